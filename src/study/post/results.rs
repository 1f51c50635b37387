//! How a run is evaluated, and its results.

use std::sync::Arc;

use rhai::Engine;
use serde_json::{Map, Value, json};
use thiserror::Error;

use super::field::{compare, warnings};
use super::{Audit, Impact, Indent, Inflation, ReferenceComparison, Run, RunFindings, Stretch, Verdict, run};
use crate::field_comparison::FieldComparison;
use crate::functions;
use crate::script::{self, Fault, Limits, OutputCollector, Script, ScriptOutput, object};
use base::finding::Finding;
use lab::signal::filter::{self, ChannelFilter, Standard};
use lab::signal::resample;
use lab::signal::{Channel, Recording, Series, column};
use scene::model::loading::Test;
use scene::model::{self, Model};
use scene::simulate::Outcome;

/// Entries of a summary that are no figures: which scenario, and by which droptower.
pub const HEADER: [&str; 3] = ["scenario", "title", "droptower"];

/// Entries of a summary that a post script adds.
pub(super) const OUTPUT: [&str; 4] = ["answer", "tables", "plots", "files"];

/// Figures by kind of loading.
#[derive(Clone, Debug, PartialEq)]
pub enum Measures {
    /// Of an impact.
    Impact(Impact),
    /// Of a stretch.
    Stretch(Stretch),
    /// Of an indentation.
    Indent(Indent),
    /// Of an inflation.
    Inflation(Inflation),
}

/// A measured run.
#[derive(Clone, Debug)]
pub struct Results {
    /// The channels of `signals.csv`, the filtered one included.
    pub signals: Recording,
    /// Figures of its kind of loading.
    pub measures: Measures,
    /// Size, cost and errors of the run.
    pub audit: Audit,
    /// The findings of the run, of its comparison with a reference and of its post script.
    pub findings: RunFindings,
    /// The reference, where there is one.
    pub comparison: Option<ReferenceComparison>,
    /// The run beside the displacement field of the reference, where there is one.
    pub field: Option<Arc<FieldComparison>>,
    /// The output of the post script.
    pub script_output: ScriptOutput,
}

/// Why a finished run cannot be measured.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum EvaluateError {
    /// The acceleration cannot be resampled, or the channel filter needs a higher sample rate.
    #[error("the acceleration cannot be filtered: {0}")]
    Filter(#[from] lab::Error),
    /// The post script failed.
    #[error(transparent)]
    Script(#[from] Fault),
}

impl EvaluateError {
    /// Whether the same run may be measured another time: its post script took too long or could not be started.
    pub fn may_pass(&self) -> bool {
        matches!(self, EvaluateError::Script(fault) if fault.may_pass)
    }
}

impl Results {
    /// Everything but the post script.
    pub(super) fn measure(
        model: &Model,
        outcome: &Outcome,
        comparison: Option<ReferenceComparison>,
    ) -> Result<Results, EvaluateError> {
        let signals = with_filtered(model, &outcome.signals)?;
        let mut findings = RunFindings::from_outcome(model, outcome);
        let measures = match model.loading.test() {
            Test::Impact => Measures::Impact(Impact::measure(model, &signals, comparison.as_ref(), &mut findings)),
            Test::Stretch => Measures::Stretch(Stretch::measure(outcome, &signals)),
            Test::Indent { velocity } => Measures::Indent(Indent::measure(velocity, outcome, &signals)),
            Test::Inflation => Measures::Inflation(Inflation::measure(outcome, &signals)),
        };
        comparison.iter().flat_map(ReferenceComparison::warnings).for_each(|warning| findings.push(&warning));
        let field = compare(model, outcome, comparison.as_ref());
        warnings(field.as_ref()).iter().for_each(|warning| findings.push(warning));
        let field = field.and_then(Result::ok).map(Arc::new);
        let verdict = Verdict::of_run(model, outcome, &measures, &signals, &findings);
        let audit = Audit::from_outcome(outcome, verdict, field.as_deref());
        let script_output = ScriptOutput::default();
        Ok(Results { signals, measures, audit, findings, comparison, field, script_output })
    }

    /// The results of a run that was ended early, see `Impact::ended_early`.
    pub fn ended_early(self) -> Results {
        match self.measures {
            Measures::Impact(impact) => Results { measures: Measures::Impact(impact.ended_early()), ..self },
            measures => Results { measures, ..self },
        }
    }

    /// The content of `summary.json`; numbers that are not finite are null.
    pub fn summary(&self, model: &Model) -> Map<String, Value> {
        let mut summary = header(model);
        summary.extend(self.figures());
        summary.extend(self.script_output.measures.clone());
        let [answer, tables, plots, files] = OUTPUT.map(String::from);
        summary.extend(self.script_output.answer.iter().map(|sentence| (answer.clone(), json!(sentence))));
        if !self.script_output.tables.is_empty() {
            let rows = self.script_output.tables.iter();
            let rows = rows.map(|(name, rows)| (name.clone(), json!(rows)));
            summary.insert(tables, Value::Object(rows.collect()));
        }
        if !self.script_output.plots.is_empty() {
            let titles = self.script_output.plots.iter().map(|plot| plot.title.clone());
            summary.insert(plots, titles.collect());
        }
        if !self.script_output.files.is_empty() {
            summary.insert(files, self.script_output.files.names().into());
        }
        summary
    }

    /// The figures and the findings by name, in the order of `summary.json`.
    pub fn figures(&self) -> Map<String, Value> {
        let own = match &self.measures {
            Measures::Impact(impact) => impact.figures(),
            Measures::Stretch(stretch) => object(stretch),
            Measures::Indent(indent) => object(indent),
            Measures::Inflation(inflation) => object(inflation),
        };
        own.into_iter().chain(object(&self.audit)).chain(object(&self.findings)).collect()
    }

    /// Whether an impactor rebounded.
    fn rebounds(&self) -> bool {
        let Measures::Impact(Impact { bodies, .. }) = &self.measures else { return false };
        bodies.iter().any(|body| body.rebound_velocity_m_s.is_some_and(|velocity| velocity > 0.0))
    }

    /// The names that a post script cannot give: those of this run and of the summary's own parts.
    fn reserved(&self) -> Vec<String> {
        let own = HEADER.into_iter().chain(OUTPUT).map(String::from);
        own.chain(self.figures().into_iter().map(|(name, _)| name)).collect()
    }
}

fn header(model: &Model) -> Map<String, Value> {
    let values = [json!(model.name), json!(model.title), json!(env!("CARGO_PKG_VERSION"))];
    HEADER.map(String::from).into_iter().zip(values).collect()
}

/// `signals` with the channel `acceleration_filtered_m_s2` of each impactor.
fn with_filtered(model: &Model, signals: &Recording) -> Result<Recording, EvaluateError> {
    let mut signals = signals.clone();
    for prefix in model.prefixes() {
        let [raw, name] =
            [column::ACCELERATION, column::ACCELERATION_FILTERED].map(|column| format!("{prefix}{}", column.name));
        if let Some(acceleration) = signals.series(&raw) {
            let values = filtered(model, &acceleration)?;
            signals.insert_after(&raw, Channel { name, values });
        }
    }
    Ok(signals)
}

/// An acceleration through the channel filter of the run.
fn filtered(model: &Model, raw: &Series) -> Result<Vec<f64>, EvaluateError> {
    // A run that failed in its first steps has nothing to filter.
    let Some(class) = model.output.filter.filter(|_| raw.len() >= 2) else { return Ok(raw.values().to_vec()) };
    let step = resample::common_step(raw.time());
    let even = match step {
        Some(_) => raw.clone(),
        None => resample::uniform(raw, 1.0 / model.output.sample_rate)?,
    };
    let filtered = filter::channel(&even, class, Standard::Iso6487)?;
    Ok(match step {
        Some(_) => filtered.values().to_vec(),
        None => resample::onto(&filtered, raw.time()),
    })
}

/// The reference and the post script of a model, read and checked.
#[derive(Clone, Debug)]
pub struct Plan {
    comparison: Option<ReferenceComparison>,
    script: Option<Arc<Script>>,
    /// Findings about the scenario itself.
    findings: Vec<Finding>,
}

/// Why the evaluation of a run cannot be prepared.
#[derive(Debug, Error)]
pub enum PrepareError {
    /// The channel filter needs a higher sample rate.
    #[error("output.filter: {0}")]
    Filter(lab::Error),
    /// The recording or the field of the reference cannot be read.
    #[error(transparent)]
    Recording(#[from] lab::Error),
    /// The recording does not suit the run.
    #[error(transparent)]
    Reference(#[from] crate::Error),
    /// The post script cannot be read or compiled.
    #[error(transparent)]
    Script(#[from] script::ReadError),
}

impl Plan {
    /// Reads and checks the reference, the filter and the post script of `model`.
    ///
    /// # Errors
    /// The filter does not suit the sample rate, the reference cannot be read, or the script does not compile.
    pub fn prepare(model: &Model) -> Result<Plan, PrepareError> {
        if let Some(class) = model.output.filter {
            ChannelFilter::new(class, 1.0 / model.output.sample_rate, Standard::Iso6487)
                .map_err(PrepareError::Filter)?;
        }
        let comparison = ReferenceComparison::read(model)?;
        let collector = OutputCollector::new(Vec::new());
        let engine = host(&collector);
        let stand_in = run::scope(Run::empty());
        let read = |path| Script::read(&engine, &stand_in, path);
        let script = model.post.as_deref().map(read).transpose()?.map(Arc::new);
        Ok(Plan { comparison, script, findings: vec![] })
    }

    /// The plan whose results have these findings of the scenario besides their own.
    pub fn with_findings(self, findings: Vec<Finding>) -> Plan {
        Plan { findings, ..self }
    }

    /// Findings about the scenario itself.
    pub fn findings(&self) -> &[Finding] {
        &self.findings
    }

    /// Whether the plan of one model is also that of the other.
    pub fn is_common(one: &Model, other: &Model) -> bool {
        // What a raw recording is reduced with: not the friction on the film, which searches vary.
        let reduced_with = |model: &Model| -> Vec<(Option<String>, f64, [f64; 3])> {
            model.impactors.iter().map(|own| (own.name.clone(), own.mass, own.velocity)).collect()
        };
        one.reference == other.reference
            && one.post == other.post
            && one.output == other.output
            && reduced_with(one) == reduced_with(other)
            && one.loading == other.loading
    }

    /// Measures the run and adds what its post script leaves.
    pub fn evaluate(&self, model: &Model, outcome: &Outcome) -> Result<Results, EvaluateError> {
        let mut results = self.measure(model, outcome)?;
        if let Some(script) = &self.script {
            let collector = OutputCollector::new(results.reserved());
            let run = Run::new(model, outcome, &results, None);
            script.run(&host(&collector), run::scope(run))?;
            results.script_output = collector.output();
            results.findings.extend(&results.script_output.findings);
        }
        Ok(results)
    }

    /// Measures the run without its script.
    pub fn measure(&self, model: &Model, outcome: &Outcome) -> Result<Results, EvaluateError> {
        let mut results = Results::measure(model, outcome, self.comparison.clone())?;
        let rebounds = results.rebounds();
        let findings =
            self.findings.iter().filter(|finding| rebounds || finding.code != model::ABSORPTION_NOT_GIVEN.name);
        results.findings.extend(findings);
        Ok(results)
    }

    /// The text of the post script.
    pub fn script(&self) -> Option<&str> {
        self.script.as_deref().map(Script::text)
    }

    /// The identity of the post script: its text and those of its modules.
    pub fn whole_script(&self) -> Option<String> {
        self.script.as_deref().map(Script::whole_text)
    }

    /// The comparison with the reference, where the scenario names one.
    pub fn comparison(&self) -> Option<&ReferenceComparison> {
        self.comparison.as_ref()
    }
}

fn host(collector: &OutputCollector) -> Engine {
    let mut engine = functions::engine(Limits::POST);
    functions::register_output(&mut engine, collector);
    run::register(&mut engine);
    engine
}
