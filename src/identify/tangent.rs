//! Residuals around an estimate, as far as they are a linear function of the parameters.

use nalgebra::{DMatrix, DVector};
use thiserror::Error;

use super::crew::{CrewError, Desk};
use super::objective::{Answer, Evaluation};
use super::options::{OnFailure, Search};
use super::search::Unfound;

/// r(x̂ + δ) ≈ r(x̂) + J δ
#[derive(Clone, Debug, PartialEq)]
pub struct Tangent {
    /// The estimate x̂.
    pub x: Vec<f64>,
    /// r(x̂)
    pub residuals: DVector<f64>,
    /// Numbers of residuals of the parts, one after the other, that the residuals were joined from, such as signals: noise
    /// has a variance and a correlation of its own in each.
    pub parts: Vec<usize>,
    /// J = ∂r/∂x, residuals × parameters.
    pub jacobian: DMatrix<f64>,
    /// Largest ‖r(x + h) − 2 r(x) + r(x − h)‖ over the parameters: curvature and roughness at the scale of the differences.
    pub bend: f64,
    /// Parameters with a difference to one side only, since the other one lies beyond a bound or failed.
    pub one_sided: Vec<usize>,
}

/// Why there is no tangent.
#[derive(Debug, Error)]
pub enum TangentError {
    #[error(transparent)]
    Crew(#[from] CrewError),
    #[error("the objective has no value at the estimate {x:?}: {cause}")]
    Estimate { x: Vec<f64>, cause: String, numerical: bool },
    #[error(
        "the objective gave a number, and what a parameter is worth shows in residuals only: return a signal or a list"
    )]
    NotResiduals,
    #[error("the objective gave {found} residuals at {x:?}, and {expected} at the estimate")]
    Residuals { x: Vec<f64>, found: usize, expected: usize },
    #[error("the objective gave {found} residuals for {unknowns} parameters: their scatter needs more than that")]
    TooFew { found: usize, unknowns: usize },
    #[error(
        "`parts` {parts:?} are {sum} residuals together, and the objective gave {found}: they are the lengths of the lists \
         that it joined, in their order"
    )]
    Parts { parts: Vec<usize>, sum: usize, found: usize },
    #[error("the trials beside x[{place}] failed, there is no slope: at {x:?}: {cause}")]
    NoSlope { place: usize, x: Vec<f64>, cause: String, numerical: bool },
}

impl Unfound for TangentError {
    fn is_numerical(&self) -> bool {
        matches!(self, TangentError::Estimate { numerical: true, .. } | TangentError::NoSlope { numerical: true, .. })
    }
}

impl Tangent {
    /// Differences around the start of `search`, central where there is room, all evaluated at once. Their step is the share
    /// `difference` of the parameter's size.
    ///
    /// # Errors
    /// No residuals at the estimate, fewer than needed, or no trial without failure on either side.
    pub fn at_start(search: &Search, desk: &Desk<'_, '_>) -> Result<Tangent, TangentError> {
        let x = &search.start;
        let steps: Vec<[Option<f64>; 2]> = (0..x.len()).map(|place| steps(search, place)).collect();
        let mut points = vec![x.clone()];
        points.extend(
            steps
                .iter()
                .enumerate()
                .flat_map(|(place, steps)| steps.iter().flatten().map(move |step| beside(x, place, *step))),
        );
        let mut found = desk.evaluate_all(&points)?.into_iter();
        let residuals = match found.next() {
            Some(found) => residuals(found)?.map_err(|Failed { cause, numerical }| TangentError::Estimate {
                x: x.clone(),
                cause,
                numerical,
            })?,
            None => return Err(CrewError::Broken("the trial was not made".into()).into()),
        };
        if residuals.len() <= x.len() {
            return Err(TangentError::TooFew { found: residuals.len(), unknowns: x.len() });
        }
        let mut tangent = Tangent {
            x: x.clone(),
            jacobian: DMatrix::zeros(residuals.len(), x.len()),
            parts: vec![residuals.len()],
            residuals: DVector::from_vec(residuals),
            bend: 0.0,
            one_sided: vec![],
        };
        for (place, steps) in steps.into_iter().enumerate() {
            let sides = steps.into_iter().flatten().zip(&mut found).collect();
            tangent.take(search, place, sides)?;
        }
        Ok(tangent)
    }

    /// With residuals that were joined from parts of these lengths, in their order; `at_start` takes them for one.
    ///
    /// # Errors
    /// They are not the residuals' number together.
    pub fn joined_from(self, parts: &[usize]) -> Result<Tangent, TangentError> {
        let (sum, found) = (parts.iter().fold(0_usize, |sum, part| sum.saturating_add(*part)), self.residuals.len());
        if sum != found {
            return Err(TangentError::Parts { parts: parts.into(), sum, found });
        }
        Ok(Tangent { parts: parts.into(), ..self })
    }

    /// ‖r(x̂)‖
    pub fn norm(&self) -> f64 {
        self.residuals.norm()
    }

    /// One column from what was found at its steps.
    fn take(&mut self, search: &Search, place: usize, sides: Vec<(f64, Evaluation)>) -> Result<(), TangentError> {
        let mut slopes = Vec::new();
        let mut failure = None;
        for (step, found) in sides {
            let x = beside(&self.x, place, step);
            match residuals(found)? {
                Ok(there) => slopes.push((step, self.difference(&x, there)?)),
                Err(Failed { cause, numerical }) => {
                    failure = Some(TangentError::NoSlope { place, x, cause, numerical });
                }
            }
        }
        let slope = match (&slopes[..], failure) {
            (_, Some(failure)) if search.on_failure == OnFailure::Stop => return Err(failure),
            ([(up, above), (down, below)], _) => {
                self.bend = self.bend.max((above + below).norm());
                (above - below) / (up - down)
            }
            ([(step, difference)], _) => {
                self.one_sided.push(place);
                difference / *step
            }
            (_, Some(failure)) => return Err(failure),
            (_, None) => return Err(CrewError::Broken("the trials were not made".into()).into()),
        };
        if slope.iter().any(|slope| !slope.is_finite()) {
            let cause = "the residuals change by more than numbers can hold".into();
            return Err(TangentError::NoSlope { place, x: self.x.clone(), cause, numerical: false });
        }
        self.jacobian.set_column(place, &slope);
        Ok(())
    }

    fn difference(&self, x: &[f64], there: Vec<f64>) -> Result<DVector<f64>, TangentError> {
        let (found, expected) = (there.len(), self.residuals.len());
        if found != expected {
            return Err(TangentError::Residuals { x: x.into(), found, expected });
        }
        Ok(DVector::from_vec(there) - &self.residuals)
    }
}

/// Steps upwards and downwards that stay within the bounds; at least one does.
fn steps(search: &Search, place: usize) -> [Option<f64>; 2] {
    let x = search.start[place];
    let [lower, upper] = search.bounds.pairs().nth(place).unwrap_or([f64::NEG_INFINITY, f64::INFINITY]);
    let size = if x == 0.0 { 1.0 } else { x.abs() };
    let step = (search.difference * size).min(0.25 * (upper - lower));
    let within = |step: &f64| (lower..=upper).contains(&(x + step));
    [Some(step).filter(within), Some(-step).filter(within)]
}

fn beside(x: &[f64], place: usize, step: f64) -> Vec<f64> {
    let mut x = x.to_vec();
    x[place] += step;
    x
}

/// Why a trial has no residuals.
pub(super) struct Failed {
    pub(super) cause: String,
    /// Whether a simulation went wrong numerically.
    pub(super) numerical: bool,
}

/// Residuals, or why the trial failed.
pub(super) fn residuals(found: Evaluation) -> Result<Result<Vec<f64>, Failed>, TangentError> {
    match found {
        Evaluation::Answer(Answer::Residuals(residuals)) => Ok(Ok(residuals)),
        Evaluation::Answer(Answer::Value(_)) => Err(TangentError::NotResiduals),
        Evaluation::Failed { cause, numerical } => Ok(Err(Failed { cause, numerical })),
        Evaluation::Broken(cause) => Err(CrewError::Broken(cause).into()),
    }
}
