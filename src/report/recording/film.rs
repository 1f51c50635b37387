//! Faces of film in a recording: triangles, coloured by strain or thickness.

use viz::{Extent, FilmSnapshot, FilmTrack, Quantity, SpringTrack};

use crate::field::Field;
use plot::viridis::VIRIDIS;
use scene::simulate::{Film, FilmSpring, Image, Snapshot};

/// The quantities, with a range from zero to the largest of an intact element in any of `snapshots`.
pub(super) fn quantities(snapshots: &[&Snapshot]) -> Vec<Quantity> {
    let films = snapshots.first().map_or(&[][..], |snapshot| &snapshot.films);
    let quantity = |Field { key, title, symbol, unit, .. }: &Field, range| Quantity {
        key,
        title: (*title).to_owned(),
        words: format!("{symbol}, {unit}"),
        range,
        colours: &VIRIDIS,
    };
    let states = || snapshots.iter().flat_map(|snapshot| &snapshot.films);
    Field::all_in(films).map(|field| quantity(field, field.range(states()))).collect()
}

/// All faces.
pub(super) fn tracks(films: &[Film]) -> Vec<FilmTrack> {
    films.iter().enumerate().map(|(face, film)| track(film, face)).collect()
}

/// Bounds of the faces in all of `snapshots`.
pub(super) fn extent(films: &[Film], snapshots: &[&Snapshot]) -> Extent {
    let faces = films.iter().enumerate().map(|(face, film)| (face, film, track(film, face)));
    faces.fold(Extent::default(), |extent, (face, film, track)| {
        snapshots.iter().fold(extent, |extent, snapshot| extent.with(&track, &state(film, snapshot, face)))
    })
}

fn track(film: &Film, face: usize) -> FilmTrack {
    FilmTrack {
        name: format!("face-{}", face + 1),
        nodes: film.nodes,
        triangles: triangles(film),
        held: film.held.clone(),
        springs: film.springs.iter().map(spring).collect(),
        images: film.images().skip(1).map(Image::signs).collect(),
    }
}

fn spring(FilmSpring { anchor, nodes, shares }: &FilmSpring) -> SpringTrack {
    SpringTrack { anchor: *anchor, nodes: *nodes, shares: *shares }
}

/// One face in a snapshot.
pub(super) fn state(film: &Film, snapshot: &Snapshot, face: usize) -> FilmSnapshot {
    let state = &snapshot.films[face];
    FilmSnapshot {
        time: snapshot.time,
        positions: state.positions.clone(),
        values: Field::all_in(&snapshot.films)
            .map(|field| field.at_nodes(film.nodes, film.outlines(), state))
            .collect(),
        visible: per_triangle(film, |element| !state.failed[element]),
        in_contact: state.in_contact.clone(),
    }
}

/// Quadrilaterals as two triangles each, then the triangles.
fn triangles(film: &Film) -> Vec<[u32; 3]> {
    let halves = |&[a, b, c, d]: &[u32; 4]| [[a, b, c], [a, c, d]];
    let quads = film.quads.iter().flat_map(halves);
    quads.chain(film.tris.iter().copied()).collect()
}

/// A value of each element, repeated for each of its triangles.
fn per_triangle(film: &Film, value: impl Fn(usize) -> bool) -> Vec<bool> {
    let quads = film.quads.len();
    let of_quads = (0..quads).flat_map(|quad| [value(quad); 2]);
    let of_tris = (0..film.tris.len()).map(|tri| value(quads + tri));
    of_quads.chain(of_tris).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::mesh::{Mesh, Quality};

    #[test]
    fn a_quadrilateral_is_two_triangles() {
        let film = Film {
            nodes: 6,
            quads: vec![[0, 1, 2, 3]],
            tris: vec![[1, 4, 2], [4, 5, 2]],
            held: vec![],
            springs: vec![],
            mirrored: [false; 2],
            quality: Quality::from_mesh(&Mesh::default()),
        };
        assert_eq!(triangles(&film).len(), 4);
        assert_eq!(per_triangle(&film, |element| element != 2), [true, true, true, false]);
    }

    #[test]
    fn an_undeformed_film_has_the_lowest_colour() {
        for quantity in quantities(&[]) {
            let [low, high] = quantity.range;
            assert!(low == 0.0 && high > 0.0, "{}: {low} to {high}", quantity.title);
        }
    }
}
