use super::Curve;
use crate::error::{Error, refusal};
use crate::experiment::fit::least_squares;

/// Strains between which the modulus is fitted by default: the elastic part of a polyethylene film.
pub const WINDOW: [f64; 2] = [0.0, 0.04];

/// Fewest samples that a slope is fitted to.
pub const FEWEST_SAMPLES: usize = 3;

/// The straight line that fits the elastic part of a curve best.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Modulus {
    /// Young's modulus E, Pa.
    pub slope: f64,
    /// Stress of the line at zero strain, Pa: not zero after an offset of the load cell or slack.
    pub intercept: f64,
    /// Samples in the window.
    pub samples: usize,
}

impl Modulus {
    /// Stress of the line at `strain`, Pa.
    pub fn stress(&self, strain: f64) -> f64 {
        self.intercept + self.slope * strain
    }
}

impl Curve {
    /// Young's modulus (equation 2): slope of the least-squares line through the samples with `from <= strain <= to`.
    ///
    /// The line need not go through the origin, so that neither an offset of the load cell nor slack changes it.
    pub fn modulus(&self, [from, to]: [f64; 2]) -> Result<Modulus, Error> {
        if !(from.is_finite() && to.is_finite() && from < to) {
            return Err(refusal!("expected a window of strain, found {from} to {to}"));
        }
        let inside: Vec<[f64; 2]> = self.samples().filter(|[strain, _]| (from..=to).contains(strain)).collect();
        let too_few = || {
            let found = inside.len();
            refusal!("{found} samples between the strains {from} and {to}, where a slope needs {FEWEST_SAMPLES}")
        };
        let line = if inside.len() < FEWEST_SAMPLES { None } else { line(&inside) };
        let modulus = line.ok_or_else(too_few)?;
        if modulus.slope > 0.0 {
            return Ok(modulus);
        }
        Err(refusal!("stress does not rise between the strains {from} and {to}").with_hint(
            "force and displacement count above zero in tension: change the sign of a channel that falls, or give other \
             strains by --window",
        ))
    }
}

/// The line through `points`; none where they lie at one abscissa.
fn line(points: &[[f64; 2]]) -> Option<Modulus> {
    let [start, end] = [points.first()?[0], points.last()?[0]];
    let (middle, half) = (0.5 * (start + end), 0.5 * (end - start));
    // Strain from the middle in halves of the interval: columns of one magnitude.
    let rows = points.iter().map(|[strain, stress]| ([1.0, (strain - middle) / half], *stress));
    let ([stress, rise], _) = least_squares(rows)?;
    let slope = rise / half;
    Some(Modulus { slope, intercept: stress - slope * middle, samples: points.len() })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bent(offset: f64) -> Curve {
        let strain: Vec<f64> = (0..=100).map(|i| 0.001 * f64::from(i)).collect();
        let stress = strain.iter().map(|e| offset + 50e6 * e.min(0.04) + 20e6 * (e - 0.04).max(0.0)).collect();
        Curve::new(strain, stress).unwrap()
    }

    #[test]
    fn the_modulus_is_the_slope_of_the_elastic_part_with_any_offset() {
        for offset in [0.0, 0.3e6, -1e6] {
            let modulus = bent(offset).modulus(WINDOW).unwrap();
            assert!((modulus.slope / 50e6 - 1.0).abs() < 1e-9, "{modulus:?}");
            assert!((modulus.intercept - offset).abs() < 1.0, "{modulus:?}");
        }
        let beyond = bent(0.0).modulus([0.05, 0.1]).unwrap();
        assert!((beyond.slope / 20e6 - 1.0).abs() < 1e-9);
    }

    #[test]
    fn windows_without_a_slope_are_refused() {
        let refused = |curve: &Curve, window| curve.modulus(window).unwrap_err().to_string();
        let too_few = "2 samples between the strains 0 and 0.0015, where a slope needs 3";
        assert_eq!(refused(&bent(0.0), [0.0, 0.0015]), too_few);
        assert_eq!(refused(&bent(0.0), [0.1, 0.0]), "expected a window of strain, found 0.1 to 0");
        let slack = Curve::new(vec![0.0, 0.01, 0.02], vec![0.0; 3]).unwrap();
        assert_eq!(refused(&slack, WINDOW), "stress does not rise between the strains 0 and 0.04");
    }
}
