//! Corners and edges of a closed mesh, which film meets between its nodes.

use nalgebra::Vector3;
use parry3d_f64::bounding_volume::Aabb;
use parry3d_f64::shape::TriMesh;

use super::element_points::{DeepestPoint, Search, corner_weights, sides, weights_of};
use super::projection::Projection;
use super::vector;

/// Angle between two faces above which their edge counts as sharp, rad: below it they stand for a curved surface.
const SHARP: f64 = 0.3;

/// Sine of the angle between two edges below which they are left to corners and nodes.
const PARALLEL: f64 = 1e-3;

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
    /// Ends of the edges at each vertex: those of vertex `n` from `first[n]` to `first[n + 1]`.
    around: Vec<u32>,
    first: Vec<u32>,
    edge_radius: f64,
}

/// An edge between two triangles.
#[derive(Clone, Copy, Debug)]
struct Edge {
    ends: [u32; 2],
    /// The third corners of its triangles.
    opposite: [u32; 2],
}

impl Features {
    /// Those of a closed mesh.
    pub(super) fn of(mesh: &TriMesh) -> Features {
        let vertices: Vec<Vector3<f64>> = mesh.vertices().iter().map(|v| Vector3::new(v.x, v.y, v.z)).collect();
        let triangles = mesh.indices().to_vec();
        // Both triangles of an edge list it, once in each direction.
        let mut sides: Vec<([u32; 2], u32, usize, usize)> = vec![];
        for (t, [a, b, c]) in triangles.iter().enumerate() {
            for (k, (ends, opposite)) in [([*a, *b], *c), ([*b, *c], *a), ([*c, *a], *b)].into_iter().enumerate() {
                sides.push(([ends[0].min(ends[1]), ends[0].max(ends[1])], opposite, t, k));
            }
        }
        sides.sort_unstable();
        let (mut edges, mut edges_of) = (vec![], vec![[0; 3]; triangles.len()]);
        for pair in sides.chunk_by(|one, other| one.0 == other.0) {
            for (_, _, t, k) in pair {
                edges_of[*t][*k] = edges.len() as u32;
            }
            edges.push(Edge { ends: pair[0].0, opposite: [pair[0].1, pair[pair.len() - 1].1] });
        }
        let mut ends: Vec<[u32; 2]> = edges.iter().flat_map(|edge| [edge.ends, [edge.ends[1], edge.ends[0]]]).collect();
        ends.sort_unstable();
        let first =
            (0..=vertices.len()).map(|n| ends.partition_point(|[from, _]| (*from as usize) < n) as u32).collect();
        let around = ends.into_iter().map(|[_, to]| to).collect();
        let mut features = Features { vertices, triangles, edges_of, edges, around, first, edge_radius: f64::INFINITY };
        let radii = features.edges.iter().filter_map(|edge| features.radius(edge));
        features.edge_radius = radii.fold(f64::INFINITY, f64::min);
        features
    }

    fn at(&self, vertex: u32) -> Vector3<f64> {
        self.vertices[vertex as usize]
    }

    /// Radius of the surface that the triangles of an edge stand for, m: the mean of their heights over the angle
    /// between them (theory.md, equation 213); zero where that is sharp.
    fn radius(&self, edge: &Edge) -> Option<f64> {
        let ([a, b], [c, d]) = (edge.ends.map(|n| self.at(n)), edge.opposite.map(|n| self.at(n)));
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

    /// Radius of the sharpest edge, m.
    pub(super) fn edge_radius(&self) -> f64 {
        self.edge_radius
    }

    /// Whether the body lies below `vertex` along the unit vector `normal`.
    fn supports(&self, vertex: u32, normal: &Vector3<f64>) -> bool {
        let at = self.at(vertex);
        let [first, end] = [0, 1].map(|k| self.first[vertex as usize + k] as usize);
        self.around[first..end].iter().all(|n| {
            let side = self.at(*n) - at;
            side.dot(normal) <= ROUND_OFF * side.norm()
        })
    }

    /// Offers the `points` of an element, corners and mean in body axes with their projections on `mesh`, its points under
    /// corners of the mesh and those where its edges cross edges of the mesh.
    pub(super) fn deepest(
        &self,
        mesh: &TriMesh,
        points: &[Vector3<f64>; 5],
        projected: &[Projection; 5],
        count: usize,
        search: &mut Search,
    ) {
        let mut offer = |projection: Projection, weights: [f64; 4]| {
            search.offer(DeepestPoint { projection, weights, side: 0, extent: projection.distance });
            search.within
        };
        let mut within = f64::INFINITY;
        for k in (0..count).chain([4]) {
            within = offer(projected[k], weights_of(k));
        }
        let (mut low, mut high) = (points[4], points[4]);
        for point in &points[..count] {
            (low, high) = (low.inf(point), high.sup(point));
        }
        // What lies deeper than a share of the element has not come through it.
        let reach = 0.5 * (high - low).norm();
        let margin = Vector3::repeat(reach.max(within));
        let near: Vec<u32> =
            mesh.bvh().intersect_aabb(&Aabb::new(vector(&(low - margin)), vector(&(high + margin)))).collect();
        let [mut vertices, mut edges]: [Vec<u32>; 2] = [vec![], vec![]];
        for t in near {
            vertices.extend(self.triangles[t as usize]);
            edges.extend(self.edges_of[t as usize]);
        }
        for list in [&mut vertices, &mut edges] {
            list.sort_unstable();
            list.dedup();
        }
        for [a, b] in sides(count) {
            let triangle = [points[a], points[b], points[4]];
            for vertex in &vertices {
                if let Some((projection, at)) = self.under_vertex(*vertex, &triangle, reach) {
                    offer(projection, corner_weights(a, b, at));
                }
            }
            for edge in &edges {
                for (side, place) in [([0, 1], 0), ([0, 2], 1)] {
                    let ends = side.map(|k: usize| triangle[k]);
                    if let Some((projection, share)) = self.across_edge(*edge, &ends, reach) {
                        let at = if place == 0 { [1.0 - share, share, 0.0] } else { [1.0 - share, 0.0, share] };
                        offer(projection, corner_weights(a, b, at));
                    }
                }
            }
        }
    }

    /// Distance of a triangle of film from a corner, with the barycentric coordinates of its point there.
    fn under_vertex(&self, vertex: u32, [p, q, m]: &[Vector3<f64>; 3], reach: f64) -> Option<(Projection, [f64; 3])> {
        let (at, cross) = (self.at(vertex), (q - p).cross(&(m - p)));
        let doubled = cross.norm();
        let normal = cross / doubled;
        let height = normal.dot(&(at - p));
        if doubled == 0.0 || height.abs() > reach {
            return None;
        }
        let part = |u: &Vector3<f64>, v: &Vector3<f64>| (u - at).cross(&(v - at)).dot(&normal) / doubled;
        let (of_p, of_q) = (part(q, m), part(m, p));
        let of_m = 1.0 - of_p - of_q;
        if of_p < 0.0 || of_q < 0.0 || of_m < 0.0 {
            return None;
        }
        let outward = [normal, -normal].into_iter().find(|normal| self.supports(vertex, normal))?;
        Some((Projection { distance: outward.dot(&(p - at)), normal: outward }, [of_p, of_q, of_m]))
    }

    /// Distance of an edge of film from an edge of the mesh that it crosses, with the share of the length where it does.
    fn across_edge(&self, edge: u32, [s, t]: &[Vector3<f64>; 2], reach: f64) -> Option<(Projection, f64)> {
        let Edge { ends, opposite } = self.edges[edge as usize];
        let [a, b] = ends.map(|n| self.at(n));
        let (along, film) = (b - a, t - s);
        let cross = along.cross(&film);
        let size = cross.norm();
        if size <= PARALLEL * along.norm() * film.norm() {
            return None;
        }
        let from = s - a;
        let on_mesh = from.cross(&film).dot(&cross) / (size * size);
        let on_film = from.cross(&along).dot(&cross) / (size * size);
        if !(0.0..=1.0).contains(&on_mesh) || !(0.0..=1.0).contains(&on_film) {
            return None;
        }
        let normal = cross / size;
        let supports = |normal: &Vector3<f64>| {
            opposite.iter().all(|n| {
                let side = self.at(*n) - a;
                side.dot(normal) <= ROUND_OFF * side.norm()
            })
        };
        let outward = [normal, -normal].into_iter().find(supports)?;
        let distance = outward.dot(&from);
        (distance.abs() <= reach).then_some((Projection { distance, normal: outward }, on_film))
    }
}
