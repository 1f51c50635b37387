//! Closest points of a point and a triangle, and of two segments (Ericson, *Real-Time Collision Detection*, 2005, sections
//! 5.1.5 and 5.1.9).

use nalgebra::Vector3;

/// Part of a triangle on which the point nearest to another one lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Feature {
    Inside,
    /// The edge opposite to this corner.
    Edge(usize),
    Corner(usize),
}

/// The weights of the corners at the point of a triangle next to `p`, and where it lies.
#[inline]
pub(super) fn on_triangle(p: &Vector3<f64>, [a, b, c]: &[Vector3<f64>; 3]) -> ([f64; 3], Feature) {
    let (ab, ac, ap) = (b - a, c - a, p - a);
    let (d1, d2) = (ab.dot(&ap), ac.dot(&ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return ([1.0, 0.0, 0.0], Feature::Corner(0));
    }
    let bp = p - b;
    let (d3, d4) = (ab.dot(&bp), ac.dot(&bp));
    if d3 >= 0.0 && d4 <= d3 {
        return ([0.0, 1.0, 0.0], Feature::Corner(1));
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        let share = d1 / (d1 - d3);
        return ([1.0 - share, share, 0.0], Feature::Edge(2));
    }
    let cp = p - c;
    let (d5, d6) = (ab.dot(&cp), ac.dot(&cp));
    if d6 >= 0.0 && d5 <= d6 {
        return ([0.0, 0.0, 1.0], Feature::Corner(2));
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        let share = d2 / (d2 - d6);
        return ([1.0 - share, 0.0, share], Feature::Edge(1));
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0 {
        let share = (d4 - d3) / ((d4 - d3) + (d5 - d6));
        return ([0.0, 1.0 - share, share], Feature::Edge(0));
    }
    let sum = va + vb + vc;
    let (v, w) = (vb / sum, vc / sum);
    ([1.0 - v - w, v, w], Feature::Inside)
}

/// Point of a triangle with these weights of its corners.
#[inline]
pub(super) fn at(weights: [f64; 3], [a, b, c]: &[Vector3<f64>; 3]) -> Vector3<f64> {
    a * weights[0] + b * weights[1] + c * weights[2]
}

/// Distance of a point from a triangle.
#[inline]
pub(super) fn distance_to_triangle(p: &Vector3<f64>, corners: &[Vector3<f64>; 3]) -> f64 {
    (p - at(on_triangle(p, corners).0, corners)).norm()
}

/// Distance of two segments.
#[inline]
pub(super) fn distance_of_segments([a, b]: &[Vector3<f64>; 2], [c, d]: &[Vector3<f64>; 2]) -> f64 {
    let (e, f, r) = (b - a, d - c, a - c);
    let (ee, ff, ef, er, fr) = (e.norm_squared(), f.norm_squared(), e.dot(&f), e.dot(&r), f.dot(&r));
    let across = ee * ff - ef * ef;
    // Parallel segments: any point of the first will do, as the second is clamped to it and it again to the second.
    let s = if across > 1e-12 * ee * ff { ((ef * fr - er * ff) / across).clamp(0.0, 1.0) } else { 0.0 };
    let t = (ef * s + fr) / ff;
    let [s, t] = match t {
        t if t < 0.0 => [(-er / ee).clamp(0.0, 1.0), 0.0],
        t if t > 1.0 => [((ef - er) / ee).clamp(0.0, 1.0), 1.0],
        t => [s, t],
    };
    (r + e * s - f * t).norm()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers between minus one and one, by a linear congruential generator.
    struct Numbers(u64);

    impl Numbers {
        fn vector(&mut self) -> Vector3<f64> {
            Vector3::from_fn(|_, _| {
                self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                (self.0 >> 33) as f64 / f64::from(1_u32 << 30) - 1.0
            })
        }
    }

    /// Against parry, which finds both in other ways.
    #[test]
    fn distances_are_those_of_another_library() {
        use parry3d_f64::math::Vector;
        use parry3d_f64::query::PointQuery;
        let mut numbers = Numbers(7);
        let of = |v: &Vector3<f64>| Vector::new(v.x, v.y, v.z);
        let mut features = [0; 3];
        for _ in 0..2000 {
            let [p, a, b, c] = [(); 4].map(|()| numbers.vector());
            let triangle = parry3d_f64::shape::Triangle::new(of(&a), of(&b), of(&c));
            let expected = (triangle.project_local_point(of(&p), false).point - of(&p)).length();
            let found = distance_to_triangle(&p, &[a, b, c]);
            assert!((found - expected).abs() < 1e-12, "{found} {expected}");
            features[match on_triangle(&p, &[a, b, c]).1 {
                Feature::Inside => 0,
                Feature::Edge(_) => 1,
                Feature::Corner(_) => 2,
            }] += 1;
            // Two segments: no point of a fine division of both is nearer, and one is nearly as near.
            let distance = distance_of_segments(&[p, a], &[b, c]);
            let share = |k: i32| f64::from(k) / 50.0;
            let nearest = (0..=50)
                .map(|i| {
                    let q = p + (a - p) * share(i);
                    let along = ((q - b).dot(&(c - b)) / (c - b).norm_squared()).clamp(0.0, 1.0);
                    (q - b - (c - b) * along).norm()
                })
                .fold(f64::INFINITY, f64::min);
            assert!(distance <= nearest + 1e-12 && nearest < distance + 0.02 * (a - p).norm(), "{distance} {nearest}");
        }
        assert!(features.iter().all(|count| *count > 100), "{features:?}");
    }
}
