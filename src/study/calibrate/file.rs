//! A calibration as a file: tests, parameters, and what follows for other scenarios, in TOML (docs/calibration.md).
//!
//! `study.schema.json` has every key with its sentence: the checks, `droptower explain` and the options of `calibrate` in scripts
//! follow from it. The file becomes the calls of a script that has the same specification, a line an entry, so that a mistake in a
//! line is one of the file's line. Scenarios that are predicted, and candidates, are read before the calibration, which takes long.

use std::fmt::Write as _;
use std::path::Path;
use std::sync::{Arc, LazyLock};

use base::diagnostic::{Diagnostic, Source, Span, closest};
use base::file;
use scene::scenario::grammar::{self, TableRule};
use scene::scenario::{Entry, Node, Rule, Table, Value, parse_tree, schema_for_editors, validate};
use serde_json::Value as Json;

use super::test::found_column;

/// Most bytes of a study.
const MOST_BYTES: u64 = 4 << 20;

/// Keys of the file that are no options of `calibrate`.
const FOLLOW: [&str; 4] = ["posterior", "predict", "candidate", "left_out"];
/// Keys whose texts are paths, seen from the file.
const PATHS: [&str; 4] = ["scenario", "scenarios", "candidate", "recordings"];
/// Keys of a test that a candidate, which was not made, does not have.
const OF_MADE: [&str; 5] = ["recordings", "own", "outcome", "failure_mass", "rupture_time"];

/// Keys, sentences and values of a study.
static SCHEMA: LazyLock<Json> = LazyLock::new(|| {
    let mut schema: Json = serde_json::from_str(include_str!("study.schema.json")).unwrap_or_default();
    let mut candidate = schema["properties"]["test"]["items"].clone();
    if let Some(keys) = candidate["properties"].as_object_mut() {
        OF_MADE.iter().for_each(|key| drop(keys.shift_remove(*key)));
    }
    schema["properties"]["candidate"]["items"] = candidate;
    schema
});

/// The schema of a study for editors.
pub fn schema() -> Json {
    schema_for_editors(SCHEMA.clone())
}

/// The rule of a study.
pub fn rule() -> &'static Rule {
    static RULE: LazyLock<Rule> = LazyLock::new(|| grammar::compile(&SCHEMA));
    &RULE
}

/// The names of the keys of a table, in their order.
fn names(table: Option<&'static TableRule>) -> impl Iterator<Item = &'static str> {
    table.into_iter().flat_map(|table| &table.keys).map(|key| key.name.as_str())
}

/// Options of `calibrate`.
pub(super) fn options() -> Vec<&'static str> {
    let own = names(rule().table()).filter(|name| !FOLLOW.contains(name));
    own.map(|name| if name == "test" { "tests" } else { name }).collect()
}

/// Options of a test.
pub(super) fn test_options() -> Vec<&'static str> {
    names(rule().at("test.0").and_then(Rule::table)).collect()
}

/// Options of a parameter that is no curve.
pub(super) fn parameter_options() -> Vec<&'static str> {
    let parameters = rule().at("parameters").and_then(Rule::table);
    names(parameters.and_then(|table| table.others.as_deref()).and_then(Rule::table)).collect()
}

/// Options of `posterior`.
pub(super) fn posterior_options() -> Vec<&'static str> {
    names(rule().at("posterior").and_then(Rule::table)).collect()
}

/// Options of `predict`.
pub(super) fn predict_options() -> Vec<&'static str> {
    names(rule().at("predict").and_then(Rule::table)).filter(|name| *name != "scenarios").collect()
}

/// A study that was read.
#[derive(Debug)]
pub struct StudyFile {
    /// The script that it stands for.
    pub script: String,
    /// Bytes of it until the end of the call that calibrates.
    called: usize,
    /// Of each of its lines the place in the file.
    places: Vec<Span>,
    /// What tests are called, and where each stands.
    tests: Vec<(String, Span)>,
    /// The file.
    pub source: Arc<Source>,
}

impl StudyFile {
    /// Reads the study at `path`.
    ///
    /// # Errors
    /// The file cannot be read, is no TOML, has keys that no study has, or lacks tests or parameters.
    pub fn read(path: &Path) -> Result<StudyFile, Vec<Diagnostic>> {
        let text = file::read_text(path, MOST_BYTES).map_err(|error| {
            let hint = error.hint().map(str::to_owned);
            vec![Diagnostic { hint, ..Diagnostic::new(format!("cannot read {}: {error}", path.display())) }]
        })?;
        let source = Source::file(path, text);
        let node = parse_tree(&source)?;
        let mut writer = Writer {
            script: String::new(),
            called: 0,
            places: Vec::new(),
            mistakes: validate(&node, rule()),
            folder: path.parent().unwrap_or(Path::new("")).to_owned(),
            first: Span::line(&source, 1),
        };
        if let Value::Table(table) = &node.value {
            writer.study(table);
        }
        let Writer { script, called, places, mistakes, .. } = writer;
        let tests = node.find("test").map_or(&[][..], items).iter();
        let tests = tests.filter_map(|test| Some((called_as(test)?.to_owned(), test.find("scenario")?.span.clone())));
        match mistakes.is_empty() {
            true => Ok(StudyFile { script, called, places, tests: tests.collect(), source }),
            false => Err(mistakes),
        }
    }

    /// The script until the call that calibrates: what reads scenarios, recordings, parameters and options.
    pub fn beginning(&self) -> &str {
        &self.script[..self.called]
    }

    /// The place in the file of a line of the script, or of the test that a message about it names.
    pub fn place(&self, line: usize, message: &str) -> Span {
        let named = message.strip_prefix("test `").and_then(|rest| rest.split_once('`'));
        let is_named = |(own, _): &&(String, Span)| named.is_some_and(|(name, _)| name.ends_with(own.as_str()));
        let of_line = || line.checked_sub(1).and_then(|line| self.places.get(line)).cloned();
        match self.tests.iter().find(is_named).map(|(_, span)| span.clone()) {
            Some(test) => test,
            None => of_line().unwrap_or_else(|| Span::line(&self.source, 1)),
        }
    }
}

/// Writes the script, a line an entry.
struct Writer {
    script: String,
    called: usize,
    places: Vec<Span>,
    mistakes: Vec<Diagnostic>,
    folder: std::path::PathBuf,
    /// The beginning of the file.
    first: Span,
}

impl Writer {
    fn study(&mut self, table: &Table) {
        self.check_names(table);
        let predict = table.get("predict").and_then(|entry| match &entry.node.value {
            Value::Table(table) => Some((entry, table)),
            _ => None,
        });
        let candidates = table.get("candidate");
        let predicted = predict.and_then(|(_, predict)| predict.get("scenarios"));
        for (name, read) in [("candidates", candidates), ("predicted", predicted)] {
            if let Some(entry) = read {
                self.line(&format!("let {name} ="), &entry.key_span);
                self.value(&entry.node, &entry.key, true);
                self.line(";", &entry.key_span);
            }
        }
        let first = self.first.clone();
        self.line("let study = calibrate(#{", &first);
        for entry in table.entries.iter().filter(|entry| !FOLLOW.contains(&entry.key.as_str())) {
            let name = if entry.key == "test" { "tests" } else { &entry.key };
            self.entry(name, &entry.node, &entry.key_span);
        }
        self.line("});", &first);
        self.called = self.script.len();
        if let Some(posterior) = table.get("posterior") {
            self.call("study.posterior(", posterior.node.clone(), &posterior.key_span);
        }
        if let Some((entry, predict)) = predict {
            let mut others = predict.clone();
            others.remove("scenarios");
            let others = Node::new(Value::Table(others), entry.node.span.clone());
            self.call("study.predict(predicted,", others, &entry.key_span);
        }
        if let Some(candidates) = candidates {
            self.line("study.settles(candidates);", &candidates.key_span);
        }
        match table.get("left_out").map(|entry| (&entry.node.value, entry)) {
            None | Some((Value::Flag(false), _)) => {}
            Some((Value::Flag(true), entry)) => self.line("study.left_out();", &entry.key_span),
            Some((_, entry)) => self.call("study.left_out(", entry.node.clone(), &entry.key_span),
        }
        self.line("study.page();", &first);
    }

    /// Names that nothing has are mistakes before a search that takes long.
    fn check_names(&mut self, table: &Table) {
        let of = |key: &str| table.get(key).map_or(&[][..], |entry| items(&entry.node));
        for test in of("test").iter().chain(of("candidate")) {
            for own in ["compare", "over"].into_iter().filter_map(|key| test.find(key)).flat_map(one_or_several) {
                let message = text(own).filter(|name| *name != "time").and_then(|name| found_column(name).err());
                self.mistakes.extend(message.map(|message| Diagnostic::new(message).at(&own.span)));
            }
        }
        let parameters: Vec<&Entry> = match table.get("parameters").map(|entry| &entry.node.value) {
            Some(Value::Table(table)) => table.entries.iter().collect(),
            _ => Vec::new(),
        };
        let known: Vec<&str> = parameters.iter().map(|entry| entry.key.as_str()).collect();
        let hierarchy = table.get("posterior").and_then(|entry| entry.node.find("hierarchy"));
        let own = of("test").iter().filter_map(|test| test.find("own"));
        self.known(hierarchy.into_iter().chain(own).flat_map(one_or_several), &known, "parameter");
        // Tests without a name have that of their scenario.
        let names: Option<Vec<&str>> = of("test").iter().map(|test| test.find("name").and_then(text)).collect();
        if let Some(names) = names {
            let left_out = of("left_out").iter().flat_map(one_or_several);
            let of_parameters = parameters.iter().filter_map(|own| own.node.find("tests")).flat_map(one_or_several);
            self.known(left_out.chain(of_parameters), &names, "test");
        }
    }

    /// Refuses names that are none of those that are known.
    fn known<'n>(&mut self, names: impl Iterator<Item = &'n Node>, known: &[&str], what: &str) {
        for own in names {
            let Some(name) = text(own).filter(|name| !known.contains(name)) else { continue };
            let mistake = Diagnostic::new(format!("there is no {what} `{name}`")).at(&own.span);
            let hint = closest(name, known.iter().copied()).map(|close| format!("did you mean `{close}`?"));
            self.mistakes.push(Diagnostic { hint, ..mistake });
        }
    }

    /// `begin argument);`
    fn call(&mut self, begin: &str, argument: Node, place: &Span) {
        self.line(begin, place);
        self.value(&argument, "", false);
        self.line(");", place);
    }

    fn line(&mut self, text: &str, place: &Span) {
        self.script.push_str(text);
        self.script.push('\n');
        self.places.push(place.clone());
    }

    fn entry(&mut self, key: &str, node: &Node, place: &Span) {
        // The key and the beginning of its value stand in one line.
        let _ = write!(self.script, "{}: ", quoted(key));
        self.value(node, key, false);
        self.line(",", place);
    }

    /// A value as a script writes it; of scenarios that are `read` the call that reads them.
    fn value(&mut self, node: &Node, key: &str, read: bool) {
        self.item(node, key, read, false);
    }

    /// The same of an entry of a list, which a pattern may stand for several of.
    fn item(&mut self, node: &Node, key: &str, read: bool, in_list: bool) {
        let place = &node.span;
        match &node.value {
            Value::Text(text) => {
                let is_path = PATHS.contains(&key);
                let path = self.folder.join(text);
                let shown = if is_path { path.to_string_lossy().into_owned() } else { text.clone() };
                let is_scenario = matches!(key, "scenario" | "scenarios" | "candidate") && read;
                let is_pattern = key == "recordings" && text.contains('*');
                if is_path && !is_pattern && !path.exists() {
                    self.mistakes.push(Diagnostic::new(format!("there is no file {shown}")).at(place));
                }
                match is_pattern {
                    true if in_list => self.files(text, place),
                    true => {
                        self.line("[", place);
                        self.files(text, place);
                        self.line("]", place);
                    }
                    false if is_scenario => self.line(&format!("scenario({})", quoted(&shown)), place),
                    false => self.line(&quoted(&shown), place),
                }
            }
            // A script has no such literal: its minus stands before a number that is too large.
            Value::Whole(i64::MIN) => self.mistakes.push(Diagnostic::new("the number is too large").at(place)),
            Value::Whole(number) => self.line(&number.to_string(), place),
            Value::Number(number) if number.is_finite() => self.line(&float(*number), place),
            Value::Number(_) => self.mistakes.push(Diagnostic::new("expected a finite number").at(place)),
            Value::Time(_) => self.mistakes.push(Diagnostic::new("a study has no dates").at(place)),
            Value::Flag(flag) => self.line(if *flag { "true" } else { "false" }, place),
            Value::List(items) => {
                self.line("[", place);
                for item in items {
                    self.item(item, key, read, true);
                    self.line(",", &item.span);
                }
                self.line("]", place);
            }
            Value::Table(table) => {
                self.line("#{", place);
                for entry in &table.entries {
                    let _ = write!(self.script, "{}: ", quoted(&entry.key));
                    self.value(&entry.node, &entry.key, read);
                    self.line(",", &entry.key_span);
                }
                self.line("}", place);
            }
        }
    }

    /// The files of a pattern in the study's folder, in the order of their names; in a list among others.
    fn files(&mut self, pattern: &str, place: &Span) {
        let folder = glob::Pattern::escape(&self.folder.to_string_lossy());
        let whole = Path::new(&folder).join(pattern);
        let mut found = Vec::new();
        match glob::glob(&whole.to_string_lossy()) {
            Ok(paths) => {
                for path in paths {
                    match path {
                        Ok(path) => found.push(quoted(&path.to_string_lossy())),
                        Err(error) => self.mistakes.push(Diagnostic::new(error.to_string()).at(place)),
                    }
                }
            }
            Err(error) => self.mistakes.push(Diagnostic::new(format!("no pattern of files: {error}")).at(place)),
        }
        if found.is_empty() {
            self.mistakes.push(Diagnostic::new(format!("no file matches {pattern}")).at(place));
        }
        self.line(&found.join(", "), place);
    }
}

/// The entries of a list, or the value itself.
fn one_or_several(node: &Node) -> &[Node] {
    if let Value::List(items) = &node.value { items } else { std::slice::from_ref(node) }
}

/// What a test is called: its name, or the name of its scenario's file.
fn called_as(test: &Node) -> Option<&str> {
    let of_file = || test.find("scenario").and_then(text).and_then(|path| Path::new(path).file_stem()?.to_str());
    test.find("name").and_then(text).or_else(of_file)
}

/// The entries of a list; none of another value.
fn items(node: &Node) -> &[Node] {
    if let Value::List(items) = &node.value { items } else { &[] }
}

/// A text.
fn text(node: &Node) -> Option<&str> {
    if let Value::Text(text) = &node.value { Some(text) } else { None }
}

/// A number with a point, which a script takes as a fraction.
fn float(number: f64) -> String {
    let text = format!("{number:?}");
    match text.split_once('e') {
        Some((digits, exponent)) if !digits.contains('.') => format!("{digits}.0e{exponent}"),
        _ => text,
    }
}

/// A text as a script writes it.
fn quoted(text: &str) -> String {
    let mut own = String::from("\"");
    for letter in text.chars() {
        match letter {
            '"' | '\\' => own.extend(['\\', letter]),
            control if control.is_control() => {
                let _ = write!(own, "\\u{:04x}", u32::from(control));
            }
            other => own.push(other),
        }
    }
    own.push('"');
    own
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<StudyFile, Vec<Diagnostic>> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("study.toml");
        std::fs::write(&path, text).unwrap();
        std::fs::write(folder.path().join("b.csv"), "").unwrap();
        for name in ["a.csv", "drop \"1\".toml", "head.toml"] {
            std::fs::write(folder.path().join(name), "").unwrap();
        }
        StudyFile::read(&path)
    }

    const STUDY: &str = "precision = 0.1\n[[test]]\nscenario = \"drop \\\"1\\\".toml\"\nrecordings = \"*.csv\"\n\
                         set = { \"impactor.mass\" = 1e-7 }\n[parameters]\nk1 = { key = \"a.k1\", start = 1, within = [0.2, 10], log = true }\n\
                         [predict]\nscenarios = [\"head.toml\"]\nsamples = 64\n[posterior]\nhierarchy = [\"k1\"]\n";

    /// Each entry is a line of the script, which a mistake in it is reported at; every text is one of the interpreter.
    #[test]
    fn a_study_becomes_a_script_line_by_line() {
        let found = read(STUDY).unwrap();
        rhai::Engine::new_raw().compile(&found.script).unwrap();
        let place = |text: &str| {
            let line = found
                .script
                .lines()
                .position(|line| line.contains(text))
                .unwrap_or_else(|| panic!("{text}: {}", found.script));
            found.place(line + 1, "").line_number()
        };
        let lines = [
            ("\"precision\"", 1),
            ("drop \\\"1\\\".toml", 3),
            ("a.csv", 4),
            ("1.0e-7", 5),
            ("\"k1\"", 7),
            ("scenario(", 9),
            ("\"samples\"", 10),
            ("study.posterior", 11),
        ];
        for (text, line) in lines {
            assert_eq!(place(text), line, "{text}");
        }
        let at = |text: &str| found.script.find(text).unwrap();
        assert!(at("let predicted") < at("calibrate(") && at("a.csv") < at("b.csv"), "{}", found.script);
        assert!(at("study.posterior(") < at("study.predict("));
    }

    /// Keys, kinds and names, each at its value and all at once.
    #[test]
    fn mistakes_have_their_places() {
        let test = "[[test]]\nscenario = \"head.toml\"\n";
        let parameters = "[parameters]\nk = { key = \"a\", start = 1, within = [0, 2] }\n";
        for (text, expected) in [
            (
                format!("{test}{parameters}[posteriors]\n"),
                &[("unknown key `posteriors`", "did you mean `posterior`?", 5)][..],
            ),
            (test.into(), &[("missing key `parameters`", "", 1)]),
            (parameters.into(), &[("missing key `test`", "", 1)]),
            (format!("{test}recordings = \"none-*.csv\"\n{parameters}"), &[("no file matches ", "", 3)]),
            (format!("{test}{parameters}[predict]\nsamples = 3\n"), &[("missing key `predict.scenarios`", "", 5)]),
            (
                format!("precision = nan\nnoise = 3\n{test}comparing = \"x\"\nweight = \"2\"\n{parameters}"),
                &[
                    ("expected a finite number", "", 1),
                    ("out of range", "", 2),
                    ("unknown key `comparing`", "", 5),
                    ("expected a number, found \"2\"", "", 6),
                ],
            ),
            ("[[test]\n".into(), &[("", "", 1)]),
            (format!("posterior = 3\n{test}{parameters}"), &[("expected a table, found 3", "", 1)]),
            (
                format!("{test}compare = \"forse\"\n{parameters}"),
                &[("there is no signal `forse` (did you mean `force`?)", "", 3)],
            ),
            (format!("{test}own = \"l\"\n{parameters}"), &[("there is no parameter `l`", "", 3)]),
            (
                format!("left_out = [[\"a\"], \"c\"]\n{test}name = \"a\"\n{test}name = \"b\"\n{parameters}"),
                &[("there is no test `c`", "", 1)],
            ),
            (
                format!("{test}{parameters}[[candidate]]\nscenario = \"a.toml\"\nrecordings = \"a.csv\"\n"),
                &[("unknown key `recordings`", "", 7), ("there is no file ", "", 6)],
            ),
        ] {
            let found = read(&text).expect_err(&text);
            for (message, hint, line) in expected {
                let is = |own: &Diagnostic| {
                    let at = own.span.as_ref().map(Span::line_number);
                    own.message.contains(message)
                        && own.hint.as_deref().unwrap_or("").contains(hint)
                        && at == Some(*line)
                };
                assert!(found.iter().any(is), "{message} in {text}: {found:?}");
            }
        }
    }

    /// The schema is that of the options that scripts have.
    #[test]
    fn options_of_scripts_are_keys_of_the_file() {
        assert_eq!(options()[..3], ["tests", "parameters", "noise"]);
        assert_eq!(test_options()[..3], ["scenario", "name", "set"]);
        assert_eq!(parameter_options(), ["key", "start", "within", "log", "prior", "tests", "scatter"]);
        assert_eq!(posterior_options().len() + predict_options().len(), 12);
        assert!(rule().at("candidate.0.compare").is_some() && rule().at("candidate.0.recordings").is_none());
    }
}
