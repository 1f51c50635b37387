//! The impactor as the recording shows it.

use droptower_viz::{BodyShape, BodyTrack, Pose};

use crate::mesh::MeshError;
use crate::model::Impactor;
use crate::report::body::Body;
use crate::simulate::Frame;

/// The impactor in the states `frames`.
pub fn track(impactor: &Impactor, frames: &[&Frame]) -> Result<BodyTrack, MeshError> {
    let shape = match Body::of(&impactor.shape)? {
        Body::Sphere { radius } => BodyShape::Sphere { radius },
        Body::Revolved { profile } => BodyShape::Revolved { profile },
        Body::Surface { points, triangles } => BodyShape::Surface { points, triangles },
    };
    Ok(BodyTrack { name: "impactor".to_owned(), shape, poses: frames.iter().filter_map(|frame| pose(frame)).collect() })
}

/// Where the impactor is in a state.
pub fn pose(frame: &Frame) -> Option<Pose> {
    let (position, rotation) = frame.impactor?;
    Some(Pose { time: frame.time, position: position.map(|c| c as f32), rotation: rotation.map(|c| c as f32) })
}
