//! Logarithmic strain in the plane and the stress that does work on it.
//!
//! `E = ½ ln C` and `S = T : 2 ∂E/∂C` without principal directions, which equal stretches do not have (theory.md,
//! equation 250). With the mean `m` and the deviator `q = (½(C₁₁ − C₂₂), C₁₂)` of C, its radius `ρ = |q|`, `r =
//! ρ/m`:
//!
//! ```text
//! A = artanh(r)/r ,   B = (1/(1 − r²) − A)/r²
//! E = ¼ ln det C ± ½ A/m q
//! S = (m t − d·q)/det C ± [ A/m d + ( B/m³ d·q − t/det C ) q ]       of T = t ± d
//! ```
//!
//! where `± x` is the deviator with the components x₁, −x₁ and x₂. A and B are even and smooth in r.

use crate::lane::{Lane, lanes, ln, splat};
use crate::material::elastic::Plane;

/// Logarithmic strain, and what derives from C.
pub(super) struct Logarithm<const L: usize> {
    /// E₁₁, E₂₂ and E₁₂.
    pub(super) strain: Plane<L>,
    /// m.
    mean: Lane<L>,
    /// q.
    deviator: [Lane<L>; 2],
    /// ρ.
    radius: Lane<L>,
    /// 1/det C.
    per_det: Lane<L>,
    /// A/m.
    across: Lane<L>,
    /// B/m³.
    bent: Lane<L>,
}

/// Denominators of artanh(t)/t = 1 + t²/3 + t⁴/5 + …, after 1/21; what is left out is below 1e-17 for |t| < 0.172.
const SERIES: [f64; 9] = [19.0, 17.0, 15.0, 13.0, 11.0, 9.0, 7.0, 5.0, 3.0];

impl<const L: usize> Logarithm<L> {
    /// Of C₁₁, C₂₂ and C₁₂.
    #[inline(always)]
    pub(super) fn from_cauchy_green(c: &Plane<L>) -> Logarithm<L> {
        let nothing = splat::<L>(0.0);
        let mut out = Logarithm {
            strain: [nothing; 3],
            mean: nothing,
            deviator: [nothing; 2],
            radius: nothing,
            per_det: nothing,
            across: nothing,
            bent: nothing,
        };
        let mut det = splat::<L>(0.0);
        for l in 0..L {
            let (mean, apart) = (0.5 * (c[0][l] + c[1][l]), 0.5 * (c[0][l] - c[1][l]));
            det[l] = c[0][l] * c[1][l] - c[2][l] * c[2][l];
            out.mean[l] = mean;
            out.deviator[0][l] = apart;
            out.deviator[1][l] = c[2][l];
            // Not `hypot`, whose bits differ between platforms and which is no vector instruction.
            out.radius[l] = (apart * apart + c[2][l] * c[2][l]).sqrt();
            out.per_det[l] = 1.0 / det[l];
        }
        for l in 0..L {
            let (mean, radius) = (out.mean[l], out.radius[l]);
            let per_mean = 1.0 / mean;
            let r = radius * per_mean;
            // c₁; c₂ is det C over it, since mean − radius would lose all digits of a small c₂.
            let first = mean + radius;
            // c₁/c₂ = 2ⁿ k with √½ ≤ k < √2, so that artanh r = ½ n ln 2 + artanh t; t is r itself where n is zero.
            const ROOT_HALF: u64 = std::f64::consts::FRAC_1_SQRT_2.to_bits();
            let ratio = first * first * out.per_det[l];
            // Subtracting √½ before the shift rounds to the nearest power: n by integer instructions, in all lanes
            // alike.
            let exponent = (ratio.to_bits().wrapping_sub(ROOT_HALF) as i64) >> 52;
            let power = f64::from_bits((exponent.wrapping_add(1023) as u64) << 52);
            let second = power * (det[l] / first);
            // Near equal stretches r itself is the exact argument: c₁ − c₂ would be a difference of equals.
            let is_near = exponent == 0;
            let t = if is_near { r } else { (first - second) / (first + second) };
            let square = t * t;
            let mut series = 1.0 / 21.0;
            for odd in SERIES {
                series = 1.0 / odd + square * series;
            }
            // (artanh(t)/t − 1)/t² and artanh(t)/t.
            let (second_part, whole) = (series, 1.0 + square * series);
            let far = (0.5 * std::f64::consts::LN_2 * f64::from(exponent as i32) + t * whole) / r;
            let a = if is_near { whole } else { far };
            let inverse = mean * mean * out.per_det[l];
            // B: the difference over r² cancels as r → 0, where the series has it term by term.
            let b = if is_near { inverse - second_part } else { (inverse - a) / (r * r) };
            out.across[l] = a * per_mean;
            out.bent[l] = b * per_mean * per_mean * per_mean;
        }
        for l in 0..L {
            // Mean of the principal E by the determinant: ln c₁ + ln c₂ without either of them.
            let mean = 0.25 * ln(det[l]);
            let apart = 0.5 * out.across[l] * out.deviator[0][l];
            out.strain[0][l] = mean + apart;
            out.strain[1][l] = mean - apart;
            out.strain[2][l] = 0.5 * out.across[l] * out.deviator[1][l];
        }
        out
    }

    /// Second Piola–Kirchhoff stress S of the stress T that does work on E.
    #[inline(always)]
    pub(super) fn second_piola(&self, t: &Plane<L>) -> Plane<L> {
        let mut s = [splat(0.0); 3];
        for l in 0..L {
            let (mean, apart, shear) = (0.5 * (t[0][l] + t[1][l]), 0.5 * (t[0][l] - t[1][l]), t[2][l]);
            let [q, w] = [self.deviator[0][l], self.deviator[1][l]];
            // d·q of the deviators as two components.
            let along = apart * q + shear * w;
            let level = (mean * self.mean[l] - along) * self.per_det[l];
            let turned = self.bent[l] * along - mean * self.per_det[l];
            let deviator = self.across[l] * apart + turned * q;
            s[0][l] = level + deviator;
            s[1][l] = level - deviator;
            s[2][l] = self.across[l] * shear + turned * w;
        }
        s
    }

    /// Bound on the eigenvalues of the second derivative by F of the energy ½ E_e·T with the moduli `plane` = Y/(1 −
    /// ν²) and `shear` = G (Pa), at the stress T = t ± d: of `d²W = dE·ℂ dE + T·d²E`
    ///
    /// ```text
    /// max { a + τ/c₂ , G θ² (c₁ + c₂) + τ (1/c₂ + 2 (φ₁ + φ₂)(c₁ + c₂)) } + |d| (θ + 4 √((c₁ + c₂)(φ₁² c₁ + φ₂² c₂)))
    /// a = Y/(1 − ν²) ( ½ (1/c₁ + 1/c₂) + √(¼ (1/c₁ − 1/c₂)² + ν²/det C) ) ,   τ = |t| + |d|
    /// θ = ln(c₁/c₂)/(c₁ − c₂) = A/m ,   φ₁,₂ = ¼ (1/det C ∓ B ρ/m³)
    /// ```
    ///
    /// with the eigenvalues c₁ ≥ c₂ of C.
    #[inline(always)]
    pub(super) fn bound(&self, t: &Plane<L>, [plane, poisson, shear]: [f64; 3]) -> Lane<L> {
        let mut out = splat(0.0);
        for l in 0..L {
            let (mean, apart) = (0.5 * (t[0][l] + t[1][l]), 0.5 * (t[0][l] - t[1][l]));
            let cross = (apart * apart + t[2][l] * t[2][l]).sqrt();
            // Largest size of a principal stress: the bound must hold for tension and compression.
            let most = mean.abs() + cross;
            let (sum, radius) = (2.0 * self.mean[l], self.radius[l]);
            let (first, second) = (1.0 / (self.mean[l] + radius), (self.mean[l] + radius) * self.per_det[l]);
            // Y/(1 − ν²) (1/c₁, ν/√(c₁c₂); ·, 1/c₂).
            let (middle, half) = (0.5 * (first + second), 0.5 * (second - first));
            let between = poisson * poisson * self.per_det[l];
            let stretched = plane * (middle + (half * half + between).sqrt());
            let theta = self.across[l];
            let sheared = shear * theta * theta * sum;
            let bent = self.bent[l] * radius;
            let [first, last] = [0.25 * (self.per_det[l] - bent), 0.25 * (self.per_det[l] + bent)];
            let c = [self.mean[l] + radius, 1.0 / second];
            let coupling = (sum * (first * first * c[0] + last * last * c[1])).sqrt();
            let sideways = second + 2.0 * sum * (first + last);
            let (one, other) = (stretched + most * second, sheared + most * sideways);
            // A NaN must propagate.
            let larger = if one <= other { other } else { one };
            out[l] = larger + cross * (theta + 4.0 * coupling);
        }
        out
    }
}

/// T₁₁ + T₂₂ of the stress S at C: their scalar product.
#[inline(always)]
pub(super) fn trace<const L: usize>(c: &Plane<L>, s: [&Lane<L>; 3]) -> Lane<L> {
    lanes(|l| c[0][l] * s[0][l] + c[1][l] * s[1][l] + 2.0 * c[2][l] * s[2][l])
}
