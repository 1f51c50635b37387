//! The simplex of Nelder and Mead, in the variant of Lagarias, Reeds, Wright and Wright (SIAM J. Optim. 9, 1998) and
//! with all choices of MATLAB's `fminsearch`, so that numbers of iterations and evaluations can be compared with it.
//!
//! No crate makes these choices: `argmin` stops on the standard deviation of the objective and leaves the initial
//! simplex to the caller.

use crate::identify::iteration::Step;

/// Reflection, expansion, contraction and shrinkage of Lagarias et al.
const REFLECT: f64 = 1.0;
const EXPAND: f64 = 2.0;
const CONTRACT: f64 = 0.5;
const SHRINK: f64 = 0.5;

/// Relative edge length of the initial simplex along an axis, and the absolute one where the start is zero.
const STEP: f64 = 0.05;
const STEP_FROM_ZERO: f64 = 0.00025;

/// The values of a simplex.
pub(super) trait SimplexValues {
    /// Why there is no value.
    type Error;

    /// The value at `x`; one that is not finite counts as worse than all others.
    fn value(&mut self, x: &[f64]) -> Result<f64, Self::Error>;

    /// Points that may be requested next, the most probable first, for speculative evaluation.
    fn speculate(&mut self, _points: &[Vec<f64>]) {}

    /// Points that `simplex` will request next according to a surrogate model.
    fn predict(&self, _simplex: &Simplex) -> Vec<Vec<f64>> {
        vec![]
    }

    /// Projects a point onto the bounds.
    fn project(&self, _x: &mut [f64]) {}
}

/// Weight of earlier iterations in the frequencies of second points.
const DECAY: f64 = 0.9;

/// Tolerances, which both have to be met, and limits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Limits {
    /// Largest distance of a vertex from the best one along an axis.
    pub(super) tol_x: f64,
    /// Largest difference of the value at a vertex from the best one.
    pub(super) tol_f: f64,
    pub(super) max_iterations: usize,
    pub(super) max_evaluations: usize,
}

impl Limits {
    /// Whether a limit is reached.
    pub(super) fn are_met(&self, simplex: &Simplex) -> bool {
        simplex.iterations >= self.max_iterations || simplex.evaluations >= self.max_evaluations
    }
}

/// A simplex of n + 1 vertices, the best first.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Simplex {
    pub(super) vertices: Vec<Vertex>,
    pub(super) iterations: usize,
    pub(super) evaluations: usize,
    /// The kind of the last step.
    pub(super) step: Step,
    /// Decaying frequencies of the second points of iterations: expanded, contracted outside, contracted inside.
    frequencies: [f64; 3],
}

/// A point and its value.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Vertex {
    pub(super) x: Vec<f64>,
    pub(super) f: f64,
    /// Number of its evaluation.
    pub(super) evaluation: usize,
}

impl Simplex {
    /// The start and a point beside it along each axis, on the other side where the bounds allow none on this one.
    pub(super) fn around<V: SimplexValues>(start: &[f64], values: &mut V) -> Result<Simplex, V::Error> {
        let beside = |axis: usize| {
            let step = if start[axis] == 0.0 { STEP_FROM_ZERO } else { STEP * start[axis] };
            let mut x = start.to_vec();
            // Not start + step: the rounding of fminsearch.
            x[axis] = if start[axis] == 0.0 { STEP_FROM_ZERO } else { (1.0 + STEP) * start[axis] };
            values.project(&mut x);
            if x[axis] == start[axis] {
                x[axis] = start[axis] - step;
                values.project(&mut x);
            }
            x
        };
        let points: Vec<Vec<f64>> = std::iter::once(start.to_vec()).chain((0..start.len()).map(beside)).collect();
        values.speculate(&points);
        let vertices = points
            .into_iter()
            .zip(1..)
            .map(|(x, evaluation)| vertex(x, evaluation, values))
            .collect::<Result<Vec<_>, _>>()?;
        let evaluations = vertices.len();
        let mut simplex = Simplex { vertices, iterations: 1, evaluations, step: Step::Initial, frequencies: [0.0; 3] };
        simplex.sort();
        Ok(simplex)
    }

    /// Whether both tolerances of `limits` are met.
    pub(super) fn has_converged(&self, limits: &Limits) -> bool {
        let best = &self.vertices[0];
        let largest = best.x.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        // As in fminsearch: a tolerance below the rounding of the numbers would never be met.
        self.spread() <= limits.tol_f.max(10.0 * spacing(best.f))
            && self.size() <= limits.tol_x.max(10.0 * spacing(largest))
    }

    /// Largest distance of a vertex from the best one along an axis.
    pub(super) fn size(&self) -> f64 {
        let best = &self.vertices[0].x;
        let distances =
            self.vertices[1..].iter().flat_map(|other| other.x.iter().zip(best).map(|(a, b)| (a - b).abs()));
        distances.fold(0.0, f64::max)
    }

    /// Largest difference of the value at a vertex from the best one.
    pub(super) fn spread(&self) -> f64 {
        let best = self.vertices[0].f;
        self.vertices[1..].iter().map(|other| (other.f - best).abs()).fold(0.0, f64::max)
    }

    /// One iteration: the worst vertex moves, or all but the best shrink towards it.
    pub(super) fn advance<V: SimplexValues>(&mut self, values: &mut V) -> Result<(), V::Error> {
        let before = self.clone();
        let n = self.vertices.len() - 1;
        let centre = self.centroid();
        let [best, second_worst, worst] = [0, n - 1, n].map(|index| self.vertices[index].f);
        // Away from the worst vertex by a factor, towards it where that is negative.
        let along = |factor: f64| -> Vec<f64> {
            let worst = &self.vertices[n].x;
            let mut x: Vec<f64> = centre.iter().zip(worst).map(|(c, w)| (1.0 + factor) * c - factor * w).collect();
            values.project(&mut x);
            x
        };
        // All four are known before any value is, so that idle threads can evaluate them meanwhile.
        let [reflected, expanded, outside, inside] =
            [REFLECT, REFLECT * EXPAND, REFLECT * CONTRACT, -CONTRACT].map(along);
        let predicted = values.predict(&before);
        values.speculate(&[predicted, self.candidates(&reflected, [&expanded, &outside, &inside], values)].concat());
        let reflected = self.evaluate(reflected, values)?;
        let (moved, step) = if reflected.f < best {
            let expanded = self.evaluate_second(0, expanded, &before, values)?;
            if expanded.f < reflected.f { (Some(expanded), Step::Expanded) } else { (Some(reflected), Step::Reflected) }
        } else if reflected.f < second_worst {
            (Some(reflected), Step::Reflected)
        } else if reflected.f < worst {
            let outside = self.evaluate_second(1, outside, &before, values)?;
            ((outside.f <= reflected.f).then_some(outside), Step::ContractedOutside)
        } else {
            let inside = self.evaluate_second(2, inside, &before, values)?;
            ((inside.f < worst).then_some(inside), Step::ContractedInside)
        };
        match moved {
            Some(vertex) => {
                self.vertices[n] = vertex;
                self.step = step;
            }
            None => self.shrink(values)?,
        }
        self.sort();
        self.iterations += 1;
        Ok(())
    }

    /// The points of an iteration and the first of the next one, the most probable first.
    fn candidates<V: SimplexValues>(&self, reflected: &[f64], second: [&Vec<f64>; 3], values: &V) -> Vec<Vec<f64>> {
        let mut order = [2, 0, 1];
        order.sort_by(|a, b| self.frequencies[*b].total_cmp(&self.frequencies[*a]));
        let [probable, others @ ..] = order.map(|index| second[index].clone());
        let next = self.next_reflected(reflected, values);
        [reflected.to_vec(), probable, next].into_iter().chain(others).collect()
    }

    /// The reflected point of the next iteration if this one accepts `x` and it is not the worst vertex then.
    fn next_reflected<V: SimplexValues>(&self, x: &[f64], values: &V) -> Vec<f64> {
        let n = self.vertices.len() - 1;
        let accepted = Vertex { x: x.into(), f: f64::NAN, evaluation: self.evaluations };
        let others: Vec<&Vertex> = self.vertices[..n - 1].iter().chain([&accepted]).collect();
        let worst = &self.vertices[n - 1].x;
        let mut next: Vec<f64> =
            centroid(others).iter().zip(worst).map(|(c, w)| (1.0 + REFLECT) * c - REFLECT * w).collect();
        values.project(&mut next);
        next
    }

    /// Evaluates the second point of an iteration that began with the simplex `before`.
    fn evaluate_second<V: SimplexValues>(
        &mut self,
        which: usize,
        x: Vec<f64>,
        before: &Simplex,
        values: &mut V,
    ) -> Result<Vertex, V::Error> {
        // Older iterations count less: which second point is likely changes along the way.
        self.frequencies = self.frequencies.map(|frequency| DECAY * frequency);
        self.frequencies[which] += 1.0;
        let predicted = values.predict(before);
        values.speculate(&[vec![x.clone()], predicted, vec![self.next_reflected(&x, values)]].concat());
        self.evaluate(x, values)
    }

    fn shrink<V: SimplexValues>(&mut self, values: &mut V) -> Result<(), V::Error> {
        let best = self.vertices[0].x.clone();
        let shrunk = |vertex: &Vertex| vertex.x.iter().zip(&best).map(|(x, b)| b + SHRINK * (x - b)).collect();
        let points: Vec<Vec<f64>> = self.vertices[1..].iter().map(shrunk).collect();
        values.speculate(&points);
        for (index, x) in points.into_iter().enumerate() {
            self.vertices[index + 1] = self.evaluate(x, values)?;
        }
        self.step = Step::Shrunk;
        Ok(())
    }

    /// Mean of all vertices but the worst.
    fn centroid(&self) -> Vec<f64> {
        centroid(self.vertices[..self.vertices.len() - 1].iter().collect())
    }

    fn evaluate<V: SimplexValues>(&mut self, x: Vec<f64>, values: &mut V) -> Result<Vertex, V::Error> {
        self.evaluations += 1;
        vertex(x, self.evaluations, values)
    }

    /// The simplex with this many iterations and evaluations of earlier ones counted in.
    pub(super) fn after(self, [iterations, evaluations]: [usize; 2]) -> Simplex {
        Simplex { iterations: self.iterations + iterations, evaluations: self.evaluations + evaluations, ..self }
    }

    /// Best first; of equal ones the older first.
    fn sort(&mut self) {
        self.vertices.sort_by(|a, b| a.f.total_cmp(&b.f));
    }
}

fn vertex<V: SimplexValues>(x: Vec<f64>, evaluation: usize, values: &mut V) -> Result<Vertex, V::Error> {
    let f = values.value(&x)?;
    Ok(Vertex { x, f: if f.is_finite() { f } else { f64::INFINITY }, evaluation })
}

/// Mean of `vertices`, summed in the order of their evaluations: it does not depend on their ranks, to the bit.
fn centroid(mut vertices: Vec<&Vertex>) -> Vec<f64> {
    vertices.sort_by_key(|vertex| vertex.evaluation);
    let count = vertices.len();
    let mean = |axis: usize| vertices.iter().map(|vertex| vertex.x[axis]).sum::<f64>() / count as f64;
    (0..count).map(mean).collect()
}

/// Distance from `value` to the next larger number of its size.
fn spacing(value: f64) -> f64 {
    let size = value.abs();
    size.next_up() - size
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::convert::Infallible;

    /// All points but the vertices are worse than they.
    #[test]
    fn a_simplex_without_better_points_shrinks_to_its_best_vertex() {
        struct Vertices(Vec<Vec<f64>>);
        impl SimplexValues for Vertices {
            type Error = Infallible;
            fn value(&mut self, x: &[f64]) -> Result<f64, Infallible> {
                let known = self.0.iter().position(|vertex| vertex == x);
                Ok(known.map_or(f64::NAN, |index| index as f64))
            }
        }
        let mut vertices = Vertices(vec![vec![1.0, 2.0], vec![1.05, 2.0], vec![1.0, 2.1]]);
        let Ok(mut simplex) = Simplex::around(&[1.0, 2.0], &mut vertices);
        let Ok(()) = simplex.advance(&mut vertices);
        assert_eq!((simplex.step, simplex.evaluations), (Step::Shrunk, 3 + 2 + 2));
        assert!((simplex.size() - 0.05).abs() < 1e-12 && simplex.vertices[0].x == [1.0, 2.0]);
    }
}
