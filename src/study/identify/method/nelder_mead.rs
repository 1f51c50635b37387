//! The simplex search of Nelder and Mead with bounds and restarts.
//!
//! The simplex of Nelder and Mead, in the variant of Lagarias, Reeds, Wright and Wright (SIAM J. Optim. 9, 1998) and
//! with all choices of MATLAB's `fminsearch`, so that numbers of iterations and evaluations can be compared with it.
//!
//! No crate makes these choices: `argmin` stops on the standard deviation of the objective and leaves the initial
//! simplex to the caller.

use super::{SearchContext, Trials, limit};
use crate::identify::objective::SearchError;
use crate::identify::options::Search;
use crate::identify::search::{Iteration, StartResult};

/// Largest number of restarts with a best vertex on a bound.
const MAX_RESTARTS: usize = 5;

/// Searches from `start`.
///
/// A simplex that collapsed onto a bound cannot leave it. Where one converges with its best vertex on a bound, the
/// search restarts with a new simplex around that vertex until a restart brings no improvement.
pub(in crate::identify) fn search(start: &[f64], context: SearchContext<'_>) -> Result<StartResult, SearchError> {
    let SearchContext { search, trials, start: number, observer } = context;
    let mut history = Vec::new();
    let mut observe = |simplex: &Simplex| {
        let iteration = iteration(simplex, number);
        observer(&iteration);
        history.push(iteration);
    };
    let mut simplex = Simplex::around(start, trials)?;
    let mut restarts = 0;
    loop {
        observe(&simplex);
        let before = simplex.vertices[0].f;
        while !simplex.has_converged(search) && !simplex.is_at_limit(search) {
            simplex.advance(trials)?;
            observe(&simplex);
        }
        let best = simplex.vertices[0].clone();
        let is_on_bound = !search.bounds.active(&best.x).is_empty() && !simplex.is_at_limit(search);
        // A first simplex may have collapsed onto the bound at once: it is restarted even without any improvement.
        let improved = restarts == 0 || before - best.f > search.tol_f;
        if !is_on_bound || !improved || restarts == MAX_RESTARTS {
            break;
        }
        restarts += 1;
        let so_far = [simplex.iterations, simplex.evaluations];
        simplex = Simplex::around(&best.x, trials)?.after(so_far);
    }
    let converged = simplex.has_converged(search);
    let reason = match converged {
        true => "the simplex is within tol_x and tol_f".to_owned(),
        false => limit(simplex.iterations, search),
    };
    let best = &simplex.vertices[0];
    let (iterations, evaluations) = (simplex.iterations, simplex.evaluations);
    let (x, f, size) = (best.x.clone(), best.f, Some(simplex.size()));
    Ok(StartResult { x, f, iterations, evaluations, converged, reason, size, history })
}

fn iteration(simplex: &Simplex, start: usize) -> Iteration {
    let best = &simplex.vertices[0];
    Iteration {
        start,
        iteration: simplex.iterations,
        evaluations: simplex.evaluations,
        x: best.x.clone(),
        f: best.f,
        size: Some(simplex.size()),
        spread: Some(simplex.spread()),
        step: simplex.step,
    }
}

/// Reflection, expansion, contraction and shrinkage of Lagarias et al.
const REFLECT: f64 = 1.0;
const EXPAND: f64 = 2.0;
const CONTRACT: f64 = 0.5;
const SHRINK: f64 = 0.5;

/// Relative edge length of the initial simplex along an axis, and the absolute one where the start is zero.
const STEP: f64 = 0.05;
const STEP_FROM_ZERO: f64 = 0.00025;

/// Weight of earlier iterations in the frequencies of second points.
const DECAY: f64 = 0.9;

/// A simplex of n + 1 vertices, the best first.
#[derive(Clone, Debug, PartialEq)]
struct Simplex {
    vertices: Vec<Vertex>,
    iterations: usize,
    evaluations: usize,
    /// The kind of the last step.
    step: &'static str,
    /// Decaying frequencies of the second points of iterations: expanded, contracted outside, contracted inside.
    frequencies: [f64; 3],
}

/// A point and its value.
#[derive(Clone, Debug, PartialEq)]
struct Vertex {
    x: Vec<f64>,
    f: f64,
    /// Number of its evaluation.
    evaluation: usize,
}

impl Simplex {
    /// The start and a point beside it along each axis, on the other side where the bounds allow none on this one.
    fn around(start: &[f64], trials: &Trials<'_>) -> Result<Simplex, SearchError> {
        let beside = |axis: usize| {
            let step = if start[axis] == 0.0 { STEP_FROM_ZERO } else { STEP * start[axis] };
            let mut x = start.to_vec();
            // Not start + step: the rounding of fminsearch.
            x[axis] = if start[axis] == 0.0 { STEP_FROM_ZERO } else { (1.0 + STEP) * start[axis] };
            trials.search.bounds.project(&mut x);
            if x[axis] == start[axis] {
                x[axis] = start[axis] - step;
                trials.search.bounds.project(&mut x);
            }
            x
        };
        let points: Vec<Vec<f64>> = std::iter::once(start.to_vec()).chain((0..start.len()).map(beside)).collect();
        trials.prepare(&points, &[])?;
        let vertices = points
            .into_iter()
            .zip(1..)
            .map(|(x, evaluation)| vertex(x, evaluation, trials))
            .collect::<Result<Vec<_>, _>>()?;
        let evaluations = vertices.len();
        let mut simplex = Simplex { vertices, iterations: 1, evaluations, step: "initial", frequencies: [0.0; 3] };
        simplex.sort();
        Ok(simplex)
    }

    /// Whether a limit of `search` is reached.
    fn is_at_limit(&self, search: &Search) -> bool {
        self.iterations >= search.max_iterations || self.evaluations >= search.max_evaluations
    }

    /// Whether both tolerances of `search` are met.
    fn has_converged(&self, search: &Search) -> bool {
        let best = &self.vertices[0];
        let largest = best.x.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        // As in fminsearch: a tolerance below the rounding of the numbers would never be met.
        self.spread() <= search.tol_f.max(10.0 * spacing(best.f))
            && self.size() <= search.tol_x.max(10.0 * spacing(largest))
    }

    /// Largest distance of a vertex from the best one along an axis.
    fn size(&self) -> f64 {
        let best = &self.vertices[0].x;
        let distances =
            self.vertices[1..].iter().flat_map(|other| other.x.iter().zip(best).map(|(a, b)| (a - b).abs()));
        distances.fold(0.0, f64::max)
    }

    /// Largest difference of the value at a vertex from the best one.
    fn spread(&self) -> f64 {
        let best = self.vertices[0].f;
        self.vertices[1..].iter().map(|other| (other.f - best).abs()).fold(0.0, f64::max)
    }

    /// One iteration: the worst vertex moves, or all but the best shrink towards it.
    fn advance(&mut self, trials: &Trials<'_>) -> Result<(), SearchError> {
        let n = self.vertices.len() - 1;
        let centre = self.centroid();
        let [best, second_worst, worst] = [0, n - 1, n].map(|index| self.vertices[index].f);
        // Away from the worst vertex by a factor, towards it where that is negative.
        let along = |factor: f64| -> Vec<f64> {
            let worst = &self.vertices[n].x;
            let mut x: Vec<f64> = centre.iter().zip(worst).map(|(c, w)| (1.0 + factor) * c - factor * w).collect();
            trials.search.bounds.project(&mut x);
            x
        };
        // All four are known before any value is, so that idle threads can evaluate them at once.
        let [reflected, expanded, outside, inside] =
            [REFLECT, REFLECT * EXPAND, REFLECT * CONTRACT, -CONTRACT].map(along);
        trials.prepare(std::slice::from_ref(&reflected), &self.second_points([&expanded, &outside, &inside]))?;
        let reflected = self.evaluate(reflected, trials)?;
        let (moved, step) = if reflected.f < best {
            let expanded = self.evaluate_second(0, expanded, trials)?;
            if expanded.f < reflected.f { (Some(expanded), "expanded") } else { (Some(reflected), "reflected") }
        } else if reflected.f < second_worst {
            (Some(reflected), "reflected")
        } else if reflected.f < worst {
            let outside = self.evaluate_second(1, outside, trials)?;
            ((outside.f <= reflected.f).then_some(outside), "contracted_outside")
        } else {
            let inside = self.evaluate_second(2, inside, trials)?;
            ((inside.f < worst).then_some(inside), "contracted_inside")
        };
        match moved {
            Some(vertex) => {
                self.vertices[n] = vertex;
                self.step = step;
            }
            None => self.shrink(trials)?,
        }
        self.sort();
        self.iterations += 1;
        Ok(())
    }

    /// The second points of an iteration, the most probable first.
    fn second_points(&self, points: [&Vec<f64>; 3]) -> [Vec<f64>; 3] {
        let mut order = [2, 0, 1];
        order.sort_by(|a, b| self.frequencies[*b].total_cmp(&self.frequencies[*a]));
        order.map(|index| points[index].clone())
    }

    fn evaluate_second(&mut self, which: usize, x: Vec<f64>, trials: &Trials<'_>) -> Result<Vertex, SearchError> {
        // Older iterations count less: which second point is likely changes along the way.
        self.frequencies = self.frequencies.map(|frequency| DECAY * frequency);
        self.frequencies[which] += 1.0;
        self.evaluate(x, trials)
    }

    fn shrink(&mut self, trials: &Trials<'_>) -> Result<(), SearchError> {
        let best = self.vertices[0].x.clone();
        let shrunk = |vertex: &Vertex| vertex.x.iter().zip(&best).map(|(x, b)| b + SHRINK * (x - b)).collect();
        let points: Vec<Vec<f64>> = self.vertices[1..].iter().map(shrunk).collect();
        trials.prepare(&points, &[])?;
        for (index, x) in points.into_iter().enumerate() {
            self.vertices[index + 1] = self.evaluate(x, trials)?;
        }
        self.step = "shrunk";
        Ok(())
    }

    /// Mean of all vertices but the worst, summed in the order of their evaluations: it does not depend on their ranks, to the
    /// bit.
    fn centroid(&self) -> Vec<f64> {
        let count = self.vertices.len() - 1;
        let mut vertices: Vec<&Vertex> = self.vertices[..count].iter().collect();
        vertices.sort_by_key(|vertex| vertex.evaluation);
        let mean = |axis: usize| vertices.iter().map(|vertex| vertex.x[axis]).sum::<f64>() / count as f64;
        (0..count).map(mean).collect()
    }

    fn evaluate(&mut self, x: Vec<f64>, trials: &Trials<'_>) -> Result<Vertex, SearchError> {
        self.evaluations += 1;
        vertex(x, self.evaluations, trials)
    }

    /// The simplex with this many iterations and evaluations of earlier ones counted in.
    fn after(self, [iterations, evaluations]: [usize; 2]) -> Simplex {
        Simplex { iterations: self.iterations + iterations, evaluations: self.evaluations + evaluations, ..self }
    }

    /// Best first; of equal ones the older first.
    fn sort(&mut self) {
        self.vertices.sort_by(|a, b| a.f.total_cmp(&b.f));
    }
}

fn vertex(x: Vec<f64>, evaluation: usize, trials: &Trials<'_>) -> Result<Vertex, SearchError> {
    // A value that is not finite counts as worse than all others.
    let f = trials.value(&x)?.map(|value| value.value()).filter(|f| f.is_finite());
    Ok(Vertex { x, f: f.unwrap_or(f64::INFINITY), evaluation })
}

/// Distance from `value` to the next larger number of its size.
fn spacing(value: f64) -> f64 {
    let size = value.abs();
    size.next_up() - size
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identify::evaluator::with_evaluator;
    use crate::identify::options::Method;

    /// All points but the vertices are worse than they.
    #[test]
    fn a_simplex_without_better_points_shrinks_to_its_best_vertex() {
        let vertices = [[1.0, 2.0], [1.05, 2.0], [1.0, 2.1]];
        let rank = |x: &[f64]| vertices.iter().position(|vertex| vertex == x).map_or(f64::NAN, |index| index as f64);
        let search = Search::new(Method::NelderMead, vertices[0].to_vec());
        let simplex = with_evaluator(&rank, 1, |evaluator| {
            let trials = Trials::new(&search, evaluator);
            let mut simplex = Simplex::around(&search.start, &trials)?;
            simplex.advance(&trials)?;
            Ok::<_, SearchError>(simplex)
        });
        let simplex = simplex.unwrap();
        assert_eq!((simplex.step, simplex.evaluations), ("shrunk", 3 + 2 + 2));
        assert!((simplex.size() - 0.05).abs() < 1e-12 && simplex.vertices[0].x == [1.0, 2.0]);
    }
}
