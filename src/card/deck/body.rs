//! The surface of a body as triangles, and the mounting of film.

use std::collections::BTreeMap;
use std::f64::consts::PI;

use super::{Deck, Face, Shape};

/// Most rings of facets from a pole to the equator.
const RINGS: usize = 24;

/// Share of the radius by which the mesh of a body is smaller where a penalty needs room.
const INSET: f64 = 0.01;

/// Points (m) and triangles, oriented outwards.
pub(super) struct Triangles {
    pub(super) points: Vec<[f64; 3]>,
    pub(super) corners: Vec<[usize; 3]>,
}

impl Shape {
    /// Radius of its round parts, m.
    pub(super) fn radius(self) -> f64 {
        match self {
            Shape::Sphere { radius } | Shape::Capsule { radius, .. } => radius,
        }
    }

    /// How far a mesh lies below it where a penalty needs room, m.
    pub(super) fn inset(self) -> f64 {
        INSET * self.radius()
    }

    /// Largest distance of facets below it, m.
    pub(super) fn facet_depth(self, rings: usize) -> f64 {
        let mesh = self.triangles(0.0, rings);
        let below = |corners: &[usize; 3]| {
            let middle =
                [0, 1, 2].map(|axis| corners.map(|corner| mesh.points[corner][axis]).iter().sum::<f64>() / 3.0);
            let along = middle[2] - middle[2].clamp(-self.half(), self.half());
            self.radius() - length([middle[0], middle[1], along])
        };
        mesh.corners.iter().map(below).fold(0.0, f64::max)
    }

    /// Half the length of the shaft, m.
    fn half(self) -> f64 {
        match self {
            Shape::Sphere { .. } => 0.0,
            Shape::Capsule { length, .. } => 0.5 * length,
        }
    }

    /// Rings of facets from a pole to the equator: [`RINGS`], or as many as leave the shortest edge no less than `edge` (m).
    pub(super) fn rings(self, edge: f64) -> usize {
        // The equator has six points a ring, and the shortest edges.
        ((0.99 * PI / 3.0 * (self.radius() - self.inset()) / edge) as usize).clamp(4, RINGS)
    }

    /// Its triangles, smaller by `inset` (m) along its normals, about its centre. A ring has six points more than the one before,
    /// so that edges are alike everywhere: needles at a pole, which film meets first, make contacts that share their nodes.
    pub(super) fn triangles(self, inset: f64, rings: usize) -> Triangles {
        let (radius, half) = (self.radius() - inset, self.half());
        // Distance from the axis, height, and points of each ring from the lower pole to the upper one.
        let cap = |ring: usize| {
            let (sin, cos) = (0.5 * PI * ring as f64 / rings as f64).sin_cos();
            (radius * sin, -half - radius * without_round_off(cos), (6 * ring).max(1))
        };
        let pieces = (2.0 * half / (0.5 * PI * radius / rings as f64)).ceil() as usize;
        let shaft = (1..pieces).map(|piece| (radius, 2.0 * half * piece as f64 / pieces as f64 - half, 6 * rings));
        let lower: Vec<_> = (0..=rings).map(cap).collect();
        let upper = lower.iter().rev().map(|(out, z, count)| (*out, -z, *count));
        let all: Vec<_> = lower.iter().copied().chain(shaft).chain(upper.skip(usize::from(half == 0.0))).collect();
        let (mut points, mut corners, mut below) = (vec![], vec![], None::<(usize, usize)>);
        for (out, z, count) in all {
            let first = points.len();
            points.extend((0..count).map(|place| {
                let (sin, cos) = (2.0 * PI * place as f64 / count as f64).sin_cos();
                [out * without_round_off(cos), out * without_round_off(sin), z]
            }));
            if let Some((before, fewer)) = below {
                band(&mut corners, [before, fewer], [first, count]);
            }
            below = Some((first, count));
        }
        Triangles { points, corners }
    }
}

/// Triangles between two rings, the second above, as first point and number of points.
fn band(corners: &mut Vec<[usize; 3]>, [low, fewer]: [usize; 2], [high, more]: [usize; 2]) {
    let [below, above] = [(low, fewer), (high, more)].map(|(first, count)| move |place: usize| first + place % count);
    if fewer == more {
        for side in 0..fewer {
            let [a, b, c, d] = [below(side), below(side + 1), above(side + 1), above(side)];
            corners.extend([[a, b, c], [a, c, d]]);
        }
        return;
    }
    for sextant in 0..6 {
        // Places in the smaller and the larger ring; a pole is all places of its ring.
        let inner = fewer.min(more) / 6;
        let (small, large) = (sextant * inner, sextant * (inner + 1));
        for step in 0..=inner {
            let (s, l) = (small + step, large + step);
            if fewer < more {
                corners.push([below(s), above(l + 1), above(l)]);
                corners.extend((step < inner).then(|| [below(s), below(s + 1), above(l + 1)]));
            } else {
                corners.push([below(l), below(l + 1), above(s)]);
                corners.extend((step < inner).then(|| [above(s + 1), above(s), below(l + 1)]));
            }
        }
    }
}

impl Triangles {
    /// The shortest edge, m.
    #[cfg(test)]
    fn shortest(&self) -> f64 {
        let between = |a: usize, b: usize| length([0, 1, 2].map(|axis| self.points[a][axis] - self.points[b][axis]));
        let edges = self.corners.iter().flat_map(|&[a, b, c]| [between(a, b), between(b, c), between(c, a)]);
        edges.fold(f64::INFINITY, f64::min)
    }

    /// m².
    pub(super) fn area(&self) -> f64 {
        self.corners.iter().map(|corners| 0.5 * length(self.normal(corners))).sum()
    }

    /// Twice the area of a triangle, along its normal.
    fn normal(&self, corners: &[usize; 3]) -> [f64; 3] {
        let [a, b, c] = corners.map(|corner| self.points[corner]);
        let ([u, v, w], [x, y, z]) = ([0, 1, 2].map(|i| b[i] - a[i]), [0, 1, 2].map(|i| c[i] - a[i]));
        [v * z - w * y, w * x - u * z, u * y - v * x]
    }
}

/// A component of a unit vector, exactly zero where it is round-off.
fn without_round_off(component: f64) -> f64 {
    if component.abs() < 1e-15 { 0.0 } else { component }
}

fn length(vector: [f64; 3]) -> f64 {
    vector.iter().map(|v| v * v).sum::<f64>().sqrt()
}

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

#[cfg(test)]
mod tests {
    use super::*;

    /// Area and volume of sphere and capsule, and a closed surface: each edge belongs to two triangles that pass it in
    /// opposite directions.
    #[test]
    fn bodies_are_closed_and_face_outwards() {
        for (shape, area, volume) in [
            (Shape::Sphere { radius: 0.12 }, 4.0 * PI * 0.0144, 4.0 / 3.0 * PI * 0.12_f64.powi(3)),
            (
                Shape::Capsule { radius: 0.02, length: 0.1 },
                4.0 * PI * 0.0004 + 2.0 * PI * 0.002,
                4.0 / 3.0 * PI * 8e-6 + PI * 4e-5,
            ),
        ] {
            let found = shape.triangles(0.0, RINGS);
            let of_corners = |corners: &[usize; 3]| {
                let (normal, point) = (found.normal(corners), found.points[corners[0]]);
                (0..3).map(|axis| normal[axis] * point[axis]).sum::<f64>() / 6.0
            };
            let inside: f64 = found.corners.iter().map(of_corners).sum();
            assert!((found.area() / area - 1.0).abs() < 2e-3, "{} and {area}", found.area());
            assert!((inside / volume - 1.0).abs() < 3e-3, "{} and {volume}", inside);
            let edges: std::collections::HashSet<[usize; 2]> =
                found.corners.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]).collect();
            assert_eq!(edges.len(), 3 * found.corners.len());
            assert!(edges.iter().all(|[a, b]| edges.contains(&[*b, *a])));
        }
    }
    /// No needles: edges are of one size, and as long as is asked for.
    #[test]
    fn facets_are_even() {
        for shape in [Shape::Sphere { radius: 0.12 }, Shape::Capsule { radius: 0.02, length: 0.1 }] {
            let mesh = shape.triangles(shape.inset(), RINGS);
            let fair = 0.5 * PI * (shape.radius() - shape.inset()) / RINGS as f64;
            assert!(mesh.shortest() > 0.6 * fair, "{} and {fair}", mesh.shortest());
            let area = |corners: &[usize; 3]| 0.5 * length(mesh.normal(corners));
            let areas: Vec<f64> = mesh.corners.iter().map(area).collect();
            let least = areas.iter().copied().fold(f64::INFINITY, f64::min);
            assert!(least > 0.25 * fair * fair, "{least}");
            // As long as a gap needs.
            let edge = 0.02 * shape.radius() * 5.0;
            let coarse = shape.triangles(shape.inset(), shape.rings(edge));
            assert!(coarse.shortest() >= edge, "{}", coarse.shortest());
            assert!(shape.facet_depth(RINGS) < 1.5e-3 * shape.radius());
        }
    }
}
