//! Channels sampled from the state of film and frame: a row each.

use super::frame::Crest;
use super::frame_force::HeldSides;
use super::tracks::Tracks;
use lab::signal::column::{self, Column};
use lab::signal::{Channel, Recording};
use membrane::engine::{FilmContactState, SpringsState, Torn, View};

/// The state of a run at a sample, with what takes time to compute or is also checked against a bound.
pub(super) struct Sample<'a> {
    /// State of the engine.
    pub(super) view: &'a View<'a>,
    /// Sides held by the frame.
    pub(super) held: &'a HeldSides,
    /// The held edge on the crest of the frame's bars.
    pub(super) crest: &'a Crest,
    /// Largest rise of a node of inflated film, m.
    pub(super) rise: Option<f64>,
    /// Largest slip in the frame's clamp (m), and the share of it that holds film no longer.
    pub(super) clamp: Option<[f64; 2]>,
    /// State of the springs on which film hangs.
    pub(super) springs: Option<SpringsState>,
    /// Contact between faces.
    pub(super) films: Option<FilmContactState>,
    /// Tears.
    pub(super) torn: Option<Torn>,
}

/// A channel that is sampled.
struct Sampled {
    column: Column,
    /// Its value in a sample; none of a run that does not have the channel.
    value: fn(&Sample<'_>) -> Option<f64>,
    /// Its value in the column at sample `k`, from what was sampled and interpolated to the time of `k`.
    finish: fn(&Tracks, usize, f64) -> f64,
}

/// The sampled channels, in the order of `signals.csv`.
const SAMPLED: &[Sampled] = &[
    sampled(column::FRAME_FORCE_X, |s| s.held.force(s.view, 0)),
    sampled(column::FRAME_FORCE_Y, |s| s.held.force(s.view, 1)),
    Sampled {
        finish: on_bars,
        ..sampled(column::FRAME_FORCE, |s| s.crest.force(s.view.nodes).or_else(|| s.view.spring_force()))
    },
    sampled(column::CLAMP_SLIP, |s| s.clamp.map(|[slip, _]| slip)),
    sampled(column::SPRING_ELONGATION, |s| Some(s.springs?.elongation)),
    sampled(column::SPRING_FORCE, |s| Some(s.springs?.force)),
    sampled(column::AIR_PRESSURE, |s| s.view.cushion_pressure()),
    sampled(column::FILM_DISTANCE, |s| Some(s.films?.distance)),
    Sampled {
        finish: |_, _, nodes| nodes.round(),
        ..sampled(column::FILM_CONTACT_NODES, |s| Some(s.films?.nodes as f64))
    },
    sampled(column::TORN_LENGTH, |s| Some(s.torn?.length)),
    sampled(column::TORN_AREA, |s| Some(s.torn?.area)),
    sampled(column::FRACTURE_ENERGY, |s| Some(s.torn?.energy)),
    sampled(column::DEFLECTION, |s| s.rise),
    sampled(column::PRESSURE, |s| Some(s.view.inflated()?[0])),
    sampled(column::VOLUME, |s| Some(s.view.inflated()?[1])),
];

/// A channel whose values are as they were sampled.
const fn sampled(column: Column, value: fn(&Sample<'_>) -> Option<f64>) -> Sampled {
    Sampled { column, value, finish: |_, _, value| value }
}

/// Vertical force on the frame at sample `k`, N: that of springs or of the edge on the `crest` of bars, and what film and
/// impactors push these by.
fn on_bars(tracks: &Tracks, k: usize, crest: f64) -> f64 {
    tracks.bars.as_ref().map_or(crest, |bars| crest - bars.contact_force(k) - bars.collision_force(k))
}

/// Adds the values of a sample to `tracks`.
pub(super) fn take(sample: &Sample<'_>, tracks: &mut Tracks) {
    for Sampled { column, value, .. } in SAMPLED {
        if let Some(value) = value(sample) {
            tracks.sample(column, sample.view.time, value);
        }
    }
}

/// Adds the sampled channels to the `signals` of a loading, but for those that it has placed itself.
pub(super) fn add(tracks: &Tracks, signals: &mut Recording) {
    for Sampled { column, finish, .. } in SAMPLED {
        let values = tracks.sampled(column);
        if !values.is_empty() && signals.channel(column.name).is_none() {
            let values = values.iter().take(signals.time.len()).enumerate();
            let values = values.map(|(k, value)| finish(tracks, k, *value)).collect();
            signals.channels.push(Channel { name: column.name.into(), values });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulate::tracks::Sampling;

    #[test]
    fn sampled_channels_follow_those_that_a_loading_placed_itself() {
        let mut tracks = Tracks::new(Sampling::new(1.0, 0.5), vec![], None);
        for time in [0.0, 0.5, 1.0] {
            tracks.sample(&column::PRESSURE, time, 1.0);
            tracks.sample(&column::FILM_CONTACT_NODES, time, 2.6);
        }
        let mut signals = tracks.table(&[column::PRESSURE.name], &[[5.0], [6.0]]);
        add(&tracks, &mut signals);
        let expected = [("pressure_Pa", vec![5.0, 6.0]), ("film_contact_nodes", vec![3.0, 3.0])];
        let expected = expected.map(|(name, values)| Channel { name: name.into(), values });
        assert_eq!(signals.channels, expected);
    }
}
