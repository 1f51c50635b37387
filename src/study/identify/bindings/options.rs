//! The options of a search as a script writes them.

use rhai::{Array, Dynamic, EvalAltResult, FnPtr, INT, Map};

use super::objective::OnRupture;
use crate::identify::bounds::Bounds;
use crate::identify::convergence::{Labels, SignalLabel};
use crate::identify::options::{Method, OptionsError, Search, Starts};
use crate::script::{HostResult, number, refuse};
use base::diagnostic::closest;
use base::removed;

/// Largest limit of iterations or evaluations.
const MAX_COUNT: INT = 100_000;

/// Largest length of a title or a name, characters.
const MAX_LENGTH: usize = 200;

/// Names of the options.
pub(super) const OPTIONS: [&str; 13] = [
    "tol_x",
    "tol_f",
    "max_iterations",
    "max_evaluations",
    "lower",
    "upper",
    "seed",
    "starts",
    "on_rupture",
    "difference",
    "names",
    "title",
    "signals",
];

const ON_RUPTURE: [(&str, OnRupture); 2] = [("fail", OnRupture::Fail), ("keep", OnRupture::Keep)];

/// A search of a script.
pub(super) struct ScriptSearch {
    pub(super) search: Search,
    pub(super) on_rupture: OnRupture,
    pub(super) labels: Labels,
    /// The objective.
    pub(super) call: FnPtr,
}

impl ScriptSearch {
    /// The search for the arguments of `minimize`.
    pub(super) fn new(method: &str, start: &Array, options: &Map, call: FnPtr) -> HostResult<ScriptSearch> {
        let method = word("method", method, &Method::NAMES)?;
        let mut search = Search::new(method, numbers(start, "start")?);
        let mut on_rupture = OnRupture::default();
        let unknowns = search.start.len();
        let mut labels = Labels::default();
        let mut signals: Vec<String> = vec![];
        let mut sides = [None, None];
        for (option, value) in options {
            let list = || match value.read_lock::<Array>() {
                Some(list) => Ok(list.clone()),
                None => Err(refuse(format!("`{option}` is a list, not {}", value.type_name()))),
            };
            let text = || {
                let text = value.clone().into_immutable_string();
                text.map_err(|found| refuse(format!("`{option}` must be a string, not {found}")))
            };
            match option.as_str() {
                "tol_x" => search.tol_x = number(value, option)?,
                "tol_f" => search.tol_f = number(value, option)?,
                "difference" => search.difference = number(value, option)?,
                "max_iterations" => search.max_iterations = count(value, option, MAX_COUNT)?,
                "max_evaluations" => search.max_evaluations = count(value, option, MAX_COUNT)?,
                "seed" => search.seed = whole(value, option)?.cast_unsigned(),
                "lower" => sides[0] = Some(side(&list()?, f64::NEG_INFINITY, option)?),
                "upper" => sides[1] = Some(side(&list()?, f64::INFINITY, option)?),
                "starts" if value.is_array() => search.starts = Starts::Given(points(&list()?)?),
                "starts" => search.starts = Starts::Spread(count(value, option, MAX_COUNT)?),
                "on_rupture" => on_rupture = word(option, &text()?, &ON_RUPTURE)?,
                "names" => search.names = list()?.iter().map(Dynamic::to_string).collect(),
                "title" => labels.title = Some(text()?.to_string()),
                "signals" => signals = list()?.iter().map(Dynamic::to_string).collect(),
                other => return Err(unknown_option("minimize", other, OPTIONS)),
            }
        }
        if search.names.len() != unknowns {
            return Err(refuse(OptionsError::Names { found: search.names.len(), unknowns }));
        }
        check_labels(&search.names, &labels, &signals)?;
        labels.signals = signals.iter().map(|text| SignalLabel::parse(text)).collect();
        let [lower, upper] = sides;
        search.bounds = Bounds::new(&search.names, lower, upper).map_err(refuse)?;
        Ok(ScriptSearch { search, on_rupture, labels, call })
    }
}

fn check_labels(names: &[String], labels: &Labels, signals: &[String]) -> HostResult<()> {
    let mut all = names.iter().chain(signals).chain(&labels.title);
    let fits = |text: &String| !text.trim().is_empty() && text.chars().count() <= MAX_LENGTH;
    let message =
        || format!("`title`, `names` and `signals` of a search must be strings of 1 to {MAX_LENGTH} characters");
    if all.all(fits) { Ok(()) } else { Err(refuse(message())) }
}

/// The value of a word among `known`.
pub(super) fn word<T: Copy>(what: &str, text: &str, known: &[(&'static str, T)]) -> HostResult<T> {
    let found = known.iter().find(|(name, _)| *name == text).map(|(_, value)| *value);
    found.ok_or_else(|| unknown(what, text, known.iter().map(|(name, _)| *name)))
}

/// The error for a word that is not among `known`, with the closest one as a hint.
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

/// The error for an option that `function` does not have.
pub(super) fn unknown_option<'k>(
    function: &str,
    option: &str,
    known: impl IntoIterator<Item = &'k str> + Clone,
) -> Box<EvalAltResult> {
    let gone = |function: &str| removed::function(&format!("{function}.{option}"));
    match gone(function).or_else(|| gone("minimize")) {
        Some(hint) => refuse(format!("unknown option `{option}` ({hint})")),
        None => unknown("option", option, known),
    }
}

/// An integer of 1 to `max`.
pub(super) fn count(value: &Dynamic, option: &str, max: INT) -> HostResult<usize> {
    let count = whole(value, option)?;
    let fits = usize::try_from(count).ok().filter(|_| (1..=max).contains(&count));
    fits.ok_or_else(|| refuse(format!("`{option}` is {count}, which must be 1 to {max}")))
}

fn whole(value: &Dynamic, option: &str) -> HostResult<INT> {
    value.as_int().map_err(|found| refuse(format!("`{option}` is a whole number, not {found}")))
}

fn numbers(list: &Array, what: &str) -> HostResult<Vec<f64>> {
    list.iter().map(|item| number(item, what)).collect()
}

/// Bounds of one side; `()` is `none`.
fn side(list: &Array, none: f64, what: &str) -> HostResult<Vec<f64>> {
    list.iter().map(|item| if item.is_unit() { Ok(none) } else { number(item, what) }).collect()
}

fn points(list: &Array) -> HostResult<Vec<Vec<f64>>> {
    let point = |item: &Dynamic| match item.read_lock::<Array>() {
        Some(point) => numbers(&point, "starts"),
        None => Err(refuse(format!("`starts` is a number or a list of lists, with {} in it", item.type_name()))),
    };
    list.iter().map(point).collect()
}
