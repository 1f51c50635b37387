//! The friction of the guide, from the fall.

use crate::experiment::absorption::Body;
use crate::experiment::fit::least_squares;
use crate::signal::{Series, integrate};
use membrane::engine::GuideFriction;

/// Share of the friction at contact below which its change over the fall is none.
const CHANGES: f64 = 0.05;

/// The friction of `body` between the times `[from, to]` (s) of the fall, from each of the `restored` accelerations
/// (m/s², from rest on) that the time constant admits, the best of them first. It depends on the speed where it does
/// so with each of them.
pub(super) fn fit(restored: &[&Series], [from, to]: [f64; 2], body: Body) -> Option<GuideFriction> {
    let falls: Vec<(Series, Series)> = restored.iter().map(|series| fall(series, [from, to])).collect();
    let force = |a: f64| body.mass * (a + body.gravity);
    let lines = falls.iter().map(|(acceleration, speed)| {
        let rows = acceleration.values().iter().zip(speed.values()).map(|(a, u)| ([1.0, *u], force(*a)));
        least_squares(rows).map(|([constant, per_speed], _)| GuideFriction { constant, per_speed, curve: vec![] })
    });
    let lines = lines.collect::<Option<Vec<GuideFriction>>>()?;
    let (acceleration, speed) = falls.first()?;
    let fastest = speed.values().last()?;
    let changes = |line: &GuideFriction| line.per_speed * fastest > CHANGES * line.force_at(*fastest).abs();
    let best = lines.first()?;
    if lines.iter().all(changes) && best.constant > 0.0 {
        return Some(best.clone());
    }
    let forces = || acceleration.values().iter().map(|a| force(*a));
    if lines.iter().all(changes) {
        let per_speed = forces().zip(speed.values()).map(|(f, u)| f * u).sum::<f64>()
            / speed.values().iter().map(|u| u * u).sum::<f64>();
        return Some(GuideFriction { per_speed, ..GuideFriction::default() });
    }
    let constant = forces().sum::<f64>() / acceleration.len() as f64;
    Some(GuideFriction { constant, ..GuideFriction::default() })
}

/// Acceleration and speed (downward) of the part of a fall.
fn fall(restored: &Series, window: [f64; 2]) -> (Series, Series) {
    let velocity = integrate::once(restored, 0.0).window(window);
    let speed = velocity.with_values(velocity.values().iter().map(|v| -v).collect());
    (restored.window(window), speed)
}
