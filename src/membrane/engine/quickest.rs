//! The vector instructions with which a processor is quickest.

use std::sync::OnceLock;
use std::time::{Duration, Instant};

use nalgebra::Point3;

use super::film::Film;
use super::mesh::Mesh;
use super::nodes::Nodes;
use super::section::Section;
use crate::lane::Width;
use crate::material::{Curve, Fabric, Law};

/// Elements along each side of the film that is timed: its arrays fit into the cache next to the processor.
const CELLS: u32 = 12;

/// Times that its forces are computed with each of the instructions, of which the quickest counts.
const ROUNDS: usize = 40;

/// The vector instructions with which this processor computes the forces of film in the least time. Some lower their clock
/// for the widest ones, or carry them out in halves; where a processor has these, a measurement of less than a millisecond
/// decides, once a process. No result depends on it.
pub fn quickest_width() -> Width {
    static QUICKEST: OnceLock<Width> = OnceLock::new();
    *QUICKEST.get_or_init(|| match Width::best() {
        Width::Avx512 => measured().unwrap_or(Width::Avx512),
        narrower => narrower,
    })
}

/// The quicker of the two widest; none where the film cannot be made.
fn measured() -> Option<Width> {
    let (mut film, mut nodes) = film()?;
    let widths = [Width::Avx512, Width::Avx2];
    let mut least = [Duration::MAX; 2];
    // In turn: whatever else the machine does meets both alike.
    for _ in 0..ROUNDS {
        for (width, least) in widths.iter().zip(&mut least) {
            let start = Instant::now();
            film.add_forces_at(*width, &mut nodes, 0.0);
            *least = start.elapsed().min(*least);
        }
    }
    Some(if least[1] < least[0] { Width::Avx2 } else { Width::Avx512 })
}

/// A square of fabric, as in the drop tests.
fn film() -> Option<(Film, Nodes)> {
    let place = |k: u32| f64::from(k % (CELLS + 1));
    let row = |k: u32| f64::from(k / (CELLS + 1));
    let at = |k: u32| Point3::new(0.01 * place(k), 0.01 * row(k), 0.0);
    let quad = |k: u32| {
        let first = k / CELLS * (CELLS + 1) + k % CELLS;
        [first, first + 1, first + CELLS + 2, first + CELLS + 1]
    };
    let mesh = Mesh {
        nodes: (0..(CELLS + 1).pow(2)).map(at).collect(),
        quads: (0..CELLS.pow(2)).map(quad).collect(),
        ..Mesh::default()
    };
    let curve = |stress: f64| Curve::new(vec![[0.0, 0.0], [0.1, 0.4 * stress], [0.5, 0.6 * stress], [2.0, stress]]);
    let [md, td, shear] = [curve(2e7).ok()?, curve(1e7).ok()?, curve(2e6).ok()?];
    let section =
        Section { prestrain: [0.02, 0.01], ..Section::new(Law::Fabric(Fabric::new(md, td, shear, 0.5)), 915.0, 12e-6) };
    let mut nodes = Nodes::default();
    let film = Film::mount(&mesh, &section, 0.0, &mut nodes).ok()?;
    Some((film, nodes))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_of_the_instructions_of_the_processor_is_quickest_and_stays_so() {
        let quickest = quickest_width();
        assert!(Width::available().any(|width| width == quickest));
        assert_eq!(quickest_width(), quickest);
        if Width::best() == Width::Avx512 {
            assert!(measured().is_some(), "the film that is timed can be made");
        }
    }
}
