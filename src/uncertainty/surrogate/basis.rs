//! Orthonormal polynomials of one and of several independent inputs, and the choice of those that a model takes.

use crate::normal;

/// Polynomials of one input, orthonormal under the distribution of their argument.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Family {
    /// Legendre, of the cumulative probability: for any distribution, best for bounded ones.
    Legendre,
    /// Hermite, of the standard normal score: for outputs that are smooth functions of a normal or log-normal input.
    Hermite,
}

impl Family {
    /// Values of degree 0, 1, 2 … at the point `u` of the open unit interval, as many as `values` holds.
    ///
    /// By the three-term recurrence of the monic polynomials, P₍ₙ₊₁₎ = x Pₙ − bₙ P₍ₙ₋₁₎, divided by their norms
    /// (Gautschi 2004): √b₍ₙ₊₁₎ p₍ₙ₊₁₎ = x pₙ − √bₙ p₍ₙ₋₁₎.
    pub(super) fn fill(self, u: f64, values: &mut [f64]) {
        let x = match self {
            Self::Legendre => 2.0 * u - 1.0,
            Self::Hermite => normal::quantile(u),
        };
        let norm = |n: usize| {
            let n = n as f64;
            match self {
                Self::Legendre => n / (4.0 * n * n - 1.0).sqrt(),
                Self::Hermite => n.sqrt(),
            }
        };
        if let Some(first) = values.first_mut() {
            *first = 1.0;
        }
        for n in 0..values.len().saturating_sub(1) {
            // Normalized within the recurrence, so that values stay of the order of one at any degree.
            let before = if n == 0 { 0.0 } else { norm(n) * values[n - 1] };
            values[n + 1] = (x * values[n] - before) / norm(n + 1);
        }
    }
}

/// Degrees of a product of polynomials: the inputs that take part, each with its degree of at least one.
pub(super) type Degrees = Vec<(usize, usize)>;

/// All products of at most `degree` by the q-norm, (Σ αᵢ^q)^(1/q) ≤ degree (hyperbolic truncation; Blatman, Sudret
/// 2011), by their total degree; none where they are more than `most`.
pub(super) fn hyperbolic(inputs: usize, degree: usize, q: f64, most: usize) -> Option<Vec<Degrees>> {
    // A rounded power must not exclude what lies on the limit.
    let limit = libm::pow(degree as f64, q) * (1.0 + 1e-12);
    let mut all: Vec<Degrees> = vec![Vec::new()];
    let mut last: Vec<(Degrees, f64)> = vec![(Vec::new(), 0.0)];
    while !last.is_empty() {
        let mut longer = Vec::new();
        for (degrees, sum) in &last {
            let from = degrees.last().map_or(0, |&(input, _): &(usize, usize)| input + 1);
            for input in from..inputs {
                for own in 1..=degree {
                    let sum = sum + libm::pow(own as f64, q);
                    if sum > limit {
                        break;
                    }
                    longer.push(([degrees.as_slice(), &[(input, own)]].concat(), sum));
                }
            }
            // Checked while the list grows: it may be astronomically long for many inputs.
            if all.len() + longer.len() > most {
                return None;
            }
        }
        all.extend(longer.iter().map(|(degrees, _)| degrees.clone()));
        last = longer;
    }
    all.sort_by_key(|degrees| degrees.iter().map(|(_, own)| own).sum::<usize>());
    Some(all)
}

/// A column with a smaller part of its length orthogonal to the chosen ones is a combination of them.
const DEPENDENT: f64 = 1e-6;

/// Orthogonal matching pursuit (Pati, Rezaiifar, Krishnaprasad 1993): starts with the first column, adds each time that
/// with the largest correlation to the residual, and fits all chosen by least squares.
///
/// Only the first `fitted` rows are fitted. The others go through the same sums, so that their residuals are the errors
/// of prediction after every step.
pub(super) struct Pursuit<'a> {
    columns: &'a [Vec<f64>],
    fitted: usize,
    usable: Vec<bool>,
    chosen: Vec<usize>,
    /// Orthonormal basis Q of the chosen columns.
    q: Vec<Vec<f64>>,
    /// Columns of R⁻¹, Ψ = Q R, each to its diagonal.
    inverse: Vec<Vec<f64>>,
    /// Qᵀ y.
    projections: Vec<f64>,
    residual: Vec<f64>,
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

impl<'a> Pursuit<'a> {
    pub fn new(columns: &'a [Vec<f64>], outputs: Vec<f64>, fitted: usize) -> Self {
        let usable = vec![true; columns.len()];
        Self {
            columns,
            fitted,
            usable,
            chosen: Vec::new(),
            q: Vec::new(),
            inverse: Vec::new(),
            projections: Vec::new(),
            residual: outputs,
        }
    }

    /// Adds one column; false where none is left, or as many are chosen as half the rows that are fitted.
    pub fn step(&mut self) -> bool {
        if 2 * (self.chosen.len() + 1) > self.fitted {
            return false;
        }
        // The constant first, whatever its correlation: every fit needs it.
        while let Some(column) = if self.chosen.is_empty() { Some(0) } else { self.most_correlated() } {
            self.usable[column] = false;
            if self.add(column) {
                return true;
            }
        }
        false
    }

    /// Sum of the squared errors of the rows that are not fitted.
    pub fn prediction_error(&self) -> f64 {
        let left_out = &self.residual[self.fitted..];
        dot(left_out, left_out)
    }

    fn most_correlated(&self) -> Option<usize> {
        let mut best = (None, 0.0);
        for (index, column) in self.columns.iter().enumerate().filter(|(index, _)| self.usable[*index]) {
            let column = &column[..self.fitted];
            let product = dot(column, &self.residual);
            // Over the squared length: in a sample the columns are not quite orthonormal, and a long one must not win
            // by its length.
            let correlation = product * product / dot(column, column);
            if correlation > best.1 {
                best = (Some(index), correlation);
            }
        }
        best.0
    }

    /// Adds a column; false where it is a combination of the chosen ones.
    fn add(&mut self, column: usize) -> bool {
        let fitted = self.fitted;
        let mut q = self.columns[column].clone();
        let length = dot(&q[..fitted], &q[..fitted]).sqrt();
        let mut products = vec![0.0; self.q.len()];
        // Twice is enough (Kahan; Parlett 1980).
        for _ in 0..2 {
            // Over the rows that are fitted, but applied to all: rows left out go along and give the prediction error
            // without another fit.
            for (basis, product) in self.q.iter().zip(&mut products) {
                let part = dot(&basis[..fitted], &q);
                *product += part;
                q.iter_mut().zip(basis).for_each(|(q, basis)| *q -= part * basis);
            }
        }
        let rest = dot(&q[..fitted], &q[..fitted]).sqrt();
        // What is left of it is round-off, and dividing by that would make it look like a term.
        if rest <= DEPENDENT * length {
            return false;
        }
        q.iter_mut().for_each(|q| *q /= rest);
        let mut inverse = vec![0.0; self.q.len() + 1];
        for (column, product) in self.inverse.iter().zip(&products) {
            // R⁻¹ grows by a column a step, so that coefficients need no back substitution.
            inverse.iter_mut().zip(column).for_each(|(sum, entry)| *sum -= entry * product / rest);
        }
        inverse[self.q.len()] = 1.0 / rest;
        let projection = dot(&q[..fitted], &self.residual);
        self.residual.iter_mut().zip(&q).for_each(|(residual, q)| *residual -= projection * q);
        self.chosen.push(column);
        self.inverse.push(inverse);
        self.projections.push(projection);
        self.q.push(q);
        true
    }

    /// The chosen columns with their coefficients R⁻¹ Qᵀ y.
    pub fn terms(&self) -> Vec<(usize, f64)> {
        let mut coefficients = vec![0.0; self.chosen.len()];
        for (inverse, projection) in self.inverse.iter().zip(&self.projections) {
            coefficients.iter_mut().zip(inverse).for_each(|(sum, entry)| *sum += entry * projection);
        }
        self.chosen.iter().copied().zip(coefficients).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Stream;

    fn values(family: Family, u: f64) -> [f64; 6] {
        let mut values = [0.0; 6];
        family.fill(u, &mut values);
        values
    }

    #[test]
    fn polynomials_are_orthonormal() {
        // Midpoint rule over the probability, and over the score, where the density makes it exact but for the tails.
        let by_probability: Vec<(f64, f64)> = (0..40_000).map(|i| ((f64::from(i) + 0.5) / 4e4, 1.0 / 4e4)).collect();
        let scores = (-800..=800).map(|i| f64::from(i) / 100.0);
        let by_score: Vec<(f64, f64)> = scores.map(|z| (normal::cumulative(z), normal::density(z) / 100.0)).collect();
        for (family, rule, allowed) in [(Family::Legendre, by_probability, 1e-6), (Family::Hermite, by_score, 1e-6)] {
            let values: Vec<([f64; 6], f64)> = rule.iter().map(|&(u, weight)| (values(family, u), weight)).collect();
            for one in 0..=5 {
                for other in 0..=5 {
                    let product: f64 = values.iter().map(|(v, weight)| weight * v[one] * v[other]).sum();
                    let expected = f64::from(u8::from(one == other));
                    assert!((product - expected).abs() < allowed, "{family:?} {one} {other}: {product}");
                }
            }
        }
    }

    #[test]
    fn hermite_polynomials_are_the_known_ones() {
        let z = normal::quantile(0.9);
        let values = values(Family::Hermite, 0.9);
        assert!((values[2] - (z * z - 1.0) / 2.0_f64.sqrt()).abs() < 1e-14);
        assert!((values[3] - (z.powi(3) - 3.0 * z) / 6.0_f64.sqrt()).abs() < 1e-14);
    }

    #[test]
    fn the_truncation_keeps_what_the_norm_allows() {
        let count = |inputs, degree, q| hyperbolic(inputs, degree, q, 10_000).unwrap().len();
        assert_eq!(count(3, 4, 1.0), 35, "(3 + 4)!/(3! 4!) by total degree");
        assert_eq!(count(2, 3, 0.5), 7, "no interaction of degree 3 or less");
        assert_eq!(count(2, 4, 0.5), 10, "(1, 1) has the norm 4");
        assert_eq!(hyperbolic(3, 4, 1.0, 34), None);
        assert_eq!(hyperbolic(2, 1, 1.0, 10).unwrap(), [vec![], vec![(0, 1)], vec![(1, 1)]]);
    }

    fn random(columns: usize, rows: usize, seed: u64) -> Vec<Vec<f64>> {
        let mut stream = Stream::new(seed);
        let mut columns: Vec<Vec<f64>> = (0..columns).map(|_| (0..rows).map(|_| stream.normal()).collect()).collect();
        columns[0] = vec![1.0; rows];
        columns
    }

    #[test]
    fn the_terms_that_made_the_outputs_are_found() {
        let columns = random(200, 100, 3);
        let outputs: Vec<f64> = (0..100).map(|i| 2.0 + 3.0 * columns[17][i] - 0.5 * columns[140][i]).collect();
        let mut pursuit = Pursuit::new(&columns, outputs, 80);
        while pursuit.prediction_error() > 1e-18 && pursuit.step() {}
        let terms = pursuit.terms();
        assert!(terms.len() < 10, "{} terms", terms.len());
        for (column, coefficient) in [(0, 2.0), (17, 3.0), (140, -0.5)] {
            let found = terms.iter().find(|(index, _)| *index == column).expect("chosen").1;
            assert!((found - coefficient).abs() < 1e-10, "{column}: {found}");
        }
    }

    #[test]
    fn errors_of_rows_that_are_left_out_are_those_of_the_coefficients() {
        let columns = random(12, 40, 8);
        let mut stream = Stream::new(2);
        let outputs: Vec<f64> = (0..40).map(|i| columns[1][i] + 0.3 * stream.normal()).collect();
        let mut pursuit = Pursuit::new(&columns, outputs.clone(), 30);
        while pursuit.step() {
            let terms = pursuit.terms();
            let predicted = |row: usize| terms.iter().map(|(column, c)| c * columns[*column][row]).sum::<f64>();
            let error: f64 = (30..40).map(|row| (outputs[row] - predicted(row)).powi(2)).sum();
            assert!((pursuit.prediction_error() / error - 1.0).abs() < 1e-10);
            // Least squares: the residual of what is fitted is orthogonal to every chosen column.
            for (column, _) in &terms {
                let along: f64 = (0..30).map(|row| (outputs[row] - predicted(row)) * columns[*column][row]).sum();
                assert!(along.abs() < 1e-10, "{along:e}");
            }
        }
        assert_eq!(pursuit.terms().len(), 12);
    }

    #[test]
    fn a_column_that_adds_nothing_is_left_out() {
        let mut columns = random(3, 20, 1);
        columns[2] = columns[1].iter().map(|x| 2.0 * x + 1.0).collect();
        let mut pursuit = Pursuit::new(&columns, columns[1].clone(), 20);
        assert!(pursuit.add(0) && pursuit.add(1) && !pursuit.add(2));
    }
}
