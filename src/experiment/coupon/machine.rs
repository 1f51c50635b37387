use thiserror::Error;

use super::{Coupon, Curve};

/// The tensile machine of virtual tests: jaws that part at one speed, a load cell with noise, and a recorder that
/// rounds to so many decimals.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Machine {
    /// Speed of the jaws apart, m/s.
    pub velocity: f64,
    /// Decimals of the recorded force in N.
    pub force_decimals: u8,
    /// Decimals of the recorded displacement in m and time in s.
    pub displacement_decimals: u8,
}

/// What the machine recorded: as many times (s) as displacements (m) and forces (N).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TensileRecord {
    /// s.
    pub time: Vec<f64>,
    /// Of the jaws apart, m.
    pub displacement: Vec<f64>,
    /// N, tension positive.
    pub force: Vec<f64>,
}

/// Why nothing can be recorded.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum MachineError {
    /// The speed is not positive, m/s.
    #[error("the speed of the jaws is positive, not {0} m/s")]
    Velocity(f64),
    /// Not as many values of noise as rows.
    #[error("{noise} values of noise for {rows} rows")]
    Noise {
        /// Number of values of noise.
        noise: usize,
        /// Number of strains, each a row of the recording.
        rows: usize,
    },
    /// A strain lies before the start of the curve.
    #[error("the film has no stress at the strain {0}, where its curve has not begun")]
    BeforeStart(f64),
}

impl Machine {
    /// Records a `coupon` whose film follows `curve` and is broken beyond its end, at `strains`; `noise` (N) is added
    /// to the force row by row. The force is that of the rounded displacement, so rounding adds no error.
    pub fn pull(
        &self,
        coupon: &Coupon,
        curve: &Curve,
        strains: &[f64],
        noise: &[f64],
    ) -> Result<TensileRecord, MachineError> {
        if !(self.velocity.is_finite() && self.velocity > 0.0) {
            return Err(MachineError::Velocity(self.velocity));
        }
        if noise.len() != strains.len() {
            return Err(MachineError::Noise { noise: noise.len(), rows: strains.len() });
        }
        let mut pull = TensileRecord::default();
        for (strain, noise) in strains.iter().zip(noise) {
            let displacement = rounded(strain * coupon.gauge(), self.displacement_decimals);
            let stress = stress(curve, *strain, displacement / coupon.gauge())?;
            pull.time.push(rounded(displacement / self.velocity, self.displacement_decimals));
            pull.displacement.push(displacement);
            pull.force.push(rounded(stress * coupon.area() + noise, self.force_decimals));
        }
        Ok(pull)
    }
}

/// Stress at the rounded value of `strain`; the last one before the break may be rounded across it.
fn stress(curve: &Curve, strain: f64, rounded: f64) -> Result<f64, MachineError> {
    let [start, end] = curve.range();
    if strain > end {
        return Ok(0.0);
    }
    let inside = if strain >= start { curve.at(rounded.clamp(start, end)) } else { None };
    inside.ok_or(MachineError::BeforeStart(strain))
}

fn rounded(value: f64, decimals: u8) -> f64 {
    let digits = 10_f64.powi(decimals.into());
    (value * digits).round() / digits
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::signal::Series;

    const MACHINE: Machine = Machine { velocity: 0.02, force_decimals: 6, displacement_decimals: 7 };

    fn parts() -> (Coupon, Curve) {
        (Coupon::new(5e-3, 10e-3, 12e-6).unwrap(), Curve::new(vec![0.0, 0.5, 1.0], vec![0.0, 10e6, 15e6]).unwrap())
    }

    #[test]
    fn a_recording_reduces_to_the_curve_of_its_film() {
        let (coupon, curve) = parts();
        let strains = [0.0, 0.123_456_789, 0.5, 1.0, 1.1];
        let pull = MACHINE.pull(&coupon, &curve, &strains, &[0.0; 5]).unwrap();
        assert_eq!(pull.displacement[1], 0.000_617_3);
        assert_eq!((pull.time[1], pull.force[4]), (0.030_865, 0.0));
        let series = |values: Vec<f64>| Series::new(pull.time.as_slice(), values);
        let found = coupon.curve(&series(pull.force.clone()), &series(pull.displacement.clone())).unwrap();
        for [strain, stress] in found.samples().take(4) {
            // Half of the last decimal of the force, on the cross-section.
            assert!((stress - curve.at(strain.min(1.0)).unwrap()).abs() <= 0.51e-6 / coupon.area());
        }
    }

    #[test]
    fn noise_is_added_to_the_force() {
        let (coupon, curve) = parts();
        let pull = MACHINE.pull(&coupon, &curve, &[0.0, 0.5], &[-0.25, 0.5]).unwrap();
        assert_eq!(pull.force, [-0.25, 1.7]);
    }

    #[test]
    fn impossible_recordings_are_refused() {
        let (coupon, curve) = parts();
        let late = curve.within([0.5, 1.0]).unwrap();
        let pull = |machine: Machine, curve, noise: &[f64]| machine.pull(&coupon, curve, &[0.2], noise).unwrap_err();
        assert_eq!(pull(Machine { velocity: 0.0, ..MACHINE }, &curve, &[0.0]), MachineError::Velocity(0.0));
        assert_eq!(pull(MACHINE, &curve, &[]), MachineError::Noise { noise: 0, rows: 1 });
        assert_eq!(pull(MACHINE, &late, &[0.0]), MachineError::BeforeStart(0.2));
    }
}
