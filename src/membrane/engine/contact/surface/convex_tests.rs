//! Closed forms and caches of the surface against parry's queries.

use nalgebra::{Isometry3, Vector3};
use parry3d_f64::shape::{Ball, TriMesh};

use super::triangle_minimum::{Minimum, minimum, over_plane};
use super::*;

/// A sphere, a hemisphere-ended shaft, a cylinder, one with rounded edges, a box, a cone, and a body of two parts.
pub(super) fn test_shapes() -> Vec<Surface> {
    let two = || -> Result<Surface, SurfaceError> {
        let high = Isometry3::translation(0.0, 0.0, 0.09);
        Surface::compound(vec![(Isometry3::identity(), Surface::sphere(0.04)?), (high, Surface::capsule(0.02, 0.1)?)])
    };
    let shapes = [
        Surface::sphere(0.15),
        Surface::capsule(0.02, 0.1),
        Surface::cylinder(0.03, 0.2, 0.0),
        Surface::cylinder(0.03, 0.2, 0.005),
        Surface::cuboid([0.1, 0.08, 0.12], 0.01),
        Surface::cone(0.04, 0.1, 0.004),
        two(),
    ];
    shapes.map(Result::unwrap).into()
}

/// Points around a body, inside and outside, from a sequence that fills space.
fn points(reach: f64, count: u32) -> impl Iterator<Item = Vector3<f64>> {
    let share = |k: u32, step: f64| (f64::from(k) * step).fract() * 2.0 - 1.0;
    (1..=count).map(move |k| Vector3::new(share(k, 0.819_172), share(k, 0.671_043), share(k, 0.549_700)) * reach)
}

/// Distances are parry's; normals are those of the nearest point, and the derivative of the distance inside.
#[test]
fn closed_forms_are_the_projections_of_parry() {
    let shapes = [
        Surface::cylinder(0.03, 0.2, 0.0),
        Surface::cylinder(0.03, 0.02, 0.002),
        Surface::cone(0.04, 0.1, 0.0),
        Surface::cone(0.04, 0.03, 0.004),
        Surface::cuboid([0.1, 0.08, 0.12], 0.01),
    ];
    for (k, surface) in shapes.into_iter().map(Result::unwrap).enumerate() {
        let Shape::Solid(solid) = &surface.shape else { panic!("a solid") };
        for point in points(1.3 * surface.bounding_radius(), 4000) {
            let found = solid.project_local(&point);
            let parry = solid.core().project_point(solid.place(), vector(&point), false);
            let expected = convex::signed(&point, parry.point, parry.is_inside);
            let distance = expected.distance - solid.edge();
            assert!((found.distance - distance).abs() < 1e-12, "{k}: {found:?} {expected:?} at {point}");
            assert!((found.normal.norm() - 1.0).abs() < 1e-12, "{k}: {found:?}");
            if expected.distance.abs() > 1e-6 {
                let step = 1e-9;
                let ahead = solid.project_local(&(point + found.normal * step)).distance;
                assert!((ahead - found.distance - step).abs() < 1e-3 * step, "{k}: {found:?} at {point}");
            }
        }
    }
}

/// No sample of a triangle is nearer to a convex body than its nearest point, and none than its lower bound; from any
/// place that the search starts at.
#[test]
fn the_nearest_point_of_a_triangle_is_nearer_than_its_samples() {
    let shapes = [
        Surface::cylinder(0.03, 0.2, 5e-5),
        Surface::cylinder(0.03, 0.02, 0.002),
        Surface::cone(0.04, 0.1, 5e-5),
        Surface::cone(0.04, 0.03, 0.004),
        Surface::cuboid([0.1, 0.08, 0.12], 5e-5),
        Surface::cuboid([0.1, 0.08, 0.12], 0.01),
    ];
    let (size, tolerance, count) = (0.01, 1e-7, 40);
    let mut met = [0; 3];
    for (k, surface) in shapes.into_iter().map(Result::unwrap).enumerate() {
        let Shape::Solid(solid) = &surface.shape else { panic!("a solid") };
        let turns: Vec<_> = points(1.0, 4000).collect();
        for (n, near) in points(1.1 * surface.bounding_radius(), 2000).enumerate() {
            // About a point a little above the surface, below it, or on it.
            let projection = solid.project_local(&near);
            let height = size * 0.02 * f64::from(n as u32 % 5) - size * 0.04;
            let middle = near - projection.normal * (projection.distance - height);
            let across = [turns[n], turns[3999 - n]].map(|turn| {
                let out = projection.normal * turn.dot(&projection.normal);
                (turn - out * (0.9 + 0.1 * turn.x)) * size
            });
            let corners = [middle + across[0], middle + across[1], middle - across[0] - across[1]];
            let at = |[u, v]: [f64; 2]| corners[0] * u + corners[1] * v + corners[2] * (1.0 - u - v);
            let places =
                (0..=count).flat_map(|i| (0..=count - i).map(move |j| [i, j].map(|x| f64::from(x) / f64::from(count))));
            let least = places.map(|place| solid.project_local(&at(place)).distance).fold(f64::INFINITY, f64::min);
            let [u, v] = [turns[n].x.abs() * 0.5, turns[n].y.abs() * 0.5];
            // Inside, and on each edge.
            let start = [[u, v], [u, 1.0 - u], [u, 0.0], [0.0, v]][n % 4];
            for within in [f64::INFINITY, 0.0] {
                match minimum(solid, &corners, start, within, tolerance) {
                    Minimum::At { projection, place } => {
                        met[0] += 1;
                        assert!(projection.distance <= least + tolerance, "{k}, {n}: {projection:?}, {least}");
                        let again = solid.project_local(&at(place));
                        assert!((again.distance - projection.distance).abs() < 1e-15, "{k}, {n}");
                    }
                    Minimum::Beyond { bound, normal, .. } => {
                        met[1] += 1;
                        let over = over_plane(solid, &corners, &normal, within).unwrap().0;
                        assert!(over <= least + 1e-15, "{k}, {n}: {over}, {least}");
                        assert!(bound >= within && bound <= least + 1e-15, "{k}, {n}: {bound}, {least}");
                    }
                    Minimum::Cut => met[2] += 1,
                }
            }
        }
    }
    assert!(met[0] > 10_000 && met[1] > 1000 && met[2] > 100, "{met:?}");
}

/// Rounding leaves the flat faces where they are, and everything inside the sharp body.
#[test]
fn rounded_bodies_lie_inside_with_their_faces() {
    for sharp in [Surface::cylinder(0.03, 0.1, 0.0), Surface::cone(0.04, 0.05, 0.0), Surface::cuboid([0.1; 3], 0.0)] {
        let sharp = sharp.unwrap();
        let rounded = sharp.with_edges(0.003);
        let mut on_faces = 0;
        for point in points(1.2 * sharp.bounding_radius(), 3000) {
            let [outer, inner] = [&sharp, &rounded].map(|s| s.project(&Isometry3::identity(), &point.into()).distance);
            assert!(inner > outer - 1e-15 && inner - outer < 0.003 * 2.0, "{inner} {outer}");
            on_faces += u32::from((inner - outer).abs() < 1e-15);
        }
        assert!(on_faces > 300, "{on_faces}");
    }
}

/// Two bodies in one mesh are not convex, nor is one with a dent.
#[test]
fn meshes_are_known_to_be_convex() {
    let (vertices, triangles) = Ball::new(0.1).to_trimesh(14, 9);
    let mesh = TriMesh::new(vertices, triangles).unwrap();
    let vertices: Vec<_> = mesh.vertices().iter().map(|v| Point3::new(v.x, v.y, v.z)).collect();
    let is_convex = |vertices: &[Point3<f64>], triangles: &[[u32; 3]]| {
        Surface::closed_mesh((vertices.to_vec(), triangles.to_vec())).unwrap().is_convex()
    };
    assert!(is_convex(&vertices, mesh.indices()));
    let mut dented = vertices.clone();
    dented[20].coords *= 0.9;
    assert!(!is_convex(&dented, mesh.indices()));
    let beside = vertices.iter().map(|v| v + Vector3::new(0.3, 0.0, 0.0));
    let further = mesh.indices().iter().map(|t| t.map(|n| n + vertices.len() as u32));
    let twice: Vec<_> = mesh.indices().iter().copied().chain(further).collect();
    assert!(!is_convex(&vertices.iter().copied().chain(beside).collect::<Vec<_>>(), &twice));
}

/// Knowledge of the nearest triangle never changes a projection, on a path that jumps now and then.
#[test]
fn a_projection_that_follows_its_triangle_is_that_of_the_whole_mesh() {
    let (vertices, triangles) = Ball::new(0.1).to_trimesh(14, 9);
    let mesh = TriMesh::new(vertices, triangles).unwrap();
    let convex: Vec<_> = mesh.vertices().iter().map(|v| Point3::new(v.x, v.y, v.z * 0.7)).collect();
    let mut dented = convex.clone();
    dented[20].coords *= 0.9;
    let of = |vertices| Surface::closed_mesh((vertices, mesh.indices().to_vec())).unwrap();
    // Without a search: a convex body by the faces that a point outside lies over, any other by distances.
    let spared = [convex, dented].map(|vertices| spared_on_a_path_beside(&of(vertices)));
    assert!(spared[0][0] > 1000 && spared[0].iter().sum::<u32>() > 5500 && spared[1][1] > 4000, "{spared:?}");
}

/// Steps of 6000 in which the nearest triangle was found by the face under the point, and by distances.
fn spared_on_a_path_beside(surface: &Surface) -> [u32; 2] {
    let pose = Isometry3::new(Vector3::new(0.1, -0.2, 0.5), Vector3::new(0.3, 0.2, -0.1));
    let mut nearest = Nearest::default();
    let [mut kept, mut under] = [0; 2];
    for k in 0..6000_u32 {
        let turn = f64::from(k) * 2e-4 + if k % 500 == 0 { 1.0 } else { 0.0 };
        let (sin, cos) = turn.sin_cos();
        let arm = pose.rotation
            * (Vector3::new(0.097 * cos, 0.097 * sin * 0.8, 0.03 * sin) * (1.0 + 0.02 * (3.1 * turn).sin()));
        let before = nearest;
        let found = surface.project_on_mesh(&pose, &arm, None, &mut nearest);
        let whole = surface.shape.project(&pose, &arm);
        kept += u32::from(before.is_kept(&nearest));
        under += u32::from(nearest.is_under() && !before.is_kept(&nearest));
        assert_eq!((found.distance, found.normal), (whole.distance, whole.normal), "step {k}");
        let bound = surface.project_on_mesh(&pose, &arm, Some(1e-4), &mut nearest.clone());
        assert!(
            bound.distance <= whole.distance + 1e-15 && (whole.distance < 1e-4 || bound.distance > 1e-4),
            "step {k}"
        );
    }
    [under, kept]
}

/// No sample of an element is deeper than what its corners tell, also where one tells no more than a bound, and what is
/// known of the depth changes no deepest point.
#[test]
fn an_element_is_no_deeper_than_its_bound() {
    let (vertices, triangles) = Ball::new(0.1).to_trimesh(30, 20);
    let mesh = TriMesh::new(vertices, triangles).unwrap();
    let vertices = |scale: f64| mesh.vertices().iter().map(|v| Point3::new(v.x, v.y, v.z * scale)).collect::<Vec<_>>();
    let dented = |mut vertices: Vec<Point3<f64>>| {
        vertices.iter_mut().filter(|v| v.x > 0.08).for_each(|v| v.coords *= 0.9);
        vertices
    };
    let of = |vertices| Surface::closed_mesh((vertices, mesh.indices().to_vec())).unwrap();
    let pose = Isometry3::new(Vector3::new(0.1, -0.2, 0.5), Vector3::new(0.3, 0.2, -0.1));
    let (size, count) = (0.01, 12);
    let mut met = [0; 2];
    let bodies = [of(vertices(0.7)), of(dented(vertices(1.0))), Surface::cylinder(0.05, 0.1, 1e-4).unwrap()];
    for (b, body) in bodies.into_iter().enumerate() {
        let turns: Vec<_> = points(1.0, 400).collect();
        for (n, near) in points(1.1 * body.bounding_radius(), 400).enumerate() {
            let projection = body.shape.project(&Isometry3::identity(), &near);
            let height = size * (0.01 * f64::from(n as u32 % 7) - 0.02);
            let middle = near - projection.normal * (projection.distance - height);
            let across = [turns[n], turns[399 - n]]
                .map(|turn| (turn - projection.normal * turn.dot(&projection.normal) * (0.9 + 0.1 * turn.x)) * size);
            let corners = [across[0], across[1], -across[0], -across[1]].map(|arm| pose * Point3::from(middle + arm));
            let arms = corners.map(|corner| corner.coords - pose.translation.vector);
            let mut nearest = [Nearest::default(); 4];
            let mut at = [Projection { distance: 0.0, normal: Vector3::zeros() }; 4];
            for k in 0..4 {
                at[k] = body.project_on_mesh(&pose, &arms[k], None, &mut nearest[k]);
                // As of nodes that are not near: by a face, or by a bound of the distance alone.
                if n % 5 == k {
                    at[k] = Projection { distance: at[k].distance - 1e-4, normal: Vector3::zeros() };
                } else if let Some(of_face) = body.face_of_mesh(&pose, &arms[k], &nearest[k]).filter(|_| n % 3 == k) {
                    at[k] = of_face;
                }
            }
            let outward = at.iter().map(|at| at.normal).sum::<Vector3<f64>>().normalize();
            let outward = Some(&outward).filter(|_| body.is_convex());
            let [mut bound, _] = body.least_distance(&pose, &corners, &at, outward, Some(&nearest[0]), f64::INFINITY);
            if let Some(outward) = outward {
                bound = bound.max(body.least_over_triangles(&pose, &corners, &at, outward, Some(&nearest[0])));
            }
            let mean = corners.iter().map(|corner| corner.coords).sum::<Vector3<f64>>() * 0.25;
            for a in 0..4 {
                for (i, j) in (0..=count).flat_map(|i| (0..=count - i).map(move |j| (i, j))) {
                    let [u, v] = [i, j].map(|x| f64::from(x) / f64::from(count));
                    let point = mean + (corners[a].coords - mean) * u + (corners[(a + 1) % 4].coords - mean) * v;
                    let distance = body.project(&pose, &point.into()).distance;
                    assert!(distance >= bound - 1e-12, "{b}, {n}: {distance} below {bound}");
                }
            }
            for within in [2e-4, 0.0, -1e-4] {
                let [all, known] =
                    [f64::INFINITY, -bound].map(|depth| body.deepest_point(&pose, &corners, within, depth));
                met[usize::from(all.is_some())] += 1;
                // In a dent, depth along the film's own normal may be more than that from the nearest point.
                if b != 1 || all.is_none_or(|all| all.projection.distance >= bound) {
                    let distance = |found: Option<DeepestPoint>| found.map(|found| found.projection.distance);
                    assert_eq!(distance(all), distance(known), "{b}, {n}: {bound}");
                }
            }
        }
    }
    assert!(met[0] > 300 && met[1] > 300, "{met:?}");
}
