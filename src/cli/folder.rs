//! The files of a run folder, and the summary of a run on the terminal.

use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};
use std::fmt::Write;
use std::io;
use std::path::{Path, PathBuf};

use clap::Args;
use rayon::prelude::*;
use serde_json::{Map, Value};

use crate::{Failure, terminal};
use base::diagnostic::{listed, shown_path};
use base::file;
use base::number::{self, grouped};
use base::table;
use lab::signal::{Recording, csv};
use report::vtu::{self, VtuError};
use report::{self, RunPage};
use scene::model::Model;
use scene::scenario::{is_same_value, leaves};
use scene::simulate::Outcome;
use study::post::{self, Audit, Impact, Measures, Results};
use study::script::{Row, ScriptOutput};
use study::store::{self, Draft, Origin, StoreError, run_files};

/// A run, complete or failed.
pub(crate) struct Contents<'a> {
    pub model: &'a Model,
    pub outcome: &'a Outcome,
    /// `None` where a failed run cannot be measured.
    pub results: Option<&'a Results>,
    pub scenario: &'a str,
    /// Text of the post script that `scenario` reads as [`run_files::POST_SCRIPT`].
    pub script: Option<&'a str>,
    pub failure: Option<&'a str>,
    /// Whether snapshots are also written for ParaView.
    pub vtu: bool,
}

/// `--out` and `--force` of commands that have a folder for each name.
#[derive(Clone, Debug, Args)]
pub(crate) struct ResultArgs {
    /// Folder for the results; left out, runs/NAME of the scenario, script or study, runs/NAME.sweep of a sweep or
    /// runs/NAME-NAME.compare of the first two runs that are compared
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Replace results of something else in the same folder
    #[arg(long)]
    pub force: bool,
}

impl ResultArgs {
    /// The folder for the results of this name and origin, checked.
    pub(crate) fn place(&self, name: &str, origin: Origin) -> Result<ResultPlace, Failure> {
        ResultPlace::new(self.folder(name)?, origin, self.force)
    }

    /// The folder for results of this name.
    pub(crate) fn folder(&self, name: &str) -> Result<PathBuf, StoreError> {
        self.out.clone().map_or_else(|| store::default_place(name), Ok)
    }
}

/// The folder for the results of a command, and what they may replace.
pub(crate) struct ResultPlace {
    pub folder: PathBuf,
    pub origin: Origin,
    /// Whether results of another origin are replaced.
    pub force: bool,
}

impl ResultPlace {
    /// Checks that results in `folder` replace nothing of the user's and, unless `force`, no results of another origin.
    pub(crate) fn new(folder: PathBuf, origin: Origin, force: bool) -> Result<ResultPlace, Failure> {
        store::check_places(std::slice::from_ref(&folder))?;
        if !force {
            origin.check(&folder)?;
        }
        Ok(ResultPlace { folder, origin, force })
    }

    /// Stores a summary, what `others` writes, and a page, published as `publish` does it: where they are, and the lines that
    /// name them.
    pub(crate) fn store(
        &self,
        summary: &Map<String, Value>,
        others: impl FnOnce(&mut Files<'_>) -> Result<(), StoreError>,
        page: String,
        publish: fn(Draft) -> Result<PathBuf, StoreError>,
    ) -> Result<(PathBuf, String), Failure> {
        let stored = || -> Result<(PathBuf, String), StoreError> {
            let draft = Draft::begin(&self.folder, self.origin.clone(), self.force)?;
            let mut files = Files::new(&draft);
            files.write(run_files::SUMMARY, json(summary)?)?;
            others(&mut files)?;
            files.write(run_files::REPORT, page.into_bytes())?;
            let files = files.written()?;
            let place = publish(draft)?;
            let listing = listing(&place, &files);
            Ok((place, listing))
        };
        stored().map_err(|error| Failure::unstored(&error))
    }
}

/// Most keys that are named of results that are replaced.
const MOST_KEYS: usize = 4;

/// Says which keys of the scenario of results at `place`, which are about to be replaced, are others in `scenario`; none where
/// all are equal.
pub(crate) fn replaced_scenario(place: &Path, what: &str, scenario: &str) -> Option<String> {
    let former = file::read_text(&place.join(run_files::SCENARIO), run_files::MOST_BYTES).ok()?;
    replaced(place, what, [leaves(&former), leaves(scenario)])
}

/// Says which keys of results at `place`, which are about to be replaced, were others than `now`; none where all are equal.
pub(crate) fn replaced(place: &Path, what: &str, [former, now]: [BTreeMap<String, String>; 2]) -> Option<String> {
    let keys: BTreeSet<&String> = former.keys().chain(now.keys()).collect();
    let differs = |key: &&String| !is_same_value(former.get(*key), now.get(*key));
    let differs: Vec<String> = keys.into_iter().filter(differs).cloned().collect();
    let named = match differs.len() {
        0 => return None,
        count if count > MOST_KEYS => format!("{} and {} more keys", listed(&differs[..MOST_KEYS]), count - MOST_KEYS),
        _ => listed(&differs),
    };
    Some(format!("{} replaces {what} with other {named}; --out keeps both", shown_path(place)))
}

/// Writes all files of a run into the draft, by as many threads as there are, and gives their names.
pub(crate) fn fill<'a>(draft: &'a Draft, contents: &'a Contents<'a>) -> Result<Vec<String>, StoreError> {
    let Contents { model, outcome, results, scenario, script, failure, vtu } = *contents;
    let mut files = Files::new(draft);
    let signals = results.map_or(&outcome.signals, |results| &results.signals);
    files.later(run_files::SIGNALS, || recording(signals));
    files.later(run_files::ENERGIES, || recording(&outcome.energies));
    if let Some(field) = results.and_then(|results| results.field.as_ref()) {
        let failed = |error| StoreError::write(draft.path().join(run_files::FIELD), error);
        files.later(run_files::FIELD, move || table::to_csv(&field.columns()).map_err(failed));
    }
    if let Some(results) = results {
        files.later(run_files::SUMMARY, || json(&results.summary(model)));
        files.script_output(&results.script_output)?;
        #[cfg(feature = "rerun")]
        files.recording(contents, results);
    }
    if vtu {
        files.snapshots(vtu::files(model, outcome))?;
    }
    files.write(run_files::SCENARIO, scenario.as_bytes().to_vec())?;
    if let Some(text) = script {
        files.write(run_files::POST_SCRIPT, text.as_bytes().to_vec())?;
    }
    if let Some(cause) = failure {
        files.write(run_files::FAILURE, format!("{cause}\n").into_bytes())?;
    }
    if let Some(results) = results {
        files.page(contents, results);
    }
    files.written()
}

/// The files of a folder as they are written.
pub(crate) struct Files<'a> {
    draft: &'a Draft,
    /// Of all files, those that are written later among them.
    names: Vec<String>,
    /// What writes the files that are written later.
    later: Vec<Box<dyn FnOnce() -> Result<(), StoreError> + Send + 'a>>,
}

impl<'a> Files<'a> {
    fn new(draft: &'a Draft) -> Files<'a> {
        Files { draft, names: Vec::new(), later: Vec::new() }
    }

    /// Writes what is to be written later, by as many threads as there are; the names of all files.
    fn written(self) -> Result<Vec<String>, StoreError> {
        self.later.into_par_iter().map(|write| write()).collect::<Result<(), StoreError>>()?;
        Ok(self.names)
    }

    /// A file whose content is made while others are.
    fn later(&mut self, name: &str, content: impl FnOnce() -> Result<Vec<u8>, StoreError> + Send + 'a) {
        let (draft, own) = (self.draft, name.to_owned());
        self.later.push(Box::new(move || draft.write(&own, content()?)));
        self.names.push(name.into());
    }

    pub(crate) fn write(&mut self, name: &str, content: Vec<u8>) -> Result<(), StoreError> {
        self.draft.write(name, content)?;
        self.names.push(name.into());
        Ok(())
    }

    /// The page, which lists the files before it.
    fn page(&mut self, contents: &'a Contents<'a>, results: &'a Results) {
        let Contents { model, outcome, scenario, failure, .. } = *contents;
        let files = self.names.clone();
        self.later(run_files::REPORT, move || {
            let page = report::run_page(&RunPage { model, outcome, results, scenario, failure, files: &files });
            Ok(page.into_bytes())
        });
    }

    #[cfg(feature = "rerun")]
    fn recording(&mut self, contents: &'a Contents<'a>, results: &'a Results) {
        let Contents { model, outcome, scenario, failure, .. } = *contents;
        let (path, files) = (self.draft.path().join(run_files::RECORDING), self.names.clone());
        self.later.push(Box::new(move || {
            viz::write(&path, &RunPage { model, outcome, results, scenario, failure, files: &files })
                .map_err(|error| StoreError::write(&path, io::Error::other(error.to_string())))
        }));
        self.names.push(run_files::RECORDING.into());
    }

    /// Writes files for ParaView, by as many threads as there are.
    fn snapshots(
        &mut self,
        files: impl ParallelIterator<Item = Result<vtu::File, VtuError>>,
    ) -> Result<(), StoreError> {
        let failed = |error| StoreError::write(self.draft.path(), io::Error::other(error));
        let draft = self.draft;
        let written = files.map(|file| {
            let vtu::File { name, content } = file.map_err(failed)?;
            draft.write(&name, content)?;
            Ok(name)
        });
        let names = written.collect::<Result<Vec<String>, StoreError>>()?;
        self.names.extend(names);
        Ok(())
    }

    /// The tables and files of a script.
    pub(crate) fn script_output(&mut self, output: &ScriptOutput) -> Result<(), StoreError> {
        for (name, rows) in &output.tables {
            let file = format!("{}/{name}.csv", run_files::TABLES);
            let content = rows_as_csv(rows).map_err(|error| StoreError::write(self.draft.path().join(&file), error))?;
            self.write(&file, content)?;
        }
        for file in output.files.iter() {
            self.write(&file.name, file.content.clone().into_bytes())?;
        }
        Ok(())
    }
}

fn recording(recording: &Recording) -> Result<Vec<u8>, StoreError> {
    let mut text = Vec::new();
    csv::write(recording, &mut text).map_err(|error| StoreError::write(run_files::SIGNALS, error))?;
    Ok(text)
}

/// A summary as the text of its file.
pub(crate) fn json(summary: &Map<String, Value>) -> Result<Vec<u8>, StoreError> {
    let text = serde_json::to_vec_pretty(summary);
    let mut text = text.map_err(|error| StoreError::write(run_files::SUMMARY, error.into()))?;
    text.push(b'\n');
    Ok(text)
}

/// Rows under the names of all their columns.
fn rows_as_csv(rows: &[Row]) -> io::Result<Vec<u8>> {
    let columns = report::columns(rows);
    let mut out = ::csv::Writer::from_writer(Vec::new());
    out.write_record(&columns)?;
    for row in rows {
        let cell = |name: &String| row.get(name).map_or_else(String::new, cell);
        out.write_record(columns.iter().map(cell))?;
    }
    out.into_inner().map_err(|error| io::Error::other(error.to_string()))
}

fn cell(value: &Value) -> String {
    match value {
        Value::Null => String::new(),
        Value::String(text) => text.clone(),
        other => other.to_string(),
    }
}

/// Significant digits of a figure.
pub(crate) const DIGITS: usize = 3;

/// Title, cost, figures and findings of a run; ends with a line break.
pub(crate) fn summary_of_run(model: &Model, outcome: &Outcome, results: &Results) -> String {
    let mut text = format!("{}  {}\n", model.name, model.subject());
    let answer = results.script_output.answer.clone().unwrap_or_else(|| post::answer(model, results, false));
    text += &terminal::sentences(&answer);
    text += &cost(&results.audit);
    let _ = writeln!(text, "  {}", post::further(model, results).join(", "));
    if let Measures::Impact(measures) = &results.measures {
        text += &[errors(model, measures), springs_and_faces(measures)].concat();
    }
    text += &steadiness(&results.audit);
    text += &field(&results.audit);
    if let Some(torn) = outcome.torn.filter(|torn| torn.length > 0.0) {
        let _ = writeln!(text, "  the film is torn {} mm in the end", number::figure(1e3 * torn.length, DIGITS));
    }
    text += &terminal::findings_of_run("  ", results.findings.iter());
    for line in &results.script_output.log {
        let _ = writeln!(text, "  {line}");
    }
    text
}

/// Title and findings of a run that failed; ends with a line break.
pub(crate) fn summary_of_failed(model: &Model, results: &Results) -> String {
    format!("{}  {}\n{}", model.name, model.subject(), terminal::findings_of_run("  ", results.findings.iter()))
}

/// The folder and its files; ends with a line break.
pub(crate) fn listing(place: &Path, files: &[String]) -> String {
    format!("  {}: {}\n", shown_path(place), gathered(files).join("  "))
}

/// Most files of one folder that are named one by one.
const MOST_NAMED: usize = 9;

/// The names; of a folder that holds many, its name and their number.
fn gathered(files: &[String]) -> Vec<String> {
    let folder = |name: &str| name.rsplit_once('/').map_or(String::new(), |(folder, _)| folder.to_owned());
    let mut counts: HashMap<String, usize> = HashMap::new();
    for name in files {
        *counts.entry(folder(name)).or_default() += 1;
    }
    let mut named = HashSet::new();
    let mut entry = |name: &String| {
        let folder = folder(name);
        let count = counts.get(&folder).copied().filter(|count| !folder.is_empty() && *count > MOST_NAMED);
        let Some(count) = count else { return Some(name.clone()) };
        named.insert(folder.clone()).then(|| format!("{folder}/ ({count} files)"))
    };
    files.iter().filter_map(&mut entry).collect()
}

fn cost(audit: &Audit) -> String {
    format!(
        "  {} element{}, {} steps of {} us, {:.2} s ({:.0} ns per element step)\n",
        grouped(audit.elements as u64),
        if audit.elements == 1 { "" } else { "s" },
        grouped(audit.steps),
        number::figure(audit.time_step_s * 1e6, DIGITS),
        audit.wall_s,
        audit.ns_per_element_step,
    )
}

/// The errors against a displacement field; empty without one.
fn field(audit: &Audit) -> String {
    let Some(field) = &audit.field else { return String::new() };
    let millimetres = |length: f64| format!("{} mm", number::figure(length * 1e3, DIGITS));
    format!(
        "  against the field   {} (rms), {} at most, {} of what was measured; {} of {} points at {} times\n",
        field.rms_m.map_or("-".into(), millimetres),
        field.largest_m.map_or("-".into(), millimetres),
        audit.field_error.map_or("-".into(), percent),
        field.compared,
        field.points,
        field.times.len()
    )
}

/// What the springs of the frame carried, and how near film came to film.
fn springs_and_faces(measures: &Impact) -> String {
    let mut text = String::new();
    if let (Some(force), Some(elongation)) = (measures.peak_spring_force, measures.peak_spring_elongation_m) {
        let [force, elongation] = [force, 1e3 * elongation].map(|value| number::figure(value, DIGITS));
        let _ = writeln!(text, "  springs             up to {force} N, {elongation} mm longer than without force");
    }
    if let Some(least) = measures.least_film_distance_m {
        let least = number::figure(1e3 * least, DIGITS);
        let _ = writeln!(text, "  film from film      {least} mm at least, from middle to middle");
    }
    text
}

fn errors(model: &Model, measures: &Impact) -> String {
    let Some(signals) = model.reference.as_ref().and_then(|reference| reference.signals.as_ref()) else {
        return String::new();
    };
    let shown = |error: Option<f64>| error.map_or("-".into(), percent);
    let (acceleration, displacement) = (shown(measures.acceleration_error), shown(measures.displacement_error));
    format!("  against {}:  E_a {acceleration}   E_d {displacement}\n", shown_path(signals))
}

/// The kinetic share of a slow test and the factor on its mass; the mass added to small elements.
fn steadiness(audit: &Audit) -> String {
    let added = match (audit.added_mass_kg, audit.added_mass_share) {
        (Some(mass), Some(share)) => {
            format!(
                "  mass added to small elements: {} g, {} of the film\n",
                number::figure(1e3 * mass, DIGITS),
                percent(share)
            )
        }
        _ => String::new(),
    };
    let scaled = match (audit.mass_scaling, audit.kinetic_share) {
        (Some(scaling), Some(share)) => {
            format!("  mass scaled by {}, kinetic share {}\n", number::figure(scaling, DIGITS), percent(share))
        }
        _ => String::new(),
    };
    format!("{scaled}{added}")
}

/// A share in per cent with one decimal; one below 0.1 % with its first two digits, down to a thousandth.
fn percent(share: f64) -> String {
    let percent = 100.0 * share;
    match percent.abs() {
        small if (1e-3..0.0995).contains(&small) => format!("{} %", number::significant(percent, 2)),
        _ => format!("{percent:.1} %"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_shares_keep_their_digits() {
        let found = [1.366e-4, 1.2e-3, 9.96e-4, 0.0, 0.887].map(percent);
        assert_eq!(found, ["0.014 %", "0.1 %", "0.1 %", "0.0 %", "88.7 %"]);
    }

    #[test]
    fn a_folder_of_many_files_is_named_once() {
        let many = (0..20).map(|n| format!("coupons/{n}.csv"));
        let files: Vec<String> =
            ["summary.json".to_owned(), "tables/a.csv".to_owned()].into_iter().chain(many).collect();
        assert_eq!(gathered(&files), ["summary.json", "tables/a.csv", "coupons/ (20 files)"]);
    }
}
