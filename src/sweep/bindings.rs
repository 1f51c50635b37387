//! Sweeps, screening and indices in scripts.

use std::sync::Arc;

use droptower_uncertainty::indices::{self, FactorIndices};
use droptower_uncertainty::screening::{self, Effects};
use droptower_uncertainty::statistics::{Bootstrap, Estimate};
use rhai::{Dynamic, Engine, Map, NativeCallContext};
use serde_json::{Value, json};

use super::table::{Column, Table, Values};
use super::work::{Done, Stop, Work};
use super::{Share, Sweep, SweepError, SweepResults};
use crate::post::{Evaluations, Study};
use crate::scenario::{Assignment, Document};
use crate::script::{Chapter, Entry, HostResult, Options, Session, from_json, refuse, to_json};

/// Levels of a screening, of each input.
const LEVELS: usize = 8;

/// Offers sweeps to scripts; their runs are taken from `evaluations` and added to them.
pub fn register(engine: &mut Engine, evaluations: &Arc<Evaluations>) {
    let of = |work: fn(&Study, &Options<'_>, &Host<'_>) -> HostResult<Dynamic>, name: &'static str| {
        let evaluations = Arc::clone(evaluations);
        move |context: NativeCallContext, study: &mut Study, options: Map| {
            let host = Host { evaluations: &evaluations, session: Session::of(&context) };
            work(study, &Options { of: name, map: &options }, &host)
        }
    };
    engine
        .register_fn("sweep", of(sweep, "sweep"))
        .register_fn("screening", of(screen, "screening"))
        .register_fn("indices", of(indices, "indices"));
}

/// What a script's sweeps are run with.
struct Host<'a> {
    evaluations: &'a Evaluations,
    session: Session,
}

impl Host<'_> {
    /// The results of a sweep.
    fn results(&self, sweep: &Sweep) -> HostResult<SweepResults> {
        let done = self.done(sweep)?;
        SweepResults::of(sweep, &done, self.evaluations).map_err(refuse)
    }

    fn done(&self, sweep: &Sweep) -> HostResult<Done> {
        let stop = Stop { requested: self.session.cancellation().clone(), deadline: None };
        let work = Work { sweep, evaluations: self.evaluations, share: Share::WHOLE, stop: &stop, gather: false };
        let done = work.run(&|_| {}).map_err(refuse)?;
        if done.len() < sweep.len() { Err(refuse("the sweep was cancelled")) } else { Ok(done) }
    }
}

/// The scenario of a study with what the options vary in place of what it varies itself.
fn varied(study: &Study, options: &Options<'_>) -> HostResult<Document> {
    let mut changes = vec![];
    if let Some(keys) = options.map.get("vary") {
        changes.push(Assignment::unset("variation", "vary"));
        changes.push(assignment("variation", &to_json(keys)?)?);
        if study.document().find("variation").is_none() {
            changes.remove(0);
        }
    }
    for name in ["samples", "seed", "method"] {
        if let Some(value) = options.map.get(name) {
            changes.push(assignment(&format!("variation.{name}"), &to_json(value)?)?);
        }
    }
    Ok(study.document().with(&changes))
}

fn assignment(path: &str, value: &Value) -> HostResult<Assignment> {
    let value = toml::Value::try_from(value).map_err(|error| refuse(format!("{path}: {error}")))?;
    Assignment::from_value(path, &value, "options").map_err(|mistakes| refused(SweepError::Scenario(mistakes)))
}

fn refused(error: SweepError) -> Box<rhai::EvalAltResult> {
    refuse(match error {
        SweepError::Scenario(mistakes) => super::refusal(&mistakes),
        SweepError::NothingVaries => "nothing varies: give `vary`, or a scenario with [variation]".into(),
        SweepError::Points(error) => error.to_string(),
        SweepError::Prepare(error) => error.to_string(),
    })
}

/// `sweep(scenario, #{ … })`.
fn sweep(study: &Study, options: &Options<'_>, host: &Host<'_>) -> HostResult<Dynamic> {
    options.check(&["vary", "samples", "seed", "method"])?;
    let sweep = Sweep::prepare(&varied(study, options)?, None).map_err(refused)?;
    let results = host.results(&sweep)?;
    let mut summary = results.summary(&sweep, 0.0);
    ["seconds", "engine_s", "scenario", "title", "droptower"].iter().for_each(|name| drop(summary.remove(*name)));
    summary.insert("table".into(), columns(&results.table));
    Ok(from_json(&Value::Object(summary)))
}

/// The columns of a table by name.
fn columns(table: &Table) -> Value {
    let values = |column: &Column| match &column.values {
        Values::Numbers(values) => json!(values),
        Values::Flags(values) => json!(values),
        Values::Texts(values) => json!(values),
    };
    table.columns.iter().map(|column| (column.name.clone(), values(column))).collect()
}

/// `screening(scenario, #{ … })`.
fn screen(study: &Study, options: &Options<'_>, host: &Host<'_>) -> HostResult<Dynamic> {
    options.check(&["vary", "trajectories", "seed", "figures"])?;
    let count = whole(options, "trajectories", 10)?;
    let seed = whole(options, "seed", 1)? as u64;
    let places = |factors| screening::trajectories(factors, count, LEVELS, seed).map_err(|error| error.to_string());
    let (sweep, points) = at(study, options, &places)?;
    let of_factor =
        |Effects { mean, mean_magnitude: Estimate { value, interval }, deviation, missing, .. }: Effects| {
            let interval = interval.map(|interval| [interval.low, interval.high]);
            json!({ "mu_star": value, "interval": interval, "mu": mean, "sigma": deviation, "missing": missing })
        };
    reduced(&sweep, options, host, |outputs| {
        let effects = screening::effects(&points, outputs, &Bootstrap::default()).map_err(|error| error.to_string())?;
        Ok(effects.into_iter().map(|effects| effects.map_or(Value::Null, of_factor)).collect())
    })
}

/// `indices(scenario, #{ … })`.
fn indices(study: &Study, options: &Options<'_>, host: &Host<'_>) -> HostResult<Dynamic> {
    options.check(&["vary", "blocks", "seed", "figures"])?;
    let blocks = whole(options, "blocks", 64)?;
    let seed = whole(options, "seed", 1)? as u64;
    let places = |factors| indices::rows(factors, blocks, seed).map_err(|error| error.to_string());
    let (sweep, _) = at(study, options, &places)?;
    let estimate = |Estimate { value, interval }: Estimate| json!({ "value": value, "interval": interval.map(|interval| [interval.low, interval.high]) });
    let of_factor = |FactorIndices { first, total, missing, .. }: FactorIndices| json!({ "first": estimate(first), "total": estimate(total), "missing": missing });
    let factors = sweep.variation().factors.len();
    reduced(&sweep, options, host, |outputs| {
        let found = indices::indices(factors, outputs, &Bootstrap::default()).map_err(|error| error.to_string())?;
        Ok(found.into_iter().map(of_factor).collect())
    })
}

/// The whole number in an option.
fn whole(options: &Options<'_>, name: &str, default: usize) -> HostResult<usize> {
    let Some(value) = options.map.get(name) else { return Ok(default) };
    let number = value.as_int().ok().and_then(|number| usize::try_from(number).ok()).filter(|number| *number > 0);
    number.ok_or_else(|| refuse(format!("expected a whole number above zero as {name}, found {value}")))
}

/// Points of the unit cube.
type Points = Vec<Vec<f64>>;

/// The sweep of a study at points of the unit cube, whose number of coordinates is that of the keys that vary.
fn at(
    study: &Study,
    options: &Options<'_>,
    places: &dyn Fn(usize) -> Result<Points, String>,
) -> HostResult<(Sweep, Points)> {
    let document = varied(study, options)?;
    let variation = crate::model::variation(&document).map_err(|mistakes| refused(SweepError::Scenario(mistakes)))?;
    let factors = variation.ok_or_else(|| refused(SweepError::NothingVaries))?.factors.len();
    let points = places(factors).map_err(refuse)?;
    Ok((Sweep::at(&document, &points).map_err(refused)?, points))
}

/// What becomes of the figures of a sweep, by figure and by key: of those in the option `figures`, or of all that vary.
fn reduced(
    sweep: &Sweep,
    options: &Options<'_>,
    host: &Host<'_>,
    of: impl Fn(&[Option<f64>]) -> Result<Vec<Value>, String>,
) -> HostResult<Dynamic> {
    let results = host.results(sweep)?;
    let asked = options.map.get("figures").cloned().map(Dynamic::into_typed_array::<String>).transpose();
    let asked = asked.map_err(|found| refuse(format!("expected a list of names as figures, found {found}")))?;
    let varying = || results.effects.iter().map(|effects| effects.figure.clone()).collect();
    let mut found = serde_json::Map::new();
    for name in asked.unwrap_or_else(varying) {
        let column = results.table.column(&name);
        let column = column.ok_or_else(|| refuse(format!("the runs have no figure `{name}`")))?;
        let values = of(&column.values.numbers()).map_err(|error| refuse(format!("{name}: {error}")))?;
        let keys = sweep.variation().factors.iter().map(|factor| factor.path.clone());
        found.insert(name, Value::Object(keys.zip(values).collect()));
    }
    Ok(from_json(&Value::Object(found)))
}

/// The reference of sweeps in scripts.
pub const ENTRIES: &[Entry] = &[
    Entry {
        call: "sweep(scenario, #{ vary: #{ \"key.path\": values }, samples, seed, method })",
        gives: "the results of many runs, as `summary.json` of `droptower sweep` has them, and `table`, the columns of inputs \
                and figures; what is left out is that of [variation]. Failed runs are rows with their cause",
        example: "sweep(scenario(args.scenario).with(#{ \"loading.impact.duration\": \"1 ms\", \"specimen.mesh.size\": \"80 mm\", post: (), reference: () }), \
                  #{ vary: #{ \"impactor.mass\": [10, 11] } }).table.run == [1.0, 2.0]",
    },
    Entry {
        call: "screening(scenario, #{ trajectories, figures, vary, seed })",
        gives: "elementary effects (Morris) by figure and key: `mu_star` with its `interval`, `mu`, `sigma`, `missing`; \
                trajectories × (keys + 1) runs, 10 trajectories where none are given",
        example: "screening(scenario(args.scenario).with(#{ \"loading.impact.duration\": \"1 ms\", \"specimen.mesh.size\": \"80 mm\", post: (), reference: () }), \
                  #{ trajectories: 2, figures: [\"peak_displacement_m\"], vary: #{ \"loading.impact.velocity\": #{ uniform: [4.0, 4.2] } } }).peak_displacement_m[\"loading.impact.velocity\"].mu < 0",
    },
    Entry {
        call: "indices(scenario, #{ blocks, figures, vary, seed })",
        gives: "Sobol' indices by figure and key: `first` and `total`, each with `value` and `interval`, and `missing`; \
                blocks × (keys + 2) runs, 64 blocks where none are given",
        example: "indices(scenario(args.scenario).with(#{ \"loading.impact.duration\": \"1 ms\", \"specimen.mesh.size\": \"80 mm\", post: (), reference: () }), \
                  #{ blocks: 8, figures: [\"peak_displacement_m\"], vary: #{ \"loading.impact.velocity\": #{ uniform: [4.0, 4.2] } } }).peak_displacement_m[\"loading.impact.velocity\"].total.value > 0.9",
    },
];

/// The reference of sweeps in scripts.
pub const REFERENCE: &[Chapter] = &[Chapter { title: "many runs (droptower script)", entries: ENTRIES }];
