//! Stretches and shear angle of two fibre sets, and the stress that follows from the values of their curves.

use super::elastic::Plane;
use super::{Deformation, Stress, Stresses};
use crate::lane::{Lane, at, each, lanes, larger, smaller};

/// |sin γ| up to which the shear angle is the arcsine.
const SINE_BOUND: f64 = 0.95;

/// γ/sin γ in powers of cos γ − [`CENTRE`], |sin γ| up to the bound: interpolation at Chebyshev nodes, within 1.2e-16.
/// As a function of the cosine it is smooth through γ = 0, where the arcsine as a function of the sine would need
/// another root.
const ANGLE_OVER_SINE: [f64; 16] = [
    1.1331927198876424,
    -0.45048585789817597,
    0.21647545881796867,
    -0.11172212091915776,
    0.05985914378835787,
    -0.03281938075907477,
    0.018277169215623234,
    -0.010293937629056713,
    0.005847226654561683,
    -0.003343609810733535,
    0.0019230361865691136,
    -0.0011104189468963863,
    0.0006355670625241936,
    -0.0003695298638060537,
    0.0002569675709305914,
    -0.00015006110076762043,
];

/// The middle of the cosines.
const CENTRE: f64 = 0.656;

/// [`ANGLE_OVER_SINE`] at a cosine, by Estrin's scheme, whose chain of dependent operations is shorter than Horner's.
#[inline(always)]
fn angle_over_sine(cosine: f64) -> f64 {
    let t = cosine - CENTRE;
    let t2 = t * t;
    let t4 = t2 * t2;
    let pair = |k: usize| ANGLE_OVER_SINE[2 * k] + ANGLE_OVER_SINE[2 * k + 1] * t;
    let four = |k: usize| pair(2 * k) + pair(2 * k + 1) * t2;
    let eight = |k: usize| four(2 * k) + four(2 * k + 1) * t4;
    eight(0) + eight(1) * (t4 * t4)
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
        let [first, second, r1, r2, sine, secant, angle] = each(|l| {
            let [c11, c22, c12] = d.metric_at(l);
            let (first, second) = (c11.sqrt(), c22.sqrt());
            let (m1, m2) = (larger(first, 1.0), larger(second, 1.0));
            // One division for two inverses: divisions are what this loop costs.
            let both = 1.0 / (m1 * m2);
            let (r1, r2) = (m2 * both, m1 * both);
            let sine = c12 * r1 * r2;
            let bounded = smaller(larger(sine, -SINE_BOUND), SINE_BOUND);
            let cosine = (1.0 - bounded * bounded).sqrt();
            let secant = 1.0 / cosine;
            // Beyond the bound along the tangent (theory.md, equation 7), in the same expression: the second term is zero
            // within it.
            let angle = bounded * angle_over_sine(cosine) + (sine - bounded) * secant;
            [first, second, r1, r2, sine, secant, angle]
        });
        Fibres { stretch: [first, second], inverse: [r1, r2], sine, secant, angle }
    }

    #[inline(always)]
    pub(super) fn strain(&self, fibre: usize) -> Lane<L> {
        lanes(|l| self.stretch[fibre][l] - 1.0)
    }

    /// |γ|.
    #[inline(always)]
    pub(super) fn shear(&self) -> Lane<L> {
        lanes(|l| self.angle[l].abs())
    }

    /// Nominal stresses, of any law: ∂W/∂λ_I and ∂W/∂γ where W depends on λ₁², λ₂² and f₁·f₂ = m₁ m₂ sin γ.
    pub(super) fn stresses(&self, stress: &Stress<L>) -> Stresses<L> {
        let [md, td, shear] = each(|l| {
            let ([first, second], [r1, r2], sine) = (at(&self.stretch, l), at(&self.inverse, l), self.sine[l]);
            let ([s11, s22], s12) = (at(&stress.tension, l), stress.cross[l]);
            let along = |stretch: f64, tension: f64, other: f64| {
                tension * stretch + s12 * if stretch > 1.0 { sine / other } else { 0.0 }
            };
            [along(first, s11, r2), along(second, s22, r1), s12 / (r1 * r2 * self.secant[l])]
        });
        Stresses { md, td, shear }
    }

    /// (ε₁ + ε₂)/2.
    #[inline(always)]
    pub(super) fn mean_strain(&self) -> Lane<L> {
        lanes(|l| 0.5 * (self.stretch[0][l] + self.stretch[1][l]) - 1.0)
    }

    /// Second Piola–Kirchhoff stress S₁₁, S₂₂ and S₁₂ of fibres with the nominal stresses `md`, `td` and `shear`, Pa.
    #[inline(always)]
    pub(super) fn second_piola(&self, nominal: &Plane<L>) -> Plane<L> {
        each(|l| {
            let ([first, second], [r1, r2], sine) = (at(&self.stretch, l), at(&self.inverse, l), self.sine[l]);
            let [md, td, shear] = at(nominal, l);
            // Curves know |γ| alone; the sign of the angle is put back by its bit, without a branch.
            let shear = shear.copysign(self.angle[l]) * self.secant[l];
            // The bracket [λ > 1] of equation 6.
            let taut1 = if first > 1.0 { r1 * r1 } else { 0.0 };
            let taut2 = if second > 1.0 { r2 * r2 } else { 0.0 };
            [md * r1 - shear * sine * taut1, td * r2 - shear * sine * taut2, shear * r1 * r2]
        })
    }

    /// Adds the stress of biaxial coupling σ_b to a second Piola–Kirchhoff stress.
    #[inline(always)]
    pub(super) fn add_biaxial(&self, s: &mut Plane<L>, stress: &Lane<L>) {
        for fibre in 0..2 {
            for l in 0..L {
                // By λ, not by m: σ_b pulls at slack fibres, too (theory.md, below equation 4b).
                s[fibre][l] += stress[l] / self.stretch[fibre][l];
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_angle_is_the_arcsine_continued_along_its_tangent() {
        for i in -99..=99 {
            let sine = f64::from(i) / 100.0;
            let f = [[1.0, 0.0, 0.0], [sine, (1.0 - sine * sine).sqrt(), 0.0]].map(|v| v.map(|x| [x]));
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
