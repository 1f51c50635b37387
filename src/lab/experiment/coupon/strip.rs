//! The strip of film that is tested.

use super::curve::Curve;
use super::shear;
use crate::error::{Error, refusal};
use crate::signal::Series;
use base::number::significant;

/// A strip of film between two jaws, unstretched.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coupon {
    gauge: f64,
    width: f64,
    thickness: f64,
}

impl Coupon {
    /// A coupon of the length l₀ between the jaws, its width w and its thickness h, all in m.
    pub fn new(gauge: f64, width: f64, thickness: f64) -> Result<Coupon, Error> {
        for (what, value) in [("gauge length", gauge), ("width", width), ("thickness", thickness)] {
            if !(value.is_finite() && value > 0.0) {
                let value = significant(value, 6);
                return Err(refusal!("the {what} of a coupon is a positive length, not {value} m"));
            }
        }
        Ok(Coupon { gauge, width, thickness })
    }

    /// Length l₀ between the jaws, m.
    pub fn gauge(&self) -> f64 {
        self.gauge
    }

    /// Width w, m.
    pub fn width(&self) -> f64 {
        self.width
    }

    /// Thickness h, m.
    pub fn thickness(&self) -> f64 {
        self.thickness
    }

    /// Cross-section A₀ = h·w, m².
    pub fn area(&self) -> f64 {
        self.thickness * self.width
    }

    /// Nominal stress σ = F/A₀ (Pa) over engineering strain ε = d/l₀ (equation 1).
    ///
    /// `force` (N, tension positive) and `displacement` (m, of the jaws apart) share their time axis. Zero is where
    /// the recording has it: nothing is shifted here (see [`Curve::toe_compensated`]).
    ///
    /// # Errors
    /// Unequal time axes, a sample that was not measured, and what makes no [`Curve`].
    pub fn curve(&self, force: &Series, displacement: &Series) -> Result<Curve, Error> {
        if force.time() != displacement.time() {
            let [force, displacement] = [force, displacement].map(Series::len);
            return Err(refusal!(
                "force and displacement have no common time axis ({force} and {displacement} samples)"
            ));
        }
        for (quantity, series) in [("force", force), ("displacement", displacement)] {
            if let Some([time, _]) = series.samples().find(|[_, value]| !value.is_finite()) {
                return Err(refusal!("the {quantity} was not measured at {} s", significant(time, 9)));
            }
        }
        let strain = displacement.values().iter().map(|d| d / self.gauge).collect();
        let stress = force.values().iter().map(|f| f / self.area()).collect();
        Curve::new(strain, stress)
    }

    /// Shear of the film from a `curve` recorded at 45° (D3), by equations 4 to 8.
    ///
    /// The paper supposes a square that is stretched along its diagonal and does not say how much of the coupon it is.
    /// Stress and strain are **assumed** the same everywhere, so that a square with the diagonal √2 L carries √2 L/w of
    /// the force and has √2 L/l₀ of the displacement: then L cancels, τ = σ/(1 + ε). Here it is the largest that fits
    /// the coupon.
    ///
    /// # Errors
    /// Samples that make no [`Curve`].
    pub fn shear(&self, curve: &Curve) -> Result<shear::Shear, Error> {
        let square = shear::Square::with_diagonal(self.gauge.min(self.width), self.thickness);
        let force = self.area() * square.diagonal() / self.width;
        let forces: Vec<f64> = curve.stress().iter().map(|stress| stress * force).collect();
        let displacements: Vec<f64> = curve.strain().iter().map(|strain| strain * square.diagonal()).collect();
        square.shear(&forces, &displacements)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn coupon() -> Coupon {
        Coupon::new(5e-3, 10e-3, 12e-6).unwrap()
    }

    #[test]
    fn stress_and_strain_are_those_of_equation_1() {
        let (force, displacement) = (Series::new([0.0, 1.0], [0.0, 1.2]), Series::new([0.0, 1.0], [0.0, 1e-3]));
        let curve = coupon().curve(&force, &displacement).unwrap();
        assert!((curve.strain()[1] - 0.2).abs() < 1e-15);
        assert!((curve.stress()[1] / 10e6 - 1.0).abs() < 1e-14);
    }

    #[test]
    fn shear_does_not_depend_on_the_size_of_the_coupon() {
        let curve = Curve::new(vec![0.0, 0.1, 0.2, 0.4], vec![0.0, 4e6, 6e6, 8e6]).unwrap();
        for [gauge, width] in [[5e-3, 10e-3], [50e-3, 10e-3], [100e-3, 15e-3]] {
            let sheared = Coupon::new(gauge, width, 12e-6).unwrap().shear(&curve).unwrap();
            assert_eq!(sheared.cut, 0);
            for ([strain, stress], [angle, shear]) in curve.samples().zip(sheared.curve.samples()) {
                // ψ = π/2 − γ is the angle at the stretched corners: the diagonal √2 L (1 + ε) is 2 L cos ψ/2.
                let diagonal = 2.0 * (0.5 * (std::f64::consts::FRAC_PI_2 - angle)).cos();
                assert!((diagonal / std::f64::consts::SQRT_2 - (1.0 + strain)).abs() < 1e-12, "{gauge}: {angle}");
                assert!((shear - stress / (1.0 + strain)).abs() < 1e-6, "{gauge}: {shear}");
            }
        }
    }

    #[test]
    fn invalid_coupons_and_recordings_are_refused() {
        assert_eq!(
            Coupon::new(5e-3, 10e-3, -12e-6).unwrap_err().to_string(),
            "the thickness of a coupon is a positive length, not -0.000012 m"
        );
        let line = |values: [f64; 3]| Series::new([0.0, 1.0, 2.0], values);
        let good = line([0.0, 1.0, 2.0]);
        for (force, displacement, expected) in [
            (&line([0.0, f64::NAN, 2.0]), &good, "the force was not measured at 1 s"),
            (&good, &good.window([0.0, 1.0]), "force and displacement have no common time axis (3 and 2 samples)"),
            (&good, &line([0.0, 0.002, 0.001]), "strain goes back at sample 3: 0.2 after 0.4"),
        ] {
            assert_eq!(coupon().curve(force, displacement).unwrap_err().to_string(), expected);
        }
    }
}
