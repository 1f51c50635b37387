//! Shear of a square of film that is stretched along its diagonal (equations 4 to 8).
//!
//! The four sides keep their length while the square becomes a rhombus with the angle ψ at the stretched corners.

use std::f64::consts::{FRAC_PI_2, SQRT_2};

use super::Curve;
use super::curve::lengths;
use crate::Error;

/// A square of film, unstretched.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Square {
    /// Side L, m.
    pub side: f64,
    /// Thickness h, m.
    pub thickness: f64,
}

/// Shear of the stretched square.
#[derive(Clone, Debug, PartialEq)]
pub struct Shear {
    /// Shear stress τ (Pa) over the shear angle γ (rad).
    pub curve: Curve,
    /// How many samples lay beyond the displacement that the square can follow; they are cut off.
    pub cut: usize,
}

impl Square {
    /// The square whose diagonal √2 L is `diagonal` (m).
    pub fn with_diagonal(diagonal: f64, thickness: f64) -> Square {
        Square { side: diagonal / SQRT_2, thickness }
    }

    /// Length √2 L of the diagonal, m.
    pub fn diagonal(&self) -> f64 {
        SQRT_2 * self.side
    }

    /// Displacement (2 − √2) L at which the rhombus is a line, cos ψ/2 = 1, m.
    pub fn limit(&self) -> f64 {
        (2.0 - SQRT_2) * self.side
    }

    /// Shear angle γ (5) and shear stress τ (Pa, 7) at the `force` F₃ (N) and the `displacement` d (m) of the diagonal:
    /// cos ψ/2 = (√2 L + d)/(2L) (6), γ = π/2 − ψ (5), Q = F₃/(2 cos ψ/2) (4), τ = Q/(L h) (7).
    ///
    /// None beyond [`Square::limit`].
    pub fn state(&self, force: f64, displacement: f64) -> Option<[f64; 2]> {
        if displacement > self.limit() {
            return None;
        }
        let cosine = ((self.diagonal() + displacement) / (2.0 * self.side)).min(1.0);
        let side_force = force / (2.0 * cosine);
        Some([FRAC_PI_2 - 2.0 * cosine.acos(), side_force / (self.side * self.thickness)])
    }

    /// The shear curve of a recording; samples beyond [`Square::limit`] are cut off and counted.
    pub fn shear(&self, force: &[f64], displacement: &[f64]) -> Result<Shear, Error> {
        if force.len() != displacement.len() {
            return Err(lengths(displacement.len(), force.len()));
        }
        let states = force.iter().zip(displacement).map_while(|(force, d)| self.state(*force, *d));
        let (angle, stress) = states.map(|[angle, stress]| (angle, stress)).unzip::<_, _, Vec<_>, Vec<_>>();
        let cut = force.len() - angle.len();
        Ok(Shear { curve: Curve::new(angle, stress)?, cut })
    }
}

impl Shear {
    /// Resultant shear stress τ_h = τ h (N/m) over γ, sample by sample (equation 8).
    pub fn resultant(&self, thickness: f64) -> Vec<f64> {
        self.curve.resultant(thickness)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SQUARE: Square = Square { side: 0.1, thickness: 12e-6 };

    #[test]
    fn the_square_at_rest_is_not_sheared() {
        let [angle, stress] = SQUARE.state(1.0, 0.0).unwrap();
        // Q = F/√2 on the side: equilibrium of a corner with two sides at 45 degrees.
        assert!(angle.abs() < 1e-15);
        assert!((stress / (1.0 / SQRT_2 / (0.1 * 12e-6)) - 1.0).abs() < 1e-14);
    }

    #[test]
    fn a_third_of_the_right_angle_left_is_sheared_by_the_rest() {
        // ψ = 60°: the diagonal is √3 L.
        let [angle, stress] = SQUARE.state(3.0, (3.0_f64.sqrt() - SQRT_2) * 0.1).unwrap();
        assert!((angle - 30.0_f64.to_radians()).abs() < 1e-14);
        assert!((stress * 12e-6 * 0.1 - 3.0 / 3.0_f64.sqrt()).abs() < 1e-14);
    }

    /// Virtual work: F dd = τ h A dγ for every d, on the rhombus' present area A = L² cos γ.
    #[test]
    fn stress_and_angle_do_the_work_of_the_force() {
        for part in [0.1, 0.4, 0.8] {
            let (d, step) = (part * SQUARE.limit(), 1e-8);
            let [before, after] = [d - step, d + step].map(|d| SQUARE.state(7.0, d).unwrap()[0]);
            let [angle, stress] = SQUARE.state(7.0, d).unwrap();
            let work = stress * 12e-6 * 0.1 * 0.1 * angle.cos() * (after - before);
            assert!((work / (7.0 * 2.0 * step) - 1.0).abs() < 1e-6, "{part}: {work}");
        }
    }

    #[test]
    fn beyond_the_closed_rhombus_the_curve_is_cut_and_that_is_counted() {
        let d: Vec<f64> = (0..=10).map(|i| 0.01 * f64::from(i)).collect();
        let sheared = SQUARE.shear(&[1.0; 11], &d).unwrap();
        assert!((SQUARE.limit() - 0.0585786).abs() < 1e-7);
        assert_eq!((sheared.curve.strain().len(), sheared.cut), (6, 5));
        let closed = Square::with_diagonal(5e-3, 12e-6);
        let [angle, _] = closed.state(1.0, closed.limit()).unwrap();
        assert!((angle - FRAC_PI_2).abs() < 1e-7);
    }
}
