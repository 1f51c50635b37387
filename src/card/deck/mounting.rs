//! The step of mounting: film moves from its stress-free shape to the frame.

use std::collections::BTreeMap;

use super::{Deck, Face};

/// Duration of the step where there is pre-strain, s.
const TIME: f64 = 0.01;

/// Time of the step and of the rest before the test, over that of the step: film is free before a body meets it.
const REST: f64 = 1.05;

/// A motion that is round-off, m.
const ROUND_OFF: f64 = 1e-12;

/// Nodes that are moved alike.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Move {
    /// 0, 1 or 2: x, y or z.
    pub(super) axis: usize,
    /// m.
    pub(super) by: f64,
    /// Whether frame or mirror planes hold them thereafter.
    pub(super) is_held: bool,
    /// Counted through all faces, from 0.
    pub(super) nodes: Vec<usize>,
}

/// The motion of the film of a deck to its frame.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Mounting {
    /// s; zero without pre-strain.
    pub(super) time: f64,
    /// When the test begins, s.
    pub(super) begin: f64,
    /// Of all nodes along all axes, but for those that never move; none without pre-strain. Across its plane film without stress
    /// has no stiffness, so that it is held there too.
    pub(super) moves: Vec<Move>,
    /// Nodes that never move along x, y and z, counted through all faces.
    pub(super) fixed: [Vec<usize>; 3],
}

/// The stress-free places of nodes that are mounted with this pre-strain along MD and TD.
pub fn stress_free(mounted: &[[f64; 3]], md_angle: f64, prestrain: [f64; 2]) -> Vec<[f64; 3]> {
    let (sin, cos) = md_angle.sin_cos();
    let [md, td] = prestrain.map(|strain| 1.0 / (1.0 + strain));
    let place = |&[x, y, z]: &[f64; 3]| {
        let [along, across] = [md * (x * cos + y * sin), td * (y * cos - x * sin)];
        [along * cos - across * sin, along * sin + across * cos, z]
    };
    mounted.iter().map(place).collect()
}

pub(super) fn mounting(deck: &Deck<'_>) -> Mounting {
    let moves_at_all = |face: &Face<'_>| {
        face.mounted
            .iter()
            .zip(&face.stress_free)
            .any(|(a, b)| (0..2).any(|axis| (a[axis] - b[axis]).abs() > ROUND_OFF))
    };
    let is_strained = deck.faces.iter().any(moves_at_all);
    let mut groups: BTreeMap<(usize, i64, bool), Vec<usize>> = BTreeMap::new();
    let mut fixed = [vec![], vec![], vec![]];
    let mut first = 0;
    for face in &deck.faces {
        for (node, held) in face.held.iter().enumerate() {
            for axis in 0..3 {
                let by = ((face.mounted[node][axis] - face.stress_free[node][axis]) / ROUND_OFF).round() as i64;
                if held[axis] && by == 0 {
                    fixed[axis].push(first + node);
                } else if is_strained {
                    groups.entry((axis, by, held[axis])).or_default().push(first + node);
                }
            }
        }
        first += face.mounted.len();
    }
    let of_group = |((axis, by, is_held), nodes)| Move { axis, by: by as f64 * ROUND_OFF, is_held, nodes };
    let time = if is_strained { TIME } else { 0.0 };
    Mounting { time, begin: REST * time, moves: groups.into_iter().map(of_group).collect(), fixed }
}

/// Share of the motion over share of the time: it begins and ends at rest.
pub(super) fn shares() -> impl Iterator<Item = [f64; 2]> {
    const PIECES: usize = 40;
    (0..=PIECES).map(|piece| {
        let time = piece as f64 / PIECES as f64;
        [time, 0.5 - 0.5 * (std::f64::consts::PI * time).cos()]
    })
}
