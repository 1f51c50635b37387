//! Points that move, each with a colour of its own.

use re_sdk::{RecordingStream, RecordingStreamResult};
use re_sdk_types::archetypes::Points3D;
use re_sdk_types::components::{Color, Radius};

use crate::scene::PointTrack;
use crate::series::TIME;

/// Logs all states.
pub(crate) fn log(stream: &RecordingStream, track: &PointTrack) -> RecordingStreamResult<()> {
    for state in &track.states {
        stream.set_duration_secs(TIME, state.time);
        let colours = state.colours.iter().map(|[r, g, b]| Color::from_rgb(*r, *g, *b));
        let points = Points3D::new(state.positions.iter().copied())
            .with_colors(colours)
            .with_radii([Radius::from(track.radius)]);
        stream.log(format!("scene/{}", track.name), &points)?;
    }
    Ok(())
}
