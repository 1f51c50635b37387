//! Which triangle of the neighbouring faces lies nearest to each node, followed from step to step.

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use super::due::Pairs;
use super::surface::{NONE, Surface, are_below, place};
use crate::engine::nodes::Vectors;

/// Share of an element by which a node may lie beside its triangle until it is followed to the next one.
pub(super) const BESIDE: f64 = 1e-3;

/// Distance along the triangle, over the least allowed one, within which a node lies on a corner. A crossing of their
/// edges is as far apart as these two, but for the angle between the normals (theory.md, section 6), so that it is left
/// to them.
const ON_CORNER: f64 = 0.5;

/// Distance along the triangle, over the least allowed one, beyond which it has left the corner.
const OFF_CORNER: f64 = 1.0;

/// Triangles over which a node is followed at most at once.
const HOPS: usize = 64;

/// For every node the nearest triangle of a face on one side of its own in the order of the faces.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(super) struct Tracking {
    /// [`NONE`] where no triangle is near.
    pub(super) triangle: Vec<u32>,
    /// Its corners, the one on which the node lies first; the node itself where there is no triangle.
    pub(super) corners: [Vec<u32>; 3],
    /// Square of the distance along the triangle, m², beyond which the node does not lie on that corner any more;
    /// infinite where it lies on none.
    pub(super) on_corner: Vec<f64>,
    /// Of each node and its triangle; on no side beside the outline of the face.
    pub(super) pairs: Pairs,
}

/// The point of a surface next to another one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Foot {
    pub(super) triangle: u32,
    /// Of its corners.
    pub(super) weights: [f64; 3],
    /// Unit normal on the side from which triangles are counterclockwise.
    pub(super) normal: Vector3<f64>,
    /// Distance along the normal, m.
    pub(super) distance: f64,
    /// Whether the point lies over the surface and not beside its outline.
    pub(super) is_over: bool,
}

impl Tracking {
    /// Nothing near any of `count` nodes.
    pub(super) fn new(count: usize) -> Tracking {
        let own: Vec<u32> = (0..count as u32).collect();
        Tracking {
            triangle: vec![NONE; count],
            corners: [own.clone(), own.clone(), own],
            on_corner: vec![f64::INFINITY; count],
            pairs: Pairs::none(count),
        }
    }

    /// Lets `node` follow `triangle` of `surface` on the side `sign`.
    pub(super) fn follow(&mut self, node: usize, triangle: u32, sign: f64, surface: &Surface) {
        self.triangle[node] = triangle;
        self.pairs.sign[node] = sign;
        let corners = surface.corners[triangle as usize];
        (0..3).for_each(|k| self.corners[k][node] = corners[k]);
        self.on_corner[node] = f64::INFINITY;
        self.pairs.due[node] = 0.0;
    }

    /// Decides whether `node` lies on a corner of its triangle, if that is not known: within [`ON_CORNER`] of the least
    /// allowed distance along the triangle, until it is [`OFF_CORNER`] of it away.
    pub(super) fn find_corner(&mut self, node: usize, position: &Vectors) {
        if self.triangle[node] == NONE || self.pairs.sign[node] == 0.0 || self.on_corner[node].is_finite() {
            return;
        }
        let corners = self.corners.each_ref().map(|corner| corner[node]);
        let ([a, b, c], point) = (corners.map(|n| place(position, n as usize)), place(position, node));
        let normal = (b - a).cross(&(c - a)).normalize();
        for (k, corner) in [a, b, c].iter().enumerate() {
            let from = point - corner;
            let along = from - normal * from.dot(&normal);
            if along.norm() <= ON_CORNER * self.pairs.bound[node] {
                (0..3).for_each(|l| self.corners[l][node] = corners[(k + l) % 3]);
                self.on_corner[node] = (OFF_CORNER * self.pairs.bound[node]).powi(2);
                return;
            }
        }
    }

    /// Notes that `node` does not lie on a corner any more.
    pub(super) fn leave_corner(&mut self, node: usize) {
        self.on_corner[node] = f64::INFINITY;
    }

    /// The corner on which `node` lies.
    pub(super) fn corner(&self, node: u32) -> Option<u32> {
        self.on_corner[node as usize].is_finite().then(|| self.corners[0][node as usize])
    }

    /// Lets `node` follow nothing.
    pub(super) fn lose(&mut self, node: usize) {
        self.triangle[node] = NONE;
        self.corners.iter_mut().for_each(|corner| corner[node] = node as u32);
        self.on_corner[node] = f64::INFINITY;
        self.pairs.sign[node] = 0.0;
        self.pairs.due[node] = f64::INFINITY;
    }

    /// Whether it fits a scene of so many nodes with the triangles of `surface`.
    pub(super) fn fits(&self, nodes: usize, surface: &Surface) -> bool {
        let triangles = surface.corners.len();
        [self.triangle.len(), self.on_corner.len()] == [nodes; 2]
            && self.pairs.fits(nodes)
            && self.triangle.iter().all(|triangle| *triangle == NONE || (*triangle as usize) < triangles)
            && self.corners.iter().all(|corner| corner.len() == nodes && are_below(corner, nodes))
    }
}

/// The foot of `point` on `surface` with nodes at `position`, followed from `triangle` over its neighbours.
pub(super) fn foot(surface: &Surface, position: &Vectors, point: &Vector3<f64>, triangle: u32) -> Foot {
    let (mut now, mut before) = (triangle, NONE);
    // Bounded: over crumpled film the walk need not end by itself.
    for _ in 0..HOPS {
        let (weights, normal, distance) = project(surface, position, point, now);
        // Over the side that the point lies farthest beyond, by the most negative weight.
        let (k, least) = least(&weights);
        if least >= -BESIDE {
            return Foot { triangle: now, weights, normal, distance, is_over: true };
        }
        // Past a sharp fold the surface turns its other side to the point.
        let leads_on = |k: usize| {
            let next = surface.across[now as usize][k];
            (next != NONE && normal_of(surface, position, next).dot(&normal) > 0.0).then_some(next)
        };
        match leads_on(k) {
            // Over a ridge: beside both triangles, but over their common edge.
            Some(next) if next == before => {
                // One triangle, whichever of the two the point was followed from: the foot does not depend on the path.
                let first = now.min(next);
                let edge = surface.edges_of[now as usize][k];
                let k = (0..3).find(|k| surface.edges_of[first as usize][*k] == edge).unwrap_or(k);
                return beside(surface, position, point, first, k, true);
            }
            Some(next) => (before, now) = (now, next),
            None => {
                // Another edge may lead on.
                let mut others = (1..3).map(|turn| (k + turn) % 3).filter(|l| weights[*l] < -BESIDE);
                match others.find_map(|l| leads_on(l).filter(|next| *next != before)) {
                    Some(next) => (before, now) = (now, next),
                    None => return beside(surface, position, point, now, k, false),
                }
            }
        }
    }
    let (weights, ..) = project(surface, position, point, now);
    // Around a corner: over none of its triangles.
    beside(surface, position, point, now, least(&weights).0, true)
}

/// The foot on the edge opposite to corner `k` of a triangle.
fn beside(surface: &Surface, position: &Vectors, point: &Vector3<f64>, triangle: u32, k: usize, is_over: bool) -> Foot {
    let corners = surface.corners[triangle as usize];
    let [from, to] = [(k + 1) % 3, (k + 2) % 3];
    let [a, b] = [from, to].map(|c| place(position, corners[c] as usize));
    let along = b - a;
    let share = ((point - a).dot(&along) / along.norm_squared()).clamp(0.0, 1.0);
    let mut weights = [0.0; 3];
    (weights[from], weights[to]) = (1.0 - share, share);
    // The mean normal of both sides of an edge, so that the direction of contact does not jump where a node passes the
    // ridge.
    let mut normal = normal_of(surface, position, triangle);
    let other = surface.across[triangle as usize][k];
    if other != NONE {
        let sum = normal + normal_of(surface, position, other);
        normal = sum / sum.norm();
    }
    Foot { triangle, weights, normal, distance: (point - (a + along * share)).dot(&normal), is_over }
}

/// Weights of the corners at the projection of `point` onto the plane of a triangle, its normal, and the distance.
pub(super) fn project(
    surface: &Surface,
    position: &Vectors,
    point: &Vector3<f64>,
    triangle: u32,
) -> ([f64; 3], Vector3<f64>, f64) {
    let [a, b, c] = surface.corners_at(position, triangle);
    let (u, v, r) = (b - a, c - a, point - a);
    let area = u.cross(&v);
    let squared = area.norm_squared();
    let (of_b, of_c) = (r.cross(&v).dot(&area) / squared, u.cross(&r).dot(&area) / squared);
    let normal = area / squared.sqrt();
    ([1.0 - of_b - of_c, of_b, of_c], normal, r.dot(&normal))
}

/// Unit normal of a triangle.
pub(super) fn normal_of(surface: &Surface, position: &Vectors, triangle: u32) -> Vector3<f64> {
    let [a, b, c] = surface.corners_at(position, triangle);
    let area = (b - a).cross(&(c - a));
    area / area.norm()
}

/// The least of three weights and its corner.
fn least(weights: &[f64; 3]) -> (usize, f64) {
    let mut out = (0, weights[0]);
    for k in 1..3 {
        if weights[k] < out.1 {
            out = (k, weights[k]);
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::{Film, Mesh, Nodes, Section};
    use crate::material::{Elastic, Law};
    use nalgebra::Point3;

    /// A roof of two quadrilaterals over the y axis, 1 m wide on each side and 0.5 m high.
    fn roof() -> (Surface, Nodes) {
        let nodes =
            [[-1.0, 0.0, 0.0], [0.0, 0.0, 0.5], [1.0, 0.0, 0.0], [-1.0, 1.0, 0.0], [0.0, 1.0, 0.5], [1.0, 1.0, 0.0]];
        let quads = vec![[0, 1, 4, 3], [1, 2, 5, 4]];
        let mesh = Mesh { nodes: nodes.map(Point3::from).into(), quads, ..Mesh::default() };
        let law = Law::Elastic(Elastic { young: 1.0, poisson: 0.3 });
        let section = Section::new(law, 1.0, 1e-3);
        let mut all = Nodes::default();
        let film = Film::mount(&mesh, &section, 0.0, &mut all).unwrap();
        (Surface::new(&[film]), all)
    }

    #[test]
    fn a_point_is_followed_over_the_ridge_to_its_foot_and_beside_the_outline() {
        let (surface, nodes) = roof();
        let slope = 0.25_f64.atan2(0.5);
        for (point, distance, is_over) in [
            ([-0.5, 0.6, 0.25 + 0.1 / slope.cos()], 0.1, true),
            ([0.5, 0.4, 0.25 - 0.1 / slope.cos()], -0.1, true),
            // Above the ridge: beside both sides, over their edge.
            ([0.0, 0.5, 0.7], 0.2, true),
            ([-1.2, 0.5, 0.0], 0.0, false),
        ] {
            for from in 0..4 {
                let found = foot(&surface, &nodes.position, &Vector3::from(point), from);
                assert_eq!(found.is_over, is_over, "{point:?} from {from}: {found:?}");
                if is_over {
                    assert!((found.distance - distance).abs() < 1e-12, "{point:?} from {from}: {found:?}");
                    assert!((found.weights.iter().sum::<f64>() - 1.0).abs() < 1e-12);
                    let corners = surface.corners[found.triangle as usize];
                    let at = |k: usize| Vector3::from(nodes.position.value_at(corners[k] as usize)) * found.weights[k];
                    let apart = Vector3::from(point) - (at(0) + at(1) + at(2));
                    assert!((apart - found.normal * found.distance).norm() < 1e-12, "{point:?} from {from}: {found:?}");
                }
            }
        }
    }
}
