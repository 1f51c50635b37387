//! Searches in scripts: `minimize`, `minimize_all` and `confidence`, and the host that runs them.

mod confidence;
mod minimize;
mod objective;

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use minimize::ScriptSearch;
use objective::{ScriptError, ScriptObjective};
use rayon::prelude::*;
use rhai::{Dynamic, Engine, EvalAltResult, INT, NativeCallContext};

use crate::identify::convergence::{Labels, Progress, convergence_history};
use crate::identify::evaluator::{Evaluator, TrialEvent, TrialPool};
use crate::identify::objective::{Objective, SearchError};
use crate::identify::options::Search;
use crate::identify::search::{Iteration, SearchResult, minimize};
use crate::script::{Compared, ConvergenceHistory, HostResult, Session, numerical_failure, refuse};
use plot::Correlation;

/// Registers `minimize`, `minimize_all` and `confidence`, whose searches `host` runs.
pub fn register(engine: &mut Engine, host: &SearchHost) {
    minimize::register(engine, host);
    confidence::register(engine, host);
}

/// An engine with these functions and a host that shows nothing.
#[cfg(test)]
fn test_engine(limits: crate::script::Limits) -> Engine {
    let mut engine = crate::functions::engine(limits);
    register(&mut engine, &SearchHost::new(|_| {}));
    engine
}

/// Runs the searches of a script; their events go to one observer. Cheap to clone.
#[derive(Clone)]
pub struct SearchHost {
    searches: Arc<AtomicUsize>,
    observer: Arc<dyn Fn(SearchEvent<'_>) + Send + Sync>,
}

/// A search, its labels and its objective.
pub(crate) struct HostSearch<'a> {
    /// The function that the script calls.
    pub(crate) function: &'a str,
    pub(crate) search: &'a Search,
    pub(crate) labels: &'a Labels,
    pub(crate) objective: &'a dyn Objective,
}

/// What asks for the trials of an objective: a search, or an estimate about its result.
#[derive(Clone, Copy, Debug)]
pub struct SearchStart<'a> {
    /// Its number among those of the script, from zero.
    pub number: usize,
    /// The function that the script calls, such as `minimize`.
    pub function: &'a str,
    /// Title and names of the signals that are compared.
    pub labels: &'a Labels,
    /// Names of the unknowns.
    pub unknowns: &'a [String],
    /// Whether all references are virtual recordings.
    pub is_virtual: bool,
}

/// An event during the searches of a script.
#[derive(Clone, Copy, Debug)]
pub enum SearchEvent<'a> {
    /// Trials of an objective are asked for from now on.
    Begun(SearchStart<'a>),
    /// What becomes of a trial of the search of this number.
    Trial(usize, TrialEvent<'a>),
    /// No more trials are asked for by the search of this number.
    Ended(usize),
    /// An iteration of the search of this number has ended.
    Progress(usize, &'a Progress),
    /// A search has ended.
    Finished(&'a ConvergenceHistory),
    /// The correlation of estimated parameters is known.
    Correlation(&'a Correlation),
    /// How far what follows a search is, in words.
    Followed(&'a str),
}

impl SearchHost {
    /// A host that calls `observer` with each event.
    pub fn new(observer: impl Fn(SearchEvent<'_>) + Send + Sync + 'static) -> SearchHost {
        SearchHost { searches: Arc::default(), observer: Arc::new(observer) }
    }

    /// Runs independent searches on the same threads at the same time; the results in their order, or the number and the
    /// error of the first that failed.
    pub(crate) fn minimize_all(
        &self,
        session: &Session,
        searches: &[HostSearch<'_>],
    ) -> HostResult<Result<Vec<SearchResult>, (usize, SearchError)>> {
        let several = searches.len() > 1;
        let begun = self.searches.load(Ordering::Relaxed);
        let results = self.run(session, searches, |evaluator, number| {
            let HostSearch { search, labels, .. } = &searches[number];
            let name = (several || labels.title.is_some()).then(|| labels.full_title(number));
            let mut observer = |iteration: &Iteration| {
                let progress = Progress::after(iteration, search, name.as_deref());
                (self.observer)(SearchEvent::Progress(begun + number, &progress));
            };
            minimize(search, evaluator, &mut observer)
        })?;
        Ok(results.inspect(|results| {
            // The curves at the best points, each of one more trial: of all others they would be most of what is stored.
            let curves = |(result, own): (&SearchResult, &HostSearch<'_>)| {
                own.objective.trial(&result.best.x, session.cancellation()).compared
            };
            let compared: Vec<Vec<Compared>> = results.par_iter().zip(searches).map(curves).collect();
            for (number, ((result, own), compared)) in results.iter().zip(searches).zip(compared).enumerate() {
                let title = own.labels.common_title(begun + number);
                let (names, is_virtual) = (&own.search.names, session.is_all_virtual());
                let history = convergence_history(result, title, names, own.labels, is_virtual, compared);
                (self.observer)(SearchEvent::Finished(&history));
            }
        }))
    }

    /// What `job` finds of the objective of `search`.
    fn linearized<T: Send>(
        &self,
        context: &NativeCallContext,
        search: &ScriptSearch,
        job: impl Fn(&Evaluator<'_>) -> Result<T, SearchError> + Sync,
    ) -> HostResult<T> {
        let mut found = self.with_objectives(context, std::slice::from_ref(search), |session, searches| {
            self.run(session, searches, |evaluator, _| job(evaluator))
        })?;
        found.pop().ok_or_else(|| refuse("the search has no result"))
    }

    /// What `run` finds of `searches` with their objectives; an error of the script has its position.
    fn with_objectives<T>(
        &self,
        context: &NativeCallContext,
        searches: &[ScriptSearch],
        run: impl FnOnce(&Session, &[HostSearch<'_>]) -> HostResult<Result<Vec<T>, (usize, SearchError)>>,
    ) -> HostResult<Vec<T>> {
        let session = Session::from_context(context);
        if session.is_trial() {
            return Err(refuse!("an objective cannot search: `{}` is called within one", context.fn_name()));
        }
        let objective = |ScriptSearch { on_rupture, call, .. }: &ScriptSearch| {
            ScriptObjective::new(context, session.clone(), *on_rupture, call)
        };
        let objectives: Vec<ScriptObjective<'_>> = searches.iter().map(objective).collect();
        let with_objective = |(own, objective)| {
            let ScriptSearch { search, labels, .. }: &ScriptSearch = own;
            HostSearch { function: context.fn_name(), search, labels, objective }
        };
        let searches: Vec<HostSearch<'_>> =
            searches.iter().zip(objectives.iter().map(|own| own as &dyn Objective)).map(with_objective).collect();
        run(&session, &searches)?.map_err(|(number, error)| {
            let key_mistake = || objectives[number].take_key_mistake(error.cause_of_trial()?);
            script_error(&error)
                .or_else(key_mistake)
                .unwrap_or_else(|| failure(&error, &prefix(number, searches.len())))
        })
    }

    /// Runs `job` for each of `searches` with a pool that evaluates their objectives; the number and the error of the first
    /// that failed.
    pub(crate) fn run<T: Send>(
        &self,
        session: &Session,
        searches: &[HostSearch<'_>],
        job: impl Fn(&Evaluator<'_>, usize) -> Result<T, SearchError> + Sync,
    ) -> HostResult<Result<Vec<T>, (usize, SearchError)>> {
        for (number, HostSearch { search, .. }) in searches.iter().enumerate() {
            let refused = |error| refuse!("{}{error}", prefix(number, searches.len()));
            search.check().map_err(refused)?;
        }
        let begun = self.searches.fetch_add(searches.len(), Ordering::Relaxed);
        for (number, HostSearch { function, search, labels, .. }) in searches.iter().enumerate() {
            (self.observer)(SearchEvent::Begun(SearchStart {
                number: begun + number,
                function,
                labels,
                unknowns: &search.names,
                is_virtual: session.is_all_virtual(),
            }));
        }
        let objectives = searches.iter().map(|own| own.objective).collect();
        let pool = TrialPool::new(objectives, rayon::current_num_threads());
        let pool = pool.with_observer(|number, event| (self.observer)(SearchEvent::Trial(begun + number, event)));
        Ok(pool.run(|evaluator, number| {
            let found = job(evaluator, number);
            (self.observer)(SearchEvent::Ended(begun + number));
            found
        }))
    }

    /// Says how far what follows a search is.
    pub(crate) fn tell(&self, text: &str) {
        (self.observer)(SearchEvent::Followed(text));
    }
}

/// A count as scripts have it.
fn integer(count: usize) -> Dynamic {
    INT::try_from(count).unwrap_or(INT::MAX).into()
}

/// Words before the error of one of several searches.
fn prefix(number: usize, searches: usize) -> String {
    if searches > 1 { format!("search {}: ", number + 1) } else { String::new() }
}

/// The error of a search as the script gets it.
pub(crate) fn failure(error: &SearchError, prefix: &str) -> Box<EvalAltResult> {
    let text = format!("{prefix}{error}");
    if error.is_numerical() { numerical_failure(text) } else { refuse(text) }
}

/// The script error that ended a search with `error`, if one did.
fn script_error(error: &SearchError) -> Option<Box<EvalAltResult>> {
    let SearchError::Fatal(fatal) = error else { return None };
    fatal.cause::<ScriptError>()?.take()
}
