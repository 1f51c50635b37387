//! Hill's quadratic yield function of orthotropic film in plane stress (Hill, Proc. R. Soc. A 193, 1948).
//!
//! With MD, TD and the normal of the film as axes (theory.md, equations 253 and 254):
//!
//! ```text
//! σ̄² = (G + H) T₁₁² − 2H T₁₁T₂₂ + (F + H) T₂₂² + 2N T₁₂²  =  T·P T
//! ```

use serde::{Deserialize, Serialize};

/// Coefficients of Hill's yield function.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Hill {
    /// F.
    pub f: f64,
    /// G.
    pub g: f64,
    /// H.
    pub h: f64,
    /// N.
    pub n: f64,
}

impl Default for Hill {
    /// Hill's function that is von Mises'.
    fn default() -> Hill {
        Hill { f: 0.5, g: 0.5, h: 0.5, n: 1.5 }
    }
}

impl Hill {
    /// Hill's function of film with the plastic strain ratios `[r₀, r₄₅, r₉₀]` (width over thickness in uniaxial
    /// tension at these angles from MD) and the yield stress of the hardening along MD (theory.md, equation 255).
    pub fn from_strain_ratios([r0, r45, r90]: [f64; 3]) -> Hill {
        let g = 1.0 / (1.0 + r0);
        let h = r0 * g;
        let f = h / r90;
        Hill { f, g, h, n: (r45 + 0.5) * (f + g) }
    }

    /// Hill's function of film whose yield stresses along MD, TD and its normal are `[R₁₁, R₂₂, R₃₃]` times that of the
    /// hardening, and in shear `r12` times that of the hardening over √3 (theory.md, equation 256).
    pub fn from_stress_ratios(ratios: [f64; 3], r12: f64) -> Hill {
        let [first, second, third] = ratios.map(|ratio| 0.5 / (ratio * ratio));
        Hill { f: second + third - first, g: third + first - second, h: first + second - third, n: 1.5 / (r12 * r12) }
    }

    /// Whether the yield surface in plane stress is closed: P is positive definite.
    pub fn is_closed(&self) -> bool {
        let [along, across] = self.normal();
        along > 0.0 && across > 0.0 && along * across > self.h * self.h && self.n > 0.0
    }

    /// G + H and F + H.
    pub(super) fn normal(&self) -> [f64; 2] {
        [self.g + self.h, self.f + self.h]
    }

    /// Yield stress in uniaxial tension at `angle` (rad) from MD, over that of the hardening.
    pub fn stress_ratio(&self, angle: f64) -> f64 {
        let (c, s) = (angle.cos().powi(2), angle.sin().powi(2));
        let [along, across] = self.normal();
        1.0 / (along * c * c + across * s * s + 2.0 * (self.n - self.h) * c * s).sqrt()
    }

    /// Plastic strain ratio r (width over thickness) in uniaxial tension at `angle` (rad) from MD.
    pub fn strain_ratio(&self, angle: f64) -> f64 {
        let (c, s) = (angle.cos().powi(2), angle.sin().powi(2));
        (self.h + (2.0 * self.n - self.f - self.g - 4.0 * self.h) * s * c) / (self.f * s + self.g * c)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strain_ratios_are_those_written() {
        for ratios in [[1.0, 1.0, 1.0], [1.0, 0.8, 1.2], [0.4, 2.5, 3.0]] {
            let hill = Hill::from_strain_ratios(ratios);
            for (angle, ratio) in [0.0, 45.0_f64, 90.0].into_iter().zip(ratios) {
                assert!((hill.strain_ratio(angle.to_radians()) - ratio).abs() < 1e-14 * 10.0, "{angle}: {hill:?}");
            }
            assert!((hill.stress_ratio(0.0) - 1.0).abs() < 1e-15);
            assert!(hill.is_closed());
        }
        let mises = Hill::from_strain_ratios([1.0; 3]);
        assert_eq!(mises, Hill::default());
        assert_eq!(Hill::from_stress_ratios([1.0; 3], 1.0), mises);
    }

    /// One film described by both: the ratios of yield stress that follow from strain ratios give back its
    /// coefficients.
    #[test]
    fn stress_ratios_are_those_written() {
        let ratios = [1.1, 0.9, 0.95];
        let hill = Hill::from_stress_ratios(ratios, 1.05);
        let [along, across] = hill.normal();
        let of = [along.powf(-0.5), across.powf(-0.5), (hill.f + hill.g).powf(-0.5)];
        for (found, ratio) in of.into_iter().zip(ratios) {
            assert!((found - ratio).abs() < 1e-14, "{found} {ratio}");
        }
        assert!((hill.stress_ratio(std::f64::consts::FRAC_PI_2) - 0.9).abs() < 1e-14);
        // Pure shear along MD and TD: 2N τ² = σ².
        assert!(((1.0 / (2.0 * hill.n)).sqrt() - 1.05 / 3.0_f64.sqrt()).abs() < 1e-15);
    }

    #[test]
    fn an_open_surface_is_noticed() {
        // σ̄² = T₁₁² + T₂₂² + 4.25 T₁₁T₂₂ is negative in shear at 45°.
        let hill = Hill::from_stress_ratios([1.0, 1.0, 0.4], 1.0);
        assert!((hill.h + 2.125).abs() < 1e-15 && !hill.is_closed());
        assert!(Hill::from_stress_ratios([1.0, 1.0, 0.8], 1.0).is_closed());
        assert!(!Hill { n: 0.0, ..Hill::default() }.is_closed());
    }
}
