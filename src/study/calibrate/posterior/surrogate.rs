//! A surrogate of one test: what its signals differ by from the recordings, and what it demands of its film, as polynomials
//! of the unknowns within a box.
//!
//! Its likelihood contains what cross-validation leaves of each principal component of the differences, which is an error of all
//! coordinates together, and what components that are left out leave of every coordinate (docs/methods.md, equation 334).

use membrane::lane::{LANES, Lane, Width, at_width, lanes};
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;
use uncertainty::Error;
use uncertainty::surrogate::{Components, Family, Output};

use crate::calibrate::error_model::{Spectrum, log_mean_exp};

/// Highest degree of the polynomials.
const HIGHEST_DEGREE: usize = 6;
/// Distance of points from the faces of the box in its unit coordinates, which are open.
const INSIDE: f64 = 1e-6;
/// Distance of the logarithms of the model's errors between which likelihoods are interpolated.
const SPACING: f64 = 0.08;

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
    pub(super) demand_errors: Vec<f64>,
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
    /// outside of it are left out. `spectra` are those of the shapes that the model's error may have.
    pub(super) fn fit(
        region: Region,
        runs: &[(Vec<f64>, Vec<f64>)],
        compared: usize,
        shares: Shares,
        spectra: &[Spectrum],
    ) -> Result<TestSurrogate, Error> {
        let inside: Vec<(Vec<f64>, &[f64])> =
            runs.iter().filter_map(|(point, found)| Some((region.unit(point)?, found.as_slice()))).collect();
        let points: Vec<Vec<f64>> = inside.iter().map(|(point, _)| point.clone()).collect();
        let families = vec![Family::Legendre; region.low.len()];
        let Some(numbers) = inside.first().map(|(_, found)| found.len()) else {
            let (terms, needed) = (families.len() + 1, 2 * families.len() + 3);
            let text =
                format!("0 samples are too few for a linear polynomial of {terms} terms: at least {needed} are needed");
            return Err(Error::new(text));
        };
        let all = DMatrix::from_fn(compared, inside.len(), |row, run| inside[run].1[row]);
        let differences = Components::fit(&families, &points, &all, HIGHEST_DEGREE)?;
        let demands = (compared..numbers).map(|place| {
            let outputs: Vec<f64> = inside.iter().map(|(_, found)| found[place]).collect();
            Output::fit(&families, &points, &outputs, HIGHEST_DEGREE)
        });
        let demands = demands.collect::<Result<Vec<_>, _>>()?;
        let demand_errors = demands.iter().map(Output::error).collect();
        let likelihood = OverShares::new(shares, &differences, spectra);
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

    /// Logarithm of the likelihood of the differences for a model's error of any shape, up to a constant.
    pub(super) fn log_likelihood(&self, found: &Found, share: f64) -> f64 {
        log_mean_exp(self.of_shapes(found, share).iter().copied())
    }

    /// The same for each shape.
    pub(super) fn of_shapes(&self, found: &Found, share: f64) -> Vec<f64> {
        self.likelihood.of_shapes(&found.amplitudes, share)
    }
}

/// The likelihood of differences for every size of the model's error that is asked for, and for every shape: it is a matrix for
/// each, which samples are too many to make anew.
struct OverShares {
    /// Logarithm of the first size.
    first: f64,
    shapes: usize,
    /// At sizes [`SPACING`] apart in their logarithm, or the one size that is given: of each product of two amplitudes, the mean's of
    /// one among them, its factor for every shape; then what is added. Shapes are lanes, of which the last may be empty.
    nodes: Vec<Vec<Lane>>,
    width: Width,
}

at_width! {
    /// Sums of weight, product and factor over nodes, for the shapes of each chunk. A step of a walker is little else.
    fn summed[](nodes: &[(&[Lane], f64)], products: &[f64], sums: &mut [Lane]) {
        let chunks = sums.len();
        for chunk in 0..chunks {
            let mut sum = Lane::default();
            for (factors, weight) in nodes {
                for place in 0..products.len() {
                    sum += factors[place * chunks + chunk] * (weight * products[place]);
                }
            }
            sums[chunk] = sum;
        }
    }
}

impl OverShares {
    /// Nodes that are interpolated between.
    const POINTS: usize = 4;

    fn new(shares: Shares, differences: &Components, spectra: &[Spectrum]) -> OverShares {
        let (first, sizes) = match shares {
            Shares::Given(share) => (0.0, vec![share]),
            Shares::Between(ends) => {
                let [low, high] = ends.map(f64::ln);
                let intervals = ((high - low) / SPACING).ceil().max(1.0) as usize;
                // One beyond either end, so that every size lies between two of each side.
                let first = low - SPACING;
                (first, (0..=intervals + 2).map(|place| (first + SPACING * place as f64).exp()).collect())
            }
        };
        let of_shape = |spectrum: &Spectrum| -> Vec<Vec<f64>> {
            let own = differences.rotated(&spectrum.basis);
            let at = |share: &f64| own.likelihood(&spectrum.variances(*share).collect::<Vec<_>>());
            sizes.iter().map(at).collect()
        };
        let all: Vec<Vec<Vec<f64>>> = spectra.par_iter().map(of_shape).collect();
        let node = |size: usize| {
            let chunk =
                |of: &[Vec<Vec<f64>>], factor: usize| lanes(|lane| of.get(lane).map_or(0.0, |own| own[size][factor]));
            (0..all[0][size].len()).flat_map(|factor| all.chunks(LANES).map(move |of| chunk(of, factor))).collect()
        };
        OverShares { first, shapes: spectra.len(), nodes: (0..sizes.len()).map(node).collect(), width: Width::best() }
    }

    /// By the cubic through the nodes about a size.
    fn of_shapes(&self, amplitudes: &[f64], share: f64) -> Vec<f64> {
        let nodes = match self.nodes.len() {
            1 => vec![(0, 1.0)],
            count => {
                let place = (share.ln() - self.first) / SPACING;
                let from = (place.floor() as usize).saturating_sub(1).min(count - Self::POINTS);
                let t = place - from as f64;
                let weight = |own: usize| {
                    let others = (0..Self::POINTS).filter(|other| *other != own);
                    others.map(|other| (t - other as f64) / (own as f64 - other as f64)).product::<f64>()
                };
                (0..Self::POINTS).map(|own| (from + own, weight(own))).collect()
            }
        };
        let with_mean = || std::iter::once(1.0).chain(amplitudes.iter().copied());
        // Each pair of amplitudes once, then one for what is added.
        let pairs = with_mean()
            .enumerate()
            .flat_map(|(column, own)| with_mean().take(column + 1).map(move |other| own * other));
        let products: Vec<f64> = pairs.chain([1.0]).collect();
        let nodes: Vec<(&[Lane], f64)> =
            nodes.into_iter().map(|(node, weight)| (self.nodes[node].as_slice(), weight)).collect();
        let mut sums = vec![Lane::default(); self.shapes.div_ceil(LANES)];
        summed(self.width, &nodes, &products, &mut sums);
        sums.iter().flat_map(|chunk| chunk.iter().copied()).take(self.shapes).collect()
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;

    /// Interpolated likelihoods are those of the covariance written out, at every size of the model's error and for both of two
    /// shapes, also where differences are fifty deviations.
    #[test]
    fn likelihoods_between_sizes_are_those_of_their_covariance() {
        let region = Region { low: vec![-1.0], high: vec![1.0] };
        let differences =
            |x: f64| DVector::from_fn(40, |row, _| 50.0 * (0.2 * row as f64).sin() * (1.0 + 0.5 * x + 0.2 * x * x));
        let runs: Vec<(Vec<f64>, Vec<f64>)> = (0..30)
            .map(|run| {
                let x = f64::from(run) / 15.0 - 0.97;
                (vec![x], differences(x).as_slice().to_vec())
            })
            .collect();
        let covariance = |length: f64| DMatrix::from_fn(40, 40, |a, b| 1e4 * (-(a.abs_diff(b) as f64) / length).exp());
        let spectrum = |length: f64| {
            let eigen = nalgebra::SymmetricEigen::new(covariance(length));
            Spectrum {
                basis: Arc::new(eigen.eigenvectors.transpose()),
                eigenvalues: eigen.eigenvalues.as_slice().to_vec(),
            }
        };
        let lengths = [3.0, 12.0];
        let all = Shares::Between([1e-5, 1.0]);
        let found = TestSurrogate::fit(region.clone(), &runs, 40, all, &lengths.map(spectrum)).unwrap();
        for share in [1e-5, 1.3e-4, 2e-3, 0.0123, 0.1, 0.7, 1.0] {
            for x in [-0.9, 0.1, 0.8] {
                let at = found.predicted(&[x]).unwrap();
                let exact = lengths.map(|length| {
                    let whole = DMatrix::identity(40, 40) + share * share * covariance(length);
                    let factor = whole.cholesky().unwrap();
                    let own = found.differences(&at);
                    let constant = 2.0 * factor.l().diagonal().iter().map(|own| own.ln()).sum::<f64>();
                    -0.5 * (own.dot(&factor.solve(&own)) + constant)
                });
                for (own, exact) in found.of_shapes(&at, share).iter().zip(exact) {
                    assert!((own - exact).abs() < 2e-3 * exact.abs().max(10.0), "{share} {x}: {own} for {exact}");
                }
            }
        }
        assert!(found.predicted(&[1.1]).is_none());
        let none = TestSurrogate::fit(region.clone(), &[], 0, Shares::Given(0.0), &[Spectrum::trivial(0)]);
        assert!(none.err().unwrap().to_string().starts_with("0 samples are too few"));
    }
}
