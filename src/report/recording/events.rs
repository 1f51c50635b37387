//! What happened, for the recording's log.

use droptower_viz::{Event, Moment, Severity};

use crate::signal::Recording;
use crate::simulate::Outcome;

/// First contact, extremes, rupture and warnings, in the order of time.
pub fn of(outcome: &Outcome, signals: &Recording) -> Vec<Event> {
    let info = |time: f64, text: String| (time, Severity::Info, text);
    let warning = |time: f64, text: String| (time, Severity::Warning, text);
    let contact = first_contact(signals).map(|time| info(time, "first contact".to_owned()));
    let braking = extreme(signals, "acceleration_filtered_m_s2", 1.0)
        .map(|(time, peak)| info(time, format!("peak deceleration {peak:.1} m/s²")));
    let lowest = extreme(signals, "displacement_m", -1.0)
        .filter(|_| outcome.frames.iter().any(|frame| frame.impactor.is_some()))
        .map(|(time, peak)| info(time, format!("lowest point {:.1} mm", 1e3 * peak)));
    let rupture = outcome.rupture_time;
    let rupture = rupture.map(|time| warning(time, "first element breaks".to_owned()));
    let end = signals.time.last().copied().unwrap_or_default();
    let warnings = outcome.warnings.iter().map(|text| warning(end, text.clone()));
    let mut events: Vec<_> = [contact, braking, lowest, rupture].into_iter().flatten().chain(warnings).collect();
    events.sort_by(|a, b| a.0.total_cmp(&b.0));
    let event = |(time, severity, text)| Event { at: Moment::Time(time), severity, text };
    events.into_iter().map(event).collect()
}

fn first_contact(signals: &Recording) -> Option<f64> {
    let force = signals.channel("contact_force_N")?;
    let first = force.iter().position(|force| *force > 0.0)?;
    signals.time.get(first).copied()
}

/// Time and value of the largest sample of a channel, or of the smallest where `sign` is -1.
fn extreme(signals: &Recording, channel: &str, sign: f64) -> Option<(f64, f64)> {
    let samples = signals.time.iter().zip(signals.channel(channel)?);
    let finite = samples.filter(|(_, value)| value.is_finite());
    let largest = finite.max_by(|(_, a), (_, b)| (sign * **a).total_cmp(&(sign * **b)))?;
    Some((*largest.0, *largest.1))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::signal::Channel;

    #[test]
    fn contact_and_extremes_are_found_at_their_times() {
        let channel = |name: &str, values: [f64; 4]| Channel { name: name.to_owned(), values: values.to_vec() };
        let signals = Recording {
            time: vec![0.0, 0.1, 0.2, 0.3],
            channels: vec![
                channel("contact_force_N", [0.0, 3.0, 5.0, 0.0]),
                channel("displacement_m", [0.0, -0.1, -0.2, f64::NAN]),
            ],
        };
        assert_eq!(first_contact(&signals), Some(0.1));
        assert_eq!(extreme(&signals, "displacement_m", -1.0), Some((0.2, -0.2)));
        assert_eq!(extreme(&signals, "velocity_m_s", 1.0), None);
    }
}
