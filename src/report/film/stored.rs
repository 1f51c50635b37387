//! The film of a page, read back: the inverse of the figure that is written.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde::Deserialize;
use serde_json::Value;
use thiserror::Error;

use super::FAILED;
use crate::{Moment, RunScene, SceneBody, SceneFace};
use scene::simulate::{FilmSpring, FilmState, Snapshot};

/// Why the film of a page cannot be read; the page was changed, or written by another version.
#[derive(Debug, Error)]
pub enum FilmError {
    /// The data are not those of a film.
    #[error("{0}")]
    Json(#[from] serde_json::Error),
    /// Bytes are not base64.
    #[error("{0}")]
    Base64(#[from] base64::DecodeError),
    /// A number of something does not fit to that of another.
    #[error("{what} of the film do not fit together")]
    Mismatch {
        /// Plural, in the words of the field.
        what: &'static str,
    },
}

#[derive(Deserialize)]
struct Data {
    #[serde(rename = "box")]
    ends: [[f32; 3]; 2],
    fibre: [f32; 2],
    shear: [f32; 2],
    faces: Vec<FaceData>,
    states: Vec<StateData>,
    moments: Vec<(String, f64)>,
    bodies: Vec<BodyData>,
    #[serde(default)]
    coarsened: bool,
}

#[derive(Deserialize)]
struct FaceData {
    nodes: usize,
    patches: String,
    mirrored: [bool; 2],
    /// Ends of springs on the frame; their ends on the film are the last nodes.
    #[serde(default)]
    springs: Vec<[f32; 3]>,
}

#[derive(Deserialize)]
struct StateData {
    time: f64,
    places: String,
    strains: String,
    poses: Vec<[f64; 7]>,
}

#[derive(Deserialize)]
struct BodyData {
    points: Vec<[f32; 3]>,
    patches: Vec<[u32; 4]>,
}

/// The scene in the data of a page's film.
///
/// # Errors
/// The data are not those that a page has.
pub(crate) fn scene(data: &Value) -> Result<RunScene, FilmError> {
    let data = Data::deserialize(data)?;
    let faces = data.faces.iter().map(face).collect::<Result<Vec<_>, _>>()?;
    let bodies = data.bodies.iter().map(body).collect::<Result<Vec<_>, _>>()?;
    let states = data.states.iter().map(|written| state(written, &data, &faces)).collect::<Result<Vec<_>, _>>()?;
    if states.is_empty() || !states.is_sorted_by(|a, b| a.time < b.time) {
        return Err(FilmError::Mismatch { what: "times" });
    }
    let moments = data.moments.into_iter().map(|(words, time)| Moment { words, time: time * 1e-3 }).collect();
    Ok(RunScene { faces, bodies, states, moments, is_coarsened: data.coarsened })
}

fn face(FaceData { nodes, patches, mirrored, springs }: &FaceData) -> Result<SceneFace, FilmError> {
    let bytes = STANDARD.decode(patches)?;
    let (corners, []) = bytes.as_chunks::<4>() else { return Err(FilmError::Mismatch { what: "patches" }) };
    let corners: Vec<u32> = corners.iter().map(|corner| u32::from_le_bytes(*corner)).collect();
    let (patches, []) = corners.as_chunks::<4>() else { return Err(FilmError::Mismatch { what: "patches" }) };
    check_corners(patches, *nodes)?;
    let Some(first) = nodes.checked_sub(springs.len()) else { return Err(FilmError::Mismatch { what: "springs" }) };
    let spring = |(node, anchor): (usize, &[f32; 3])| {
        let node = u32::try_from(node).map_err(|_| FilmError::Mismatch { what: "springs" })?;
        Ok(FilmSpring { anchor: *anchor, nodes: [node; 2], shares: [1.0, 0.0] })
    };
    let springs = (first..).zip(springs).map(spring).collect::<Result<_, FilmError>>()?;
    Ok(SceneFace { nodes: *nodes, patches: patches.to_vec(), mirrored: *mirrored, springs })
}

fn body(BodyData { points, patches }: &BodyData) -> Result<SceneBody, FilmError> {
    check_corners(patches, points.len())?;
    Ok(SceneBody { points: points.clone(), patches: patches.clone() })
}

fn check_corners(patches: &[[u32; 4]], nodes: usize) -> Result<(), FilmError> {
    let are_nodes = patches.iter().flatten().all(|corner| (*corner as usize) < nodes);
    if are_nodes { Ok(()) } else { Err(FilmError::Mismatch { what: "corners and nodes" }) }
}

fn state(written: &StateData, data: &Data, faces: &[SceneFace]) -> Result<Snapshot, FilmError> {
    let [places, strains] = [STANDARD.decode(&written.places)?, STANDARD.decode(&written.strains)?];
    let (places, []) = places.as_chunks::<6>() else { return Err(FilmError::Mismatch { what: "positions" }) };
    let (strains, []) = strains.as_chunks::<3>() else { return Err(FilmError::Mismatch { what: "strains" }) };
    let count = |of: fn(&SceneFace) -> usize| faces.iter().map(of).try_fold(0_usize, usize::checked_add);
    if count(|face| face.nodes) != Some(places.len()) {
        return Err(FilmError::Mismatch { what: "positions and nodes" });
    }
    if count(|face| face.patches.len()) != Some(strains.len()) {
        return Err(FilmError::Mismatch { what: "strains and patches" });
    }
    if written.poses.len() != data.bodies.len() {
        return Err(FilmError::Mismatch { what: "positions and bodies" });
    }
    let (mut places, mut strains) = (places, strains);
    let mut film = |face: &SceneFace| {
        let (own, rest) = places.split_at(face.nodes);
        let (of_patches, rest_of_patches) = strains.split_at(face.patches.len());
        (places, strains) = (rest, rest_of_patches);
        film(own, of_patches, data)
    };
    let films = faces.iter().map(&mut film).collect();
    let pose = |&[x, y, z, i, j, k, w]: &[f64; 7]| ([x, y, z], [i, j, k, w]);
    Ok(Snapshot { time: written.time * 1e-3, films, impactors: written.poses.iter().map(pose).collect() })
}

/// One face from the steps of its positions and strains.
fn film(places: &[[u8; 6]], strains: &[[u8; 3]], data: &Data) -> FilmState {
    let [low, high] = data.ends;
    let position = |steps: &[u8; 6]| {
        [0, 1, 2].map(|axis| {
            let step = u16::from_le_bytes([steps[2 * axis], steps[2 * axis + 1]]);
            low[axis] + f32::from(step) / f32::from(u16::MAX) * (high[axis] - low[axis])
        })
    };
    let ranges = [data.fibre, data.fibre, data.shear];
    let strain = |steps: &[u8; 3]| {
        [0, 1, 2].map(|part| {
            let [low, high] = ranges[part];
            low + f32::from(steps[part]) / f32::from(FAILED - 1) * (high - low)
        })
    };
    FilmState {
        positions: places.iter().map(position).collect(),
        strains: strains.iter().map(strain).collect(),
        failed: strains.iter().map(|steps| steps[0] == FAILED).collect(),
        ..FilmState::default()
    }
}
