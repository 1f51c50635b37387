//! The energy balance.

use serde::{Deserialize, Serialize};

/// Terms of the energy balance, J. Their sum is constant (theory.md, equation 24).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Energies {
    /// Kinetic, film.
    pub kinetic_film: f64,
    /// Kinetic, impactors.
    pub kinetic_impactor: f64,
    /// Potential in gravity, film and impactors, over the undeformed state.
    pub potential: f64,
    /// Elastic, returned on unloading.
    pub stored: f64,
    /// Absorbed by the film's law.
    pub absorbed: f64,
    /// Stored in fibres when they broke, and in film that tore.
    pub rupture: f64,
    /// In the stabilisation against hourglass modes.
    pub hourglass: f64,
    /// Dissipated where nodes come into contact.
    pub contact: f64,
    /// Dissipated by friction of film on the impactor, on the frame's bars and on film.
    pub friction: f64,
    /// Dissipated by friction of the impactor's guide.
    pub guide: f64,
    /// Dissipated where impactors meet each other or the frame's bars.
    pub collision: f64,
    /// Dissipated by friction of film in the frame's clamp.
    pub clamp: f64,
    /// Dissipated by mass-proportional damping.
    pub damping: f64,
    /// External work by jaws, pressure, an impactor with prescribed motion or what launches an impactor, counted
    /// negative.
    pub external: f64,
}

impl Energies {
    /// Names of the terms as channels, in the order of [`Energies::terms`].
    pub const NAMES: [&'static str; 14] = [
        "kinetic_film_J",
        "kinetic_impactor_J",
        "potential_J",
        "stored_J",
        "absorbed_J",
        "rupture_J",
        "hourglass_J",
        "contact_J",
        "friction_J",
        "guide_J",
        "collision_J",
        "clamp_J",
        "damping_J",
        "external_J",
    ];

    /// The terms in order.
    pub fn terms(&self) -> [f64; 14] {
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
            self.guide,
            self.collision,
            self.clamp,
            self.damping,
            self.external,
        ]
    }

    /// Sum of all terms.
    pub fn total(&self) -> f64 {
        self.terms().iter().sum()
    }

    /// Energy exchanged between the terms since `start`: half the sum of their changes in magnitude.
    pub fn exchanged(&self, start: &Energies) -> f64 {
        let changes = self.terms().iter().zip(start.terms()).map(|(now, then)| (now - then).abs()).sum::<f64>();
        0.5 * changes
    }
}
