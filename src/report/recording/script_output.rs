//! The output of a study in its recording.

use serde_json::{Map, Value, json};

use super::text::{self, Text};
use super::{Approach, Iteration, StudyRecording};
use crate::convergence::{objective, simulated, target};
use crate::{StudyPage, markdown};
use plot::{Correlation, Curve, Plot, TIME};
use study::script::{ConvergenceHistory, Fit, Iterate, Row, ScriptOutput};

impl StudyRecording {
    /// A recording of the study that its page shows.
    pub(super) fn from_page(study: &StudyPage) -> StudyRecording {
        let output = study.output;
        let is_over_time = |plot: &&Plot| plot.x.label == TIME;
        let (over_time, plots): (Vec<&Plot>, Vec<&Plot>) = output.plots.iter().partition(is_over_time);
        StudyRecording {
            name: study.name.into(),
            texts: texts(study),
            searches: output.searches.iter().flat_map(approaches).collect(),
            plots: plots.into_iter().cloned().collect(),
            over_time: over_time.into_iter().cloned().collect(),
            findings: output.findings.clone(),
            log: output.log.clone(),
        }
    }
}

/// Figures, tables, correlations, script and arguments.
fn texts(study: &StudyPage) -> Vec<Text> {
    let warnings = study.output.findings.iter().filter(|finding| finding.is_warning());
    let warnings: String =
        warnings.map(|found| format!("{} \\[{}\\]\n\n", text::escaped(&found.message), found.code)).collect();
    let summary = Text { title: "Summary".into(), markdown: warnings + markdown(&study.output.measures).as_str() };
    let given = serde_json::to_string_pretty(study.call).unwrap_or_else(|error| error.to_string());
    let run = [Text::verbatim("Script", study.script), Text::verbatim("What was run", &given)];
    let own = [Some(summary), Text::tables(study.output), correlations(study.output), Text::files(study.output)];
    own.into_iter().flatten().chain(run).collect()
}

fn correlations(output: &ScriptOutput) -> Option<Text> {
    let tables: Vec<String> = output.correlations.iter().map(|found| text::table(&found.title, &rows(found))).collect();
    (!tables.is_empty()).then(|| Text { title: "Correlations".into(), markdown: tables.join("\n") })
}

fn rows(Correlation { names, rows, .. }: &Correlation) -> Vec<Row> {
    let row = |(name, row): (&String, &Vec<f64>)| {
        let first = ("parameter".to_owned(), json!(name));
        let values = names.iter().cloned().zip(row.iter().map(|value| json!(value)));
        std::iter::once(first).chain(values).collect::<Map<String, Value>>()
    };
    names.iter().zip(rows).map(row).collect()
}

/// The best of a search over each target; without a target, its objective and its unknowns.
fn approaches(search: &ConvergenceHistory) -> Vec<Approach> {
    if search.fits.is_empty() {
        return vec![without_target(search)];
    }
    search.fits.iter().map(|fit| approach(search, fit)).collect()
}

fn approach(search: &ConvergenceHistory, fit: &Fit) -> Approach {
    let name = match search.fits.as_slice() {
        [_] => search.title.clone(),
        _ => format!("{}, {}", search.title, fit.label()),
    };
    let curves = || vec![simulated("simulated", fit)];
    let iterations = search.history.last().map(|best| iteration(search, best, curves()));
    Approach { name, target: target(search, fit), iterations: iterations.into_iter().collect() }
}

fn without_target(search: &ConvergenceHistory) -> Approach {
    let iterations = search.history.iter().map(|at| iteration(search, at, vec![])).collect();
    Approach { name: search.title.clone(), target: objective(search), iterations }
}

fn iteration(search: &ConvergenceHistory, at: &Iterate, curves: Vec<Curve>) -> Iteration {
    Iteration {
        number: u32::try_from(at.iteration).unwrap_or(u32::MAX),
        objective: at.f,
        parameters: search.unknowns.iter().cloned().zip(at.x.iter().copied()).collect(),
        curves,
    }
}
