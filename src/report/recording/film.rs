//! Faces of film as the recording shows them: triangles, coloured by the larger fibre strain.

use droptower_viz::{FilmFrame, FilmTrack};

use crate::simulate::{Film, FilmState, Frame, Outcome};

/// The largest fibre strain in any kept state of an element that holds.
pub fn highest_strain(outcome: &Outcome) -> f32 {
    let states = outcome.frames.iter().flat_map(|frame| &frame.films);
    let elements = states.flat_map(|state| state.strains.iter().zip(&state.broken));
    let held = elements.filter(|(_, broken)| !**broken);
    held.map(|(strain, _)| fibre_strain(strain)).fold(0.0, f32::max)
}

fn fibre_strain([md, td, _]: &[f32; 3]) -> f32 {
    md.max(*td)
}

/// One face in all kept states, `highest` being the strain of the brightest colour.
pub fn track(outcome: &Outcome, face: usize, highest: f32) -> FilmTrack {
    let film = &outcome.films[face];
    let frame = |frame: &Frame| {
        let state = &frame.films[face];
        FilmFrame {
            time: frame.time,
            positions: state.positions.clone(),
            values: nodal_strains(film, state),
            visible: per_triangle(film, |element| !state.broken[element]),
        }
    };
    FilmTrack {
        name: format!("face-{}", face + 1),
        triangles: triangles(film),
        mirrored: film.mirrored,
        range: [0.0, highest],
        frames: outcome.frames.iter().map(frame).collect(),
    }
}

/// Quadrilaterals as two triangles each, then the triangles.
fn triangles(film: &Film) -> Vec<[u32; 3]> {
    let halves = |&[a, b, c, d]: &[u32; 4]| [[a, b, c], [a, c, d]];
    let quads = film.quads.iter().flat_map(halves);
    quads.chain(film.tris.iter().copied()).collect()
}

/// A value of each element, for every triangle that it is drawn as.
fn per_triangle(film: &Film, value: impl Fn(usize) -> bool) -> Vec<bool> {
    let quads = film.quads.len();
    let of_quads = (0..quads).flat_map(|quad| [value(quad); 2]);
    let of_tris = (0..film.tris.len()).map(|tri| value(quads + tri));
    of_quads.chain(of_tris).collect()
}

/// Fibre strain at the nodes: the mean of the elements around that hold.
fn nodal_strains(film: &Film, state: &FilmState) -> Vec<f32> {
    let mut sums = vec![(0.0_f32, 0.0_f32); film.nodes];
    let quads = film.quads.iter().map(|quad| quad.as_slice());
    let outlines = quads.chain(film.tris.iter().map(|tri| tri.as_slice()));
    let held = outlines.zip(&state.strains).zip(&state.broken);
    for ((corners, strain), _) in held.filter(|(_, broken)| !**broken) {
        for node in corners {
            let (sum, elements) = &mut sums[*node as usize];
            *sum += fibre_strain(strain);
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
    fn nodes_take_the_mean_of_the_elements_that_hold() {
        let film = Film {
            nodes: 6,
            quads: vec![[0, 1, 2, 3]],
            tris: vec![[1, 4, 2], [4, 5, 2]],
            mirrored: [false; 2],
            quality: Quality::of(&Mesh::default()),
        };
        let state = FilmState {
            positions: vec![[0.0; 3]; 6],
            strains: vec![[0.1, 0.4, 9.0], [0.2, 0.0, 9.0], [7.0, 0.0, 0.0]],
            broken: vec![false, false, true],
            touching: vec![],
            detail: None,
        };
        let strains = nodal_strains(&film, &state);
        let expected = [0.4, 0.3, 0.3, 0.4, 0.2, 0.0];
        for (strain, expected) in strains.iter().zip(expected) {
            assert!((strain - expected).abs() < 1e-6, "{strains:?}");
        }
        assert_eq!(triangles(&film).len(), 4);
        let held = per_triangle(&film, |element| !state.broken[element]);
        assert_eq!(held, [true, true, true, false]);
    }
}
