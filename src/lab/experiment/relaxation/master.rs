//! The master curve: relaxations at several temperatures, shifted along the logarithm of time until they are one.

use thiserror::Error;

use super::ZERO_CELSIUS;

/// Difference of temperatures, K, that count as one: a chamber holds its temperature no better.
const SAME_TEMPERATURE: f64 = 1.0;

/// Levels of the modulus at which two relaxations are compared.
const LEVELS: usize = 50;

/// The relaxation at one temperature.
#[derive(Clone, Debug, PartialEq)]
pub struct Relaxation {
    /// K.
    pub temperature: f64,
    /// Time (s) and modulus (Pa), by increasing time.
    pub points: Vec<[f64; 2]>,
}

/// log₁₀ a_T of one temperature: relaxation there after t is that at the reference after t/a_T.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShiftFactor {
    /// K.
    pub temperature: f64,
    /// log₁₀ a_T.
    pub log_shift: f64,
}

/// A master curve.
#[derive(Clone, Debug, PartialEq)]
pub struct Master {
    /// Reduced time t/a_T (s) and modulus (Pa), by increasing time.
    pub points: Vec<[f64; 2]>,
    /// By increasing temperature.
    pub factors: Vec<ShiftFactor>,
    /// Temperature of log₁₀ a_T = 0, K.
    pub reference: f64,
}

/// Why relaxations give no master curve.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum MasterError {
    /// A temperature has no shift factor.
    #[error("no shift factor within 1 K of {:.1} degC", temperature - ZERO_CELSIUS)]
    NoFactor {
        /// Of the relaxation, K.
        temperature: f64,
    },
    /// Two neighbours have no modulus in common.
    #[error(
        "the relaxations at {:.1} and {:.1} degC have no modulus in common: their shift is unknown",
        colder - ZERO_CELSIUS, warmer - ZERO_CELSIUS
    )]
    NoOverlap {
        /// K.
        colder: f64,
        /// K.
        warmer: f64,
    },
    /// There is one temperature.
    #[error("one temperature has no shift factors")]
    OneTemperature,
}

impl Master {
    /// The curve by given shift factors; its reference is where they cross zero.
    pub fn shifted(relaxations: &[Relaxation], factors: &[ShiftFactor]) -> Result<Master, MasterError> {
        let of = |relaxation: &Relaxation| {
            let away = |factor: &&ShiftFactor| (factor.temperature - relaxation.temperature).abs();
            let nearest = factors.iter().min_by(|a, b| away(a).total_cmp(&away(b)));
            let nearest = nearest.filter(|factor| away(factor) <= SAME_TEMPERATURE);
            nearest.copied().ok_or(MasterError::NoFactor { temperature: relaxation.temperature })
        };
        let found = relaxations.iter().map(of).collect::<Result<Vec<_>, _>>()?;
        let zero = found.iter().min_by(|a, b| a.log_shift.abs().total_cmp(&b.log_shift.abs()));
        let reference = zero.map_or(f64::NAN, |factor| factor.temperature);
        Ok(Master::from_shifted(relaxations, found, reference))
    }

    /// The curve by overlap: from one temperature to the next the shift is the mean distance along log₁₀ t at equal
    /// modulus (theory.md, equation 236). The factor is zero at the relaxation nearest to `reference` (K), or at the
    /// middle one.
    pub fn overlapped(relaxations: &[Relaxation], reference: Option<f64>) -> Result<Master, MasterError> {
        let mut sorted: Vec<&Relaxation> = relaxations.iter().collect();
        sorted.sort_by(|a, b| a.temperature.total_cmp(&b.temperature));
        if sorted.len() < 2 {
            return Err(MasterError::OneTemperature);
        }
        let mut logs = vec![0.0];
        for pair in sorted.windows(2) {
            let distance = distance(pair[0], pair[1])
                .ok_or(MasterError::NoOverlap { colder: pair[0].temperature, warmer: pair[1].temperature })?;
            logs.push(logs[logs.len() - 1] + distance);
        }
        let away = |place: &usize| reference.map_or(0.0, |wanted| (sorted[*place].temperature - wanted).abs());
        let zero = match reference {
            Some(_) => (0..sorted.len()).min_by(|a, b| away(a).total_cmp(&away(b))).unwrap_or(0),
            None => sorted.len() / 2,
        };
        let factors = sorted
            .iter()
            .zip(&logs)
            .map(|(relaxation, log)| ShiftFactor { temperature: relaxation.temperature, log_shift: log - logs[zero] });
        let owned: Vec<Relaxation> = sorted.iter().map(|relaxation| (*relaxation).clone()).collect();
        Ok(Master::from_shifted(&owned, factors.collect(), sorted[zero].temperature))
    }

    fn from_shifted(relaxations: &[Relaxation], mut factors: Vec<ShiftFactor>, reference: f64) -> Master {
        let shifted = relaxations.iter().zip(&factors).flat_map(|(relaxation, factor)| {
            let shift = 10.0_f64.powf(factor.log_shift);
            relaxation.points.iter().map(move |[time, modulus]| [time / shift, *modulus])
        });
        let mut points: Vec<[f64; 2]> = shifted.collect();
        points.sort_by(|a, b| a[0].total_cmp(&b[0]));
        factors.sort_by(|a, b| a.temperature.total_cmp(&b.temperature));
        Master { points, factors, reference }
    }
}

/// Mean of log₁₀ t of the warmer less that of the colder at the moduli that both have; none where they have none.
fn distance(colder: &Relaxation, warmer: &Relaxation) -> Option<f64> {
    let (colder, warmer) = (falling(colder), falling(warmer));
    let ends = |curve: &[[f64; 2]]| [curve[curve.len() - 1][0], curve[0][0]];
    let ([a, b], [c, d]) = (ends(&colder), ends(&warmer));
    let [low, high] = [a.max(c), b.min(d)];
    if low >= high {
        return None;
    }
    let level = |k: usize| low + (high - low) * k as f64 / (LEVELS - 1) as f64;
    let sum: f64 = (0..LEVELS).map(|k| log_time_at(&warmer, level(k)) - log_time_at(&colder, level(k))).sum();
    Some(sum / LEVELS as f64)
}

/// Modulus and log₁₀ t where the modulus falls below all before it.
fn falling(relaxation: &Relaxation) -> Vec<[f64; 2]> {
    let mut curve: Vec<[f64; 2]> = Vec::new();
    for [time, modulus] in &relaxation.points {
        if curve.last().is_none_or(|last| *modulus < last[0]) {
            curve.push([*modulus, time.log10()]);
        }
    }
    curve
}

/// log₁₀ t at a modulus within a falling curve.
fn log_time_at(curve: &[[f64; 2]], modulus: f64) -> f64 {
    let below = curve.iter().position(|point| point[0] <= modulus).unwrap_or(curve.len() - 1);
    let Some(before) = below.checked_sub(1) else { return curve[0][1] };
    let ([m0, t0], [m1, t1]) = (curve[before], curve[below]);
    t0 + (t1 - t0) * (modulus - m0) / (m1 - m0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Relaxations of 1/(1 + √t) with factors of one decade every 10 K.
    fn relaxations() -> Vec<Relaxation> {
        let of = |step: i32| {
            let shift = 10.0_f64.powi(-step);
            let time = |k: i32| 10.0_f64.powf(f64::from(k) / 10.0);
            let points = (-20..=20).map(|k| [time(k), 1e8 / (1.0 + (time(k) / shift).sqrt())]);
            Relaxation { temperature: 293.15 + 10.0 * f64::from(step), points: points.collect() }
        };
        (-3..=3).rev().map(of).collect()
    }

    #[test]
    fn overlap_gives_the_factors() {
        let master = Master::overlapped(&relaxations(), Some(294.0)).expect("a master curve");
        assert_eq!((master.factors.len(), master.reference), (7, 293.15));
        for (factor, expected) in master.factors.iter().zip([3.0, 2.0, 1.0, 0.0, -1.0, -2.0, -3.0]) {
            assert!((factor.log_shift - expected).abs() < 2e-3, "{factor:?}");
        }
        for [time, modulus] in &master.points {
            assert!((modulus / (1e8 / (1.0 + time.sqrt())) - 1.0).abs() < 5e-3, "{time} {modulus}");
        }
        assert!(master.points.windows(2).all(|pair| pair[0][0] <= pair[1][0]));
    }

    #[test]
    fn given_factors_are_used() {
        let factors = Master::overlapped(&relaxations(), None).expect("a master curve").factors;
        let master = Master::shifted(&relaxations(), &factors).expect("a master curve");
        assert_eq!(master, Master::overlapped(&relaxations(), None).expect("a master curve"));
        let error = Master::shifted(&relaxations(), &factors[1..]).expect_err("no factor");
        assert_eq!(error.to_string(), "no shift factor within 1 K of -10.0 degC");
    }

    #[test]
    fn relaxations_apart_have_no_shift() {
        let mut apart = relaxations();
        apart[0].points.iter_mut().for_each(|point| point[1] *= 1e-6);
        let error = Master::overlapped(&apart, None).expect_err("no overlap").to_string();
        assert!(error.starts_with("the relaxations at 40.0 and 50.0 degC have no modulus in common"), "{error}");
        assert_eq!(Master::overlapped(&apart[..1], None), Err(MasterError::OneTemperature));
    }
}
