//! The evaluation of a run, prepared before it: the reference is read and the script compiled first.

use std::sync::Arc;

use rhai::Engine;
use thiserror::Error;

use super::{EvaluateError, ReferenceComparison, ReferenceError, Results, Run, run};
use crate::functions;
use crate::script::{self, Limits, OutputCollector, Script};
use base::finding::Finding;
use lab::signal::filter::{ChannelFilter, Standard};
use scene::model::{self, Model};
use scene::simulate::Outcome;

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
    Filter(#[from] lab::Error),
    /// The reference cannot be read.
    #[error(transparent)]
    Reference(#[from] ReferenceError),
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
            ChannelFilter::new(class, 1.0 / model.output.sample_rate, Standard::Iso6487)?;
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
        one.reference == other.reference
            && one.post == other.post
            && one.output == other.output
            && one.impactors == other.impactors
            && one.loading == other.loading
    }

    /// Measures the run and adds what its post script leaves.
    pub fn evaluate(&self, model: &Model, outcome: &Outcome) -> Result<Results, EvaluateError> {
        let mut results = self.measure(model, outcome)?;
        if let Some(script) = &self.script {
            let collector = OutputCollector::new(results.measures.reserved());
            let run = Run::new(model, outcome, &results, None);
            script.run(&host(&collector), run::scope(run))?;
            results.script_output = collector.output();
            results.measures.findings_mut().extend(&results.script_output.findings);
        }
        Ok(results)
    }

    /// Measures the run without its script.
    pub fn measure(&self, model: &Model, outcome: &Outcome) -> Result<Results, EvaluateError> {
        let mut results = Results::measure(model, outcome, self.comparison.clone())?;
        let rebounds = results.measures.rebounds();
        let findings =
            self.findings.iter().filter(|finding| rebounds || finding.code != model::ABSORPTION_NOT_GIVEN.name);
        results.measures.findings_mut().extend(findings);
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
