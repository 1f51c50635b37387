//! `droptower explain`: unit, range, default and sentence of the keys under a path, and the topics beside them: script
//! functions, codes of findings, columns of signals and energies, figures, solvers, formats of recordings.

use ::card::Target;
use clap::Args;
use serde::Serialize;
use serde_json::{Value as Json, json};

use crate::{Failure, Shared, checkpoint, print, print_json, shell, shipped};
use base::diagnostic::{Diagnostic, closest, did_you_mean};
use base::finding::Code;
use base::group;
use base::removed;
use lab::signal::column::{self, COLUMNS, Column};
use lab::signal::format::{FORMATS, Support};
use scene::model::exclusions;
use scene::scenario::grammar::{self, Key, Rule, TableRule};
use scene::simulate::{EnergyTerm, energy_columns};
use study::calibrate;
use study::post::{self, FigureName, HEADLINES, Headline};
use study::reference::{Chapter, Entry, chapters};
use study::store::run_files::{ENERGIES, SIGNALS};

#[derive(Debug, Args)]
pub(super) struct ExplainArgs {
    /// Key path, e.g. specimen.mesh, or its end, e.g. mesh [default: the top tables]; a script function, e.g. plot; the code of a
    /// finding, e.g. coarse-contact; a column of signals.csv or energies.csv, e.g. clamp_slip_m; a figure of summary.json, e.g.
    /// energy_absorption; a solver that cards are written for, e.g. ls-dyna; `keys`, `functions`, `findings`, `columns`,
    /// `figures` or `solvers` for all of them; `formats` for the formats of recordings
    #[arg(value_name = "KEY", add = shell::keys())]
    pub path: Option<String>,
}

/// What is printed: objects for a program, or paragraphs for a person.
#[derive(Default)]
pub(super) struct Explanation {
    facts: Vec<Json>,
    paragraphs: Vec<String>,
}

impl FromIterator<(Json, String)> for Explanation {
    fn from_iter<I: IntoIterator<Item = (Json, String)>>(entries: I) -> Explanation {
        let (facts, paragraphs) = entries.into_iter().unzip();
        Explanation { facts, paragraphs }
    }
}

/// A word in place of a key, and all that it lists.
type Topic = (&'static str, fn() -> Explanation);

const TOPICS: [Topic; 7] = [
    ("keys", || keys(top_keys().flat_map(|key| under(&key.name, key)).collect())),
    ("functions", || functions(None)),
    ("findings", || findings().map(finding_entry).collect()),
    ("columns", || columns().collect()),
    ("figures", || post::figures().iter().map(|figure| figure_entry(&figure.name, None, figure)).collect()),
    ("solvers", || Target::ALL.into_iter().map(solver_entry).collect()),
    ("formats", formats),
];

pub(super) fn run(args: &ExplainArgs, shared: &Shared) -> Result<(), Failure> {
    let Explanation { facts, paragraphs } = match args.path.as_deref() {
        None => keys(top_keys().map(|key| KeyEntry::new(&key.name, key)).collect()),
        Some(path) => explained(path)?,
    };
    if shared.json { print_json(&facts) } else { print(&paragraphs.join("\n\n")) }
}

/// What `path` names: a topic, a solver, a kind of file, a key, a function, a finding, the end of keys, a figure or a column.
fn explained(path: &str) -> Result<Explanation, Diagnostic> {
    if let Some((_, all)) = TOPICS.iter().find(|(word, _)| *word == path) {
        return Ok(all());
    }
    if let Some(target) = Target::ALL.into_iter().find(|target| target.key() == path) {
        return Ok([solver_entry(target)].into_iter().collect());
    }
    if let Some(kind) = kind(path) {
        return Ok(keys(whole(kind)));
    }
    let mistake = match find(path) {
        Ok((name, key)) => return Ok(keys(under(&name, key))),
        Err(mistake) => mistake,
    };
    if chapters().iter().any(|chapter| !called(chapter, Some(path)).is_empty()) {
        return Ok(functions(Some(path)));
    }
    if let Some(code) = finding(path) {
        return Ok([finding_entry(code)].into_iter().collect());
    }
    match &ending(path)[..] {
        // A figure such as `peak_acceleration_m_s2` ends like a column.
        [] => figure(path)
            .or_else(|| shipped::figure(path))
            .or_else(|| column(path))
            .ok_or_else(|| with_similar_name(mistake, path)),
        [(name, key)] => Ok(keys(under(name, key))),
        several => Ok(keys(several.iter().map(|(name, key)| KeyEntry::new(name, key)).collect())),
    }
}

/// The mistake with the code of a finding, a column or a figure as its hint, where the unknown `path` is like one and is
/// written like one.
fn with_similar_name(mistake: Diagnostic, path: &str) -> Diagnostic {
    let is_name = path.contains('_') && !path.contains('.');
    let gone = || removed::key(path).or_else(|| removed::function(path)).or_else(|| removed::finding(path));
    let code = || similar_finding(path).filter(|_| path.contains('-'));
    let figures = post::figures();
    let figures = figures.iter().map(|figure| figure.name.as_str());
    let columns = COLUMNS.iter().map(|column| column.name).chain(energy_columns().map(|term| term.name));
    let column = || closest(path, columns).map(|name| format!("did you mean the column `{name}`?"));
    let figure = || closest(path, figures).map(|name| format!("did you mean the figure `{name}`?"));
    let named = || if is_name { column().or_else(figure) } else { None };
    mistake.hint_if(gone().or_else(code).or_else(named))
}

/// The entry of one key.
#[derive(Serialize)]
struct KeyEntry {
    key: String,
    sentence: Option<String>,
    expected: String,
    unit: Option<&'static str>,
    range: Option<String>,
    likely: Option<String>,
    default: Option<Json>,
    required: bool,
    choices: Vec<Choice>,
    refused_beside: Vec<&'static str>,
}

#[derive(Serialize)]
struct Choice {
    word: String,
    sentence: Option<String>,
}

/// The entries of keys; those that mean the same, as those of the specimen's material and of a layer's, share a paragraph.
fn keys(entries: Vec<KeyEntry>) -> Explanation {
    let texts = group::by_key(entries.iter().map(|entry| (entry.text(), entry.key.as_str())));
    let paragraphs = texts.into_iter().map(|(text, keys)| format!("{}\n    {text}", keys.join("\n"))).collect();
    Explanation { facts: entries.iter().map(|entry| json!(entry)).collect(), paragraphs }
}

fn top_keys() -> impl Iterator<Item = &'static Key> {
    grammar::scenario().table().into_iter().flat_map(|table| &table.keys)
}

/// A kind of file besides scenarios: the word that its keys begin with, and its rule.
type Kind = (&'static str, fn() -> &'static Rule);

/// Files besides scenarios: `expect.toml`, studies.
const KINDS: [Kind; 2] = [("expect", grammar::expectations), ("study", calibrate::rule)];

/// The kind of file of this name.
fn kind(word: &str) -> Option<Kind> {
    KINDS.into_iter().find(|(name, _)| *name == word)
}

/// All keys of a kind of file.
fn whole((word, rule): Kind) -> Vec<KeyEntry> {
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
        let keys = keys_under(rule).ok_or_else(|| Diagnostic::new(format!("`{name}` has no keys of its own")))?;
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

fn unknown(step: &str, name: &str, keys: &TableRule) -> Diagnostic {
    let place = if name.is_empty() { "a scenario".to_owned() } else { format!("`{name}`") };
    let names = || keys.keys.iter().map(|key| key.name.as_str());
    let hint = did_you_mean(step, names());
    let hint = hint.unwrap_or_else(|| format!("it has {}", names().collect::<Vec<_>>().join(", ")));
    Diagnostic::new(format!("{place} has no key `{step}`")).hint(hint)
}

/// The keys of a table, or of the tables in a list.
fn keys_under(rule: &Rule) -> Option<&TableRule> {
    rule.table().or_else(|| rule.item(0)?.table())
}

/// The key and everything under it.
fn under(name: &str, key: &Key) -> Vec<KeyEntry> {
    let mut all = vec![KeyEntry::new(name, key)];
    if let Some(table) = keys_under(&key.rule) {
        all.extend(table.keys.iter().flat_map(|child| under(&format!("{name}.{}", child.name), child)));
        let others = table.others.as_deref().and_then(keys_under).into_iter().flat_map(|table| &table.keys);
        all.extend(others.flat_map(|child| under(&format!("{name}.<name>.{}", child.name), child)));
    }
    all
}

impl KeyEntry {
    fn new(name: &str, key: &Key) -> KeyEntry {
        let dimension = key.rule.dimension();
        let show = |bound: f64| dimension.map_or(bound.to_string(), |d| d.show(bound));
        let likely = key.rule.range().and_then(|range| range.likely);
        let choice = |(word, sentence): (&str, Option<&str>)| Choice {
            word: word.to_owned(),
            sentence: sentence.map(str::to_owned),
        };
        let place = name.replace("layer.material.", "specimen.material.");
        KeyEntry {
            key: name.to_owned(),
            sentence: key.sentence.clone(),
            expected: key.rule.to_string(),
            unit: dimension.filter(|_| !key.rule.takes_bare_number()).map(|d| d.unit),
            range: key.rule.range().and_then(|range| range.describe(show)),
            likely: likely.map(|[low, high]| format!("{} to {}", show(low), show(high))),
            default: key.default.clone().filter(|default| !default.is_object()),
            required: key.required,
            choices: key.rule.words().into_iter().map(choice).collect(),
            refused_beside: exclusions().into_iter().filter_map(|(key, it)| (key == place).then_some(it)).collect(),
        }
    }

    /// The entry without the path of its key.
    fn text(&self) -> String {
        let mut lines: Vec<String> = self.sentence.iter().cloned().collect();
        let mut facts = vec![self.expected.clone()];
        facts.extend(self.unit.map(|unit| format!("a bare number is in {unit}")));
        facts.extend(self.range.clone());
        facts.extend(self.likely.as_ref().map(|likely| format!("usually {likely}")));
        facts.extend(self.default.as_ref().map(|default| format!("default {default}")));
        facts.extend(self.required.then(|| "required".to_owned()));
        lines.push(facts.join("; "));
        let described = self.choices.iter().filter_map(|choice| {
            let sentence = choice.sentence.as_ref()?;
            Some(format!("  \"{}\": {sentence}", choice.word))
        });
        lines.extend(described);
        lines.extend(self.refused_beside.iter().map(|beside| match beside.strip_prefix("no ") {
            Some(lacking) => format!("refused without {lacking}"),
            None => format!("refused beside {beside}"),
        }));
        lines.join("\n    ")
    }
}

/// The reference of scripts: all of it, or the entries in which the function `name` is called; a paragraph a chapter.
fn functions(name: Option<&str>) -> Explanation {
    let mut all = Explanation::default();
    for chapter in chapters() {
        let entries = called(chapter, name);
        let text = entries
            .iter()
            .map(|Entry { call, gives, example }| format!("\n  {call}\n      {gives}\n      e.g. {example}"));
        let text: String = text.collect();
        all.paragraphs.extend((!entries.is_empty()).then(|| format!("{}{text}", chapter.title)));
        all.facts.extend(entries.iter().map(|Entry { call, gives, example }| {
            json!({ "chapter": chapter.title, "call": call, "gives": gives, "example": example })
        }));
    }
    all
}

/// The entries of a chapter in which `name` is called; all of them where there is no name.
fn called(chapter: &'static Chapter, name: Option<&str>) -> Vec<&'static Entry> {
    let calls = |call: &str, name: &str| {
        let opened = format!("{name}(");
        let begins = |at: usize| !call[..at].ends_with(|c: char| c.is_alphanumeric() || c == '_');
        call.match_indices(&opened).any(|(at, _)| begins(at))
    };
    chapter.entries.iter().filter(|entry| name.is_none_or(|name| calls(&entry.call, name))).collect()
}

/// The codes of all findings, module by module.
fn findings() -> impl Iterator<Item = &'static Code> {
    let of_cards = [::card::CODES, ::card::read::CODES, ::card::deck::CODES];
    study::codes::all().chain(of_cards.into_iter().flatten().chain(checkpoint::CODES).copied())
}

/// The code `name`, which may be written as the terminal prints it: `warning[coarse-contact]`.
pub(super) fn finding(name: &str) -> Option<&'static Code> {
    let name = bare(name);
    findings().find(|code| code.name == name)
}

/// The code whose name is like `name`, as a hint.
pub(super) fn similar_finding(name: &str) -> Option<String> {
    let meant = misspelt_finding(bare(name)).or_else(|| closest(bare(name), findings().map(|code| code.name)));
    meant.map(|name| format!("did you mean the finding `{name}`?"))
}

/// The code that differs from `name` by at most two letters.
pub(super) fn misspelt_finding(name: &str) -> Option<&'static str> {
    findings().map(|code| code.name).find(|known| strsim::damerau_levenshtein(known, name) <= 2)
}

/// `coarse-contact` of `warning[coarse-contact]:`, of `[coarse-contact]` and of itself.
fn bare(text: &str) -> &str {
    let enclosed = text.trim_end_matches(':').strip_suffix(']').and_then(|text| text.split_once('['));
    match enclosed {
        Some(("" | "warning" | "note", name)) => name,
        _ => text,
    }
}

fn finding_entry(code: &Code) -> (Json, String) {
    let text = format!("{} ({})\n    {}\n    what to do: {}", code.name, code.severity, code.meaning, code.remedy);
    (json!(code), text)
}

/// All columns.
fn columns() -> impl Iterator<Item = (Json, String)> {
    let signals = COLUMNS.iter().map(|column| signal_entry(column.name, "", column));
    signals.chain(energy_columns().map(energy_entry))
}

/// The column `name`, which may begin with the name of an impactor; only what a column of a run may be called.
fn column(name: &str) -> Option<Explanation> {
    if let Some(term) = energy_columns().find(|term| term.name == name) {
        return Some([energy_entry(term)].into_iter().collect());
    }
    let (prefix, column) = column::find(name)?;
    let is_possible = prefix.is_empty() || column.is_of_each_impactor;
    is_possible.then(|| [signal_entry(name, prefix, column)].into_iter().collect())
}

fn signal_entry(name: &str, prefix: &str, column: &Column) -> (Json, String) {
    let script = format!("run.{prefix}{}", column.short);
    column_entry(name, SIGNALS, prefix.strip_suffix('_'), column.sentence, [column.unit, column.when, &script])
}

fn energy_entry(term: EnergyTerm) -> (Json, String) {
    let script = format!("run.energies.{}", term.name);
    column_entry(term.name, ENERGIES, None, term.sentence, ["J", "of every run", &script])
}

fn column_entry(
    name: &str,
    file: &str,
    impactor: Option<&str>,
    sentence: &[&str],
    [unit, when, script]: [&str; 3],
) -> (Json, String) {
    let sentence = sentence.iter().map(|line| line.trim()).collect::<Vec<_>>().join(" ");
    let facts = json!({
        "column": name,
        "file": file,
        "impactor": impactor,
        "sentence": sentence,
        "unit": unit,
        "when": when,
        "script": script,
    });
    let unit = if unit.is_empty() { "a ratio or a number".to_owned() } else { format!("in {unit}") };
    let whose = of_impactor(impactor);
    let text =
        format!("{name}\n    {sentence}{whose}\n    column of {file}; {unit}; {when}\n    in scripts `{script}`");
    (facts, text)
}

fn of_impactor(name: Option<&str>) -> String {
    name.map_or_else(String::new, |name| format!("\n    of the impactor \"{name}\""))
}

/// The figure `name` of `summary.json`, which may begin with the name of an impactor; none where no run has one.
fn figure(name: &str) -> Option<Explanation> {
    let all = post::figures();
    // `E_a` of a page and of the terminal is `acceleration_error`.
    let symbol = |headline: &&Headline| headline.words.rsplit(' ').next() == Some(name) && name.contains('_');
    let name = HEADLINES.iter().find(symbol).map_or(name, |headline| headline.name);
    let exact: Vec<_> =
        all.iter().filter(|figure| figure.name == name).map(|figure| figure_entry(name, None, figure)).collect();
    if !exact.is_empty() {
        return Some(exact.into_iter().collect());
    }
    let of_impactor = |figure: &FigureName| {
        let prefix = name.strip_suffix(&figure.name)?.strip_suffix('_')?;
        (figure.is_of_each_impactor && !prefix.is_empty()).then_some(prefix)
    };
    let (prefix, figure) =
        all.iter().filter_map(|figure| Some((of_impactor(figure)?, figure))).min_by_key(|(prefix, _)| prefix.len())?;
    Some([figure_entry(name, Some(prefix), figure)].into_iter().collect())
}

fn figure_entry(name: &str, impactor: Option<&str>, figure: &FigureName) -> (Json, String) {
    let FigureName { sentence, loadings, .. } = figure;
    let unit = column::dimension(&figure.name).map_or("", |dimension| dimension.unit);
    let script = format!("run.summary.{name}");
    let facts = json!({
        "figure": name,
        "impactor": impactor,
        "sentence": sentence,
        "unit": unit,
        "loadings": loadings,
        "script": script,
    });
    let unit = if unit.is_empty() { String::new() } else { format!("; in {unit}") };
    let (whose, of) = (of_impactor(impactor), loadings.join(", "));
    let text = format!(
        "{name}\n    {sentence}{whose}\n    figure of summary.json{unit}; of loading.{of}\n    in scripts `{script}`"
    );
    (facts, text)
}

/// What a solver is written.
fn solver_entry(target: Target) -> (Json, String) {
    let (key, about) = (target.key(), target.about());
    let write = format!("droptower export card FILM --for {key} -o film.{}", target.ending());
    let facts = json!({ "solver": target.name(), "write": write, "laws": about.laws, "advice": about.advice });
    let laws = about.laws.iter().map(|(film, keyword)| format!("{film}: {keyword}"));
    let advice = about.advice.iter().map(|sentence| format!("note: {sentence}"));
    let lines = std::iter::once(write).chain(laws).chain(advice).map(|line| format!("\n    {line}"));
    (facts, format!("{}{}", target.name(), lines.collect::<String>()))
}

/// The formats of recordings that are read, and how to convert others.
fn formats() -> Explanation {
    let entry = |format: &lab::signal::format::Format| {
        let (read, convert) = match format.support {
            Support::Read(how, _) => (Some(how), None),
            Support::Refused(conversion) => (None, Some(conversion)),
        };
        let (name, endings) = (format.name, format.endings);
        let facts = json!({
            "format": name,
            "endings": endings,
            "is_read": read.is_some(),
            "read": read,
            "convert": convert,
        });
        let what = match (read, convert) {
            (Some(read), _) => read.to_owned(),
            (None, convert) => format!("not read; {}", convert.unwrap_or_default()),
        };
        (facts, format!("{name} ({endings})\n    {what}"))
    };
    FORMATS.iter().map(entry).collect()
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use super::*;
    use base::finding::is_code;

    #[test]
    fn a_code_is_found_as_the_terminal_prints_it() {
        for written in ["coarse-contact", "[coarse-contact]", "warning[coarse-contact]", "warning[coarse-contact]:"] {
            assert_eq!(finding(written).map(|code| code.name), Some("coarse-contact"), "{written}");
        }
        let hint = similar_finding("warning[corse-contact]");
        assert_eq!(hint.as_deref(), Some("did you mean the finding `coarse-contact`?"));
        assert_eq!(finding("frame[coarse-contact]"), None);
    }

    #[test]
    fn what_excludes_a_key_is_explained() {
        for (name, beside) in exclusions() {
            let (found, key) = find(&name).expect("a key");
            assert!(
                found == name && KeyEntry::new(&name, key).text().contains(beside.trim_start_matches("no ")),
                "{name}"
            );
        }
    }

    #[test]
    fn codes_are_unique_well_formed_and_explained() {
        let mut seen = HashSet::new();
        for code in findings() {
            assert!(is_code(code.name), "{}", code.name);
            assert!(seen.insert(code.name), "{} has two meanings", code.name);
            for text in [code.meaning, code.remedy] {
                assert!(text.starts_with(char::is_lowercase) || text.starts_with('`'), "{}: {text}", code.name);
                assert!(!text.ends_with('.') && !text.contains("  "), "{}: {text}", code.name);
            }
        }
        assert!(!seen.is_empty());
    }
}
