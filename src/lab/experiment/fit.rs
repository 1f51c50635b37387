//! Linear least squares with a handful of unknowns.

use nalgebra::{SMatrix, SVector};

/// The coefficients c with the least Σ (Σ_j c_j x_j − y)² over all rows (x, y), and that sum of squares.
///
/// Columns should be of one order of magnitude. None where the rows do not determine the coefficients.
pub(super) fn least_squares<const N: usize>(
    rows: impl Iterator<Item = ([f64; N], f64)> + Clone,
) -> Option<([f64; N], f64)> {
    let mut moments = Moments::default();
    for (x, y) in rows.clone() {
        moments.add(x, y);
    }
    let (coefficients, _) = moments.solve()?;
    let gap = |(x, y): ([f64; N], f64)| y - (0..N).map(|j| coefficients[j] * x[j]).sum::<f64>();
    Some((coefficients, rows.map(|row| gap(row).powi(2)).sum()))
}

/// Sums over rows, for fits to every beginning or end of one signal.
#[derive(Clone, Debug)]
pub(super) struct Moments<const N: usize> {
    normal: SMatrix<f64, N, N>,
    right: SVector<f64, N>,
    square: f64,
}

impl<const N: usize> Default for Moments<N> {
    fn default() -> Moments<N> {
        Moments { normal: SMatrix::zeros(), right: SVector::zeros(), square: 0.0 }
    }
}

impl<const N: usize> Moments<N> {
    pub(super) fn add(&mut self, x: [f64; N], y: f64) {
        let x = SVector::from(x);
        self.normal += x * x.transpose();
        self.right += x * y;
        self.square += y * y;
    }

    /// As [`least_squares`]; the sum of squares is a difference, accurate to the rounding of Σy².
    pub(super) fn solve(&self) -> Option<([f64; N], f64)> {
        let solution = self.normal.cholesky()?.solve(&self.right);
        let left = (self.square - solution.dot(&self.right)).max(0.0);
        let coefficients: [f64; N] = solution.into();
        coefficients.iter().all(|c| c.is_finite()).then_some((coefficients, left))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_parabola_is_found_again() {
        let rows = (0..20).map(|i| f64::from(i) / 10.0).map(|t| ([1.0, t, t * t], 3.0 - 2.0 * t + 0.5 * t * t));
        let (found, left) = least_squares(rows).unwrap();
        for (found, expected) in found.into_iter().zip([3.0, -2.0, 0.5]) {
            assert!((found - expected).abs() < 1e-10, "{found} for {expected}");
        }
        assert!(left < 1e-18);
    }

    #[test]
    fn the_residual_is_the_scatter() {
        let rows = [1.0, -1.0, 1.0, -1.0].map(|y| ([1.0], y));
        assert_eq!(least_squares(rows.into_iter()), Some(([0.0], 4.0)));
    }

    #[test]
    fn moments_give_the_fit_of_the_rows() {
        let rows = (0..50).map(|i| f64::from(i) / 10.0).map(|t| ([1.0, t, t * t], (3.0 * t).sin()));
        let mut moments = Moments::default();
        rows.clone().for_each(|(x, y)| moments.add(x, y));
        let ([by_rows, ..], left) = least_squares(rows).unwrap();
        let ([by_sums, ..], difference) = moments.solve().unwrap();
        assert!((by_rows - by_sums).abs() < 1e-12 && (left - difference).abs() < 1e-12, "{left} {difference}");
    }

    #[test]
    fn too_few_rows_determine_nothing() {
        assert_eq!(least_squares([([1.0, 2.0], 3.0)].into_iter()), None);
    }
}
