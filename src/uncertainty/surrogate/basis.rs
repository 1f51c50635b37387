//! Orthonormal polynomials of one and of several independent inputs.

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

#[cfg(test)]
mod tests {
    use super::*;

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
}
