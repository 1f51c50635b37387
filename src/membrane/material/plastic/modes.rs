//! Modes of stress that elasticity and yield do not couple.
//!
//! With the compliance `S` of plane stress and P of Hill's function, `P v = κ S v` has three modes `v_i` of stress with
//! `v_i·S v_j = δ_ij`; the third is shear. In the amplitudes `y_i = v_i·E` of an elastic strain `E` (theory.md,
//! equation 257)
//!
//! ```text
//! T = Σ v_i y_i ,   σ̄² = Σ κ_i y_i² ,   ½ E·T = ½ Σ y_i²
//! ```

use serde::{Deserialize, Serialize};

use super::Hill;
use crate::lane::Lane;
use crate::material::elastic::Plane;

/// Modes of a film.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Modes {
    /// Components 11 and 22 of v₁ and v₂, √Pa.
    normal: [[f64; 2]; 2],
    /// Component 12 of v₃, √Pa.
    shear: f64,
    /// κ_i, Pa.
    pub(super) stiffness: [f64; 3],
}

impl Modes {
    /// Modes of isotropic elasticity with Young's modulus `young` (Pa) and Hill's function.
    pub(super) fn new(young: f64, poisson: f64, hill: &Hill) -> Modes {
        // In (T₁₁ + T₂₂)/√2 and (T₁₁ − T₂₂)/√2 the compliance is diagonal; scaled by its roots, P is m.
        let root = [1.0 - poisson, 1.0 + poisson].map(|compliance| (young / compliance).sqrt());
        let [along, across] = hill.normal();
        let m11 = 0.5 * (along + across - 2.0 * hill.h) * root[0] * root[0];
        let m22 = 0.5 * (along + across + 2.0 * hill.h) * root[1] * root[1];
        let m12 = 0.5 * (along - across) * root[0] * root[1];
        // Jacobi's rotation.
        // The smaller angle of the two that make it diagonal, by a formula that does not cancel for small m₁₂.
        let tangent = if m12 == 0.0 {
            0.0
        } else {
            let slope = 0.5 * (m22 - m11) / m12;
            slope.signum() / (slope.abs() + (1.0 + slope * slope).sqrt())
        };
        let cosine = 1.0 / (1.0 + tangent * tangent).sqrt();
        let rotation = [[cosine, -tangent * cosine], [tangent * cosine, cosine]];
        let normal = rotation.map(|[mean, apart]| {
            let (mean, apart) = (mean * root[0], apart * root[1]);
            [mean + apart, mean - apart].map(|component| std::f64::consts::FRAC_1_SQRT_2 * component)
        });
        let shear = 0.5 * young / (1.0 + poisson);
        let stiffness = [m11 - tangent * m12, m22 + tangent * m12, 2.0 * hill.n * shear];
        Modes { normal, shear: shear.sqrt(), stiffness }
    }

    /// y_i of the components 11, 22 and 12 of an elastic strain.
    #[inline(always)]
    pub(super) fn amplitudes<const L: usize>(&self, strain: &Plane<L>) -> Plane<L> {
        let [first, second] = self.normal;
        [
            first[0] * strain[0] + first[1] * strain[1],
            second[0] * strain[0] + second[1] * strain[1],
            // Twice, as T₁₂ works on both E₁₂ and E₂₁.
            2.0 * self.shear * strain[2],
        ]
    }

    /// T of the amplitudes.
    #[inline(always)]
    pub(super) fn stress<const L: usize>(&self, amplitudes: &Plane<L>) -> Plane<L> {
        let [first, second] = self.normal;
        [
            first[0] * amplitudes[0] + second[0] * amplitudes[1],
            first[1] * amplitudes[0] + second[1] * amplitudes[1],
            self.shear * amplitudes[2],
        ]
    }

    /// κ_i y_i², whose sum is σ̄².
    #[inline(always)]
    pub(super) fn squares<const L: usize>(&self, amplitudes: &Plane<L>) -> Plane<L> {
        let ([a, b, c], [first, second, shear]) = (*amplitudes, self.stiffness);
        [first * a * a, second * b * b, shear * c * c]
    }

    /// ½ Σ y_i², J/m³.
    #[inline(always)]
    pub(super) fn stored<const L: usize>(&self, amplitudes: &Plane<L>) -> Lane<L> {
        let [a, b, c] = *amplitudes;
        0.5 * (a * a + b * b + c * c)
    }

    /// Least κ, Pa.
    pub(super) fn softest(&self) -> f64 {
        self.stiffness.into_iter().fold(f64::INFINITY, f64::min)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lane::splat;

    /// Stress, stored energy and yield function against plane stress and Hill's function as written.
    #[test]
    fn modes_are_elasticity_and_yield_function() {
        for (poisson, ratios) in
            [(0.45, [1.0; 3]), (0.3, [1.0, 0.8, 1.2]), (0.0, [0.3, 3.0, 2.0]), (-0.4, [5.0, 0.2, 0.7])]
        {
            let (young, hill) = (2e8, Hill::from_strain_ratios(ratios));
            let modes = Modes::new(young, poisson, &hill);
            for strain in [[0.01, 0.0, 0.0], [0.0, 0.02, 0.0], [0.0, 0.0, 0.01], [0.02, -0.015, 0.006]] {
                let amplitudes = modes.amplitudes::<1>(&strain.map(splat));
                let plane = young / (1.0 - poisson * poisson);
                let expected = [
                    plane * (strain[0] + poisson * strain[1]),
                    plane * (strain[1] + poisson * strain[0]),
                    young / (1.0 + poisson) * strain[2],
                ];
                let stress = modes.stress(&amplitudes);
                for i in 0..3 {
                    assert!((stress[i][0] - expected[i]).abs() < 1e-14 * young, "{stress:?} {expected:?}");
                }
                let [t1, t2, t3] = expected;
                let [along, across] = hill.normal();
                let square = along * t1 * t1 - 2.0 * hill.h * t1 * t2 + across * t2 * t2 + 2.0 * hill.n * t3 * t3;
                let found: f64 = modes.squares(&amplitudes).iter().map(|square| square[0]).sum();
                assert!((found / square - 1.0).abs() < 1e-13, "{found} {square}");
                let stored = 0.5 * (t1 * strain[0] + t2 * strain[1]) + t3 * strain[2];
                assert!((modes.stored(&amplitudes)[0] / stored - 1.0).abs() < 1e-13);
            }
            assert!(modes.softest() > 0.0);
        }
    }
}
