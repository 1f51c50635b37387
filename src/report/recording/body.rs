//! The impactor as the recording shows it.

use droptower_viz::{BodyTrack, Pose};

use crate::engine::Surface;
use crate::report::body::Body;
use crate::simulate::Frame;

/// Sides of an impactor that is round.
const SIDES: u32 = 64;

/// The impactor in the states `frames`.
pub fn track(impactor: &Surface, frames: &[&Frame]) -> BodyTrack {
    let Body { points, triangles } = Body::of(impactor, SIDES);
    let poses = frames.iter().filter_map(|frame| pose(frame)).collect();
    BodyTrack { name: "impactor".to_owned(), points, triangles, poses }
}

/// Where the impactor is in a state.
pub fn pose(frame: &Frame) -> Option<Pose> {
    let (position, rotation) = frame.impactor?;
    Some(Pose { time: frame.time, position: position.map(|c| c as f32), rotation: rotation.map(|c| c as f32) })
}
