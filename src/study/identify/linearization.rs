//! The linearization of the residuals at an estimate, by finite differences.

use nalgebra::{DMatrix, DVector};
use thiserror::Error;

use crate::identify::error::SearchFailure;
use crate::identify::objective::{Evaluation, ObjectiveValue};
use crate::identify::options::Search;
use crate::identify::pool::trial_pool::{Evaluator, PoolError};
use lab::confidence::Linearization;

/// Why there is no linearization, or no confidence from it.
#[derive(Debug, Error)]
pub enum LinearizationError {
    /// There are no more trials.
    #[error(transparent)]
    Pool(#[from] PoolError),
    /// The objective has no value at the estimate.
    #[error("the objective has no value at the estimate {x:?}: {cause}")]
    Estimate {
        /// The estimate.
        x: Vec<f64>,
        /// Why its trial failed.
        cause: String,
        /// Whether a simulation failed numerically.
        numerical: bool,
    },
    /// The objective is a scalar.
    #[error("the objective gave a number, and a confidence needs residuals: return a signal or a list")]
    NotResiduals,
    /// The number of residuals changed.
    #[error("the objective gave {found} residuals at {x:?}, and {expected} at the estimate")]
    Residuals {
        /// The point.
        x: Vec<f64>,
        /// Number of residuals there.
        found: usize,
        /// Number of residuals at the estimate.
        expected: usize,
    },
    /// There are too few residuals.
    #[error(
        "the objective gave {found} residuals for {unknowns} parameters: there must be more residuals than parameters"
    )]
    TooFew {
        /// Number of residuals.
        found: usize,
        /// Number of parameters.
        unknowns: usize,
    },
    /// The lengths of the parts do not add up, or there are no confidence intervals.
    #[error(transparent)]
    Confidence(#[from] lab::Error),
    /// The trials on both sides of a parameter failed.
    #[error("the trials beside {parameter} failed, there is no derivative: at {x:?}: {cause}")]
    NoDerivative {
        /// The parameter.
        parameter: String,
        /// The point of the last failed trial.
        x: Vec<f64>,
        /// Why it failed.
        cause: String,
        /// Whether a simulation failed numerically.
        numerical: bool,
    },
}

impl SearchFailure for LinearizationError {
    fn is_numerical(&self) -> bool {
        matches!(
            self,
            LinearizationError::Estimate { numerical: true, .. }
                | LinearizationError::NoDerivative { numerical: true, .. }
        )
    }

    fn cause_of_trial(&self) -> Option<&str> {
        match self {
            LinearizationError::Estimate { cause, .. } | LinearizationError::NoDerivative { cause, .. } => Some(cause),
            _ => None,
        }
    }
}

/// The linearization at the start of `search`, by central differences where bounds and failed trials allow; all
/// trials are evaluated at once. The step is `difference` times the parameter.
///
/// # Errors
/// No residuals at the estimate, too few of them, or failed trials on both sides of a parameter.
pub fn linearize_at_start(search: &Search, evaluator: &Evaluator<'_, '_>) -> Result<Linearization, LinearizationError> {
    // With as many unknowns as residuals, no degree of freedom is left from which to estimate their variance.
    linearize(search, evaluator, search.start.len() + 1)
}

/// The same of residuals whose variance is known, of which there may be fewer than parameters.
///
/// # Errors
/// No residuals at the estimate, or failed trials on both sides of a parameter.
pub fn weigh_at_start(search: &Search, evaluator: &Evaluator<'_, '_>) -> Result<Linearization, LinearizationError> {
    linearize(search, evaluator, 0)
}

/// The linearization of at least `fewest` residuals.
fn linearize(
    search: &Search,
    evaluator: &Evaluator<'_, '_>,
    fewest: usize,
) -> Result<Linearization, LinearizationError> {
    let x = &search.start;
    let steps: Vec<[Option<f64>; 2]> = (0..x.len()).map(|index| steps(search, index)).collect();
    // The estimate itself first, then all steps: one batch, so that all threads have work from the beginning.
    let mut points = vec![x.clone()];
    points.extend(
        steps
            .iter()
            .enumerate()
            .flat_map(|(index, steps)| steps.iter().flatten().map(move |step| beside(x, index, *step))),
    );
    let mut found = evaluator.evaluate_all(&points)?.into_iter();
    let residuals = match found.next() {
        Some(found) => residuals(found)?.map_err(|Failed { cause, numerical }| LinearizationError::Estimate {
            x: x.clone(),
            cause,
            numerical,
        })?,
        None => return Err(PoolError::Closed.into()),
    };
    if residuals.len() < fewest {
        return Err(LinearizationError::TooFew { found: residuals.len(), unknowns: x.len() });
    }
    let mut linearization = Linearization {
        x: x.clone(),
        jacobian: DMatrix::zeros(residuals.len(), x.len()),
        parts: vec![residuals.len()],
        residuals: DVector::from_vec(residuals),
        roughness: 0.0,
        one_sided: vec![],
    };
    for (index, steps) in steps.into_iter().enumerate() {
        let sides = steps.into_iter().flatten().zip(&mut found).collect();
        set_column(&mut linearization, search, index, sides)?;
    }
    Ok(linearization)
}

/// Sets one column of the Jacobian from the outcomes on both sides.
fn set_column(
    linearization: &mut Linearization,
    search: &Search,
    index: usize,
    sides: Vec<(f64, Evaluation)>,
) -> Result<(), LinearizationError> {
    let parameter = || search.names[index].clone();
    let mut slopes = Vec::new();
    let mut failure = None;
    for (step, found) in sides {
        let x = beside(&linearization.x, index, step);
        match residuals(found)? {
            Ok(there) => slopes.push((step, difference(linearization, &x, there)?)),
            Err(Failed { cause, numerical }) => {
                failure = Some(LinearizationError::NoDerivative { parameter: parameter(), x, cause, numerical });
            }
        }
    }
    let slope = match (&slopes[..], failure) {
        ([(up, above), (down, below)], _) => {
            // The first order cancels: curvature over the step is left, or scatter.
            linearization.roughness = linearization.roughness.max((above + below).norm());
            (above - below) / (up - down)
        }
        ([(step, difference)], _) => {
            linearization.one_sided.push(index);
            difference / *step
        }
        (_, Some(failure)) => return Err(failure),
        (_, None) => return Err(PoolError::Closed.into()),
    };
    if slope.iter().any(|slope| !slope.is_finite()) {
        let cause = "the differences of the residuals overflow".into();
        return Err(LinearizationError::NoDerivative {
            parameter: parameter(),
            x: linearization.x.clone(),
            cause,
            numerical: false,
        });
    }
    linearization.jacobian.set_column(index, &slope);
    Ok(())
}

/// The residuals `there`, at `x`, less those at the estimate.
fn difference(linearization: &Linearization, x: &[f64], there: Vec<f64>) -> Result<DVector<f64>, LinearizationError> {
    let (found, expected) = (there.len(), linearization.residuals.len());
    if found != expected {
        return Err(LinearizationError::Residuals { x: x.into(), found, expected });
    }
    Ok(DVector::from_vec(there) - &linearization.residuals)
}

/// Steps up and down that stay within the bounds; at least one does.
fn steps(search: &Search, index: usize) -> [Option<f64>; 2] {
    let x = search.start[index];
    let [lower, upper] = search.bounds.pairs().nth(index).unwrap_or([f64::NEG_INFINITY, f64::INFINITY]);
    let size = if x == 0.0 { 1.0 } else { x.abs() };
    let step = (search.difference * size).min(0.25 * (upper - lower));
    let within = |step: &f64| (lower..=upper).contains(&(x + step));
    [Some(step).filter(within), Some(-step).filter(within)]
}

fn beside(x: &[f64], index: usize, step: f64) -> Vec<f64> {
    let mut x = x.to_vec();
    x[index] += step;
    x
}

/// Why a trial has no residuals.
struct Failed {
    cause: String,
    /// Whether a simulation failed numerically.
    numerical: bool,
}

/// Residuals, or why the trial failed.
fn residuals(found: Evaluation) -> Result<Result<Vec<f64>, Failed>, LinearizationError> {
    match found {
        Evaluation::Value(ObjectiveValue::Residuals(residuals)) => Ok(Ok(residuals)),
        Evaluation::Value(ObjectiveValue::Scalar(_)) => Err(LinearizationError::NotResiduals),
        Evaluation::Failed { cause, numerical } => Ok(Err(Failed { cause, numerical })),
        Evaluation::Fatal(cause) => Err(PoolError::Fatal(cause).into()),
    }
}
