//! A surrogate of one test: what its signals differ by from the recordings, and what it demands of its film, as polynomials
//! of the unknowns within a box.
//!
//! Its likelihood contains what cross-validation leaves of each principal component of the differences, which is an error of all
//! coordinates together, and what components that are left out leave of every coordinate (docs/theory.md, equation 334).

use nalgebra::{DMatrix, DVector};
use uncertainty::surrogate::{Components, Family, Likelihood, Options, Output, SurrogateError};

/// Highest degree of the polynomials.
const HIGHEST_DEGREE: usize = 6;
/// Distance of points from the faces of the box in its unit coordinates, which are open.
const INSIDE: f64 = 1e-6;
/// Distance of the logarithms of the model's errors between which likelihoods are interpolated.
const SPACING: f64 = 0.02;

/// A box of the unknowns that act on a test.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Region {
    pub(super) low: Vec<f64>,
    pub(super) high: Vec<f64>,
}

impl Region {
    /// A point in unit coordinates; none outside.
    pub(super) fn unit(&self, point: &[f64]) -> Option<Vec<f64>> {
        let unit = |((x, low), high): ((&f64, &f64), &f64)| {
            (low..=high).contains(&x).then(|| ((x - low) / (high - low)).clamp(INSIDE, 1.0 - INSIDE))
        };
        point.iter().zip(&self.low).zip(&self.high).map(unit).collect()
    }

    /// The point at unit coordinates.
    pub(super) fn point(&self, unit: &[f64]) -> Vec<f64> {
        unit.iter().zip(&self.low).zip(&self.high).map(|((u, low), high)| low + u * (high - low)).collect()
    }
}

/// The differences and demands of a test as functions of the unknowns that act on it.
pub(super) struct TestSurrogate {
    region: Region,
    differences: Components,
    likelihood: OverShares,
    demands: Vec<Output>,
    /// Variances of the errors of the demands.
    demand_errors: Vec<f64>,
}

/// What a surrogate says at a point.
pub(super) struct Found {
    amplitudes: Vec<f64>,
    pub(super) demands: Vec<f64>,
}

/// Sizes of the model's error for which a likelihood is asked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Shares {
    /// This one alone.
    Given(f64),
    /// Any between two.
    Between([f64; 2]),
}

impl TestSurrogate {
    /// Fits runs at points of a region, of whose numbers the first `compared` are differences and the others demands; runs
    /// outside of it are left out. `variances` are those of the differences for a model's error.
    pub(super) fn fit(
        region: Region,
        runs: &[(Vec<f64>, Vec<f64>)],
        compared: usize,
        shares: Shares,
        variances: impl Fn(f64) -> Vec<f64>,
    ) -> Result<TestSurrogate, SurrogateError> {
        let inside: Vec<(Vec<f64>, &[f64])> =
            runs.iter().filter_map(|(point, found)| Some((region.unit(point)?, found.as_slice()))).collect();
        let points: Vec<Vec<f64>> = inside.iter().map(|(point, _)| point.clone()).collect();
        let families = vec![Family::Legendre; region.low.len()];
        let Some(numbers) = inside.first().map(|(_, found)| found.len()) else {
            let (terms, needed) = (families.len() + 1, 2 * families.len() + 3);
            return Err(SurrogateError::TooFewSamples { samples: 0, terms, needed });
        };
        let options = Options { highest_degree: HIGHEST_DEGREE, ..Options::default() };
        let all = DMatrix::from_fn(compared, inside.len(), |row, run| inside[run].1[row]);
        let differences = Components::fit(&families, &points, &all, &options)?;
        let demands = (compared..numbers).map(|place| {
            let outputs: Vec<f64> = inside.iter().map(|(_, found)| found[place]).collect();
            Output::fit(&families, &points, &outputs, &options)
        });
        let demands = demands.collect::<Result<Vec<_>, _>>()?;
        let demand_errors = demands.iter().map(Output::error).collect();
        let likelihood = OverShares::new(shares, |share| differences.likelihood(&variances(share)));
        Ok(TestSurrogate { region, differences, likelihood, demands, demand_errors })
    }

    /// What it says at a point; none outside of the region.
    pub(super) fn predicted(&self, point: &[f64]) -> Option<Found> {
        let unit = self.region.unit(point)?;
        let demands = self.demands.iter().map(|own| own.at(&unit)).collect();
        Some(Found { amplitudes: self.differences.amplitudes(&unit), demands })
    }

    /// The differences.
    pub(super) fn differences(&self, found: &Found) -> DVector<f64> {
        self.differences.outputs(&found.amplitudes)
    }

    /// Logarithm of the likelihood of the differences for a model's error, up to a constant.
    pub(super) fn log_likelihood(&self, found: &Found, share: f64) -> f64 {
        self.likelihood.log(&found.amplitudes, share)
    }

    /// Variances of the errors of the demands.
    pub(super) fn demand_errors(&self) -> &[f64] {
        &self.demand_errors
    }
}

/// The likelihood of differences for every size of the model's error that is asked for: it is a matrix for each, which samples
/// are too many to make anew.
struct OverShares {
    /// Logarithm of the first size.
    first: f64,
    /// At sizes [`SPACING`] apart in their logarithm, or the one size that is given.
    nodes: Vec<Likelihood>,
}

impl OverShares {
    /// Nodes that are interpolated between.
    const POINTS: usize = 4;

    fn new(shares: Shares, at: impl Fn(f64) -> Likelihood) -> OverShares {
        match shares {
            Shares::Given(share) => OverShares { first: 0.0, nodes: vec![at(share)] },
            Shares::Between(ends) => {
                let [low, high] = ends.map(f64::ln);
                let intervals = ((high - low) / SPACING).ceil().max(1.0) as usize;
                // One beyond either end, so that every size lies between two of each side.
                let first = low - SPACING;
                let node = |place: usize| at((first + SPACING * place as f64).exp());
                OverShares { first, nodes: (0..=intervals + 2).map(node).collect() }
            }
        }
    }

    /// By the cubic through the nodes about a size.
    fn log(&self, amplitudes: &[f64], share: f64) -> f64 {
        if let [only] = &self.nodes[..] {
            return only.log(amplitudes);
        }
        let place = (share.ln() - self.first) / SPACING;
        let from = (place.floor() as usize).saturating_sub(1).min(self.nodes.len() - Self::POINTS);
        let t = place - from as f64;
        let weight = |own: usize| {
            let others = (0..Self::POINTS).filter(|other| *other != own);
            others.map(|other| (t - other as f64) / (own as f64 - other as f64)).product::<f64>()
        };
        (0..Self::POINTS).map(|own| weight(own) * self.nodes[from + own].log(amplitudes)).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Interpolated likelihoods are those of the variances at every size of the model's error, also where differences are fifty
    /// deviations.
    #[test]
    fn likelihoods_between_sizes_are_those_of_their_variances() {
        let region = Region { low: vec![-1.0], high: vec![1.0] };
        let runs: Vec<(Vec<f64>, Vec<f64>)> = (0..30)
            .map(|run| {
                let x = f64::from(run) / 15.0 - 0.97;
                (vec![x], (0..40).map(|row| 50.0 * (0.1 * f64::from(row) * (2.0 + x)).sin()).collect())
            })
            .collect();
        let variances = |share: f64| (0..40).map(|row| 1.0 + (100.0 * share).powi(2) * 0.9_f64.powi(row)).collect();
        let of = |shares| TestSurrogate::fit(region.clone(), &runs, 40, shares, variances).unwrap();
        let interpolated = of(Shares::Between([1e-5, 1.0]));
        for share in [1e-5, 1.3e-4, 2e-3, 0.0123, 0.1, 0.7, 1.0] {
            for x in [-0.9, 0.1, 0.8] {
                let found = interpolated.predicted(&[x]).unwrap();
                let exact = of(Shares::Given(share)).log_likelihood(&found, share);
                let off = interpolated.log_likelihood(&found, share) - exact;
                assert!(off.abs() < 1e-6 * exact.abs().max(10.0), "{share} {x}: {off} of {exact}");
            }
        }
        assert!(interpolated.predicted(&[1.1]).is_none());
        let none = TestSurrogate::fit(region.clone(), &[], 0, Shares::Given(0.0), |_| Vec::new());
        assert!(matches!(none.err(), Some(SurrogateError::TooFewSamples { samples: 0, .. })));
    }
}
