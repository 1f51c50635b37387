//! A calibration as a file: tests, parameters, and what follows for other scenarios, in TOML (docs/calibration.md).
//!
//! The file becomes the calls of a script that has the same specification, a line an entry, so that a mistake in a line is one of
//! the file's line. Scenarios that are predicted, and candidates, are read before the calibration, which takes long.

use std::fmt::Write as _;
use std::path::Path;
use std::sync::Arc;

use base::diagnostic::{Diagnostic, Source, Span, closest};
use base::file;
use scene::scenario::{Node, Table, Value, parse_tree};

use super::plan;

/// Most bytes of a study.
const MOST_BYTES: u64 = 4 << 20;

/// Keys of the file that are no options of `calibrate`.
const OWN: [&str; 6] = ["test", "parameters", "posterior", "predict", "candidate", "left_out"];
/// Keys whose texts are paths, seen from the file.
const PATHS: [&str; 4] = ["scenario", "scenarios", "candidate", "recordings"];

/// A study that was read.
#[derive(Debug)]
pub struct StudyFile {
    /// The script that it stands for.
    pub script: String,
    /// Bytes of it until the end of the call that calibrates.
    called: usize,
    /// Of each of its lines the place in the file.
    places: Vec<Span>,
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
            mistakes: Vec::new(),
            folder: path.parent().unwrap_or(Path::new("")).to_owned(),
            first: Span::line(&source, 1),
        };
        if let Value::Table(table) = &node.value {
            writer.study(table);
        }
        let Writer { script, called, places, mistakes, .. } = writer;
        if mistakes.is_empty() { Ok(StudyFile { script, called, places, source }) } else { Err(mistakes) }
    }

    /// The script until the call that calibrates: what reads scenarios, recordings, parameters and options.
    pub fn beginning(&self) -> &str {
        &self.script[..self.called]
    }

    /// The place in the file of a line of the script.
    pub fn place(&self, line: usize) -> Span {
        let place = line.checked_sub(1).and_then(|line| self.places.get(line));
        place.cloned().unwrap_or_else(|| Span::line(&self.source, 1))
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
        for entry in &table.entries {
            let key = entry.key.as_str();
            let names = || OWN.iter().chain(plan::OPTIONS.iter().filter(|own| **own != "tests")).copied();
            if !names().any(|own| own == key) {
                let mistake = Diagnostic::new(format!("a study has no key `{key}`")).at(&entry.key_span);
                let hint = closest(key, names()).map(|own| format!("did you mean `{own}`?"));
                self.mistakes.push(Diagnostic { hint, ..mistake });
            }
        }
        for (key, example) in
            [("test", "[[test]]\nscenario = \"drop.toml\""), ("parameters", "[parameters]\nk1 = { key = \"…\", … }")]
        {
            if table.get(key).is_none() {
                let mistake = Diagnostic::new(format!("a study needs `{key}`")).at(&self.first);
                self.mistakes.push(mistake.hint(example.replace('\n', " ")));
            }
        }
        self.check_shapes(table);
        if let Some(candidates) = table.get("candidate") {
            self.line("let candidates =", &candidates.key_span);
            self.value(&candidates.node, "candidate", true);
            self.line(";", &candidates.key_span);
        }
        let predict = table.get("predict").and_then(|entry| match &entry.node.value {
            Value::Table(table) => Some((entry, table)),
            _ => {
                let mistake = Diagnostic::new("`predict` is a table").at(&entry.node.span);
                self.mistakes.push(mistake.hint("[predict] scenarios = [\"head-50.toml\"]"));
                None
            }
        });
        if let Some((entry, predict)) = predict {
            match predict.get("scenarios") {
                Some(scenarios) => {
                    self.line("let predicted =", &scenarios.key_span);
                    self.value(&scenarios.node, "scenarios", true);
                    self.line(";", &scenarios.key_span);
                }
                None => {
                    let mistake = Diagnostic::new("`predict` names no `scenarios`").at(&entry.key_span);
                    self.mistakes.push(mistake.hint("scenarios = [\"head-50.toml\"]"));
                }
            }
        }
        let first = self.first.clone();
        self.line("let study = calibrate(#{", &first);
        for entry in table
            .entries
            .iter()
            .filter(|entry| entry.key == "test" || !OWN.contains(&entry.key.as_str()) || entry.key == "parameters")
        {
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
        if let Some(candidates) = table.get("candidate") {
            self.line("study.settles(candidates);", &candidates.key_span);
        }
        match table.get("left_out").map(|entry| (&entry.node.value, entry)) {
            None | Some((Value::Flag(false), _)) => {}
            Some((Value::Flag(true), entry)) => self.line("study.left_out();", &entry.key_span),
            Some((_, entry)) => self.call("study.left_out(", entry.node.clone(), &entry.key_span),
        }
        self.line("study.page();", &first);
    }

    /// What is known to be wrong before a search that takes long: tables that are none, and names that nothing has.
    fn check_shapes(&mut self, table: &Table) {
        let is_table = |node: &Node| matches!(node.value, Value::Table(_));
        for key in ["parameters", "posterior"] {
            if let Some(entry) = table.get(key).filter(|entry| !is_table(&entry.node)) {
                self.mistakes.push(Diagnostic::new(format!("`{key}` is a table: [{key}]")).at(&entry.node.span));
            }
        }
        for key in ["test", "candidate"] {
            if let Some(entry) = table.get(key).filter(|entry| !matches!(entry.node.value, Value::List(_))) {
                self.mistakes
                    .push(Diagnostic::new(format!("`{key}` is a list of tables: [[{key}]]")).at(&entry.key_span));
            }
        }
        let tests = table.get("test").map_or(&[][..], |entry| items(&entry.node));
        let names: Option<Vec<&str>> = tests.iter().map(|test| test.find("name").and_then(text)).collect();
        let parameters: Vec<&str> = match table.get("parameters").map(|entry| &entry.node.value) {
            Some(Value::Table(table)) => table.entries.iter().map(|entry| entry.key.as_str()).collect(),
            _ => Vec::new(),
        };
        // Tests without a name have that of their scenario.
        if let (Some(names), Some(left_out)) = (names, table.get("left_out")) {
            let groups = items(&left_out.node).iter().flat_map(|own| match items(own) {
                [] => std::slice::from_ref(own),
                group => group,
            });
            self.known(groups, &names, "test");
        }
        if let Some(hierarchy) = table.get("posterior").and_then(|entry| entry.node.find("hierarchy")) {
            self.known(items(hierarchy).iter(), &parameters, "parameter");
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
            found.place(line + 1).line_number()
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

    #[test]
    fn mistakes_have_their_lines() {
        for (text, message, hint) in [
            (
                "[[test]]\nscenario = 1\n[parameters]\n[posteriors]\n",
                "a study has no key `posteriors`",
                "did you mean `posterior`?",
            ),
            ("[[test]]\nscenario = 1\n", "a study needs `parameters`", "[parameters] k1 = "),
            ("[parameters]\n", "a study needs `test`", "[[test]] scenario"),
            ("[[test]]\nrecordings = \"none-*.csv\"\n[parameters]\n", "no file matches ", ""),
            ("[[test]]\n[parameters]\n[predict]\nsamples = 3\n", "`predict` names no `scenarios`", "scenarios = "),
            ("[[test]]\nprecision = nan\n[parameters]\n", "expected a finite number", ""),
            ("[[test]\n", "", ""),
            ("posterior = 3\n[[test]]\n[parameters]\n", "`posterior` is a table", ""),
            ("[candidate]\n[[test]]\n[parameters]\n", "`candidate` is a list of tables", ""),
            (
                "left_out = [[\"a\"], \"c\"]\n[[test]]\nname = \"a\"\n[[test]]\nname = \"b\"\n[parameters]\n",
                "there is no test `c`",
                "",
            ),
            ("[[test]]\nscenario = \"none.toml\"\n[parameters]\n", "there is no file ", ""),
        ] {
            let found = read(text).expect_err(text);
            let is = |own: &Diagnostic| {
                own.message.contains(message) && own.hint.as_deref().unwrap_or("").contains(hint) && own.span.is_some()
            };
            assert!(found.iter().any(is), "{text}: {found:?}");
        }
    }
}
