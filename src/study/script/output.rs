//! The output of a script: figures, tables, plots, files, findings and a log.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;
use std::sync::{Arc, Mutex, MutexGuard};

use serde_json::Value;

use crate::Error;
use crate::script::warning::Warning;
use crate::store::run_files::RESERVED_NAMES;
use base::finding::{Finding, is_code};
use base::units::Unit;
use lab::experiment::coupon::Curve;
use lab::signal::Series;
use plot::{Correlation, Plot, outline};

/// One row of a table: column name and value, in order.
pub type Row = serde_json::Map<String, Value>;

/// Most entries of each kind.
const MOST_ENTRIES: usize = 10_000;

/// Most searches and correlations whose plots are stored.
const MOST_SEARCHES: usize = 100;

/// Figures, tables, plots, files, findings and lines of the log, in the order in which the script gave them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ScriptOutput {
    /// What it answers, in a sentence.
    pub answer: Option<String>,
    /// Figures by name.
    pub measures: Row,
    /// Tables: name and rows.
    pub tables: Vec<(String, Vec<Row>)>,
    /// Plots.
    pub plots: Vec<Plot>,
    /// The convergence histories of its searches.
    pub searches: Vec<ConvergenceHistory>,
    /// The correlations of what its searches found.
    pub correlations: Vec<Correlation>,
    /// Files.
    pub files: Files,
    /// Lines of the log.
    pub log: Vec<String>,
    /// Findings that it reported with `warn`, and other warnings about its output.
    pub findings: Vec<Finding>,
}

/// There are `MOST_ENTRIES` of a kind.
fn too_many() -> Error {
    Error::new(format!("a script leaves at most {MOST_ENTRIES} figures, tables, rows, lines or warnings"))
}

fn remedy(reserved: &str) -> &'static str {
    match reserved {
        "warning" | "warnings" | "findings" => "report a warning with `warn(code, text)`",
        _ => "choose another name",
    }
}

/// A report of a script while it runs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Message<'a> {
    /// A line of its log.
    Line(&'a str),
    /// A finding, by `warn` or of the host.
    Finding(&'a Finding),
}

impl fmt::Display for Message<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Message::Line(line) => f.write_str(line),
            Message::Finding(finding) => finding.fmt(f),
        }
    }
}

/// Called with each message of a script at once.
type Listener = dyn Fn(Message<'_>) + Send + Sync;

/// Collects the output of a script while it runs. Cheap to clone.
#[derive(Clone)]
pub struct OutputCollector {
    output: Arc<Mutex<ScriptOutput>>,
    reserved: Arc<[String]>,
    listener: Arc<Listener>,
}

impl OutputCollector {
    /// An empty collector; figures and tables cannot have a `reserved` name.
    pub fn new(reserved: Vec<String>) -> OutputCollector {
        OutputCollector { output: Arc::default(), reserved: reserved.into(), listener: Arc::new(|_| {}) }
    }

    /// The collector, which also calls `listener` with each message.
    pub fn with_listener(self, listener: impl Fn(Message<'_>) + Send + Sync + 'static) -> OutputCollector {
        OutputCollector { listener: Arc::new(listener), ..self }
    }

    /// The output that was collected so far.
    pub fn output(&self) -> ScriptOutput {
        self.lock().clone()
    }

    /// Adds the convergence history of a search; where there are too many, a finding says so once.
    pub fn add_search(&self, convergence: ConvergenceHistory) {
        // The phases of a search are one search.
        let before = if convergence.continues { self.lock().searches.pop() } else { None };
        let whole = match before {
            Some(before) => convergence.behind(before),
            None => convergence,
        };
        self.add(whole, |output| &mut output.searches);
    }

    /// Adds the correlation of what a search found; where there are too many, a finding says so once.
    pub fn add_correlation(&self, correlation: Correlation) {
        self.add(correlation, |output| &mut output.correlations);
    }

    fn add<T>(&self, item: T, list: impl FnOnce(&mut ScriptOutput) -> &mut Vec<T>) {
        let mut output = self.lock();
        let list = list(&mut output);
        if list.len() < MOST_SEARCHES {
            return list.push(item);
        }
        let finding = Finding::new(&Warning::SearchesNotShown { shown: MOST_SEARCHES });
        if !output.findings.contains(&finding) {
            output.findings.push(finding.clone());
            drop(output);
            (self.listener)(Message::Finding(&finding));
        }
    }

    /// Sets the answer, in place of an earlier one.
    pub fn answer(&self, sentence: &str) {
        self.lock().answer = Some(sentence.into());
    }

    /// Adds a figure, or replaces the one of this name.
    ///
    /// # Errors
    /// The name is not one, is reserved, or there are too many.
    pub fn measure(&self, name: &str, value: Value) -> Result<(), Error> {
        self.check(name)?;
        let measures = &mut self.lock().measures;
        if measures.len() >= MOST_ENTRIES {
            return Err(too_many());
        }
        measures.insert(name.into(), value);
        Ok(())
    }

    /// Adds a table, or replaces the one of this name.
    ///
    /// # Errors
    /// The name is not one, is reserved, or there are too many tables or rows.
    pub fn table(&self, name: &str, rows: Vec<Row>) -> Result<(), Error> {
        self.check(name)?;
        let tables = &mut self.lock().tables;
        if tables.len() >= MOST_ENTRIES || rows.len() > MOST_ENTRIES {
            return Err(too_many());
        }
        // One file a table: two names must differ on every file system.
        tables.retain(|(other, _)| !other.eq_ignore_ascii_case(name));
        tables.push((name.into(), rows));
        Ok(())
    }

    /// Whether there is a table of this name.
    pub fn has_table(&self, name: &str) -> bool {
        self.lock().tables.iter().any(|(other, _)| other.eq_ignore_ascii_case(name))
    }

    /// Adds a line to the log.
    ///
    /// # Errors
    /// There are too many.
    pub fn log(&self, line: &str) -> Result<(), Error> {
        if self.lock().log.len() >= MOST_ENTRIES {
            return Err(too_many());
        }
        (self.listener)(Message::Line(line));
        self.lock().log.push(line.into());
        Ok(())
    }

    /// Adds a warning with the script's own code.
    ///
    /// # Errors
    /// The code is not one, or there are too many warnings.
    pub fn warn(&self, code: &str, text: &str) -> Result<(), Error> {
        self.report(Finding::of_script(code, text))
    }

    /// Adds a finding as it is.
    ///
    /// # Errors
    /// Its code is not one, or there are too many findings.
    pub fn report(&self, finding: Finding) -> Result<(), Error> {
        if !is_code(&finding.code) {
            return Err(Error::new(format!(
                "`{}` is not the code of a warning: use lower-case words joined by hyphens, such as `coarse-mesh`",
                shortened(&finding.code, 80)
            )));
        }
        if self.lock().findings.len() >= MOST_ENTRIES {
            return Err(too_many());
        }
        (self.listener)(Message::Finding(&finding));
        self.lock().findings.push(finding);
        Ok(())
    }

    /// Adds a finding of the host, unless there is one of the same code, key, files and figure, or there are too many.
    pub(crate) fn report_once(&self, finding: Finding) {
        let same = |other: &Finding| {
            let is_same = |name: &str| other.figures.get(name) == finding.figures.get(name);
            other.code == finding.code && ["key", "files", "what"].into_iter().all(is_same)
        };
        if !self.lock().findings.iter().any(same) {
            // Too many findings are an error of the script that gives them.
            let _ = self.report(finding);
        }
    }

    /// Adds a file, or replaces the one of this name.
    ///
    /// # Errors
    /// The name cannot name a file, is reserved for the results, or the files together are too large.
    pub fn file(&self, file: File) -> Result<(), Error> {
        self.lock().files.put(file, &RESERVED_NAMES)
    }

    /// Adds a plot, or replaces the one of this title.
    ///
    /// # Errors
    /// A text is empty or too long, it has no curves or too many, or the plots together are too large.
    pub fn plot(&self, plot: Plot) -> Result<(), Error> {
        put(&mut self.lock().plots, plot)
    }

    fn check(&self, name: &str) -> Result<(), Error> {
        let letter = |c: char| c.is_ascii_alphanumeric() || c == '_';
        if name.is_empty() || name.len() > 80 || !name.chars().all(letter) {
            return Err(Error::new(format!(
                "`{}` is not a name for a figure or a table: use letters, digits and _",
                shortened(name, 80)
            )));
        }
        if self.reserved.iter().any(|reserved| reserved == name) {
            return Err(Error::new(format!(
                "`{name}` is a field of the summary and cannot be replaced: {}",
                remedy(name)
            )));
        }
        Ok(())
    }

    fn lock(&self) -> MutexGuard<'_, ScriptOutput> {
        base::lock(&self.output)
    }
}

/// The first characters of a text.
fn shortened(text: &str, most: usize) -> String {
    text.chars().take(most).collect()
}

/// Extensions that a file may have, all of text files.
const ENDINGS: [&str; 7] = ["csv", "json", "md", "obj", "svg", "toml", "txt"];

/// Most files of one script.
const MOST_FILES: usize = 10_000;

/// Most bytes of all files together.
pub(crate) const MOST_BYTES: usize = 256 << 20;

/// Longest name of a file, bytes.
const LONGEST_NAME: usize = 200;

/// A file that a script writes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct File {
    /// Its path in the folder of the results, separated by `/`.
    pub name: String,
    /// Its text.
    pub content: String,
}

/// The files of one script; their names differ on every file system.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Files {
    files: Vec<File>,
    /// Index of the file by its name in lower case.
    places: BTreeMap<String, usize>,
    /// Bytes of all files together.
    bytes: usize,
}

impl Files {
    /// The files in the order in which they were first written.
    pub fn iter(&self) -> impl Iterator<Item = &File> {
        self.files.iter()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.files.is_empty()
    }

    /// Their paths in the folder of the results.
    pub fn names(&self) -> Vec<String> {
        self.files.iter().map(|file| file.name.clone()).collect()
    }

    /// Adds the file, or replaces the one of this name; `reserved` names, and files in folders of such a name, are
    /// refused.
    pub(crate) fn put(&mut self, file: File, reserved: &[&str]) -> Result<(), Error> {
        check_name(&file.name, reserved)?;
        let lower = file.name.to_ascii_lowercase();
        if let Some(place) = self.clash(&lower) {
            return Err(Error::new(format!(
                "`{name}` would be a file and a folder at once, because of `{other}`",
                name = file.name,
                other = self.files[place].name
            )));
        }
        let same = self.places.get(&lower).copied();
        let others = self.bytes - same.map_or(0, |place| self.files[place].content.len());
        let bytes = others + file.content.len();
        if bytes > MOST_BYTES || (same.is_none() && self.files.len() >= MOST_FILES) {
            return Err(too_many_bytes());
        }
        self.bytes = bytes;
        match same {
            Some(place) => self.files[place] = file,
            None => {
                self.places.insert(lower, self.files.len());
                self.files.push(file);
            }
        }
        Ok(())
    }

    /// Index of a file that is a folder of the path `lower`, or lies below it.
    fn clash(&self, lower: &str) -> Option<usize> {
        let above = lower.match_indices('/').find_map(|(end, _)| self.places.get(&lower[..end]));
        let within = format!("{lower}/");
        let first = self.places.range(within.clone()..).next();
        let below = first.filter(|(name, _)| name.starts_with(&within)).map(|(_, place)| place);
        above.or(below).copied()
    }
}

/// There are too many files, or too large ones.
pub(crate) fn too_many_bytes() -> Error {
    Error::new(format!("a script leaves at most {MOST_FILES} files of {} MB together", MOST_BYTES >> 20))
}

fn check_name(name: &str, reserved: &[&str]) -> Result<(), Error> {
    let letter = |c: char| c.is_ascii_alphanumeric() || "-_.".contains(c);
    let plain = |part: &str| !part.is_empty() && !part.starts_with('.') && part.chars().all(letter);
    let ending = name.rsplit_once('.').map(|(_, ending)| ending);
    if name.len() > LONGEST_NAME || !name.split('/').all(plain) || !ending.is_some_and(|end| ENDINGS.contains(&end)) {
        return Err(Error::new(format!(
            "`{}` cannot name a file: folders and names of letters, digits, `-`, `_` and `.`, ending in .{}",
            shortened(name, LONGEST_NAME),
            ENDINGS.join(", .")
        )));
    }
    let first = name.split('/').next().unwrap_or(name);
    if reserved.iter().any(|reserved| reserved.eq_ignore_ascii_case(first)) {
        return Err(Error::new(format!("`{name}` is a file of droptower's own results")));
    }
    Ok(())
}

/// Numbers of runs, and of those with a finding of each code.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct RunFindings {
    /// Number of runs with an outcome.
    pub runs: usize,
    /// Of these, how many had findings, by code.
    pub codes: BTreeMap<String, usize>,
}

impl RunFindings {
    /// Counts a run with findings of these codes.
    pub fn count<'c>(&mut self, codes: impl IntoIterator<Item = &'c str>) {
        self.runs += 1;
        for code in codes.into_iter().collect::<BTreeSet<&str>>() {
            *self.codes.entry(code.to_owned()).or_default() += 1;
        }
    }

    /// Counts the runs of another part of the study.
    pub fn add(&mut self, other: &RunFindings) {
        self.runs += other.runs;
        for (code, count) in &other.codes {
            *self.codes.entry(code.clone()).or_default() += count;
        }
    }
}

/// Most plots of one script, and most curves of one plot.
const MOST_PLOTS: usize = 100;
const MOST_CURVES: usize = 60;

/// Most points that the plots of one script hold together.
const MOST_POINTS: usize = 80_000;

/// Longest title, name or axis label, characters.
const LONGEST: usize = 200;

/// Adds the plot, or replaces the one of this title.
pub(crate) fn put(plots: &mut Vec<Plot>, plot: Plot) -> Result<(), Error> {
    if let Some(text) = texts(&plot).find(|text| text.trim().is_empty() || text.chars().count() > LONGEST) {
        return Err(Error::new(format!(
            "a title, an axis label or a name of a plot has 1 to {LONGEST} characters, not `{}`",
            shortened(text, 40)
        )));
    }
    if !(1..=MOST_CURVES).contains(&plot.curves.len()) {
        return Err(Error::new(format!(
            "the plot `{}` has {} curves; a plot has 1 to {MOST_CURVES}",
            plot.title,
            plot.curves.len()
        )));
    }
    let points = |plot: &Plot| plot.curves.iter().map(|curve| curve.points.len()).sum::<usize>();
    let same = plots.iter().position(|other| other.title == plot.title);
    let others = plots.iter().filter(|other| other.title != plot.title);
    let together = others.map(points).sum::<usize>() + points(&plot);
    if together > MOST_POINTS || (same.is_none() && plots.len() >= MOST_PLOTS) {
        return Err(Error::new(format!(
            "a script leaves at most {MOST_PLOTS} plots of {MOST_POINTS} points together: take slices, or resample signals"
        )));
    }
    match same {
        Some(place) => plots[place] = plot,
        None => plots.push(plot),
    }
    Ok(())
}

/// All its texts.
fn texts(plot: &Plot) -> impl Iterator<Item = &String> {
    let names = plot.curves.iter().map(|curve| &curve.name);
    let own = [&plot.title, &plot.x.label, &plot.y.label].into_iter();
    own.chain(names).chain(plot.window.iter().map(|window| &window.label))
}

/// Most samples of a comparison.
const MOST_SAMPLES: usize = 200;

/// The abscissa of a comparison.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Over {
    /// Time, s.
    Time,
    /// Engineering strain of a coupon; the values are stresses, Pa.
    Strain,
    /// Travel or depth, m.
    Travel,
}

/// The part of a reference that simulations are compared with; compared bit by bit.
#[derive(Clone, Debug)]
pub struct Target {
    /// The abscissa.
    pub over: Over,
    /// Times, strains or travels, increasing.
    pub places: Vec<f32>,
    /// The reference at these abscissae; NaN where it was not measured.
    pub values: Vec<f32>,
}

/// Simulated values at the abscissae of a reference.
#[derive(Clone, Debug, PartialEq)]
pub struct Compared {
    /// The reference.
    pub target: Target,
    /// Simulated values; NaN where there is none.
    pub values: Vec<f32>,
}

impl PartialEq for Target {
    fn eq(&self, other: &Target) -> bool {
        let same = |a: &[f32], b: &[f32]| a.iter().map(|a| a.to_bits()).eq(b.iter().map(|b| b.to_bits()));
        self.over == other.over && same(&self.places, &other.places) && same(&self.values, &other.values)
    }
}

impl Compared {
    /// `signal` over the samples of `reference` with `from <= time <= to`.
    pub fn signals(signal: &Series, reference: &Series, window: [f64; 2]) -> Compared {
        let samples = reference.window(window);
        Compared::sampled(Over::Time, samples.samples(), |time| signal.value_at(time))
    }

    /// `signal` over the samples of `reference`, both over a travel or a depth (m).
    pub fn over_travel(signal: &Series, reference: &Series) -> Compared {
        Compared::sampled(Over::Travel, reference.samples(), |place| signal.value_at(place))
    }

    /// `curve` over the samples of `reference`.
    pub fn curves(curve: &Curve, reference: &Curve) -> Compared {
        let samples = reference.strain().iter().zip(reference.stress()).map(|(strain, stress)| [*strain, *stress]);
        Compared::sampled(Over::Strain, samples, |strain| curve.stress_at(strain))
    }

    fn sampled(over: Over, samples: impl Iterator<Item = [f64; 2]>, found: impl Fn(f64) -> Option<f64>) -> Compared {
        let samples = outline(&samples.collect::<Vec<_>>(), MOST_SAMPLES);
        let values = samples.iter().map(|[place, _]| found(*place).unwrap_or(f64::NAN) as f32).collect();
        let places = samples.iter().map(|[place, _]| *place as f32).collect();
        let target = Target { over, places, values: samples.iter().map(|[_, value]| *value as f32).collect() };
        Compared { target, values }
    }
}

/// The convergence history of one search.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ConvergenceHistory {
    /// The title that the script gave, or `search 1`.
    pub title: String,
    /// Whether it goes on where the search before it ended: both are phases of one search.
    pub continues: bool,
    /// Names of the unknowns.
    pub unknowns: Vec<String>,
    /// Lowest objective value after each iteration, one list for each start: iteration and value.
    pub objectives: Vec<Vec<(usize, f64)>>,
    /// The iterates of the best start.
    pub history: Vec<Iterate>,
    /// The fits to the references that the objective compares with, at the best point.
    pub fits: Vec<Fit>,
    /// Whether all references are virtual recordings.
    pub is_virtual: bool,
}

impl ConvergenceHistory {
    /// This phase of a search behind those `before` it: iterations are counted on. Objective values are of this phase alone, since each weighs its signals in its own way.
    pub(crate) fn behind(mut self, before: ConvergenceHistory) -> ConvergenceHistory {
        let offset = before.history.last().map_or(0, |at| at.iteration);
        self.history.iter_mut().for_each(|at| at.iteration += offset);
        self.objectives.iter_mut().flatten().for_each(|(iteration, _)| *iteration += offset);
        self.history.splice(..0, before.history);
        ConvergenceHistory { continues: before.continues, ..self }
    }
}

/// A simulated curve and its reference.
#[derive(Clone, Debug, PartialEq)]
pub struct Fit {
    /// The quantity of the curves, such as `acceleration`.
    pub quantity: String,
    /// Its unit, where one is known; a curve over strain is shown in it.
    pub unit: Option<Unit>,
    /// The reference.
    pub target: Target,
    /// Simulated values at the abscissae of the reference.
    pub values: Vec<f32>,
}

impl Fit {
    /// Quantity and unit, such as `acceleration (m/s²)`.
    pub fn label(&self) -> String {
        self.unit.as_ref().map_or_else(
            || self.quantity.clone(),
            |unit| format!("{} ({})", self.quantity, unit.symbol().replace("/s2", "/s²")),
        )
    }
}

/// The best trial up to an iteration.
#[derive(Clone, Debug, PartialEq)]
pub struct Iterate {
    /// Number of the iteration, from one.
    pub iteration: usize,
    /// Objective value.
    pub f: f64,
    /// Values of the unknowns.
    pub x: Vec<f64>,
}

#[cfg(test)]
mod tests {
    use crate::script::Iterate;

    use super::*;

    #[test]
    fn searches_without_plots_are_reported_once() {
        let messages = Arc::new(Mutex::new(Vec::new()));
        let collected = Arc::clone(&messages);
        let collector = OutputCollector::new(vec![]);
        let collector = collector.with_listener(move |message| collected.lock().unwrap().push(message.to_string()));
        let search = ConvergenceHistory { title: "a".into(), ..ConvergenceHistory::default() };
        let phase = |iteration: usize, continues| ConvergenceHistory {
            continues,
            history: vec![Iterate { iteration, f: 1.0, x: vec![] }],
            objectives: vec![vec![(iteration, 1.0)]],
            ..search.clone()
        };
        let phases = OutputCollector::new(vec![]);
        [phase(3, false), phase(2, true), phase(1, false)].into_iter().for_each(|phase| phases.add_search(phase));
        let found = phases.output().searches;
        let iterations = |search: &ConvergenceHistory| search.history.iter().map(|at| at.iteration).collect::<Vec<_>>();
        let iterations: Vec<_> = found.iter().map(iterations).collect();
        assert_eq!(iterations, [vec![3, 5], vec![1]], "two phases are one search");
        assert_eq!(found[0].objectives, [[(5, 1.0)]]);

        (0..MOST_SEARCHES + 2).for_each(|_| collector.add_search(search.clone()));
        let output = collector.output();
        assert_eq!(output.searches.len(), MOST_SEARCHES);
        let [finding] = &output.findings[..] else { panic!("{:?}", output.findings) };
        assert_eq!((finding.code.as_str(), &finding.figures["shown"]), ("searches-not-shown", &MOST_SEARCHES.into()));
        let expected =
            "note[searches-not-shown]: the report shows the first 100 searches of a script; later ones have no plots";
        assert_eq!(*messages.lock().unwrap(), [expected]);
    }

    fn put(files: &mut Files, name: &str) -> Result<(), Error> {
        files.put(File { name: name.into(), content: "x".into() }, &["summary.json", "tables"])
    }

    #[test]
    fn names_outside_the_folder_and_names_of_results_are_refused() {
        for name in ["../x.csv", "/x.csv", "a/../x.csv", "a//x.csv", ".x.csv", "x", "x.exe", "a b.csv", "C:\\x.csv", ""]
        {
            let error = put(&mut Files::default(), name).unwrap_err().to_string();
            assert!(error.contains("cannot name a file"), "{name}: {error}");
        }
        for name in ["summary.json", "Summary.json", "tables/x.csv"] {
            let error = put(&mut Files::default(), name).unwrap_err().to_string();
            assert!(error.contains("own results"), "{name}: {error}");
        }
    }

    #[test]
    fn a_name_is_not_a_file_and_a_folder_at_once() {
        let mut files = Files::default();
        for name in ["a.csv", "A.csv", "b/c.csv", "b/d.csv"] {
            put(&mut files, name).unwrap();
        }
        assert_eq!(files.iter().count(), 3);
        assert!(put(&mut files, "a.csv/x.csv").unwrap_err().to_string().contains("a file and a folder at once"));
        put(&mut files, "e.txt/f.csv").unwrap();
        assert!(put(&mut files, "e.txt").unwrap_err().to_string().contains("a file and a folder at once"));
    }

    #[test]
    fn a_replaced_file_does_not_count_towards_the_limit() {
        let half = "x".repeat(MOST_BYTES / 2 + 1);
        let mut files = Files::default();
        let mut put = |name: &str| files.put(File { name: name.into(), content: half.clone() }, &[]);
        put("a.csv").unwrap();
        put("A.csv").unwrap();
        assert_eq!(put("b.csv"), Err(too_many_bytes()));
    }

    #[test]
    fn a_run_counts_once_for_a_code() {
        let mut found = RunFindings::default();
        found.count(["a", "b", "a"]);
        found.count([]);
        found.add(&found.clone());
        assert_eq!((found.runs, found.codes["a"], found.codes["b"]), (4, 2, 2));
    }

    #[test]
    fn a_short_peak_is_not_thinned_out() {
        let values: Vec<f64> = (0..5000).map(|i| if i == 1234 { -90.0 } else { 0.0 }).collect();
        let reference = Series::new((0..5000).map(|i| i as f64 * 1e-4).collect::<Vec<_>>(), values);
        let Compared { target, .. } = Compared::signals(&reference, &reference, [0.0, 1.0]);
        assert!(target.values.contains(&-90.0));
    }

    #[test]
    fn comparisons_are_thinned_to_samples_of_the_signal() {
        for count in [1, 2, 199, 200, 201, 5000] {
            let time: Vec<f64> = (0..count).map(|i| i as f64 * 1e-4).collect();
            let reference = Series::new(time.clone(), time.iter().map(|t| t.sin()).collect::<Vec<_>>());
            let signal = reference.with_values(time.iter().map(|t| 2.0 * t).collect());
            let Compared { target, values } = Compared::signals(&signal, &reference, [0.0, 1.0]);
            assert!(values.len() <= 200 && values.len() == count.min(values.len()), "{count}");
            assert_eq!(target.places.first().zip(target.places.last()), Some((&0.0, &(time[count - 1] as f32))));
            for (place, value) in target.places.iter().zip(&values) {
                let at = time.iter().position(|time| *time as f32 == *place).unwrap();
                assert_eq!(*value, signal.values()[at] as f32);
            }
        }
    }
}
