//! First-order reliability method: the design point, of all that fail the nearest to the origin.

use serde::{Deserialize, Serialize};

use super::{Counted, LimitState, ReliabilityError, dot};
use crate::normal;

/// How the design point is searched.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FormOptions {
    /// Most iterations.
    pub iterations: usize,
    /// Converged when g is at most this part of its value at the origin, and the point off its gradient by at most this
    /// part of its distance, or of 1 if that is more. Not below 1e-7, whose square is lost in the merit function.
    pub tolerance: f64,
    /// Step of the central differences, in standard deviations; larger than the noise of the limit state.
    pub step: f64,
}

impl Default for FormOptions {
    fn default() -> Self {
        Self { iterations: 50, tolerance: 1e-3, step: 1e-2 }
    }
}

/// Where the search for the design point ended.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DesignPoint {
    /// The point, in standard normal space.
    pub point: Vec<f64>,
    /// Unit vector towards failure, −∇g/|∇g|. The squares of its components are the shares of the inputs in the
    /// variance of the linearized limit state (importance factors).
    pub direction: Vec<f64>,
    /// Reliability index β (Hasofer, Lind 1974): distance of the point, negative where the origin fails.
    pub index: f64,
    /// Φ(−β), the probability of failure of the linearized limit state.
    pub probability: f64,
    /// Whether the origin fails, so that more than about half of all points do.
    pub origin_fails: bool,
    /// Whether the search converged; if not, point and probability are where it stood.
    pub converged: bool,
    /// Iterations.
    pub iterations: usize,
    /// Points that were evaluated.
    pub evaluations: usize,
    /// Of these, points whose output is missing.
    pub missing: usize,
}

/// Trial steps of a batch, each half the one before.
const STEPS: i32 = 3;
/// Batches of trial steps.
const BATCHES: i32 = 4;
/// Share of the first-order decrease of the merit function that a step must reach (Armijo 1966).
const DECREASE: f64 = 0.1;

/// Searches the design point from the origin by the iteration of Hasofer and Lind (1974), Rackwitz and Fiessler (1978),
/// with the step control of Zhang and Der Kiureghian (1995), and gradients by central differences.
///
/// Of several design points it finds one.
///
/// # Errors
/// See [`ReliabilityError`]; also an output missing at the point of an iteration or beside it.
pub fn design_point(
    inputs: usize,
    options: &FormOptions,
    limit_state: &mut LimitState,
) -> Result<DesignPoint, ReliabilityError> {
    if inputs == 0 {
        return Err(ReliabilityError::NoInputs);
    }
    let mut counted = Counted::new(limit_state);
    let mut point = vec![0.0; inputs];
    let mut at_origin = None;
    let mut iterations = 0;
    loop {
        let (g, gradient) = linearized(&mut counted, &point, options.step)?;
        // g has no scale of its own: its value at the origin is the unit in which it counts as zero.
        let scale = at_origin.get_or_insert(g).abs();
        let length = dot(&gradient, &gradient).sqrt();
        if length == 0.0 {
            return Err(ReliabilityError::Flat { evaluations: counted.evaluations });
        }
        let direction: Vec<f64> = gradient.iter().map(|slope| -slope / length).collect();
        let index = dot(&direction, &point);
        let off: f64 = point.iter().zip(&direction).map(|(u, a)| (u - index * a) * (u - index * a)).sum();
        // Both: a point on the limit state need not be its nearest, and one along the gradient need not be on it.
        let converged = g.abs() <= options.tolerance * scale && off.sqrt() <= options.tolerance * index.abs().max(1.0);
        let next = if converged || iterations == options.iterations {
            None
        } else {
            // theory.md, equation 318: the nearest point of the limit state as linearized here.
            let target: Vec<f64> = direction.iter().map(|a| a * (index + g / length)).collect();
            step(&mut counted, (&point, g), &gradient, &target)?
        };
        let Some(next) = next else {
            let probability = normal::cumulative(-index);
            return Ok(DesignPoint {
                point,
                direction,
                index,
                probability,
                origin_fails: at_origin.is_some_and(|g| g < 0.0),
                converged,
                iterations,
                evaluations: counted.evaluations,
                missing: counted.missing,
            });
        };
        point = next;
        iterations += 1;
    }
}

/// Output and gradient at a point.
fn linearized(counted: &mut Counted, point: &[f64], step: f64) -> Result<(f64, Vec<f64>), ReliabilityError> {
    let beside = |input: usize, by: f64| {
        let mut beside = point.to_vec();
        beside[input] += by;
        beside
    };
    let sides = (0..point.len()).flat_map(|input| [beside(input, step), beside(input, -step)]);
    // One batch, so that an expensive limit state is evaluated at all of them in parallel.
    let batch: Vec<Vec<f64>> = std::iter::once(point.to_vec()).chain(sides).collect();
    // A gradient with a gap would point anywhere; unlike a sample, it cannot leave one out.
    let outputs: Option<Vec<f64>> = counted.evaluate(&batch)?.into_iter().collect();
    let outputs = outputs.ok_or(ReliabilityError::Missing { evaluations: counted.evaluations })?;
    let slopes = outputs[1..].chunks(2).map(|sides| (sides[0] - sides[1]) / (2.0 * step)).collect();
    Ok((outputs[0], slopes))
}

/// The point on the way to `target` at which the merit function |u|²/2 + c |g| has decreased enough; none where no step
/// is short enough.
fn step(
    counted: &mut Counted,
    (point, g): (&[f64], f64),
    gradient: &[f64],
    target: &[f64],
) -> Result<Option<Vec<f64>>, ReliabilityError> {
    let way: Vec<f64> = target.iter().zip(point).map(|(target, u)| target - u).collect();
    let length = dot(gradient, gradient).sqrt();
    // Twice the bound c > |u|/|∇g| with which the step is a descent direction of the merit function (Zhang and Der
    // Kiureghian 1995).
    let least = 2.0 * dot(point, point).sqrt() / length;
    let weight = if g == 0.0 { least } else { least.max(dot(target, target) / g.abs()) };
    let merit = |u: &[f64], g: f64| 0.5 * dot(u, u) + weight * g.abs();
    let slope = dot(point, &way) + weight * g.signum() * dot(gradient, &way);
    for batch in 0..BATCHES {
        // Some at once, although the first mostly does: a batch costs no more time than one run where they run in
        // parallel.
        let lengths = (0..STEPS).map(|half| 0.5_f64.powi(batch * STEPS + half));
        let (lengths, points): (Vec<f64>, Vec<Vec<f64>>) =
            lengths.map(|t| (t, point.iter().zip(&way).map(|(u, way)| u + t * way).collect())).unzip();
        let outputs = counted.evaluate(&points)?;
        for ((t, u), output) in lengths.into_iter().zip(points).zip(outputs) {
            // In the order of the lengths: the longest step that is good enough, not the best one, which keeps the pace
            // of the method.
            if output.is_some_and(|new| merit(&u, new) - merit(point, g) <= DECREASE * t * slope) {
                return Ok(Some(u));
            }
        }
    }
    Ok(None)
}
