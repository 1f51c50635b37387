//! The linearization of the residuals at an estimate, by finite differences.

use nalgebra::{DMatrix, DVector};

use crate::identify::evaluator::Evaluator;
use crate::identify::objective::{Evaluation, ObjectiveValue, SearchError};
use crate::identify::options::Search;
use lab::confidence::Linearization;

/// The linearization at the start of `search`, by central differences where bounds and failed trials allow; all
/// trials are evaluated at once. The step is `difference` times the parameter.
///
/// # Errors
/// No residuals at the estimate, too few of them, or failed trials on both sides of a parameter.
pub fn linearize_at_start(search: &Search, evaluator: &Evaluator<'_>) -> Result<Linearization, SearchError> {
    // With as many unknowns as residuals, no degree of freedom is left from which to estimate their variance.
    linearize(search, evaluator, search.start.len() + 1)
}

/// The same of residuals whose variance is known, of which there may be fewer than parameters.
///
/// # Errors
/// No residuals at the estimate, or failed trials on both sides of a parameter.
pub fn weigh_at_start(search: &Search, evaluator: &Evaluator<'_>) -> Result<Linearization, SearchError> {
    linearize(search, evaluator, 0)
}

/// The linearization of at least `fewest` residuals.
fn linearize(search: &Search, evaluator: &Evaluator<'_>, fewest: usize) -> Result<Linearization, SearchError> {
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
        Some(found) => residuals(found)?
            .map_err(|failed| failed.at(format!("the objective has no value at the estimate {x:?}")))?,
        None => return Err(SearchError::Ended),
    };
    if residuals.len() < fewest {
        return Err(SearchError::refused(format!(
            "the objective gave {found} residuals for {unknowns} parameters: there must be more residuals than parameters",
            found = residuals.len(),
            unknowns = x.len()
        )));
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
) -> Result<(), SearchError> {
    let beside_parameter =
        |x: &[f64]| format!("the trials beside {} failed, there is no derivative: at {x:?}", search.names[index]);
    let mut slopes = Vec::new();
    let mut failure = None;
    for (step, found) in sides {
        let x = beside(&linearization.x, index, step);
        match residuals(found)? {
            Ok(there) => slopes.push((step, difference(linearization, &x, there)?)),
            Err(failed) => failure = Some(failed.at(beside_parameter(&x))),
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
        (_, None) => return Err(SearchError::Ended),
    };
    if slope.iter().any(|slope| !slope.is_finite()) {
        let failed = Failed { cause: "the differences of the residuals overflow".into(), numerical: false };
        return Err(failed.at(beside_parameter(&linearization.x)));
    }
    linearization.jacobian.set_column(index, &slope);
    Ok(())
}

/// The residuals `there`, at `x`, less those at the estimate.
fn difference(linearization: &Linearization, x: &[f64], there: Vec<f64>) -> Result<DVector<f64>, SearchError> {
    let (found, expected) = (there.len(), linearization.residuals.len());
    if found != expected {
        return Err(SearchError::refused(format!(
            "the objective gave {found} residuals at {x:?}, and {expected} at the estimate"
        )));
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

impl Failed {
    /// The error of a trial at this place.
    fn at(self, place: String) -> SearchError {
        SearchError::Trial { place, cause: self.cause, numerical: self.numerical }
    }
}

/// Residuals, or why the trial failed.
fn residuals(found: Evaluation) -> Result<Result<Vec<f64>, Failed>, SearchError> {
    match found {
        Evaluation::Value(ObjectiveValue::Residuals(residuals)) => Ok(Ok(residuals)),
        Evaluation::Value(ObjectiveValue::Scalar(_)) => Err(SearchError::refused(
            "the objective gave a number, and a confidence needs residuals: return a signal or a list",
        )),
        Evaluation::Failed { cause, numerical } => Ok(Err(Failed { cause, numerical })),
        Evaluation::Fatal(cause) => Err(cause.into()),
    }
}
