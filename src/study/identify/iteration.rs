//! Iterations of a search, and why it stopped.

use std::fmt;

use serde::{Serialize, Serializer};

use super::options::Search;

/// The state of a search after an iteration.
#[derive(Clone, Debug, PartialEq)]
pub struct Iteration {
    /// Number of the start, from zero.
    pub start: usize,
    /// Number of the iteration, from one.
    pub iteration: usize,
    /// Points that the search has requested so far.
    pub evaluations: usize,
    /// The best point so far.
    pub x: Vec<f64>,
    /// Its objective value.
    pub f: f64,
    /// Nelder–Mead: largest distance of a vertex from the best along an axis. CMA-ES: step size σ.
    pub size: Option<f64>,
    /// Nelder–Mead: largest difference of the value at a vertex from the best.
    pub spread: Option<f64>,
    /// The kind of step that the iteration made.
    pub step: Step,
}

/// The kind of step of an iteration of a search.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// The first point, simplex or Jacobian.
    Initial,
    /// Nelder–Mead: the worst vertex was reflected.
    Reflected,
    /// Nelder–Mead: the worst vertex was reflected and expanded.
    Expanded,
    /// Nelder–Mead: contracted between centroid and reflected point.
    ContractedOutside,
    /// Nelder–Mead: contracted between centroid and worst vertex.
    ContractedInside,
    /// Nelder–Mead: all vertices moved towards the best.
    Shrunk,
    /// Levenberg–Marquardt: a step was accepted.
    Accepted,
    /// Levenberg–Marquardt: the last point.
    Final,
    /// CMA-ES: a generation was evaluated.
    Generation,
}

impl Step {
    /// Its name in tables of scripts.
    pub fn name(self) -> &'static str {
        match self {
            Step::Initial => "initial",
            Step::Reflected => "reflected",
            Step::Expanded => "expanded",
            Step::ContractedOutside => "contracted_outside",
            Step::ContractedInside => "contracted_inside",
            Step::Shrunk => "shrunk",
            Step::Accepted => "step",
            Step::Final => "final",
            Step::Generation => "generation",
        }
    }
}

/// Why a search stopped.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum StopReason {
    /// Nelder–Mead: the simplex meets both tolerances.
    SimplexTolerance,
    /// Levenberg–Marquardt: the relative reduction of the sum of squares is below `tol_f`.
    SumOfSquaresTolerance,
    /// Levenberg–Marquardt: the reductions of three steps in a row are below `tol_f`, though the linear model promises more.
    SlowDescent,
    /// Levenberg–Marquardt: the relative change of x is below `tol_x`.
    StepTolerance,
    /// Levenberg–Marquardt: the residuals are orthogonal to the columns of the Jacobian.
    ZeroGradient,
    /// Levenberg–Marquardt: all residuals are zero.
    ZeroResiduals,
    /// CMA-ES: the objective values differ by less than `tol_f`.
    ObjectiveTolerance,
    /// CMA-ES: the standard deviations are below `tol_x`.
    DistributionTolerance,
    /// The limit of iterations was reached.
    MaxIterations,
    /// The limit of evaluations was reached.
    MaxEvaluations,
    /// The tolerances are met at a point on a bound.
    OnBound,
    /// Levenberg–Marquardt: a tolerance is below what rounding allows; its name in MINPACK.
    NoImprovement(&'static str),
    /// Levenberg–Marquardt: this quantity is not finite.
    NotFinite(&'static str),
    /// Levenberg–Marquardt: this quantity is missing or has another size than before.
    Unavailable(&'static str),
    /// There are no unknowns or no residuals.
    Empty,
    /// CMA-ES: another termination criterion, by the name that the method gives it.
    Method(String),
}

impl StopReason {
    /// The limit of `search` that ended it after `iterations`.
    pub(crate) fn limit(iterations: usize, search: &Search) -> StopReason {
        if iterations >= search.max_iterations { StopReason::MaxIterations } else { StopReason::MaxEvaluations }
    }
}

impl fmt::Display for StopReason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            StopReason::SimplexTolerance => f.write_str("the simplex is within tol_x and tol_f"),
            StopReason::SumOfSquaresTolerance => f.write_str("the sum of squares changes by less than tol_f of itself"),
            StopReason::SlowDescent => {
                f.write_str("three steps in a row changed the sum of squares by less than tol_f of itself")
            }
            StopReason::StepTolerance => f.write_str("x changes by less than tol_x of itself"),
            StopReason::ZeroGradient => f.write_str("the gradient is zero"),
            StopReason::ZeroResiduals => f.write_str("the residuals are zero"),
            StopReason::ObjectiveTolerance => f.write_str("the objective changes by less than tol_f"),
            StopReason::DistributionTolerance => f.write_str("the distribution is narrower than tol_x"),
            StopReason::MaxIterations => f.write_str("max_iterations was reached"),
            StopReason::MaxEvaluations => f.write_str("max_evaluations was reached"),
            StopReason::OnBound => f.write_str("the best point lies on a bound"),
            StopReason::NoImprovement(tolerance) => write!(f, "no improvement is possible ({tolerance})"),
            StopReason::NotFinite(quantity) => write!(f, "{quantity} is not finite"),
            StopReason::Unavailable(quantity) => write!(f, "{quantity} unavailable"),
            StopReason::Empty => f.write_str("there are no unknowns or no residuals"),
            StopReason::Method(name) => write!(f, "the method stopped ({name})"),
        }
    }
}

/// As its message.
impl Serialize for StopReason {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}
