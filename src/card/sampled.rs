//! Curves with few points: those of a card are straight between them.

/// A curve of straight pieces, and how far it is off.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Sampled {
    /// Abscissa and ordinate.
    pub(crate) points: Vec<[f64; 2]>,
    /// Largest difference from the curve over its largest ordinate.
    pub(crate) error: f64,
}

/// At most `most` ≥ 2 of the `points` of a curve, its ends among them: each in turn is where the pieces so far are
/// farthest off.
pub(crate) fn thinned(points: &[[f64; 2]], most: usize) -> Sampled {
    let largest = points.iter().map(|point| point[1].abs()).fold(f64::MIN_POSITIVE, f64::max);
    let mut kept = vec![0, points.len() - 1];
    loop {
        let (place, off) = farthest(points, &kept);
        if kept.len() >= most.max(2) || off == 0.0 {
            let points = kept.iter().map(|index| points[*index]).collect();
            return Sampled { points, error: off / largest };
        }
        kept.insert(kept.partition_point(|index| *index < place), place);
    }
}

/// The point that is farthest from the pieces between the kept ones, and how far.
fn farthest(points: &[[f64; 2]], kept: &[usize]) -> (usize, f64) {
    let mut farthest = (0, 0.0);
    for ends in kept.windows(2) {
        let ([x, y], [to_x, to_y]) = (points[ends[0]], points[ends[1]]);
        for (index, point) in points.iter().enumerate().take(ends[1]).skip(ends[0] + 1) {
            let off = (y + (to_y - y) * (point[0] - x) / (to_x - x) - point[1]).abs();
            if off > farthest.1 {
                farthest = (index, off);
            }
        }
    }
    farthest
}

/// A smooth curve `f` from zero to `end` by at most `most` points, chosen as [`thinned`] does among many.
pub(crate) fn of_function(f: impl Fn(f64) -> f64, end: f64, most: usize) -> Sampled {
    const FINE: usize = 4000;
    let fine: Vec<[f64; 2]> = (0..=FINE).map(|i| end * i as f64 / FINE as f64).map(|x| [x, f(x)]).collect();
    thinned(&fine, most)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn corners_are_kept_and_points_between_are_not() {
        let corner = [[0.0, 0.0], [0.5, 1.0], [1.0, 2.0], [1.5, 2.0], [2.0, 2.0]];
        let found = thinned(&corner, 100);
        assert_eq!(found, Sampled { points: vec![[0.0, 0.0], [1.0, 2.0], [2.0, 2.0]], error: 0.0 });
        assert_eq!(thinned(&corner, 2).points, [[0.0, 0.0], [2.0, 2.0]]);
        assert!((thinned(&corner, 2).error - 0.5).abs() < 1e-15);
    }

    /// Pieces of a parabola between n + 1 points are off by h²/8 of its second derivative at best.
    #[test]
    fn a_smooth_curve_is_off_by_the_square_of_the_distance() {
        let parabola = |x: f64| x * x;
        let [few, many] = [17, 65].map(|most| of_function(parabola, 1.0, most));
        assert_eq!((few.points.len(), many.points.len()), (17, 65));
        let least = |points: f64| 0.25 / (points - 1.0).powi(2);
        assert!(few.error >= 0.99 * least(17.0) && few.error < 4.5 * least(17.0), "{}", few.error);
        assert!(many.error >= 0.99 * least(65.0) && many.error < 4.5 * least(65.0), "{}", many.error);
    }
}
