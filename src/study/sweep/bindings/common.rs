//! Parts in common of the functions for scripts: the sweep of a study.

use serde_json::Value;

use crate::evaluate::Evaluations;
use crate::scenario_functions::Study;
use crate::script::{HostResult, Options, Session, check_stop, refuse, to_json};
use crate::sweep::work::{Done, Stop, Work};
use crate::sweep::{Sweep, SweepError, SweepResults};
use scene::scenario::{Assignment, Document};

/// The surroundings of a script's sweeps: kept evaluations and the session.
pub(super) struct Host<'a> {
    pub(super) evaluations: &'a Evaluations,
    pub(super) session: Session,
}

impl Host<'_> {
    /// The results of a sweep.
    pub(super) fn results(&self, sweep: &Sweep) -> HostResult<SweepResults> {
        let done = self.done(sweep)?;
        let found = SweepResults::from_evaluations(sweep, &done, self.evaluations).map_err(refuse)?;
        self.session.count_runs(&found.run_findings());
        Ok(found)
    }

    fn done(&self, sweep: &Sweep) -> HostResult<Done> {
        let (requested, given_up) = (self.session.stop().clone(), self.session.cancellation().clone());
        let stop = Stop { requested, given_up, deadline: None };
        let work = Work { sweep, evaluations: self.evaluations, waits: true, stop: &stop, gather: false };
        let done = work.run(&|_| {}).map_err(refuse)?;
        if done.len() < sweep.len() {
            check_stop(&self.session)?;
            return Err(refuse("the sweep was cancelled"));
        }
        Ok(done)
    }
}

/// The scenario of a study with what the options vary in place of what it varies itself.
pub(super) fn varied(study: &Study, options: &Options<'_>) -> HostResult<Document> {
    let mut changes = vec![];
    if let Some(keys) = options.map.get("vary") {
        changes.push(Assignment::unset("variation", "vary"));
        changes.push(assignment("variation", &to_json(keys)?)?);
        if study.document().find("variation").is_none() {
            changes.remove(0);
        }
    }
    Ok(study.document().with(&changes))
}

pub(super) fn assignment(path: &str, value: &Value) -> HostResult<Assignment> {
    let value = toml::Value::try_from(value).map_err(|error| refuse(format!("{path}: {error}")))?;
    Assignment::from_value(path, &value, "options").map_err(|mistakes| refused(SweepError::Scenario(mistakes)))
}

pub(super) fn refused(error: SweepError) -> Box<rhai::EvalAltResult> {
    refuse(match error {
        SweepError::Scenario(mistakes) => crate::sweep::refusal(&mistakes, &[]),
        SweepError::NothingVaries => "nothing varies: give `vary`, or a scenario with [variation]".into(),
        SweepError::Points(mistake) => mistake.message,
        SweepError::Prepare(error) => error.to_string(),
    })
}

/// The whole number in an option.
pub(super) fn whole(options: &Options<'_>, name: &str, default: usize) -> HostResult<usize> {
    let Some(value) = options.map.get(name) else { return Ok(default) };
    let number = value.as_int().ok().and_then(|number| usize::try_from(number).ok()).filter(|number| *number > 0);
    number.ok_or_else(|| refuse(format!("expected a whole number above zero as {name}, found {value}")))
}
