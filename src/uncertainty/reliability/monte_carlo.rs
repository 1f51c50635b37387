//! Crude Monte Carlo.

use super::{Counted, LimitState, Probability, ReliabilityError, SamplingOptions, normal_point};
use crate::random::Stream;
use crate::statistics::wilson;

/// Share of independent points that fail, with the interval by Wilson (1927), which also bounds the probability where
/// none failed.
///
/// Points whose output is missing are left out and counted: where failure itself makes a run give no output, the
/// estimate is low. A larger sample begins with the points of a smaller.
///
/// # Errors
/// See [`ReliabilityError`].
pub fn monte_carlo(
    inputs: usize,
    options: &SamplingOptions,
    limit_state: &mut LimitState,
) -> Result<Probability, ReliabilityError> {
    if inputs == 0 {
        return Err(ReliabilityError::NoInputs);
    }
    let mut stream = Stream::new(options.seed);
    let mut counted = Counted::new(limit_state);
    let (mut failures, mut valid) = (0, 0);
    counted.sample(
        options,
        || normal_point(&mut stream, inputs),
        |_, g| {
            failures += u64::from(g < 0.0);
            valid += 1;
        },
    )?;
    let value = failures as f64 / valid as f64;
    Ok(Probability {
        value,
        // √((1 − p)/(p n)) with p n = failures.
        variation: (failures > 0).then(|| ((1.0 - value) / failures as f64).sqrt()),
        interval: Some(wilson(failures, valid, options.confidence)),
        evaluations: counted.evaluations,
        missing: counted.missing,
    })
}
