//! Second derivatives at a node of a mesh from the nodes around it, as weights (Liszka and Orkisz, The finite difference
//! method at arbitrary irregular grids, Computers and Structures 11, 1980).

use nalgebra::{DMatrix, SMatrix, SVector};

/// Least eigenvalue of the equations, of columns of length one, below which they do not decide what is asked for.
const LEAST: f64 = 1e-3;

/// Which second derivatives of a function of two coordinates are fitted beside its gradient.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Terms {
    /// ∂²/∂X², ∂²/∂Y², 2 ∂²/∂X∂Y.
    All,
    /// ∂²/∂X², 2 ∂²/∂X∂Y.
    AlongAndTwist,
    /// ∂²/∂X².
    Along,
}

impl Terms {
    /// Number of unknowns: both slopes and the second derivatives.
    fn count(self) -> usize {
        match self {
            Terms::All => 5,
            Terms::AlongAndTwist => 4,
            Terms::Along => 3,
        }
    }

    /// The function of each unknown at a point, the others padded with zero.
    fn functions(self, [x, y]: [f64; 2]) -> [f64; 5] {
        // XY/2 for the derivative 2 ∂²/∂X∂Y.
        match self {
            Terms::All => [x, y, 0.5 * x * x, 0.5 * y * y, 0.5 * x * y],
            Terms::AlongAndTwist => [x, y, 0.5 * x * x, 0.5 * x * y, 0.0],
            Terms::Along => [x, y, 0.5 * x * x, 0.0, 0.0],
        }
    }
}

/// Weights of the values at `points` (m, from the node), less that at the node, in the second derivatives of the quadratic
/// function through the node that is nearest to them, an error at the distance d counting as d⁻³; as many as `terms` has,
/// the others zero. None where the points do not decide them.
pub(super) fn weights(points: &[[f64; 2]], terms: Terms) -> Option<Vec<[f64; 3]>> {
    let count = terms.count();
    if points.len() < count {
        return None;
    }
    // No `hypot`: that of the platform's library has bits of its own.
    let square = |[x, y]: &[f64; 2]| x * x + y * y;
    let nearest = points.iter().map(square).fold(f64::INFINITY, f64::min).sqrt();
    let weighted = |[x, y]: [f64; 2]| {
        let ratio = nearest * nearest / square(&[x, y]);
        let weight = ratio * ratio * ratio;
        (SVector::<f64, 5>::from(terms.functions([x / nearest, y / nearest])), weight)
    };
    let mut normal = SMatrix::<f64, 5, 5>::zeros();
    for (functions, weight) in points.iter().map(|point| weighted(*point)) {
        normal += functions * functions.transpose() * weight;
    }
    // Columns of length one: elements of any aspect ratio are as well conditioned as their shape along each axis is.
    let length = |k: usize| if normal[(k, k)] > 0.0 { normal[(k, k)].sqrt() } else { 1.0 };
    let lengths: [f64; 5] = std::array::from_fn(length);
    let scaled = DMatrix::from_fn(count, count, |i, j| normal[(i, j)] / (lengths[i] * lengths[j]));
    if scaled.symmetric_eigenvalues().min() < LEAST {
        return None;
    }
    let inverse = scaled.cholesky()?.inverse();
    let of_point = |point: &[f64; 2]| {
        let (functions, weight) = weighted(*point);
        let mut out = [0.0; 3];
        for (k, out) in out.iter_mut().enumerate().take(count - 2) {
            let row = 2 + k;
            let sum: f64 = (0..count).map(|j| inverse[(row, j)] * functions[j] / lengths[j]).sum();
            *out = weight * sum / (lengths[row] * nearest * nearest);
        }
        out
    };
    Some(points.iter().map(of_point).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every quadratic function has its own second derivatives, whatever the points are.
    #[test]
    fn quadratic_functions_are_exact() {
        let value = |[x, y]: [f64; 2]| 3.0 * x - 2.0 * y + 0.5 * 7.0 * x * x + 0.5 * 11.0 * y * y - 5.0 * x * y;
        let pentagon: Vec<[f64; 2]> = (0..5)
            .map(|k| (0.4 + 1.2566 * f64::from(k)).sin_cos())
            .map(|(s, c)| [0.02 * c, 0.07 * s + 0.003])
            .collect();
        let grid: Vec<[f64; 2]> = (0..9)
            .filter(|k| *k != 4)
            .map(|k| [f64::from(k % 3) - 1.0, f64::from(k / 3) - 1.0])
            .map(|[x, y]| [1e-3 * x, 4e-3 * (y + 0.2 * x)])
            .collect();
        for points in [pentagon, grid] {
            let weights = weights(&points, Terms::All).expect("weights");
            for (k, expected) in [7.0, 11.0, -10.0].into_iter().enumerate() {
                let found: f64 = weights.iter().zip(&points).map(|(weight, point)| weight[k] * value(*point)).sum();
                assert!((found - expected).abs() < 1e-8, "{k}: {found} for {expected}");
            }
        }
    }

    #[test]
    fn what_points_do_not_decide_is_not_fitted() {
        // A cross says nothing of a twist, and a row of points beside an edge nothing of what is across it.
        let cross = [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]];
        let edge = [[1.0, 0.0], [-1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [-1.0, 1.0]];
        for (points, terms, is_decided) in [
            (&cross[..], Terms::All, false),
            (&cross, Terms::AlongAndTwist, false),
            (&cross, Terms::Along, true),
            (&edge, Terms::All, false),
            (&edge, Terms::AlongAndTwist, true),
            (&edge[..3], Terms::AlongAndTwist, false),
            (&edge[..3], Terms::Along, true),
        ] {
            assert_eq!(weights(points, terms).is_some(), is_decided, "{points:?} {terms:?}");
        }
    }

    /// A function of one coordinate along a line of a grid has the second difference.
    #[test]
    fn cylinders_along_a_grid_have_second_differences() {
        let grid: Vec<[f64; 2]> =
            (0..9).filter(|k| *k != 4).map(|k| [f64::from(k % 3) - 1.0, f64::from(k / 3) - 1.0]).collect();
        let weights = weights(&grid, Terms::All).expect("weights");
        let value = |x: f64| {
            if x < 0.0 {
                2.0
            } else if x > 0.0 {
                5.0
            } else {
                0.0
            }
        };
        let curvature = |k: usize| weights.iter().zip(&grid).map(|(weight, [x, _])| weight[k] * value(*x)).sum::<f64>();
        assert!((curvature(0) - 7.0).abs() < 1e-12 && curvature(1).abs() < 1e-12 && curvature(2).abs() < 1e-12);
    }
}
