use super::{Coupon, Curve};
use crate::error::{Error, refusal};

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
    /// The load cell with the jaw that hangs on it; none reads the force of the film as it is.
    pub load_cell: Option<LoadCell>,
}

/// A load cell that reads the deflection of its spring, with the mass of the jaw on it: an oscillator of second order
/// (methods.md, equations 184 and 185).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LoadCell {
    /// Mass m_j of the jaw and of what moves with it, kg.
    pub jaw_mass: f64,
    /// Stiffness k_c of the cell, N/m.
    pub stiffness: f64,
    /// Share ζ of the critical damping, from 0 to below 1.
    pub damping: f64,
}

impl LoadCell {
    /// Natural frequency √(k_c/m_j)/2π, Hz.
    pub fn frequency(&self) -> f64 {
        (self.stiffness / self.jaw_mass).sqrt() / std::f64::consts::TAU
    }

    fn check(&self) -> Result<(), Error> {
        let positive = |value: f64| value.is_finite() && value > 0.0;
        let fits = positive(self.jaw_mass) && positive(self.stiffness) && (0.0..1.0).contains(&self.damping);
        if fits {
            return Ok(());
        }
        let LoadCell { jaw_mass, stiffness, damping } = self;
        Err(refusal!(
            "expected a jaw mass and a stiffness above zero and a damping from 0 to below 1, found {jaw_mass} kg, {stiffness} \
             N/m and {damping}"
        ))
    }

    /// Readings of a `force` (N) that is linear between the times `time` (s), from rest under the first:
    /// exact for that force (Nigam and Jennings, Bull. Seismol. Soc. Am. 59, 1969).
    pub fn read(&self, time: &[f64], force: &[f64]) -> Vec<f64> {
        let natural = (self.stiffness / self.jaw_mass).sqrt();
        let (decay, damped) = (self.damping * natural, natural * (1.0 - self.damping * self.damping).sqrt());
        let [mut reading, mut rate] = [force.first().copied().unwrap_or(0.0), 0.0];
        let mut readings: Vec<f64> = force.first().copied().into_iter().collect();
        for (times, forces) in time.windows(2).zip(force.windows(2)) {
            let step = times[1] - times[0];
            if step > 0.0 {
                let slope = (forces[1] - forces[0]) / step;
                // On a ramp the cell follows with the delay 2ζ/ω, about which it oscillates.
                let behind = 2.0 * self.damping / natural * slope;
                let (apart, apart_rate) = (reading - (forces[0] - behind), rate - slope);
                let other = (apart_rate + decay * apart) / damped;
                let ((sine, cosine), left) = ((damped * step).sin_cos(), (-decay * step).exp());
                reading = forces[1] - behind + left * (apart * cosine + other * sine);
                rate = slope
                    + left * ((other * damped - decay * apart) * cosine - (apart * damped + decay * other) * sine);
            }
            readings.push(reading);
        }
        readings
    }
}

/// A recording of the machine: as many times (s) as displacements (m) and forces (N).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TensileRecord {
    /// s.
    pub time: Vec<f64>,
    /// Of the jaws apart, m.
    pub displacement: Vec<f64>,
    /// N, tension positive.
    pub force: Vec<f64>,
}

impl Machine {
    /// Records a `coupon` whose film follows `curve` and is broken beyond its end, at `strains`; `noise` (N) is added
    /// to the force row by row. The force is that of the rounded displacement, so rounding adds no error; the
    /// deflection of the load cell is left out of the strain.
    pub fn pull(&self, coupon: &Coupon, curve: &Curve, strains: &[f64], noise: &[f64]) -> Result<TensileRecord, Error> {
        if !(self.velocity.is_finite() && self.velocity > 0.0) {
            return Err(not_positive(self.velocity));
        }
        if noise.len() != strains.len() {
            return Err(refusal!("{} values of noise for {} rows", noise.len(), strains.len()));
        }
        self.load_cell.iter().try_for_each(LoadCell::check)?;
        let mut pull = TensileRecord::default();
        let mut forces = Vec::with_capacity(strains.len());
        for strain in strains {
            let displacement = rounded(strain * coupon.gauge(), self.displacement_decimals);
            let stress = stress(curve, *strain, displacement / coupon.gauge())?;
            pull.time.push(rounded(displacement / self.velocity, self.displacement_decimals));
            pull.displacement.push(displacement);
            forces.push(stress * coupon.area());
        }
        let read = match &self.load_cell {
            Some(cell) => {
                let time: Vec<f64> =
                    pull.displacement.iter().map(|displacement| displacement / self.velocity).collect();
                cell.read(&time, &forces)
            }
            None => forces,
        };
        let recorded = read.iter().zip(noise).map(|(force, noise)| rounded(force + noise, self.force_decimals));
        pull.force = recorded.collect();
        Ok(pull)
    }
}

/// Stress at the rounded value of `strain`; the last one before the break may be rounded across it.
fn stress(curve: &Curve, strain: f64, rounded: f64) -> Result<f64, Error> {
    let [start, end] = curve.range();
    if strain > end {
        return Ok(0.0);
    }
    let inside = if strain >= start { curve.stress_at(rounded.clamp(start, end)) } else { None };
    inside.ok_or_else(|| refusal!("the film has no stress at the strain {strain}, where its curve has not begun"))
}

/// The refusal of a speed of the jaws (m/s).
pub(super) fn not_positive(velocity: f64) -> Error {
    refusal!("the speed of the jaws is positive, not {velocity} m/s")
}

fn rounded(value: f64, decimals: u8) -> f64 {
    let digits = 10_f64.powi(decimals.into());
    (value * digits).round() / digits
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::signal::Series;

    const MACHINE: Machine = Machine { velocity: 0.02, force_decimals: 6, displacement_decimals: 7, load_cell: None };

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
            assert!((stress - curve.stress_at(strain.min(1.0)).unwrap()).abs() <= 0.51e-6 / coupon.area());
        }
    }

    #[test]
    fn noise_is_added_to_the_force() {
        let (coupon, curve) = parts();
        let pull = MACHINE.pull(&coupon, &curve, &[0.0, 0.5], &[-0.25, 0.5]).unwrap();
        assert_eq!(pull.force, [-0.25, 1.7]);
    }

    #[test]
    fn a_load_cell_follows_ramps_with_its_own_oscillation() {
        let cell = LoadCell { jaw_mass: 0.2, stiffness: 1e6, damping: 0.05 };
        assert!((cell.frequency() - 355.88).abs() < 0.01);
        let natural: f64 = (1e6_f64 / 0.2).sqrt();
        // A ramp of 1 N/ms and then a constant force, against small steps of the equation of motion.
        let (ramp, end) = (1000.0, 4e-3);
        let force = |time: f64| ramp * time.min(2e-3);
        let time: Vec<f64> = (0..=40).map(|i| end * f64::from(i) / 40.0).collect();
        let read = cell.read(&time, &time.iter().map(|time| force(*time)).collect::<Vec<_>>());
        let (steps, mut reading, mut rate) = (400_000, 0.0, 0.0);
        let dt = end / f64::from(steps);
        for i in 0..steps {
            let now = f64::from(i) * dt;
            if i % (steps / 40) == 0 {
                let found: f64 = read[(i / (steps / 40)) as usize];
                assert!((found - reading).abs() < 1e-3, "{now}: {found} for {reading}");
            }
            rate += dt * (natural * natural * (force(now + 0.5 * dt) - reading) - 2.0 * 0.05 * natural * rate);
            reading += dt * rate;
        }
        let slow: Vec<f64> = (0..=10).map(f64::from).collect();
        assert!(cell.read(&slow, &slow).iter().zip(&slow).all(|(read, force)| (read - force).abs() < 1e-3));
    }

    /// The window of the modulus at the fastest jaws of the study, 0.04 at 0.2 m/s on 5 mm, lasts 1 ms.
    #[test]
    fn a_heavy_jaw_makes_film_without_rates_seem_soft() {
        let coupon = Coupon::new(5e-3, 10e-3, 12e-6).unwrap();
        let film = Curve::new(vec![0.0, 0.04, 0.3], vec![0.0, 2e6, 8e6]).unwrap();
        let strains: Vec<f64> = (0..=60).map(|i| 0.001 * f64::from(i)).collect();
        let modulus = |velocity: f64| {
            let load_cell = Some(LoadCell { jaw_mass: 0.2, stiffness: 1e6, damping: 0.05 });
            let machine = Machine { velocity, load_cell, ..MACHINE };
            let pull = machine.pull(&coupon, &film, &strains, &[0.0; 61]).unwrap();
            let series = |values: &[f64]| Series::new(pull.time.as_slice(), values);
            let curve = coupon.curve(&series(&pull.force), &series(&pull.displacement)).unwrap();
            curve.modulus([0.0, 0.04]).unwrap().slope
        };
        assert!((modulus(0.02) / 50e6 - 1.0).abs() < 0.05, "{}", modulus(0.02));
        assert!(modulus(0.2) < 45e6 || modulus(0.2) > 55e6, "{}", modulus(0.2));
        let machine = |load_cell| Machine { load_cell: Some(load_cell), ..MACHINE };
        let wrong = LoadCell { jaw_mass: 0.0, stiffness: 1e6, damping: 0.05 };
        let refused = machine(wrong).pull(&coupon, &film, &[0.0], &[0.0]);
        let refused = refused.unwrap_err().to_string();
        assert!(refused.ends_with("found 0 kg, 1000000 N/m and 0.05"), "{refused}");
    }

    #[test]
    fn impossible_recordings_are_refused() {
        let (coupon, curve) = parts();
        let late = curve.within([0.5, 1.0]).unwrap();
        let pull = |machine: Machine, curve, noise: &[f64]| {
            machine.pull(&coupon, curve, &[0.2], noise).unwrap_err().to_string()
        };
        let still = Machine { velocity: 0.0, ..MACHINE };
        assert_eq!(pull(still, &curve, &[0.0]), "the speed of the jaws is positive, not 0 m/s");
        assert_eq!(pull(MACHINE, &curve, &[]), "0 values of noise for 1 rows");
        assert!(pull(MACHINE, &late, &[0.0]).starts_with("the film has no stress at the strain 0.2"));
    }
}
