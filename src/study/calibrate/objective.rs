//! The objective of a calibration: independent residuals of unit variance of all tests, and of what is known before.

use super::outcome::Outcomes;
use super::plan::{Plan, Stage};
use super::recorded_test::{Signal, Test};
use crate::identify::{Evaluation, FatalError, Objective, Trial};
use crate::script::{HostResult, Session, is_numerical, refuse, thrown};
use base::cancellation::Cancellation;
use lab::signal::Series;
use rhai::EvalAltResult;

/// The residuals of all tests with values of the unknowns.
pub(super) struct CalibrationObjective<'a> {
    pub(super) plan: &'a Plan,
    /// What is run of the tests in this stage.
    pub(super) stage: Vec<Stage>,
    /// The model's error, as a share of each signal.
    pub(super) share: f64,
    /// Whether that is taken as independent from bin to bin: the differences themselves count, which vary more smoothly with
    /// the unknowns than those between neighbouring bins, and lead to the neighbourhood of the minimum.
    pub(super) is_plain: bool,
    pub(super) session: Session,
}

impl<'a> CalibrationObjective<'a> {
    /// Of all tests as they are.
    pub(super) fn new(plan: &'a Plan, share: f64, session: &Session) -> CalibrationObjective<'a> {
        CalibrationObjective { plan, stage: plan.last_stage(), share, is_plain: false, session: session.clone() }
    }

    /// The residuals of a test, each signal's after the other's, by its simulated signals.
    fn residuals_of(&self, test: &Test, simulated: &[Series]) -> Result<Vec<f64>, String> {
        let mut residuals = Vec::new();
        for (signal, simulated) in test.signals.iter().zip(simulated) {
            let own = signal.residuals(simulated, self.share, self.is_plain)?.into_iter();
            residuals.extend(own.map(|residual| (test.weight * test.of_signals).sqrt() * residual));
        }
        Ok(residuals)
    }

    /// The signals of a test with these values, and what it demands of its film where it has outcomes. Both are of one run, whose
    /// film does not break then: specimens differ in when it does.
    pub(super) fn simulated(&self, test: usize, x: &[f64], session: &Session) -> HostResult<(Vec<Series>, Vec<f64>)> {
        let (own, changes) = (&self.plan.tests[test], self.plan.changes(test, x));
        let Stage { study, outcomes } = &self.stage[test];
        let Some(outcomes) = outcomes else {
            return Ok((own.simulated(&study.with(changes, session)?, session)?, Vec::new()));
        };
        let (run, demands) = outcomes.run(changes, !own.signals.is_empty(), session)?;
        let signals = run.iter().flat_map(|run| own.signals.iter().map(move |signal| signal.simulated(run)));
        Ok((signals.collect::<HostResult<_>>()?, demands))
    }

    fn evaluated(&self, x: &[f64], session: &Session) -> Evaluation {
        let mut residuals = Vec::new();
        // A test that is left out has no weight; such searches are compared by their results alone.
        let is_whole = self.plan.tests.iter().all(|test| test.weight > 0.0);
        for (test, own) in self.plan.tests.iter().enumerate().filter(|(_, own)| own.weight > 0.0) {
            let (simulated, demands) = match self.simulated(test, x, session) {
                Ok(found) => found,
                Err(error) => return self.failed(own, error),
            };
            if let Some(rupture) = self.plan.rupture_in(session) {
                return Evaluation::failed(rupture);
            }
            for (signal, simulated) in own.signals.iter().zip(&simulated).filter(|_| is_whole) {
                session.add_comparison(|| signal.compared(simulated));
            }
            match self.residuals_of(own, &simulated) {
                Ok(own) => residuals.extend(own),
                Err(cause) => return Evaluation::failed(format!("{}: {cause}", own.name)),
            }
            if let Some(outcomes) = &own.outcomes {
                let found = outcomes.residuals(&demands, &self.plan.break_unknowns(test).with_values(x)).into_iter();
                residuals.extend(found.map(|residual| own.weight.sqrt() * residual));
            }
        }
        residuals.extend(self.of_priors(x));
        residuals.into()
    }

    fn failed(&self, test: &Test, error: Box<EvalAltResult>) -> Evaluation {
        let numerical = is_numerical(&error);
        match error.unwrap_inner() {
            EvalAltResult::ErrorRuntime(value, _) => {
                Evaluation::Failed { cause: format!("{}: {}", test.name, thrown(value)), numerical }
            }
            _ => Evaluation::Fatal(FatalError::new(error.to_string())),
        }
    }

    /// One residual of each unknown with a distribution.
    fn of_priors(&self, x: &[f64]) -> impl Iterator<Item = f64> {
        let residual = |(unknown, value): (_, &f64)| self.plan.parameter_of(unknown).prior_residual(*value);
        self.plan.unknowns.iter().zip(x).filter_map(residual)
    }

    /// Where the residuals of each test begin, and where all end.
    pub(super) fn ends(&self) -> Vec<usize> {
        let mut ends = vec![0];
        for (place, test) in self.plan.tests.iter().enumerate() {
            let outcomes = test.outcomes.as_ref().map_or(0, Outcomes::residual_count);
            ends.push(ends[place] + self.compared(place) + outcomes);
        }
        ends
    }

    /// Number of differences of a test's signals.
    pub(super) fn compared(&self, test: usize) -> usize {
        self.plan.tests[test].signals.iter().map(Signal::count).sum()
    }
}

impl Objective for CalibrationObjective<'_> {
    fn trial(&self, x: &[f64], cancellation: &Cancellation) -> Trial {
        // Once the study is told to stop, no trial begins; what runs ends.
        if self.session.is_stopped() {
            return Evaluation::Fatal(FatalError::new(refuse("the study was stopped").to_string())).into();
        }
        let session = self.session.with_trial(cancellation);
        let evaluation = self.evaluated(x, &session);
        Trial { evaluation, compared: session.trial().compared }
    }
}
