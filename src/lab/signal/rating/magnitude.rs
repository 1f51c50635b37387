//! The magnitude rating E_M of ISO/TS 18571, equation 64: what remains between the curves when their time is warped.
//!
//! Sakoe and Chiba, IEEE Transactions on Acoustics, Speech, and Signal Processing 26 (1978): squared differences, steps
//! of (1, 0), (0, 1) and (1, 1) of equal weight, a band about the diagonal. The rating only needs two sums along the
//! path, so they are computed with the costs from one antidiagonal of the band to the next, and no path is stored:
//! memory is linear in the length.

use std::ops::Range;

use base::cancellation::stop_if_cancelled;
use membrane::lane::{LANES, Lane, Width, at_width, splat};

/// Relative difference of the warped curves as a rating: 1 for none, 0 for a half.
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
    // The padding of the last lanes is computed and discarded.
    let padding = [0.0; LANES];
    let reversed: Vec<f64> = reference.iter().rev().chain(&padding).copied().collect();
    let comparison: Vec<f64> = comparison.iter().chain(&padding).copied().collect();
    // A diagonal step comes from the last antidiagonal but one.
    let mut fronts = [Front::new(count), Front::new(count), Front::new(count)];
    fronts[1].start(comparison[0] - reference[0], reference[0]);
    for diagonal in 1..2 * count - 1 {
        stop_if_cancelled();
        let first = diagonal.saturating_sub(count - 1).max(diagonal.saturating_sub(band).div_ceil(2));
        // In a band without width every other antidiagonal is empty.
        let end = count.min(diagonal + 1).min((diagonal + band) / 2 + 1).max(first);
        // Of the pairs of an antidiagonal, one index rises as the other falls.
        let opposite = first + count - 1 - diagonal;
        let [before_last, last, next] = &mut fronts;
        next.advance(first..end, [&comparison[first..], &reversed[opposite..]], last, before_last);
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

/// Cost and sums of the paths to neighbouring cells.
type Paths = [Lane; 3];

impl Front {
    fn new(count: usize) -> Front {
        let length = count + 2 + LANES;
        Front { cost: vec![f64::INFINITY; length], off: vec![0.0; length], size: vec![0.0; length] }
    }

    fn start(&mut self, difference: f64, reference: f64) {
        (self.cost[1], self.off[1], self.size[1]) = (difference * difference, difference.abs(), reference.abs());
    }

    /// Paths to the next antidiagonal, whose curves begin at its first cell.
    #[inline(always)]
    fn advance(&mut self, cells: Range<usize>, curves: [&[f64]; 2], last: &Front, before_last: &Front) {
        for block in (0..cells.len()).step_by(LANES) {
            let below = cells.start + block;
            let [comparison, reference] = curves.map(|curve| lane(curve, block));
            // Steps (1, 0), (0, 1), (1, 1): of paths of equal cost the first counts.
            let before = cheaper(cheaper(last.paths(below), last.paths(below + 1)), before_last.paths(below));
            self.store(below + 1, step(before, comparison, reference));
        }
        // Beyond the ends are values of an earlier antidiagonal or of padded lanes.
        self.cost[cells.start] = f64::INFINITY;
        self.cost[cells.end + 1] = f64::INFINITY;
    }

    #[inline(always)]
    fn paths(&self, from: usize) -> Paths {
        [lane(&self.cost, from), lane(&self.off, from), lane(&self.size, from)]
    }

    #[inline(always)]
    fn store(&mut self, from: usize, [cost, off, size]: Paths) {
        self.cost[from..from + LANES].copy_from_slice(&cost);
        self.off[from..from + LANES].copy_from_slice(&off);
        self.size[from..from + LANES].copy_from_slice(&size);
    }
}

#[inline(always)]
fn lane(values: &[f64], from: usize) -> Lane {
    let mut lane = splat(0.0);
    lane.copy_from_slice(&values[from..from + LANES]);
    lane
}

/// The cheaper of two paths in each lane, the first of equally cheap ones.
#[inline(always)]
fn cheaper(first: Paths, second: Paths) -> Paths {
    let mut paths = first;
    for l in 0..LANES {
        let better = second[0][l] < first[0][l];
        for k in 0..3 {
            paths[k][l] = if better { second[k][l] } else { first[k][l] };
        }
    }
    paths
}

/// The paths, extended by one pair of samples.
#[inline(always)]
fn step(mut paths: Paths, comparison: Lane, reference: Lane) -> Paths {
    for l in 0..LANES {
        let difference = comparison[l] - reference[l];
        paths[0][l] += difference * difference;
        paths[1][l] += difference.abs();
        paths[2][l] += reference[l].abs();
    }
    paths
}

/// |off|₁/|size|₁; infinite where only `size` is zero.
pub(super) fn relative(off: f64, size: f64) -> f64 {
    if off == 0.0 { 0.0 } else { off / size }
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
    fn running_sums_are_those_along_the_path() {
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
    fn ties_of_paths_are_broken_as_specified() {
        // Plateaus make ties everywhere.
        let reference: Vec<f64> = (0..60).map(|i| f64::from(i / 13)).collect();
        let comparison: Vec<f64> = (0..60).map(|i| f64::from((i + 4) / 11) - 0.5).collect();
        for band in [3, 5, 20] {
            assert_eq!(warped(Width::best(), &reference, &comparison, band), by_matrix(&reference, &comparison, band));
        }
    }
}
