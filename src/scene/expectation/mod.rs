//! Demands on the results of a run: expectations as they are written, checked, and how a run differs from them.

mod signals;

use std::path::{Path, PathBuf};

use serde::{Serialize, Serializer};
use serde_json::{Map, Value};

use crate::scenario::{self, Amount, Document};
use base::diagnostic::{Diagnostic, Diagnostics, closest, shown_path};
use base::file::{self, FileError};
use base::number::significant;
use lab::signal::{Recording, Series, column, csv};
pub use signals::Difference;

/// Most bytes of recorded figures.
const MOST_BYTES: u64 = 64 << 20;

/// The results of a run that are compared.
#[derive(Clone, Copy, Debug)]
pub struct Given<'a> {
    /// Its signals.
    pub signals: &'a Recording,
    /// The fields of its summary.
    pub figures: &'a Map<String, Value>,
}

/// The record of an earlier run.
#[derive(Clone, Debug, Default)]
pub struct Recorded {
    /// Its signals, where they were recorded.
    pub signals: Option<Recording>,
    /// The figures that are bounded by their recorded values.
    pub figures: Map<String, Value>,
}

impl Recorded {
    /// Reads the files of an earlier run; one that is not there records nothing.
    ///
    /// # Errors
    /// A file cannot be read or holds something else.
    pub fn read(signals: &Path, figures: &Path) -> Result<Recorded, Diagnostic> {
        let signals = match signals.exists() {
            true => Some(csv::read(signals).map_err(|error| Diagnostic::new(error.to_string()))?),
            false => None,
        };
        let refused = |what: String| Diagnostic::new(format!("{}: {what}", shown_path(figures)));
        let figures = match file::read_text(figures, MOST_BYTES) {
            Ok(text) => match serde_json::from_str(&text) {
                Ok(Value::Object(figures)) => figures,
                Ok(_) => return Err(refused("expected an object".into())),
                Err(error) => return Err(refused(error.to_string())),
            },
            Err(FileError::NotFound) => Map::new(),
            Err(error) => return Err(refused(error.to_string())),
        };
        Ok(Recorded { signals, figures })
    }
}

impl Expectations {
    /// How a run differs from what is expected, signals first; nothing where it does not.
    pub fn differences(&self, recorded: &Recorded, given: &Given<'_>) -> Vec<Difference> {
        let signals = signals::differences(self, recorded.signals.as_ref(), given.signals);
        let figures = figure_differences(self, &recorded.figures, given.figures);
        [signals, figures, finding_differences(self, given.figures)].concat()
    }

    /// The record that can be made of a run.
    pub fn recorded(&self, given: &Given<'_>) -> Recorded {
        let is_compared = |name: &str| self.signal(name).is_some_and(SignalBounds::needs_recording);
        let mut signals = given.signals.clone();
        signals.channels.retain(|channel| is_compared(&channel.name));
        let is_bound = |name: &str| self.figures.iter().any(|(own, bounds)| own == name && bounds.needs_recording());
        let figures = given.figures.iter().filter(|(name, _)| is_bound(name));
        Recorded {
            signals: (!signals.channels.is_empty()).then_some(signals),
            figures: figures.map(|(name, value)| (name.clone(), value.clone())).collect(),
        }
    }
}

/// Stands for every signal without an entry of its own, and for every warning.
const ALL: &str = "*";

/// The demands on the results of a run, SI.
#[derive(Clone, Debug, Default)]
pub struct Expectations {
    /// Bounds of signals by name; those under `*` are last.
    pub signals: Vec<(String, SignalBounds)>,
    /// Bounds of figures by name.
    pub figures: Vec<(String, FigureBounds)>,
    /// Codes of findings that must come.
    pub must: Vec<String>,
    /// Codes of findings that must not come; `*` stands for every other warning.
    pub must_not: Vec<String>,
}

/// How far a signal may be from the recorded one.
#[derive(Clone, Debug, Default)]
pub struct SignalBounds {
    /// Largest distance.
    pub absolute: Option<f64>,
    /// Largest distance over the largest recorded magnitude.
    pub relative: Option<f64>,
    /// Distance in time that is allowed, s.
    pub time: f64,
    /// Least rating by ISO/TS 18571.
    pub rating: Option<f64>,
    /// Lower and upper bound over time.
    pub corridor: Option<[Series; 2]>,
    /// From when to when they hold, s.
    pub window: Option<[f64; 2]>,
}

/// The demand on a figure.
#[derive(Clone, Debug, PartialEq)]
pub enum FigureBounds {
    /// True or false.
    Flag(bool),
    /// Exactly this number.
    Number(f64),
    /// Exactly this text.
    Text(String),
    /// Bounds.
    Bounds {
        /// Least and largest value.
        between: Option<[f64; 2]>,
        /// Largest distance from the recorded figure.
        absolute: Option<f64>,
        /// Largest distance from the recorded figure over its magnitude.
        relative: Option<f64>,
    },
}

impl SignalBounds {
    /// Whether they bound the distance from a recorded signal.
    pub fn needs_recording(&self) -> bool {
        self.absolute.is_some() || self.relative.is_some() || self.rating.is_some()
    }
}

impl FigureBounds {
    /// Whether they bound the distance from a recorded figure.
    pub fn needs_recording(&self) -> bool {
        matches!(self, FigureBounds::Bounds { absolute, relative, .. } if absolute.is_some() || relative.is_some())
    }
}

impl Expectations {
    /// The expectations of the file.
    ///
    /// # Errors
    /// All mistakes of the file, at once.
    pub fn check(document: &Document) -> Result<Expectations, Vec<Diagnostic>> {
        let (written, mistakes) = document.expectations();
        let is_read = mistakes.is_empty();
        let mut checker = Checker { document, is_read, mistakes: Diagnostics(mistakes) };
        let found = written.map(|written| checker.all(&written));
        match found {
            Some(found) if checker.mistakes.0.is_empty() => Ok(found),
            _ => Err(checker.mistakes.0),
        }
    }

    /// The bounds of a signal.
    pub fn signal(&self, name: &str) -> Option<&SignalBounds> {
        let of = |wanted: &str| self.signals.iter().find(|(own, _)| own == wanted);
        of(name).or_else(|| of(ALL)).map(|(_, bounds)| bounds)
    }
}

struct Checker<'a> {
    document: &'a Document,
    /// Whether every key was read: where one was not, another that is missing may be what it stands for.
    is_read: bool,
    mistakes: Diagnostics,
}

impl Checker<'_> {
    fn all(&mut self, written: &scenario::Expectations) -> Expectations {
        let signals = written.signals.iter().map(|(name, bounds)| (name.clone(), self.signal(name, bounds)));
        let signals = signals.collect();
        let figures =
            written.figures.iter().filter_map(|(name, bounds)| Some((name.clone(), self.figure(name, bounds)?)));
        let figures = figures.collect();
        let found = Expectations {
            signals,
            figures,
            must: written.warnings.must.clone(),
            must_not: written.warnings.must_not.clone(),
        };
        let both = found.must.iter().find(|code| found.must_not.contains(code));
        if let Some(code) = both {
            self.refuse(&["warnings", "must_not"], format!("`{code}` must and must not come"), "keep one of both");
        }
        let is_empty = written.signals.is_empty() && written.figures.is_empty();
        if self.is_read && is_empty && found.must.is_empty() && found.must_not.is_empty() {
            let hint = "write [signals], [figures] or [warnings]: `droptower explain expect`";
            self.refuse(&["signals"], "nothing is expected", hint);
        }
        found
    }

    fn signal(&mut self, name: &str, written: &scenario::SignalBounds) -> SignalBounds {
        let found = SignalBounds {
            absolute: written
                .absolute
                .as_ref()
                .and_then(|amount| self.distance(&["signals", name, "absolute"], name, amount)),
            relative: written.relative,
            time: written.time.map_or(0.0, |time| time.0),
            rating: written.rating,
            corridor: written.corridor.as_ref().and_then(|_| self.corridor(name)),
            window: written.window.map(|window| window.map(|time| time.0)),
        };
        if name == ALL && (written.absolute.is_some() || written.corridor.is_some()) {
            let message = "signals have different units: `*` cannot bound them by a value";
            self.refuse(&["signals", name], message, "give `relative` or `rating`");
        }
        let has_bound = found.needs_recording() || written.absolute.is_some() || written.corridor.is_some();
        if self.is_read && !has_bound {
            let hint = "give absolute, relative, rating or corridor";
            self.refuse(&["signals", name], format!("nothing bounds `{name}`"), hint);
        }
        if found.window.is_some_and(|[from, to]| from >= to) {
            let span = self.document.span_of(&["signals", name, "window"]);
            self.mistakes.report(&span, "expected a window that ends after it starts");
        }
        found
    }

    fn figure(&mut self, name: &str, written: &scenario::FigureBounds) -> Option<FigureBounds> {
        let bounds = match written {
            scenario::FigureBounds::Flag(flag) => return Some(FigureBounds::Flag(*flag)),
            scenario::FigureBounds::Number(number) => return Some(FigureBounds::Number(*number)),
            scenario::FigureBounds::Text(text) => return Some(FigureBounds::Text(text.clone())),
            scenario::FigureBounds::Bounds(bounds) => bounds,
        };
        if bounds.between.is_none() && bounds.absolute.is_none() && bounds.relative.is_none() {
            if self.is_read {
                let hint = "give between, absolute or relative";
                self.refuse(&["figures", name], format!("nothing bounds `{name}`"), hint);
            }
            return None;
        }
        let between = bounds.between.as_ref().and_then(|[low, high]| {
            let path = ["figures", name, "between"];
            Some([self.amount(&path, name, low)?, self.amount(&path, name, high)?])
        });
        if between.is_some_and(|[low, high]| low > high) {
            let span = self.document.span_of(&["figures", name, "between"]);
            self.mistakes.report(&span, "expected the least value first");
        }
        let absolute = bounds.absolute.as_ref();
        let absolute = absolute.and_then(|amount| self.distance(&["figures", name, "absolute"], name, amount));
        Some(FigureBounds::Bounds { between, absolute, relative: bounds.relative })
    }

    /// A distance in the unit of what is called `name`.
    fn distance(&mut self, path: &[&str], name: &str, amount: &Amount) -> Option<f64> {
        let found = self.amount(path, name, amount)?;
        if found >= 0.0 {
            return Some(found);
        }
        self.mistakes.report(&self.document.span_of(path), "expected a distance of at least 0");
        None
    }

    /// The value of an amount in the unit of what is called `name`.
    fn amount(&mut self, path: &[&str], name: &str, amount: &Amount) -> Option<f64> {
        let text = match amount {
            Amount::Number(number) => return Some(*number),
            Amount::Text(text) => text,
        };
        let parsed = match column::dimension(name) {
            Some(dimension) => dimension.parse(text).map_err(|error| (error.to_string(), error.hint())),
            None => text
                .trim()
                .parse()
                .map_err(|_| (format!("expected a number, found \"{text}\""), format!("`{name}` has no unit"))),
        };
        parsed.map_err(|(message, hint)| self.refuse(path, message, hint)).ok()
    }

    /// The two bounds of a corridor.
    fn corridor(&mut self, name: &str) -> Option<[Series; 2]> {
        let path = ["signals", name, "corridor"];
        let file: PathBuf = self.document.file_of(&path)?;
        let bounds = csv::read(&file).map_err(|error| error.to_string()).and_then(|found| {
            let both = found.series("lower").zip(found.series("upper"));
            both.ok_or_else(|| format!("{} has no columns lower and upper", file.display()))
        });
        let hint = "expected the columns time_s, lower and upper";
        bounds.map(Into::into).map_err(|message| self.refuse(&path, message, hint)).ok()
    }

    /// A mistake in what is written under these keys, and what to write instead.
    fn refuse(&mut self, keys: &[&str], message: impl Into<String>, hint: impl Into<String>) {
        self.mistakes.report_with(&self.document.span_of(keys), message, hint);
    }
}

/// Findings that did not come although they must, and those that came although they must not.
fn finding_differences(expectations: &Expectations, summary: &Map<String, Value>) -> Vec<Difference> {
    let Expectations { must, must_not, .. } = expectations;
    let found: Vec<[&str; 3]> =
        summary.get("findings").and_then(Value::as_array).into_iter().flatten().map(parts).collect();
    let lacking = must.iter().filter(|code| !found.iter().any(|[own, ..]| own == code));
    let lacking = lacking.map(|code| Difference::NoFinding { finding: code.clone() });
    let is_unwanted = |[code, severity, _]: &&[&str; 3]| {
        let named = |list: &[String]| list.iter().any(|own| own == code);
        let is_any = must_not.iter().any(|own| own == ALL) && *severity == "warning" && !named(must);
        named(must_not) || is_any
    };
    let unwanted = found.iter().filter(is_unwanted);
    let unwanted = unwanted.map(|[code, _, message]| Difference::UnexpectedFinding {
        finding: (*code).into(),
        message: (*message).into(),
    });
    lacking.chain(unwanted).collect()
}

/// Code, severity and message of a finding of a summary.
fn parts(finding: &Value) -> [&str; 3] {
    ["code", "severity", "message"].map(|name| finding[name].as_str().unwrap_or_default())
}

/// Significant digits of bounds in messages.
const DIGITS: usize = 6;

/// The figures that are not what is expected.
fn figure_differences(
    expectations: &Expectations,
    recorded: &Map<String, Value>,
    given: &Map<String, Value>,
) -> Vec<Difference> {
    let figures = expectations.figures.iter();
    let differences = figures.filter_map(|(name, bounds)| match given.get(name) {
        Some(found) => difference(name, bounds, recorded.get(name), found),
        None => {
            let like = closest(name, given.keys().map(String::as_str)).map(String::from);
            Some(Difference::NoFigure { figure: name.clone(), like })
        }
    });
    differences.collect()
}

fn difference(name: &str, bounds: &FigureBounds, recorded: Option<&Value>, found: &Value) -> Option<Difference> {
    let figure = name.to_owned();
    if bounds.needs_recording() && recorded.is_none() {
        return Some(Difference::FigureNotRecorded { figure });
    }
    let expected = unmet(bounds, recorded, found)?;
    Some(Difference::FigureDiffers { figure, found: found.clone(), expected })
}

/// The expectation in words where it is not met.
fn unmet(bounds: &FigureBounds, recorded: Option<&Value>, found: &Value) -> Option<String> {
    let exactly = |is_met: bool, words: String| (!is_met).then_some(words);
    match bounds {
        FigureBounds::Flag(flag) => exactly(found.as_bool() == Some(*flag), flag.to_string()),
        FigureBounds::Number(number) => exactly(found.as_f64() == Some(*number), significant(*number, DIGITS)),
        FigureBounds::Text(text) => exactly(found.as_str() == Some(text), format!("\"{text}\"")),
        FigureBounds::Bounds { between, absolute, relative } => {
            let number = found.as_f64();
            let is_within = |[low, high]: [f64; 2]| number.is_some_and(|number| (low..=high).contains(&number));
            let words = |[low, high]: [f64; 2]| {
                let [low, high] = [low, high].map(|bound| significant(bound, DIGITS));
                format!("{low} to {high}")
            };
            let around = || {
                let recorded = recorded?.as_f64()?;
                let distance = allowed(*absolute, *relative, recorded.abs());
                Some([recorded - distance, recorded + distance])
            };
            let is_recorded = absolute.is_some() || relative.is_some();
            let unmet = between.filter(|range| !is_within(*range)).map(words);
            let Some(range) = around().filter(|_| is_recorded) else {
                // A recorded value that is no number must come again.
                let again = recorded.filter(|recorded| is_recorded && *recorded != found).map(ToString::to_string);
                return unmet.or(again);
            };
            unmet.or_else(|| (!is_within(range)).then(|| words(range)))
        }
    }
}

/// The larger of both distances.
fn allowed(absolute: Option<f64>, relative: Option<f64>, magnitude: f64) -> f64 {
    absolute.unwrap_or(0.0).max(relative.unwrap_or(0.0) * magnitude)
}

/// The outcome of a case.
#[derive(Clone, Debug)]
pub struct Verdict {
    /// Its path from the working folder.
    pub name: String,
    /// The demands on its run.
    pub expectations: Expectations,
    /// How its run differs from that; nothing where it does not.
    pub differences: Vec<Difference>,
    /// The record of an earlier run.
    pub recorded: Recorded,
    /// The signals of its run; none where it failed.
    pub signals: Option<Recording>,
    /// Wall time, s.
    pub seconds: f64,
    /// Whether its records were renewed.
    pub blessed: bool,
}

/// A verdict as `summary.json` has it.
#[derive(Debug, Serialize)]
pub struct Entry<'a> {
    name: &'a str,
    passed: bool,
    blessed: bool,
    seconds: f64,
    #[serde(serialize_with = "rows")]
    differences: &'a [Difference],
}

/// A difference and its message.
#[derive(Debug, Serialize)]
struct Row<'a> {
    #[serde(flatten)]
    difference: &'a Difference,
    message: String,
}

/// How a run differs from another one by more than is allowed.
#[derive(Clone, Debug, Serialize)]
pub struct Outside {
    /// Name of the run.
    pub run: String,
    /// The differences; nothing where it is within.
    #[serde(serialize_with = "rows")]
    pub differences: Vec<Difference>,
}

impl Verdict {
    /// Whether the run is what is expected.
    pub fn has_passed(&self) -> bool {
        self.differences.is_empty()
    }

    /// Its entry in `summary.json`.
    pub fn entry(&self) -> Entry<'_> {
        Entry {
            name: &self.name,
            passed: self.has_passed(),
            blessed: self.blessed,
            seconds: self.seconds,
            differences: &self.differences,
        }
    }
}

fn rows<S: Serializer>(differences: &impl AsRef<[Difference]>, serializer: S) -> Result<S::Ok, S::Error> {
    let rows = differences.as_ref().iter();
    serializer.collect_seq(rows.map(|difference| Row { difference, message: difference.to_string() }))
}

#[cfg(test)]
mod tests {
    use std::fs;

    use serde_json::json;

    use super::*;

    fn checked(text: &str) -> Result<Expectations, Vec<String>> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("expect.toml");
        fs::write(folder.path().join("corridor.csv"), "time_s,lower,upper\n0,-1,1\n1,-2,2\n").unwrap();
        fs::write(&path, text).unwrap();
        let messages = |mistakes: Vec<Diagnostic>| mistakes.into_iter().map(|mistake| mistake.message).collect();
        let document = Document::read_expectations(&path).map_err(messages)?;
        Expectations::check(&document).map_err(messages)
    }

    #[test]
    fn expectations_are_read_in_their_units() {
        let found = checked(
            r#"
            [signals."acceleration_filtered_m_s2"]
            absolute = "50 cm/s2"
            relative = 0.01
            window   = ["0 ms", "60 ms"]
            [signals."*"]
            rating = 0.9
            [figures]
            peak_acceleration_m_s2 = { between = ["138 m/s2", 142] }
            ruptured = false
            layers = 8
            energy_absorption = { relative = 0.01 }
            [warnings]
            must = ["strain-rate-outside"]
            "#,
        )
        .unwrap();
        let bounds = found.signal("acceleration_filtered_m_s2").unwrap();
        assert_eq!((bounds.absolute, bounds.window), (Some(0.5), Some([0.0, 0.06])));
        assert_eq!(found.signal("displacement_m").unwrap().rating, Some(0.9));
        let figure = |name: &str| found.figures.iter().find(|(own, _)| own == name).map(|(_, bounds)| bounds.clone());
        let between = Some([138.0, 142.0]);
        let expected = FigureBounds::Bounds { between, absolute: None, relative: None };
        assert_eq!(figure("peak_acceleration_m_s2"), Some(expected));
        assert_eq!(figure("ruptured"), Some(FigureBounds::Flag(false)));
        assert_eq!(figure("layers"), Some(FigureBounds::Number(8.0)));
        let with_corridor = checked("[signals.force_N]\ncorridor = \"corridor.csv\"").unwrap();
        assert_eq!(with_corridor.signal("force_N").unwrap().corridor.as_ref().unwrap()[1].value_at(0.5), Some(1.5));
        assert!(with_corridor.signal("displacement_m").is_none());
    }

    #[test]
    fn findings_come_or_do_not() {
        let finding = |code: &str, severity: &str| json!({ "code": code, "severity": severity, "message": "m" });
        let summary = json!({ "findings": [finding("a", "warning"), finding("b", "note"), finding("c", "warning")] });
        let Value::Object(summary) = summary else { panic!("an object") };
        let expect = |must: &[&str], must_not: &[&str]| {
            let list = |codes: &[&str]| codes.iter().map(|code| (*code).to_owned()).collect();
            let expectations = Expectations { must: list(must), must_not: list(must_not), ..Expectations::default() };
            let found = finding_differences(&expectations, &summary);
            let code = |difference: Difference| match difference {
                Difference::NoFinding { finding } => format!("-{finding}"),
                Difference::UnexpectedFinding { finding, .. } => format!("+{finding}"),
                other => panic!("{other:?}"),
            };
            found.into_iter().map(code).collect::<Vec<_>>().join(" ")
        };
        assert_eq!(expect(&["a", "d"], &["e"]), "-d");
        assert_eq!(expect(&["a"], &["b"]), "+b");
        assert_eq!(expect(&["a"], &["*"]), "+c");
        assert_eq!(expect(&[], &["*"]), "+a +c");
    }

    #[test]
    fn figures_are_held_against_bounds_and_records() {
        let bounds = |between: Option<[f64; 2]>, absolute: Option<f64>, relative: Option<f64>| FigureBounds::Bounds {
            between,
            absolute,
            relative,
        };
        for (bounds, recorded, found, unmet_as) in [
            (FigureBounds::Flag(false), json!(null), json!(false), None),
            (FigureBounds::Flag(false), json!(null), json!(true), Some("false")),
            (FigureBounds::Number(8.0), json!(null), json!(8), None),
            (FigureBounds::Number(8.0), json!(null), json!(9), Some("8")),
            (FigureBounds::Text("a".into()), json!(null), json!("b"), Some("\"a\"")),
            (bounds(Some([1.0, 2.0]), None, None), json!(null), json!(2.0), None),
            (bounds(Some([1.0, 2.0]), None, None), json!(null), json!(2.1), Some("1 to 2")),
            (bounds(Some([1.0, 2.0]), None, None), json!(null), json!(null), Some("1 to 2")),
            (bounds(None, Some(0.1), Some(0.01)), json!(-50.0), json!(-50.5), None),
            (bounds(None, Some(0.1), Some(0.01)), json!(-50.0), json!(-50.6), Some("-50.5 to -49.5")),
            (bounds(None, None, Some(0.01)), json!(null), json!(1.0), Some("null")),
            (bounds(None, None, Some(0.01)), json!(null), json!(null), None),
        ] {
            assert_eq!(unmet(&bounds, Some(&recorded), &found).as_deref(), unmet_as, "{bounds:?} {found}");
        }
        let missing = difference("a", &bounds(None, None, Some(0.1)), None, &json!(1.0));
        assert_eq!(missing, Some(Difference::FigureNotRecorded { figure: "a".into() }));
        let figures = vec![("peak_forse_N".to_owned(), FigureBounds::Flag(true))];
        let Value::Object(given) = json!({ "peak_force_N": 1.0, "ruptured": true }) else { panic!("an object") };
        let found = figure_differences(&Expectations { figures, ..Expectations::default() }, &Map::new(), &given);
        let like = Some("peak_force_N".into());
        assert_eq!(found, [Difference::NoFigure { figure: "peak_forse_N".into(), like }]);
    }
}
