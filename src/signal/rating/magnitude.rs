//! The magnitude rating E_M of ISO/TS 18571, equations 66 and 67: what remains between the curves when their time is warped.
//!
//! Sakoe and Chiba, IEEE Transactions on Acoustics, Speech, and Signal Processing 26 (1978): squared differences, steps of (1, 0), (0, 1)
//! and (1, 1) of equal weight, a band about the diagonal. The rating only needs two sums along the path, so they are carried with
//! the costs from one antidiagonal of the band to the next, and no path is kept: memory grows with the length alone.

use super::relative;
use crate::lane::{Width, at_width};

/// What the warped curves differ by, over the reference; 1 for nothing, 0 for a half.
pub(super) fn rating(reference: &[f64], comparison: &[f64]) -> f64 {
    let band = reference.len().div_ceil(10) - 1;
    let [off, size] = warped(Width::best(), reference, comparison, band);
    ((0.5 - relative(off, size)) / 0.5).max(0.0)
}

at_width! {
    /// Sums of the absolute difference and of the absolute reference along the cheapest path.
    fn warped[](reference: &[f64], comparison: &[f64], band: usize) -> [f64; 2] = warped_lanewise
}

#[inline(always)]
fn warped_lanewise(reference: &[f64], comparison: &[f64], band: usize) -> [f64; 2] {
    let count = comparison.len();
    let reversed: Vec<f64> = reference.iter().rev().copied().collect();
    let mut fronts = [Front::new(count), Front::new(count), Front::new(count)];
    fronts[1].start(comparison[0] - reference[0], reference[0]);
    for diagonal in 1..2 * count - 1 {
        let first = diagonal.saturating_sub(count - 1).max(diagonal.saturating_sub(band).div_ceil(2));
        let end = count.min(diagonal + 1).min((diagonal + band) / 2 + 1);
        let [before_last, last, next] = &mut fronts;
        // In a band without width every other antidiagonal is empty.
        let end = end.max(first);
        // Of the pairs of an antidiagonal, one index rises as the other falls.
        let opposite = first + count - 1 - diagonal;
        let curves = [&comparison[first..end], &reversed[opposite..opposite + end - first]];
        next.advance(first, curves, last, before_last);
        fronts.rotate_left(1);
    }
    [fronts[1].off[count], fronts[1].size[count]]
}

/// The cheapest paths to the cells of an antidiagonal, by the index in the comparison plus one.
struct Front {
    cost: Vec<f64>,
    off: Vec<f64>,
    size: Vec<f64>,
}

impl Front {
    fn new(count: usize) -> Front {
        Front { cost: vec![f64::INFINITY; count + 2], off: vec![0.0; count + 2], size: vec![0.0; count + 2] }
    }

    fn start(&mut self, difference: f64, reference: f64) {
        (self.cost[1], self.off[1], self.size[1]) = (difference * difference, difference.abs(), reference.abs());
    }

    /// Paths that come from the cells around; of equally cheap ones, the first of (1, 0), (0, 1), (1, 1).
    #[inline(always)]
    fn advance(&mut self, first: usize, [comparison, reference]: [&[f64]; 2], last: &Front, before_last: &Front) {
        let count = comparison.len();
        let cells = first + 1..first + 1 + count;
        let below = first..first + count;
        let up = [&last.cost[below.clone()], &last.off[below.clone()], &last.size[below.clone()]];
        let left = [&last.cost[cells.clone()], &last.off[cells.clone()], &last.size[cells.clone()]];
        let both = [&before_last.cost[below.clone()], &before_last.off[below.clone()], &before_last.size[below]];
        // Beyond the ends lies what an earlier antidiagonal left.
        self.cost[first] = f64::INFINITY;
        self.cost[first + 1 + count] = f64::INFINITY;
        let (cost, off, size) = (&mut self.cost[cells.clone()], &mut self.off[cells.clone()], &mut self.size[cells]);
        for l in 0..count {
            let difference = comparison[l] - reference[l];
            let from_left = left[0][l] < up[0][l];
            let cheaper = [0, 1, 2].map(|k| if from_left { left[k][l] } else { up[k][l] });
            let from_both = both[0][l] < cheaper[0];
            let best = [0, 1, 2].map(|k| if from_both { both[k][l] } else { cheaper[k] });
            cost[l] = best[0] + difference * difference;
            off[l] = best[1] + difference.abs();
            size[l] = best[2] + reference[l].abs();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The whole matrix, and the way back through it.
    fn by_matrix(reference: &[f64], comparison: &[f64], band: usize) -> [f64; 2] {
        let n = reference.len();
        let mut cost = vec![vec![f64::INFINITY; n]; n];
        let at = |cost: &Vec<Vec<f64>>, i: isize, j: isize| {
            if i < 0 || j < 0 { f64::INFINITY } else { cost[i as usize][j as usize] }
        };
        let from = |cost: &Vec<Vec<f64>>, i: usize, j: usize| {
            let (i, j) = (i as isize, j as isize);
            let steps = [(i - 1, j), (i, j - 1), (i - 1, j - 1)];
            steps.into_iter().reduce(|a, b| if at(cost, b.0, b.1) < at(cost, a.0, a.1) { b } else { a }).unwrap()
        };
        for i in 0..n {
            for j in i.saturating_sub(band)..(i + band + 1).min(n) {
                let (before_i, before_j) = from(&cost, i, j);
                let before = if i == 0 && j == 0 { 0.0 } else { at(&cost, before_i, before_j) };
                cost[i][j] = before + (comparison[i] - reference[j]).powi(2);
            }
        }
        let (mut i, mut j, mut sums) = (n - 1, n - 1, [0.0, 0.0]);
        loop {
            sums = [sums[0] + (comparison[i] - reference[j]).abs(), sums[1] + reference[j].abs()];
            if i == 0 && j == 0 {
                return sums;
            }
            let (before_i, before_j) = from(&cost, i, j);
            (i, j) = (before_i as usize, before_j as usize);
        }
    }

    #[test]
    fn carried_sums_are_those_along_the_path() {
        for (n, band) in [(9, 0), (12, 1), (57, 5), (58, 5), (130, 12), (40, 39)] {
            let reference: Vec<f64> = (0..n).map(|i| (0.11 * i as f64).sin() + 0.1 * (i * i % 7) as f64).collect();
            let comparison: Vec<f64> =
                (0..n).map(|i| (0.12 * i as f64 - 0.2).sin() + 0.1 * (i * i % 5) as f64).collect();
            let expected = by_matrix(&reference, &comparison, band);
            for width in Width::available() {
                let found = warped(width, &reference, &comparison, band);
                assert!(
                    found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12 * b),
                    "{n}, {band}: {found:?} {expected:?}"
                );
            }
        }
    }

    #[test]
    fn equally_cheap_paths_are_told_apart_as_specified() {
        // Plateaus make ties everywhere.
        let reference: Vec<f64> = (0..60).map(|i| f64::from(i / 13)).collect();
        let comparison: Vec<f64> = (0..60).map(|i| f64::from((i + 4) / 11) - 0.5).collect();
        for band in [3, 5, 20] {
            assert_eq!(warped(Width::best(), &reference, &comparison, band), by_matrix(&reference, &comparison, band));
        }
    }
}
