//! Indices from a design of their own.

use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::design::{self, DesignError, Levels, Method};
use crate::statistics::{Bootstrap, Estimate, present};

/// Why there are no indices.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum IndicesError {
    /// The outputs are not those of whole blocks.
    #[error("{outputs} outputs are not whole blocks of {rows} rows")]
    Outputs {
        /// Number of outputs.
        outputs: usize,
        /// Rows of a block.
        rows: usize,
    },
    /// Too many outputs of the rows of a factor are missing.
    #[error("factor {factor} has {blocks} complete blocks, but needs at least 2")]
    TooFewBlocks {
        /// Index of the factor, from 0.
        factor: usize,
        /// Blocks that have all outputs of the factor.
        blocks: usize,
    },
    /// The output does not vary.
    #[error("the output is the same everywhere: it has no variance to share")]
    Constant,
}

/// Rows of the unit cube for `blocks` blocks of d + 2 rows: a point A, a point B, and for every factor A with that
/// factor of B (radial design; Saltelli et al. 2010).
///
/// A and B are the halves of a scrambled Sobol' sequence of 2 d dimensions. More blocks keep the first ones; powers of
/// two balance best.
///
/// # Errors
/// See [`DesignError`].
pub fn rows(factors: usize, blocks: usize, seed: u64) -> Result<Vec<Vec<f64>>, DesignError> {
    let points = design::points(Method::Sobol, &vec![Levels::Continuous; 2 * factors], blocks, seed)?;
    Ok(points.iter().flat_map(|point| block(point)).collect())
}

fn block(point: &[f64]) -> Vec<Vec<f64>> {
    let (a, b) = point.split_at(point.len() / 2);
    let mixed = (0..a.len()).map(|factor| {
        let mut mixed = a.to_vec();
        mixed[factor] = b[factor];
        mixed
    });
    [a.to_vec(), b.to_vec()].into_iter().chain(mixed).collect()
}

/// Indices of one factor.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FactorIndices {
    /// First-order index: share of the variance that the factor alone is due for, which would be gone were it known.
    pub first: Estimate,
    /// Total index: share that the factor alone and with others is due for, which would be left were all others known.
    pub total: Estimate,
    /// Number of blocks that have all outputs of the factor.
    pub blocks: usize,
    /// Number of blocks that were left out because an output is missing or no finite number.
    pub missing: usize,
}

/// Outputs of the blocks that are complete for one factor.
struct Blocks {
    a: Vec<f64>,
    b: Vec<f64>,
    mixed: Vec<f64>,
}

/// First-order and total indices of `factors` independent inputs from the outputs of [`rows`], with percentile
/// intervals of the bootstrap over blocks.
///
/// First order by Saltelli et al. (2010, table 2, estimator b), total by Jansen (1999). A block with a missing output
/// is left out for the factors that need it. That biases the indices where it is the inputs that make a run fail.
///
/// # Errors
/// The outputs are not whole blocks, too many are missing, or they do not vary.
pub fn indices(
    factors: usize,
    outputs: &[Option<f64>],
    bootstrap: &Bootstrap,
) -> Result<Vec<FactorIndices>, IndicesError> {
    let rows = factors + 2;
    if outputs.is_empty() || !outputs.len().is_multiple_of(rows) {
        return Err(IndicesError::Outputs { outputs: outputs.len(), rows });
    }
    (0..factors).map(|factor| of_factor(factor, outputs, rows, bootstrap)).collect()
}

fn of_factor(
    factor: usize,
    outputs: &[Option<f64>],
    rows: usize,
    bootstrap: &Bootstrap,
) -> Result<FactorIndices, IndicesError> {
    let complete = outputs
        .chunks(rows)
        .filter_map(|block| Some([present(block[0])?, present(block[1])?, present(block[2 + factor])?]));
    let mut blocks = Blocks { a: Vec::new(), b: Vec::new(), mixed: Vec::new() };
    for [a, b, mixed] in complete {
        blocks.a.push(a);
        blocks.b.push(b);
        blocks.mixed.push(mixed);
    }
    let count = blocks.a.len();
    if count < 2 {
        return Err(IndicesError::TooFewBlocks { factor, blocks: count });
    }
    // The estimate is that of the identical resample, by the code that the bootstrap uses.
    let whole: Vec<usize> = (0..count).collect();
    let [Some(first), Some(total)] = blocks.estimate(&whole) else { return Err(IndicesError::Constant) };
    let [first_interval, total_interval] = bootstrap.percentiles(count, |indices| blocks.estimate(indices));
    Ok(FactorIndices {
        first: Estimate { value: first, interval: first_interval },
        total: Estimate { value: total, interval: total_interval },
        blocks: count,
        missing: outputs.len() / rows - count,
    })
}

impl Blocks {
    /// First-order and total index from the blocks `indices`; none where the output does not vary.
    fn estimate(&self, indices: &[usize]) -> [Option<f64>; 2] {
        let n = indices.len() as f64;
        let sum = |of: &dyn Fn(usize) -> f64| indices.iter().map(|&index| of(index)).sum::<f64>();
        // Outputs are taken from their mean, which lowers the variance of the first-order estimator.
        let mean = sum(&|i| self.a[i] + self.b[i]) / (2.0 * n);
        let square = |x: f64| x * x;
        // From A and B, which are independent; the mixed points repeat coordinates of both.
        let variance = sum(&|i| square(self.a[i] - mean) + square(self.b[i] - mean)) / (2.0 * n - 1.0);
        if variance <= 0.0 {
            return [None, None];
        }
        // B and A_i share coordinate i alone, so their covariance is the first-order part; less that with A, which is
        // zero on average and takes away noise (theory.md, equation 313).
        let first = sum(&|i| (self.b[i] - mean) * (self.mixed[i] - self.a[i])) / n;
        let total = sum(&|i| square(self.a[i] - self.mixed[i])) / (2.0 * n);
        [Some(first / variance), Some(total / variance)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::indices::functions::{g, g_indices, ishigami, ishigami_indices};
    use crate::random::Stream;

    fn evaluated(factors: usize, blocks: usize, seed: u64, f: impl Fn(&[f64]) -> f64) -> Vec<Option<f64>> {
        rows(factors, blocks, seed).unwrap().iter().map(|u| Some(f(u))).collect()
    }

    /// Prints the indices beside the exact ones and gives the largest error.
    fn worst(found: &[FactorIndices], first: &[f64], total: &[f64]) -> f64 {
        let mut worst: f64 = 0.0;
        for (factor, found) in found.iter().enumerate() {
            let interval = found.first.interval.unwrap();
            println!(
                "x{} S {:.4} ({:.4}; 95 % {:.3} … {:.3})  ST {:.4} ({:.4})",
                factor + 1,
                found.first.value,
                first[factor],
                interval.low,
                interval.high,
                found.total.value,
                total[factor]
            );
            worst = worst.max((found.first.value - first[factor]).abs()).max((found.total.value - total[factor]).abs());
        }
        worst
    }

    #[test]
    fn ishigamis_function_has_its_indices() {
        let (first, total, _) = ishigami_indices();
        for (exact, published) in first.iter().chain(&total).zip([0.3139, 0.4424, 0.0, 0.5576, 0.4424, 0.2437]) {
            assert!((exact - published).abs() < 5e-5);
        }
        let outputs = evaluated(3, 4096, 1, ishigami);
        let found = indices(3, &outputs, &Bootstrap { resamples: 200, ..Bootstrap::default() }).unwrap();
        let worst = worst(&found, &first, &total);
        assert!(worst < 0.01, "{worst}");
    }

    #[test]
    fn the_g_function_has_its_indices() {
        let a = [0.0, 1.0, 4.5, 9.0, 99.0, 99.0, 99.0, 99.0];
        let (first, total) = g_indices(&a);
        let outputs = evaluated(8, 4096, 2, |u| g(&a, u));
        let found = indices(8, &outputs, &Bootstrap { resamples: 200, ..Bootstrap::default() }).unwrap();
        let worst = worst(&found, &first, &total);
        assert!(worst < 0.01, "{worst}");
    }

    /// With scrambled points the bootstrap, which takes blocks for independent, covers more often than it says.
    #[test]
    fn intervals_cover_at_least_as_often_as_they_say() {
        let (first, total, _) = ishigami_indices();
        let (mut covered, mut all) = (0, 0);
        for seed in 0..40 {
            let outputs = evaluated(3, 256, 100 + seed, ishigami);
            let bootstrap = Bootstrap { resamples: 300, seed, ..Bootstrap::default() };
            for (factor, found) in indices(3, &outputs, &bootstrap).unwrap().iter().enumerate() {
                covered += u32::from(found.first.interval.unwrap().contains(first[factor]));
                covered += u32::from(found.total.interval.unwrap().contains(total[factor]));
                all += 2;
            }
        }
        println!("95 % intervals from 256 blocks covered {covered} of {all} indices");
        assert!(f64::from(covered) > 0.93 * f64::from(all), "{covered} of {all}");
    }

    #[test]
    fn blocks_with_missing_outputs_are_left_out_for_the_factors_that_need_them() {
        let (first, total, _) = ishigami_indices();
        let mut outputs = evaluated(3, 4096, 1, ishigami);
        let mut stream = Stream::new(5);
        outputs.iter_mut().for_each(|output| *output = output.filter(|_| stream.uniform() > 0.05));
        let found = indices(3, &outputs, &Bootstrap { resamples: 100, ..Bootstrap::default() }).unwrap();
        assert!(found.iter().all(|f| f.blocks + f.missing == 4096 && (400..800).contains(&f.missing)), "{found:?}");
        // The remaining blocks are a random part of the sequence: the errors are those of independent points.
        let worst = worst(&found, &first, &total);
        assert!(worst < 0.06, "{worst}");
    }

    #[test]
    fn blocks_are_the_halves_of_one_sequence_and_are_kept_by_a_larger_study() {
        let (few, many) = (rows(3, 4, 9).unwrap(), rows(3, 16, 9).unwrap());
        assert_eq!(few, many[..20]);
        for block in many.chunks(5) {
            for factor in 0..3 {
                let expected: Vec<f64> = (0..3).map(|i| if i == factor { block[1][i] } else { block[0][i] }).collect();
                assert_eq!(block[2 + factor], expected);
            }
        }
    }

    #[test]
    fn impossible_indices_are_refused() {
        let bootstrap = Bootstrap::default();
        assert_eq!(indices(2, &[None; 7], &bootstrap), Err(IndicesError::Outputs { outputs: 7, rows: 4 }));
        assert_eq!(indices(2, &[Some(1.0); 8], &bootstrap), Err(IndicesError::Constant));
        let mut outputs = [Some(1.0); 8];
        outputs[3] = None;
        outputs[5] = Some(2.0);
        assert_eq!(indices(2, &outputs, &bootstrap), Err(IndicesError::TooFewBlocks { factor: 1, blocks: 1 }));
    }
}
