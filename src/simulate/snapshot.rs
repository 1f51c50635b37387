//! Snapshots of the scene for pictures.

use std::ops::Range;

use super::{Detail, Film, FilmState, Snapshot};
use crate::engine::{self, ElementDetail, ElementStrain, View};
use crate::model::{MOST_IN_FRAMES, PER_DETAIL, PER_FRAME};

/// Number of snapshots of `films` where `wanted` are asked for: as many as fit into [`MOST_IN_FRAMES`], at least the first and
/// the last.
pub(super) fn count(wanted: usize, films: &[Film], detailed: bool) -> usize {
    let elements: usize = films.iter().map(|film| film.quads.len() + film.tris.len()).sum();
    let per_element = if detailed { PER_FRAME + PER_DETAIL } else { PER_FRAME };
    wanted.min(((MOST_IN_FRAMES / (per_element * elements as f64)) as usize).max(2))
}

/// The scene as `view` shows it, `detailed` or not; `strains` are those of its faces.
pub(super) fn snapshot(view: &View<'_>, strains: &[Vec<ElementStrain>], detailed: bool) -> Snapshot {
    let touched = view.nodes_in_contact();
    let film = |(film, strains): (&engine::Film, &Vec<ElementStrain>)| FilmState {
        positions: film.nodes.clone().map(|n| view.nodes.position.at(n).map(|x| x as f32)).collect(),
        strains: strains.iter().map(|s| s.strain.map(|x| x as f32)).collect(),
        failed: strains.iter().map(|s| s.volume == 0.0).collect(),
        touching: touching(&touched, &film.nodes),
        detail: detailed.then(|| detail(view, film, strains)),
    };
    let pose = view.body.map(|body| {
        let (place, turn) = (body.pose.translation.vector, body.pose.rotation.coords);
        ([place.x, place.y, place.z], [turn.x, turn.y, turn.z, turn.w])
    });
    Snapshot { time: view.time, films: view.films.iter().zip(strains).map(film).collect(), impactor: pose }
}

fn detail(view: &View<'_>, film: &engine::Film, strains: &[ElementStrain]) -> Detail {
    let mut out = Detail {
        velocities: film.nodes.clone().map(|n| view.velocity(n).map(|v| v as f32)).collect(),
        peaks: strains.iter().map(|s| s.peak.map(|e| e as f32)).collect(),
        ..Detail::default()
    };
    for ElementDetail { stress, thickness_ratio, fibres } in film.details(&view.nodes.position) {
        out.stresses.push(stress.map(|s| s as f32));
        out.thickness_ratio.push(thickness_ratio as f32);
        out.fibres.push(fibres.map(|f| f.map(|x| x as f32)));
    }
    out
}

/// Of the `touched` nodes those of one face, counted from its first.
fn touching(touched: &[usize], nodes: &Range<usize>) -> Vec<u32> {
    let mut own: Vec<u32> =
        touched.iter().filter(|node| nodes.contains(*node)).map(|node| (node - nodes.start) as u32).collect();
    own.sort_unstable();
    own
}
