//! Importance sampling around a design point.

use super::{Counted, LimitState, Probability, ReliabilityError, SamplingOptions, dot, log_normal, normal_point};
use crate::random::Stream;

/// Samples the normal distribution about `centre`, usually the design point, and weights failures by the ratio of the
/// densities (Schuëller, Stix 1987).
///
/// The interval takes the logarithm of the estimate for normal; it and the coefficient of variation know only the parts
/// of the failure domain that were met. Failure domains far from the centre are missed: compare with
/// [`super::subset_simulation`]. Missing outputs are left out and counted.
///
/// # Errors
/// See [`ReliabilityError`].
pub fn importance_sampling(
    centre: &[f64],
    options: &SamplingOptions,
    limit_state: &mut LimitState,
) -> Result<Probability, ReliabilityError> {
    if centre.is_empty() {
        return Err(ReliabilityError::NoInputs);
    }
    let mut stream = Stream::new(options.seed);
    let mut counted = Counted::new(limit_state);
    // Once for all points; u·u cancels in the ratio of the densities (theory.md, equation 319).
    let half_square = 0.5 * dot(centre, centre);
    let (mut sum, mut squares, mut valid) = (0.0, 0.0, 0_usize);
    counted.sample(
        options,
        || normal_point(&mut stream, centre.len()).iter().zip(centre).map(|(z, centre)| z + centre).collect(),
        |u, g| {
            // φ(u)/φ(u − centre)
            let weight = if g <= 0.0 { libm::exp(half_square - dot(u, centre)) } else { 0.0 };
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
        interval: variation.map(|variation| log_normal(value, variation, options.confidence)),
        evaluations: counted.evaluations,
        missing: counted.missing,
    })
}
