//! Adiabatic heating: film keeps the energy that it absorbs as heat, and softens by it (theory.md, equation 358).

use serde::{Deserialize, Serialize};

use super::Densities;
use crate::lane::exp;

/// How film warms up by what it absorbs, and how it softens.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Thermal {
    /// Heat capacity of stress-free film, J/(m³ K).
    pub capacity: f64,
    /// Loss of stress and stiffness with temperature over what is left, 1/K.
    pub softening: f64,
}

/// Heat of one element: energies are those per stress-free volume.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Heat {
    /// Share of the law's forces that the element has, at the last position.
    pub share: f64,
    /// Share of the law's forces at the next position.
    pub next: f64,
    /// Energy absorbed since film was mounted, which warms it, J/m³.
    pub absorbed: f64,
    /// Energy that the law had absorbed when film was mounted, which has left it, J/m³.
    pub mounted: f64,
    /// Energies of the law, without softening, at the last position.
    pub law: Densities,
}

impl Thermal {
    /// Growth of the temperature by `heat` (J/m³), K.
    pub fn warming(&self, heat: f64) -> f64 {
        heat / self.capacity
    }

    /// Share of stress and stiffness that film has after it absorbed `heat` (J/m³): that of a material whose stress falls by
    /// the same share with each kelvin.
    pub(crate) fn share(&self, heat: f64) -> f64 {
        exp(-self.softening * self.warming(heat))
    }
}

impl Heat {
    /// Number of its variables.
    pub(crate) const VARIABLES: usize = 6;

    /// Virgin film.
    pub(crate) const NONE: Heat =
        Heat { share: 1.0, next: 1.0, absorbed: 0.0, mounted: 0.0, law: Densities { stored: 0.0, absorbed: 0.0 } };

    /// Its variables, always in the same order.
    pub(crate) fn variables(&self) -> [f64; Heat::VARIABLES] {
        let Heat { share, next, absorbed, mounted, law } = *self;
        [share, next, absorbed, mounted, law.stored, law.absorbed]
    }

    /// Heat with these variables, in the order of [`Heat::variables`].
    pub(crate) fn of_variables(variables: [f64; Heat::VARIABLES]) -> Heat {
        let [share, next, absorbed, mounted, stored, of_law] = variables;
        Heat { share, next, absorbed, mounted, law: Densities { stored, absorbed: of_law } }
    }

    /// Moves on to the next position after `dt` (s), at which the law has these energies. What the law absorbs at the mean
    /// share of both positions, and what is stored less because film softens, becomes heat (theory.md, equation 358). Film
    /// that is mounted, which takes no time, has the temperature of the room.
    pub(crate) fn advance(&mut self, now: Densities, dt: f64, thermal: &Thermal) {
        let (mean, fallen) = (0.5 * (self.share + self.next), self.share - self.next);
        let grown = mean * (now.absorbed - self.law.absorbed) + 0.5 * (self.law.stored + now.stored) * fallen;
        self.share = self.next;
        self.law = now;
        if dt > 0.0 {
            self.absorbed += grown;
            self.next = thermal.share(self.absorbed);
        } else {
            self.mounted += grown;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Equation 359 with D = 1: the heat is ln(1 + β W)/β.
    #[test]
    fn heat_of_film_that_absorbs_everything() {
        let thermal = Thermal { capacity: 2.1e6, softening: 8e-3 };
        let (beta, work) = (thermal.softening / thermal.capacity, 40e6);
        let steps = 2000;
        let mut heat = Heat::NONE;
        for i in 1..=steps {
            let absorbed = work * f64::from(i) / f64::from(steps);
            heat.advance(Densities { stored: 0.0, absorbed }, 1e-6, &thermal);
        }
        let expected = (1.0 + beta * work).ln() / beta;
        assert!((heat.absorbed / expected - 1.0).abs() < 2e-4, "{} for {expected}", heat.absorbed);
        assert!((heat.share - 1.0 / (1.0 + beta * work)).abs() < 1e-4, "{}", heat.share);
    }

    /// The work of the forces at the mean of two positions is what is stored and what became heat.
    #[test]
    fn work_is_stored_or_heat() {
        let thermal = Thermal { capacity: 2.1e6, softening: 20e-3 };
        let (young, absorption, steps) = (2e7, 0.6, 4000);
        let (mut heat, mut work, mut force) = (Heat::NONE, 0.0, 0.0);
        for i in 1..=steps {
            let strain = 2.0 * f64::from(i) / f64::from(steps);
            let energy = 0.5 * young * strain * strain;
            let now = heat.next * young * strain;
            work += 0.5 * (force + now) * 2.0 / f64::from(steps);
            force = now;
            let law = Densities { stored: (1.0 - absorption) * energy, absorbed: absorption * energy };
            heat.advance(law, 1e-6, &thermal);
        }
        let found = heat.share * heat.law.stored + heat.absorbed;
        assert!((found / work - 1.0).abs() < 1e-5, "{found} of {work}");
    }

    #[test]
    fn mounting_warms_nothing() {
        let thermal = Thermal { capacity: 2.1e6, softening: 8e-3 };
        let mut heat = Heat::NONE;
        let law = Densities { stored: 1e6, absorbed: 5e6 };
        heat.advance(law, 0.0, &thermal);
        assert_eq!(heat, Heat { mounted: 5e6, law, ..Heat::NONE });
        heat.advance(law, 1e-6, &thermal);
        assert_eq!((heat.absorbed, heat.share), (0.0, 1.0));
    }
}
