//! Writes the files of a run folder.

use std::io;

use rayon::prelude::*;
use serde_json::{Map, Value};

use crate::model::Model;
use crate::post::{Results, RunComparison};
use crate::report::{self, RunPage, StudyPage, SweepPage, compare_page, vtu};
use crate::script::{Row, ScriptOutput};
use crate::signal::{Recording, csv};
use crate::simulate::Outcome;
use crate::store::{Draft, StoreError, run_files};

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
    /// Whether the snapshots are also written for ParaView.
    pub vtu: bool,
}

/// Writes all files of a run into the draft and gives their names.
pub(super) fn fill(draft: &Draft, contents: &Contents) -> Result<Vec<String>, StoreError> {
    let Contents { model, outcome, results, scenario, script, failure, vtu } = contents;
    let mut files = Files { draft, names: Vec::new() };
    let signals = results.map_or(&outcome.signals, |results| &results.signals);
    files.write(run_files::SIGNALS, recording(signals)?)?;
    files.write(run_files::ENERGIES, recording(&outcome.energies)?)?;
    if let Some(results) = results {
        files.write(run_files::SUMMARY, json(&results.summary(model))?)?;
        files.script_output(&results.script_output)?;
        #[cfg(feature = "rerun")]
        files.recording(contents, results)?;
    }
    if *vtu {
        files.vtu(model, outcome)?;
    }
    files.write(run_files::SCENARIO, scenario.as_bytes().to_vec())?;
    if let Some(text) = script {
        files.write(run_files::POST_SCRIPT, text.as_bytes().to_vec())?;
    }
    if let Some(cause) = failure {
        files.write(run_files::FAILURE, format!("{cause}\n").into_bytes())?;
    }
    if let Some(results) = results {
        files.page(contents, results)?;
    }
    Ok(files.names)
}

/// Writes all files of a study into the draft and gives their names.
pub(super) fn fill_study(
    draft: &Draft,
    study: &StudyPage,
    summary: &Map<String, Value>,
) -> Result<Vec<String>, StoreError> {
    let mut files = Files { draft, names: Vec::new() };
    files.write(run_files::SUMMARY, json(summary)?)?;
    files.script_output(study.output)?;
    #[cfg(feature = "rerun")]
    files.study_recording(study)?;
    files.write(run_files::REPORT, report::study_page(study).into_bytes())?;
    Ok(files.names)
}

/// Writes all files of a sweep into the draft and gives their names.
pub(super) fn fill_sweep(draft: &Draft, page: &SweepPage, scenario: &str) -> Result<Vec<String>, StoreError> {
    let mut files = Files { draft, names: Vec::new() };
    let table = &page.results.table;
    let failed = |name: &'static str| move |error| StoreError::write(draft.path().join(name), error);
    files.write(run_files::SUMMARY, json(page.summary)?)?;
    files.write(run_files::SCENARIO, scenario.as_bytes().to_vec())?;
    files.write(run_files::TABLE, table.to_csv().map_err(failed(run_files::TABLE))?)?;
    files.write(run_files::PARQUET, table.to_parquet().map_err(failed(run_files::PARQUET))?)?;
    files.write(run_files::REPORT, report::sweep_page(page).into_bytes())?;
    Ok(files.names)
}

/// Writes all files of a comparison into the draft and gives their names.
pub(super) fn fill_comparison(draft: &Draft, comparison: &RunComparison) -> Result<Vec<String>, StoreError> {
    let mut files = Files { draft, names: Vec::new() };
    files.write(run_files::SUMMARY, json(&comparison.summary())?)?;
    #[cfg(feature = "rerun")]
    files.comparison(comparison)?;
    files.write(run_files::REPORT, compare_page::compare_page(comparison).into_bytes())?;
    Ok(files.names)
}

struct Files<'a> {
    draft: &'a Draft,
    names: Vec<String>,
}

impl Files<'_> {
    fn write(&mut self, name: &str, content: Vec<u8>) -> Result<(), StoreError> {
        self.draft.write(name, content)?;
        self.names.push(name.into());
        Ok(())
    }

    /// Writes the page, which lists the files written before it.
    fn page(&mut self, contents: &Contents, results: &Results) -> Result<(), StoreError> {
        let Contents { model, outcome, scenario, failure, .. } = *contents;
        let page = report::run_page(&RunPage { model, outcome, results, scenario, failure, files: &self.names });
        self.write(run_files::REPORT, page.into_bytes())
    }

    #[cfg(feature = "rerun")]
    fn recording(&mut self, contents: &Contents, results: &Results) -> Result<(), StoreError> {
        let Contents { model, outcome, scenario, failure, .. } = *contents;
        let path = self.draft.path().join(run_files::RECORDING);
        report::recording::write(&path, &RunPage { model, outcome, results, scenario, failure, files: &self.names })
            .map_err(|error| StoreError::write(&path, io::Error::other(error.to_string())))?;
        self.names.push(run_files::RECORDING.into());
        Ok(())
    }

    #[cfg(feature = "rerun")]
    fn study_recording(&mut self, study: &StudyPage) -> Result<(), StoreError> {
        let path = self.draft.path().join(run_files::RECORDING);
        report::recording::write_study(&path, study)
            .map_err(|error| StoreError::write(&path, io::Error::other(error.to_string())))?;
        self.names.push(run_files::RECORDING.into());
        Ok(())
    }

    #[cfg(feature = "rerun")]
    fn comparison(&mut self, comparison: &RunComparison) -> Result<(), StoreError> {
        let path = self.draft.path().join(run_files::RECORDING);
        report::recording::write_comparison(&path, comparison)
            .map_err(|error| StoreError::write(&path, io::Error::other(error.to_string())))?;
        self.names.push(run_files::RECORDING.into());
        Ok(())
    }

    fn vtu(&mut self, model: &Model, outcome: &Outcome) -> Result<(), StoreError> {
        let folder = self.draft.path().join(run_files::SNAPSHOTS);
        let failed = |error| StoreError::write(&folder, io::Error::other(error));
        let draft = self.draft;
        let written = vtu::files(model, outcome).map(|file| {
            let vtu::File { name, content } = file.map_err(failed)?;
            draft.write(&name, content)?;
            Ok(name)
        });
        self.names.extend(written.collect::<Result<Vec<String>, StoreError>>()?);
        Ok(())
    }

    fn script_output(&mut self, output: &ScriptOutput) -> Result<(), StoreError> {
        for (name, rows) in &output.tables {
            let file = format!("{}/{name}.csv", run_files::TABLES);
            let content = table(rows).map_err(|error| StoreError::write(self.draft.path().join(&file), error))?;
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

fn json(summary: &Map<String, Value>) -> Result<Vec<u8>, StoreError> {
    let text = serde_json::to_vec_pretty(summary);
    let mut text = text.map_err(|error| StoreError::write(run_files::SUMMARY, error.into()))?;
    text.push(b'\n');
    Ok(text)
}

/// Rows under the names of all their columns.
fn table(rows: &[Row]) -> io::Result<Vec<u8>> {
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
