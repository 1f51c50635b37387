//! The energy balance.

use serde::{Deserialize, Serialize};

macro_rules! terms {
    ($($(#[doc = $doc:literal])+ $term:ident = $name:literal;)+) => {
        /// Terms of the energy balance, J. Their sum is constant (theory.md, equation 24).
        #[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
        pub struct Energies {
            $($(#[doc = $doc])+ pub $term: f64,)+
        }

        impl Energies {
            /// The terms as channels, in the order of [`Energies::terms`].
            pub const TERMS: &[EnergyTerm] = &[$(EnergyTerm { name: $name, sentence: &[$($doc),+] }),+];

            /// The terms in order.
            pub fn terms(&self) -> [f64; Self::TERMS.len()] {
                [$(self.$term),+]
            }
        }
    };
}

/// A term of the energy balance as a channel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EnergyTerm {
    /// It ends with the unit.
    pub name: &'static str,
    /// Description, as one or more lines.
    pub sentence: &'static [&'static str],
}

terms! {
    /// Kinetic energy of the film.
    kinetic_film = "kinetic_film_J";
    /// Kinetic energy of the impactors.
    kinetic_impactor = "kinetic_impactor_J";
    /// Potential energy of film and impactors in gravity, over the undeformed state.
    potential = "potential_J";
    /// Elastic energy of the film, returned on unloading.
    stored = "stored_J";
    /// Energy absorbed by the film's law.
    absorbed = "absorbed_J";
    /// Energy that was stored in fibres when they broke, and in film that tore.
    rupture = "rupture_J";
    /// Energy in the stabilisation against hourglass modes.
    hourglass = "hourglass_J";
    /// Energy dissipated where nodes come into contact.
    contact = "contact_J";
    /// Energy dissipated by friction of film on the impactor, on the frame's bars and on film.
    friction = "friction_J";
    /// Energy dissipated by friction of the impactor's guide.
    guide = "guide_J";
    /// Energy dissipated where impactors meet each other or the frame's bars.
    collision = "collision_J";
    /// Energy dissipated by friction of film in the frame's clamp.
    clamp = "clamp_J";
    /// Elastic energy of the frame's springs.
    springs = "springs_J";
    /// Energy dissipated by mass-proportional damping.
    damping = "damping_J";
    /// External work by jaws, pressure, an impactor with prescribed motion or what launches an impactor, counted
    /// negative.
    external = "external_J";
}

impl Energies {
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
