//! Random numbers and thresholds in scripts.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal, StandardUniform};
use rhai::{Array, Dynamic, Engine, EvalAltResult, FnPtr, INT, NativeCallContext};

use crate::script::{HostResult, number, refuse};

/// Most numbers that are drawn at once, the limit of lists.
const MOST: INT = 10_000;

/// A stream of random numbers.
type Stream = ChaCha8Rng;

/// Offers `random(seed)` to scripts.
pub(super) fn register_random(engine: &mut Engine) {
    engine
        .register_type_with_name::<Stream>("random")
        // By its bits, so that a negative number is a seed too.
        .register_fn("random", |seed: INT| Stream::seed_from_u64(seed.cast_unsigned()))
        .register_fn("uniform", |stream: &mut Stream| -> f64 { StandardUniform.sample(stream) })
        .register_fn("normal", |stream: &mut Stream| -> f64 { StandardNormal.sample(stream) })
        .register_fn("normals", normals);
}

fn normals(stream: &mut Stream, count: INT) -> Result<Array, Box<EvalAltResult>> {
    if !(0..=MOST).contains(&count) {
        return Err(refuse(format!("expected a count of 0 to {MOST} random numbers, found {count}")));
    }
    let draw = |_| -> f64 { StandardNormal.sample(stream) };
    Ok((0..count).map(draw).map(Dynamic::from).collect())
}

/// Most halvings: the bits of a number.
const MOST_HALVINGS: u32 = 64;

/// Offers `threshold` to scripts.
pub(super) fn register_threshold(engine: &mut Engine) {
    engine.register_fn("threshold", threshold);
}

/// The two ends, the one nearer to `from` first, of an interval no longer than `tolerance` between `from` and `to` over
/// which the condition changes, by bisection.
///
/// # Errors
/// The condition is the same at `from` and `to`, or is no Boolean.
fn threshold(
    context: NativeCallContext,
    from: Dynamic,
    to: Dynamic,
    tolerance: Dynamic,
    condition: FnPtr,
) -> HostResult<rhai::Array> {
    let [mut near, mut far] = [number(&from, "the first end")?, number(&to, "the second end")?];
    let tolerance = number(&tolerance, "the tolerance")?;
    if !(near.is_finite() && far.is_finite() && tolerance > 0.0) {
        return Err(refuse("a threshold needs two finite ends and a tolerance above zero"));
    }
    let holds = |x: f64| -> HostResult<bool> {
        let found: Dynamic = condition.call_within_context(&context, (x,))?;
        found.as_bool().map_err(|kind| refuse(format!("the condition gives true or false, not {kind}")))
    };
    let at_near = holds(near)?;
    if holds(far)? == at_near {
        return Err(refuse(format!(
            "the condition is {at_near} at {near} and at {far}: there is no threshold to find"
        )));
    }
    // Not until the tolerance is met: it may be less than the distance between two numbers of this size.
    for _ in 0..MOST_HALVINGS {
        if (far - near).abs() <= tolerance {
            break;
        }
        let middle = 0.5 * (near + far);
        if holds(middle)? == at_near {
            near = middle;
        } else {
            far = middle;
        }
    }
    Ok(vec![near.into(), far.into()])
}

#[cfg(test)]
mod tests {
    use crate::functions::tests::engine;

    #[test]
    fn a_condition_may_fall_and_the_ends_may_be_in_either_order() {
        let falls = "let t = threshold(8, 0, 0.01, |x| x < 3.3); t[0] > t[1] && t[0] >= 3.3 && t[1] < 3.3 && t[0] - t[1] <= 0.01";
        assert_eq!(engine().eval::<bool>(falls).ok(), Some(true));
    }
}
