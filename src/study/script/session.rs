//! The state that host functions share while one script runs: the recordings that it read, and the trial they are called in.

use std::any::Any;
use std::cell::Cell;
use std::collections::BTreeMap;
use std::panic::{self, AssertUnwindSafe};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};

use rayon::prelude::*;
use rhai::{Dynamic, Engine, EvalAltResult, NativeCallContext, Position};

use super::module::{Programs, ShippedModule};
use super::{Compared, HostResult, OutputCollector, RunFindings};
use base::budget::Budget;
use base::cancellation::Cancellation;
use base::finding::Finding;

/// Most comparisons of one trial that are stored for plots.
const MOST_COMPARED: usize = 12;

/// The fields of the maps that host values have under one name.
#[derive(Clone, Copy, Debug)]
pub struct Fields {
    /// The name of the map, as in `run.<map>.<field>`.
    pub map: &'static str,
    /// The names of its fields.
    pub names: &'static [&'static str],
}

/// Options of a host function, or of the maps within one of them.
#[derive(Clone, Copy, Debug)]
pub struct CallOptions {
    /// What has the options, as messages name it.
    pub of: &'static str,
    /// The function, whose last argument is the map.
    pub function: &'static str,
    /// The option whose own maps have these options: the items of its list, or the values of its map.
    pub inside: Option<&'static str>,
    /// The names of the options.
    pub names: fn() -> Vec<&'static str>,
}

/// State that host functions share while a script runs; each engine has one, as its tag. Cheap to clone.
#[derive(Clone, Default)]
pub struct Session {
    recordings: Arc<Mutex<BTreeMap<PathBuf, bool>>>,
    trial: Option<Arc<Mutex<Trial>>>,
    cancellation: Cancellation,
    stop: Cancellation,
    budget: Budget,
    last_call: Arc<Mutex<Position>>,
    fields: Arc<Mutex<Vec<Fields>>>,
    options: Arc<Mutex<Vec<CallOptions>>>,
    output: Arc<Mutex<Option<OutputCollector>>>,
    run_findings: Arc<Mutex<RunFindings>>,
    modules: Arc<Mutex<(Vec<ShippedModule>, bool)>>,
    programs: Programs,
}

/// The record that host functions keep of one evaluation of an objective.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Trial {
    /// Scenarios whose film ruptured, each with the time.
    pub ruptures: Vec<String>,
    /// Curves that were compared with references, for plots.
    pub compared: Vec<Compared>,
}

impl Session {
    /// The session of the script that calls a host function.
    pub fn from_context(context: &NativeCallContext) -> Session {
        let session = context.tag().and_then(Session::in_tag).unwrap_or_default();
        *base::lock(&session.last_call) = context.call_position();
        session
    }

    /// The session of the scripts that `engine` runs.
    pub fn of_engine(engine: &Engine) -> Session {
        Session::in_tag(engine.default_tag()).unwrap_or_default()
    }

    fn in_tag(tag: &Dynamic) -> Option<Session> {
        tag.read_lock::<Session>().map(|session| session.clone())
    }

    /// Findings of the host are reported in the output of `collector` from now on.
    pub fn report_to(&self, collector: &OutputCollector) {
        *base::lock(&self.output) = Some(collector.clone());
    }

    /// Reports findings of a scenario or of recordings that the script reads, each kind once of a key or of files. Those of
    /// the trials of a search are left out: their number and order depend on the threads.
    pub fn report(&self, findings: impl IntoIterator<Item = Finding>) {
        let output = base::lock(&self.output).clone();
        if let Some(output) = output.filter(|_| !self.is_trial()) {
            findings.into_iter().for_each(|finding| output.report_once(finding));
        }
    }

    /// Counts runs with the codes of their findings. Those of the trials of a search are left out.
    pub fn count_runs(&self, found: &RunFindings) {
        if !self.is_trial() {
            base::lock(&self.run_findings).add(found);
        }
    }

    /// How often the runs so far had findings.
    pub fn run_findings(&self) -> RunFindings {
        base::lock(&self.run_findings).clone()
    }

    /// Declares the fields of maps of the host, which scripts are checked against before they run.
    pub fn declare(&self, fields: Fields) {
        base::lock(&self.fields).push(fields);
    }

    /// The declared fields.
    pub fn fields(&self) -> Vec<Fields> {
        base::lock(&self.fields).clone()
    }

    /// Declares the options of a function of the host, which scripts are checked against before they run.
    pub fn declare_options(&self, options: CallOptions) {
        base::lock(&self.options).push(options);
    }

    /// The declared options.
    pub(super) fn call_options(&self) -> Vec<CallOptions> {
        base::lock(&self.options).clone()
    }

    /// Offers these modules to scripts.
    pub fn ship(&self, modules: &'static [ShippedModule]) {
        base::lock(&self.modules).0.extend(modules);
    }

    /// Lets scripts import modules in files of their folder.
    pub fn read_modules(&self) {
        base::lock(&self.modules).1 = true;
    }

    /// The modules that are shipped, and whether those in files are read.
    pub(super) fn modules(&self) -> (Vec<ShippedModule>, bool) {
        base::lock(&self.modules).clone()
    }

    /// The programs that the engine runs.
    pub(super) fn programs(&self) -> &Programs {
        &self.programs
    }

    /// The session within an evaluation of an objective, which may be cancelled.
    pub fn with_trial(&self, cancellation: &Cancellation) -> Session {
        // A trial of its own, since evaluations run side by side; files and recordings are those of the script.
        Session { trial: Some(Arc::default()), cancellation: cancellation.clone(), ..self.clone() }
    }

    /// Cancels the simulations of an evaluation whose result is no longer needed.
    pub fn cancellation(&self) -> &Cancellation {
        &self.cancellation
    }

    /// Stops the script before its next run or trial; those that have begun end.
    pub fn stop(&self) -> &Cancellation {
        &self.stop
    }

    /// Whether no run or trial may begin any more.
    pub fn is_stopped(&self) -> bool {
        self.stop.is_cancelled() || self.cancellation.is_cancelled()
    }

    /// What the values of the host that the script holds count towards.
    pub fn budget(&self) -> &Budget {
        &self.budget
    }

    /// Where the host was last called with a context.
    pub(super) fn last_call(&self) -> Position {
        *base::lock(&self.last_call)
    }

    /// Whether an objective is being evaluated.
    pub fn is_trial(&self) -> bool {
        self.trial.is_some()
    }

    /// The record of the evaluation so far.
    pub fn trial(&self) -> Trial {
        self.trial.as_ref().map(|trial| base::lock(trial).clone()).unwrap_or_default()
    }

    /// Records that the film of `scenario` ruptured at `time` (s).
    pub fn add_rupture(&self, scenario: &str, time: f64) {
        self.update_trial(|trial| trial.ruptures.push(format!("{scenario}: the film broke at {:.1} ms", 1e3 * time)));
    }

    /// Records a comparison with a reference.
    pub(crate) fn add_comparison(&self, compared: impl FnOnce() -> Compared) {
        self.update_trial(|trial| {
            if trial.compared.len() < MOST_COMPARED {
                trial.compared.push(compared());
            }
        });
    }

    fn update_trial(&self, update: impl FnOnce(&mut Trial)) {
        if let Some(trial) = &self.trial {
            update(&mut base::lock(trial));
        }
    }

    /// Records whether the recording at `path` is virtual.
    pub fn add_recording(&self, path: &Path, is_virtual: bool) {
        base::lock(&self.recordings).insert(path.into(), is_virtual);
    }

    /// Virtual recordings that were read so far.
    pub fn virtual_recordings(&self) -> Vec<PathBuf> {
        let recordings = base::lock(&self.recordings);
        recordings.iter().filter(|(_, is_virtual)| **is_virtual).map(|(path, _)| path.clone()).collect()
    }

    /// Whether recordings were read so far and all of them are virtual.
    pub fn is_all_virtual(&self) -> bool {
        let recordings = base::lock(&self.recordings);
        !recordings.is_empty() && recordings.values().all(|is_virtual| *is_virtual)
    }
}

thread_local! {
    /// Whether this thread interprets a script, which reports what panics.
    static INTERPRETS: Cell<bool> = const { Cell::new(false) };
}

/// Lets panics within scripts, which become errors with a line, print nothing. For programs: the hook is that of the whole
/// process.
pub fn silence_panics() {
    let print = panic::take_hook();
    panic::set_hook(Box::new(move |info| {
        if !INTERPRETS.get() {
            print(info);
        }
    }));
}

/// What ends a script that was cancelled.
pub(crate) const STOPPED: &str = "stopped";

/// Checks that a run or a trial of a script may begin.
///
/// # Errors
/// The script was stopped; no `try` of it catches that.
pub(crate) fn check_stop(session: &Session) -> HostResult<()> {
    match session.is_stopped() {
        true => Err(EvalAltResult::ErrorTerminated(STOPPED.into(), Position::NONE).into()),
        false => Ok(()),
    }
}

/// What `take` gives of every place, in the order of the places; all threads take them in this `order`. After an error, or once the
/// script is stopped, nothing more begins, and the error is that of the first place; a trial that has begun goes on to its end.
pub(crate) fn run_all<T: Send>(
    session: &Session,
    order: &[usize],
    take: impl Fn(usize) -> HostResult<T> + Sync,
) -> HostResult<Vec<T>> {
    let check = || if session.is_trial() { Ok(()) } else { check_stop(session) };
    let is_over = AtomicBool::new(false);
    let taken = |place: &usize| {
        let found = (!is_over.load(Ordering::Relaxed)).then(|| check().and_then(|()| take(*place)))?;
        is_over.fetch_or(found.is_err(), Ordering::Relaxed);
        Some((*place, found))
    };
    let mut found: Vec<(usize, HostResult<T>)> = order.iter().par_bridge().filter_map(taken).collect();
    found.sort_by_key(|(place, _)| *place);
    let found = found.into_iter().map(|(_, found)| found).collect::<HostResult<Vec<T>>>()?;
    // What was given up at the end is no result.
    check().map(|()| found)
}

/// What `take` gives of every item of a list, which are taken from the first to the last.
pub(crate) fn run_list<I: Sync, T: Send>(
    session: &Session,
    items: &[I],
    take: impl Fn(&I) -> HostResult<T> + Sync,
) -> HostResult<Vec<T>> {
    run_all(session, &(0..items.len()).collect::<Vec<_>>(), |place| take(&items[place]))
}

/// Does `work`, which interprets a script; that `cancellation` stopped it, or a panic in it, is an error at `place`.
pub(crate) fn catch<T>(
    cancellation: &Cancellation,
    place: impl Fn() -> Position,
    work: impl FnOnce() -> HostResult<T>,
) -> HostResult<T> {
    let before = INTERPRETS.replace(true);
    let done = panic::catch_unwind(AssertUnwindSafe(|| cancellation.stops(work)));
    INTERPRETS.set(before);
    let error = match done {
        Ok(Some(result)) => return result,
        Ok(None) => EvalAltResult::ErrorTerminated(STOPPED.into(), place()),
        Err(panic) => {
            let text = message(&*panic);
            let text = format!("a function of droptower failed, which is a mistake in droptower: {text}");
            EvalAltResult::ErrorRuntime(text.into(), place())
        }
    };
    Err(error.into())
}

fn message(panic: &(dyn Any + Send)) -> &str {
    let text = panic.downcast_ref::<String>().map(String::as_str);
    text.or_else(|| panic.downcast_ref::<&str>().copied()).unwrap_or("no message")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::script::{Limits, engine};

    #[test]
    fn virtual_and_measured_recordings_are_distinguished() {
        let session = Session::default();
        assert!(!session.is_all_virtual());
        session.with_trial(&Cancellation::default()).add_recording(Path::new("b.csv"), true);
        assert!(session.is_all_virtual());
        session.add_recording(Path::new("a.csv"), false);
        assert!(!session.is_all_virtual());
        assert_eq!(session.virtual_recordings(), [PathBuf::from("b.csv")]);
    }

    #[test]
    fn host_functions_find_the_session_of_their_engine() {
        let mut engine = engine(Limits::POST);
        engine.register_fn("trial", |context: NativeCallContext| Session::from_context(&context).is_trial());
        assert!(!engine.eval::<bool>("trial()").unwrap());
        engine.set_default_tag(Dynamic::from(Session::default().with_trial(&Cancellation::default())));
        assert!(engine.eval::<bool>("[1].map(|x| trial())[0]").unwrap());
    }
}
