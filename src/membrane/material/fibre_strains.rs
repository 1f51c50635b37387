//! Stretches and shear angle of two fibre sets, and the stress that follows from the values of their curves.

use super::{Deformation, Stress, Stresses};
use crate::lane::Lane;

/// |sin γ| up to which the shear angle is the arcsine.
const SINE_BOUND: f64 = 0.95;

/// γ/sin γ in powers of cos γ − [`CENTRE`], |sin γ| up to the bound: interpolation at Chebyshev nodes, within 1.2e-16.
/// As a function of the cosine it is smooth through γ = 0, where the arcsine as a function of the sine would need
/// another root.
const ANGLE_OVER_SINE: [[f64; 8]; 2] = [
    [
        1.1331927198876424,
        -0.45048585789817597,
        0.21647545881796867,
        -0.11172212091915776,
        0.05985914378835787,
        -0.03281938075907477,
        0.018277169215623234,
        -0.010293937629056713,
    ],
    [
        0.005847226654561683,
        -0.003343609810733535,
        0.0019230361865691136,
        -0.0011104189468963863,
        0.0006355670625241936,
        -0.0003695298638060537,
        0.0002569675709305914,
        -0.00015006110076762043,
    ],
];

/// The middle of the cosines.
const CENTRE: f64 = 0.656;

/// [`ANGLE_OVER_SINE`] at a cosine, by Estrin's scheme, whose chain of dependent operations is shorter than Horner's.
#[inline(always)]
fn angle_over_sine<const L: usize>(cosine: Lane<L>) -> Lane<L> {
    let t = cosine - CENTRE;
    let t2 = t * t;
    let t4 = t2 * t2;
    let [low, high] = ANGLE_OVER_SINE;
    eight(low, t, t2, t4) + eight(high, t, t2, t4) * (t4 * t4)
}

/// Σ c_k t^k, with the powers of `t`.
#[inline(always)]
fn eight<const L: usize>(c: [f64; 8], t: Lane<L>, t2: Lane<L>, t4: Lane<L>) -> Lane<L> {
    let low = (c[0] + c[1] * t) + (c[2] + c[3] * t) * t2;
    let high = (c[4] + c[5] * t) + (c[6] + c[7] * t) * t2;
    low + high * t4
}

/// The fibres of a deformation.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fibres<const L: usize> {
    pub(super) stretch: [Lane<L>; 2],
    /// 1/m_i.
    pub(super) inverse: [Lane<L>; 2],
    /// f₁·f₂/(m₁ m₂).
    pub(super) sine: Lane<L>,
    /// dγ/d(sin γ).
    pub(super) secant: Lane<L>,
    /// Shear angle γ, rad.
    pub(super) angle: Lane<L>,
}

impl<const L: usize> Fibres<L> {
    #[inline(always)]
    pub(super) fn from_deformation(d: &Deformation<L>) -> Fibres<L> {
        let [c11, c22, product] = d.metric();
        let stretch = [c11.sqrt(), c22.sqrt()];
        let [m1, m2] = [stretch[0].max(1.0), stretch[1].max(1.0)];
        // One division for two inverses: divisions are what this function costs.
        let both = 1.0 / (m1 * m2);
        let inverse = [m2 * both, m1 * both];
        let sine = product * inverse[0] * inverse[1];
        let bounded = sine.max(-SINE_BOUND).min(SINE_BOUND);
        let cosine = (1.0 - bounded * bounded).sqrt();
        let secant = 1.0 / cosine;
        // Beyond the bound along the tangent (theory.md, equation 7), in the same expression: the second term is zero
        // within it.
        let angle = bounded * angle_over_sine(cosine) + (sine - bounded) * secant;
        Fibres { stretch, inverse, sine, secant, angle }
    }

    #[inline(always)]
    pub(super) fn strain(&self, fibre: usize) -> Lane<L> {
        self.stretch[fibre] - 1.0
    }

    /// |γ|.
    #[inline(always)]
    pub(super) fn shear(&self) -> Lane<L> {
        self.angle.abs()
    }

    /// Nominal stresses, of any law: ∂W/∂λ_I and ∂W/∂γ where W depends on λ₁², λ₂² and f₁·f₂ = m₁ m₂ sin γ.
    pub(super) fn stresses(&self, stress: &Stress<L>) -> Stresses<L> {
        let along = |fibre: usize| {
            let stretch = self.stretch[fibre];
            let sheared = stretch.above(1.0).select(self.sine / self.inverse[1 - fibre], 0.0);
            stress.tension[fibre] * stretch + stress.cross * sheared
        };
        let shear = stress.cross / (self.inverse[0] * self.inverse[1] * self.secant);
        Stresses { md: along(0), td: along(1), shear }
    }

    /// (ε₁ + ε₂)/2.
    #[inline(always)]
    pub(super) fn mean_strain(&self) -> Lane<L> {
        0.5 * (self.stretch[0] + self.stretch[1]) - 1.0
    }

    /// Tensions of fibres with the nominal stresses `md`, `td` and `shear`, Pa.
    #[inline(always)]
    pub(super) fn tensions(&self, [md, td, shear]: [Lane<L>; 3]) -> Tensions<L> {
        let [r1, r2] = self.inverse;
        // Curves know |γ| alone; the sign of the angle is put back by its bit, without a branch.
        let shear = shear.copysign(self.angle) * self.secant;
        // The bracket [λ > 1] of equation 6.
        let taut1 = self.stretch[0].above(1.0).select(r1 * r1, 0.0);
        let taut2 = self.stretch[1].above(1.0).select(r2 * r2, 0.0);
        let tension = [md * r1 - shear * self.sine * taut1, td * r2 - shear * self.sine * taut2];
        Tensions { tension, cross: shear * r1 * r2 }
    }
}

/// Derivatives of the energy by the metric.
pub(super) struct Tensions<const L: usize> {
    /// 2 ∂W/∂λ₁² and 2 ∂W/∂λ₂², Pa.
    pub(super) tension: [Lane<L>; 2],
    /// ∂W/∂(f₁·f₂), Pa.
    cross: Lane<L>,
}

impl<const L: usize> Tensions<L> {
    /// Adds the nominal stress `stress` (Pa) along both fibres.
    #[inline(always)]
    pub(super) fn add_biaxial(&mut self, fibres: &Fibres<L>, stress: Lane<L>) {
        // By λ, not by m: σ_b pulls at slack fibres, too (theory.md, below equation 4b).
        self.tension[0] += stress / fibres.stretch[0];
        self.tension[1] += stress / fibres.stretch[1];
    }

    /// The stress at `d`.
    #[inline(always)]
    pub(super) fn stress(&self, d: &Deformation<L>) -> Stress<L> {
        Stress::of_metric(d, self.tension, self.cross)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_angle_is_the_arcsine_continued_along_its_tangent() {
        for i in -99..=99 {
            let sine = f64::from(i) / 100.0;
            let f = [[1.0, 0.0, 0.0], [sine, (1.0 - sine * sine).sqrt(), 0.0]];
            let expected = if sine.abs() <= SINE_BOUND {
                sine.asin()
            } else {
                let tangent = 1.0 / (1.0 - SINE_BOUND * SINE_BOUND).sqrt();
                sine.signum() * (SINE_BOUND.asin() + tangent * (sine.abs() - SINE_BOUND))
            };
            assert!((Fibres::<1>::from_deformation(&f.into()).angle[0] - expected).abs() < 2e-15, "at {sine}");
        }
    }
}
