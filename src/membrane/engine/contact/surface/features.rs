//! Corners and edges of a closed mesh, which film meets between its nodes.

use nalgebra::Vector3;
use parry3d_f64::bounding_volume::Aabb;
use parry3d_f64::math::Vector;
use parry3d_f64::query::PointQueryWithLocation;
use parry3d_f64::shape::{TriMesh, TrianglePointLocation};

use super::element_points::{DeepestPoint, Search, corner_weights, sides, weights_of};
use super::projection::Projection;
use super::vector;
use crate::engine::adjacency::{Around, sorted_sides};

/// Angle between two faces above which their edge counts as sharp, rad: below it they stand for a curved surface.
const SHARP: f64 = 0.3;

/// Sine of the angle between two edges below which they are left to corners and nodes.
const PARALLEL: f64 = 1e-3;

/// Distance up to which more than what is looked for is found, over half the diagonal of an element.
const BEYOND: f64 = 0.05;

/// Triangles over which a point is followed at most.
const HOPS: usize = 16;

/// Least weight of a corner of the triangle that a point lies over.
const INSIDE: f64 = 1e-6;

/// Share of a length by which a point may lie outside what an edge or a corner supports.
const ROUND_OFF: f64 = 1e-9;

/// Corners and edges of a closed mesh.
#[derive(Clone, Debug)]
pub(super) struct Features {
    vertices: Vec<Vector3<f64>>,
    triangles: Vec<[u32; 3]>,
    /// Edges of each triangle, from its first corner on.
    edges_of: Vec<[u32; 3]>,
    edges: Vec<Edge>,
    /// Ends of the edges at each vertex.
    around: Around<u32>,
    edge_radius: f64,
    is_convex: bool,
}

/// An edge between two triangles.
#[derive(Clone, Copy, Debug)]
struct Edge {
    ends: [u32; 2],
    /// The third corners of its triangles.
    opposite: [u32; 2],
    triangles: [u32; 2],
}

/// Corners of a mesh with their places, and edges with the places of their ends among these.
struct Near {
    vertices: Vec<(u32, Vector3<f64>)>,
    edges: Vec<(u32, [usize; 2])>,
}

/// A triangle of film.
struct Face {
    corners: [Vector3<f64>; 3],
    /// Outward from the body.
    normal: Vector3<f64>,
    /// Change of the weights of the first two corners in space, 1/m.
    gradients: [Vector3<f64>; 2],
}

impl Face {
    /// The triangle with its normal on the side of `outward`; none of a triangle without area.
    fn new(corners: [Vector3<f64>; 3], outward: &Vector3<f64>) -> Option<Face> {
        let [u, v] = [corners[0] - corners[2], corners[1] - corners[2]];
        let cross = u.cross(&v);
        let squared = cross.norm_squared();
        // A sign on the root instead of a branch on the cross product.
        let normal = cross / squared.sqrt().copysign(cross.dot(outward));
        (squared > 0.0).then(|| Face {
            corners,
            normal,
            // Weights are linear in the point: with their gradients a corner of the mesh costs two scalar products.
            gradients: [v.cross(&cross) / squared, cross.cross(&u) / squared],
        })
    }

    /// Weights of the corners at the foot of a point, if that is inside.
    fn weights_under(&self, at: &Vector3<f64>) -> Option<[f64; 3]> {
        let arm = at - self.corners[2];
        let [p, q] = self.gradients.each_ref().map(|gradient| gradient.dot(&arm));
        let m = 1.0 - p - q;
        (p >= 0.0 && q >= 0.0 && m >= 0.0).then_some([p, q, m])
    }
}

impl Features {
    /// Corners and edges of a closed `mesh`.
    pub(super) fn from_mesh(mesh: &TriMesh) -> Features {
        let vertices: Vec<Vector3<f64>> = mesh.vertices().iter().map(|v| Vector3::new(v.x, v.y, v.z)).collect();
        let triangles = mesh.indices().to_vec();
        let (mut edges, mut edges_of) = (vec![], vec![[0; 3]; triangles.len()]);
        for of_edge in sorted_sides(&triangles).chunk_by(|one, other| one.ends == other.ends) {
            for side in of_edge {
                // The edge opposite to a corner begins at the next one.
                edges_of[side.triangle as usize][(side.corner + 1) % 3] = edges.len() as u32;
            }
            // An edge with one triangle, which a closed mesh does not have, is its own neighbour instead of a panic.
            let both = [of_edge[0], of_edge[of_edge.len() - 1]];
            let opposite = both.map(|side| triangles[side.triangle as usize][side.corner]);
            edges.push(Edge { ends: of_edge[0].ends, opposite, triangles: both.map(|side| side.triangle) });
        }
        let ends = edges.iter().flat_map(|Edge { ends: [a, b], .. }| [(*a, *b), (*b, *a)]);
        let around = Around::new(vertices.len(), ends.collect());
        let mut features =
            Features { vertices, triangles, edges_of, edges, around, edge_radius: f64::INFINITY, is_convex: true };
        let radii = features.edges.iter().filter_map(|edge| features.radius(edge));
        features.edge_radius = radii.fold(f64::INFINITY, f64::min);
        // A closed surface of one part that bends inwards nowhere is convex; Euler's number tells the number of parts.
        let used = (0..features.around.len()).filter(|vertex| !features.around.at(*vertex as u32).is_empty()).count();
        features.is_convex = used + features.triangles.len() == features.edges.len() + 2
            && features.triangles.iter().zip(&features.edges_of).all(|(t, e)| features.is_above_its_neighbours(t, e));
        features
    }

    fn vertex(&self, vertex: u32) -> Vector3<f64> {
        self.vertices[vertex as usize]
    }

    /// Radius of the surface that the triangles of an edge stand for, m: the mean of their heights over the angle
    /// between them (theory.md, equation 213); zero where that is sharp.
    fn radius(&self, edge: &Edge) -> Option<f64> {
        let ([a, b], [c, d]) = (edge.ends.map(|n| self.vertex(n)), edge.opposite.map(|n| self.vertex(n)));
        let along = (b - a).try_normalize(0.0)?;
        let across = |to: Vector3<f64>| (to - a) - along * along.dot(&(to - a));
        let [c, d] = [across(c), across(d)];
        let heights = [c.norm(), d.norm()];
        let cosine = -c.dot(&d) / (heights[0] * heights[1]);
        // The angle from its chord: 2 sin(θ/2) = √(2 − 2 cos θ).
        let angle = (2.0 - 2.0 * cosine).max(0.0).sqrt();
        if angle < 1e-6 {
            return None;
        }
        Some(if angle > SHARP { 0.0 } else { (heights[0] + heights[1]) / 3.0 / angle })
    }

    /// Whether the triangles next to one lie below its plane.
    fn is_above_its_neighbours(&self, triangle: &[u32; 3], edges: &[u32; 3]) -> bool {
        let [a, b, c] = triangle.map(|n| self.vertex(n));
        let normal = (b - a).cross(&(c - a)).normalize();
        let others = edges.iter().flat_map(|edge| self.edges[*edge as usize].opposite).map(|n| self.vertex(n) - a);
        others.into_iter().all(|arm| arm.dot(&normal) <= ROUND_OFF * arm.norm())
    }

    /// The triangle beyond an edge of another one, counted from its first corner on.
    fn across(&self, triangle: u32, edge: u32) -> u32 {
        let [one, other] = self.edges[self.edges_of[triangle as usize][edge as usize] as usize].triangles;
        if one == triangle { other } else { one }
    }

    /// The face of a convex `mesh` that a point outside of it lies over, and its foot there, found from `triangle` over its
    /// neighbours. The body lies below the plane of that face, so none of its points is nearer.
    pub(super) fn face_under(&self, mesh: &TriMesh, point: Vector, triangle: u32) -> Option<(u32, Vector)> {
        let (mut at, mut before) = (triangle, triangle);
        for _ in 0..HOPS {
            let (foot, location) = mesh.triangle(at).project_local_point_and_get_location(point, false);
            match location {
                // Outside, and so far from the edges that no other triangle is as near but for round-off: a search over the
                // whole mesh would then end at this one, too.
                TrianglePointLocation::OnFace(0, weights) => {
                    return weights.iter().all(|weight| *weight >= INSIDE).then_some((at, foot.point));
                }
                // Corners lie between the edges of the same number and the one before.
                TrianglePointLocation::OnEdge(edge, _) | TrianglePointLocation::OnVertex(edge) => {
                    let next = self.across(at, edge);
                    // Over the edge itself, of which either triangle tells the same but for round-off.
                    if next == before {
                        return None;
                    }
                    (before, at) = (at, next);
                }
                _ => return None,
            }
        }
        None
    }

    /// Whether the body is convex.
    pub(super) fn is_convex(&self) -> bool {
        self.is_convex
    }

    /// Radius of the sharpest edge, m.
    pub(super) fn edge_radius(&self) -> f64 {
        self.edge_radius
    }

    /// How far a convex body reaches along the unit vector `direction`, m, searched from a corner of `triangle` on.
    pub(super) fn reach(&self, direction: &Vector3<f64>, triangle: u32) -> f64 {
        let mut at = self.triangles[triangle as usize][0];
        let mut reach = self.vertex(at).dot(direction);
        // Uphill from corner to corner: on a convex body no other corner lies beyond one whose neighbours do not.
        loop {
            let before = at;
            for next in self.around.at(before) {
                let along = self.vertex(*next).dot(direction);
                if along > reach {
                    (at, reach) = (*next, along);
                }
            }
            if at == before {
                return reach;
            }
        }
    }

    /// Whether the body lies below `vertex` along the unit vector `normal`.
    fn supports(&self, vertex: u32, normal: &Vector3<f64>) -> bool {
        let at = self.vertex(vertex);
        self.around.at(vertex).iter().all(|n| {
            let side = self.vertex(*n) - at;
            side.dot(normal) <= ROUND_OFF * side.norm()
        })
    }

    /// Offers the `points` of an element, corners and mean in body axes with their projections on `mesh`, its points
    /// under corners of the mesh and those where its edges cross edges of the mesh.
    pub(super) fn deepest(
        &self,
        mesh: &TriMesh,
        points: &[Vector3<f64>; 5],
        projected: &[Projection; 5],
        count: usize,
        search: &mut Search,
    ) {
        for k in (0..count).chain([4]) {
            let projection = projected[k];
            let extent = projection.distance;
            search.offer(DeepestPoint { projection, weights: weights_of(k), side: 0, extent });
        }
        let (mut low, mut high) = (points[4], points[4]);
        for point in &points[..count] {
            (low, high) = (low.inf(point), high.sup(point));
        }
        // Points deeper than a share of the element have not come through it.
        let half = 0.5 * (high - low).norm();
        // A little more than is asked for, so that it need not be looked for again when the element has moved.
        let beyond = if search.keeps_all { BEYOND * half } else { 0.0 };
        // What the element has of depth along one normal of the body, it has over the cosine of the angle between them
        // along its own: twice that up to 60 degrees. Nothing is asked of points that are as far outside.
        let reach = half.min(2.0 * search.depth.max(search.within + beyond));
        search.least = search.least.min(reach);
        // By the box of the whole element: its four triangles share the corners and edges that are found.
        let near = self.near(mesh, [low, high], reach.max(search.within + beyond));
        let mut heights = vec![];
        for [a, b] in sides(count) {
            // The mean is projected anyway, and one side for all four triangles keeps their contacts consistent.
            let Some(face) = Face::new([points[a], points[b], points[4]], &projected[4].normal) else { continue };
            heights.clear();
            // Heights once a triangle: corners and both ends of every edge are compared by them.
            heights.extend(near.vertices.iter().map(|(_, at)| face.normal.dot(&(at - face.corners[2]))));
            for ((vertex, at), height) in near.vertices.iter().zip(&heights) {
                // It is the farther inside the body the higher the corner is.
                if height.abs() <= reach
                    && -height.abs() < search.within + beyond
                    && let Some(weights) = face.weights_under(at)
                    && let Some(outward) = [face.normal, -face.normal].into_iter().find(|n| self.supports(*vertex, n))
                {
                    let distance = -height * outward.dot(&face.normal);
                    let projection = Projection { distance, normal: outward };
                    let weights = corner_weights(a, b, weights);
                    search.offer(DeepestPoint { projection, weights, side: 0, extent: distance });
                }
            }
            let lowest = -(search.within + beyond).max(0.0);
            for (edge, ends) in &near.edges {
                // Film that is deep enough in the body has one of the ends above it.
                if ends.iter().all(|end| heights[*end] <= lowest) {
                    continue;
                }
                // The third side, from the second corner to the mean, is one of the next triangle.
                for other in [1, 2] {
                    let film = [face.corners[0], face.corners[other]];
                    if let Some((projection, share)) = self.across_edge(*edge, &film, reach) {
                        let mut at = [1.0 - share, 0.0, 0.0];
                        at[other] = share;
                        let (weights, extent) = (corner_weights(a, b, at), projection.distance);
                        search.offer(DeepestPoint { projection, weights, side: 0, extent });
                    }
                }
            }
        }
        search.least = search.least.min(search.within + beyond);
    }

    /// Corners and edges of the triangles of `mesh` that lie within `margin` (m) of a box from `low` to `high` (m).
    fn near(&self, mesh: &TriMesh, [low, high]: [Vector3<f64>; 2], margin: f64) -> Near {
        let margin = Vector3::repeat(margin);
        let [mut vertices, mut edges]: [Vec<u32>; 2] = [vec![], vec![]];
        for t in mesh.bvh().intersect_aabb(&Aabb::new(vector(&(low - margin)), vector(&(high + margin)))) {
            vertices.extend(self.triangles[t as usize]);
            edges.extend(self.edges_of[t as usize]);
        }
        for list in [&mut vertices, &mut edges] {
            list.sort_unstable();
            list.dedup();
        }
        let place = |n: u32| vertices.partition_point(|vertex| *vertex < n);
        let edges = edges.into_iter().map(|edge| (edge, self.edges[edge as usize].ends.map(place))).collect();
        Near { edges, vertices: vertices.into_iter().map(|n| (n, self.vertex(n))).collect() }
    }

    /// Distance of an edge of film from an edge of the mesh that it crosses, with the share of the length where it
    /// does.
    fn across_edge(&self, edge: u32, [s, t]: &[Vector3<f64>; 2], reach: f64) -> Option<(Projection, f64)> {
        let Edge { ends, opposite, .. } = self.edges[edge as usize];
        let [a, b] = ends.map(|n| self.vertex(n));
        let (along, film) = (b - a, t - s);
        let cross = along.cross(&film);
        let squared = cross.norm_squared();
        // Compared before any division: parallel edges have no common normal, and their ends are corners and nodes
        // anyway.
        if squared <= PARALLEL * PARALLEL * along.norm_squared() * film.norm_squared() {
            return None;
        }
        let from = s - a;
        // Shares times the square of the cross product: the test needs no division, and most pairs fail it.
        let on_mesh = from.cross(&film).dot(&cross);
        let on_film = from.cross(&along).dot(&cross);
        if !(0.0..=squared).contains(&on_mesh) || !(0.0..=squared).contains(&on_film) {
            return None;
        }
        let (normal, on_film) = (cross / squared.sqrt(), on_film / squared);
        let supports = |normal: &Vector3<f64>| {
            opposite.iter().all(|n| {
                let side = self.vertex(*n) - a;
                side.dot(normal) <= ROUND_OFF * side.norm()
            })
        };
        let outward = [normal, -normal].into_iter().find(supports)?;
        let distance = outward.dot(&from);
        (distance.abs() <= reach).then_some((Projection { distance, normal: outward }, on_film))
    }
}
