//! What happened, for the recording's log.

use droptower_viz::{Event, Moment, Severity};

use crate::report::RunPage;
use crate::signal::Recording;

/// First contact, extremes, rupture, rebound and warnings in the order of time, and what the post script said.
pub fn of(run: &RunPage) -> Vec<Event> {
    let signals = &run.results.signals;
    let end = signals.time.last().copied().unwrap_or_default();
    let rupture = run.outcome.rupture_time.map(|time| (time, Severity::Warning, "first element breaks".to_owned()));
    let failure = run.failure.map(|cause| (end, Severity::Warning, format!("the run broke off: {cause}")));
    let warnings = run.results.measures.warnings().iter().map(|text| (end, Severity::Warning, text.clone()));
    let said = run.results.findings.log.iter().map(|text| (end, Severity::Info, text.clone()));
    let motion = motion(signals).into_iter().map(|(time, text)| (time, Severity::Info, text));
    let mut all: Vec<_> = motion.chain(rupture).chain(failure).chain(warnings).chain(said).collect();
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    all.into_iter().map(|(time, severity, text)| Event { at: Moment::Time(time), severity, text }).collect()
}

/// How an impactor fares.
fn motion(signals: &Recording) -> Vec<(f64, String)> {
    let Some(force) = signals.channel("contact_force_N") else { return vec![] };
    let contact = force.iter().position(|force| *force > 0.0).map(|k| (k, "first contact".to_owned()));
    let braking = extreme(signals, "acceleration_filtered_m_s2", 1.0)
        .map(|(k, peak)| (k, format!("largest deceleration, {peak:.1} m/s²")));
    // At the end of what was sampled it may go on.
    let lowest = extreme(signals, "displacement_m", -1.0).filter(|(k, _)| k + 1 < force.len());
    let lowest = lowest.map(|(k, depth)| (k, format!("lowest point, {:.1} mm", 1e3 * depth)));
    let rebound = lowest.as_ref().and_then(|(k, _)| rebound(signals, force, *k));
    let timed = |(k, text)| Some((*signals.time.get(k)?, text));
    [contact, braking, lowest, rebound].into_iter().flatten().filter_map(timed).collect()
}

/// The first sample from which on nothing touches any more, with the speed there.
fn rebound(signals: &Recording, force: &[f64], lowest: usize) -> Option<(usize, String)> {
    let left = force.iter().rposition(|force| *force > 0.0)? + 1;
    let speed = signals.channel("velocity_m_s")?.get(left)?;
    (left > lowest && *speed > 0.0).then(|| (left, format!("leaves the film at {speed:.2} m/s")))
}

/// Index and value of the largest sample of a channel, or of the smallest where `sign` is -1.
fn extreme(signals: &Recording, channel: &str, sign: f64) -> Option<(usize, f64)> {
    let samples = signals.channel(channel)?.iter().copied().enumerate();
    let finite = samples.filter(|(_, value)| value.is_finite());
    finite.max_by(|(_, a), (_, b)| (sign * a).total_cmp(&(sign * b)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::signal::Channel;

    #[test]
    fn an_impactor_touches_turns_and_leaves() {
        let channel = |name: &str, values: [f64; 5]| Channel { name: name.to_owned(), values: values.to_vec() };
        let signals = |force| Recording {
            time: vec![0.0, 0.1, 0.2, 0.3, 0.4],
            channels: vec![
                channel("contact_force_N", force),
                channel("displacement_m", [0.0, -0.1, -0.2, -0.1, f64::NAN]),
                channel("velocity_m_s", [-4.0, -3.0, 0.0, 1.0, 1.5]),
            ],
        };
        let told = |force| motion(&signals(force)).into_iter().map(|(time, text)| format!("{time} {text}"));
        let bounced: Vec<String> = told([0.0, 3.0, 5.0, 1.0, 0.0]).collect();
        assert_eq!(bounced, ["0.1 first contact", "0.2 lowest point, -200.0 mm", "0.4 leaves the film at 1.50 m/s"]);
        assert_eq!(told([0.0, 3.0, 5.0, 1.0, 1.0]).count(), 2, "it stays in touch");
        assert_eq!(motion(&Recording::default()), []);
    }
}
