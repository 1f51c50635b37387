//! Designs: which points of the unit cube a study evaluates.

mod latin;
mod sobol;

use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::random::Stream;

pub use sobol::MOST_FACTORS;

/// How points are chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Method {
    /// Full factorial: every combination of the levels, the last factor fastest.
    Grid,
    /// Latin hypercube (McKay, Beckman, Conover 1979): of n equal strata of every factor each holds one point, at a
    /// random place; the strata of different factors are paired at random. With another number of samples all points
    /// are others.
    LatinHypercube,
    /// Sobol' sequence (Sobol' 1967; direction numbers of Joe, Kuo 2008) with nested uniform scrambling (Owen 1995).
    ///
    /// Scrambling makes the estimates unbiased and, by the seed, repeatable; nested scrambling has, for smooth
    /// functions, a smaller variance than a digital shift, n⁻³ instead of n⁻² (Owen 1997). The first n points are the
    /// same however many follow; powers of two balance best.
    Sobol,
    /// Independent points. The first n are the same however many follow.
    Random,
}

/// Values that a factor takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Levels {
    /// Any.
    Continuous,
    /// This many, in a list.
    Count(usize),
}

impl Levels {
    /// Which level, from 0, the point `u` of the unit interval stands for, each by an equal part of the interval; none
    /// of a continuous factor.
    pub fn level(self, u: f64) -> Option<usize> {
        match self {
            Self::Continuous => None,
            Self::Count(count) => Some(((u * count as f64) as usize).min(count.saturating_sub(1))),
        }
    }
}

/// Why there is no such design.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum DesignError {
    /// There is nothing to vary.
    #[error("a design needs at least one factor")]
    NoFactors,
    /// There is nothing to evaluate.
    #[error("a design needs at least one sample")]
    NoSamples,
    /// A grid cannot take every value of a factor.
    #[error("factor {factor} is continuous; a grid needs a number of levels of every factor")]
    ContinuousInGrid {
        /// Index of the factor, from 0.
        factor: usize,
    },
    /// A factor has no level.
    #[error("factor {factor} has no level")]
    NoLevels {
        /// Index of the factor, from 0.
        factor: usize,
    },
    /// More points than are stored.
    #[error("the design has more than {} points", MOST_POINTS)]
    TooManyPoints,
    /// The Sobol' sequence has fewer dimensions.
    #[error("{factors} factors are more than the {} of the Sobol' sequence", MOST_FACTORS)]
    TooManyFactors {
        /// Number of factors.
        factors: usize,
    },
}

/// Most points of a design.
pub const MOST_POINTS: usize = 1 << 24;

/// Points in the open unit cube, one coordinate a factor: a design by this method, decided by `seed`.
///
/// A grid has the middle of every level's part of the unit interval, and neither `samples` nor `seed` matter. The other
/// methods place points anywhere: [`Levels::level`] tells which level of a factor they stand for.
///
/// # Errors
/// See [`DesignError`].
pub fn points(method: Method, factors: &[Levels], samples: usize, seed: u64) -> Result<Vec<Vec<f64>>, DesignError> {
    if factors.is_empty() {
        return Err(DesignError::NoFactors);
    }
    if let Some(factor) = factors.iter().position(|levels| *levels == Levels::Count(0)) {
        return Err(DesignError::NoLevels { factor });
    }
    if method == Method::Grid {
        return grid(factors);
    }
    if samples == 0 {
        return Err(DesignError::NoSamples);
    }
    if samples > MOST_POINTS {
        return Err(DesignError::TooManyPoints);
    }
    match method {
        Method::Sobol => sobol::points(factors.len(), samples, seed),
        Method::LatinHypercube => Ok(latin::points(factors.len(), samples, seed)),
        Method::Random | Method::Grid => Ok(random(factors.len(), samples, seed)),
    }
}

fn grid(factors: &[Levels]) -> Result<Vec<Vec<f64>>, DesignError> {
    let mut points = vec![Vec::new()];
    for (factor, levels) in factors.iter().enumerate() {
        let Levels::Count(count) = *levels else { return Err(DesignError::ContinuousInGrid { factor }) };
        if points.len().checked_mul(count).is_none_or(|total| total > MOST_POINTS) {
            return Err(DesignError::TooManyPoints);
        }
        let middles: Vec<f64> = (0..count).map(|level| (level as f64 + 0.5) / count as f64).collect();
        let extended = |point: &Vec<f64>, &middle: &f64| [point.as_slice(), &[middle]].concat();
        points = points.iter().flat_map(|point| middles.iter().map(|middle| extended(point, middle))).collect();
    }
    Ok(points)
}

fn random(factors: usize, samples: usize, seed: u64) -> Vec<Vec<f64>> {
    let mut stream = Stream::new(seed);
    (0..samples).map(|_| (0..factors).map(|_| stream.uniform()).collect()).collect()
}

#[cfg(test)]
mod tests;
