//! Damped least squares (Levenberg 1944, Marquardt 1963; Moré's implementation in MINPACK) on a vector of residuals.
//!
//! The Jacobian is made of differences, evaluated all at once. A trial that fails counts as a step that is far too long: the
//! search draws in its trust region. Bounds are kept by transform, see [`Bounds`](super::Bounds).

use std::cell::RefCell;

use levenberg_marquardt::{LeastSquaresProblem, LevenbergMarquardt, TerminationReason};
// The crate's own version of nalgebra, in which its problems are written.
use nalgebra_of_lm::{DMatrix, DVector, Dyn, Owned};

use super::objective::Answer;
use super::search::{Course, Ended, Iteration, SearchError, limit};

/// What a failed trial counts as, over the norm of the residuals at the start.
const WORST: f64 = 1e3;

/// Searches from `start`.
pub(super) fn search(start: &[f64], course: Course<'_, '_, '_>) -> Result<Ended, SearchError> {
    let search = course.search;
    let mut start = start.to_vec();
    search.bounds.inwards(&mut start);
    let first = residuals(course.trials.at_start(&start)?)?;
    if first.len() < start.len() {
        return Err(SearchError::TooFew { found: first.len(), unknowns: start.len() });
    }
    let patience = search.most_evaluations.div_ceil(start.len() + 1);
    let method = LevenbergMarquardt::new().with_ftol(search.tol_f).with_xtol(search.tol_x).with_patience(patience);
    let problem = Problem {
        u: DVector::from_vec(search.bounds.u_of(&start)),
        worst: WORST * norm(&first),
        count: first.len(),
        state: RefCell::new(State {
            course,
            best: (start, f64::INFINITY),
            here: vec![],
            iterations: 0,
            history: vec![],
            end: None,
        }),
    };
    let (problem, report) = method.minimize(problem);
    let mut state = problem.state.into_inner();
    if let Some(End::Error(error)) = state.end {
        return Err(error);
    }
    state.iterations += 1;
    state.hear("final");
    let State { course, best: (x, f), iterations, history, end, .. } = state;
    let (converged, reason) = match end {
        Some(_) => (false, limit(iterations, search).to_owned()),
        None => (report.termination.was_successful(), words(&report.termination)),
    };
    let evaluations = course.trials.evaluations();
    Ok(Ended { x, f, iterations, evaluations, converged, reason, size: None, history })
}

/// Residuals as a function of u, which stands for a point within the bounds.
struct Problem<'s, 'c, 'a> {
    u: DVector<f64>,
    /// Norm of what a failed trial counts as.
    worst: f64,
    /// Residuals at every point.
    count: usize,
    /// The crate asks through shared references.
    state: RefCell<State<'s, 'c, 'a>>,
}

struct State<'s, 'c, 'a> {
    course: Course<'s, 'c, 'a>,
    best: (Vec<f64>, f64),
    /// Residuals of the last trial that had some.
    here: Vec<f64>,
    iterations: usize,
    history: Vec<Iteration>,
    end: Option<End>,
}

/// Why the crate was stopped on its way.
enum End {
    Limit,
    Error(SearchError),
}

impl State<'_, '_, '_> {
    fn hear(&mut self, step: &'static str) {
        let (x, f) = self.best.clone();
        let (iteration, evaluations) = (self.iterations, self.course.trials.evaluations());
        let start = self.course.number;
        let iteration = Iteration { start, iteration, evaluations, x, f, size: None, spread: None, step };
        (self.course.listener)(&iteration);
        self.history.push(iteration);
    }
}

impl Problem<'_, '_, '_> {
    fn x_of(&self, u: &DVector<f64>) -> Vec<f64> {
        self.state.borrow().course.search.bounds.x_of(u.as_slice())
    }

    /// Steps of u for the differences, into the half of its range where there is room for them.
    fn steps(&self) -> Vec<f64> {
        let difference = self.state.borrow().course.search.difference;
        self.u.iter().map(|u| if *u == 0.0 { difference } else { -difference * u }).collect()
    }

    /// The points of the differences around the present one.
    fn beside(&self) -> Vec<Vec<f64>> {
        let moved = |(place, step): (usize, f64)| {
            let mut u = self.u.clone();
            u[place] += step;
            self.x_of(&u)
        };
        self.steps().into_iter().enumerate().map(moved).collect()
    }

    fn checked(&self, x: &[f64], answer: Option<Answer>) -> Result<Option<Vec<f64>>, SearchError> {
        let found = answer.map(residuals).transpose()?;
        match &found {
            Some(found) if found.len() != self.count => {
                let expected = self.count;
                Err(SearchError::Residuals { x: x.into(), found: found.len(), expected })
            }
            _ => Ok(found),
        }
    }

    fn try_residuals(&self) -> Result<DVector<f64>, SearchError> {
        let x = self.x_of(&self.u);
        let answer = {
            let state = self.state.borrow();
            let mut points = vec![x.clone()];
            points.extend(self.beside());
            // The Jacobian is wanted next where the step is taken, which most are.
            state.course.trials.expect(&points);
            state.course.trials.answer(&x)?
        };
        let Some(found) = self.checked(&x, answer)? else {
            return Ok(DVector::from_element(self.count, self.worst / (self.count as f64).sqrt()));
        };
        let f = norm(&found);
        let mut state = self.state.borrow_mut();
        if f < state.best.1 {
            state.best = (x, f);
        }
        state.here.clone_from(&found);
        Ok(DVector::from_vec(found))
    }

    /// Differences from the present point, which is the last that had residuals; to the other side where this one fails.
    fn try_jacobian(&self) -> Result<DMatrix<f64>, SearchError> {
        let points = self.beside();
        let here = self.state.borrow().here.clone();
        let found = self.state.borrow().course.trials.answers(&points)?;
        let mut jacobian = DMatrix::zeros(self.count, self.u.len());
        for (place, answer) in found.into_iter().enumerate() {
            let step = self.steps()[place];
            let (there, step) = match self.checked(&points[place], answer)? {
                Some(there) => (there, step),
                None => (self.behind(place, step)?, -step),
            };
            for (row, (there, here)) in there.iter().zip(&here).enumerate() {
                jacobian[(row, place)] = (there - here) / step;
            }
        }
        Ok(jacobian)
    }

    fn behind(&self, place: usize, step: f64) -> Result<Vec<f64>, SearchError> {
        let mut u = self.u.clone();
        u[place] -= step;
        let x = self.x_of(&u);
        let answer = self.state.borrow().course.trials.answer(&x)?;
        let failed = || SearchError::Failed {
            x: x.clone(),
            cause: "it is failing all around, there is no slope".into(),
            numerical: false,
        };
        self.checked(&x, answer)?.ok_or_else(failed)
    }

    /// The value, unless the search is to end; then the crate is told that there is none.
    fn unless_over<T>(&self, value: Result<T, SearchError>) -> Option<T> {
        let mut state = self.state.borrow_mut();
        match value {
            Ok(_) if state.course.trials.evaluations() > state.course.search.most_evaluations => {
                state.end = Some(End::Limit);
                None
            }
            Ok(value) => Some(value),
            Err(error) => {
                state.end = Some(End::Error(error));
                None
            }
        }
    }
}

impl LeastSquaresProblem<f64, Dyn, Dyn> for Problem<'_, '_, '_> {
    type ResidualStorage = Owned<f64, Dyn>;
    type JacobianStorage = Owned<f64, Dyn, Dyn>;
    type ParameterStorage = Owned<f64, Dyn>;

    fn set_params(&mut self, u: &DVector<f64>) {
        self.u.copy_from(u);
    }

    fn params(&self) -> DVector<f64> {
        self.u.clone()
    }

    fn residuals(&self) -> Option<DVector<f64>> {
        self.unless_over(self.try_residuals())
    }

    fn jacobian(&self) -> Option<DMatrix<f64>> {
        let over = {
            let mut state = self.state.borrow_mut();
            state.iterations += 1;
            let step = if state.iterations == 1 { "initial" } else { "step" };
            state.hear(step);
            state.iterations >= state.course.search.most_iterations
        };
        if over {
            self.state.borrow_mut().end = Some(End::Limit);
            return None;
        }
        self.unless_over(self.try_jacobian())
    }
}

fn residuals(answer: Answer) -> Result<Vec<f64>, SearchError> {
    match answer {
        Answer::Residuals(residuals) => Ok(residuals),
        Answer::Value(_) => Err(SearchError::NotResiduals),
    }
}

fn norm(residuals: &[f64]) -> f64 {
    residuals.iter().map(|r| r * r).sum::<f64>().sqrt()
}

fn words(reason: &TerminationReason) -> String {
    match reason {
        TerminationReason::ResidualsZero => "the residuals are zero".into(),
        TerminationReason::Orthogonal => "the residuals have no part along the Jacobian".into(),
        TerminationReason::Converged { ftol: true, .. } => {
            "the sum of squares changes by less than tol_f of itself".into()
        }
        TerminationReason::Converged { .. } => "x changes by less than tol_x of itself".into(),
        TerminationReason::NoImprovementPossible(what) => format!("no improvement is possible ({what})"),
        TerminationReason::LostPatience => "max_evaluations was reached".into(),
        TerminationReason::Numerical(what) => format!("{what} is not a number"),
        TerminationReason::User(what) | TerminationReason::WrongDimensions(what) => format!("the {what} cannot be had"),
        TerminationReason::NoParameters | TerminationReason::NoResiduals => "there is nothing to search".into(),
    }
}
