//! A fit with one parameter fixed, from the linearization at an estimate.
//!
//! The other parameters start at the minimum of the linear model. Damped least squares follow whose Jacobian is that of
//! the estimate with Broyden's updates (secant version of Levenberg–Marquardt: Madsen, Nielsen and Tingleff, *Methods
//! for Non-Linear Least Squares Problems*, 2004; Broyden 1965). A fit takes two or three trials.

use nalgebra::{DMatrix, DVector};

use crate::identify::options::Search;
use lab::confidence::Confidence;
use lab::confidence::Linearization;

/// Limit of trials of one fit.
const MAX_TRIALS: usize = 6;

/// Predicted improvement, over the rise above the estimate or its threshold, at which a fit ends.
pub(super) const NEGLIGIBLE: f64 = 0.01;

/// Damping over the curvature: initially, at least after a trial without improvement, and its factors after a trial
/// with and without improvement.
const INITIAL_DAMPING: f64 = 1e-8;
const MIN_DAMPING: f64 = 1e-2;
const DECREASE: f64 = 0.1;
const INCREASE: f64 = 10.0;

/// The fit of all parameters but one, which is fixed.
pub(super) struct ConstrainedFit {
    /// The fixed parameter.
    fixed: usize,
    scale: Vec<f64>,
    /// The point that the next Broyden update starts from: the estimate at first.
    from: (Vec<f64>, DVector<f64>),
    /// The best point so far and its residuals.
    best: Option<(Vec<f64>, DVector<f64>)>,
    jacobian: DMatrix<f64>,
    damping: f64,
    trials: usize,
    /// The first trial.
    first: Vec<f64>,
    /// The next trial; none where the fit has ended.
    pub(super) next: Option<Vec<f64>>,
    /// The second trial where the first fails.
    fallback: Option<Vec<f64>>,
    /// ‖r‖² of the estimate, and its rise to the threshold.
    least: f64,
    rise: f64,
}

impl ConstrainedFit {
    /// The fit with parameter `fixed` at `value`. It starts where the linear model has its minimum.
    pub(super) fn new(
        search: &Search,
        linearization: &Linearization,
        confidence: &Confidence,
        fixed: usize,
        value: f64,
    ) -> ConstrainedFit {
        let mut fit = ConstrainedFit {
            fixed,
            scale: linearization.x.iter().map(|x| if *x == 0.0 { 1.0 } else { x.abs() }).collect(),
            from: (linearization.x.clone(), linearization.residuals.clone()),
            best: None,
            jacobian: linearization.jacobian.clone(),
            damping: INITIAL_DAMPING,
            trials: 0,
            first: vec![],
            next: None,
            fallback: None,
            least: linearization.residuals.norm_squared(),
            rise: rise(confidence, fixed),
        };
        let mut beside = linearization.x.clone();
        beside[fixed] = value;
        let moved = linearization.jacobian.column(fixed) * (value - linearization.x[fixed]);
        // The estimate is a minimum: its own residuals have no gradient.
        let mut start = fit.stepped(search, &beside, &moved).unwrap_or_else(|| beside.clone());
        start[fixed] = value;
        fit.fallback = Some(beside).filter(|beside| *beside != start);
        fit.first.clone_from(&start);
        fit.next = Some(start);
        fit
    }

    /// Updates the fit with the residuals at `x`, none where the trial failed, and determines the next trial.
    pub(super) fn update(&mut self, search: &Search, x: Vec<f64>, residuals: Option<DVector<f64>>) {
        self.trials += 1;
        let improves = |found: &DVector<f64>| {
            self.best.as_ref().is_none_or(|(_, best)| found.norm_squared() < best.norm_squared())
        };
        match residuals {
            Some(found) => {
                let better = improves(&found);
                // Also without an improvement: the secant corrects the slope that misled the step.
                self.correct(&x, &found);
                self.damp(better);
                if better {
                    self.from = (x.clone(), found.clone());
                    self.best = Some((x, found));
                }
            }
            None => self.damp(false),
        }
        self.next = match &self.best {
            None => self.fallback.take(),
            Some(_) if self.trials >= MAX_TRIALS => None,
            Some((x, residuals)) => self.worthwhile(search, x, residuals),
        };
    }

    fn damp(&mut self, better: bool) {
        self.damping = if better { DECREASE * self.damping } else { (INCREASE * self.damping).max(MIN_DAMPING) };
    }

    /// Broyden's update: the smallest change of the Jacobian with which the secant condition holds.
    fn correct(&mut self, x: &[f64], found: &DVector<f64>) {
        let step: Vec<f64> = x.iter().zip(&self.from.0).zip(&self.scale).map(|((x, from), s)| (x - from) / s).collect();
        let square: f64 = step.iter().map(|step| step * step).sum();
        if square == 0.0 {
            return;
        }
        let mut missed = found - &self.from.1;
        for (index, step) in step.iter().enumerate() {
            missed.axpy(-step * self.scale[index], &self.jacobian.column(index), 1.0);
        }
        for (index, step) in step.iter().enumerate() {
            let change = step / square / self.scale[index];
            self.jacobian.column_mut(index).axpy(change, &missed, 1.0);
        }
    }

    /// The next trial if the linear model predicts more than a negligible improvement.
    fn worthwhile(&self, search: &Search, x: &[f64], residuals: &DVector<f64>) -> Option<Vec<f64>> {
        let next = self.stepped(search, x, residuals)?;
        let mut there = residuals.clone();
        for (index, (next, x)) in next.iter().zip(x).enumerate() {
            there.axpy(next - x, &self.jacobian.column(index), 1.0);
        }
        let now = residuals.norm_squared();
        let gain = now - there.norm_squared();
        (gain > NEGLIGIBLE * self.rise.max(now - self.least)).then_some(next)
    }

    /// A damped step of all but the fixed parameter, projected onto the bounds; none where it leads to the same point.
    fn stepped(&self, search: &Search, x: &[f64], residuals: &DVector<f64>) -> Option<Vec<f64>> {
        let free: Vec<usize> = (0..x.len()).filter(|index| *index != self.fixed).collect();
        let column = |index: usize| self.jacobian.column(index) * self.scale[index];
        let columns: Vec<DVector<f64>> = free.iter().map(|index| column(*index)).collect();
        let mut normal = DMatrix::from_fn(free.len(), free.len(), |i, j| columns[i].dot(&columns[j]));
        // A parameter without effect leaves a zero on the diagonal, which no factor damps.
        let least = f64::EPSILON * normal.diagonal().amax();
        for index in 0..free.len() {
            normal[(index, index)] = normal[(index, index)] * (1.0 + self.damping) + least;
        }
        let slope = DVector::from_iterator(free.len(), columns.iter().map(|column| -column.dot(residuals)));
        let step = normal.cholesky()?.solve(&slope);
        let mut next = x.to_vec();
        for (index, step) in free.iter().zip(&step) {
            next[*index] += step * self.scale[*index];
        }
        search.bounds.project(&mut next);
        (next != x && next.iter().all(|next| next.is_finite())).then_some(next)
    }

    /// The fixed parameter.
    pub(super) fn fixed(&self) -> usize {
        self.fixed
    }

    /// The best point and its ‖r‖; the first trial and none where all trials failed.
    pub(super) fn result(&self) -> (&[f64], Option<f64>) {
        match &self.best {
            Some((x, residuals)) => (x, Some(residuals.norm())),
            None => (&self.first, None),
        }
    }
}

/// Rise of ‖r‖² from the estimate to the ends of the interval of a parameter.
pub(super) fn rise(confidence: &Confidence, index: usize) -> f64 {
    confidence.quantile.powi(2) * confidence.increases[index]
}
