//! The impactor of a recording.

use droptower_viz::{BodyTrack, Pose};

use crate::engine::Surface;
use crate::report::body::Body;
use crate::simulate::Snapshot;

/// Sides of a round impactor.
const SIDES: u32 = 64;

/// The impactor in the snapshots.
pub(super) fn track(impactor: &Surface, snapshots: &[&Snapshot]) -> BodyTrack {
    let Body { points, triangles } = Body::of(impactor, SIDES);
    let poses = snapshots.iter().filter_map(|snapshot| pose(snapshot)).collect();
    BodyTrack { name: "impactor".to_owned(), points, triangles, poses }
}

/// The pose of the impactor in a snapshot.
pub(super) fn pose(snapshot: &Snapshot) -> Option<Pose> {
    let (position, rotation) = snapshot.impactor?;
    Some(Pose { time: snapshot.time, position: position.map(|c| c as f32), rotation: rotation.map(|c| c as f32) })
}
