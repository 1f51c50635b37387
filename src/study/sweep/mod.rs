//! Sweeps: many runs of a scenario whose keys vary, each evaluated once, by any number of processes.

mod bindings;
mod table;
mod warning;
mod work;

use rayon::prelude::*;

use crate::evaluate::{EvaluationError, EvaluationKeys, Evaluations};
use crate::post::{Plan, PrepareError};
use base::diagnostic::Diagnostic;
use base::finding::Finding;
pub use bindings::register;
use scene::model::{self, Factor, Input, Model, Point, Points, Variation};
use scene::scenario::Document;
use scene::simulate;
pub use table::{Effect, Effects, Quantiles, SweepResults, Table, Trend};
pub use warning::{Beyond, CODES, Limit, Warning, warnings};
pub use work::{Done, Event, RemainingWork, Stop, Work, seconds_to_go};

/// A scenario, what varies in it, and the values of its runs.
#[derive(Debug)]
pub struct Sweep {
    /// The scenario without what varies.
    base: Document,
    variation: Variation,
    points: Points,
    /// Model and plan of the scenario as written.
    model: Model,
    plan: Plan,
}

/// Why a scenario cannot be swept.
#[derive(Debug)]
pub enum SweepError {
    /// Mistakes in the scenario.
    Scenario(Vec<Diagnostic>),
    /// Nothing varies.
    NothingVaries,
    /// Its points cannot be chosen.
    Points(Diagnostic),
    /// Its evaluation cannot be prepared.
    Prepare(PrepareError),
}

/// Checks every listed value that is a word, such as a file, in the scenario as written. Whether numbers suit each other only
/// the runs tell.
///
/// # Errors
/// The mistakes of all these scenarios.
pub fn check_words(base: &Document, variation: &Variation) -> Result<(), Vec<Diagnostic>> {
    let scenarios = variation.factors.iter().flat_map(Factor::words).map(|assignment| base.with(&[assignment]));
    let mistakes: Vec<Diagnostic> = scenarios.filter_map(|document| model::check(&document).err()).flatten().collect();
    if mistakes.is_empty() { Ok(()) } else { Err(mistakes) }
}

/// One run of a sweep, checked.
#[derive(Debug)]
pub(crate) struct Case {
    pub model: Model,
    pub plan: Plan,
    pub keys: EvaluationKeys,
}

impl Sweep {
    /// The sweep of the scenario in `document`, of `samples` runs in place of the number that is written.
    ///
    /// # Errors
    /// The scenario as written has mistakes, nothing varies, or its points cannot be chosen.
    pub fn prepare(document: &Document, samples: Option<usize>) -> Result<Sweep, SweepError> {
        Sweep::with_points(document, |variation| variation.points(samples).map_err(SweepError::Points))
    }

    /// The sweep at places of the unit cube: of each key the probability of at most its value, in the order of the
    /// keys. Where keys are correlated, places are those of independent ones.
    ///
    /// # Errors
    /// As those of [`Sweep::prepare`].
    pub fn prepare_at(document: &Document, places: Vec<Vec<f64>>) -> Result<Sweep, SweepError> {
        Sweep::with_points(document, |variation| Ok(variation.coupled(places)))
    }

    fn with_points(
        document: &Document,
        points: impl FnOnce(&Variation) -> Result<Points, SweepError>,
    ) -> Result<Sweep, SweepError> {
        let variation = model::variation(document).map_err(SweepError::Scenario)?;
        let base = document.without_variation();
        let model = model::check(&base).map_err(SweepError::Scenario)?;
        simulate::check(&base, &model).map_err(SweepError::Scenario)?;
        let plan = Plan::prepare(&model).map_err(SweepError::Prepare)?;
        let variation = variation.ok_or(SweepError::NothingVaries)?;
        check_words(&base, &variation).map_err(SweepError::Scenario)?;
        let points = points(&variation)?;
        Ok(Sweep { base, variation, points, model, plan })
    }

    /// The keys that vary, and how.
    pub fn variation(&self) -> &Variation {
        &self.variation
    }

    /// The scenario as written.
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// The scenario as written, unchecked.
    pub fn base(&self) -> &Document {
        &self.base
    }

    /// Number of runs.
    pub fn len(&self) -> usize {
        self.points.len()
    }

    /// Whether there are no runs.
    pub fn is_empty(&self) -> bool {
        self.points.is_empty()
    }

    /// The values of the run at `place`, counted from zero.
    pub fn inputs(&self, place: usize) -> impl Iterator<Item = Input> {
        self.point(place).levels.into_iter().map(|level| level.input)
    }

    fn point(&self, place: usize) -> Point {
        self.variation.point(&self.points, place)
    }

    /// The scenario of the run at `place`.
    pub fn document(&self, place: usize) -> Document {
        self.base.with(&self.variation.assignments(&self.point(place)))
    }

    /// The changes of the scenario that give the run at `place`, as arguments of `--set`.
    pub fn changes(&self, place: usize) -> Vec<String> {
        let levels = self.variation.factors.iter().zip(self.point(place).levels);
        let written = |value: toml::Value| match value.as_float() {
            Some(small) if small != 0.0 && small.abs() < 1e-3 => format!("{small:e}"),
            _ => value.to_string(),
        };
        levels.map(|(factor, level)| format!("{}={}", factor.path, written(level.node.to_toml()))).collect()
    }

    /// Keys of the evaluations of all runs; none of a run whose values make no valid scenario.
    ///
    /// # Errors
    /// A mesh or a reference cannot be read.
    pub fn keys(&self) -> Result<Vec<Option<EvaluationKeys>>, EvaluationError> {
        let key = |place| Ok(self.case(place)?.ok().map(|case| case.keys));
        (0..self.len()).into_par_iter().map(key).collect()
    }

    /// The run at `place`, checked; why its values make no valid scenario is within.
    pub(crate) fn case(&self, place: usize) -> Result<Result<Case, String>, EvaluationError> {
        let document = self.document(place);
        let plan = |model: &Model| match Plan::is_common(model, &self.model) {
            true => Ok(self.plan.clone()),
            false => Plan::prepare(model).map_err(|error| error.to_string()),
        };
        let model = model::check(&document).map_err(|mistakes| refusal(&mistakes, &self.variation.factors));
        let (model, plan) = match model.and_then(|model| Ok((plan(&model)?, model))) {
            Ok((plan, model)) => (model, plan),
            Err(cause) => return Ok(Err(cause)),
        };
        let warnings = model::warnings(&document, &model);
        let plan = plan.with_findings(warnings.iter().map(Finding::new).collect());
        let keys = Evaluations::keys(&model, &plan)?;
        Ok(Ok(Case { model, plan, keys }))
    }
}

/// The mistakes of a scenario in one line, each with its key where it is the value of a factor.
fn refusal(mistakes: &[Diagnostic], factors: &[Factor]) -> String {
    let key = |mistake: &Diagnostic| {
        let is_there = |factor: &&Factor| mistake.span.as_ref().is_some_and(|span| span.is(&factor.span));
        factors.iter().find(is_there).map_or_else(String::new, |factor| format!("`{}`: ", factor.path))
    };
    let line = |mistake: &Diagnostic| format!("{}{}", key(mistake), mistake.in_line());
    mistakes.iter().map(line).collect::<Vec<_>>().join("; ")
}
