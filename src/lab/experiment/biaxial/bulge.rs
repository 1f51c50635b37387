//! A bulge: a disc that is clamped on a circle and blown up, reduced to stress over strain at its top.

use thiserror::Error;

use crate::experiment::coupon::{Curve, CurveError};

/// Height over the largest one below which a cap is too flat for the curvature that follows from its height.
const FLAT: f64 = 0.1;

/// A disc that is clamped on a circle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bulge {
    radius: f64,
    thickness: f64,
}

/// Why a bulge cannot be reduced.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum BulgeError {
    /// A dimension is not positive.
    #[error("the {name} of the bulge must be above zero, and is {value} m")]
    Dimension {
        /// Which.
        name: &'static str,
        /// m.
        value: f64,
    },
    /// The film does not rise under pressure.
    #[error("the recording has no two samples in which film has risen under pressure")]
    Flat,
    /// The height goes back by more than jitter.
    #[error("the film sinks at sample {sample}: {:.3} mm after {:.3} mm", 1e3 * height, 1e3 * before)]
    Sinks {
        /// Number of the sample, from one.
        sample: usize,
        /// m.
        height: f64,
        /// Largest height before it, m.
        before: f64,
    },
    /// The samples are no curve.
    #[error(transparent)]
    Curve(#[from] CurveError),
}

impl BulgeError {
    /// The remedy, where there is one.
    pub fn hint(&self) -> Option<&'static str> {
        match self {
            BulgeError::Flat => Some(
                "pressure and height count above zero where film rises: change the sign of a channel that is negative",
            ),
            _ => None,
        }
    }
}

impl Bulge {
    /// A disc of this radius within the clamp (m) and this thickness before the test (m).
    ///
    /// # Errors
    /// One of them is not positive.
    pub fn new(radius: f64, thickness: f64) -> Result<Bulge, BulgeError> {
        for (name, value) in [("radius", radius), ("thickness", thickness)] {
            if !(value > 0.0 && value.is_finite()) {
                return Err(BulgeError::Dimension { name, value });
            }
        }
        Ok(Bulge { radius, thickness })
    }

    /// Nominal stress (Pa) over engineering strain, alike in all directions, of a spherical cap that is strained evenly
    /// (docs/methods.md, equation 36b): `pressure` (Pa) and `height` of the top (m) sample by sample, from a tenth of the
    /// largest height up to there, also where the pressure falls before.
    ///
    /// # Errors
    /// The film does not rise, or its height goes back.
    pub fn curve(&self, pressure: &[f64], height: &[f64]) -> Result<Curve, BulgeError> {
        let top = height.iter().copied().fold(0.0, f64::max);
        let end = height.iter().rposition(|own| *own == top).map_or(0, |place| place + 1);
        let is_cap = |(_, (pressure, height)): &(usize, (&f64, &f64))| **pressure > 0.0 && **height > FLAT * top;
        let samples = pressure.iter().zip(&height[..end]).enumerate().filter(is_cap);
        let (places, points): (Vec<usize>, Vec<(f64, f64)>) =
            samples.map(|(place, (pressure, height))| (place, self.point(*pressure, *height))).unzip();
        let (strain, stress): (Vec<f64>, Vec<f64>) = points.into_iter().unzip();
        if strain.len() < 2 {
            return Err(BulgeError::Flat);
        }
        Curve::new(strain, stress).map_err(|error| match error {
            // In the samples of the recording.
            CurveError::GoesBack { sample, .. } => {
                let place = places[sample - 1];
                let before = height[..place].iter().copied().fold(0.0, f64::max);
                BulgeError::Sinks { sample: place + 1, height: height[place], before }
            }
            error => error.into(),
        })
    }

    /// Strain and nominal stress.
    fn point(&self, pressure: f64, height: f64) -> (f64, f64) {
        let radius = (self.radius * self.radius + height * height) / (2.0 * height);
        // The angle from the top to the clamp; above a half sphere it is more than a right one.
        let angle = 2.0 * height.atan2(self.radius);
        let stretch = radius * angle / self.radius;
        (stretch - 1.0, 0.5 * pressure * radius * stretch / self.thickness)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A half sphere: π/2 times the radius along the meridian, and p a/2 per length of its edge.
    #[test]
    fn a_half_sphere_has_its_stretch_and_stress() {
        let bulge = Bulge::new(0.05, 1e-5).unwrap();
        let curve = bulge.curve(&[0.0, 100.0, 400.0, 300.0], &[0.0, 0.01, 0.05, 0.049]).unwrap();
        let [strain, stress] = curve.samples().last().unwrap();
        let stretch = 0.5 * std::f64::consts::PI;
        assert!((strain - (stretch - 1.0)).abs() < 1e-12);
        assert!((stress - 400.0 * 0.05 / 2.0 * stretch / 1e-5).abs() < 1e-3);
        assert_eq!(curve.strain().len(), 2);
    }

    /// A flat cap: the strain 2 h²/(3 a²) and the stress p a²/(4 h t).
    #[test]
    fn a_flat_cap_has_the_known_series() {
        let (a, h, p, t) = (0.05, 5e-4, 10.0, 1e-5);
        let curve = Bulge::new(a, t).unwrap().curve(&[5.0, p], &[4e-4, h]).unwrap();
        let [strain, stress] = curve.samples().last().unwrap();
        assert!((strain / (2.0 * h * h / (3.0 * a * a)) - 1.0).abs() < 1e-3, "{strain}");
        assert!((stress / (p * a * a / (4.0 * h * t)) - 1.0).abs() < 1e-3, "{stress}");
    }

    #[test]
    fn what_is_no_bulge_is_refused() {
        assert!(matches!(Bulge::new(0.05, 0.0), Err(BulgeError::Dimension { name: "thickness", .. })));
        let bulge = Bulge::new(0.05, 1e-5).unwrap();
        assert_eq!(bulge.curve(&[0.0, 1.0], &[0.0, 0.0]), Err(BulgeError::Flat));
        assert_eq!(bulge.curve(&[], &[]), Err(BulgeError::Flat));
        for negative in [[[-1.0, -2.0], [0.01, 0.02]], [[1.0, 2.0], [-0.01, -0.02]]] {
            let error = bulge.curve(&negative[0], &negative[1]).unwrap_err();
            assert!(error.hint().unwrap().contains("sign"), "{error}");
        }
        let back = bulge.curve(&[0.0, 1.0, 2.0, 3.0], &[0.0, 0.01, 0.004, 0.02]);
        assert_eq!(back, Err(BulgeError::Sinks { sample: 3, height: 0.004, before: 0.01 }));
        assert_eq!(bulge.curve(&[f64::NAN, 1.0], &[0.01, f64::NAN]), Err(BulgeError::Flat));
        // Past the largest pressure film rises on; when it sinks again, that is another curve.
        let on = bulge.curve(&[1e3, 2e3, 1.7e3, 100.0], &[0.01, 0.02, 0.05, 0.03]).unwrap();
        assert_eq!(on.strain().len(), 3);
    }
}
