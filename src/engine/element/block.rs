//! Elements side by side, in blocks of lanes.

use super::hourglass::Hourglass;
use crate::lane::{LANES, Lane, splat};
use crate::material::Peaks;

/// Elements with `NODES` nodes and `POINTS` integration points.
#[derive(Clone, Debug)]
pub struct Blocks<const NODES: usize, const POINTS: usize> {
    /// Elements; the last block is filled up with weightless copies of the last one.
    pub count: usize,
    /// Nodes of each element in each lane.
    pub nodes: Vec<[[u32; LANES]; NODES]>,
    /// Integration points, block by block.
    pub points: Vec<[Point<NODES>; POINTS]>,
    /// Stabilisation against hourglass modes, block by block.
    pub hourglass: Vec<Hourglass<NODES>>,
}

/// An integration point of the elements of a block.
#[derive(Clone, Debug)]
pub struct Point<const NODES: usize> {
    /// ∂N_a/∂X_I along MD and TD of the stress-free film, 1/m.
    pub gradient: [[Lane; 2]; NODES],
    /// Volume of stress-free film (all layers), m³; zero once broken.
    pub volume: Lane,
    /// Largest strains so far.
    pub peaks: Peaks,
}

/// One element as it is put into a block.
pub(crate) struct Element<const NODES: usize, const POINTS: usize> {
    pub(super) nodes: [u32; NODES],
    pub(super) gradient: [[[f64; 2]; NODES]; POINTS],
    /// Area of stress-free film at each point, m².
    pub(super) area: [f64; POINTS],
    /// γ_a and H_I.
    pub(super) hourglass: ([f64; NODES], [f64; 2]),
}

impl<const NODES: usize, const POINTS: usize> Blocks<NODES, POINTS> {
    /// Blocks of `elements` of a film `thickness` (m, all layers) thick.
    pub(crate) fn new(elements: &[Element<NODES, POINTS>], thickness: f64) -> Self {
        let mut out = Blocks { count: elements.len(), nodes: vec![], points: vec![], hourglass: vec![] };
        for chunk in elements.chunks(LANES) {
            let lane = |l: usize| &chunk[l.min(chunk.len() - 1)];
            let weight = |l: usize| if l < chunk.len() { thickness } else { 0.0 };
            out.nodes.push(std::array::from_fn(|a| std::array::from_fn(|l| lane(l).nodes[a])));
            out.points.push(std::array::from_fn(|p| Point {
                gradient: std::array::from_fn(|a| {
                    std::array::from_fn(|i| std::array::from_fn(|l| lane(l).gradient[p][a][i]))
                }),
                volume: std::array::from_fn(|l| weight(l) * lane(l).area[p]),
                peaks: [splat(0.0); 3],
            }));
            out.hourglass.push(Hourglass {
                shape: std::array::from_fn(|a| std::array::from_fn(|l| lane(l).hourglass.0[a])),
                mean_square: std::array::from_fn(|i| std::array::from_fn(|l| lane(l).hourglass.1[i])),
            });
        }
        out
    }

    /// Block and lane of each element, in order.
    pub fn places(&self) -> impl Iterator<Item = (usize, usize)> + use<NODES, POINTS> {
        (0..self.count).map(|i| (i / LANES, i % LANES))
    }

    /// Nodes of the element at `block`, `lane`.
    pub fn nodes_at(&self, block: usize, lane: usize) -> [u32; NODES] {
        std::array::from_fn(|a| self.nodes[block][a][lane])
    }

    /// Whether the element at `block`, `lane` has broken.
    pub fn is_broken(&self, block: usize, lane: usize) -> bool {
        self.points[block][0].volume[lane] == 0.0
    }
}

impl<const NODES: usize, const POINTS: usize> Element<NODES, POINTS> {
    /// Area of stress-free film, m².
    pub(crate) fn area(&self) -> f64 {
        self.area.iter().sum()
    }
}
