//! What a search may be told.

use thiserror::Error;

use super::bounds::{Bounds, BoundsError};

/// How a minimum is searched.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// Simplex, as MATLAB's `fminsearch`.
    NelderMead,
    /// Damped least squares on a vector of residuals.
    LevenbergMarquardt,
    /// Evolution of a normal distribution, for rough objectives.
    CmaEs,
}

impl Method {
    /// The methods by the names that scripts write.
    pub const NAMES: [(&'static str, Method); 3] = [
        ("nelder-mead", Method::NelderMead),
        ("levenberg-marquardt", Method::LevenbergMarquardt),
        ("cma-es", Method::CmaEs),
    ];
}

/// What a trial counts as that has no value.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum OnFailure {
    /// As worse than all others.
    #[default]
    Worst,
    /// As what is found a millionth of its place aside; worst, where that fails too.
    Retry,
    /// As the end of the search.
    Stop,
}

/// What a run counts as in which the film broke.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum OnRupture {
    /// As a failed trial.
    #[default]
    Fail,
    /// As any other: for tests whose film broke.
    Keep,
}

/// Where searches start besides the first start.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Starts {
    #[default]
    One,
    /// So many in all, the others in a Latin hypercube over the bounds.
    Spread(usize),
    /// These as well.
    Given(Vec<Vec<f64>>),
}

/// A search, ready to begin.
#[derive(Clone, Debug, PartialEq)]
pub struct Search {
    pub method: Method,
    pub start: Vec<f64>,
    /// Nelder–Mead: largest distance of a corner from the best along an axis. Levenberg–Marquardt: change of x over its size.
    /// CMA-ES: standard deviation over the first one's unit.
    pub tol_x: f64,
    /// Nelder–Mead, CMA-ES: spread of the objective. Levenberg–Marquardt: change of the sum of squares over itself.
    pub tol_f: f64,
    pub most_iterations: usize,
    pub most_evaluations: usize,
    pub bounds: Bounds,
    /// Of the random numbers of CMA-ES and of the Latin hypercube.
    pub seed: u64,
    pub starts: Starts,
    /// Where to begin in place of a start without a value: the first of these that has one.
    pub fallback: Vec<Vec<f64>>,
    pub on_failure: OnFailure,
    pub on_rupture: OnRupture,
    /// Relative step of the differences that make a Jacobian.
    pub difference: f64,
    /// First standard deviation of CMA-ES: over the size of an unknown, or in u where it has bounds.
    pub spread: f64,
}

/// Why a search cannot begin.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum OptionsError {
    #[error(transparent)]
    Bounds(#[from] BoundsError),
    #[error("a search needs 1 to {} unknowns, the start has {found}", Search::MOST_UNKNOWNS)]
    Unknowns { found: usize },
    #[error("the start is not a number: x[{place}] = {value}")]
    Start { place: usize, value: f64 },
    #[error("`{option}` is {found}, which must be {range}")]
    Range { option: &'static str, found: f64, range: &'static str },
    #[error("starts spread over the bounds need `lower` and `upper` for every unknown")]
    Unbounded,
    #[error("start {number} has {found} entries for {unknowns} unknowns")]
    Count { number: usize, found: usize, unknowns: usize },
}

impl Search {
    /// Most unknowns of a search; more ask for gradients.
    pub const MOST_UNKNOWNS: usize = 50;
    /// Most starts of one search.
    pub const MOST_STARTS: usize = 1000;

    /// A search from `start` with the tolerances and limits of MATLAB's `fminsearch`.
    pub fn new(method: Method, start: Vec<f64>) -> Search {
        let unknowns = start.len();
        Search {
            method,
            tol_x: 1e-4,
            tol_f: 1e-4,
            most_iterations: 200 * unknowns,
            most_evaluations: 200 * unknowns,
            bounds: Bounds::none(unknowns),
            seed: 1,
            starts: Starts::One,
            fallback: vec![],
            on_failure: OnFailure::Worst,
            on_rupture: OnRupture::Fail,
            difference: 1e-3,
            spread: 0.25,
            start,
        }
    }

    /// Whether it can begin.
    pub fn check(&self) -> Result<(), OptionsError> {
        let unknowns = self.start.len();
        if !(1..=Search::MOST_UNKNOWNS).contains(&unknowns) {
            return Err(OptionsError::Unknowns { found: unknowns });
        }
        for (option, found) in [("tol_x", self.tol_x), ("tol_f", self.tol_f)] {
            if !(found.is_finite() && found >= 0.0) {
                return Err(OptionsError::Range { option, found, range: "zero or more" });
            }
        }
        for (option, found) in [("difference", self.difference), ("spread", self.spread)] {
            if !(found > 0.0 && found < 1.0) {
                return Err(OptionsError::Range { option, found, range: "between 0 and 1" });
            }
        }
        for (option, found) in [("max_iterations", self.most_iterations), ("max_evaluations", self.most_evaluations)] {
            if found == 0 {
                return Err(OptionsError::Range { option, found: 0.0, range: "at least 1" });
            }
        }
        self.check_starts(unknowns)
    }

    fn check_starts(&self, unknowns: usize) -> Result<(), OptionsError> {
        let most = Search::MOST_STARTS;
        let starts = match &self.starts {
            Starts::One => &vec![],
            Starts::Spread(count) if (1..=most).contains(count) && self.bounds.are_all() => &vec![],
            Starts::Spread(count) if !(1..=most).contains(count) => {
                return Err(OptionsError::Range { option: "starts", found: *count as f64, range: "1 to 1000" });
            }
            Starts::Spread(_) => return Err(OptionsError::Unbounded),
            Starts::Given(starts) if starts.len() >= most => {
                return Err(OptionsError::Range { option: "starts", found: starts.len() as f64, range: "1 to 1000" });
            }
            Starts::Given(starts) => starts,
        };
        for (number, start) in std::iter::once(&self.start).chain(starts).chain(&self.fallback).enumerate() {
            if start.len() != unknowns {
                return Err(OptionsError::Count { number: number + 1, found: start.len(), unknowns });
            }
            if let Some(place) = start.iter().position(|x| !x.is_finite()) {
                return Err(OptionsError::Start { place, value: start[place] });
            }
            self.bounds.check(start)?;
        }
        Ok(())
    }
}
