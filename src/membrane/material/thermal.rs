//! Adiabatic heating: film keeps the energy that it absorbs as heat, and softens by it (theory.md, equation 358).

use serde::{Deserialize, Serialize};

use crate::lane::{Lane, splat};

/// How film warms up by what it absorbs, and how it softens.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Thermal {
    /// Heat capacity of stress-free film, J/(m³ K).
    pub capacity: f64,
    /// Loss of stress and stiffness with temperature over what is left, 1/K.
    pub softening: f64,
}

/// Heat of elements, one a lane: energies are those per stress-free volume.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Heat<const L: usize> {
    /// Share of the law's forces that the element has, at the last position.
    pub share: Lane<L>,
    /// Share of the law's forces at the next position.
    pub next: Lane<L>,
    /// Energy absorbed since film was mounted, which warms it, J/m³.
    pub absorbed: Lane<L>,
    /// Energy that the law had absorbed when film was mounted, which has left it, J/m³.
    pub mounted: Lane<L>,
    /// Energy that the law, without softening, stored at the last position, J/m³.
    pub law_stored: Lane<L>,
    /// Energy that the law, without softening, had absorbed there, J/m³.
    pub law_absorbed: Lane<L>,
}

impl Thermal {
    /// Growth of the temperature by `heat` (J/m³), K.
    pub fn warming(&self, heat: f64) -> f64 {
        heat / self.capacity
    }

    /// Share of stress and stiffness that film has after it absorbed `heat` (J/m³): that of a material whose stress falls by
    /// the same share with each kelvin.
    #[inline(always)]
    fn share<const L: usize>(&self, heat: Lane<L>) -> Lane<L> {
        (-self.softening / self.capacity * heat).exp()
    }
}

/// Number of variables of [`Heat`].
pub(crate) const HEAT_VARIABLES: usize = 6;

impl<const L: usize> Heat<L> {
    /// Virgin film.
    pub(crate) const NONE: Heat<L> = Heat {
        share: splat(1.0),
        next: splat(1.0),
        absorbed: splat(0.0),
        mounted: splat(0.0),
        law_stored: splat(0.0),
        law_absorbed: splat(0.0),
    };

    /// Its variables, always in the same order.
    pub(crate) fn variables(&mut self) -> [&mut Lane<L>; HEAT_VARIABLES] {
        let Heat { share, next, absorbed, mounted, law_stored, law_absorbed } = self;
        [share, next, absorbed, mounted, law_stored, law_absorbed]
    }

    /// Moves on to the next position after `dt` (s), at which the law has `stored` and `absorbed` these energies (J/m³). What it
    /// absorbs at the mean share of both positions, and what is stored less because film softens, becomes heat (theory.md,
    /// equation 358). Film that is mounted, which takes no time, has the temperature of the room.
    #[inline(always)]
    pub(crate) fn advance(&mut self, stored: Lane<L>, absorbed: Lane<L>, dt: f64, thermal: &Thermal) {
        let (mean, fallen) = (0.5 * (self.share + self.next), self.share - self.next);
        let grown = mean * (absorbed - self.law_absorbed) + 0.5 * (self.law_stored + stored) * fallen;
        if dt > 0.0 {
            self.absorbed += grown;
        } else {
            self.mounted += grown;
        }
        self.share = self.next;
        self.next = thermal.share(self.absorbed);
        (self.law_stored, self.law_absorbed) = (stored, absorbed);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lane::one;

    /// Equation 359 with D = 1: the heat is ln(1 + β W)/β.
    #[test]
    fn heat_of_film_that_absorbs_everything() {
        let thermal = Thermal { capacity: 2.1e6, softening: 8e-3 };
        let (beta, work) = (thermal.softening / thermal.capacity, 40e6);
        let steps = 2000;
        let mut heat = Heat::<1>::NONE;
        for i in 1..=steps {
            let absorbed = work * f64::from(i) / f64::from(steps);
            heat.advance(one(0.0), one(absorbed), 1e-6, &thermal);
        }
        let expected = (1.0 + beta * work).ln() / beta;
        assert!((heat.absorbed[0] / expected - 1.0).abs() < 2e-4, "{:?} for {expected}", heat.absorbed);
        assert!((heat.share[0] - 1.0 / (1.0 + beta * work)).abs() < 1e-4, "{:?}", heat.share);
    }

    /// The work of the forces at the mean of two positions is what is stored and what became heat.
    #[test]
    fn work_is_stored_or_heat() {
        let thermal = Thermal { capacity: 2.1e6, softening: 20e-3 };
        let (young, absorption, steps) = (2e7, 0.6, 4000);
        let (mut heat, mut work, mut force) = (Heat::<1>::NONE, 0.0, 0.0);
        for i in 1..=steps {
            let strain = 2.0 * f64::from(i) / f64::from(steps);
            let energy = 0.5 * young * strain * strain;
            let now = heat.next[0] * young * strain;
            work += 0.5 * (force + now) * 2.0 / f64::from(steps);
            force = now;
            heat.advance(one((1.0 - absorption) * energy), one(absorption * energy), 1e-6, &thermal);
        }
        let found = heat.share[0] * heat.law_stored[0] + heat.absorbed[0];
        assert!((found / work - 1.0).abs() < 1e-5, "{found} of {work}");
    }

    #[test]
    fn mounting_warms_nothing() {
        let thermal = Thermal { capacity: 2.1e6, softening: 8e-3 };
        let mut heat = Heat::<1>::NONE;
        heat.advance(one(1e6), one(5e6), 0.0, &thermal);
        assert_eq!(heat, Heat { mounted: one(5e6), law_stored: one(1e6), law_absorbed: one(5e6), ..Heat::NONE });
        heat.advance(one(1e6), one(5e6), 1e-6, &thermal);
        assert_eq!((heat.absorbed, heat.share), (one(0.0), one(1.0)));
    }
}
