//! A finished run in scripts.

use std::sync::Arc;

use rhai::{Dynamic, Engine, EvalAltResult, INT, ImmutableString, Scope};
use serde_json::{Value, json};

use super::figures::SUMMARY;
use super::{ReferenceComparison, Results};
use crate::field_comparison::FieldComparison;
use crate::script::{Fields, HostResult, Session, from_json, number, numerical_failure, object, refuse};
use base::budget::{Budget, Claim};
use lab::dic::Field;
use lab::signal::{Recording, Series, column};
use scene::model::{Face, Impactor, Model};
use scene::simulate::Outcome;

/// A finished run: signals, energies, figures and what was run. Cheap to clone.
#[derive(Clone, Debug)]
pub struct Run(Arc<Parts>);

#[derive(Debug, Default)]
struct Parts {
    signals: Recording,
    energies: Recording,
    summary: serde_json::Map<String, Value>,
    model: serde_json::Map<String, Value>,
    field: Option<Arc<FieldComparison>>,
    _claim: Option<Claim>,
}

/// Channels by the names of their columns.
#[derive(Clone, Debug)]
struct Columns {
    run: Run,
    of: fn(&Parts) -> &Recording,
}

/// The errors against a displacement field in scripts.
#[derive(Clone, Debug)]
struct FieldErrors(Arc<FieldComparison>);

/// A reference recording in scripts.
#[derive(Clone, Debug)]
pub(crate) struct ReferenceSignals(pub ReferenceComparison);

impl Run {
    /// The run of `model` with its results, which count towards the budget of a script where there is one.
    pub fn new(model: &Model, outcome: &Outcome, results: &Results, budget: Option<&Budget>) -> Run {
        Run(Arc::new(Parts {
            _claim: budget.map(|budget| budget.claim(results.signals.size() + outcome.energies.size())),
            signals: results.signals.clone(),
            energies: outcome.energies.clone(),
            summary: results.summary(model),
            model: facts(model),
            field: results.field.clone(),
        }))
    }

    /// An empty run, for compiling scripts before the run.
    pub(crate) fn empty() -> Run {
        Run(Arc::default())
    }

    /// The figures of `summary.json`.
    pub fn summary(&self) -> &serde_json::Map<String, Value> {
        &self.0.summary
    }

    fn property(&mut self, name: ImmutableString) -> Result<Dynamic, Box<EvalAltResult>> {
        let run = || self.clone();
        match name.as_str() {
            "time" => Ok(Dynamic::from(Series::new(&*self.0.signals.time, &*self.0.signals.time))),
            "summary" => Ok(from_json(&Value::Object(self.0.summary.clone()))),
            "model" => Ok(from_json(&Value::Object(self.0.model.clone()))),
            "signals" => Ok(Dynamic::from(Columns { run: run(), of: |parts| &parts.signals })),
            "energies" => Ok(Dynamic::from(Columns { run: run(), of: |parts| &parts.energies })),
            "field" => Ok(self.0.field.clone().map_or(Dynamic::UNIT, |field| Dynamic::from(FieldErrors(field)))),
            name => self.channel(name).map(Dynamic::from),
        }
    }

    /// The channel that scripts call `name`.
    pub(crate) fn channel(&self, name: &str) -> Result<Series, Box<EvalAltResult>> {
        let shorts =
            || self.0.signals.channels.iter().filter_map(|channel| Some((short(&channel.name)?, &channel.name)));
        let series = shorts().find(|(short, _)| short == name).and_then(|(_, column)| self.0.signals.series(column));
        series.ok_or_else(|| {
            let shorts: Vec<String> = shorts().map(|(short, _)| short).collect();
            let others = ["time", "signals", "energies", "field", "summary", "model"];
            unknown("run", name, shorts.iter().map(String::as_str).chain(others))
        })
    }
}

impl Columns {
    fn get(&mut self, name: ImmutableString) -> Result<Series, Box<EvalAltResult>> {
        let recording = (self.of)(&self.run.0);
        let names = || recording.channels.iter().map(|c| c.name.as_str());
        let series = recording.series(&name);
        series.ok_or_else(|| unknown("recording", &name, names()))
    }

    fn names(&mut self) -> rhai::Array {
        let recording = (self.of)(&self.run.0);
        recording.channels.iter().map(|c| c.name.clone().into()).collect()
    }
}

impl FieldErrors {
    fn get(&mut self, name: ImmutableString) -> HostResult<Dynamic> {
        let (norms, [points, compared]) = (self.0.norms(), self.0.counts());
        let given = |value: Option<f64>| value.map_or(Dynamic::UNIT, Dynamic::from);
        let count = |count: usize| Dynamic::from(count as INT);
        match name.as_str() {
            "rms" => Ok(given(norms.rms())),
            "largest" => Ok(given(norms.largest())),
            "relative" => Ok(given(norms.relative())),
            "points" => Ok(count(points)),
            "compared" => Ok(count(compared)),
            name => Err(unknown("field", name, ["rms", "largest", "relative", "points", "compared", "residuals()"])),
        }
    }

    /// Residuals over `scale` (m).
    fn residuals(&mut self, scale: f64) -> HostResult<rhai::Array> {
        if let [first, ..] = self.0.not_reached[..] {
            return Err(numerical_failure(format!("the run did not reach the file of the field at {first} s")));
        }
        if !(scale.is_finite() && scale > 0.0) {
            return Err(refuse!("residuals are divided by a positive length, not by {scale}"));
        }
        Ok(self.0.residuals().map(|residual| Dynamic::from(residual / scale)).collect())
    }

    /// Residuals whose norm is the relative error.
    fn relative_residuals(&mut self) -> HostResult<rhai::Array> {
        let norm = self.0.measured_norm();
        if norm > 0.0 { self.residuals(norm) } else { Err(refuse("nothing has moved in the field")) }
    }
}

impl ReferenceSignals {
    fn get(&mut self, name: ImmutableString) -> Result<Dynamic, Box<EvalAltResult>> {
        let ReferenceComparison { acceleration, displacement, energy_absorption, drop, field, .. } = &self.0;
        let found = match name.as_str() {
            "acceleration" => acceleration.clone().map(Dynamic::from),
            "displacement" => displacement.clone().map(Dynamic::from),
            "energy_absorption" => Some(energy_absorption.map_or(Dynamic::UNIT, Dynamic::from)),
            "drop" => Some(drop.as_ref().map_or(Dynamic::UNIT, |drop| from_json(&json!(drop)))),
            "field" => Some(field.as_ref().map_or(Dynamic::UNIT, |field| from_json(&field_facts(field)))),
            _ => None,
        };
        let known = ["acceleration", "displacement", "energy_absorption", "drop", "field"];
        found.ok_or_else(|| unknown("reference", &name, known))
    }
}

fn field_facts(field: &Field) -> Value {
    let times: Vec<f64> = field.states.iter().map(|state| state.time).collect();
    json!({ "program": field.program, "points": field.points(), "times": times })
}

/// The name of a column in scripts; of one of several impactors with its name.
fn short(name: &str) -> Option<String> {
    let (prefix, column) = column::find(name)?;
    Some(format!("{prefix}{}", column.short))
}

fn unknown<'a>(owner: &str, name: &str, known: impl IntoIterator<Item = &'a str>) -> Box<EvalAltResult> {
    let known: Vec<&str> = known.into_iter().collect();
    refuse!("a {owner} has no `{name}`; it has {}", known.join(", "))
}

/// The quantities of a model that scripts read.
pub(crate) fn facts(model: &Model) -> serde_json::Map<String, Value> {
    let of_faces = |of: fn(&Face) -> Value| model.faces.iter().map(of).collect::<Value>();
    let mut facts = object(json!({
        "name": model.name, "title": model.title, "layers": of_faces(|face| json!(face.layers)),
        "thickness": of_faces(|face| json!(face.material.thickness)), "prestrain": of_faces(|face| json!(face.prestrain)),
    }));
    match model.impactors.as_slice() {
        [impactor] if impactor.mass.is_finite() => drop(facts.insert("mass".into(), json!(impactor.mass))),
        [] | [_] => {}
        several => {
            let of_one = |impactor: &Impactor| json!({ "name": impactor.words(), "mass": Some(impactor.mass).filter(|m| m.is_finite()) });
            facts.insert("impactors".into(), several.iter().map(of_one).collect());
        }
    }
    facts.extend(model.loading.facts().into_iter().map(|(name, value)| (name.to_owned(), json!(value))));
    facts
}

/// Offers the type of `run` to scripts.
pub(crate) fn register(engine: &mut Engine) {
    Session::of_engine(engine).declare(Fields { map: "summary", names: &SUMMARY });
    engine
        .register_type_with_name::<Run>("run")
        .register_indexer_get(Run::property)
        .register_type_with_name::<Columns>("recording")
        .register_indexer_get(Columns::get)
        .register_fn("names", Columns::names)
        .register_type_with_name::<FieldErrors>("field")
        .register_indexer_get(FieldErrors::get)
        .register_fn("residuals", |field: &mut FieldErrors| field.residuals(1.0))
        .register_fn("residuals", |field: &mut FieldErrors, deviation: Dynamic| {
            field.residuals(number(&deviation, "a standard deviation")?)
        })
        .register_fn("relative_residuals", FieldErrors::relative_residuals)
        .register_type_with_name::<ReferenceSignals>("reference")
        .register_indexer_get(ReferenceSignals::get);
}

/// The scope of a post script: the constant `run`.
pub(crate) fn scope(run: Run) -> Scope<'static> {
    let mut scope = Scope::new();
    scope.push_constant("run", run);
    scope
}
