//! The impactor as the recording shows it.

use droptower_viz::{BodyTrack, Pose};

use crate::engine::Surface;
use crate::report::body::Body;
use crate::simulate::Snapshot;

/// Sides of an impactor that is round.
const SIDES: u32 = 64;

/// The impactor in the states `snapshots`.
pub fn track(impactor: &Surface, snapshots: &[&Snapshot]) -> BodyTrack {
    let Body { points, triangles } = Body::of(impactor, SIDES);
    let poses = snapshots.iter().filter_map(|snapshot| pose(snapshot)).collect();
    BodyTrack { name: "impactor".to_owned(), points, triangles, poses }
}

/// Where the impactor is in a state.
pub fn pose(snapshot: &Snapshot) -> Option<Pose> {
    let (position, rotation) = snapshot.impactor?;
    Some(Pose { time: snapshot.time, position: position.map(|c| c as f32), rotation: rotation.map(|c| c as f32) })
}
