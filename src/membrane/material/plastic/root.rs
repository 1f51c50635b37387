//! Roots of functions that grow, a lane each.
//!
//! Newton's method is safeguarded by a bracket: a step that leaves it, or is longer than half the last one, is replaced
//! by a bisection. A lane that has converged no longer changes, whatever the others need.

use crate::lane::{Lane, larger, splat};

/// Value at which Newton's method takes its last step, which squares it.
const TOLERANCE: f64 = 1e-10;

/// Most steps of Newton's method or bisections: beyond the bisections of any bracket to round-off.
const STEPS: usize = 120;

/// The root of a function that grows, between `low` and `high`, from `x` on in lanes where `open` is not zero. `of`
/// gives value and derivative.
#[inline(always)]
pub(super) fn root<const L: usize>(
    mut x: Lane<L>,
    [mut low, mut high]: [Lane<L>; 2],
    mut open: Lane<L>,
    of: impl Fn(&Lane<L>) -> [Lane<L>; 2],
) -> Lane<L> {
    let mut last = splat::<L>(f64::INFINITY);
    for _ in 0..STEPS {
        let [value, derivative] = of(&x);
        let mut widest = 0.0;
        for l in 0..L {
            let is_below = value[l] < 0.0;
            // The bracket shrinks with every value, so bisection is always at hand.
            low[l] = if is_below { x[l] } else { low[l] };
            high[l] = if is_below { high[l] } else { x[l] };
            // A kink of a table may have Newton's method jump to and fro: it must at least halve its last step, or
            // bisection takes over.
            let newton = x[l] - value[l] / derivative[l];
            let is_close = value[l].abs() <= TOLERANCE;
            let is_outside = (newton <= low[l]) | (newton >= high[l]) | ((newton - x[l]).abs() > 0.5 * last[l]);
            // A NaN must propagate.
            let next = if is_outside & !is_close { 0.5 * (low[l] + high[l]) } else { newton };
            let is_open = open[l] > TOLERANCE;
            last[l] = (next - x[l]).abs();
            // A lane that is done keeps its bits whatever its neighbours still search: no lane depends on another.
            x[l] = if is_open { next } else { x[l] };
            open[l] = if is_open { value[l].abs() } else { open[l] };
            widest = larger(open[l], widest);
        }
        if widest <= TOLERANCE {
            break;
        }
    }
    x
}
