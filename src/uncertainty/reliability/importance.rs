//! Importance sampling around a design point.

use super::{
    Counted, DesignPoint, LimitState, Probability, ReliabilityError, SamplingOptions, dot, log_normal, normal_point,
};
use crate::normal;
use crate::random::Stream;
use crate::statistics::{Interval, wilson};

/// Samples the normal distribution about `centre`, usually the design point, and weights failures by the ratio of the
/// densities (Schuëller, Stix 1987).
///
/// The interval takes the logarithm of the estimate for normal; it and the coefficient of variation know only the parts
/// of the failure domain that were met. Failure domains far from the centre are missed: compare with
/// [`super::subset_simulation`]. Where no point failed the interval goes from 0 to the bound of theory.md, equation 319b. Missing
/// outputs are left out and counted.
///
/// # Errors
/// See [`ReliabilityError`].
pub fn importance_sampling(
    centre: &[f64],
    options: &SamplingOptions,
    limit_state: &mut LimitState,
) -> Result<Probability, ReliabilityError> {
    sampled(centre, options, limit_state, |g| g < 0.0)
}

/// [`importance_sampling`] about a design point, of the complement where the origin fails: beyond the design point weights are
/// at most one, on the side of the origin they grow without bound.
///
/// # Errors
/// See [`ReliabilityError`].
pub fn importance_sampling_at(
    at: &DesignPoint,
    options: &SamplingOptions,
    limit_state: &mut LimitState,
) -> Result<Probability, ReliabilityError> {
    if !at.origin_fails {
        return importance_sampling(&at.point, options, limit_state);
    }
    let survival = sampled(&at.point, options, limit_state, |g| g >= 0.0)?;
    let value = (1.0 - survival.value).max(0.0);
    Ok(Probability {
        value,
        // The deviation is that of the complement.
        variation: survival.variation.filter(|_| value > 0.0).map(|variation| variation * survival.value / value),
        interval: survival.interval.map(|Interval { low, high }| Interval { low: 1.0 - high, high: 1.0 - low }),
        ..survival
    })
}

/// Probability that an output is one of those that `counts`.
fn sampled(
    centre: &[f64],
    options: &SamplingOptions,
    limit_state: &mut LimitState,
    counts: impl Fn(f64) -> bool,
) -> Result<Probability, ReliabilityError> {
    if centre.is_empty() {
        return Err(ReliabilityError::NoInputs);
    }
    let mut stream = Stream::new(options.seed);
    let mut counted = Counted::new(limit_state);
    // Once for all points; u·u cancels in the ratio of the densities (theory.md, equation 319).
    let half_square = 0.5 * dot(centre, centre);
    let (mut sum, mut squares, mut valid) = (0.0, 0.0, 0_u64);
    counted.sample(
        options,
        || normal_point(&mut stream, centre.len()).iter().zip(centre).map(|(z, centre)| z + centre).collect(),
        |u, g| {
            // φ(u)/φ(u − centre)
            let weight = if counts(g) { libm::exp(half_square - dot(u, centre)) } else { 0.0 };
            sum += weight;
            squares += weight * weight;
            valid += 1;
        },
    )?;
    // Over valid points only: a missing output says nothing of failure here.
    let n = valid as f64;
    let value = sum / n;
    let variation =
        // Variance of the mean over its square; equal weights may leave less than zero by round-off.
        (sum > 0.0 && valid > 1).then(|| ((squares / n / (value * value) - 1.0).max(0.0) / (n - 1.0)).sqrt());
    Ok(Probability {
        value,
        variation,
        interval: if sum > 0.0 {
            variation.map(|variation| log_normal(value, variation, options.confidence))
        } else {
            let met = wilson(0, valid, options.confidence).high;
            Some(Interval { low: 0.0, high: unmet(met, dot(centre, centre).sqrt()) })
        },
        evaluations: counted.evaluations,
        missing: counted.missing,
    })
}

/// Most that a domain can have of the normal distribution where the one about a centre at this `distance` has at most `met` of it.
fn unmet(met: f64, distance: f64) -> f64 {
    /// Places z at which the bound is evaluated, as deviations from the distance.
    const PLACES: i32 = 400;
    if distance == 0.0 {
        return met;
    }
    // theory.md, equation 319b, which holds for every z; its least value lies below z = distance.
    let bound = |place: i32| {
        let z = distance - 0.1 * f64::from(place);
        met * libm::exp(distance * (0.5 * distance - z)) + normal::cumulative(z)
    };
    (0..PLACES).map(bound).fold(1.0, f64::min)
}
