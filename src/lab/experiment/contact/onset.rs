//! The onset of the force in an acceleration: a constant before it, a cubic after it.

use std::ops::Range;

use crate::experiment::fit::Moments;
use crate::signal::Series;

/// Largest distance of the onset from the time near which it is sought, s.
const SEARCH: f64 = 0.003;
/// Interval about that time which constant and cubic describe, s.
const SPAN: [f64; 2] = [-0.05, 0.006];
/// Variances by which constant and cubic must lower the sum of squares that a straight line leaves; chance hardly ever
/// does.
const SIGNIFICANT: f64 = 60.0;

/// Mean sample interval, s: the onset is known no better.
pub(super) fn step(series: &Series) -> f64 {
    match series.time() {
        [first, .., last] => (last - first) / (series.len() - 1) as f64,
        _ => 0.0,
    }
}

/// The time near `near` (s) at which the sum of squares that constant and cubic leave, plus the `penalty` (m²/s⁴) of
/// the time, is smallest.
///
/// None where a straight line fits as well, where the acceleration does not rise, and where the best time is the first
/// or last that is tried. Constant and cubic need not meet: the guide's friction ends with the fall. Between two
/// samples all times are equal; the result is the middle.
pub(super) fn onset(acceleration: &Series, near: f64, penalty: impl Fn(f64) -> f64) -> Option<f64> {
    let around = acceleration.window(SPAN.map(|span| near + span));
    let time = around.time();
    let first = time.partition_point(|t| *t < near - SEARCH).max(1);
    let last = time.partition_point(|t| *t <= near + SEARCH);
    if time.len() < last + 4 {
        return None;
    }
    let splits = Splits::new(&around, near, first..last);
    let best = splits.all.iter().min_by(|a, b| {
        let sum = |split: &Split| split.squares + penalty(time[split.from]);
        sum(a).total_cmp(&sum(b))
    })?;
    // One constant and four coefficients of the cubic are fitted.
    let variance = best.squares / (time.len() - 5) as f64;
    let is_significant = splits.line - best.squares > SIGNIFICANT * variance;
    // At the first or last place that is tried the sum still falls: that is a bound of the search and no onset.
    let is_inside = best.from > first && best.from + 1 < last;
    (is_significant && is_inside && best.rise > 0.0).then(|| 0.5 * (time[best.from - 1] + time[best.from]))
}

/// All splits of a signal into a constant and a cubic.
struct Splits {
    all: Vec<Split>,
    /// Sum of squares that a straight line leaves of the whole.
    line: f64,
}

/// One of them.
struct Split {
    /// First sample of the cubic.
    from: usize,
    /// Sum of squares that both leave.
    squares: f64,
    /// From the constant to the end of the cubic.
    rise: f64,
}

impl Splits {
    /// Sums run along the signal once, so that the cost is linear in its samples.
    fn new(signal: &Series, near: f64, places: Range<usize>) -> Splits {
        let mean = signal.values().iter().sum::<f64>() / signal.len().max(1) as f64;
        let row = |[t, a]: [f64; 2]| ((t - near) / SEARCH, a - mean);
        let rows: Vec<(f64, f64)> = signal.samples().map(row).collect();
        let cubic = |u: f64| [1.0, u, u * u, u * u * u];
        let mut after = Moments::default();
        let mut tails: Vec<_> = rows
            .iter()
            .enumerate()
            .rev()
            .filter_map(|(k, (u, a))| {
                after.add(cubic(*u), *a);
                places.contains(&k).then(|| after.solve())
            })
            .collect();
        let (mut before, mut line) = (Moments::default(), Moments::default());
        let mut all = Vec::new();
        for (k, (u, a)) in rows.iter().enumerate() {
            if places.contains(&k)
                && let (Some(([constant], head)), Some((tail, rest))) = (before.solve(), tails.pop().flatten())
            {
                let end = rows.last().map_or([0.0; 4], |(u, _)| cubic(*u));
                let rise = tail.iter().zip(end).map(|(c, x)| c * x).sum::<f64>() - constant;
                all.push(Split { from: k, squares: head + rest, rise });
            }
            before.add([1.0], *a);
            line.add([1.0, *u], *a);
        }
        Splits { all, line: line.solve().map_or(0.0, |(_, left)| left) }
    }
}
