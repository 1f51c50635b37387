//! States of the scene that are kept for pictures.

use std::ops::Range;

use super::{Film, FilmState, Frame};
use crate::engine::{ElementStrain, View};
use crate::model::{MOST_IN_FRAMES, PER_FRAME};

/// States of `films` that are kept where `wanted` are asked for: as many as [`MOST_IN_FRAMES`] holds, the first and the
/// last in any case.
pub(super) fn kept(wanted: usize, films: &[Film]) -> usize {
    let elements: usize = films.iter().map(|film| film.quads.len() + film.tris.len()).sum();
    wanted.min(((MOST_IN_FRAMES / (PER_FRAME * elements as f64)) as usize).max(2))
}

/// The scene as `view` shows it; `strains` are those of its faces.
pub(super) fn frame(view: &View<'_>, strains: &[Vec<ElementStrain>]) -> Frame {
    let touched = view.touched();
    let film = |(film, strains): (&crate::engine::Film, &Vec<ElementStrain>)| FilmState {
        positions: film.nodes.clone().map(|n| view.nodes.position.at(n).map(|x| x as f32)).collect(),
        strains: strains.iter().map(|s| s.strain.map(|x| x as f32)).collect(),
        broken: strains.iter().map(|s| s.volume == 0.0).collect(),
        touching: touching(&touched, &film.nodes),
    };
    let pose = view.body.map(|body| {
        let (place, turn) = (body.pose.translation.vector, body.pose.rotation.coords);
        ([place.x, place.y, place.z], [turn.x, turn.y, turn.z, turn.w])
    });
    Frame { time: view.time, films: view.films.iter().zip(strains).map(film).collect(), impactor: pose }
}

/// Of the `touched` nodes those of one face, counted from its first.
fn touching(touched: &[usize], nodes: &Range<usize>) -> Vec<u32> {
    let mut own: Vec<u32> =
        touched.iter().filter(|node| nodes.contains(*node)).map(|node| (node - nodes.start) as u32).collect();
    own.sort_unstable();
    own
}
