//! Writes the files of a run folder.

use std::io;

use rayon::prelude::*;
use serde_json::{Map, Value};

use base::table;
use lab::signal::{Recording, csv};
use report::vtu::VtuError;
use report::{self, RunPage, StudyPage, SweepPage, compare_page, vtu};
use scene::expectation::{Outside, Verdict};
use scene::model::Model;
use scene::simulate::Outcome;
use study::post::{Results, RunComparison};
use study::script::{Row, ScriptOutput};
use study::store::{Draft, StoreError, run_files};

/// A run, complete or failed.
pub(super) struct Contents<'a> {
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

/// Writes all files of a run into the draft, by as many threads as there are, and gives their names.
pub(super) fn fill<'a>(draft: &'a Draft, contents: &'a Contents<'a>) -> Result<Vec<String>, StoreError> {
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

/// Writes all files of a study into the draft and gives their names.
pub(super) fn fill_study(
    draft: &Draft,
    study: &StudyPage,
    summary: &Map<String, Value>,
) -> Result<Vec<String>, StoreError> {
    let mut files = Files::new(draft);
    files.write(run_files::SUMMARY, json(summary)?)?;
    files.script_output(study.output)?;
    files.write(run_files::REPORT, report::study_page(study).into_bytes())?;
    files.written()
}

/// Writes all files of tests into the draft and gives their names.
pub(super) fn fill_tests(
    draft: &Draft,
    verdicts: &[Verdict],
    summary: &Map<String, Value>,
) -> Result<Vec<String>, StoreError> {
    let mut files = Files::new(draft);
    files.write(run_files::SUMMARY, json(summary)?)?;
    files.write(run_files::REPORT, report::test_page(verdicts).into_bytes())?;
    files.written()
}

/// Writes all files of a sweep into the draft and gives their names.
pub(super) fn fill_sweep(draft: &Draft, page: &SweepPage, scenario: &str) -> Result<Vec<String>, StoreError> {
    let mut files = Files::new(draft);
    let columns = &page.results.table.columns;
    let failed = |name: &'static str| move |error| StoreError::write(draft.path().join(name), error);
    files.write(run_files::SUMMARY, json(page.summary)?)?;
    files.write(run_files::SCENARIO, scenario.as_bytes().to_vec())?;
    files.write(run_files::TABLE, table::to_csv(columns).map_err(failed(run_files::TABLE))?)?;
    files.write(run_files::REPORT, report::sweep_page(page).into_bytes())?;
    files.written()
}

/// Writes all files of a comparison into the draft and gives their names.
pub(super) fn fill_comparison(
    draft: &Draft,
    comparison: &RunComparison,
    summary: &Map<String, Value>,
    outside: Option<&[Outside]>,
) -> Result<Vec<String>, StoreError> {
    let mut files = Files::new(draft);
    files.write(run_files::SUMMARY, json(summary)?)?;
    files.write(run_files::REPORT, compare_page::compare_page(comparison, outside).into_bytes())?;
    files.written()
}

struct Files<'a> {
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

    fn write(&mut self, name: &str, content: Vec<u8>) -> Result<(), StoreError> {
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
            report::recording::write(&path, &RunPage { model, outcome, results, scenario, failure, files: &files })
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

    fn script_output(&mut self, output: &ScriptOutput) -> Result<(), StoreError> {
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
pub(super) fn json(summary: &Map<String, Value>) -> Result<Vec<u8>, StoreError> {
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
