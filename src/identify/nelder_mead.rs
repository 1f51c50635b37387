//! The simplex search of Nelder and Mead, in the variant of Lagarias, Reeds, Wright and Wright (SIAM J. Optim. 9, 1998) and
//! with every choice that MATLAB's `fminsearch` makes, so that iterations and evaluations can be compared with it.
//!
//! Own code because crates choose other initial simplices and other ends: `argmin` stops on the standard deviation of
//! the objective and leaves the initial simplex to the caller.

/// Reflection, expansion, contraction and shrinkage of Lagarias et al.
const REFLECT: f64 = 1.0;
const EXPAND: f64 = 2.0;
const CONTRACT: f64 = 0.5;
const SHRINK: f64 = 0.5;

/// A corner of the initial simplex lies 5 % further along its axis, or this far where the start is zero.
const STEP: f64 = 0.05;
const STEP_FROM_ZERO: f64 = 0.00025;

/// Where a simplex finds its values.
pub trait Values {
    /// Why there are no more.
    type Error;

    /// The value at `x`; one that is not finite counts as worse than all others.
    fn value(&mut self, x: &[f64]) -> Result<f64, Self::Error>;

    /// Points of which some will be asked for next, the likeliest first: whoever has cores to spare may evaluate them
    /// meanwhile.
    fn expect(&mut self, _points: &[Vec<f64>]) {}

    /// What `simplex` will ask for next, where that can be foreseen.
    fn foresee(&self, _simplex: &Simplex) -> Vec<Vec<f64>> {
        vec![]
    }

    /// Moves a point to where it may be tried.
    fn confine(&self, _x: &mut [f64]) {}
}

/// What an iteration's need counts for in the next one, when it is guessed what that will need.
const FORGET: f64 = 0.9;

/// When a search ends; both tolerances have to be met.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Largest distance of a corner from the best one, along an axis.
    pub tol_x: f64,
    /// Largest difference of a corner's value from the best one.
    pub tol_f: f64,
    pub most_iterations: usize,
    pub most_evaluations: usize,
}

impl Limits {
    /// Those of `fminsearch` for `n` unknowns.
    pub fn of_fminsearch(n: usize) -> Limits {
        Limits { tol_x: 1e-4, tol_f: 1e-4, most_iterations: 200 * n, most_evaluations: 200 * n }
    }

    /// Whether the search has gone on for as long as it may.
    pub fn are_met(&self, simplex: &Simplex) -> bool {
        simplex.iterations >= self.most_iterations || simplex.evaluations >= self.most_evaluations
    }
}

/// What the last step did to the simplex.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// It has just been made.
    Initial,
    Reflected,
    Expanded,
    ContractedOutside,
    ContractedInside,
    Shrunk,
}

/// A simplex of n + 1 corners, the best first.
#[derive(Clone, Debug, PartialEq)]
pub struct Simplex {
    pub corners: Vec<Corner>,
    pub iterations: usize,
    pub evaluations: usize,
    /// What the last iteration did to it.
    pub step: Step,
    /// How often, of late, an iteration needed each of its second points: expanded, contracted outside, contracted inside.
    needed: [f64; 3],
}

/// A point and its value.
#[derive(Clone, Debug, PartialEq)]
pub struct Corner {
    pub x: Vec<f64>,
    pub f: f64,
    /// Number of the evaluation that it came from.
    pub born: usize,
}

impl Simplex {
    /// The start, and a point beside it along every axis; on the other side where it may not be tried on this one.
    pub fn around<V: Values>(start: &[f64], values: &mut V) -> Result<Simplex, V::Error> {
        let beside = |axis: usize| {
            let step = if start[axis] == 0.0 { STEP_FROM_ZERO } else { STEP * start[axis] };
            let mut x = start.to_vec();
            // Not start + step: this is what fminsearch computes, to the bit.
            x[axis] = if start[axis] == 0.0 { STEP_FROM_ZERO } else { (1.0 + STEP) * start[axis] };
            values.confine(&mut x);
            if x[axis] == start[axis] {
                x[axis] = start[axis] - step;
                values.confine(&mut x);
            }
            x
        };
        let points: Vec<Vec<f64>> = std::iter::once(start.to_vec()).chain((0..start.len()).map(beside)).collect();
        values.expect(&points);
        let corners =
            points.into_iter().zip(1..).map(|(x, born)| corner(x, born, values)).collect::<Result<Vec<_>, _>>()?;
        let evaluations = corners.len();
        let mut simplex = Simplex { corners, iterations: 1, evaluations, step: Step::Initial, needed: [0.0; 3] };
        simplex.sort();
        Ok(simplex)
    }

    /// Whether the simplex is as small, and its values as alike, as `limits` ask.
    pub fn has_converged(&self, limits: &Limits) -> bool {
        let best = &self.corners[0];
        let largest = best.x.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        self.spread() <= limits.tol_f.max(10.0 * spacing(best.f))
            && self.size() <= limits.tol_x.max(10.0 * spacing(largest))
    }

    /// Largest distance of a corner from the best one, along an axis.
    pub fn size(&self) -> f64 {
        let best = &self.corners[0].x;
        let distances = self.corners[1..].iter().flat_map(|other| other.x.iter().zip(best).map(|(a, b)| (a - b).abs()));
        distances.fold(0.0, f64::max)
    }

    /// Largest difference of a corner's value from the best one.
    pub fn spread(&self) -> f64 {
        let best = self.corners[0].f;
        self.corners[1..].iter().map(|other| (other.f - best).abs()).fold(0.0, f64::max)
    }

    /// One iteration: the worst corner is moved, or all but the best are drawn in.
    pub fn advance<V: Values>(&mut self, values: &mut V) -> Result<(), V::Error> {
        let before = self.clone();
        let n = self.corners.len() - 1;
        let centre = self.centre();
        let [best, second_worst, worst] = [0, n - 1, n].map(|place| self.corners[place].f);
        // Away from the worst corner by a factor, or towards it where that is negative.
        let along = |factor: f64| -> Vec<f64> {
            let worst = &self.corners[n].x;
            let mut x: Vec<f64> = centre.iter().zip(worst).map(|(c, w)| (1.0 + factor) * c - factor * w).collect();
            values.confine(&mut x);
            x
        };
        let [reflected, expanded, outside, inside] =
            [REFLECT, REFLECT * EXPAND, REFLECT * CONTRACT, -CONTRACT].map(along);
        let foreseen = values.foresee(&before);
        values.expect(&[foreseen, self.likeliest(&reflected, [&expanded, &outside, &inside], values)].concat());
        let reflected = self.try_at(reflected, values)?;
        let (moved, step) = if reflected.f < best {
            let expanded = self.try_second(0, expanded, &before, values)?;
            if expanded.f < reflected.f { (Some(expanded), Step::Expanded) } else { (Some(reflected), Step::Reflected) }
        } else if reflected.f < second_worst {
            (Some(reflected), Step::Reflected)
        } else if reflected.f < worst {
            let outside = self.try_second(1, outside, &before, values)?;
            ((outside.f <= reflected.f).then_some(outside), Step::ContractedOutside)
        } else {
            let inside = self.try_second(2, inside, &before, values)?;
            ((inside.f < worst).then_some(inside), Step::ContractedInside)
        };
        match moved {
            Some(corner) => {
                self.corners[n] = corner;
                self.step = step;
            }
            None => self.shrink(values)?,
        }
        self.sort();
        self.iterations += 1;
        Ok(())
    }

    /// The points of an iteration and the first of the next one, the likeliest to be asked for first.
    fn likeliest<V: Values>(&self, reflected: &[f64], second: [&Vec<f64>; 3], values: &V) -> Vec<Vec<f64>> {
        let mut order = [2, 0, 1];
        order.sort_by(|a, b| self.needed[*b].total_cmp(&self.needed[*a]));
        let [likely, others @ ..] = order.map(|place| second[place].clone());
        let next = self.next_reflected(reflected, values);
        [reflected.to_vec(), likely, next].into_iter().chain(others).collect()
    }

    /// The reflected point of the next iteration where this one takes `x`, and that is not the worst corner then.
    fn next_reflected<V: Values>(&self, x: &[f64], values: &V) -> Vec<f64> {
        let n = self.corners.len() - 1;
        let taken = Corner { x: x.into(), f: f64::NAN, born: self.evaluations };
        let kept: Vec<&Corner> = self.corners[..n - 1].iter().chain([&taken]).collect();
        let worst = &self.corners[n - 1].x;
        let mut next: Vec<f64> =
            centre(kept).iter().zip(worst).map(|(c, w)| (1.0 + REFLECT) * c - REFLECT * w).collect();
        values.confine(&mut next);
        next
    }

    /// The second point of an iteration that began with the simplex `before`.
    fn try_second<V: Values>(
        &mut self,
        which: usize,
        x: Vec<f64>,
        before: &Simplex,
        values: &mut V,
    ) -> Result<Corner, V::Error> {
        self.needed = self.needed.map(|often| FORGET * often);
        self.needed[which] += 1.0;
        let foreseen = values.foresee(before);
        values.expect(&[vec![x.clone()], foreseen, vec![self.next_reflected(&x, values)]].concat());
        self.try_at(x, values)
    }

    fn shrink<V: Values>(&mut self, values: &mut V) -> Result<(), V::Error> {
        let best = self.corners[0].x.clone();
        let drawn_in = |corner: &Corner| corner.x.iter().zip(&best).map(|(x, b)| b + SHRINK * (x - b)).collect();
        let points: Vec<Vec<f64>> = self.corners[1..].iter().map(drawn_in).collect();
        values.expect(&points);
        for (place, x) in points.into_iter().enumerate() {
            self.corners[place + 1] = self.try_at(x, values)?;
        }
        self.step = Step::Shrunk;
        Ok(())
    }

    /// Mean of all corners but the worst.
    fn centre(&self) -> Vec<f64> {
        centre(self.corners[..self.corners.len() - 1].iter().collect())
    }

    fn try_at<V: Values>(&mut self, x: Vec<f64>, values: &mut V) -> Result<Corner, V::Error> {
        self.evaluations += 1;
        corner(x, self.evaluations, values)
    }

    /// The same simplex as the next one of a search that has already gone on for so long.
    pub(super) fn after(self, [iterations, evaluations]: [usize; 2]) -> Simplex {
        Simplex { iterations: self.iterations + iterations, evaluations: self.evaluations + evaluations, ..self }
    }

    /// Best first; of equals the older one.
    fn sort(&mut self) {
        self.corners.sort_by(|a, b| a.f.total_cmp(&b.f));
    }
}

fn corner<V: Values>(x: Vec<f64>, born: usize, values: &mut V) -> Result<Corner, V::Error> {
    let f = values.value(&x)?;
    Ok(Corner { x, f: if f.is_finite() { f } else { f64::INFINITY }, born })
}

/// Mean of `corners`, added up in the order of their birth: so it is known to the bit before their ranks are.
fn centre(mut corners: Vec<&Corner>) -> Vec<f64> {
    corners.sort_by_key(|corner| corner.born);
    let count = corners.len();
    let mean = |axis: usize| corners.iter().map(|corner| corner.x[axis]).sum::<f64>() / count as f64;
    (0..count).map(mean).collect()
}

/// Distance from `value` to the next larger number of its size.
fn spacing(value: f64) -> f64 {
    let size = value.abs();
    size.next_up() - size
}

impl Step {
    /// One word for it.
    pub fn name(self) -> &'static str {
        match self {
            Step::Initial => "initial",
            Step::Reflected => "reflected",
            Step::Expanded => "expanded",
            Step::ContractedOutside => "contracted_outside",
            Step::ContractedInside => "contracted_inside",
            Step::Shrunk => "shrunk",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::convert::Infallible;

    struct Banana;

    impl Values for Banana {
        type Error = Infallible;
        fn value(&mut self, x: &[f64]) -> Result<f64, Infallible> {
            Ok(100.0 * (x[1] - x[0] * x[0]).powi(2) + (1.0 - x[0]).powi(2))
        }
    }

    /// The published run of `fminsearch` on Rosenbrock's function (MATLAB's documentation of `fminsearch` and `optimset`).
    #[test]
    fn rosenbrock_takes_what_fminsearch_takes() {
        let limits = Limits::of_fminsearch(2);
        let Ok(mut simplex) = Simplex::around(&[-1.2, 1.0], &mut Banana);
        while !simplex.has_converged(&limits) {
            let Ok(()) = simplex.advance(&mut Banana);
        }
        assert_eq!((simplex.iterations, simplex.evaluations), (85, 159));
        assert!((simplex.corners[0].f - 8.1777e-10).abs() < 1e-14);
    }

    /// A simplex that only shrinks: every point but the corners is worse than all of them.
    #[test]
    fn a_simplex_with_nowhere_to_go_is_drawn_in_to_its_best_corner() {
        struct Corners(Vec<Vec<f64>>);
        impl Values for Corners {
            type Error = Infallible;
            fn value(&mut self, x: &[f64]) -> Result<f64, Infallible> {
                let known = self.0.iter().position(|corner| corner == x);
                Ok(known.map_or(f64::NAN, |place| place as f64))
            }
        }
        let mut corners = Corners(vec![vec![1.0, 2.0], vec![1.05, 2.0], vec![1.0, 2.1]]);
        let Ok(mut simplex) = Simplex::around(&[1.0, 2.0], &mut corners);
        let Ok(()) = simplex.advance(&mut corners);
        assert_eq!((simplex.step, simplex.evaluations), (Step::Shrunk, 3 + 2 + 2));
        assert!((simplex.size() - 0.05).abs() < 1e-12 && simplex.corners[0].x == [1.0, 2.0]);
    }
}
