//! Search for faces near the nodes of others.

use nalgebra::Vector3;
use parry3d_f64::bounding_volume::{Aabb, BoundingVolume};
use parry3d_f64::math::Vector;
use parry3d_f64::partitioning::{Bvh, BvhBuildStrategy};

use super::surface::{NONE, Surface};
use super::tracking::{Foot, foot};
use crate::engine::film::Film;
use crate::engine::nodes::Vectors;

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
        let at = self.position.at(node as usize);
        let around = Aabb::from_half_extents(Vector::from(at), Vector::splat(self.reach));
        if !around.intersects(&self.boxes[face]) {
            return None;
        }
        let (surface, position) = (self.surface, self.position);
        let first = surface.faces[face].start;
        let tree = self.trees[face].get_or_insert_with(|| {
            let leaf = |triangle: u32| {
                let corners = surface.corners[triangle as usize].map(|n| Vector::from(position.at(n as usize)));
                let low = corners[0].min(corners[1]).min(corners[2]);
                Aabb::new(low, corners[0].max(corners[1]).max(corners[2]))
            };
            let leaves: Vec<Aabb> = surface.faces[face].clone().map(leaf).collect();
            Bvh::from_leaves(BvhBuildStrategy::Binned, &leaves)
        });
        let point = Vector3::from(at);
        let mut nearest = (self.reach * self.reach, NONE);
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

/// Square of the distance between a point and a triangle, m².
fn distance_squared(surface: &Surface, position: &Vectors, point: &Vector3<f64>, triangle: u32) -> f64 {
    use parry3d_f64::query::PointQuery;
    use parry3d_f64::shape::Triangle;
    let [a, b, c] = surface.corners[triangle as usize].map(|n| Vector::from(position.at(n as usize)));
    let point = Vector::from(<[f64; 3]>::from(*point));
    let projected = Triangle::new(a, b, c).project_local_point(point, true).point;
    (projected - point).length_squared()
}
