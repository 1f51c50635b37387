//! The points of a sweep: the values of its runs.

use thiserror::Error;
use uncertainty::design::{self, DesignError, Levels, Method as Sampling};

use super::{Factor, Level, Values, Variation};
use crate::scenario::{Assignment, Method};

/// Most runs of a sweep.
const MOST: usize = 1_000_000;

/// The values of one run, in the order of the factors.
#[derive(Clone, Debug)]
pub struct Point {
    /// A value of each factor.
    pub levels: Vec<Level>,
}

/// Which values all runs of a sweep have; those of a run are made when it is at hand.
#[derive(Clone, Debug)]
pub enum Points {
    /// The rows of a table, as many.
    Rows(usize),
    /// Places in the unit cube, of each factor the probability of at most its value.
    Places(Vec<Vec<f64>>),
}

impl Points {
    /// Number of runs.
    pub fn len(&self) -> usize {
        match self {
            Points::Rows(count) => *count,
            Points::Places(places) => places.len(),
        }
    }

    /// Whether there are no runs.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// Why a variation has no points.
#[derive(Debug, Error)]
pub enum PointsError {
    /// The number of runs is given neither in the scenario nor for the sweep.
    #[error("the number of runs is not given")]
    NoSamples,
    /// The number of runs is that of a list.
    #[error("the variation has {0} runs, which `-n` does not change")]
    Fixed(usize),
    /// More runs than can be numbered.
    #[error("the variation has more than {MOST} runs")]
    TooMany,
    /// The points cannot be chosen.
    #[error(transparent)]
    Design(#[from] DesignError),
}

impl PointsError {
    /// A remedy, where one follows from the error.
    pub fn hint(&self) -> Option<&'static str> {
        match self {
            PointsError::NoSamples => Some("write samples = 200 in [variation], or give -n 200"),
            PointsError::Fixed(_) => Some("leave `-n` out, or choose another method: method = \"sobol\""),
            PointsError::TooMany | PointsError::Design(_) => None,
        }
    }
}

impl Variation {
    /// The points, of which there are `samples` in place of the number that is written.
    ///
    /// # Errors
    /// Their number is not known, or the method does not suit the factors.
    pub fn points(&self, samples: Option<usize>) -> Result<Points, PointsError> {
        let listed = self.listed();
        let count = match (listed, samples) {
            (Some(listed), Some(samples)) if samples != listed => return Err(PointsError::Fixed(listed)),
            (Some(listed), _) => listed,
            (None, samples) => samples.or(self.samples).ok_or(PointsError::NoSamples)?,
        };
        if count > MOST {
            return Err(PointsError::TooMany);
        }
        if let Method::Table(_) = self.method {
            return Ok(Points::Rows(count));
        }
        let mut chosen = design::points(self.sampling(), &self.levels(), count, self.seed)?;
        if let Some(correlation) = &self.correlation {
            chosen.iter_mut().for_each(|point| *point = correlation.apply(point));
        }
        Ok(Points::Places(chosen))
    }

    /// The values of the run at `place` among `points`.
    pub fn point(&self, points: &Points, place: usize) -> Point {
        match points {
            Points::Rows(_) => Point { levels: self.factors.iter().map(|factor| factor.level(place)).collect() },
            Points::Places(places) => self.point_at(&places[place]),
        }
    }

    /// The changes of the scenario that make it the one of a run.
    pub fn assignments(&self, point: &Point) -> Vec<Assignment> {
        self.factors.iter().zip(&point.levels).map(|(factor, level)| factor.assignment(level)).collect()
    }

    /// Number of runs, where the scenario says it.
    pub fn runs(&self) -> Option<usize> {
        self.listed().or(self.samples)
    }

    /// Number of runs of a grid or a table.
    fn listed(&self) -> Option<usize> {
        let counts = || self.factors.iter().map(|factor| factor.values.count().unwrap_or(1));
        match self.method {
            Method::Grid => Some(counts().fold(1, usize::saturating_mul)),
            Method::Table(_) => counts().next(),
            Method::LatinHypercube | Method::Sobol | Method::Random => None,
        }
    }

    fn sampling(&self) -> Sampling {
        match self.method {
            Method::Grid | Method::Table(_) => Sampling::Grid,
            Method::LatinHypercube => Sampling::LatinHypercube,
            Method::Sobol => Sampling::Sobol,
            Method::Random => Sampling::Random,
        }
    }

    fn levels(&self) -> Vec<Levels> {
        let levels = |factor: &Factor| factor.values.count().map_or(Levels::Continuous, Levels::Count);
        self.factors.iter().map(levels).collect()
    }

    fn point_at(&self, place: &[f64]) -> Point {
        let at = |(factor, place): (&Factor, &f64)| match &factor.values {
            Values::Levels(levels) => factor.level((place * levels.len() as f64) as usize),
            Values::Distribution(distribution) => factor.number(distribution.quantile(*place)),
        };
        Point { levels: self.factors.iter().zip(place).map(at).collect() }
    }
}
