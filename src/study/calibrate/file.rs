//! A calibration as a file: tests, parameters, and what follows for other scenarios, in TOML (docs/calibration.md).
//!
//! `study.schema.json` has every key with its sentence: the checks, `droptower explain` and the options of `calibrate` in scripts
//! follow from it.

use std::path::{Path, PathBuf};
use std::sync::{Arc, LazyLock, Mutex};

use rhai::{Array, Dynamic, Map};
use serde_json::Value as Json;

use super::bindings::{Calibration, Surroundings, to_predict};
use super::plan::Plan;
use super::recorded_test::found_column;
use crate::scenario_functions::Scenarios;
use crate::script::{self, HostResult, Session, cause, refused_key};
use base::diagnostic::{Diagnostic, Source, Span, did_you_mean};
use base::file;
use scene::scenario::grammar::{self, TableRule};
use scene::scenario::{Entry, Node, Rule, Value, parse_tree, schema_for_editors, validate};

/// Most bytes of a study.
const MOST_BYTES: u64 = 4 << 20;

/// Keys of the file that are no options of `calibrate`.
const FOLLOW: [&str; 4] = ["posterior", "predict", "candidate", "left_out"];
/// Keys whose texts are paths, seen from the file.
const PATHS: [&str; 3] = ["scenario", "scenarios", "recordings"];
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

/// The path of the keys of a test.
pub(super) const TEST: &str = "test.0";

/// The names of the keys of a table, in their order.
fn names(table: Option<&'static TableRule>) -> impl Iterator<Item = &'static str> {
    table.into_iter().flat_map(|table| &table.keys).map(|key| key.name.as_str())
}

/// Options of `calibrate`.
pub(super) fn options() -> Vec<&'static str> {
    let own = names(rule().table()).filter(|name| !FOLLOW.contains(name));
    own.map(|name| if name == "test" { "tests" } else { name }).collect()
}

/// The options whose keys are those of the table at a path, such as those of a test.
pub(super) fn options_at(path: &str) -> Vec<&'static str> {
    names(rule().at(path).and_then(Rule::table)).collect()
}

/// Options of a parameter that is no curve.
pub(super) fn parameter_options() -> Vec<&'static str> {
    let parameters = rule().at("parameters").and_then(Rule::table);
    names(parameters.and_then(|table| table.others.as_deref()).and_then(Rule::table)).collect()
}

/// Options of `predict`.
pub(super) fn predict_options() -> Vec<&'static str> {
    options_at("predict").into_iter().filter(|name| *name != "scenarios").collect()
}

/// A study that was read.
#[derive(Debug)]
pub struct StudyFile {
    /// Options of `calibrate`, and of what follows it.
    calibration: Map,
    posterior: Option<Map>,
    predict: Option<(Array, Map)>,
    candidates: Option<Array>,
    /// The tests that are left out; all that can be where none are named.
    left_out: Option<Option<Array>>,
    root: Node,
    /// Where the step that failed stands.
    failed: Mutex<Option<Span>>,
    /// The file.
    pub source: Arc<Source>,
}

impl StudyFile {
    /// The script that runs a study, by the function that [`register`](super::register) offers.
    pub const SCRIPT: &str = "calibrate_study();\n";

    /// Whether the file at `path` has keys of a study and no specimen.
    pub fn is_study(path: &Path) -> bool {
        let root = file::read_text(path, MOST_BYTES).ok().and_then(|text| parse_tree(&Source::file(path, text)).ok());
        let has = |key: &str| root.as_ref().is_some_and(|root| root.find(key).is_some());
        !has("specimen") && (has("test") || has("parameters"))
    }

    /// Reads the study at `path`.
    ///
    /// # Errors
    /// The file cannot be read, is no TOML, has keys or values that no study has, or lacks tests or parameters.
    pub fn read(path: &Path) -> Result<StudyFile, Vec<Diagnostic>> {
        let text = file::read_text(path, MOST_BYTES).map_err(|error| {
            let hint = error.hint().map(str::to_owned);
            vec![Diagnostic { hint, ..Diagnostic::new(format!("cannot read {}: {error}", path.display())) }]
        })?;
        let source = Source::file(path, text);
        let root = parse_tree(&source)?;
        if root.find("specimen").is_some() {
            let mistake = Diagnostic::new(format!("{} is a scenario, not a study", path.display()));
            return Err(vec![mistake.hint(
                "a study names scenarios as its [[test]]s and the [parameters] to find: `droptower new study study.toml`",
            )]);
        }
        let folder = path.parent().unwrap_or(Path::new("")).to_owned();
        let mut reader = Reader { mistakes: validate(&root, rule()), folder };
        reader.check_names(&root);
        let mut given = reader.value(&root, "").try_cast::<Map>().unwrap_or_default();
        if !reader.mistakes.is_empty() {
            return Err(reader.mistakes);
        }
        let map = |value: Dynamic| value.try_cast::<Map>().unwrap_or_default();
        let list = |value: Dynamic| value.try_cast::<Array>().unwrap_or_default();
        let predict = given.remove("predict").map(|predict| {
            let mut options = map(predict);
            (list(options.remove("scenarios").unwrap_or_default()), options)
        });
        let left_out = given.remove("left_out").and_then(|tests| match tests.as_bool() {
            Ok(is_all) => is_all.then_some(None),
            Err(_) => Some(Some(list(tests))),
        });
        let (posterior, candidates) = (given.remove("posterior").map(map), given.remove("candidate").map(list));
        let tests = given.remove("test").unwrap_or_default();
        given.insert("tests".into(), tests);
        let failed = Mutex::default();
        Ok(StudyFile { calibration: given, posterior, predict, candidates, left_out, root, failed, source })
    }

    /// Reads scenarios, recordings, parameters and options, and runs nothing.
    ///
    /// # Errors
    /// One of them has a mistake, which has its place.
    pub fn check(&self, scenarios: &Scenarios) -> Result<(), Diagnostic> {
        let session = Session::default();
        let checked = self.scenarios(scenarios, &session).and_then(|_| {
            let plan = Plan::read(&self.calibration, scenarios, &session).map(drop);
            self.located("", plan)
        });
        checked.map_err(|error| Diagnostic::new(cause(&error)).at(&self.place()))
    }

    /// Calibrates, and takes the steps that follow.
    pub(super) fn run(&self, around: &Surroundings, session: &Session) -> HostResult<()> {
        let [candidates, predicted] = self.scenarios(&around.scenarios, session)?;
        let found = Calibration::new(&self.calibration, around, session);
        let found = self.located("", found)?;
        if let Some(options) = &self.posterior {
            self.located("posterior", found.posterior(options, session).map(drop))?;
        }
        if let Some((_, options)) = &self.predict {
            self.located("predict", found.predict(&predicted, options, session).map(drop))?;
        }
        if self.candidates.is_some() {
            self.located("candidate", found.settles(&candidates, session).map(drop))?;
        }
        if let Some(tests) = &self.left_out {
            self.located("left_out", found.left_out(tests.as_ref(), session).map(drop))?;
        }
        found.page()
    }

    /// Candidates, and scenarios that are predicted, read: that they cannot be read is known before the calibration, which takes
    /// long.
    fn scenarios(&self, scenarios: &Scenarios, session: &Session) -> HostResult<[Array; 2]> {
        let read = |section: &str, list: Option<&Array>| -> HostResult<Array> {
            let one = |given: &Dynamic| -> HostResult<Dynamic> {
                let Some(mut map) = given.read_lock::<Map>().map(|map| map.clone()) else {
                    return scenarios.named(given, session).map(Dynamic::from);
                };
                if let Some(scenario) = map.get_mut("scenario") {
                    *scenario = Dynamic::from(scenarios.named(scenario, session)?);
                }
                Ok(map.into())
            };
            self.located(section, list.into_iter().flatten().map(one).collect())
        };
        let candidates = read("candidate", self.candidates.as_ref())?;
        let predicted = read("predict", self.predict.as_ref().map(|(list, _)| list))?;
        if let Some((_, options)) = &self.predict {
            self.located("predict", to_predict(&predicted, options, scenarios, session).map(drop))?;
        }
        Ok([candidates, predicted])
    }

    /// Notes where in a section of the file an error stands: at the key that it names, or at the test.
    fn located<T>(&self, section: &str, result: HostResult<T>) -> HostResult<T> {
        result.inspect_err(|error| {
            let section = self.root.find(section).unwrap_or(&self.root);
            let key = refused_key(error).and_then(|key| value_of(section, &key));
            let message = cause(error);
            let named = message.strip_prefix("test `").and_then(|rest| rest.split_once('`')).map(|(name, _)| name);
            let is_named = |test: &&Node| called_as(test).zip(named).is_some_and(|(own, name)| name.ends_with(own));
            let tests = self.root.find("test").map_or(&[][..], items);
            let test = || tests.iter().find(is_named).and_then(|test| test.find("scenario"));
            let place = key.or_else(test).unwrap_or(section).span.clone();
            *base::lock(&self.failed) = Some(place);
        })
    }

    /// Where the step that failed stands; the beginning of the file where none did.
    pub fn place(&self) -> Span {
        let failed = base::lock(&self.failed).clone();
        failed.unwrap_or_else(|| Span::line(&self.source, 1))
    }
}

/// The value of the first key of this name in a tree.
fn value_of<'n>(node: &'n Node, key: &str) -> Option<&'n Node> {
    match &node.value {
        Value::Table(table) => {
            let own = table.get(key).map(|entry| &entry.node);
            own.or_else(|| table.entries.iter().find_map(|entry| value_of(&entry.node, key)))
        }
        Value::List(items) => items.iter().find_map(|item| value_of(item, key)),
        _ => None,
    }
}

/// Reads the values of a study, and collects mistakes.
struct Reader {
    mistakes: Vec<Diagnostic>,
    folder: PathBuf,
}

impl Reader {
    /// Names that nothing has are mistakes before a search that takes long.
    fn check_names(&mut self, root: &Node) {
        let of = |key: &str| root.find(key).map_or(&[][..], items);
        for test in of("test").iter().chain(of("candidate")) {
            for own in ["compare", "over"].into_iter().filter_map(|key| test.find(key)).flat_map(one_or_several) {
                let message = text(own).filter(|name| *name != "time").and_then(|name| found_column(name).err());
                self.mistakes.extend(message.map(|message| Diagnostic::new(message).at(&own.span)));
            }
        }
        let parameters: Vec<&Entry> = match root.find("parameters").map(|node| &node.value) {
            Some(Value::Table(table)) => table.entries.iter().collect(),
            _ => Vec::new(),
        };
        let known: Vec<&str> = parameters.iter().map(|entry| entry.key.as_str()).collect();
        let hierarchy = root.find("posterior.hierarchy");
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
            self.mistakes.push(mistake.hint_if(did_you_mean(name, known.iter().copied())));
        }
    }

    /// A value of the file as scripts have it, with paths seen from the working folder.
    fn value(&mut self, node: &Node, key: &str) -> Dynamic {
        let place = &node.span;
        match &node.value {
            Value::Text(pattern) if key == "recordings" && pattern.contains('*') => self.files(pattern, place).into(),
            Value::Text(path) if PATHS.contains(&key) => {
                let path = self.folder.join(path);
                let shown = path.to_string_lossy().into_owned();
                if !path.exists() {
                    self.mistakes.push(Diagnostic::new(format!("there is no file {shown}")).at(place));
                }
                shown.into()
            }
            Value::Text(text) => text.clone().into(),
            Value::Whole(whole) => (*whole).into(),
            Value::Number(number) => (*number).into(),
            Value::Flag(flag) => (*flag).into(),
            Value::Time(_) => {
                self.mistakes.push(Diagnostic::new("a study has no dates").at(place));
                Dynamic::UNIT
            }
            // A pattern in a list stands for its files.
            Value::List(items) if key == "recordings" => {
                items.iter().flat_map(|item| script::one_or_several(&self.value(item, key))).collect::<Array>().into()
            }
            Value::List(items) => items.iter().map(|item| self.value(item, key)).collect::<Array>().into(),
            Value::Table(table) => {
                let entries = table.entries.iter();
                entries
                    .map(|entry| (entry.key.as_str().into(), self.value(&entry.node, &entry.key)))
                    .collect::<Map>()
                    .into()
            }
        }
    }

    /// The files of a pattern in the study's folder, in the order of their names.
    fn files(&mut self, pattern: &str, place: &Span) -> Array {
        let folder = glob::Pattern::escape(&self.folder.to_string_lossy());
        let whole = Path::new(&folder).join(pattern);
        let mut mistake = |message: String| self.mistakes.push(Diagnostic::new(message).at(place));
        let mut found = Array::new();
        match glob::glob(&whole.to_string_lossy()) {
            Ok(paths) => {
                for path in paths {
                    match path {
                        Ok(path) => found.push(path.to_string_lossy().into_owned().into()),
                        Err(error) => mistake(error.to_string()),
                    }
                }
            }
            Err(error) => mistake(format!("no pattern of files: {error}")),
        }
        if found.is_empty() {
            mistake(format!("no file matches {pattern}"));
        }
        found
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::script::{refuse, refuse_key};

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

    /// Paths are seen from the file, patterns are files, and what follows the calibration stands apart.
    #[test]
    fn a_study_is_what_a_script_would_give() {
        let found = read(STUDY).unwrap();
        let shown = Dynamic::from(found.calibration.clone()).to_string();
        for part in ["\"precision\": 0.1", "1e-7", "\"start\": 1,", "\"within\": [0.2, 10]"] {
            assert!(shown.contains(part), "{part} in {shown}");
        }
        let at = |text: &str| shown.find(text).unwrap_or_else(|| panic!("{text} in {shown}"));
        assert!(at("a.csv") < at("b.csv") && shown.contains("drop \\\"1\\\".toml"), "{shown}");
        assert_eq!(
            found.calibration.keys().map(|key| key.as_str()).collect::<Vec<_>>(),
            ["parameters", "precision", "tests"]
        );
        let (scenarios, options) = found.predict.as_ref().unwrap();
        assert!(scenarios[0].to_string().ends_with("head.toml") && options["samples"].as_int() == Ok(64));
        assert!(found.posterior.is_some() && found.candidates.is_none() && found.left_out.is_none());
    }

    /// A key that is refused has its value's place, and an error about a test that of its scenario.
    #[test]
    fn errors_of_steps_have_their_places() {
        let found = read(STUDY).unwrap();
        let place = |section: &str, error| {
            drop(found.located::<()>(section, Err(error)));
            found.place().line_number()
        };
        assert_eq!(found.place().line_number(), 1);
        assert_eq!(place("", refuse_key("log", "x", None)), 7);
        assert_eq!(place("", refuse("test `drop \"1\"`: x")), 3);
        assert_eq!(place("posterior", refuse("x")), 11);
        assert_eq!(place("predict", refuse_key("samples", "x", None)), 10);
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
        assert_eq!(options_at(TEST)[..3], ["scenario", "name", "set"]);
        assert_eq!(parameter_options(), ["key", "start", "within", "log", "prior", "tests", "scatter"]);
        assert_eq!(options_at("posterior").len() + predict_options().len(), 12);
        assert!(rule().at("candidate.0.compare").is_some() && rule().at("candidate.0.recordings").is_none());
    }
}
