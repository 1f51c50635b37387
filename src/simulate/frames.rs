//! States of the scene that are kept for pictures.

use super::{FilmState, Frame};
use crate::engine::{ElementStrain, View};

/// The scene as `view` shows it; `strains` are those of its faces.
pub(super) fn frame(view: &View<'_>, strains: &[Vec<ElementStrain>]) -> Frame {
    let film = |(film, strains): (&crate::engine::Film, &Vec<ElementStrain>)| FilmState {
        positions: film.nodes.clone().map(|n| view.nodes.position.at(n).map(|x| x as f32)).collect(),
        strains: strains.iter().map(|s| s.strain.map(|x| x as f32)).collect(),
        broken: strains.iter().map(|s| s.volume == 0.0).collect(),
    };
    let pose = view.body.map(|body| {
        let (place, turn) = (body.pose.translation.vector, body.pose.rotation.coords);
        ([place.x, place.y, place.z], [turn.x, turn.y, turn.z, turn.w])
    });
    Frame { time: view.time, films: view.films.iter().zip(strains).map(film).collect(), impactor: pose }
}
