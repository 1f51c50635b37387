//! Linear least squares of any number of unknowns, free or not negative.

use nalgebra::{DMatrix, DVector};

/// Singular values below this share of the largest are rounding errors.
const ROUNDING: f64 = 1e-13;

/// Share of |b| below which a slope along a column counts as zero.
const NO_SLOPE: f64 = 1e-13;

/// The x with the least |A x − b|, and of these the smallest in columns of unit length; none where a number is not
/// finite.
pub(super) fn least_squares(a: &DMatrix<f64>, b: &DVector<f64>) -> Option<DVector<f64>> {
    let (a, lengths) = scaled(a)?;
    solve(&a, b).map(|x| x.component_div(&lengths))
}

/// The x ≥ 0 with the least |A x − b|, by the active set of Lawson and Hanson (*Solving Least Squares Problems*, 1974,
/// chapter 23); none where a number is not finite.
pub(super) fn nonnegative_least_squares(a: &DMatrix<f64>, b: &DVector<f64>) -> Option<DVector<f64>> {
    let (a, lengths) = scaled(a)?;
    let count = a.ncols();
    let mut x = DVector::zeros(count);
    let mut passive: Vec<usize> = Vec::new();
    // Each round lowers |A x − b|, so that no set comes twice; the limit is that of rounding.
    for _ in 0..3 * count {
        // Minus the gradient: at the solution no unknown at zero could lower |A x − b| by growing (Kuhn and Tucker).
        let slope = a.tr_mul(&(b - &a * &x));
        let steepest = (0..count).filter(|j| !passive.contains(j)).max_by(|i, j| slope[*i].total_cmp(&slope[*j]));
        let Some(next) = steepest.filter(|j| slope[*j] > NO_SLOPE * b.norm()) else { break };
        passive.push(next);
        loop {
            let free = solve(&a.select_columns(&passive), b)?;
            if free.iter().all(|value| *value > 0.0) {
                x.fill(0.0);
                passive.iter().zip(free.iter()).for_each(|(j, value)| x[*j] = *value);
                break;
            }
            // As far towards the free solution as no unknown becomes negative.
            let pairs = passive.iter().zip(free.iter()).filter(|(_, value)| **value <= 0.0);
            let share = pairs.map(|(j, value)| x[*j] / (x[*j] - value)).fold(1.0, f64::min);
            passive.iter().zip(free.iter()).for_each(|(j, value)| x[*j] += share * (value - x[*j]));
            let least = passive.iter().map(|j| x[*j]).fold(f64::INFINITY, f64::min);
            // The one that reached zero first leaves even where rounding keeps it above, so that the inner loop ends.
            let left: Vec<usize> = passive.iter().copied().filter(|j| x[*j] > least.max(0.0)).collect();
            (0..count).filter(|j| !left.contains(j)).for_each(|j| x[j] = 0.0);
            passive = left;
            if passive.is_empty() {
                break;
            }
        }
    }
    Some(x.component_div(&lengths))
}

/// The matrix with columns of unit length, and their lengths; a column of zeros has the length one.
fn scaled(a: &DMatrix<f64>) -> Option<(DMatrix<f64>, DVector<f64>)> {
    let length = |norm: f64| if norm == 0.0 { 1.0 } else { norm };
    let lengths = DVector::from_iterator(a.ncols(), a.column_iter().map(|column| length(column.norm())));
    if !lengths.iter().all(|length| length.is_finite()) {
        return None;
    }
    let mut scaled = a.clone();
    scaled.column_iter_mut().zip(lengths.iter()).for_each(|(mut column, length)| column /= *length);
    Some((scaled, lengths))
}

fn solve(a: &DMatrix<f64>, b: &DVector<f64>) -> Option<DVector<f64>> {
    let decomposition = a.clone().svd(true, true);
    let largest = decomposition.singular_values.iter().copied().fold(0.0, f64::max);
    let x = decomposition.solve(b, ROUNDING * largest).ok()?;
    x.iter().all(|value| value.is_finite()).then_some(x)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample(seed: u64) -> impl FnMut() -> f64 {
        let mut random = thorough::random(seed);
        move || random() - 0.5
    }

    /// The best of all subsets of columns whose free solution is positive.
    fn brute_force(a: &DMatrix<f64>, b: &DVector<f64>) -> f64 {
        let subsets = (1..1_usize << a.ncols()).map(|bits| (0..a.ncols()).filter(move |j| bits >> j & 1 == 1));
        let left = subsets.filter_map(|subset| {
            let columns = a.select_columns(&subset.collect::<Vec<_>>());
            let x = solve(&columns, b)?;
            x.iter().all(|value| *value >= 0.0).then(|| (&columns * &x - b).norm())
        });
        left.fold(b.norm(), f64::min)
    }

    #[test]
    fn the_least_of_all_subsets_is_found() {
        let mut random = sample(5);
        for _ in 0..200 {
            let a = DMatrix::from_fn(9, 5, |_, _| random());
            let b = DVector::from_fn(9, |_, _| random());
            let x = nonnegative_least_squares(&a, &b).expect("a solution");
            assert!(x.iter().all(|value| *value >= 0.0), "{x}");
            let (found, expected) = ((&a * &x - &b).norm(), brute_force(&a, &b));
            assert!((found - expected).abs() < 1e-12, "{found} {expected}");
        }
    }

    #[test]
    fn a_solution_that_is_positive_is_the_free_one() {
        let mut random = sample(9);
        let a = DMatrix::from_fn(12, 4, |_, j| random() * 10.0_f64.powi(j as i32 * 3));
        let expected = DVector::from_vec(vec![1.0, 2e-3, 3e-6, 0.0]);
        let b = &a * &expected;
        for found in [least_squares(&a, &b), nonnegative_least_squares(&a, &b)] {
            let found = found.expect("a solution");
            assert!((0..4).all(|j| (found[j] - expected[j]).abs() < 1e-11 * 10.0_f64.powi(-3 * j as i32)), "{found}");
        }
    }

    #[test]
    fn equal_columns_share_and_numbers_that_are_not_finite_have_no_solution() {
        let a = DMatrix::from_row_slice(2, 2, &[1.0, 1.0, 2.0, 2.0]);
        let b = DVector::from_vec(vec![1.0, 2.0]);
        let free = least_squares(&a, &b).expect("a solution");
        assert!((free[0] - 0.5).abs() < 1e-12 && (free[1] - 0.5).abs() < 1e-12);
        let x = nonnegative_least_squares(&a, &b).expect("a solution");
        assert!((x.sum() - 1.0).abs() < 1e-12);
        assert_eq!(least_squares(&DMatrix::from_element(2, 1, f64::NAN), &b), None);
    }
}
