//! The options of a search.

use thiserror::Error;

use super::bounds::{Bounds, BoundsError};
use super::point::unnamed;

/// The method of a search.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// The simplex search of Nelder and Mead, as MATLAB's `fminsearch`.
    NelderMead,
    /// Damped least squares; needs residuals.
    LevenbergMarquardt,
    /// Evolution of a normal distribution, for rough objectives.
    CmaEs,
}

impl Method {
    /// The methods by their names in scripts.
    pub const NAMES: [(&'static str, Method); 3] = [
        ("nelder-mead", Method::NelderMead),
        ("levenberg-marquardt", Method::LevenbergMarquardt),
        ("cma-es", Method::CmaEs),
    ];
}

/// Starts beside [`Search::start`].
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Starts {
    /// None.
    #[default]
    One,
    /// This number in all, the others in a Latin hypercube over the bounds.
    Spread(usize),
    /// These.
    Given(Vec<Vec<f64>>),
    /// This number in all, the others those of these points whose values are lowest.
    Lowest(usize, Vec<Vec<f64>>),
}

/// A search: method, start, tolerances and limits.
#[derive(Clone, Debug, PartialEq)]
pub struct Search {
    /// The method.
    pub method: Method,
    /// The first start, one value for each unknown.
    pub start: Vec<f64>,
    /// Names of the unknowns; `x0`, `x1`, … where none are given.
    pub names: Vec<String>,
    /// Nelder–Mead: largest distance of a vertex from the best along an axis. Levenberg–Marquardt: relative change of
    /// x. CMA-ES: standard deviation in units of the first one.
    pub tol_x: f64,
    /// Nelder–Mead, CMA-ES: difference of objective values. Levenberg–Marquardt: relative reduction of the sum of
    /// squares.
    pub tol_f: f64,
    /// Limit of iterations of one start.
    pub max_iterations: usize,
    /// Limit of evaluations of one start.
    pub max_evaluations: usize,
    /// Bounds of the unknowns.
    pub bounds: Bounds,
    /// Seed of CMA-ES and of the Latin hypercube.
    pub seed: u64,
    /// Further starts.
    pub starts: Starts,
    /// Relative step of the differences of a Jacobian.
    pub difference: f64,
}

/// Why the options of a search are invalid.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum OptionsError {
    /// The bounds are invalid.
    #[error(transparent)]
    Bounds(#[from] BoundsError),
    /// There are too many unknowns, or none.
    #[error("a search needs 1 to {} unknowns, the start has {found}", Search::MAX_UNKNOWNS)]
    Unknowns {
        /// Their number.
        found: usize,
    },
    /// There is not one name for each unknown.
    #[error("`names` has {found} entries for {unknowns} unknowns")]
    Names {
        /// Number of names.
        found: usize,
        /// Number of unknowns.
        unknowns: usize,
    },
    /// A start is not finite.
    #[error("the start is not finite: {unknown} = {value}")]
    Start {
        /// The unknown.
        unknown: String,
        /// Its value.
        value: f64,
    },
    /// An option is out of its range.
    #[error("`{option}` is {found}, which must be {range}")]
    Range {
        /// Its name.
        option: &'static str,
        /// Its value.
        found: f64,
        /// The range in words.
        range: &'static str,
    },
    /// A Latin hypercube needs bounds.
    #[error("starts spread over the bounds need `lower` and `upper` for every unknown")]
    Unbounded,
    /// A start has the wrong number of entries.
    #[error("start {number} has {found} entries for {unknowns} unknowns")]
    Count {
        /// The start, from one.
        number: usize,
        /// Number of its entries.
        found: usize,
        /// Number of unknowns.
        unknowns: usize,
    },
}

impl Starts {
    /// Number of starts, that of the search included.
    pub fn count(&self) -> usize {
        match self {
            Starts::One => 1,
            Starts::Spread(count) => *count,
            Starts::Given(others) => 1 + others.len(),
            Starts::Lowest(count, points) => 1 + points.len().min(count.saturating_sub(1)),
        }
    }
}

impl Search {
    /// Largest number of unknowns; more need gradients.
    pub const MAX_UNKNOWNS: usize = 50;
    /// Largest number of starts.
    pub const MAX_STARTS: usize = 1000;

    /// A search from `start` with the tolerances and limits of MATLAB's `fminsearch`.
    pub fn new(method: Method, start: Vec<f64>) -> Search {
        let unknowns = start.len();
        Search {
            method,
            tol_x: 1e-4,
            tol_f: 1e-4,
            max_iterations: 200 * unknowns,
            max_evaluations: 200 * unknowns,
            bounds: Bounds::none(unknowns),
            seed: 1,
            starts: Starts::One,
            difference: 1e-3,
            names: unnamed(unknowns),
            start,
        }
    }

    /// Checks ranges, bounds and starts.
    ///
    /// # Errors
    /// The first option that is invalid.
    pub fn check(&self) -> Result<(), OptionsError> {
        let unknowns = self.start.len();
        if !(1..=Search::MAX_UNKNOWNS).contains(&unknowns) {
            return Err(OptionsError::Unknowns { found: unknowns });
        }
        if self.names.len() != unknowns {
            return Err(OptionsError::Names { found: self.names.len(), unknowns });
        }
        for (option, found) in [("tol_x", self.tol_x), ("tol_f", self.tol_f)] {
            if !(found.is_finite() && found >= 0.0) {
                return Err(OptionsError::Range { option, found, range: "zero or more" });
            }
        }
        if !(self.difference > 0.0 && self.difference < 1.0) {
            let (option, found) = ("difference", self.difference);
            return Err(OptionsError::Range { option, found, range: "between 0 and 1" });
        }
        for (option, found) in [("max_iterations", self.max_iterations), ("max_evaluations", self.max_evaluations)] {
            if found == 0 {
                return Err(OptionsError::Range { option, found: 0.0, range: "at least 1" });
            }
        }
        self.check_starts(unknowns)
    }

    fn check_starts(&self, unknowns: usize) -> Result<(), OptionsError> {
        let most = Search::MAX_STARTS;
        let starts = match &self.starts {
            Starts::One => &vec![],
            Starts::Spread(count) if (1..=most).contains(count) && self.bounds.are_all() => &vec![],
            Starts::Spread(count) if !(1..=most).contains(count) => {
                return Err(OptionsError::Range { option: "starts", found: *count as f64, range: "1 to 1000" });
            }
            Starts::Spread(_) => return Err(OptionsError::Unbounded),
            Starts::Given(starts) | Starts::Lowest(_, starts) if starts.len() >= most => {
                return Err(OptionsError::Range { option: "starts", found: starts.len() as f64, range: "1 to 1000" });
            }
            Starts::Given(starts) | Starts::Lowest(_, starts) => starts,
        };
        for (number, start) in std::iter::once(&self.start).chain(starts).enumerate() {
            if start.len() != unknowns {
                return Err(OptionsError::Count { number: number + 1, found: start.len(), unknowns });
            }
            if let Some(index) = start.iter().position(|x| !x.is_finite()) {
                return Err(OptionsError::Start { unknown: self.names[index].clone(), value: start[index] });
            }
            self.bounds.check(start, &self.names)?;
        }
        Ok(())
    }
}
