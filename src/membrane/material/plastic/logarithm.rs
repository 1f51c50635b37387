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

use crate::lane::{Lane, exponent, splat};
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
        let (mean, apart) = (0.5 * (c[0] + c[1]), 0.5 * (c[0] - c[1]));
        let det = c[0] * c[1] - c[2] * c[2];
        // Not `hypot`, whose bits differ between platforms and which is no vector instruction.
        let radius = (apart * apart + c[2] * c[2]).sqrt();
        let (per_det, per_mean) = (1.0 / det, 1.0 / mean);
        let r = radius * per_mean;
        // c₁; c₂ is det C over it, since mean − radius would lose all digits of a small c₂.
        let first = mean + radius;
        // c₁/c₂ = 2ⁿ k with √½ ≤ k < √2, so that artanh r = ½ n ln 2 + artanh t; t is r itself where n is zero.
        let ratio = first * first * per_det;
        let [mut n, mut power] = [splat(0.0); 2];
        for l in 0..L {
            let exponent = exponent(ratio[l]);
            n[l] = f64::from(exponent as i32);
            power[l] = f64::from_bits((exponent.wrapping_add(1023) as u64) << 52);
        }
        let second = power * (det / first);
        // Near equal stretches r itself is the exact argument: c₁ − c₂ would be a difference of equals.
        let is_near = n.equals(0.0);
        let t = is_near.select(r, (first - second) / (first + second));
        let square = t * t;
        let mut series = splat(1.0 / 21.0);
        for odd in SERIES {
            series = 1.0 / odd + square * series;
        }
        // (artanh(t)/t − 1)/t² and artanh(t)/t.
        let (second_part, whole) = (series, 1.0 + square * series);
        let a = is_near.select(whole, (0.5 * std::f64::consts::LN_2 * n + t * whole) / r);
        let inverse = mean * mean * per_det;
        // B: the difference over r² cancels as r → 0, where the series has it term by term.
        let b = is_near.select(inverse - second_part, (inverse - a) / (r * r));
        let (across, bent) = (a * per_mean, b * per_mean * per_mean * per_mean);
        // Mean of the principal E by the determinant: ln c₁ + ln c₂ without either of them.
        let (level, deviator) = (0.25 * det.ln(), 0.5 * across * apart);
        let strain = [level + deviator, level - deviator, 0.5 * across * c[2]];
        Logarithm { strain, mean, deviator: [apart, c[2]], radius, per_det, across, bent }
    }

    /// Second Piola–Kirchhoff stress S of the stress T that does work on E.
    #[inline(always)]
    pub(super) fn second_piola(&self, t: &Plane<L>) -> Plane<L> {
        let (mean, apart, shear) = (0.5 * (t[0] + t[1]), 0.5 * (t[0] - t[1]), t[2]);
        let [q, w] = self.deviator;
        // d·q of the deviators as two components.
        let along = apart * q + shear * w;
        let level = (mean * self.mean - along) * self.per_det;
        let turned = self.bent * along - mean * self.per_det;
        let deviator = self.across * apart + turned * q;
        [level + deviator, level - deviator, self.across * shear + turned * w]
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
        let (mean, apart) = (0.5 * (t[0] + t[1]), 0.5 * (t[0] - t[1]));
        let cross = (apart * apart + t[2] * t[2]).sqrt();
        // Largest size of a principal stress: the bound must hold for tension and compression.
        let most = mean.abs() + cross;
        let (sum, larger) = (2.0 * self.mean, self.mean + self.radius);
        let (first, second) = (1.0 / larger, larger * self.per_det);
        // Y/(1 − ν²) (1/c₁, ν/√(c₁c₂); ·, 1/c₂).
        let (middle, half) = (0.5 * (first + second), 0.5 * (second - first));
        let between = poisson * poisson * self.per_det;
        let stretched = plane * (middle + (half * half + between).sqrt());
        let theta = self.across;
        let sheared = shear * theta * theta * sum;
        let bent = self.bent * self.radius;
        let [phi1, phi2] = [0.25 * (self.per_det - bent), 0.25 * (self.per_det + bent)];
        let coupling = (sum * (phi1 * phi1 * larger + phi2 * phi2 * (1.0 / second))).sqrt();
        let sideways = second + 2.0 * sum * (phi1 + phi2);
        let (stretched, sheared) = (stretched + most * second, sheared + most * sideways);
        // A NaN must propagate.
        let largest = stretched.at_most(sheared).select(sheared, stretched);
        largest + cross * (theta + 4.0 * coupling)
    }
}

/// T₁₁ + T₂₂ of the stress S at C: their scalar product.
#[inline(always)]
pub(super) fn trace<const L: usize>(c: &Plane<L>, s: &Plane<L>) -> Lane<L> {
    c[0] * s[0] + c[1] * s[1] + 2.0 * c[2] * s[2]
}
