//! Faces of film in a recording: triangles, coloured by strain or thickness.

use droptower_viz::{Extent, FilmSnapshot, FilmTrack, Quantity};

use crate::simulate::{Film, FilmState, Image, Snapshot};

/// What faces are coloured by.
struct Colouring {
    key: &'static str,
    title: &'static str,
    words: &'static str,
    /// Factor from the value of `of` to the unit of the words.
    factor: f32,
    /// Of an element, by its index.
    of: fn(&FilmState, usize) -> f32,
    /// Whether film in this state has it; all has it where there is no such condition.
    only: Option<fn(&FilmState) -> bool>,
}

/// What there is to choose from, the default first. A mirror image reverses a shear angle, so its magnitude is shown.
/// The last three only where a law gives the thickness or a plastic strain, and where film can tear.
const COLOURINGS: [Colouring; 7] = [
    Colouring {
        key: "largest",
        title: "Larger fibre strain",
        words: "max(MD, TD), %",
        factor: 100.0,
        of: |state, element| state.strains[element][0].max(state.strains[element][1]),
        only: None,
    },
    Colouring {
        key: "md",
        title: "Strain MD",
        words: "MD, %",
        factor: 100.0,
        of: |state, element| state.strains[element][0],
        only: None,
    },
    Colouring {
        key: "td",
        title: "Strain TD",
        words: "TD, %",
        factor: 100.0,
        of: |state, element| state.strains[element][1],
        only: None,
    },
    Colouring {
        key: "shear",
        title: "Shear",
        words: "|γ|, °",
        factor: 180.0 / std::f32::consts::PI,
        of: |state, element| state.strains[element][2].abs(),
        only: None,
    },
    Colouring {
        key: "thickness",
        title: "Loss of thickness",
        words: "1 − h/h₀, %",
        factor: 100.0,
        of: |state, element| 1.0 - state.thickness_ratio.get(element).copied().unwrap_or(f32::NAN),
        only: Some(|state| !state.thickness_ratio.is_empty()),
    },
    Colouring {
        key: "plastic",
        title: "Plastic strain",
        words: "equivalent, %",
        factor: 100.0,
        of: |state, element| state.plastic_strain.get(element).copied().unwrap_or(f32::NAN),
        only: Some(|state| !state.plastic_strain.is_empty()),
    },
    Colouring {
        key: "damage",
        title: "Damage",
        words: "share of the force lost, %",
        factor: 100.0,
        of: |state, element| state.damage.get(element).copied().unwrap_or(f32::NAN),
        only: Some(|state| !state.damage.is_empty()),
    },
];

/// Those of `snapshots`, all of one run.
fn colourings<'a>(mut snapshots: impl Iterator<Item = &'a Snapshot>) -> Vec<&'static Colouring> {
    let films = snapshots.next().map_or(&[][..], |snapshot| &snapshot.films);
    let is_shown = |colouring: &&Colouring| colouring.only.is_none_or(|is_in| films.iter().any(is_in));
    COLOURINGS.iter().filter(is_shown).collect()
}

/// Least upper end of the colour range: strains below it are rounding errors.
const LEAST_STRAIN: f32 = 1e-6;

/// The quantities, with a range from zero to the largest of an intact element in any of `snapshots`.
pub(super) fn quantities(snapshots: &[&Snapshot]) -> Vec<Quantity> {
    let highest = |colouring: &Colouring| {
        let states = snapshots.iter().flat_map(|snapshot| &snapshot.films);
        states.map(|state| largest(colouring, state)).fold(0.0, f32::max)
    };
    colourings(snapshots.iter().copied()).iter().map(|colouring| colouring.quantity(highest(colouring))).collect()
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
        images: film.images().skip(1).map(Image::signs).collect(),
    }
}

/// One face in a snapshot.
pub(super) fn state(film: &Film, snapshot: &Snapshot, face: usize) -> FilmSnapshot {
    let state = &snapshot.films[face];
    FilmSnapshot {
        time: snapshot.time,
        positions: state.positions.clone(),
        values: colourings(std::iter::once(snapshot)).iter().map(|colouring| nodal(colouring, film, state)).collect(),
        visible: per_triangle(film, |element| !state.failed[element]),
        in_contact: state.in_contact.clone(),
    }
}

impl Colouring {
    fn quantity(&self, highest: f32) -> Quantity {
        let Colouring { key, title, words, factor, .. } = *self;
        let range = [0.0, factor * highest.max(LEAST_STRAIN)];
        Quantity { key, title: title.to_owned(), words: words.to_owned(), range }
    }
}

/// The largest value of the intact elements.
fn largest(colouring: &Colouring, state: &FilmState) -> f32 {
    let held = state.failed.iter().enumerate().filter(|(_, failed)| !**failed);
    held.map(|(element, _)| (colouring.of)(state, element)).fold(0.0, f32::max)
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

/// A value at the nodes, in the unit of its words: the mean of the intact elements around each.
fn nodal(colouring: &Colouring, film: &Film, state: &FilmState) -> Vec<f32> {
    let mut sums = vec![(0.0_f32, 0.0_f32); film.nodes];
    let quads = film.quads.iter().map(|quad| quad.as_slice());
    let outlines = quads.chain(film.tris.iter().map(|tri| tri.as_slice()));
    for (element, (corners, _)) in outlines.zip(&state.failed).enumerate().filter(|(_, (_, failed))| !**failed) {
        for node in corners {
            let (sum, elements) = &mut sums[*node as usize];
            *sum += colouring.factor * (colouring.of)(state, element);
            *elements += 1.0;
        }
    }
    let mean = |(sum, elements): (f32, f32)| sum / elements.max(1.0);
    sums.into_iter().map(mean).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{Mesh, Quality};

    #[test]
    fn nodal_strains_are_means_of_the_intact_elements() {
        let film = Film {
            nodes: 6,
            quads: vec![[0, 1, 2, 3]],
            tris: vec![[1, 4, 2], [4, 5, 2]],
            held: vec![],
            mirrored: [false; 2],
            quality: Quality::of(&Mesh::default()),
        };
        let state = FilmState {
            positions: vec![[0.0; 3]; 6],
            strains: vec![[0.1, 0.4, 0.3], [0.2, 0.0, -0.5], [7.0, 0.0, 0.0]],
            failed: vec![false, false, true],
            thickness_ratio: vec![],
            plastic_strain: vec![],
            damage: vec![],
            in_contact: vec![],
            detail: None,
        };
        let strains = nodal(&COLOURINGS[0], &film, &state);
        let expected = [40.0, 30.0, 30.0, 40.0, 20.0, 0.0];
        for (strain, expected) in strains.iter().zip(expected) {
            assert!((strain - expected).abs() < 1e-5, "{strains:?}");
        }
        assert_eq!(
            COLOURINGS.each_ref().map(|colouring| largest(colouring, &state)),
            [0.4, 0.2, 0.4, 0.5, 0.0, 0.0, 0.0]
        );
        let thin = FilmState { thickness_ratio: vec![0.9, 0.7, 0.1], ..state.clone() };
        assert!((largest(&COLOURINGS[4], &thin) - 0.3).abs() < 1e-6, "of the intact elements");
        let shear = nodal(&COLOURINGS[3], &film, &state);
        assert!((shear[4] - 0.5_f32.to_degrees()).abs() < 1e-4, "shear is in degrees: {shear:?}");
        assert_eq!(triangles(&film).len(), 4);
        let held = per_triangle(&film, |element| !state.failed[element]);
        assert_eq!(held, [true, true, true, false]);
    }

    #[test]
    fn an_undeformed_film_has_the_lowest_colour() {
        for quantity in quantities(&[]) {
            let [low, high] = quantity.range;
            assert!(low == 0.0 && high > 0.0, "{}: {low} to {high}", quantity.title);
        }
    }
}
