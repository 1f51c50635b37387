//! The elements of a film with their mirror images, the edges around each node, and what is behind held ones.

use std::collections::BTreeSet;

/// Directions of a mounted edge that differ by more than this angle (cosine) make a corner.
const CORNER: f64 = 0.7;

/// Share of the distance to a neighbour that counts as none.
const ON_EDGE: f64 = 1e-6;

/// Square of the distance of nodes that are hardly farther than those of the elements at a node, over that of the farthest
/// of these.
const NEAR: f64 = 2.5;

/// A flat film as mounted, continued behind its mirror planes.
pub(super) struct Outline {
    /// Positions, m: those of the film's nodes first, then their images.
    pub(super) places: Vec<[f64; 2]>,
    /// The film's own node of each, and by which signs its position is multiplied.
    pub(super) source: Vec<(u32, [f64; 3])>,
    /// Elements: those of the film first, then their images, as often as there are images.
    pub(super) elements: Vec<Vec<u32>>,
    /// The elements at each node.
    pub(super) around: Vec<Vec<u32>>,
    /// Edges with film on one side alone, each at both of its nodes.
    edges: Vec<Vec<Edge>>,
}

/// An edge of film at a node.
#[derive(Clone, Copy, Debug)]
struct Edge {
    /// From the node along the edge to its other end, m.
    along: [f64; 2],
    /// Of length one, into the film.
    inward: [f64; 2],
    is_built_in: bool,
}

/// How far nodes around a node are taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Reach {
    /// Nodes of its elements.
    Next,
    /// And those of the elements at these that are hardly farther.
    Near,
    /// All of these.
    Second,
}

/// Where a node of a film lies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Place {
    /// Within the film.
    Inside,
    /// On an edge that is held, whose film goes on behind it, with its normal into the film.
    BuiltIn { inward: [f64; 2] },
    /// On a free edge along this direction.
    Free { along: [f64; 2] },
    /// At the end of a free edge along a direction, where a held one begins.
    FreeAtBuiltIn { along: [f64; 2], inward: [f64; 2] },
    /// At a corner, or where edges meet.
    Corner,
}

impl Outline {
    /// The film with nodes at `places` and these `elements`, counter-clockwise, built in at the edges `built_in`, behind
    /// the planes x = 0 and y = 0 where it is `mirrored` there.
    pub(super) fn new(
        places: &[[f64; 2]],
        elements: &[Vec<u32>],
        built_in: &[[u32; 2]],
        mirrored: [Option<&[u32]>; 2],
    ) -> Outline {
        let mut outline = Outline {
            places: places.to_vec(),
            source: (0..places.len() as u32).map(|node| (node, [1.0; 3])).collect(),
            elements: elements.to_vec(),
            around: vec![],
            edges: vec![],
        };
        let mut held: BTreeSet<[u32; 2]> = built_in.iter().map(|[a, b]| [*a.min(b), *a.max(b)]).collect();
        for (axis, plane) in mirrored.into_iter().enumerate() {
            if let Some(plane) = plane {
                outline.reflect(axis, plane, &mut held);
            }
        }
        outline.connect(&held);
        outline
    }

    /// Adds the image of everything behind the plane through the origin across an axis, on which the film's own nodes
    /// `plane` lie.
    fn reflect(&mut self, axis: usize, plane: &[u32], held: &mut BTreeSet<[u32; 2]>) {
        let mut image = Vec::with_capacity(self.places.len());
        for node in 0..self.places.len() {
            let (mut place, (own, mut signs)) = (self.places[node], self.source[node]);
            if plane.binary_search(&own).is_ok() {
                image.push(node as u32);
                continue;
            }
            image.push(self.places.len() as u32);
            place[axis] = -place[axis];
            signs[axis] = -signs[axis];
            self.places.push(place);
            self.source.push((own, signs));
        }
        let at = |node: &u32| image[*node as usize];
        let images: Vec<Vec<u32>> =
            self.elements.iter().map(|corners| corners.iter().rev().map(at).collect()).collect();
        self.elements.extend(images);
        let images: Vec<[u32; 2]> = held.iter().map(|[a, b]| [at(a).min(at(b)), at(a).max(at(b))]).collect();
        held.extend(images);
    }

    /// Finds the elements and the edges at each node.
    fn connect(&mut self, held: &BTreeSet<[u32; 2]>) {
        self.around = vec![vec![]; self.places.len()];
        self.edges = vec![vec![]; self.places.len()];
        let mut sides: Vec<([u32; 2], [u32; 2])> = vec![];
        for (number, corners) in self.elements.iter().enumerate() {
            for (from, to) in corners.iter().zip(corners.iter().cycle().skip(1)) {
                self.around[*from as usize].push(number as u32);
                sides.push(([*from.min(to), *from.max(to)], [*from, *to]));
            }
        }
        sides.sort_unstable();
        for group in sides.chunk_by(|(a, _), (b, _)| a == b) {
            let [(edge, [from, to])] = group else { continue };
            let is_built_in = held.contains(edge);
            let along = self.between(*from, *to);
            let length = dot(along, along).sqrt();
            let inward = [-along[1] / length, along[0] / length];
            self.edges[*from as usize].push(Edge { along, inward, is_built_in });
            let back = along.map(|component| -component);
            self.edges[*to as usize].push(Edge { along: back, inward, is_built_in });
        }
    }

    /// From one node to another, m.
    pub(super) fn between(&self, from: u32, to: u32) -> [f64; 2] {
        let (from, to) = (self.places[from as usize], self.places[to as usize]);
        [to[0] - from[0], to[1] - from[1]]
    }

    /// The nodes around a node, without itself, ascending.
    pub(super) fn neighbours(&self, node: u32, reach: Reach) -> Vec<u32> {
        let mut found: BTreeSet<u32> = self.corners_around(node).collect();
        let square = |other: &u32| {
            let along = self.between(node, *other);
            dot(along, along)
        };
        let farthest = found.iter().map(square).fold(0.0, f64::max);
        if reach != Reach::Next {
            let first = found.clone();
            found.extend(first.into_iter().flat_map(|other| self.corners_around(other)));
        }
        if reach == Reach::Near {
            found.retain(|other| square(other) <= NEAR * farthest);
        }
        found.remove(&node);
        found.into_iter().collect()
    }

    fn corners_around(&self, node: u32) -> impl Iterator<Item = u32> {
        self.around[node as usize].iter().flat_map(|element| self.elements[*element as usize].iter().copied())
    }

    /// Where a node lies.
    pub(super) fn place(&self, node: u32) -> Place {
        let [a, b] = match self.edges[node as usize].as_slice() {
            [] => return Place::Inside,
            [a, b] => [a, b],
            _ => return Place::Corner,
        };
        let cosine = -dot(a.along, b.along) / (dot(a.along, a.along) * dot(b.along, b.along)).sqrt();
        match [a.is_built_in, b.is_built_in] {
            [false, false] if cosine > CORNER => {
                Place::Free { along: unit([a.along[0] - b.along[0], a.along[1] - b.along[1]]) }
            }
            [true, true] if cosine > CORNER => {
                Place::BuiltIn { inward: unit([a.inward[0] + b.inward[0], a.inward[1] + b.inward[1]]) }
            }
            [false, true] => Place::FreeAtBuiltIn { along: unit(a.along), inward: b.inward },
            [true, false] => Place::FreeAtBuiltIn { along: unit(b.along), inward: a.inward },
            _ => Place::Corner,
        }
    }
}

/// Image of what is at `offset` from a node on a held edge with the normal `inward`; none of what lies on the edge.
pub(super) fn behind(offset: [f64; 2], inward: [f64; 2]) -> Option<[f64; 2]> {
    let depth = dot(offset, inward);
    let image = [offset[0] - 2.0 * depth * inward[0], offset[1] - 2.0 * depth * inward[1]];
    (depth > ON_EDGE * dot(offset, offset).sqrt()).then_some(image)
}

fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

fn unit(a: [f64; 2]) -> [f64; 2] {
    let length = dot(a, a).sqrt();
    a.map(|component| component / length)
}
