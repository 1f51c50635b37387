//! Round bodies from few triangles: Phong tessellation (Boubekeur and Alexa, ACM Transactions on Graphics 27(5), 2008,
//! equation 1).

use nalgebra::Vector3;

/// Parts of a side.
const PARTS: usize = 4;

/// Share by which points are drawn to the tangent planes of the corners: with a half, a sphere is met up to the fourth order
/// of the size of its triangles.
const SHARE: f64 = 0.5;

/// A point of a surface and its unit normal.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Corner {
    pub(crate) point: Vector3<f64>,
    pub(crate) normal: Vector3<f64>,
}

/// The triangles of a patch with these corners and normals, as round as the normals say; one `is_triangle` has its last
/// corner twice.
pub(crate) fn rounded(
    points: [Vector3<f64>; 4],
    normals: [Vector3<f64>; 4],
    is_triangle: bool,
) -> impl Iterator<Item = [Corner; 3]> {
    let corner = move |at: usize| Corner { point: points[at], normal: normals[at] };
    let halves = [[0, 1, 2], [0, 2, 3]].map(|half| half.map(corner));
    halves.into_iter().take(if is_triangle { 1 } else { 2 }).flat_map(parts)
}

fn parts(triangle: [Corner; 3]) -> impl Iterator<Item = [Corner; 3]> {
    let at = move |i: usize, j: usize| between(&triangle, [i, j].map(|step| step as f64 / PARTS as f64));
    let upright = (0..PARTS).flat_map(|i| (0..PARTS - i).map(move |j| [[i, j], [i + 1, j], [i, j + 1]]));
    let inverted = (0..PARTS).flat_map(|i| (1..PARTS - i).map(move |j| [[i, j], [i + 1, j - 1], [i + 1, j]]));
    upright.chain(inverted).map(move |corners| corners.map(|[i, j]| at(i, j)))
}

/// The point with the shares `u` of the second and `v` of the third corner.
fn between(triangle: &[Corner; 3], [u, v]: [f64; 2]) -> Corner {
    let shares = [1.0 - u - v, u, v];
    let sum = |of: &dyn Fn(&Corner) -> Vector3<f64>| -> Vector3<f64> {
        triangle.iter().zip(shares).map(|(corner, share)| share * of(corner)).sum()
    };
    let flat = sum(&|corner| corner.point);
    let tangent = sum(&|corner| flat - (flat - corner.point).dot(&corner.normal) * corner.normal);
    // Opposite normals, as at the two sides of a fold, cancel and have no direction: then that of a corner serves.
    let normal = sum(&|corner| corner.normal);
    Corner {
        point: (1.0 - SHARE) * flat + SHARE * tangent,
        normal: normal.try_normalize(0.0).unwrap_or(triangle[0].normal),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn area([p, q, r]: &[Corner; 3]) -> Vector3<f64> {
        0.5 * (q.point - p.point).cross(&(r.point - p.point))
    }

    #[test]
    fn triangles_of_a_sphere_are_round_to_the_fourth_order() {
        let off = |size: f64| {
            let corners = [[0.0, 0.0], [size, 0.0], [0.0, size]].map(|[x, y]| Vector3::new(x, y, 1.0).normalize());
            let points = [corners[0], corners[1], corners[2], corners[2]];
            let parts: Vec<[Corner; 3]> = rounded(points, points, true).collect();
            assert_eq!(parts.len(), PARTS * PARTS);
            assert!(parts.iter().all(|part| area(part).dot(&part[0].normal) > 0.0), "seen from outside");
            parts.iter().flatten().map(|corner| (corner.point.norm() - 1.0).abs()).fold(0.0, f64::max)
        };
        let order = (off(0.4) / off(0.2)).log2();
        assert!((3.7..4.3).contains(&order) && off(0.2) < 1e-3, "{order} {}", off(0.2));
    }

    #[test]
    fn a_flat_patch_stays_flat_and_whole() {
        let points = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]].map(|[x, y]| Vector3::new(x, y, 0.5));
        let parts: Vec<[Corner; 3]> = rounded(points, [Vector3::z(); 4], false).collect();
        let whole: Vector3<f64> = parts.iter().map(area).sum();
        assert!((whole - Vector3::new(0.0, 0.0, 2.0)).norm() < 1e-12);
        assert!(parts.iter().flatten().all(|corner| (corner.point.z - 0.5).abs() < 1e-12));
    }
}
