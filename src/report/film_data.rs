//! The film in 3-D as a page holds it: positions and strains in steps of one and two bytes, written and read back.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde::{Deserialize, Serialize};

use crate::coarse::bounds;
use crate::drawn::DIGITS;
use crate::geometry::{Moment, RunScene, SceneBody, SceneFace};
use base::number::rounded;
use scene::simulate::{FilmSpring, FilmState, Snapshot};

/// The byte of a strain that marks a failed element; others are below.
const FAILED: u8 = u8::MAX;

/// The data that the page's script draws.
#[derive(Debug, Serialize, Deserialize)]
pub(crate) struct FilmData {
    /// Least and largest coordinates of what is intact.
    #[serde(rename = "box")]
    ends: [[f32; 3]; 2],
    fibre: [f32; 2],
    shear: [f32; 2],
    faces: Vec<FaceData>,
    states: Vec<StateData>,
    /// What happens, and when, ms.
    moments: Vec<(String, f64)>,
    bodies: Vec<SceneBody>,
    #[serde(default)]
    coarsened: bool,
}

#[derive(Debug, Serialize, Deserialize)]
struct FaceData {
    nodes: usize,
    patches: String,
    mirrored: [bool; 2],
    /// Not in pages of earlier versions.
    #[serde(default)]
    held: Vec<[u32; 2]>,
    /// Ends of springs on the frame; their ends on the film are the last nodes.
    #[serde(default)]
    springs: Vec<[f64; 3]>,
}

#[derive(Debug, Serialize, Deserialize)]
struct StateData {
    /// ms.
    time: f64,
    places: String,
    strains: String,
    poses: Vec<[f64; 7]>,
}

impl FilmData {
    /// The data of a scene, the ends of whose springs are the last nodes of their faces.
    pub(crate) fn of_scene(scene: &RunScene) -> FilmData {
        let films = || scene.states.iter().flat_map(|state| scene.faces.iter().zip(&state.films));
        // Nodes of failed elements may be anywhere.
        let corners = films().flat_map(|(face, film)| {
            let intact = face.patches.iter().zip(&film.failed).filter(|(_, failed)| !**failed);
            intact.flat_map(|(patch, _)| patch.map(|node| film.positions[node as usize]))
        });
        let range = |of: fn(&[f32; 3]) -> [f32; 2]| {
            let intact = films().flat_map(|(_, film)| film.strains.iter().zip(&film.failed));
            let values = intact.filter(|(_, failed)| !**failed).flat_map(|(strains, _)| of(strains));
            let [low, high] = values.fold([0.0_f32, 0.0], |[low, high], value| [low.min(value), high.max(value)]);
            // Never empty.
            if high - low > 1e-6 { [low, high] } else { [low, low + 1e-6] }
        };
        let mut data = FilmData {
            ends: bounds(corners),
            // Compressive fibre strains have the colour of zero.
            fibre: range(|[md, td, _]| [md.max(0.0), td.max(0.0)]),
            shear: range(|[_, _, shear]| [*shear; 2]),
            faces: scene.faces.iter().map(FaceData::of_face).collect(),
            states: vec![],
            moments: scene.moments.iter().map(|Moment { words, time }| (words.clone(), milliseconds(*time))).collect(),
            bodies: scene.bodies.clone(),
            coarsened: scene.is_coarsened,
        };
        data.states = scene.states.iter().map(|state| data.state(state)).collect();
        data
    }

    /// The scene, with strains to a 254th of their range and positions to a 65 535th of the extent.
    ///
    /// # Errors
    /// The data are not those that a page has: it was changed, or written by another version.
    pub(crate) fn scene(self) -> Result<RunScene, String> {
        let faces = self.faces.iter().map(FaceData::face).collect::<Result<Vec<_>, _>>()?;
        for body in &self.bodies {
            check_corners(&body.patches, body.points.len())?;
        }
        let states = self.states.iter().map(|state| self.snapshot(state, &faces)).collect::<Result<Vec<_>, _>>()?;
        if states.is_empty() || !states.is_sorted_by(|a, b| a.time < b.time) {
            return Err(mismatch("times"));
        }
        let moments = self.moments.into_iter().map(|(words, time)| Moment { words, time: time * 1e-3 }).collect();
        Ok(RunScene { faces, bodies: self.bodies, states, moments, is_coarsened: self.coarsened })
    }

    fn ranges(&self) -> [[f32; 2]; 3] {
        [self.fibre, self.fibre, self.shear]
    }

    fn state(&self, state: &Snapshot) -> StateData {
        let places = state.films.iter().flat_map(|film| &film.positions).flat_map(|place| self.steps(place));
        let strains = state.films.iter().flat_map(|film| film.strains.iter().zip(&film.failed));
        let strains = strains.flat_map(|(strains, failed)| if *failed { [FAILED; 3] } else { self.shares(strains) });
        let pose = |(position, rotation): &([f64; 3], [f64; 4])| {
            let ([x, y, z], [i, j, k, w]) = (position, rotation);
            [x, y, z, i, j, k, w].map(|c| rounded(*c, DIGITS))
        };
        StateData {
            time: milliseconds(state.time),
            places: text(places.flat_map(u16::to_le_bytes)),
            strains: text(strains),
            poses: state.impactors.iter().map(pose).collect(),
        }
    }

    /// Coordinates as shares of the box along each axis.
    fn steps(&self, place: &[f32; 3]) -> [u16; 3] {
        let [low, high] = self.ends;
        [0, 1, 2].map(|axis| {
            let extent = high[axis] - low[axis];
            if extent > 0.0 { ((place[axis] - low[axis]) / extent * f32::from(u16::MAX)).round() as u16 } else { 0 }
        })
    }

    /// Strains as shares of their ranges, clamped to them.
    fn shares(&self, strains: &[f32; 3]) -> [u8; 3] {
        let ranges = self.ranges();
        [0, 1, 2].map(|part| {
            let [low, high] = ranges[part];
            ((strains[part] - low) / (high - low) * f32::from(FAILED - 1)).round() as u8
        })
    }

    fn snapshot(&self, state: &StateData, faces: &[SceneFace]) -> Result<Snapshot, String> {
        let [places, strains] = [decoded(&state.places)?, decoded(&state.strains)?];
        let (places, []) = places.as_chunks::<6>() else { return Err(mismatch("positions")) };
        let (strains, []) = strains.as_chunks::<3>() else { return Err(mismatch("strains")) };
        let count = |of: fn(&SceneFace) -> usize| faces.iter().map(of).try_fold(0_usize, usize::checked_add);
        if count(|face| face.nodes) != Some(places.len()) {
            return Err(mismatch("positions and nodes"));
        }
        if count(|face| face.patches.len()) != Some(strains.len()) {
            return Err(mismatch("strains and patches"));
        }
        if state.poses.len() != self.bodies.len() {
            return Err(mismatch("positions and bodies"));
        }
        let (mut places, mut strains) = (places, strains);
        let film = |face: &SceneFace| {
            let (own, rest) = places.split_at(face.nodes);
            let (of_patches, rest_of_patches) = strains.split_at(face.patches.len());
            (places, strains) = (rest, rest_of_patches);
            self.film(own, of_patches)
        };
        let films = faces.iter().map(film).collect();
        let pose = |&[x, y, z, i, j, k, w]: &[f64; 7]| ([x, y, z], [i, j, k, w]);
        Ok(Snapshot { time: state.time * 1e-3, films, impactors: state.poses.iter().map(pose).collect() })
    }

    /// One face from the steps of its positions and strains.
    fn film(&self, places: &[[u8; 6]], strains: &[[u8; 3]]) -> FilmState {
        let ([low, high], ranges) = (self.ends, self.ranges());
        let position = |steps: &[u8; 6]| {
            [0, 1, 2].map(|axis| {
                let step = u16::from_le_bytes([steps[2 * axis], steps[2 * axis + 1]]);
                low[axis] + f32::from(step) / f32::from(u16::MAX) * (high[axis] - low[axis])
            })
        };
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
}

impl FaceData {
    fn of_face(face: &SceneFace) -> FaceData {
        FaceData {
            nodes: face.nodes,
            patches: text(face.patches.iter().flatten().copied().flat_map(u32::to_le_bytes)),
            mirrored: face.mirrored,
            held: face.held.clone(),
            springs: face.springs.iter().map(|spring| spring.anchor.map(|c| rounded(f64::from(c), DIGITS))).collect(),
        }
    }

    fn face(&self) -> Result<SceneFace, String> {
        let bytes = decoded(&self.patches)?;
        let (corners, []) = bytes.as_chunks::<4>() else { return Err(mismatch("patches")) };
        let corners: Vec<u32> = corners.iter().map(|corner| u32::from_le_bytes(*corner)).collect();
        let (patches, []) = corners.as_chunks::<4>() else { return Err(mismatch("patches")) };
        check_corners(patches, self.nodes)?;
        check_corners(&self.held, self.nodes)?;
        let Some(first) = self.nodes.checked_sub(self.springs.len()) else { return Err(mismatch("springs")) };
        let spring = |(node, anchor): (usize, &[f64; 3])| {
            let node = u32::try_from(node).map_err(|_| mismatch("springs"))?;
            Ok(FilmSpring::at_node(node, anchor.map(|c| c as f32)))
        };
        let springs = (first..).zip(&self.springs).map(spring).collect::<Result<_, String>>()?;
        let (patches, held) = (patches.to_vec(), self.held.clone());
        Ok(SceneFace { nodes: self.nodes, patches, mirrored: self.mirrored, held, springs })
    }
}

/// Numbers of something that do not fit to those of another.
fn mismatch(what: &str) -> String {
    format!("{what} of the film do not fit together")
}

fn check_corners<const N: usize>(patches: &[[u32; N]], nodes: usize) -> Result<(), String> {
    let are_nodes = patches.iter().flatten().all(|corner| (*corner as usize) < nodes);
    if are_nodes { Ok(()) } else { Err(mismatch("corners and nodes")) }
}

fn text(bytes: impl IntoIterator<Item = u8>) -> String {
    STANDARD.encode(bytes.into_iter().collect::<Vec<u8>>())
}

fn decoded(text: &str) -> Result<Vec<u8>, String> {
    STANDARD.decode(text).map_err(|error| error.to_string())
}

fn milliseconds(time: f64) -> f64 {
    rounded(time * 1e3, DIGITS)
}

#[cfg(test)]
mod tests {
    use serde_json::{Value, json};

    use super::*;

    /// A square sheet of 3 × 3 quadrilaterals, of which the first has failed.
    fn scene() -> RunScene {
        let at = |node: u32| [(node % 4) as f32 / 3.0, (node / 4) as f32 / 3.0, 0.0];
        let corner = |at: u32| at / 3 * 4 + at % 3;
        let patches: Vec<[u32; 4]> =
            (0..9).map(|at| [corner(at), corner(at) + 1, corner(at) + 5, corner(at) + 4]).collect();
        let state = |time| {
            let film = FilmState {
                positions: (0..16).map(at).collect(),
                strains: vec![[0.1, 0.5, -0.2]; 9],
                failed: (0..9).map(|at| at == 0).collect(),
                ..FilmState::default()
            };
            Snapshot { time, films: vec![film], impactors: vec![([0.5, 0.25, 0.125], [0.0, 0.0, 0.6, 0.8])] }
        };
        RunScene {
            faces: vec![SceneFace { nodes: 16, patches, mirrored: [true; 2], held: vec![[0, 1]], springs: vec![] }],
            bodies: vec![SceneBody {
                points: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.5]],
                patches: vec![[0, 1, 2, 2]],
            }],
            states: [0.0, 1.5e-3].map(state).into(),
            moments: vec![Moment { words: "lowest point".into(), time: 1.5e-3 }],
            is_coarsened: false,
        }
    }

    /// As the page's script and a reader see it.
    fn written(scene: &RunScene) -> Value {
        serde_json::to_value(FilmData::of_scene(scene)).expect("JSON")
    }

    fn read(data: &Value) -> Result<RunScene, String> {
        FilmData::deserialize(data).map_err(|error| error.to_string()).and_then(FilmData::scene)
    }

    #[test]
    fn a_film_is_read_back_as_it_was_written() {
        let own = scene();
        let data = written(&own);
        let found = read(&data).expect("a film");
        assert_eq!((found.faces.len(), found.faces[0].nodes, found.faces[0].mirrored), (1, 16, [true; 2]));
        assert_eq!((&found.faces[0].patches, &found.faces[0].held), (&own.faces[0].patches, &own.faces[0].held));
        assert_eq!((&found.moments, found.is_coarsened), (&own.moments, false));
        assert_eq!((&found.bodies[0].points, found.bodies[0].patches[0]), (&own.bodies[0].points, [0, 1, 2, 2]));
        for (found, own) in found.states.iter().zip(&own.states) {
            assert_eq!((found.time, &found.impactors), (own.time, &own.impactors));
            let [film, own] = [&found.films[0], &own.films[0]];
            assert_eq!(film.failed, own.failed);
            let near = |a: &[f32; 3], b: &[f32; 3]| (0..3).all(|k| (a[k] - b[k]).abs() <= 2e-3);
            assert!(film.positions.iter().zip(&own.positions).all(|(a, b)| near(a, b)));
            assert!(film.strains.iter().zip(&own.strains).skip(1).all(|(a, b)| near(a, b)), "{:?}", film.strains);
        }
        let mut damaged = data;
        damaged["states"][0]["strains"] = "AAAA".into();
        let fault = |damaged: &Value| read(damaged).expect_err("a mismatch");
        assert_eq!(fault(&damaged), "strains and patches of the film do not fit together");
        damaged["faces"][0]["nodes"] = 5.into();
        assert_eq!(fault(&damaged), "corners and nodes of the film do not fit together");
    }

    #[test]
    fn failed_elements_do_not_extend_the_bounds() {
        let mut scene = scene();
        // A corner of the first element alone, which has failed.
        scene.states.iter_mut().for_each(|state| state.films[0].positions[0] = [-1e6; 3]);
        assert_eq!(written(&scene)["box"], json!([[0.0, 0.0, 0.0], [1.0, 1.0, 0.0]]));
    }
}
