//! Broad phase: which triangles of other faces the nodes follow.

use nalgebra::Vector3;
use parry3d_f64::bounding_volume::{Aabb, BoundingVolume};
use parry3d_f64::math::Vector;
use parry3d_f64::partitioning::{Bvh, BvhBuildStrategy};

use super::FilmContact;
use super::surface::{NONE, Surface, place};
use super::tracking::{Foot, foot};
use crate::engine::film::Film;
use crate::engine::nodes::{Nodes, Vectors};

/// The faces as they are now, in bounding volumes.
pub(super) struct Search<'a> {
    surface: &'a Surface,
    position: &'a Vectors,
    /// Distance up to which it looks, m.
    reach: f64,
    /// Of each face.
    boxes: Vec<Aabb>,
    /// Of each face once it was needed: a leaf a triangle.
    trees: Vec<Option<Bvh>>,
}

impl<'a> Search<'a> {
    /// A search up to the distance `reach` (m) of a node.
    pub(super) fn new(films: &[Film], surface: &'a Surface, position: &'a Vectors, reach: f64) -> Search<'a> {
        // Boxes of whole faces rule out most pairs before a tree is built for any.
        let of_face = |film: &Film| {
            let axes = position.range(film.nodes.clone());
            let low = axes.map(|axis| axis.iter().copied().fold(f64::INFINITY, f64::min));
            let high = axes.map(|axis| axis.iter().copied().fold(f64::NEG_INFINITY, f64::max));
            Aabb::new(Vector::from(low), Vector::from(high))
        };
        let trees = films.iter().map(|_| None).collect();
        Search { surface, position, reach, boxes: films.iter().map(of_face).collect(), trees }
    }

    /// Whether any node of one face may be near the other one.
    pub(super) fn may_meet(&self, one: usize, other: usize) -> bool {
        self.boxes[one].loosened(self.reach).intersects(&self.boxes[other])
    }

    /// The foot of a node on `face`, where one is near: on the triangle that lies nearest.
    pub(super) fn nearest(&mut self, node: u32, face: usize) -> Option<Foot> {
        let at = self.position.value_at(node as usize);
        let around = Aabb::from_half_extents(Vector::from(at), Vector::splat(self.reach));
        if !around.intersects(&self.boxes[face]) {
            return None;
        }
        let (surface, position) = (self.surface, self.position);
        let first = surface.faces[face].start;
        // Built anew in each search, as film has moved by much of an edge by then, and only for faces that a node is
        // near.
        let tree = self.trees[face].get_or_insert_with(|| {
            let leaf = |triangle: u32| {
                let corners = surface.corners[triangle as usize].map(|n| Vector::from(position.value_at(n as usize)));
                let low = corners[0].min(corners[1]).min(corners[2]);
                Aabb::new(low, corners[0].max(corners[1]).max(corners[2]))
            };
            let leaves: Vec<Aabb> = surface.faces[face].clone().map(leaf).collect();
            Bvh::from_leaves(BvhBuildStrategy::Binned, &leaves)
        });
        let point = Vector3::from(at);
        let mut nearest = (self.reach * self.reach, NONE);
        // All within reach instead of the tree's own nearest: that one depends on how the tree was built where several
        // are as near.
        for triangle in tree.intersect_aabb(&around).map(|leaf| first + leaf) {
            if !surface.is_intact[triangle as usize] {
                continue;
            }
            let squared = distance_squared(surface, position, &point, triangle);
            // Of triangles at the same distance the first: neighbouring nodes then follow neighbouring triangles.
            if squared < nearest.0 || (squared == nearest.0 && triangle < nearest.1) {
                nearest = (squared, triangle);
            }
        }
        (nearest.1 != NONE).then(|| foot(surface, position, &point, nearest.1))
    }
}

impl FilmContact {
    /// Searches the next face on either side of every node that has none in touch.
    pub(super) fn search(&mut self, films: &[Film], nodes: &Nodes) {
        let mut search = Search::new(films, &self.surface, &nodes.position, self.reach);
        let mut changed = vec![];
        for (face, film) in films.iter().enumerate() {
            for (side, tracking) in self.history.tracking.iter_mut().enumerate() {
                let others: Vec<usize> = match side {
                    // From the next face outwards, so that the first one found is that which lies between.
                    0 => (0..face).rev().filter(|other| search.may_meet(face, *other)).collect(),
                    _ => (face + 1..films.len()).filter(|other| search.may_meet(face, *other)).collect(),
                };
                for node in film.nodes.clone() {
                    let followed = tracking.triangle[node];
                    if !self.surface.is_intact_node(node as u32) {
                        continue;
                    }
                    if followed != NONE {
                        let now = foot(&self.surface, &nodes.position, &place(&nodes.position, node), followed);
                        // Nothing comes between films that touch each other.
                        if now.is_over && now.distance.abs() < 0.1 * self.reach {
                            continue;
                        }
                    }
                    // A face whose outline ends here must not hide the one behind it, but is followed where there is
                    // none.
                    let mut beside = None;
                    let over = others.iter().find_map(|other| {
                        let foot = search.nearest(node as u32, *other)?;
                        if foot.is_over && foot.distance.abs() < self.reach {
                            return Some(foot);
                        }
                        beside = beside.or(Some(foot));
                        None
                    });
                    let Some(foot) = over.or(beside) else {
                        if followed != NONE {
                            changed.push((node as u32, followed));
                            tracking.lose(node);
                        }
                        continue;
                    };
                    let other = self.surface.face_of(foot.triangle);
                    let same_face = followed != NONE && self.surface.face_of(followed) == other;
                    // A side is that with respect to one face; towards another one it is decided by where the node is
                    // now.
                    let kept = if same_face { tracking.pairs.sign[node] } else { 0.0 };
                    let sign = match (foot.is_over, kept != 0.0) {
                        (true, true) => kept,
                        (true, false) => 1.0_f64.copysign(foot.distance),
                        (false, _) => 0.0,
                    };
                    let thickness = self.half[face] + self.half[other];
                    // Crossings of the edges around both triangles depend on it.
                    if foot.triangle != followed || sign != tracking.pairs.sign[node] {
                        changed.push((node as u32, foot.triangle));
                        changed.extend((followed != NONE).then_some((node as u32, followed)));
                    }
                    tracking.follow(node, foot.triangle, sign, &self.surface);
                    tracking.pairs.bound[node] = (1.0 - super::SLOP) * thickness;
                }
            }
        }
        // A node farther than `reach` is as near as allowed only once film has moved by the rest.
        self.history.margin = self.reach - self.largest_bound;
        self.history.is_near =
            self.history.tracking.iter().any(|tracking| tracking.triangle.iter().any(|t| *t != NONE));
        // Only now, since `search` borrows the surface.
        changed.into_iter().for_each(|(node, triangle)| self.mark(node, triangle));
    }
}

/// Square of the distance between a point and a triangle, m².
fn distance_squared(surface: &Surface, position: &Vectors, point: &Vector3<f64>, triangle: u32) -> f64 {
    use parry3d_f64::query::PointQuery;
    use parry3d_f64::shape::Triangle;
    let [a, b, c] = surface.corners[triangle as usize].map(|n| Vector::from(position.value_at(n as usize)));
    let point = Vector::from(<[f64; 3]>::from(*point));
    let projected = Triangle::new(a, b, c).project_local_point(point, true).point;
    (projected - point).length_squared()
}
