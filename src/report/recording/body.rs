//! The impactors of a recording.

use viz::{BodyTrack, Pose};

use crate::body::Body;
use membrane::engine::Surface;
use scene::model::Model;
use scene::simulate::Snapshot;

/// Sides of a round impactor.
const SIDES: u32 = 64;

/// The impactors of `model` in the snapshots, and the bars of its frame.
pub(super) fn tracks(model: &Model, impactors: &[Surface], snapshots: &[&Snapshot]) -> Vec<BodyTrack> {
    let track = |(index, (surface, name)): (usize, (&Surface, Option<&str>))| {
        let Body { points, triangles } = Body::from_surface(surface, SIDES);
        let poses = snapshots.iter().filter_map(|snapshot| poses(snapshot).nth(index)).collect();
        let name = name.map_or_else(|| "impactor".to_owned(), |name| format!("impactors/{name}"));
        BodyTrack { name, points, triangles, poses }
    };
    let bars = model.frame.bars.map(|_| Some("frame"));
    let mut tracks: Vec<BodyTrack> =
        impactors.iter().zip(model.names().into_iter().chain(bars)).enumerate().map(track).collect();
    if let Some(frame) = tracks.last_mut().filter(|_| bars.is_some()) {
        frame.name = "frame".to_owned();
    }
    tracks
}

/// The poses of the impactors in a snapshot.
pub(super) fn poses(snapshot: &Snapshot) -> impl Iterator<Item = Pose> {
    snapshot.impactors.iter().map(|(position, rotation)| Pose {
        time: snapshot.time,
        position: position.map(|c| c as f32),
        rotation: rotation.map(|c| c as f32),
    })
}
