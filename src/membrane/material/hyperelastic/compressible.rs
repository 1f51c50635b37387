//! Neo-Hookean with a volume that changes.
//!
//! With `J = √D λ₃`, `x = λ₃²`, `k = λ/(2μ) = ν/(1 − 2ν)` (theory.md, equation 224):
//!
//! ```text
//! W = ½ μ (I + x − 3) − μ ln J + ½ λ ln² J
//! ∂W/∂λ₃ = 0 :  x − 1 + k (ln x + ln D) = 0
//! ∂W/∂I = ½ μ ,   ∂W/∂D = −½ μ x/D ,   ∂²W/∂D² = ½ μ x/D² (1 + k/(x + k))
//! ```

use serde::{Deserialize, Serialize};

use super::invariants::{self, Slopes};
use super::{Squares, StrainEnergy, Tangent};
use crate::lane::{Lane, splat};
use crate::material::elastic::Plane;

/// Moduli of small strain.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CompressibleNeoHookean {
    /// Young's modulus, Pa.
    pub young: f64,
    /// Poisson's ratio, 0 ≤ ν < 0.5.
    pub poisson: f64,
}

/// Steps of Halley's method, after which the equation of the thickness is solved to round-off for D between 1e-9 and
/// 1e9.
const STEPS: usize = 4;

/// The root x of x − 1 + k (ln x + L) = 0, and its logarithm, where `log` holds L.
///
/// In y = ln x the left side is convex and grows. Its root lies below −kL/(1 + k), since e^y ≥ 1 + y, below 1/k − L,
/// since e^y ≥ 0, and below ln max(1, 1 − kL), since y or L is negative: Halley's method starts at the least of these.
#[inline(always)]
fn thickness<const L: usize>(k: f64, log: Lane<L>) -> [Lane<L>; 2] {
    let compressed = (1.0 - k * log).max(1.0).ln();
    let mut y = compressed.min((1.0 / k - log).min(-k * log / (1.0 + k)));
    for _ in 0..STEPS {
        let x = y.exp();
        let value = x - 1.0 + k * (y + log);
        let slope = x + k;
        y -= value * slope / (slope * slope - 0.5 * value * x);
    }
    [y.exp(), y]
}

impl CompressibleNeoHookean {
    /// μ, Pa.
    fn shear(&self) -> f64 {
        self.young / (2.0 * (1.0 + self.poisson))
    }

    /// k.
    pub(super) fn ratio(&self) -> f64 {
        self.poisson / (1.0 - 2.0 * self.poisson)
    }

    #[inline(always)]
    pub(super) fn squared_thickness<const L: usize>(&self, det: Lane<L>) -> [Lane<L>; 2] {
        thickness(self.ratio(), det.ln())
    }

    #[inline(always)]
    fn slopes<const L: usize>(&self, det: Lane<L>) -> Slopes<L> {
        let half = 0.5 * self.shear();
        let [x, _] = self.squared_thickness(det);
        [splat(half), -half * x / det]
    }
}

impl StrainEnergy for CompressibleNeoHookean {
    #[inline(always)]
    fn energy<const L: usize>(&self, c: &Squares<L>) -> Lane<L> {
        let [trace, det] = invariants::of_squares(c);
        let (mu, k) = (self.shear(), self.ratio());
        let [x, y] = self.squared_thickness(det);
        let volume = 0.5 * (det.ln() + y);
        mu * (0.5 * (trace + x - 3.0) + volume * (k * volume - 1.0))
    }

    #[inline(always)]
    fn stress<const L: usize>(&self, c: &Squares<L>) -> [Lane<L>; 2] {
        let [_, det] = invariants::of_squares(c);
        invariants::stress(c, &self.slopes(det))
    }

    #[inline(always)]
    fn plane_stress<const L: usize>(&self, c: &Plane<L>) -> Plane<L> {
        let [_, det] = invariants::of_metric(c);
        invariants::plane_stress(c, &self.slopes(det))
    }

    #[inline(always)]
    fn tangent<const L: usize>(&self, c: &Squares<L>) -> Tangent<L> {
        let [_, det] = invariants::of_squares(c);
        let (half, k) = (0.5 * self.shear(), self.ratio());
        let [x, _] = self.squared_thickness(det);
        let ratio = half * x / det;
        let bent = ratio / det * (1.0 + k / (x + k));
        invariants::tangent(c, &[splat(half), -ratio], &[splat(0.0), splat(0.0), bent])
    }

    #[inline(always)]
    fn thickness<const L: usize>(&self, c: &Squares<L>) -> Lane<L> {
        let [_, det] = invariants::of_squares(c);
        let [x, _] = self.squared_thickness(det);
        x.sqrt()
    }

    /// In uniaxial tension width and thickness are equal: x − 1 + 2k (ln x + ½ ln c₁) = 0.
    #[inline(always)]
    fn natural_width<const L: usize>(&self, first: Lane<L>) -> Lane<L> {
        let [x, _] = thickness(2.0 * self.ratio(), 0.5 * first.ln());
        x
    }

    fn poisson(&self) -> f64 {
        self.poisson
    }

    fn plane_modulus(&self) -> f64 {
        self.young / (1.0 - self.poisson * self.poisson)
    }
}
