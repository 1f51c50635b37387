//! The energy audit.

use serde::{Deserialize, Serialize};

/// Where the energy of a run is, J. The sum of all terms stays constant.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Energies {
    /// Kinetic, film.
    pub kinetic_film: f64,
    /// Kinetic, impactor.
    pub kinetic_impactor: f64,
    /// Potential in gravity, film and impactor, over the undeformed state.
    pub potential: f64,
    /// Elastic, comes back on unloading.
    pub stored: f64,
    /// Absorbed by the film's law.
    pub absorbed: f64,
    /// Held by elements when they failed.
    pub rupture: f64,
    /// In the stabilisation against hourglass modes.
    pub hourglass: f64,
    /// Lost where nodes first met the impactor.
    pub contact: f64,
    /// Lost by sliding.
    pub friction: f64,
    /// Lost to mass-proportional damping.
    pub damping: f64,
    /// Given by jaws, pressure or a driven impactor, counted negative.
    pub external: f64,
}

impl Energies {
    /// Names of the terms as channels, in the order of [`Energies::terms`].
    pub const NAMES: [&'static str; 11] = [
        "kinetic_film_J",
        "kinetic_impactor_J",
        "potential_J",
        "stored_J",
        "absorbed_J",
        "rupture_J",
        "hourglass_J",
        "contact_J",
        "friction_J",
        "damping_J",
        "external_J",
    ];

    /// The terms in order.
    pub fn terms(&self) -> [f64; 11] {
        [
            self.kinetic_film,
            self.kinetic_impactor,
            self.potential,
            self.stored,
            self.absorbed,
            self.rupture,
            self.hourglass,
            self.contact,
            self.friction,
            self.damping,
            self.external,
        ]
    }

    /// Sum of all terms.
    pub fn total(&self) -> f64 {
        self.terms().iter().sum()
    }

    /// Half the sum of what all terms gained and lost since `start`: the energy that changed its place.
    pub fn exchanged(&self, start: &Energies) -> f64 {
        let moved = self.terms().iter().zip(start.terms()).map(|(now, then)| (now - then).abs()).sum::<f64>();
        0.5 * moved
    }
}
