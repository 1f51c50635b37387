//! Snapshots of the scene for pictures.

use std::ops::Range;

use serde::{Deserialize, Serialize};

use super::film::Film;
use crate::model::{DETAIL_BYTES, SNAPSHOT_BYTES, SNAPSHOT_MEMORY};
use membrane::engine::{self, ElementDetail, ElementStrain, SpringLoad, View};

/// State of the whole scene at one time.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Snapshot {
    /// Time, s.
    pub time: f64,
    /// The faces of film.
    pub films: Vec<FilmState>,
    /// Position (m) and rotation (unit quaternion i, j, k, w) of the impactors, and after them of the frame's bars.
    pub impactors: Vec<([f64; 3], [f64; 4])>,
}

/// State of one face at one time.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct FilmState {
    /// m, one entry a node.
    pub positions: Vec<[f32; 3]>,
    /// Engineering strain of the MD and TD fibres and shear angle, one entry an element (quads, then triangles).
    pub strains: Vec<[f32; 3]>,
    /// Whether the MD or TD fibres of all layers are broken in an element, one entry an element.
    pub failed: Vec<bool>,
    /// Thickness over that of stress-free film, one entry an element; empty where the law does not give it.
    pub thickness_ratio: Vec<f32>,
    /// Equivalent plastic strain, one entry an element; empty where the law has none.
    pub plastic_strain: Vec<f32>,
    /// Share of its forces that an element lost by tearing, one entry an element; empty where film has no rupture criterion
    /// of its own.
    pub damage: Vec<f32>,
    /// Growth of the temperature since film was mounted, K, one entry an element; empty where film does not warm up.
    pub warming: Vec<f32>,
    /// Nodes of the face in contact with an impactor or the frame's bars, ascending.
    pub in_contact: Vec<u32>,
    /// Stresses and more, where the run takes detailed snapshots
    /// ([`RunOptions::detailed`](super::RunOptions::detailed)).
    pub detail: Option<Detail>,
}

/// Velocities, stresses and more of the state of a face.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Detail {
    /// m/s, one entry a node.
    pub velocities: Vec<[f32; 3]>,
    /// Nominal stresses along MD and TD and in shear, Pa of one layer on its stress-free cross-section, one entry
    /// an element, as all that follow.
    pub stresses: Vec<[f32; 3]>,
    /// Largest MD and TD strain so far.
    pub peaks: Vec<[f32; 2]>,
    /// Share of the layers whose MD and TD fibres are not broken.
    pub left: Vec<[f32; 2]>,
    /// Images of unit vectors along MD and TD of the stress-free film: their directions are those of the fibres, their
    /// lengths the stretches.
    pub fibres: Vec<[[f32; 3]; 2]>,
    /// The springs of the frame on which the face hangs, in the order of [`Film::springs`].
    pub springs: Vec<SpringDetail>,
}

/// State of a spring between the frame and a face.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SpringDetail {
    /// m.
    pub elongation: f32,
    /// N; positive in tension.
    pub force: f32,
}

/// Number of snapshots of `films` where `wanted` are requested: as many as fit into [`SNAPSHOT_MEMORY`], at least the
/// first and the last.
pub(super) fn count(wanted: usize, films: &[Film], detailed: bool) -> usize {
    let elements: usize = films.iter().map(|film| film.quads.len() + film.tris.len()).sum();
    let per_element = if detailed { SNAPSHOT_BYTES + DETAIL_BYTES } else { SNAPSHOT_BYTES };
    wanted.min(((SNAPSHOT_MEMORY / (per_element * elements as f64)) as usize).max(2))
}

/// The scene as `view` shows it, `detailed` or not; `strains` are those of its faces.
pub(super) fn snapshot(view: &View<'_>, strains: &[Vec<ElementStrain>], detailed: bool) -> Snapshot {
    let in_contact = view.nodes_in_contact();
    let film = |(film, strains): (&engine::Film, &Vec<ElementStrain>)| {
        let is_needed = detailed || film.has_thickness() || film.has_rupture() || film.warms_up();
        let details = if is_needed { film.details(&view.nodes.position) } else { vec![] };
        let thickness = details.iter().filter(|_| film.has_thickness()).map(|of| of.thickness_ratio as f32);
        let plastic = details.iter().filter(|_| film.is_plastic()).map(|of| of.plastic_strain as f32);
        let damage = details.iter().filter(|_| film.has_rupture()).map(|of| of.damage as f32);
        let warming = details.iter().filter(|_| film.warms_up()).map(|of| of.warming as f32);
        FilmState {
            positions: film.nodes.clone().map(|n| view.nodes.position.value_at(n).map(|x| x as f32)).collect(),
            strains: strains.iter().map(|s| s.strain.map(|x| x as f32)).collect(),
            failed: strains.iter().map(ElementStrain::has_failed).collect(),
            thickness_ratio: thickness.collect(),
            plastic_strain: plastic.collect(),
            damage: damage.collect(),
            warming: warming.collect(),
            in_contact: of_face(&in_contact, &film.nodes),
            detail: detailed.then(|| detail(view, film, strains, &details)),
        }
    };
    let poses = view.bodies().map(|body| {
        let (position, rotation) = (body.pose.translation.vector, body.pose.rotation.coords);
        ([position.x, position.y, position.z], [rotation.x, rotation.y, rotation.z, rotation.w])
    });
    Snapshot { time: view.time, films: view.films.iter().zip(strains).map(film).collect(), impactors: poses.collect() }
}

fn detail(view: &View<'_>, film: &engine::Film, strains: &[ElementStrain], details: &[ElementDetail]) -> Detail {
    let mut out = Detail {
        velocities: film.nodes.clone().map(|n| view.velocity(n).map(|v| v as f32)).collect(),
        peaks: strains.iter().map(|s| s.peak.map(|e| e as f32)).collect(),
        left: strains.iter().map(|s| s.left.map(|e| e as f32)).collect(),
        springs: view.spring_loads(&film.nodes).into_iter().map(spring).collect(),
        ..Detail::default()
    };
    for ElementDetail { stress, fibres, .. } in details {
        out.stresses.push(stress.map(|s| s as f32));
        out.fibres.push(fibres.map(|f| f.map(|x| x as f32)));
    }
    out
}

fn spring(SpringLoad { elongation, force }: SpringLoad) -> SpringDetail {
    SpringDetail { elongation: elongation as f32, force: force as f32 }
}

/// The nodes in contact that belong to one face, counted from its first, ascending.
fn of_face(in_contact: &[usize], nodes: &Range<usize>) -> Vec<u32> {
    let mut own: Vec<u32> =
        in_contact.iter().filter(|node| nodes.contains(*node)).map(|node| (node - nodes.start) as u32).collect();
    own.sort_unstable();
    own
}
