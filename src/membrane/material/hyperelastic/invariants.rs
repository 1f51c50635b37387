//! Energies of `I = c₁ + c₂` and `D = c₁c₂`, the trace and the determinant of C.
//!
//! Neo-Hookean, Mooney–Rivlin and Yeoh, incompressible, with `λ₃² = 1/D`, `I₁ = I + 1/D` and `I₂ = D + I/D` (theory.md,
//! equation 221):
//!
//! ```text
//! W = c₁₀ (I₁ − 3) + c₂₀ (I₁ − 3)² + c₃₀ (I₁ − 3)³ + c₀₁ (I₂ − 3)
//! ∂W/∂I = A + c₀₁/D ,   ∂W/∂D = −A/D² + c₀₁ (1 − I/D²) ,   A = ∂W/∂I₁
//! ```
//!
//! Gent, incompressible: chains of a largest length (Gent, Rubber Chem. Technol. 69, 1996), with `x = I₁ − 3` (theory.md,
//! equation 222). At `x = J_m` and beyond there is no energy and no stress: both are NaN.
//!
//! ```text
//! W = −½ μ J_m ln(1 − x/J_m) ,   A = ∂W/∂I₁ = ½ μ J_m/(J_m − x)
//! ```
//!
//! Neo-Hookean with a volume that changes, with `J = √D λ₃`, `x = λ₃²`, `k = λ/(2μ) = ν/(1 − 2ν)` (theory.md, equation
//! 224):
//!
//! ```text
//! W = ½ μ (I + x − 3) − μ ln J + ½ λ ln² J
//! ∂W/∂λ₃ = 0 :  x − 1 + k (ln x + ln D) = 0
//! ∂W/∂I = ½ μ ,   ∂W/∂D = −½ μ x/D ,   ∂²W/∂D² = ½ μ x/D² (1 + k/(x + k))
//! ```

use serde::{Deserialize, Serialize};

use super::{NEAR, Principal, StrainEnergy, Tangent};
use crate::lane::{Lane, at, each, exp, lanes, larger, ln, smaller};
use crate::material::{Deformation, Stress};

/// I and D of C₁₁, C₂₂ and C₁₂.
#[inline(always)]
fn of_metric([c11, c22, c12]: [f64; 3]) -> [f64; 2] {
    [c11 + c22, c11 * c22 - c12 * c12]
}

/// I and D of the principal squares.
#[inline(always)]
fn of_squares([c1, c2]: [f64; 2]) -> [f64; 2] {
    [c1 + c2, c1 * c2]
}

/// S = 2 ∂W/∂I + 2 ∂W/∂D cof C of the slopes ∂W/∂I and ∂W/∂D (Pa).
#[inline(always)]
fn plane_stress([c11, c22, c12]: [f64; 3], [by_trace, by_det]: [f64; 2]) -> [f64; 3] {
    [2.0 * (by_trace + by_det * c22), 2.0 * (by_trace + by_det * c11), -2.0 * by_det * c12]
}

/// S₁ and S₂ of these slopes.
#[inline(always)]
fn stress([c1, c2]: [f64; 2], [by_trace, by_det]: [f64; 2]) -> [f64; 2] {
    [2.0 * (by_trace + by_det * c2), 2.0 * (by_trace + by_det * c1)]
}

/// The derivatives by the stretches of these slopes and of ∂²W/∂I², ∂²W/∂I∂D and ∂²W/∂D².
#[inline(always)]
fn tangent([c1, c2]: [f64; 2], slopes: [f64; 2], [trace, mixed, det]: [f64; 3]) -> Tangent {
    let stress = stress([c1, c2], slopes);
    let second = |other: f64| trace + other * (2.0 * mixed + other * det);
    let along = [stress[0] + 4.0 * c1 * second(c2), stress[1] + 4.0 * c2 * second(c1)];
    let product = c1 * c2;
    let cross = trace + mixed * (c1 + c2) + det * product + slopes[1];
    Tangent { stress, along, between: 4.0 * product.sqrt() * cross, shear: -2.0 * slopes[1] }
}

/// Coefficients of Neo-Hookean, Mooney–Rivlin and Yeoh film.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Polynomial {
    /// c₁₀, c₂₀ and c₃₀, Pa.
    pub first: [f64; 3],
    /// c₀₁, Pa.
    pub second: f64,
}

impl Polynomial {
    /// The neo-Hookean energy with the shear modulus `mu` (Pa).
    pub fn neo_hookean(mu: f64) -> Polynomial {
        Polynomial { first: [0.5 * mu, 0.0, 0.0], second: 0.0 }
    }

    /// The energy of Mooney and Rivlin, coefficients in Pa.
    pub fn mooney_rivlin(c10: f64, c01: f64) -> Polynomial {
        Polynomial { first: [c10, 0.0, 0.0], second: c01 }
    }

    /// The energy of Yeoh, coefficients in Pa.
    pub fn yeoh(first: [f64; 3]) -> Polynomial {
        Polynomial { first, second: 0.0 }
    }

    #[inline(always)]
    fn slopes(&self, [trace, det]: [f64; 2]) -> [f64; 2] {
        let [c10, c20, c30] = self.first;
        let inverse = 1.0 / det;
        let x = trace + inverse - 3.0;
        let a = c10 + x * (2.0 * c20 + x * (3.0 * c30));
        let square = inverse * inverse;
        [a + self.second * inverse, self.second * (1.0 - trace * square) - a * square]
    }
}

impl StrainEnergy for Polynomial {
    #[inline(always)]
    fn energy(&self, c: [f64; 2]) -> f64 {
        let ([trace, det], [c10, c20, c30]) = (of_squares(c), self.first);
        let x = trace + 1.0 / det - 3.0;
        let y = det + trace / det - 3.0;
        x * (c10 + x * (c20 + x * c30)) + self.second * y
    }

    #[inline(always)]
    fn stress(&self, c: [f64; 2]) -> [f64; 2] {
        stress(c, self.slopes(of_squares(c)))
    }

    #[inline(always)]
    fn plane_stress(&self, c: [f64; 3]) -> [f64; 3] {
        plane_stress(c, self.slopes(of_metric(c)))
    }

    #[inline(always)]
    fn tangent(&self, c: [f64; 2]) -> Tangent {
        let ([trace, det], [_, c20, c30]) = (of_squares(c), self.first);
        let slopes = self.slopes([trace, det]);
        let inverse = 1.0 / det;
        let (square, x) = (inverse * inverse, trace + inverse - 3.0);
        let a = slopes[0] - self.second * inverse;
        let bent = 2.0 * c20 + 6.0 * c30 * x;
        let by_det = square * (bent * square + 2.0 * inverse * (a + self.second * trace));
        tangent(c, slopes, [bent, -(bent + self.second) * square, by_det])
    }

    fn plane_modulus(&self) -> f64 {
        8.0 * (self.first[0] + self.second)
    }
}

/// Coefficients of Gent's energy.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Gent {
    /// Shear modulus μ, Pa.
    pub mu: f64,
    /// J_m, the limit of I₁ − 3.
    pub jm: f64,
}

impl Gent {
    /// A; NaN at the limit and beyond.
    #[inline(always)]
    fn slope(&self, x: f64) -> f64 {
        let left = self.jm - x;
        0.5 * self.mu * self.jm / if left > 0.0 { left } else { f64::NAN }
    }

    #[inline(always)]
    fn slopes(&self, [trace, det]: [f64; 2]) -> [f64; 2] {
        let inverse = 1.0 / det;
        let a = self.slope(trace + inverse - 3.0);
        [a, -a * inverse * inverse]
    }
}

impl StrainEnergy for Gent {
    #[inline(always)]
    fn energy(&self, c: [f64; 2]) -> f64 {
        let [trace, det] = of_squares(c);
        let left = 1.0 - (trace + 1.0 / det - 3.0) / self.jm;
        let energy = -0.5 * self.mu * self.jm * ln(left);
        if left > 0.0 { energy } else { f64::NAN }
    }

    #[inline(always)]
    fn stress(&self, c: [f64; 2]) -> [f64; 2] {
        stress(c, self.slopes(of_squares(c)))
    }

    #[inline(always)]
    fn plane_stress(&self, c: [f64; 3]) -> [f64; 3] {
        plane_stress(c, self.slopes(of_metric(c)))
    }

    /// At the largest I₁ that strains within 0.5 % reach; NaN where that is the limit.
    #[inline(always)]
    fn tangent(&self, c: [f64; 2]) -> Tangent {
        let [trace, det] = of_squares(c);
        let inverse = 1.0 / det;
        let square = inverse * inverse;
        let growth = 2.0 * NEAR * ((c[0] - inverse).abs() + (c[1] - inverse).abs());
        let a = self.slope(trace + inverse - 3.0 + growth);
        let bent = 2.0 * a * a / (self.mu * self.jm);
        tangent(c, [a, -a * square], [bent, -bent * square, square * (bent * square + 2.0 * inverse * a)])
    }

    fn plane_modulus(&self) -> f64 {
        4.0 * self.mu
    }

    fn has_limit(&self) -> bool {
        true
    }
}

/// Moduli of small strain of Neo-Hookean film with a volume that changes.
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
fn thickness<const L: usize>(k: f64, log: &Lane<L>) -> [Lane<L>; 2] {
    let (mut x, mut y) = ([0.0; L], [0.0; L]);
    for l in 0..L {
        let compressed = ln(larger(1.0 - k * log[l], 1.0));
        y[l] = smaller(compressed, smaller(1.0 / k - log[l], -k * log[l] / (1.0 + k)));
    }
    for _ in 0..STEPS {
        for l in 0..L {
            x[l] = exp(y[l]);
            let value = x[l] - 1.0 + k * (y[l] + log[l]);
            let slope = x[l] + k;
            y[l] -= value * slope / (slope * slope - 0.5 * value * x[l]);
        }
    }
    [lanes(|l| exp(y[l])), y]
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

    /// x, and its logarithm, where D is `det` in each lane.
    #[inline(always)]
    pub(super) fn squared_thickness<const L: usize>(&self, det: impl Fn(usize) -> f64) -> [Lane<L>; 2] {
        thickness(self.ratio(), &lanes(|l| ln(det(l))))
    }

    /// ∂W/∂I and ∂W/∂D where the film has the squared thickness x.
    #[inline(always)]
    fn slopes(&self, det: f64, x: f64) -> [f64; 2] {
        let half = 0.5 * self.shear();
        [half, -half * x / det]
    }

    /// [`StrainEnergy::energy`] where the film has the squared thickness x, whose logarithm is y.
    #[inline(always)]
    fn energy_at(&self, c: [f64; 2], [x, y]: [f64; 2]) -> f64 {
        let [trace, det] = of_squares(c);
        let volume = 0.5 * (ln(det) + y);
        self.shear() * (0.5 * (trace + x - 3.0) + volume * (self.ratio() * volume - 1.0))
    }

    /// [`StrainEnergy::tangent`] where the film has the squared thickness x.
    #[inline(always)]
    fn tangent_at(&self, c: [f64; 2], x: f64) -> Tangent {
        let ([_, det], half, k) = (of_squares(c), 0.5 * self.shear(), self.ratio());
        let ratio = half * x / det;
        tangent(c, [half, -ratio], [0.0, 0.0, ratio / det * (1.0 + k / (x + k))])
    }

    /// n in each lane: x − 1 + 2k (ln x + ½ ln c₁) = 0, as width and thickness are equal.
    #[inline(always)]
    fn natural_widths<const L: usize>(&self, c1: &Lane<L>) -> Lane<L> {
        let [x, _] = thickness(2.0 * self.ratio(), &lanes(|l| 0.5 * ln(c1[l])));
        x
    }

    /// [`StrainEnergy::principal`] in each lane.
    #[inline(always)]
    fn principal_lanes<const WRINKLING: bool, const L: usize>(
        &self,
        d: &Deformation<L>,
    ) -> impl Fn(usize) -> Principal {
        let plain = |l: usize| Principal::from_cauchy_green(d.metric_at(l));
        let natural = if WRINKLING { self.natural_widths(&lanes(|l| plain(l).stretched())) } else { [0.0; L] };
        move |l| if WRINKLING { plain(l).relaxed(natural[l]) } else { plain(l) }
    }
}

/// Chains of logarithms and exponentials go stage by stage, so that a processor works on several lanes of each at a time.
impl StrainEnergy for CompressibleNeoHookean {
    fn energy(&self, c: [f64; 2]) -> f64 {
        self.energy_at(c, self.squared_thickness(|_| c[0] * c[1]).map(|[x]| x))
    }

    fn stress(&self, c: [f64; 2]) -> [f64; 2] {
        let ([_, det], [[x], _]) = (of_squares(c), self.squared_thickness(|_| c[0] * c[1]));
        stress(c, self.slopes(det, x))
    }

    fn tangent(&self, c: [f64; 2]) -> Tangent {
        let [[x], _] = self.squared_thickness(|_| c[0] * c[1]);
        self.tangent_at(c, x)
    }

    fn thickness(&self, c: [f64; 2]) -> f64 {
        let [[x], _] = self.squared_thickness(|_| c[0] * c[1]);
        x.sqrt()
    }

    fn natural_width(&self, c1: f64) -> f64 {
        self.natural_widths(&[c1])[0]
    }

    #[inline(always)]
    fn energy_lanes<const WRINKLING: bool, const L: usize>(&self, d: &Deformation<L>) -> Lane<L> {
        let principal = self.principal_lanes::<WRINKLING, L>(d);
        let x = self.squared_thickness::<L>(|l| principal(l).det());
        lanes(|l| self.energy_at(principal(l).squares, at(&x, l)))
    }

    #[inline(always)]
    fn stress_lanes<const WRINKLING: bool, const L: usize>(&self, d: &Deformation<L>) -> Stress<L> {
        if !WRINKLING {
            let c = d.metric();
            let [x, _] = self.squared_thickness::<L>(|l| of_metric(at(&c, l))[1]);
            let s: [Lane<L>; 3] = each(|l| plane_stress(at(&c, l), self.slopes(of_metric(at(&c, l))[1], x[l])));
            return Stress::of_second_piola(d, |l| at(&s, l));
        }
        let principal = self.principal_lanes::<WRINKLING, L>(d);
        let principal: [Lane<L>; 5] = each(|l| principal(l).into());
        let [x, _] = self.squared_thickness::<L>(|l| Principal::from(at(&principal, l)).det());
        let s: [Lane<L>; 3] = each(|l| {
            let principal = Principal::from(at(&principal, l));
            principal.turned(stress(principal.squares, self.slopes(principal.det(), x[l])))
        });
        Stress::of_second_piola(d, |l| at(&s, l))
    }

    #[inline(always)]
    fn bound_lanes<const WRINKLING: bool, const L: usize>(&self, d: &Deformation<L>) -> Lane<L> {
        let principal = self.principal_lanes::<WRINKLING, L>(d);
        let [x, _] = self.squared_thickness::<L>(|l| principal(l).det());
        lanes(|l| self.tangent_at(principal(l).squares, x[l]).largest(principal(l).squares))
    }

    fn poisson(&self) -> f64 {
        self.poisson
    }

    fn plane_modulus(&self) -> f64 {
        self.young / (1.0 - self.poisson * self.poisson)
    }
}
