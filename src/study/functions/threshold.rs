//! Where a condition changes, for thresholds such as the mass at which a film breaks.

use rhai::{Dynamic, Engine, FnPtr, NativeCallContext};

use crate::script::{Entry, HostResult, number, refuse};

/// Most halvings: the bits of a number.
const MOST_HALVINGS: u32 = 64;

/// Offers `threshold` to scripts.
pub(super) fn register(engine: &mut Engine) {
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

/// The reference of thresholds.
pub const ENTRIES: &[Entry] = &[Entry {
    call: "threshold(from, to, tolerance, |x| …)",
    gives: "two numbers no further apart than the tolerance between which the condition changes, the one on the side of \
            `from` first, by bisection; the condition differs at `from` and `to`, and is called at these first",
    example: "let t = threshold(1, 2, 1e-6, |x| x * x > 2); t[1] - t[0] <= 1e-6 && t[0] <= 1.414214 && t[1] >= 1.414213",
}];

#[cfg(test)]
mod tests {
    use crate::functions::check::engine;

    #[test]
    fn a_condition_may_fall_and_the_ends_may_be_in_either_order() {
        let falls = "let t = threshold(8, 0, 0.01, |x| x < 3.3); t[0] > t[1] && t[0] >= 3.3 && t[1] < 3.3 && t[0] - t[1] <= 0.01";
        assert_eq!(engine().eval::<bool>(falls).ok(), Some(true));
    }
}
