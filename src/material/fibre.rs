//! What a fabric asks of its fibre sets.

use super::history::FibreHistory;
use super::{Absorption, Curve};
use crate::lane::{Lane, splat};

/// Stress of a fibre set as a function of its engineering strain and its past, with absorption on unloading.
pub trait FibreLaw: Clone + std::fmt::Debug + Send + Sync {
    /// What it remembers.
    type History<const L: usize>: FibreHistory<L>;

    /// Stress (Pa) at `strain`, reached `dt` (s) after the strain before; remembers it. No time passes while film is mounted.
    fn stress<const L: usize>(
        &self,
        absorption: &Absorption,
        strain: &Lane<L>,
        history: &mut Self::History<L>,
        dt: f64,
    ) -> Lane<L>;

    /// Stress (Pa) at `strain`, reached as fast as it was strained so far.
    fn stress_near<const L: usize>(
        &self,
        absorption: &Absorption,
        strain: &Lane<L>,
        history: &Self::History<L>,
    ) -> Lane<L>;

    /// Energy density (J/m³) at `strain`: what would come back, and what is lost for good.
    fn energy<const L: usize>(
        &self,
        absorption: &Absorption,
        strain: &Lane<L>,
        history: &Self::History<L>,
    ) -> (Lane<L>, Lane<L>);

    /// Largest slope dσ/dε (Pa) within `reach` of `strain`, whichever way and however fast it goes on; zero where the fibre stays slack.
    fn steepest<const L: usize>(
        &self,
        absorption: &Absorption,
        strain: &Lane<L>,
        history: &Self::History<L>,
        reach: f64,
    ) -> Lane<L>;

    /// Slope at rest, Pa.
    fn initial_slope(&self) -> f64;

    /// Strain at which it breaks as fast as it was strained so far.
    fn break_strain<const L: usize>(&self, history: &Self::History<L>) -> Lane<L>;

    /// Strains at which it breaks when it is strained slowly, and at the rate at which it holds longest.
    fn break_strains(&self) -> [f64; 2];
}

/// One curve at all rates.
impl FibreLaw for Curve {
    type History<const L: usize> = Lane<L>;

    #[inline(always)]
    fn stress<const L: usize>(
        &self,
        absorption: &Absorption,
        strain: &Lane<L>,
        history: &mut Lane<L>,
        _dt: f64,
    ) -> Lane<L> {
        absorption.stress(self, strain, history)
    }

    #[inline(always)]
    fn stress_near<const L: usize>(&self, absorption: &Absorption, strain: &Lane<L>, history: &Lane<L>) -> Lane<L> {
        absorption.stress(self, strain, &mut history.clone())
    }

    #[inline(always)]
    fn energy<const L: usize>(
        &self,
        absorption: &Absorption,
        strain: &Lane<L>,
        history: &Lane<L>,
    ) -> (Lane<L>, Lane<L>) {
        absorption.energy(self, strain, history)
    }

    #[inline(always)]
    fn steepest<const L: usize>(
        &self,
        absorption: &Absorption,
        strain: &Lane<L>,
        history: &Lane<L>,
        reach: f64,
    ) -> Lane<L> {
        absorption.steepest(self, strain, history, reach)
    }

    fn initial_slope(&self) -> f64 {
        Curve::initial_slope(self)
    }

    #[inline(always)]
    fn break_strain<const L: usize>(&self, _history: &Lane<L>) -> Lane<L> {
        splat(self.end())
    }

    fn break_strains(&self) -> [f64; 2] {
        [self.end(); 2]
    }
}
