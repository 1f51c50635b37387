//! The log of a recording: events of the run, findings, and the log of the post script.

use viz::{Event, Severity};

use crate::RunPage;
use base::number::duration;
use lab::signal::Recording;
use lab::signal::column::{self, Column};
use study::post::lowest_point;

/// First contact, extremes, release, rupture and findings in the order of time, and the log of the post script.
pub(super) fn listed(run: &RunPage) -> Vec<Event> {
    let signals = &run.results.signals;
    let end = signals.time.last().copied().unwrap_or_default();
    let rupture = run.outcome.rupture_time.map(|time| (time, Severity::Warning, "first element fails".to_owned()));
    let failure = run.failure.map(|cause| (end, Severity::Warning, format!("the run failed: {cause}")));
    let warnings = run.results.measures.findings().iter().map(|found| {
        let severity = if found.is_warning() { Severity::Warning } else { Severity::Info };
        (end, severity, format!("{} [{}]", found.message, found.code))
    });
    let logged = run.results.script_output.log.iter().map(|text| (end, Severity::Info, text.clone()));
    let named = run.model.names().into_iter().zip(run.model.prefixes());
    let motion = named.flat_map(|(name, prefix)| {
        let of = name.map_or_else(String::new, |name| format!("{name}: "));
        motion(signals, &prefix).into_iter().map(move |(time, text)| (time, Severity::Info, format!("{of}{text}")))
    });
    // The column of times in the viewer is too narrow for them.
    let timed = |(time, severity, text)| (time, severity, format!("{}: {text}", duration(time)));
    let mut all: Vec<_> = motion.chain(rupture).map(timed).chain(failure).chain(warnings).chain(logged).collect();
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    all.into_iter().map(|(time, severity, text)| Event { time, severity, text }).collect()
}

/// First contact, largest deceleration, lowest point and release of the impactor whose channels begin with `prefix`.
fn motion(signals: &Recording, prefix: &str) -> Vec<(f64, String)> {
    let name = |column: Column| format!("{prefix}{}", column.name);
    let Some(force) = signals.channel(&name(column::CONTACT_FORCE)) else { return vec![] };
    let contact = force.iter().position(|force| *force != 0.0).map(|k| (k, "first contact".to_owned()));
    let braking = largest(signals, &name(column::ACCELERATION_FILTERED))
        .map(|(k, peak)| (k, format!("largest deceleration, {peak:.1} m/s²")));
    let lowest = lowest_point(signals, prefix);
    let velocity = signals.channel(&name(column::VELOCITY)).unwrap_or_default();
    let release = lowest.and_then(|[time, _]| release(&signals.time, [force, velocity], time));
    let lowest = lowest.map(|[time, depth]| (time, format!("lowest point, {:.1} mm", 1e3 * depth)));
    let timed = |(k, text)| Some((*signals.time.get(k)?, text));
    [contact, braking].into_iter().flatten().filter_map(timed).chain(lowest).chain(release).collect()
}

/// Share of the largest contact force below which the impactor is released: slack film may come into contact with it
/// as it rises.
const RELEASED: f64 = 0.01;

/// When contact ends after the lowest point at the time `lowest` (s), and the speed of the impactor then.
fn release(time: &[f64], [force, velocity]: [&[f64]; 2], lowest: f64) -> Option<(f64, String)> {
    let least = RELEASED * force.iter().copied().fold(0.0, f64::max);
    let left = force.iter().rposition(|force| *force > least)? + 1;
    let speed = velocity.get(left)?;
    let time = *time.get(left)?;
    (time > lowest && *speed > 0.0).then(|| (time, format!("release at {speed:.2} m/s")))
}

/// Index and value of the largest sample of a channel.
fn largest(signals: &Recording, channel: &str) -> Option<(usize, f64)> {
    let samples = signals.channel(channel)?.iter().copied().enumerate();
    let finite = samples.filter(|(_, value)| value.is_finite());
    finite.max_by(|(_, a), (_, b)| a.total_cmp(b))
}

#[cfg(test)]
mod tests {
    use super::*;
    use lab::signal::Channel;

    #[test]
    fn contact_lowest_point_and_release_are_logged() {
        let channel = |name: &str, values: [f64; 5]| Channel { name: name.to_owned(), values: values.to_vec() };
        let signals = |force| Recording {
            time: vec![0.0, 0.1, 0.2, 0.3, 0.4],
            channels: vec![
                channel("contact_force_N", force),
                channel("displacement_m", [0.0, -0.1, -0.2, -0.1, f64::NAN]),
                channel("velocity_m_s", [-4.0, -3.0, 0.0, 1.0, 1.5]),
            ],
        };
        let texts = |force| motion(&signals(force), "").into_iter().map(|(time, text)| format!("{time} {text}"));
        let bounced: Vec<String> = texts([0.0, 3.0, 5.0, 1.0, 0.0]).collect();
        assert_eq!(bounced, ["0.1 first contact", "0.2 lowest point, -200.0 mm", "0.4 release at 1.50 m/s"]);
        assert_eq!(texts([0.0, 3.0, 5.0, 1.0, 1.0]).count(), 2, "the impactor stays in contact");
        assert!(
            texts([0.0, 300.0, 500.0, 1.0, 1.0]).any(|line| line == "0.3 release at 1.00 m/s"),
            "slack film may come into contact with it"
        );
        assert_eq!(motion(&Recording::default(), ""), []);
    }
}
