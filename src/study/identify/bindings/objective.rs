//! A closure of a script as an objective.

use std::sync::Mutex;

use rhai::{Array, Dynamic, Engine, EvalAltResult, FnPtr, GlobalRuntimeState, Map, NativeCallContext, Position};
use thiserror::Error;

use crate::identify::objective::{Evaluation, FatalError, Objective, ObjectiveValue, Trial};
use crate::script::{HostResult, Session, catch_panics, check_stop, is_numerical, key_mistake, number, refuse, thrown};
use base::cancellation::Cancellation;
use lab::signal::Series;

/// Operations of the interpreter that one trial may take; a search limits the number of its trials.
const OPERATIONS: u64 = 1_000_000;

/// The treatment of a run with a ruptured film.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum OnRupture {
    /// As a failed trial.
    #[default]
    Fail,
    /// As any other run, for tests that rupture.
    Keep,
}

/// An error in the script during a trial.
#[derive(Debug, Error)]
#[error("{text}")]
pub(super) struct ScriptError {
    text: String,
    /// The error with its position, until it is taken.
    error: Mutex<Option<Box<EvalAltResult>>>,
}

impl ScriptError {
    /// The error with its position; none the second time.
    pub(super) fn take(&self) -> Option<Box<EvalAltResult>> {
        base::lock(&self.error).take()
    }
}

impl From<Box<EvalAltResult>> for ScriptError {
    fn from(error: Box<EvalAltResult>) -> ScriptError {
        ScriptError { text: error.to_string(), error: Mutex::new(Some(error)) }
    }
}

/// A closure of a script, callable from several threads.
///
/// Each trial gets a copy of what the closure captures, as it was when the search began; changes are lost after the
/// trial. No trial depends on another.
pub(super) struct ScriptObjective<'c> {
    engine: &'c Engine,
    name: &'c str,
    global: GlobalRuntimeState,
    position: Position,
    session: Session,
    on_rupture: OnRupture,
    call: FnPtr,
    /// The first trial that failed by a mistake in a key: its text, and the error with its position.
    key_mistake: Mutex<Option<(String, Box<EvalAltResult>)>>,
}

impl<'c> ScriptObjective<'c> {
    pub(super) fn new(
        context: &'c NativeCallContext,
        session: Session,
        on_rupture: OnRupture,
        call: &FnPtr,
    ) -> ScriptObjective<'c> {
        let engine = context.engine();
        let mut global = context.global_runtime_state().clone();
        global.num_operations = engine.max_operations().saturating_sub(OPERATIONS);
        ScriptObjective {
            engine,
            name: context.fn_name(),
            global,
            position: context.call_position(),
            session,
            on_rupture,
            call: unshared(call),
            key_mistake: Mutex::default(),
        }
    }

    /// The mistake in a key of a map that is the cause of a failed trial, with its position; none the second time.
    pub(super) fn take_key_mistake(&self, cause: &str) -> Option<Box<EvalAltResult>> {
        let mut first = base::lock(&self.key_mistake);
        first.take_if(|(text, _)| text == cause).map(|(_, error)| error)
    }

    fn call(&self, x: &[f64], session: &Session) -> HostResult<Dynamic> {
        let mut global = self.global.clone();
        global.tag = Dynamic::from(session.clone());
        let context = NativeCallContext::new_with_all_fields(self.engine, self.name, None, &global, self.position);
        let x: Array = x.iter().map(|x| Dynamic::from(*x)).collect();
        let call = || unshared(&self.call).call_raw(&context, None, [Dynamic::from(x)]);
        session.budget().count(|| catch_panics(session.cancellation(), || Position::NONE, call))
    }

    fn evaluation(&self, returned: HostResult<Dynamic>, session: &Session) -> Evaluation {
        let returned = match returned {
            Ok(returned) => returned,
            Err(error) => return self.failure(error),
        };
        match (value(&returned), session.trial().ruptures.first()) {
            (Err(error), _) => fatal(error),
            (Ok(_), Some(rupture)) if self.on_rupture == OnRupture::Fail => Evaluation::failed(rupture),
            (Ok(value), _) => value.into(),
        }
    }

    /// A thrown value is a failed trial, any other error one of the script.
    fn failure(&self, error: Box<EvalAltResult>) -> Evaluation {
        let EvalAltResult::ErrorRuntime(value, _) = error.unwrap_inner() else { return fatal(error) };
        let failed = Evaluation::Failed { cause: thrown(value), numerical: is_numerical(&error) };
        if let Some(text) = key_mistake(&error) {
            base::lock(&self.key_mistake).get_or_insert((text, error));
        }
        failed
    }
}

impl Objective for ScriptObjective<'_> {
    fn trial(&self, x: &[f64], cancellation: &Cancellation) -> Trial {
        if let Err(stopped) = check_stop(&self.session) {
            return fatal(stopped).into();
        }
        let session = self.session.with_trial(&cancellation.within(self.session.cancellation()));
        let returned = self.call(x, &session);
        if self.session.cancellation().is_cancelled() {
            // Whatever came of it: a run that was given up is not the failure of this point.
            return fatal(refuse("the study was stopped")).into();
        }
        let evaluation = self.evaluation(returned, &session);
        Trial { evaluation, compared: session.trial().compared }
    }
}

fn fatal(error: Box<EvalAltResult>) -> Evaluation {
    Evaluation::Fatal(FatalError::new(ScriptError::from(error)))
}

/// A copy of the function that shares nothing it captures.
fn unshared(call: &FnPtr) -> FnPtr {
    let mut own = call.clone();
    for captured in own.iter_curry_mut() {
        *captured = copied(captured);
    }
    own
}

fn copied(value: &Dynamic) -> Dynamic {
    let value = value.flatten_clone();
    if let Some(list) = value.read_lock::<Array>() {
        return list.iter().map(copied).collect::<Array>().into();
    }
    if let Some(map) = value.read_lock::<Map>() {
        return map.iter().map(|(key, value)| (key.clone(), copied(value))).collect::<Map>().into();
    }
    if let Some(call) = value.read_lock::<FnPtr>() {
        return Dynamic::from(unshared(&call));
    }
    value
}

fn value(returned: &Dynamic) -> HostResult<ObjectiveValue> {
    if let Some(series) = returned.read_lock::<Series>() {
        return Ok(ObjectiveValue::Residuals(series.values().to_vec()));
    }
    if let Some(list) = returned.read_lock::<Array>() {
        let values = list.iter().map(|item| number(item, "a residual")).collect::<HostResult<Vec<f64>>>();
        return values.map(ObjectiveValue::Residuals);
    }
    let other = || refuse!("an objective gives a number, a signal or a list, not {}", returned.type_name());
    number(returned, "the objective").map(ObjectiveValue::Scalar).map_err(|_| other())
}
