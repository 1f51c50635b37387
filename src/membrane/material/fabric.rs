//! Film as a fabric: two fibre sets and shear.
//!
//! Energy per volume of stress-free film (theory.md, equations 4–7), with λ_i = |f_i|, ε_i = λ_i − 1:
//!
//! ```text
//! W = W_md(ε₁) + W_td(ε₂) + W_s(γ),    sin γ = f₁·f₂ / (m₁ m₂),   m_i = max(λ_i, 1)
//! ∂W/∂f₁ = σ_md f₁/λ₁ + τ(γ)/cos γ · ( f₂/(m₁ m₂) − [λ₁ > 1] sin γ · f₁/λ₁² )
//! ```
//!
//! and the same with the indices exchanged. γ is the angle by which taut fibres deviate from their right angle;
//! a slack fibre carries no stress, and its part in shear decreases with its length instead of growing without bound.
//! Beyond |sin γ| = 0.95 the angle is continued along its tangent, so that the force is bounded as the fibres align.

use serde::{Deserialize, Serialize};

use super::fibre::FibreLaw;
use super::history::PointHistory;
use super::{Absorption, Curve, Deformation, Energy, LayerBreaks, MembraneLaw, Stiffness, Stress, Stresses};
use crate::lane::{Lane, Lane3, dot, larger, smaller, splat};

/// Two fibre sets at 90° in the stress-free film, each with a curve or with curves by strain rate, and a shear curve,
/// with energy absorption on unloading.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Fabric<F = Curve> {
    md: F,
    td: F,
    shear: Curve,
    absorption: Absorption,
    layer_breaks: LayerBreaks,
}

impl<F: FibreLaw> Fabric<F> {
    /// Engineering stress (Pa) over engineering strain for MD and TD, shear stress (Pa) over shear angle (rad),
    /// and the share 0 ≤ `absorption` < 1 of the stored energy that is lost on unloading, in the fibres and in shear.
    pub fn new(md: F, td: F, shear: Curve, absorption: f64) -> Fabric<F> {
        Fabric { md, td, shear, absorption: Absorption::new(absorption), layer_breaks: LayerBreaks::default() }
    }

    /// The same film of layers that break one after another.
    pub fn with_layer_breaks(self, layer_breaks: LayerBreaks) -> Fabric<F> {
        Fabric { layer_breaks, ..self }
    }

    /// Curve of the MD fibres.
    pub fn md(&self) -> &F {
        &self.md
    }

    /// Curve of the TD fibres.
    pub fn td(&self) -> &F {
        &self.td
    }

    /// Shear stress over shear angle.
    pub fn shear(&self) -> &Curve {
        &self.shear
    }

    /// Share of the stored energy that is lost on unloading.
    pub fn absorption(&self) -> f64 {
        self.absorption.share()
    }
}

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
pub(super) struct Fibres<const L: usize> {
    stretch: [Lane<L>; 2],
    /// 1/m_i.
    inverse: [Lane<L>; 2],
    /// f₁·f₂/(m₁ m₂).
    sine: Lane<L>,
    /// dγ/d(sin γ).
    secant: Lane<L>,
    /// Shear angle γ, rad.
    pub(super) angle: Lane<L>,
}

impl<const L: usize> Fibres<L> {
    #[inline(always)]
    pub(super) fn of(d: &Deformation<L>) -> Fibres<L> {
        let (c11, c22, c12) = (dot(&d.f[0], &d.f[0]), dot(&d.f[1], &d.f[1]), dot(&d.f[0], &d.f[1]));
        let mut out = Fibres {
            stretch: [splat(0.0); 2],
            inverse: [splat(0.0); 2],
            sine: splat(0.0),
            secant: splat(0.0),
            angle: splat(0.0),
        };
        for l in 0..L {
            out.stretch[0][l] = (c11[l] + d.stretch_variance[0][l]).sqrt();
            out.stretch[1][l] = (c22[l] + d.stretch_variance[1][l]).sqrt();
            let (m1, m2) = (larger(out.stretch[0][l], 1.0), larger(out.stretch[1][l], 1.0));
            let both = 1.0 / (m1 * m2);
            out.inverse[0][l] = m2 * both;
            out.inverse[1][l] = m1 * both;
        }
        for l in 0..L {
            let sine = c12[l] * out.inverse[0][l] * out.inverse[1][l];
            let bounded = smaller(larger(sine, -SINE_BOUND), SINE_BOUND);
            let cosine = (1.0 - bounded * bounded).sqrt();
            out.sine[l] = sine;
            out.secant[l] = 1.0 / cosine;
            out.angle[l] = bounded * angle_over_sine(cosine) + (sine - bounded) * out.secant[l];
        }
        out
    }

    #[inline(always)]
    pub(super) fn strain(&self, fibre: usize) -> Lane<L> {
        self.stretch[fibre].map(|stretch| stretch - 1.0)
    }

    /// Engineering stresses, of any law: ∂W/∂λ_I and ∂W/∂γ where W depends on λ₁², λ₂² and f₁·f₂ = m₁ m₂ sin γ.
    pub(super) fn stresses(&self, stress: &Stress<L>) -> Stresses<L> {
        let mut out = Stresses { md: splat(0.0), td: splat(0.0), shear: splat(0.0) };
        for l in 0..L {
            let along = |fibre: usize| {
                let stretch = self.stretch[fibre][l];
                let sheared = if stretch > 1.0 { self.sine[l] / self.inverse[1 - fibre][l] } else { 0.0 };
                stress.tension[fibre][l] * stretch + stress.cross[l] * sheared
            };
            (out.md[l], out.td[l]) = (along(0), along(1));
            out.shear[l] = stress.cross[l] / (self.inverse[0][l] * self.inverse[1][l] * self.secant[l]);
        }
        out
    }

    /// Stress of fibres with the engineering stresses `md`, `td` and `shear`, Pa.
    #[inline(always)]
    fn stress(&self, d: &Deformation<L>, md: &Lane<L>, td: &Lane<L>, shear: &Lane<L>) -> Stress<L> {
        let mut tension = [splat(0.0); 2];
        let mut cross = splat(0.0);
        for l in 0..L {
            let [r1, r2] = [self.inverse[0][l], self.inverse[1][l]];
            let shear = shear[l].copysign(self.angle[l]) * self.secant[l];
            cross[l] = shear * r1 * r2;
            let taut1 = if self.stretch[0][l] > 1.0 { r1 * r1 } else { 0.0 };
            let taut2 = if self.stretch[1][l] > 1.0 { r2 * r2 } else { 0.0 };
            tension[0][l] = md[l] * r1 - shear * self.sine[l] * taut1;
            tension[1][l] = td[l] * r2 - shear * self.sine[l] * taut2;
        }
        let [f1, f2] = &d.f;
        Stress { p: [combine(&tension[0], f1, &cross, f2), combine(&tension[1], f2, &cross, f1)], tension, cross }
    }
}

impl<F: FibreLaw> MembraneLaw for Fabric<F> {
    type History<const L: usize> = PointHistory<F::History<L>, L>;

    #[inline(always)]
    fn stress<const L: usize>(&self, d: &Deformation<L>, history: &mut Self::History<L>, dt: f64) -> Stress<L> {
        let fibres = Fibres::of(d);
        let [history_md, history_td] = &mut history.fibres;
        let md = self.md.stress(&self.absorption, &fibres.strain(0), history_md, dt);
        let td = self.td.stress(&self.absorption, &fibres.strain(1), history_td, dt);
        let shear = self.absorption.stress(&self.shear, &fibres.angle.map(f64::abs), &mut history.shear);
        let [md, td, shear] = of_layers_left([md, td, shear], &history.left);
        fibres.stress(d, &md, &td, &shear)
    }

    #[inline(always)]
    fn energy<const L: usize>(&self, d: &Deformation<L>, history: &Self::History<L>) -> Energy<L> {
        let fibres = Fibres::of(d);
        let parts = [
            self.md.energy(&self.absorption, &fibres.strain(0), &history.fibres[0]),
            self.td.energy(&self.absorption, &fibres.strain(1), &history.fibres[1]),
            self.absorption.energy(&self.shear, &fibres.angle.map(f64::abs), &history.shear),
        ];
        let [stored, absorbed] = [parts.map(|part| part.0), parts.map(|part| part.1)];
        let (stored, absorbed) = (of_layers_left(stored, &history.left), of_layers_left(absorbed, &history.left));
        let mut total = Energy { stored: splat(0.0), absorbed: splat(0.0) };
        for (stored, absorbed) in stored.iter().zip(&absorbed) {
            for l in 0..L {
                total.stored[l] += stored[l];
                total.absorbed[l] += absorbed[l];
            }
        }
        total
    }

    #[inline(always)]
    fn stiffness<const L: usize>(&self, d: &Deformation<L>, history: &Self::History<L>) -> Stiffness<L> {
        /// Change of strain for which the bound holds.
        const REACH: f64 = 0.005;
        let fibres = Fibres::of(d);
        let angle = fibres.angle.map(f64::abs);
        let md = self.md.stress_near(&self.absorption, &fibres.strain(0), &history.fibres[0]);
        let td = self.td.stress_near(&self.absorption, &fibres.strain(1), &history.fibres[1]);
        let shear_stress = self.absorption.stress(&self.shear, &angle, &mut history.shear.clone());
        let [md, td, shear_stress] = of_layers_left([md, td, shear_stress], &history.left);
        let across = fibres.stress(d, &md, &td, &shear_stress).tension.map(|t| t.map(f64::abs));
        let slopes = [
            self.md.largest_slope(&self.absorption, &fibres.strain(0), &history.fibres[0], REACH),
            self.td.largest_slope(&self.absorption, &fibres.strain(1), &history.fibres[1], REACH),
            self.absorption.largest_slope(&self.shear, &angle, &history.shear, REACH),
        ];
        let [md, td, mut shear] = of_layers_left(slopes, &history.left);
        let mut along = [md, td];
        let mut largest = angle;
        for l in 0..L {
            largest[l] = larger(angle[l], history.shear[l]);
        }
        let [_, _, stress] = of_layers_left([md, td, self.shear.stress_lanes(&largest)], &history.left);
        for l in 0..L {
            along[0][l] = larger(along[0][l] - across[0][l], 0.0);
            along[1][l] = larger(along[1][l] - across[1][l], 0.0);
            let secant = fibres.secant[l];
            shear[l] = shear[l] * secant * secant + stress[l] * secant * (secant * secant + 3.0);
        }
        Stiffness { along, across, shear, alignment: fibres.sine }
    }

    /// Undefined: the curves are of the stress-free cross-section and do not include the change of thickness.
    fn thickness_ratio<const L: usize>(&self, _stress: &Stress<L>) -> Lane<L> {
        splat(f64::NAN)
    }

    fn moduli(&self) -> [f64; 2] {
        [self.md.initial_slope(), self.td.initial_slope()]
    }

    #[inline(always)]
    fn break_strains<const L: usize>(&self, history: &Self::History<L>) -> [Lane<L>; 2] {
        let first = self.layer_breaks.first();
        let limits = [self.md.break_strain(&history.fibres[0]), self.td.break_strain(&history.fibres[1])];
        limits.map(|limit| limit.map(|strain| strain * first))
    }

    fn share_left(&self, ratio: f64) -> f64 {
        self.layer_breaks.share_left(ratio)
    }

    fn break_range(&self) -> [[f64; 2]; 2] {
        let ([md, longest_md], [td, longest_td]) = (self.md.break_strains(), self.td.break_strains());
        let last = self.layer_breaks.last();
        [[md, td], [last * longest_md, last * longest_td]]
    }
}

/// Values of one layer along MD, along TD and in shear as means over all layers: those in which one set of fibres is
/// broken carry no shear.
#[inline(always)]
fn of_layers_left<const L: usize>([mut md, mut td, mut shear]: [Lane<L>; 3], left: &[Lane<L>; 2]) -> [Lane<L>; 3] {
    for l in 0..L {
        md[l] *= left[0][l];
        td[l] *= left[1][l];
        shear[l] *= smaller(left[0][l], left[1][l]);
    }
    [md, td, shear]
}

/// a·u + b·v in each lane.
#[inline(always)]
fn combine<const L: usize>(a: &Lane<L>, u: &Lane3<L>, b: &Lane<L>, v: &Lane3<L>) -> Lane3<L> {
    let mut out = [splat(0.0); 3];
    for axis in 0..3 {
        for l in 0..L {
            out[axis][l] = a[l] * u[axis][l] + b[l] * v[axis][l];
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::History;

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
            assert!((Fibres::<1>::of(&f.into()).angle[0] - expected).abs() < 2e-15, "at {sine}");
        }
    }

    /// In pure tension the first Piola–Kirchhoff stress is the engineering stress of the curve.
    #[test]
    fn uniaxial_stress_is_that_of_the_curve() {
        let md = Curve::new(vec![[0.26, 8.4e6], [0.84, 20e6], [1.39, 29.3e6]]).unwrap();
        let td = Curve::new(vec![[0.33, 8e6], [0.69, 10e6], [7.01, 16.2e6]]).unwrap();
        let film = Fabric::new(md.clone(), td.clone(), Curve::new(vec![[1.0, 1e7]]).unwrap(), 0.9);
        for strain in [0.1, 0.26, 0.5, 1.0, 1.39] {
            let f = [[1.0 + strain, 0.0, 0.0], [0.0, 1.0, 0.0]].map(|v| v.map(|x| [x]));
            assert!(
                (film.stress(&f.into(), &mut History::virgin(), 0.0).p[0][0][0] / md.stress(strain) - 1.0).abs()
                    < 1e-14
            );
            let f = [[1.0, 0.0, 0.0], [0.0, 1.0 + strain, 0.0]].map(|v| v.map(|x| [x]));
            assert!(
                (film.stress(&f.into(), &mut History::virgin(), 0.0).p[1][1][0] / td.stress(strain) - 1.0).abs()
                    < 1e-14
            );
        }
    }
}
