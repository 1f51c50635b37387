//! Energy absorption on unloading.
//!
//! A fibre that was loaded along its curve σ(ε) to the largest strain ε_m and is then unloaded follows
//! the same curve, compressed towards ε_m by the factor 1 − D (theory.md, equation 8):
//!
//! ```text
//! σ_u(ε) = σ(ε_m − (ε_m − ε)/(1 − D)),   zero where the argument is negative.
//! ```
//!
//! Substituting the argument in ∫σ_u dε gives exactly (1 − D)·W(ε_m): the share D of the stored energy is lost
//! whatever the curve, the path is monotone as the curve is, and D = 0 is the curve itself. Reloading follows
//! the same path to (ε_m, σ(ε_m)) and then the curve.

use serde::{Deserialize, Serialize};

use super::curve::Curve;
use crate::lane::Lane;

/// Share D of the stored energy that is lost on unloading.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Absorption {
    share: f64,
    steepening: f64,
}

/// A strain of fibres that absorb energy on unloading.
#[derive(Clone, Copy, Debug)]
pub struct Strained<'a, const L: usize> {
    pub(super) strain: Lane<L>,
    pub(super) absorption: &'a Absorption,
}

impl Absorption {
    /// Fibres at `strain`.
    #[inline(always)]
    pub fn at<const L: usize>(&self, strain: Lane<L>) -> Strained<'_, L> {
        Strained { strain, absorption: self }
    }

    /// `share` D with 0 ≤ D < 1.
    pub fn new(share: f64) -> Absorption {
        assert!((0.0..1.0).contains(&share), "share of absorbed energy: {share}");
        Absorption { share, steepening: 1.0 / (1.0 - share) }
    }

    /// D.
    pub fn share(&self) -> f64 {
        self.share
    }

    /// 1/(1 − D).
    #[inline(always)]
    pub(super) fn steepening(&self) -> f64 {
        self.steepening
    }

    /// Strain on the curve that has the stress of a fibre at `strain` with largest strain `peak`.
    #[inline(always)]
    fn curve_strain<const L: usize>(&self, strain: Lane<L>, peak: Lane<L>) -> Lane<L> {
        peak - (peak - strain) * self.steepening
    }

    /// Stress at `strain`; raises `peak` to it.
    #[inline(always)]
    pub fn stress<const L: usize>(&self, curve: &Curve, strain: Lane<L>, peak: &mut Lane<L>) -> Lane<L> {
        // In this order a NaN strain leaves the peak as it is; the stress has it all the same.
        *peak = strain.max(*peak);
        curve.stress_lanes(self.curve_strain(strain, *peak))
    }

    /// Energy density (J/m³) at `strain` with largest strain `peak`: stored and absorbed.
    #[inline(always)]
    pub fn energy<const L: usize>(&self, curve: &Curve, strain: Lane<L>, peak: Lane<L>) -> (Lane<L>, Lane<L>) {
        let (present, largest) = (curve.read(self.curve_strain(strain, peak)).energy, curve.read(peak).energy);
        ((1.0 - self.share) * present, self.share * largest)
    }

    /// Largest slope within `reach` of `strain` on either path, Pa; zero where the fibre stays slack.
    #[inline(always)]
    pub fn largest_slope<const L: usize>(&self, curve: &Curve, strain: Lane<L>, peak: Lane<L>, reach: f64) -> Lane<L> {
        let reach = reach * self.steepening;
        let place = self.curve_strain(strain, peak);
        let (from, to) = (place - reach, place + reach);
        // Loading has the plain slope, but any strain may turn to unloading within the interval.
        to.below(0.0).select(0.0, self.steepening * curve.largest_slope(from, to))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lane::one;

    fn curves() -> [Curve; 3] {
        [
            Curve::new(vec![[0.03, 8.4e6], [0.2, 20e6], [0.75, 29e6]]).unwrap(),
            Curve::new(vec![[0.3, 1e6], [0.5, 1e6], [0.6, 9e6]]).unwrap(),
            Curve::new(vec![[1.0, 5e7]]).unwrap(),
        ]
    }

    /// Work by the trapezoid rule along `strains`, from the stresses alone.
    fn work(absorption: Absorption, curve: &Curve, peak: &mut Lane<1>, from: f64, to: f64) -> f64 {
        let steps = 20_000;
        let at = |i: usize| from + (to - from) * i as f64 / steps as f64;
        let mut total = 0.0;
        let mut before = absorption.stress(curve, one(from), peak)[0];
        for i in 1..=steps {
            let stress = absorption.stress(curve, one(at(i)), peak)[0];
            total += 0.5 * (before + stress) * (at(i) - at(i - 1));
            before = stress;
        }
        total
    }

    /// Load, unload, reload, cycle by cycle to a larger strain each: work in, share out, nothing more lost on the way
    /// back.
    #[test]
    fn every_cycle_returns_its_share() {
        for curve in curves() {
            for share in [0.0, 0.3, 0.8896, 0.99] {
                let absorption = Absorption::new(share);
                let mut peak = one(0.0);
                for fraction in [0.02, 0.1, 0.4, 0.9] {
                    let largest = fraction * curve.end();
                    work(absorption, &curve, &mut peak, 0.0, largest);
                    let envelope = curve.energy(largest);
                    let out = -work(absorption, &curve, &mut peak, largest, 0.0);
                    let again = work(absorption, &curve, &mut peak, 0.0, largest);
                    assert!((out - (1.0 - share) * envelope).abs() < 1e-5 * envelope, "D {share}: {out} of {envelope}");
                    assert!((again - out).abs() < 1e-9 * envelope, "reload {again} after {out}");
                    let (stored, absorbed) = absorption.energy(&curve, one(largest), peak);
                    assert!((stored[0] + absorbed[0] - envelope).abs() < 1e-12 * envelope);
                }
            }
        }
    }

    #[test]
    fn unloading_is_monotone_and_reloading_meets_the_curve() {
        for curve in curves() {
            let (absorption, largest) = (Absorption::new(0.8896), 0.8 * curve.end());
            let mut peak = one(largest);
            let mut stress = |strain: f64| absorption.stress(&curve, one(strain), &mut peak)[0];
            let path: Vec<f64> = (0..=200).map(|i| stress(largest * f64::from(i) / 200.0)).collect();
            assert!(path.windows(2).all(|w| w[0] <= w[1]));
            assert_eq!(path[200], curve.stress(largest));
            assert_eq!(stress(0.9 * curve.end()), curve.stress(0.9 * curve.end()));
        }
    }
}
