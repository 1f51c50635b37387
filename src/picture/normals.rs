//! Normals of a surface at the corners of its patches, which make its shape look smooth.

use nalgebra::Vector3;

/// Unit normal of a patch, by its diagonals; zero where it has no area. A triangle has its last corner twice.
pub(super) fn normal(points: &[Vector3<f64>], [p, q, r, s]: [u32; 4]) -> Vector3<f64> {
    let point = |node: u32| points[node as usize];
    let other = if s == r { point(q) - point(p) } else { point(s) - point(q) };
    let (along, across) = if s == r { (other, point(r) - point(p)) } else { (point(r) - point(p), other) };
    along.cross(&across).try_normalize(0.0).unwrap_or_default()
}

/// Normals at the corners of each patch: the mean of those around that differ by less than the angle whose cosine is
/// `crease` from that of the patch. Patches that are not `drawn` have none.
pub(super) fn at_corners(
    points: &[Vector3<f64>],
    patches: &[[u32; 4]],
    drawn: &[bool],
    crease: f64,
) -> Vec<[Vector3<f64>; 4]> {
    let own: Vec<Vector3<f64>> = patches.iter().map(|patch| normal(points, *patch)).collect();
    let mut around: Vec<Vec<u32>> = vec![vec![]; points.len()];
    for (at, patch) in patches.iter().enumerate().filter(|(at, _)| drawn[*at]) {
        patch.iter().for_each(|node| around[*node as usize].push(at as u32));
    }
    let mean = |at: usize, node: u32| {
        let others = around[node as usize].iter().map(|other| own[*other as usize]);
        let sum: Vector3<f64> = others.filter(|other| other.dot(&own[at]) > crease).sum();
        sum.try_normalize(0.0).unwrap_or(own[at])
    };
    (0..patches.len()).map(|at| patches[at].map(|node| mean(at, node))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fold_is_smooth_below_the_crease_angle() {
        // Two squares that meet at 45°.
        let rise = std::f64::consts::FRAC_PI_4.sin();
        let point = |x: f64, z: f64, y: f64| Vector3::new(x, y, z);
        let points: Vec<Vector3<f64>> = [0.0, 1.0]
            .iter()
            .flat_map(|y| [point(0.0, 0.0, *y), point(1.0, 0.0, *y), point(1.0 + rise, rise, *y)])
            .collect();
        let patches = [[0, 1, 4, 3], [1, 2, 5, 4]];
        let [smooth, sharp] = [0.5, 0.9].map(|crease| at_corners(&points, &patches, &[true; 2], crease));
        assert!((smooth[0][1] - smooth[1][0]).norm() < 1e-12, "one normal along the fold");
        assert!((sharp[0][1] - Vector3::z()).norm() < 1e-12, "that of the patch");
        assert!((smooth[0][0] - Vector3::z()).norm() < 1e-12, "away from the fold");
        let alone = at_corners(&points, &patches, &[true, false], 0.5);
        assert!((alone[0][1] - Vector3::z()).norm() < 1e-12, "deleted elements do not count");
        assert!((normal(&points, [0, 1, 4, 4]) - Vector3::z()).norm() < 1e-12);
    }
}
