//! Gaussian copula: inputs that vary together, each by its own distribution.

use nalgebra::DMatrix;

use crate::{Error, ensure, normal};

/// Gaussian copula (Nataf 1962; Liu, Der Kiureghian 1986): the standard normal scores of the inputs are correlated,
/// every input alone stays as it was.
///
/// The correlation ρ is that of the normal scores. The rank correlations of the inputs follow whatever their
/// distributions: Spearman's 6/π asin(ρ/2), Kendall's 2/π asin ρ (Kruskal 1958).
#[derive(Clone, Debug, PartialEq)]
pub struct Correlation {
    /// Cholesky factor, lower triangle, row by row.
    factor: Vec<Vec<f64>>,
}

impl Correlation {
    /// From the correlation matrix of the normal scores.
    ///
    /// # Errors
    /// It is not square, symmetric, of unit diagonal, or not positive definite.
    pub fn new(matrix: &[Vec<f64>]) -> Result<Self, Error> {
        check(matrix)?;
        let size = matrix.len();
        let matrix = DMatrix::from_fn(size, size, |row, column| matrix[row][column]);
        match matrix.clone().cholesky() {
            Some(cholesky) => {
                let l = cholesky.unpack();
                Ok(Self { factor: (0..size).map(|row| (0..=row).map(|column| l[(row, column)]).collect()).collect() })
            }
            None => {
                // By leading blocks, to name the input that contradicts those before it; only a mistake pays for it.
                let fits = |size: &usize| matrix.view((0, 0), (*size, *size)).clone_owned().cholesky().is_some();
                let fitting = (1..size).take_while(fits).count();
                Err(Error::new(format!(
                    "the correlations of input {fitting} contradict those among the inputs before it: not positive definite"
                )))
            }
        }
    }

    /// Number of inputs.
    pub fn inputs(&self) -> usize {
        self.factor.len()
    }

    /// The correlated point of an independent one in the open unit cube; it stays within the open cube.
    ///
    /// # Panics
    /// The point has another number of coordinates.
    pub fn apply(&self, point: &[f64]) -> Vec<f64> {
        assert_eq!(point.len(), self.inputs(), "one coordinate an input");
        let scores: Vec<f64> = point.iter().map(|&u| normal::quantile(u)).collect();
        let product = |row: &Vec<f64>| row.iter().zip(&scores).map(|(l, score)| l * score).sum();
        // A far score may round to 0 or 1, where an unbounded input has no value.
        let least = f64::MIN_POSITIVE;
        self.factor.iter().map(|row| normal::cumulative(product(row)).clamp(least, 1.0_f64.next_down())).collect()
    }
}

fn check(matrix: &[Vec<f64>]) -> Result<(), Error> {
    let rows = matrix.len();
    for (row, length) in matrix.iter().map(Vec::len).enumerate() {
        ensure(length == rows, || format!("row {row} has {length} entries, but the matrix has {rows} rows"))?;
    }
    for first in 0..rows {
        let own = matrix[first][first];
        ensure(own == 1.0, || format!("the correlation of input {first} with itself is {own}, but must be 1"))?;
        for second in first + 1..rows {
            let (upper, lower) = (matrix[first][second], matrix[second][first]);
            ensure(upper > -1.0 && upper < 1.0, || {
                format!("the correlation of inputs {first} and {second} is {upper}, but must be between -1 and 1")
            })?;
            ensure(upper == lower, || {
                format!(
                    "the correlation of inputs {first} and {second} is {upper} in one place and {lower} in the other"
                )
            })?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;
    use crate::design::{Levels, Method, points};

    /// Spearman's rank correlation of two inputs whose normal scores have the correlation `correlation`.
    fn spearman(correlation: f64) -> f64 {
        6.0 / PI * libm::asin(0.5 * correlation)
    }

    /// Kendall's rank correlation of two inputs whose normal scores have the correlation `correlation`.
    fn kendall(correlation: f64) -> f64 {
        2.0 / PI * libm::asin(correlation)
    }

    /// The correlations of some pairs of inputs; all others are zero.
    fn of_pairs(inputs: usize, pairs: &[(usize, usize, f64)]) -> Result<Correlation, Error> {
        let mut matrix: Vec<Vec<f64>> =
            (0..inputs).map(|row| (0..inputs).map(|column| f64::from(u8::from(row == column))).collect()).collect();
        for &(first, second, value) in pairs {
            matrix[first][second] = value;
            matrix[second][first] = value;
        }
        Correlation::new(&matrix)
    }

    fn sample(correlation: &Correlation, samples: usize) -> Vec<Vec<f64>> {
        let levels = vec![Levels::Continuous; correlation.inputs()];
        let independent = points(Method::Random, &levels, samples, 17).unwrap();
        independent.iter().map(|point| correlation.apply(point)).collect()
    }

    /// Place of every value in the order of all.
    fn ranks(values: &[f64]) -> Vec<f64> {
        let mut order: Vec<usize> = (0..values.len()).collect();
        order.sort_by(|&a, &b| values[a].total_cmp(&values[b]));
        let mut ranks = vec![0.0; values.len()];
        order.into_iter().enumerate().for_each(|(rank, index)| ranks[index] = rank as f64);
        ranks
    }

    fn pearson(x: &[f64], y: &[f64]) -> f64 {
        let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
        let (mean_x, mean_y) = (mean(x), mean(y));
        let moment =
            |a: &[f64], b: &[f64], at: f64, bt: f64| -> f64 { a.iter().zip(b).map(|(a, b)| (a - at) * (b - bt)).sum() };
        moment(x, y, mean_x, mean_y) / (moment(x, x, mean_x, mean_x) * moment(y, y, mean_y, mean_y)).sqrt()
    }

    #[test]
    fn rank_correlations_are_the_closed_forms_and_marginals_stay_uniform() {
        let wanted = [(0, 1, 0.8), (0, 2, -0.5), (1, 2, -0.3)];
        let correlation = of_pairs(3, &wanted).unwrap();
        let samples = 20_000;
        let points = sample(&correlation, samples);
        let column = |input: usize| points.iter().map(|point| point[input]).collect::<Vec<f64>>();
        for (first, second, rho) in wanted {
            let (x, y) = (column(first), column(second));
            let found = pearson(&ranks(&x), &ranks(&y));
            // Standard error of a rank correlation: below 1.1/√n.
            assert!((found - spearman(rho)).abs() < 4.0 * 1.1 / (samples as f64).sqrt(), "{rho}: {found}");
            let pairs = (0..samples - 1).filter(|&i| (x[i] - x[i + 1]) * (y[i] - y[i + 1]) > 0.0).count();
            let concordance = 2.0 * pairs as f64 / (samples - 1) as f64 - 1.0;
            assert!((concordance - kendall(rho)).abs() < 0.03, "{rho}: {concordance}");
            let [ranks, signs] = [spearman(rho), kendall(rho)];
            println!("ρ {rho:5.2}: Spearman {found:.4} ({ranks:.4}), Kendall {concordance:.3} ({signs:.3})");
        }
        for input in 0..3 {
            let mut values = column(input);
            values.sort_by(f64::total_cmp);
            let distance = |(index, u): (usize, &f64)| {
                (u - index as f64 / samples as f64).max((index + 1) as f64 / samples as f64 - u)
            };
            let kolmogorov = values.iter().enumerate().map(distance).fold(0.0, f64::max) * (samples as f64).sqrt();
            println!("input {input}: √n D = {kolmogorov:.3}");
            assert!(kolmogorov < 1.63, "1 % of uniform samples exceed 1.63, found {kolmogorov:.3}");
        }
    }

    #[test]
    fn uncorrelated_inputs_stay_as_they_are() {
        let correlation = of_pairs(2, &[]).unwrap();
        for point in [[0.3, 0.9], [1e-12, 1.0 - 1e-12], [0.5, 1e-300]] {
            let same = correlation.apply(&point);
            assert!(point.iter().zip(&same).all(|(a, b)| (a / b - 1.0).abs() < 1e-12), "{point:?} {same:?}");
        }
    }

    #[test]
    fn spearman_leads_back_to_the_correlation_of_the_scores() {
        for rho in [-0.99, -0.2, 0.0, 0.5, 0.9] {
            assert!((2.0 * libm::sin(PI / 6.0 * spearman(rho)) - rho).abs() < 1e-15);
        }
    }

    #[test]
    fn extreme_points_stay_within_the_open_cube() {
        let correlation = of_pairs(2, &[(0, 1, 0.999)]).unwrap();
        for point in [[1e-300, 1e-300], [1.0_f64.next_down(); 2]] {
            assert!(correlation.apply(&point).iter().all(|&u| u > 0.0 && u < 1.0));
        }
    }

    #[test]
    fn what_is_no_correlation_is_refused_by_name() {
        let contradictory =
            "the correlations of input 2 contradict those among the inputs before it: not positive definite";
        for (refused, expected) in [
            (
                Correlation::new(&[vec![1.0, 0.2], vec![0.3, 1.0]]),
                "the correlation of inputs 0 and 1 is 0.2 in one place and 0.3 in the other",
            ),
            (Correlation::new(&[vec![2.0]]), "the correlation of input 0 with itself is 2, but must be 1"),
            (
                Correlation::new(&[vec![1.0; 2], vec![1.0; 2]]),
                "the correlation of inputs 0 and 1 is 1, but must be between -1 and 1",
            ),
            (Correlation::new(&[vec![1.0, 0.0]]), "row 0 has 2 entries, but the matrix has 1 rows"),
            (of_pairs(4, &[(0, 1, 0.9), (0, 2, 0.9), (1, 2, -0.9)]), contradictory),
        ] {
            assert_eq!(refused.unwrap_err(), Error::new(expected));
        }
    }
}
