//! `droptower explain`: unit, range, default and sentence of the keys under a path, script functions, codes of
//! findings, columns of signals and energies, figures, solvers, formats of recordings.

use clap::Args;
use serde::Serialize;
use serde_json::Value as Json;

use super::export::card as solvers;
use super::script::shipped;
use super::{Failure, Shared, codes, columns, complete, figures, functions, print, print_json, readable};
use base::diagnostic::{Diagnostic, closest};
use base::removed;
use scene::scenario::grammar::{self, Key, Rule, TableRule};

#[derive(Debug, Args)]
pub(super) struct ExplainArgs {
    /// Key path, e.g. specimen.mesh, or its end, e.g. mesh [default: the top tables]; a script function, e.g. plot; the code of a finding,
    /// e.g. coarse-contact; a column of signals.csv or energies.csv, e.g. clamp_slip_m; a figure of summary.json, e.g. energy_absorption; a solver that cards are
    /// written for, e.g. ls-dyna; `keys`, `functions`, `findings`, `columns`, `figures` or `solvers` for all of them; `formats` for the
    /// formats of recordings
    #[arg(value_name = "KEY", add = complete::keys())]
    pub path: Option<String>,
}

/// The word in place of a key that lists all keys of scenarios.
const WORD: &str = "keys";

/// The entry of one key.
#[derive(Serialize)]
struct Explanation {
    key: String,
    sentence: Option<String>,
    expected: String,
    unit: Option<&'static str>,
    range: Option<String>,
    likely: Option<String>,
    default: Option<Json>,
    required: bool,
    choices: Vec<Choice>,
}

#[derive(Serialize)]
struct Choice {
    word: String,
    sentence: Option<String>,
}

pub(super) fn run(args: &ExplainArgs, shared: &Shared) -> Result<(), Failure> {
    match args.path.as_deref() {
        Some(functions::WORD) => return functions::run(None, shared),
        Some(codes::WORD) => return codes::run(None, shared),
        Some(columns::WORD) => return columns::all(shared),
        Some(figures::WORD) => return figures::all(shared),
        Some(solvers::WORD) => return solvers::explain(None, shared),
        Some(readable::WORD) => return readable::run(shared),
        _ => {}
    }
    if let Some(target) = args.path.as_deref().and_then(solvers::find) {
        return solvers::explain(Some(target), shared);
    }
    let explanations = match &args.path {
        Some(path) if path == WORD => top_keys().flat_map(|key| under(&key.name, key)).collect(),
        Some(path) if kind(path).is_some() => kind(path).map(whole).unwrap_or_default(),
        Some(path) => match find(path) {
            Ok((name, key)) => under(&name, key),
            Err(_) if functions::are_called(path) => return functions::run(Some(path), shared),
            Err(mistake) => match (codes::find(path), ending(path).as_slice()) {
                (Some(code), _) => return codes::run(Some(code), shared),
                // A figure such as `peak_acceleration_m_s2` ends like a column.
                (None, []) if figures::run(path, shared)? => return Ok(()),
                (None, []) if shipped::explain(path, shared)? => return Ok(()),
                (None, []) => match columns::find(path) {
                    Some(column) => return columns::run(path, column, shared),
                    None => return Err(with_code(mistake, path).into()),
                },
                (None, [(name, key)]) => under(name, key),
                (None, several) => several.iter().map(|(name, key)| explanation(name, key)).collect(),
            },
        },
        None => top(),
    };
    if shared.json {
        return print_json(&explanations);
    }
    print(&texts(&explanations).join("\n\n"))
}

/// The texts of all; keys that mean the same, as those of the specimen's material and of a layer's, share one.
fn texts(explanations: &[Explanation]) -> Vec<String> {
    let mut texts: Vec<(Vec<&str>, String)> = Vec::new();
    for explanation in explanations {
        let text = text(explanation);
        match texts.iter_mut().find(|(_, other)| *other == text) {
            Some((keys, _)) => keys.push(&explanation.key),
            None => texts.push((vec![&explanation.key], text)),
        }
    }
    texts.into_iter().map(|(keys, text)| format!("{}\n    {text}", keys.join("\n"))).collect()
}

/// The mistake with the code of a finding, a column or a figure as its hint, where the unknown `path` is like one and is
/// written like one.
fn with_code(mistake: Diagnostic, path: &str) -> Diagnostic {
    let code = codes::hint(path).filter(|_| path.contains('-'));
    let is_name = path.contains('_') && !path.contains('.');
    let column = || closest(path, columns::names()).map(|name| format!("did you mean the column `{name}`?"));
    let figures: Vec<String> = if is_name { figures::names().collect() } else { vec![] };
    let figure =
        || closest(path, figures.iter().map(String::as_str)).map(|name| format!("did you mean the figure `{name}`?"));
    let gone = removed::key(path).or_else(|| removed::function(path)).or_else(|| removed::finding(path));
    match gone.or(code).or_else(|| column().filter(|_| is_name)).or_else(figure) {
        Some(hint) => mistake.hint(hint),
        None => mistake,
    }
}

/// The tables of a scenario, without their keys.
fn top() -> Vec<Explanation> {
    top_keys().map(|key| explanation(&key.name, key)).collect()
}

fn top_keys() -> impl Iterator<Item = &'static Key> {
    grammar::scenario().table().into_iter().flat_map(|table| &table.keys)
}

/// A kind of file besides scenarios: the word that its keys begin with, and its rule.
type Kind = (&'static str, fn() -> &'static Rule);

/// Files besides scenarios: `expect.toml`.
const KINDS: [Kind; 1] = [("expect", grammar::expectations)];

/// The kind of file of this name.
fn kind(word: &str) -> Option<Kind> {
    KINDS.into_iter().find(|(name, _)| *name == word)
}

/// All keys of a kind of file.
fn whole((word, rule): Kind) -> Vec<Explanation> {
    let keys = rule().table().into_iter().flat_map(|table| &table.keys);
    keys.flat_map(|key| under(&format!("{word}.{}", key.name), key)).collect()
}

/// The key at `path` and its name; a number in the path (an item of a list) is skipped.
fn find(path: &str) -> Result<(String, &'static Key), Diagnostic> {
    let kind = path.split_once('.').and_then(|(word, rest)| Some((kind(word)?, rest)));
    let (mut rule, mut name, path) = match kind {
        Some(((word, rule), rest)) => (rule(), word.to_owned(), rest),
        None => (grammar::scenario(), String::new(), path),
    };
    let mut found = None;
    for step in path.split('.').filter(|step| step.parse::<usize>().is_err()) {
        let keys = keys_under(rule).ok_or_else(|| nothing_under(&name))?;
        if let (None, Some(others)) = (keys.key(step), &keys.others) {
            name = format!("{name}.{step}");
            rule = others;
            continue;
        }
        let key = keys.key(step).ok_or_else(|| unknown(step, &name, keys))?;
        name = if name.is_empty() { key.name.clone() } else { format!("{name}.{}", key.name) };
        rule = &key.rule;
        found = Some(key);
    }
    found.map(|key| (name, key)).ok_or_else(|| Diagnostic::new(format!("`{path}` is not a key")))
}

/// The keys at any depth whose paths end with `path`.
fn ending(path: &str) -> Vec<(String, &'static Key)> {
    let suffix = format!(".{path}");
    let all = top_keys().flat_map(|key| paths(key.name.clone(), key));
    all.filter(|(whole, _)| whole.ends_with(&suffix)).collect()
}

/// The path of the key and of everything under it.
fn paths(name: String, key: &'static Key) -> Vec<(String, &'static Key)> {
    let children = keys_under(&key.rule).into_iter().flat_map(|table| &table.keys);
    let below: Vec<_> = children.flat_map(|child| paths(format!("{name}.{}", child.name), child)).collect();
    std::iter::once((name, key)).chain(below).collect()
}

fn nothing_under(name: &str) -> Diagnostic {
    Diagnostic::new(format!("`{name}` has no keys of its own"))
}

fn unknown(step: &str, name: &str, keys: &TableRule) -> Diagnostic {
    let place = if name.is_empty() { "a scenario".to_owned() } else { format!("`{name}`") };
    let mistake = Diagnostic::new(format!("{place} has no key `{step}`"));
    let names = || keys.keys.iter().map(|key| key.name.as_str());
    match closest(step, names()) {
        Some(name) => mistake.hint(format!("did you mean `{name}`?")),
        None => mistake.hint(format!("it has {}", names().collect::<Vec<_>>().join(", "))),
    }
}

/// The keys of a table, or of the tables in a list.
fn keys_under(rule: &Rule) -> Option<&TableRule> {
    rule.table().or_else(|| rule.item(0)?.table())
}

/// The key and everything under it.
fn under(name: &str, key: &Key) -> Vec<Explanation> {
    let mut all = vec![explanation(name, key)];
    if let Some(table) = keys_under(&key.rule) {
        all.extend(table.keys.iter().flat_map(|child| under(&format!("{name}.{}", child.name), child)));
        let others = table.others.as_deref().and_then(keys_under).into_iter().flat_map(|table| &table.keys);
        all.extend(others.flat_map(|child| under(&format!("{name}.<name>.{}", child.name), child)));
    }
    all
}

fn explanation(name: &str, key: &Key) -> Explanation {
    let dimension = key.rule.dimension();
    let show = |bound: f64| dimension.map_or(bound.to_string(), |d| d.show(bound));
    let choices = key.rule.words().into_iter();
    Explanation {
        key: name.to_owned(),
        sentence: key.sentence.clone(),
        expected: key.rule.to_string(),
        unit: dimension.filter(|_| !key.rule.takes_bare_number()).map(|d| d.unit),
        range: key.rule.range().and_then(|range| range.describe(show)),
        likely: key
            .rule
            .range()
            .and_then(|range| range.likely)
            .map(|[low, high]| format!("{} to {}", show(low), show(high))),
        default: key.default.clone().filter(|default| !default.is_object()),
        required: key.required,
        choices: choices
            .map(|(word, sentence)| Choice { word: word.to_owned(), sentence: sentence.map(str::to_owned) })
            .collect(),
    }
}

/// The entry of a key without its path.
fn text(explanation: &Explanation) -> String {
    let mut lines: Vec<String> = explanation.sentence.iter().cloned().collect();
    let mut facts = vec![explanation.expected.clone()];
    facts.extend(explanation.unit.map(|unit| format!("a bare number is in {unit}")));
    facts.extend(explanation.range.clone());
    facts.extend(explanation.likely.as_ref().map(|likely| format!("usually {likely}")));
    facts.extend(explanation.default.as_ref().map(|default| format!("default {default}")));
    if explanation.required {
        facts.push("required".to_owned());
    }
    lines.push(facts.join("; "));
    let described = explanation.choices.iter().filter_map(|choice| {
        let sentence = choice.sentence.as_ref()?;
        Some(format!("  \"{}\": {sentence}", choice.word))
    });
    lines.extend(described);
    lines.join("\n    ")
}
