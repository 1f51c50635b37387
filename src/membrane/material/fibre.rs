//! Laws of fibre sets.

use super::history::FibreHistory;
use super::{Curve, Strained};
use crate::lane::{Lane, splat};

/// Stress of a fibre set as a function of its engineering strain and its history variables, with absorption on
/// unloading.
pub trait FibreLaw: Clone + std::fmt::Debug + Send + Sync {
    /// Its history variables.
    type History<const L: usize>: FibreHistory<L>;

    /// Stress (Pa) at a strain, reached `dt` (s) after the previous one; updates the history variables. `dt` is zero
    /// while film is mounted.
    fn stress<const L: usize>(&self, at: Strained<'_, L>, history: &mut Self::History<L>, dt: f64) -> Lane<L>;

    /// Stress (Pa) at a strain, reached at the present rate.
    fn stress_near<const L: usize>(&self, at: Strained<'_, L>, history: &Self::History<L>) -> Lane<L>;

    /// Energy density (J/m³) at a strain: stored and absorbed.
    fn energy<const L: usize>(&self, at: Strained<'_, L>, history: &Self::History<L>) -> (Lane<L>, Lane<L>);

    /// Bound on the slope dσ/dε (Pa) within `reach` of a strain, on loading and unloading at any rate; zero where the
    /// fibre stays slack.
    fn largest_slope<const L: usize>(&self, at: Strained<'_, L>, history: &Self::History<L>, reach: f64) -> Lane<L>;

    /// The law whose stress is the mean of those of two laws, times `factor` > 0.
    fn mean(first: &Self, second: &Self, factor: f64) -> Self;

    /// Initial slope of the curve at the lowest rate, Pa.
    fn initial_slope(&self) -> f64;

    /// Largest slope of all curves at small strains, Pa.
    fn early_modulus(&self) -> f64;

    /// Break strain at the present rate.
    fn break_strain<const L: usize>(&self, history: &Self::History<L>) -> Lane<L>;

    /// Break strain at the lowest rate, and the largest at any rate.
    fn break_strains(&self) -> [f64; 2];
}

/// One curve at all rates.
impl FibreLaw for Curve {
    type History<const L: usize> = Lane<L>;

    #[inline(always)]
    fn stress<const L: usize>(&self, at: Strained<'_, L>, history: &mut Lane<L>, _dt: f64) -> Lane<L> {
        at.absorption.stress(self, at.strain, history)
    }

    #[inline(always)]
    fn stress_near<const L: usize>(&self, at: Strained<'_, L>, history: &Lane<L>) -> Lane<L> {
        at.absorption.stress(self, at.strain, &mut { *history })
    }

    #[inline(always)]
    fn energy<const L: usize>(&self, at: Strained<'_, L>, history: &Lane<L>) -> (Lane<L>, Lane<L>) {
        at.absorption.energy(self, at.strain, *history)
    }

    #[inline(always)]
    fn largest_slope<const L: usize>(&self, at: Strained<'_, L>, history: &Lane<L>, reach: f64) -> Lane<L> {
        at.absorption.largest_slope(self, at.strain, *history, reach)
    }

    fn mean(first: &Curve, second: &Curve, factor: f64) -> Curve {
        Curve::weighted(first, second, [0.5 * factor; 2])
    }

    fn initial_slope(&self) -> f64 {
        Curve::initial_slope(self)
    }

    fn early_modulus(&self) -> f64 {
        self.early_slope()
    }

    #[inline(always)]
    fn break_strain<const L: usize>(&self, _history: &Lane<L>) -> Lane<L> {
        splat(self.end())
    }

    fn break_strains(&self) -> [f64; 2] {
        [self.end(); 2]
    }
}
