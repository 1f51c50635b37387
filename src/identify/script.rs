//! Searches in scripts: `minimize(method, start, options, |x| …)`.

use std::collections::BTreeMap;
use std::error::Error;
use std::iter::successors;
use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use rhai::{Array, Dynamic, Engine, EvalAltResult, FnPtr, GlobalRuntimeState, INT, Map, NativeCallContext};
use thiserror::Error;

use super::bounds::Bounds;
use super::convergence::{self, Labels};
use super::crew::{Crew, CrewError, Desk, Task};
use super::history::{History, Identity};
use super::objective::{Answer, Broken, Evaluation, Objective, Observed};
use super::options::{Method, OnFailure, OnRupture, Search, Starts};
use super::progress::{Progress, Watch};
use super::search::{self, Best, Ended, Iteration, SearchError, Unfound};
use super::trust;
use crate::diagnostic::closest;
use crate::plot::Correlation;
use crate::script::{ConvergenceHistory, Entry, STACK, Session, is_numerical, number, refuse, thrown, went_wrong};
use crate::signal::Series;
use crate::simulate::Cancellation;

pub(super) type Reply<T> = Result<T, Box<EvalAltResult>>;

/// Steps of the interpreter that one trial may take; a search bounds the number of its trials.
const OPERATIONS: u64 = 1_000_000;

/// Most iterations and evaluations that a script may ask for.
const MOST: INT = 100_000;

/// Values that the history of a result holds at most: with more iterations it shows every second, every third, and so on.
/// A script's own values are limited, and this is one.
const MOST_SHOWN: usize = 6_000;

/// Runs the searches of a script: their histories go to one folder, their events to one observer. Cheap to clone.
#[derive(Clone)]
pub struct SearchHost {
    folder: Option<PathBuf>,
    identity: Arc<OnceLock<Identity>>,
    searches: Arc<AtomicUsize>,
    listener: Arc<dyn Fn(SearchEvent<'_>) + Send + Sync>,
}

/// An event during the searches of a script.
#[derive(Clone, Copy, Debug)]
pub enum SearchEvent<'a> {
    /// An iteration has ended.
    Progress(&'a Progress),
    /// A message to the user.
    Note(&'a str),
    /// A search has ended.
    Finished(&'a ConvergenceHistory),
    /// The correlation of estimated parameters is known.
    Correlation(&'a Correlation),
}

impl SearchHost {
    /// Histories go to `folder`, where there is one and once the script is [identified](SearchHost::identify); `listener`
    /// hears of every iteration.
    pub fn new(folder: Option<PathBuf>, listener: impl Fn(SearchEvent<'_>) + Send + Sync + 'static) -> SearchHost {
        SearchHost { folder, identity: Arc::default(), searches: Arc::default(), listener: Arc::new(listener) }
    }

    /// Says which script its searches belong to.
    pub fn identify(&self, identity: Identity) {
        self.identity.get_or_init(|| identity);
    }

    /// Searches on the same cores at the same time; what each found, in their order.
    fn minimise(&self, context: &NativeCallContext, searches: &[Written], calls: &[FnPtr]) -> Reply<Vec<Best>> {
        let several = searches.len() > 1;
        let tasks: Vec<(Search, FnPtr)> =
            searches.iter().zip(calls).map(|(written, call)| (written.search.clone(), call.clone())).collect();
        let begun = self.searches.load(Ordering::Relaxed);
        let session = Session::of(context);
        let found = self.at_work(context, &tasks, |desk, number| {
            let Written { search, labels } = &searches[number];
            let name = labels.title.clone().or_else(|| several.then(|| format!("search {}", number + 1)));
            let mut watch = Watch::new(search, name, &labels.names);
            let mut listener = |iteration: &Iteration| (self.listener)(SearchEvent::Progress(&watch.look(iteration)));
            let best = search::minimise(search, desk, &mut listener)?;
            let title = labels.title.clone().unwrap_or_else(|| format!("search {}", begun + number + 1));
            let convergence = convergence::of(&best, title, labels, session.is_all_virtual(), desk);
            Ok::<_, SearchError>((best, convergence))
        })?;
        let (found, convergences): (Vec<_>, Vec<_>) = found.into_iter().unzip();
        convergences.iter().for_each(|convergence| (self.listener)(SearchEvent::Finished(convergence)));
        Ok(found)
    }

    /// Does `job` for every one of `searches` with a crew for the trials of their objectives, which are written down.
    pub(super) fn at_work<T: Send, E: Unfound + From<CrewError> + Send>(
        &self,
        context: &NativeCallContext,
        searches: &[(Search, FnPtr)],
        job: impl Fn(&Desk<'_, '_>, usize) -> Result<T, E> + Sync,
    ) -> Reply<Vec<T>> {
        let session = Session::of(context);
        if session.is_trial() {
            return Err(refuse(format!("an objective cannot search: `{}` is called within one", context.fn_name())));
        }
        let several = searches.len() > 1;
        let nth = |number: usize| if several { format!("search {}: ", number + 1) } else { String::new() };
        for (number, (search, _)) in searches.iter().enumerate() {
            search.check().map_err(|error| refuse(format!("{}{error}", nth(number))))?;
        }
        let histories = searches.iter().map(|_| self.history(session.inputs()));
        let mut histories = histories.collect::<Reply<Vec<_>>>()?;
        let objective =
            |(search, call): &(Search, FnPtr)| Closure::new(context, session.clone(), search.on_rupture, call);
        let objectives: Vec<Closure<'_>> = searches.iter().map(objective).collect();
        let tasks = objectives.iter().zip(searches).zip(&mut histories);
        let tasks = tasks.map(|((objective, (search, _)), history)| Task {
            objective,
            on_failure: search.on_failure,
            history: history.as_mut(),
        });
        let crew = Crew::new(tasks.collect(), rayon::current_num_threads());
        let found = crew.at_work(STACK, job);
        found.map_err(|(number, error)| mistake(&error).unwrap_or_else(|| unfound(&error, &nth(number))))
    }

    /// Shows the user how the parameters hang together.
    pub(super) fn correlated(&self, correlation: &Correlation) {
        (self.listener)(SearchEvent::Correlation(correlation));
    }

    /// Tells the user something.
    pub(super) fn note(&self, note: &str) {
        (self.listener)(SearchEvent::Note(note));
    }

    /// The history of the next search.
    fn history(&self, inputs: BTreeMap<PathBuf, String>) -> Reply<Option<History>> {
        let number = self.searches.fetch_add(1, Ordering::Relaxed) + 1;
        let (Some(folder), Some(identity)) = (&self.folder, self.identity.get()) else {
            return Ok(None);
        };
        let history = History::open(folder, identity, number, inputs).map_err(refuse)?;
        for note in &history.notes {
            (self.listener)(SearchEvent::Note(note));
        }
        let known = history.trials().len();
        if known > 0 {
            (self.listener)(SearchEvent::Note(&format!("{known} trials are taken from {}", history.path().display())));
        }
        Ok(Some(history))
    }
}

/// Why a search found nothing, as the script hears it.
fn unfound(error: &impl Unfound, nth: &str) -> Box<EvalAltResult> {
    let text = format!("{nth}{error}");
    if error.is_numerical() { went_wrong(text) } else { refuse(text) }
}

/// The mistake in the script that ended a search with `error`, where it was one.
fn mistake(error: &(dyn Error + 'static)) -> Option<Box<EvalAltResult>> {
    let broken = successors(Some(error), |&error| error.source()).find_map(|error| error.downcast_ref::<Broken>())?;
    broken.cause::<Mistake>()?.error.lock().unwrap_or_else(PoisonError::into_inner).take()
}

/// A mistake in the script, which a trial has come upon.
#[derive(Debug, Error)]
#[error("{text}")]
struct Mistake {
    text: String,
    /// With its place; there until the script is told.
    error: Mutex<Option<Box<EvalAltResult>>>,
}

impl From<Box<EvalAltResult>> for Mistake {
    fn from(error: Box<EvalAltResult>) -> Mistake {
        Mistake { text: error.to_string(), error: Mutex::new(Some(error)) }
    }
}

/// A script's closure as an objective that may be asked from several threads.
///
/// What it captured is copied for every trial: a trial sees it as it was when the search began, and what it changes is
/// gone afterwards. So no trial depends on another.
struct Closure<'c> {
    engine: &'c Engine,
    name: &'c str,
    global: GlobalRuntimeState,
    position: rhai::Position,
    session: Session,
    on_rupture: OnRupture,
    call: FnPtr,
}

impl<'c> Closure<'c> {
    fn new(context: &'c NativeCallContext, session: Session, on_rupture: OnRupture, call: &FnPtr) -> Closure<'c> {
        let engine = context.engine();
        let mut global = context.global_runtime_state().clone();
        global.num_operations = engine.max_operations().saturating_sub(OPERATIONS);
        Closure {
            engine,
            name: context.fn_name(),
            global,
            position: context.call_position(),
            session,
            on_rupture,
            call: unshared(call),
        }
    }

    fn ask(&self, x: &[f64], session: &Session) -> Reply<Dynamic> {
        let mut global = self.global.clone();
        global.tag = session.clone().into();
        let context = NativeCallContext::new_with_all_fields(self.engine, self.name, None, &global, self.position);
        let x: Array = x.iter().map(|x| Dynamic::from(*x)).collect();
        unshared(&self.call).call_raw(&context, None, [Dynamic::from(x)])
    }

    fn evaluation(&self, found: Reply<Dynamic>, session: &Session) -> Evaluation {
        let found = match found {
            Ok(found) => found,
            Err(error) => return failure(error),
        };
        match (answer(&found), session.trial().ruptures.first()) {
            (Err(error), _) => broken(error),
            (Ok(_), Some(rupture)) if self.on_rupture == OnRupture::Fail => Evaluation::failed(rupture),
            (Ok(answer), _) => answer.checked(),
        }
    }
}

impl Objective for Closure<'_> {
    fn evaluate(&self, x: &[f64], cancellation: &Cancellation) -> Evaluation {
        self.observe(x, cancellation).found
    }

    fn observe(&self, x: &[f64], cancellation: &Cancellation) -> Observed {
        let session = self.session.with_trial(cancellation);
        let found = self.ask(x, &session);
        let found = self.evaluation(found, &session);
        Observed { found, compared: session.trial().compared }
    }

    fn inputs(&self) -> Vec<(PathBuf, String)> {
        self.session.inputs().into_iter().collect()
    }
}

/// What was thrown is a failed trial; what the interpreter finds fault with is a mistake in the script.
fn failure(error: Box<EvalAltResult>) -> Evaluation {
    match error.unwrap_inner() {
        EvalAltResult::ErrorRuntime(value, _) => {
            Evaluation::Failed { cause: thrown(value), numerical: is_numerical(&error) }
        }
        _ => broken(error),
    }
}

fn broken(error: Box<EvalAltResult>) -> Evaluation {
    Evaluation::Broken(Broken::new(Mistake::from(error)))
}

/// The same function with copies of what it captured.
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

fn answer(found: &Dynamic) -> Reply<Answer> {
    if let Some(series) = found.read_lock::<Series>() {
        return Ok(Answer::Residuals(series.values().to_vec()));
    }
    if let Some(list) = found.read_lock::<Array>() {
        let values = list.iter().map(|item| number(item, "a residual")).collect::<Reply<Vec<f64>>>();
        return values.map(Answer::Residuals);
    }
    let other = || refuse(format!("an objective gives a number, a signal or a list, not {}", found.type_name()));
    number(found, "the objective").map(Answer::Value).map_err(|_| other())
}

/// Options as a script writes them.
pub(super) const OPTIONS: [&str; 16] = [
    "tol_x",
    "tol_f",
    "max_iterations",
    "max_evaluations",
    "lower",
    "upper",
    "seed",
    "starts",
    "fallback",
    "on_failure",
    "on_rupture",
    "difference",
    "spread",
    "names",
    "title",
    "signals",
];

/// A search as it is written.
pub(super) struct Written {
    pub(super) search: Search,
    pub(super) labels: Labels,
}

pub(super) fn written(method: &str, start: &Array, options: &Map) -> Reply<Written> {
    let method = word("method", method, &Method::NAMES)?;
    let mut search = Search::new(method, numbers(start, "start")?);
    let unknowns = search.start.len();
    let names = (0..unknowns).map(|place| format!("x{place}")).collect();
    let mut labels = Labels { names, title: None, signals: vec![] };
    let mut sides = [None, None];
    for (option, value) in options {
        let list = || match value.read_lock::<Array>() {
            Some(list) => Ok(list.clone()),
            None => Err(refuse(format!("`{option}` is a list, not {}", value.type_name()))),
        };
        let text = || {
            let text = value.clone().into_immutable_string();
            text.map_err(|found| refuse(format!("`{option}` is a text, not {found}")))
        };
        match option.as_str() {
            "tol_x" => search.tol_x = number(value, option)?,
            "tol_f" => search.tol_f = number(value, option)?,
            "difference" => search.difference = number(value, option)?,
            "spread" => search.spread = number(value, option)?,
            "max_iterations" => search.most_iterations = count(value, option)?,
            "max_evaluations" => search.most_evaluations = count(value, option)?,
            "seed" => search.seed = whole(value, option)?.cast_unsigned(),
            "lower" => sides[0] = Some(sided(&list()?, f64::NEG_INFINITY, option)?),
            "upper" => sides[1] = Some(sided(&list()?, f64::INFINITY, option)?),
            "starts" if value.is_array() => {
                search.starts = Starts::Given(points(&list()?, "a number or a list", option)?)
            }
            "starts" => search.starts = Starts::Spread(count(value, option)?),
            "fallback" => search.fallback = points(&list()?, "a list", option)?,
            "on_failure" => search.on_failure = word(option, &text()?, &ON_FAILURE)?,
            "on_rupture" => search.on_rupture = word(option, &text()?, &ON_RUPTURE)?,
            "names" => labels.names = list()?.iter().map(Dynamic::to_string).collect(),
            "title" => labels.title = Some(text()?.to_string()),
            "signals" => labels.signals = list()?.iter().map(Dynamic::to_string).collect(),
            other => return Err(unknown("option", other, OPTIONS)),
        }
    }
    if labels.names.len() != unknowns {
        return Err(refuse(format!("`names` has {} entries for {unknowns} unknowns", labels.names.len())));
    }
    labels.check().map_err(refuse)?;
    let [lower, upper] = sides;
    search.bounds = Bounds::new(unknowns, lower, upper).map_err(refuse)?;
    Ok(Written { search, labels })
}

const ON_FAILURE: [(&str, OnFailure); 3] =
    [("worst", OnFailure::Worst), ("retry", OnFailure::Retry), ("stop", OnFailure::Stop)];
const ON_RUPTURE: [(&str, OnRupture); 2] = [("fail", OnRupture::Fail), ("keep", OnRupture::Keep)];

pub(super) fn word<T: Copy>(what: &str, text: &str, known: &[(&'static str, T)]) -> Reply<T> {
    let found = known.iter().find(|(name, _)| *name == text).map(|(_, value)| *value);
    found.ok_or_else(|| unknown(what, text, known.iter().map(|(name, _)| *name)))
}

pub(super) fn unknown<'k>(
    what: &str,
    text: &str,
    known: impl IntoIterator<Item = &'k str> + Clone,
) -> Box<EvalAltResult> {
    let hint = match closest(text, known.clone()) {
        Some(close) => format!("did you mean `{close}`?"),
        None => format!("there are {}", known.into_iter().collect::<Vec<_>>().join(", ")),
    };
    refuse(format!("unknown {what} `{text}` ({hint})"))
}

pub(super) fn whole(value: &Dynamic, option: &str) -> Reply<INT> {
    value.as_int().map_err(|found| refuse(format!("`{option}` is a whole number, not {found}")))
}

fn count(value: &Dynamic, option: &str) -> Reply<usize> {
    let count = whole(value, option)?;
    let fits = usize::try_from(count).ok().filter(|_| (1..=MOST).contains(&count));
    fits.ok_or_else(|| refuse(format!("`{option}` is {count}, which must be 1 to {MOST}")))
}

fn numbers(list: &Array, what: &str) -> Reply<Vec<f64>> {
    list.iter().map(|item| number(item, what)).collect()
}

/// Bounds of one side; `()` where there is none.
fn sided(list: &Array, none: f64, what: &str) -> Reply<Vec<f64>> {
    list.iter().map(|item| if item.is_unit() { Ok(none) } else { number(item, what) }).collect()
}

fn points(list: &Array, kind: &str, option: &str) -> Reply<Vec<Vec<f64>>> {
    let point = |item: &Dynamic| match item.read_lock::<Array>() {
        Some(point) => numbers(&point, option),
        None => Err(refuse(format!("`{option}` is {kind} of lists, with {} in it", item.type_name()))),
    };
    list.iter().map(point).collect()
}

/// What a script gets.
fn result(best: &Best, names: &[String]) -> Map {
    let mut result = ending(&best.best);
    let shown = history(&best.starts, names, best.starts.len() > 1);
    result.insert("history".into(), shown.into());
    let warnings = best.warnings.iter().map(|warning| warning.clone().into());
    result.insert("warnings".into(), warnings.collect::<Array>().into());
    let starts: Array = best.starts.iter().map(|ended| ending(ended).into()).collect();
    result.insert("starts".into(), starts.into());
    let total: usize = best.starts.iter().map(|ended| ended.evaluations).sum();
    result.insert("total_evaluations".into(), integer(total));
    result
}

fn ending(ended: &Ended) -> Map {
    let mut map = Map::new();
    map.insert("x".into(), ended.x.iter().map(|x| Dynamic::from(*x)).collect::<Array>().into());
    map.insert("f".into(), ended.f.into());
    map.insert("iterations".into(), integer(ended.iterations));
    map.insert("evaluations".into(), integer(ended.evaluations));
    map.insert("converged".into(), ended.converged.into());
    map.insert("reason".into(), ended.reason.clone().into());
    map.insert("simplex_size".into(), ended.size.map_or(Dynamic::UNIT, Dynamic::from));
    map
}

/// Iterations as rows of a table; thinned out evenly where they are more than a script's value may hold.
fn history(starts: &[Ended], names: &[String], several: bool) -> Array {
    let all: Vec<&Iteration> = starts.iter().flat_map(|ended| &ended.history).collect();
    let shown = convergence::thinned(&all, MOST_SHOWN / (names.len() + 7));
    shown.map(|iteration| row(iteration, names, several).into()).collect()
}

fn row(iteration: &Iteration, names: &[String], several: bool) -> Map {
    let mut map = Map::new();
    if several {
        map.insert("start".into(), integer(iteration.start + 1));
    }
    map.insert("iteration".into(), integer(iteration.iteration));
    map.insert("evaluations".into(), integer(iteration.evaluations));
    map.insert("f".into(), iteration.f.into());
    map.insert("size".into(), iteration.size.map_or(Dynamic::UNIT, Dynamic::from));
    map.insert("step".into(), iteration.step.into());
    for (name, x) in names.iter().zip(&iteration.x) {
        map.insert(name.as_str().into(), (*x).into());
    }
    map
}

fn integer(count: usize) -> Dynamic {
    INT::try_from(count).unwrap_or(INT::MAX).into()
}

/// What each of `searches` found for the objective of its place.
fn minimise(host: &SearchHost, context: &NativeCallContext, searches: &[Written], calls: &[FnPtr]) -> Reply<Vec<Map>> {
    let found = host.minimise(context, searches, calls)?;
    Ok(found.iter().zip(searches).map(|(best, written)| result(best, &written.labels.names)).collect())
}

fn minimise_one(
    host: &SearchHost,
    context: &NativeCallContext,
    (method, start, options): (&str, &Array, &Map),
    call: FnPtr,
) -> Reply<Map> {
    let mut found = minimise(host, context, &[written(method, start, options)?], &[call])?;
    found.pop().ok_or_else(|| refuse("the search was not made"))
}

/// Independent searches at the same time. `options` are those of all, or a list with those of each.
fn minimise_all(
    host: &SearchHost,
    context: &NativeCallContext,
    (method, starts, options): (&str, &Array, &Dynamic),
    calls: Array,
) -> Reply<Array> {
    let count = calls.len();
    let of_each = |list: &Array, what: &str| match list.len() {
        found if found == count => Ok(()),
        found => Err(refuse(format!("minimize_all has {found} {what} for {count} objectives"))),
    };
    of_each(starts, "starts")?;
    let options: Vec<Dynamic> = match options.read_lock::<Array>() {
        Some(list) => of_each(&list, "maps of options").map(|()| list.clone())?,
        None => vec![options.clone(); count],
    };
    let searches = starts.iter().zip(options).zip(calls).enumerate().map(|(number, ((start, options), call))| {
        let part = |error: Box<EvalAltResult>| match &*error {
            EvalAltResult::ErrorRuntime(value, _) => refuse(format!("search {}: {}", number + 1, thrown(value))),
            _ => error,
        };
        let start = start.read_lock::<Array>().ok_or_else(|| part(refuse("its start is a list of numbers")))?;
        let options = options.read_lock::<Map>().ok_or_else(|| part(refuse("its options are a map")))?;
        let call =
            call.try_cast::<FnPtr>().ok_or_else(|| part(refuse("its objective is a function, as in `|x| …`")))?;
        written(method, &start, &options).map(|written| (written, call)).map_err(part)
    });
    let (searches, calls): (Vec<_>, Vec<_>) = searches.collect::<Reply<Vec<_>>>()?.into_iter().unzip();
    let found = minimise(host, context, &searches, &calls)?;
    Ok(found.into_iter().map(Dynamic::from).collect())
}

/// Offers `minimize`, `minimize_all`, `confidence` and `profiles` to scripts.
pub fn register(engine: &mut Engine, host: &SearchHost) {
    trust::register(engine, host);
    let own = host.clone();
    engine.register_fn(
        "minimize",
        move |context: NativeCallContext, method: &str, start: Array, options: Map, call: FnPtr| {
            minimise_one(&own, &context, (method, &start, &options), call)
        },
    );
    let own = host.clone();
    engine.register_fn("minimize", move |context: NativeCallContext, method: &str, start: Array, call: FnPtr| {
        minimise_one(&own, &context, (method, &start, &Map::new()), call)
    });
    let own = host.clone();
    engine.register_fn(
        "minimize_all",
        move |context: NativeCallContext, method: &str, starts: Array, options: Dynamic, calls: Array| {
            minimise_all(&own, &context, (method, &starts, &options), calls)
        },
    );
}

/// The reference of searches.
pub const ENTRIES: &[Entry] = &[
    Entry {
        call: "minimize(method, start, options, |x| …)",
        gives: "where the objective is smallest: #{ x, f, iterations, evaluations, converged, reason, simplex_size, history, starts, \
                warnings }. Methods: \"nelder-mead\" (as MATLAB's fminsearch), \"levenberg-marquardt\" (residuals), \"cma-es\" (rough \
                objectives). The objective gives a number, or a signal or list of residuals, of which \"nelder-mead\" and \"cma-es\" take \
                the norm. It is called from several threads, and sees what it captures as it was when the search began. A trial has \
                1 000 000 steps of its own; all searches of a script share the week that it may take",
        example: r#"let best = minimize("nelder-mead", [-1.2, 1], #{}, |x| 100 * (x[1] - x[0] ** 2) ** 2 + (1 - x[0]) ** 2);
                    best.iterations == 85 && best.evaluations == 159 && best.converged"#,
    },
    Entry {
        call: "minimize_all(method, [start, …], options, [|x| …, …])",
        gives: "what `minimize` finds for every one of independent objectives, in their order and to the same bit, searched at the same \
                time on all cores; options are one map for all or a list of maps. Where a search fails, those before it are ended, those \
                behind it are broken off, and the first failure is the call's",
        example: r#"let found = minimize_all("nelder-mead", [[2.0], [3.0]], #{ tol_f: 1e-6 }, [|x| x[0] ** 2, |x| (x[0] - 1) ** 2]);
                    found[1].f == minimize("nelder-mead", [3.0], #{ tol_f: 1e-6 }, |x| (x[0] - 1) ** 2).f"#,
    },
    Entry {
        call: "#{ tol_x, tol_f, max_iterations, max_evaluations }",
        gives: "when a search ends: both tolerances 1e-4, both limits 200 for each unknown; absolute for \"nelder-mead\" and \"cma-es\", \
                relative for \"levenberg-marquardt\"",
        example: r#"let o = #{ max_iterations: 3 }; let best = minimize("nelder-mead", [1], o, |x| x[0] ** 2);
                    !best.converged && best.reason == "max_iterations was reached" && best.history.len() == 3"#,
    },
    Entry {
        call: "#{ lower: [..], upper: [..] }",
        gives: "bounds, `()` for none: by projection and new simplices on a bound (\"nelder-mead\"), by transform (the others)",
        example: r#"let best = minimize("nelder-mead", [2.0], #{ lower: [1.5] }, |x| x[0] ** 2); best.x[0] == 1.5"#,
    },
    Entry {
        call: "#{ starts: 5, seed: 1 }, #{ starts: [[..], ..] }",
        gives: "further starts, in a Latin hypercube over the bounds or as given; warnings say where they disagree",
        example: r#"let o = #{ lower: [-3], upper: [3], starts: 4 };
                    let best = minimize("nelder-mead", [1.2], o, |x| (x[0] ** 2 - 1) ** 2 + 0.3 * x[0]);
                    best.x[0] < 0 && best.warnings[0].contains("local minima")"#,
    },
    Entry {
        call: "#{ fallback: [[..], ..] }",
        gives: "where to begin in place of a start at which the objective has no value: the first of these at which it has one; noted in \
                warnings",
        example: r#"let best = minimize("nelder-mead", [0.5], #{ fallback: [[2.0]] }, |x| if x[0] < 1 { throw "too small" } else { x[0] });
                    best.history[0].x0 >= 1 && best.warnings[0].contains("begun at [2.0] instead")"#,
    },
    Entry {
        call: "#{ on_failure: \"worst\" | \"retry\" | \"stop\", on_rupture: \"fail\" | \"keep\" }",
        gives: "what a trial counts as that throws or is not a number: worse than all others (noted in warnings), what is found a millionth \
                aside, or the end; and whether a run in which film breaks is such a trial",
        example: r#"let best = minimize("nelder-mead", [2.0], #{}, |x| if x[0] < 1 { throw "too small" } else { x[0] });
                    best.x[0] >= 1 && best.warnings[0].contains("too small")"#,
    },
    Entry {
        call: "#{ title: \"1008\", signals: [\"acceleration (m/s²)\", ..] }",
        gives: "what the search is called in report and recording, where its iterations are shown without further work: the objective, \
                the unknowns, and the signals that the objective compares (`relative_error`, `relative_residuals`, `rate`) closing in \
                on their references; and what these signals are called, in the order in which they are compared",
        example: r#"let read = signal([0, 1, 2], [5, 7, 9]);
                    let o = #{ title: "line", signals: ["force (N)"], names: ["offset"] };
                    let best = minimize("nelder-mead", [4.0], o, |x| relative_error(signal([0, 1, 2], [x[0], x[0] + 2, x[0] + 4]), read, [0, 2]));
                    (best.x[0] - 5).abs() < 1e-3"#,
    },
    Entry {
        call: "#{ names: [..], difference: 1e-3, spread: 0.25 }",
        gives: "columns of the unknowns in the history; relative step of the Jacobian's differences; first standard deviation of \"cma-es\"",
        example: r#"minimize("nelder-mead", [2.0], #{ names: ["k1"] }, |x| x[0] ** 2).history[0].k1 == 2.0"#,
    },
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::functions::engine;
    use crate::script::Limits;

    fn host() -> Engine {
        let mut engine = engine(Limits::STUDY);
        register(&mut engine, &SearchHost::new(None, |_| {}));
        engine
    }

    #[test]
    fn the_examples_of_the_reference_hold() {
        let engine = host();
        for entry in ENTRIES.iter().chain(trust::ENTRIES) {
            let held = engine.eval::<bool>(entry.example);
            assert!(matches!(held, Ok(true)), "{}: {held:?}", entry.call);
        }
    }

    #[test]
    fn mistakes_are_said() {
        let engine = host();
        let with = |options: &str| format!("minimize(\"nelder-mead\", [1.0, 2], #{{ {options} }}, |x| x[0] + x[1])");
        for (text, expected) in [
            ("minimize(\"nelder\", [1], |x| x[0])".into(), "unknown method `nelder` (did you mean `nelder-mead`?)"),
            ("minimize(\"bfgs\", [1], |x| x[0])".into(), "there are nelder-mead, levenberg-marquardt, cma-es"),
            ("minimize(\"cma-es\", [], |x| 1)".into(), "a search needs 1 to 50 unknowns, the start has 0"),
            ("minimize(\"cma-es\", [1, \"a\"], |x| 1)".into(), "expected a number for start"),
            ("minimize(\"cma-es\", [0.0 / 0.0], |x| 1)".into(), "the start is not a number: x[0] = NaN"),
            (with("tolx: 1e-4"), "unknown option `tolx` (did you mean `tol_x`?)"),
            (with("tol_x: -1"), "`tol_x` is -1, which must be zero or more"),
            (with("tol_f: \"a\""), "expected a number for tol_f"),
            (with("max_iterations: 0"), "`max_iterations` is 0, which must be 1 to 100000"),
            (with("max_evaluations: 1.5"), "`max_evaluations` is a whole number, not f64"),
            (with("lower: 1"), "`lower` is a list, not i64"),
            (with("lower: [0]"), "`lower` has 1 entries for 2 unknowns"),
            (with("lower: [0, 1], upper: [1, 1]"), "the bounds of x[1] leave no room: 1 to 1"),
            (with("lower: [2, ()]"), "the start lies outside the bounds: x[0] = 1, which may be 2 to inf"),
            (with("starts: 3"), "starts spread over the bounds need `lower` and `upper` for every unknown"),
            (with("starts: [[1]]"), "start 2 has 1 entries for 2 unknowns"),
            (with("starts: [[1, 5]], upper: [2, 3]"), "the start lies outside the bounds: x[1] = 5"),
            (with("fallback: [[1]]"), "start 2 has 1 entries for 2 unknowns"),
            (with("fallback: [1]"), "`fallback` is a list of lists, with i64 in it"),
            ("minimize_all(\"cma-es\", [[1]], #{}, [])".into(), "minimize_all has 1 starts for 0 objectives"),
            ("minimize_all(\"cma-es\", [[1]], [], [|x| 1])".into(), "minimize_all has 0 maps of options for 1 objectives"),
            ("minimize_all(\"cma-es\", [1], #{}, [|x| 1])".into(), "search 1: its start is a list of numbers"),
            ("minimize_all(\"cma-es\", [[1]], #{}, [1])".into(), "search 1: its objective is a function"),
            (
                "minimize_all(\"nelder-mead\", [[1], [2]], #{}, [|x| x[0] ** 2, |x| { throw \"no\" }])".into(),
                "search 2: the objective has no value at the start [2.0]: no",
            ),
            (with("on_failure: \"ignore\""), "unknown on_failure `ignore` (there are worst, retry, stop)"),
            (with("on_rupture: 1"), "`on_rupture` is a text, not i64"),
            (with("difference: 2"), "`difference` is 2, which must be between 0 and 1"),
            (with("names: [\"k1\"]"), "`names` has 1 entries for 2 unknowns"),
            ("minimize(\"levenberg-marquardt\", [1], |x| x[0])".into(), "levenberg-marquardt needs residuals"),
            ("minimize(\"levenberg-marquardt\", [1, 2], |x| [x[0]])".into(), "the objective gave 1 residuals for 2 unknowns"),
            (
                "minimize(\"levenberg-marquardt\", [1], |x| if x[0] == 1 { [2, 3] } else { [1] })".into(),
                "the objective gave 1 residuals at",
            ),
            ("minimize(\"nelder-mead\", [1], |x| \"a\")".into(), "an objective gives a number, a signal or a list, not string"),
            ("minimize(\"nelder-mead\", [1], |x| x[1])".into(), "Array index 1 out of bounds"),
            ("minimize(\"nelder-mead\", [1], |x| 0.0 / 0.0)".into(), "the objective has no value at the start [1.0]"),
            ("minimize(\"nelder-mead\", [1], |x| { throw \"no\" })".into(), "no value at the start [1.0]: no"),
            (
                "minimize(\"nelder-mead\", [2.0], #{ on_failure: \"stop\" }, |x| if x[0] < 1 { throw \"no\" } else { x[0] })".into(),
                "a trial failed at [0.",
            ),
            ("minimize(\"nelder-mead\", [1], |x| { loop {} })".into(), "Too many operations"),
            (
                "minimize(\"nelder-mead\", [1], |x| minimize(\"nelder-mead\", [1], |y| y[0]).f)".into(),
                "an objective cannot search",
            ),
        ] {
            let error = engine.run(&text).unwrap_err().to_string();
            assert!(error.contains(expected), "{text} gave: {error}");
        }
    }

    #[test]
    fn a_mistake_in_an_objective_is_told_at_its_place() {
        let error = host().run("let a = 1;\nminimize(\"nelder-mead\", [1], |x| {\n  x[7]\n})").unwrap_err();
        assert_eq!(error.unwrap_inner().position().line(), Some(3));
    }

    /// A trial ahead of the search comes upon the index that is out of range, at 1.2 and below; the search ends at 1.4.
    #[test]
    fn a_mistake_in_a_trial_in_vain_is_not_told() {
        let text = "minimize(\"nelder-mead\", [2.0], #{ on_failure: \"stop\" }, |x| {
            if x[0] <= 1.2 { [0][9] } else if x[0] < 1.5 { let s = 0; for i in 0..20000 { s += 1; } throw \"too small\" } else { x[0] }
        })";
        for threads in [1, 2, 4] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let error = pool.install(|| host().run(text)).unwrap_err().to_string();
            assert!(error.contains("a trial failed at [1.39999") && error.contains("too small"), "{threads}: {error}");
        }
    }

    #[test]
    fn searches_at_the_same_time_find_what_they_find_alone() {
        let text =
            "let calls = [|x| [10 * (x[1] - x[0] ** 2), 1 - x[0]], |x| [x[0] - 3, x[0] * x[1]], |x| [x[0], x[1] - 1]];
            let starts = [[-1.2, 1], [1.0, 2], [0.5, 0.5]];
            for method in [\"nelder-mead\", \"levenberg-marquardt\", \"cma-es\"] {
                let together = minimize_all(method, starts, #{ max_evaluations: 150 }, calls);
                for (found, place) in together {
                    let alone = minimize(method, starts[place], #{ max_evaluations: 150 }, calls[place]);
                    if found.x != alone.x || found.f != alone.f || found.evaluations != alone.evaluations
                        || found.history.len() != alone.history.len() { throw method + place }
                }
            }";
        host().run(text).unwrap();
    }

    #[test]
    fn a_script_that_searches_without_end_runs_out_of_its_time() {
        let limits = Limits { time: std::time::Duration::from_millis(300), ..Limits::STUDY };
        let mut engine = engine(limits);
        register(&mut engine, &SearchHost::new(None, |_| {}));
        let error = engine
            .run("loop { minimize(\"nelder-mead\", [1.0], |x| { let s = 0; for i in 0..1000 { s += 1; } x[0] }) }");
        let error = error.unwrap_err();
        assert!(matches!(error.unwrap_inner(), EvalAltResult::ErrorTerminated(..)), "{error}");
    }

    #[test]
    fn what_an_objective_changes_is_gone_after_each_trial() {
        let text = "let n = 0; let l = [0];
            let best = minimize(\"nelder-mead\", [1.0], |x| { n += 1; l.push(n); x[0] ** 2 + l.len() + n });
            best.f - 3.0 < 1e-6 && n == 0 && l.len() == 1";
        assert!(host().eval::<bool>(text).unwrap());
    }

    #[test]
    fn a_long_history_is_thinned_out_and_keeps_its_ends() {
        let text = "let o = #{ max_iterations: 1000, max_evaluations: 3000, tol_x: 0, tol_f: 0 };
            let best = minimize(\"nelder-mead\", [3.0, 4, 5, 6], o, |x| x.reduce(|s, x| s + x ** 2, 0.0));
            [best.history.len(), best.history[0].iteration, best.history[-1].iteration, best.iterations]";
        let found: Vec<INT> = host().eval::<Array>(text).unwrap().iter().map(|n| n.as_int().unwrap()).collect();
        assert!(found[0] > 300 && found[0] <= 600 && found[1] == 1 && found[2] == found[3], "{found:?}");
    }
}
