//! Functions of scenarios and their runs for studies: scripts that are started by `droptower script`.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use rhai::{Array, Dynamic, Engine, EvalAltResult, INT, Identifier, Map, NativeCallContext};
use serde_json::Value;

use crate::evaluate::{self, EvaluationError, Evaluations, NoOutcome, RunEvent};
use crate::functions::Reduced;
use crate::post::run::{self, ReferenceSignals};
use crate::post::{EvaluateError, Plan, ReferenceComparison, Results, Run};
use crate::script::{
    HostResult, Options, RunFindings, Session, ShippedModule, check_stop, from_json, list, number, numbers,
    numerical_failure, refuse, refuse_key, run_all, run_list, to_json,
};
use crate::store::evaluations::Share;
use base::budget::Claim;
use base::diagnostic::Diagnostic;
use base::finding::Finding;
use base::units::Density;
use lab::experiment::coupon::{Coupon, Curve, ShearMethod};
use lab::experiment::material_file::coupon::CouponMaterial;
use membrane::material::Law;
use scene::mesh::Outline;
use scene::model::{self, Model};
use scene::scenario::{Assignment, Document, grammar};
use scene::simulate::{self, Across, Cancellation, Outcome, PullError, RunOptions};

/// The module of films that is part of droptower, which scripts over scenarios can import.
pub(crate) const FILM: ShippedModule =
    ShippedModule { name: "droptower/film", text: include_str!("../../scripts/droptower/film.rhai") };

/// A checked scenario in a script. Cheap to clone.
#[derive(Clone)]
pub struct ScenarioHandle(Arc<Parts>);

struct Parts {
    document: Document,
    model: Model,
    plan: Plan,
    /// Runs that were computed before; none where all are computed again.
    evaluations: Option<Arc<Evaluations>>,
    _claim: Claim,
}

/// Bytes of a checked scenario beside its document, about: its model, with curves of up to some hundred points.
const MODEL_SIZE: usize = 16 << 10;

/// How scripts read scenarios: the changes of the command line, and the runs that are kept.
#[derive(Clone, Default)]
pub struct Scenarios {
    /// Changes of every scenario that a script reads.
    pub changes: Vec<Assignment>,
    /// Runs that were computed before; none where all are computed again.
    pub evaluations: Option<Arc<Evaluations>>,
}

impl Scenarios {
    /// The scenario at `path`, relative to the working directory, with the changes; checked.
    ///
    /// The session records the files that this reads.
    fn read(&self, path: &Path, session: &Session) -> HostResult<ScenarioHandle> {
        let document = Document::read(path).map_err(|mut found| {
            let folder = std::env::current_dir().ok().filter(|_| path.is_relative() && !path.exists());
            if let (Some(folder), Some(mistake)) = (folder, found.first_mut()) {
                let hint = format!(
                    "paths of scripts are seen from the working directory, {}, those of studies from their file",
                    folder.display()
                );
                mistake.hint.get_or_insert(hint);
            }
            mistakes(found)
        })?;
        ScenarioHandle::check(document.with(&self.changes), None, self.evaluations.clone(), session)
    }

    /// The scenario in a file that a script names, or one that it has read.
    pub(crate) fn named(&self, given: &Dynamic, session: &Session) -> HostResult<ScenarioHandle> {
        if let Some(scenario) = given.read_lock::<ScenarioHandle>() {
            return Ok(scenario.clone());
        }
        let path = given.clone().into_string();
        let path = path.map_err(|found| refuse!("expected a scenario or the path of one, found {found}"))?;
        self.read(Path::new(&path), session)
    }

    /// The option `scenario` with the changes of the option `set`, which messages name as `set`.
    pub(crate) fn changed(&self, options: &Options<'_>, set: &str, session: &Session) -> HostResult<ScenarioHandle> {
        let scenario = self.named(options.value("scenario")?, session)?;
        let Some(changes) = options.map.get("set") else { return Ok(scenario) };
        let changes = changes.read_lock::<Map>().ok_or_else(|| refuse!("{set} is a map of keys and values"))?;
        scenario.with(changes_of(&changes)?, session)
    }
}

/// Changes of a scenario: keys and what is written there; null leaves a key out.
pub(crate) type Changes = BTreeMap<String, Value>;

/// The outcome of a run, or why there is none.
type Found = Result<Outcome, NoOutcome>;

/// What makes figures of an outcome.
type Measure = fn(&Plan, &Model, &Outcome) -> Result<Results, EvaluateError>;

impl ScenarioHandle {
    /// Its name.
    pub fn name(&self) -> &str {
        &self.0.model.name
    }

    /// The checked scenario.
    pub(crate) fn model(&self) -> &Model {
        &self.0.model
    }

    /// What is measured of its runs.
    pub(crate) fn plan(&self) -> &Plan {
        &self.0.plan
    }

    /// How many runs of any scenario were taken from records so far, and how many were computed.
    pub(crate) fn counts(&self) -> [usize; 2] {
        self.0.evaluations.as_ref().map_or([0; 2], |all| all.counts())
    }

    /// The scenario as written, with its changes.
    pub fn document(&self) -> &Document {
        &self.0.document
    }

    /// Checks `document`, which may be a variant of another scenario.
    fn check(
        document: Document,
        other: Option<&Parts>,
        evaluations: Option<Arc<Evaluations>>,
        session: &Session,
    ) -> HostResult<ScenarioHandle> {
        let model = model::check(&document).map_err(mistakes)?;
        session.report(model::warnings(&document, &model).iter().map(Finding::new));
        let plan = match other.filter(|other| Plan::is_common(&model, &other.model)) {
            Some(other) => other.plan.clone(),
            None => Plan::prepare(&model).map_err(refuse)?,
        };
        if let (Some(reference), Some(comparison)) = (&model.reference, plan.comparison()) {
            let field = comparison.field.as_ref();
            reference.signals.iter().for_each(|path| session.add_recording(path, comparison.annotations.is_virtual()));
            if let Some((field, first)) = field.and_then(|field| Some((field, field.states.first()?))) {
                session.add_recording(&first.path, field.annotations.is_virtual());
            }
        }
        let _claim = session.budget().claim(MODEL_SIZE + document.size());
        Ok(ScenarioHandle(Arc::new(Parts { document, model, plan, evaluations, _claim })))
    }

    /// The scenario with changed values of its keys.
    pub(crate) fn with(&self, changes: Changes, session: &Session) -> HostResult<ScenarioHandle> {
        let changes = changes.iter().map(|(key, value)| assignment(key, value));
        let changes = changes.collect::<HostResult<Vec<_>>>()?;
        ScenarioHandle::check(self.0.document.with(&changes), Some(&*self.0), self.0.evaluations.clone(), session)
    }

    /// The same scenario with an impactor, the one that is recorded, faster by so much (m/s); the scenario as written stays.
    pub(crate) fn faster(&self, by: f64, session: &Session) -> ScenarioHandle {
        let mut model = self.0.model.clone();
        let recorded = model.reference.as_ref().map_or(0, |reference| reference.impactor);
        if let Some(impactor) = model.impactors.get_mut(recorded) {
            let speed = impactor.velocity.iter().map(|own| own * own).sum::<f64>().sqrt();
            impactor.velocity = impactor.velocity.map(|own| own * (1.0 + by / speed));
        }
        self.of_model(model, session)
    }

    /// The same scenario on elements of another size; none where a file has them.
    pub(crate) fn with_elements(&self, factor: f64, session: &Session) -> Option<ScenarioHandle> {
        if self.has_own_mesh() {
            return None;
        }
        let mut model = self.0.model.clone();
        for face in &mut model.faces {
            face.meshing.size *= factor;
            if let Some(grading) = &mut face.meshing.grading {
                grading.fine *= factor;
            }
        }
        Some(self.of_model(model, session))
    }

    /// Whether a file has its elements.
    fn has_own_mesh(&self) -> bool {
        matches!(self.0.model.specimen.shape, Outline::Mesh { .. })
    }

    /// Edge length of its smallest elements, m; none where a file has them.
    pub(crate) fn smallest_element(&self) -> Option<f64> {
        let of = |face: &model::Face| face.meshing.grading.as_ref().map_or(face.meshing.size, |grading| grading.fine);
        let all = self.0.model.faces.iter().map(of);
        all.reduce(f64::min).filter(|_| !self.has_own_mesh())
    }

    /// A variant whose checked scenario differs in what needs no other preparation.
    fn of_model(&self, model: Model, session: &Session) -> ScenarioHandle {
        let Parts { document, plan, evaluations, .. } = &*self.0;
        let _claim = session.budget().claim(MODEL_SIZE + document.size());
        let (document, plan, evaluations) = (document.clone(), plan.clone(), evaluations.clone());
        ScenarioHandle(Arc::new(Parts { document, model, plan, evaluations, _claim }))
    }

    /// The run.
    pub(crate) fn simulate(&self, session: &Session) -> HostResult<Run> {
        self.ask_for(1);
        self.simulate_or_wait(session, Plan::measure)
    }

    /// The run with the figures of its post script.
    pub(crate) fn simulate_with_post(&self, session: &Session) -> HostResult<Run> {
        self.ask_for(1);
        self.simulate_or_wait(session, Plan::evaluate)
    }

    /// Tells who observes runs that so many more are asked for.
    fn ask_for(&self, runs: usize) {
        self.0.evaluations.iter().for_each(|evaluations| evaluations.tell(RunEvent::Wanted(runs)));
    }

    /// The run, which was asked for, also where another process computes it.
    fn simulate_or_wait(&self, session: &Session, measure: Measure) -> HostResult<Run> {
        let run = self.simulate_with(session, Evaluations::outcome_of, measure)?;
        run.ok_or_else(|| refuse("the run was cancelled"))
    }

    /// The run whose `outcome` is found; none where another process computes it.
    fn simulate_with<F: Into<Option<Found>>>(
        &self,
        session: &Session,
        outcome: impl Fn(&Evaluations, &Model, &Cancellation) -> Result<F, EvaluationError>,
        measure: Measure,
    ) -> HostResult<Option<Run>> {
        let Parts { model, plan, evaluations, .. } = &*self.0;
        let cut = session.is_trial().then(|| evaluate::cut(model, plan.comparison()));
        let model = cut.as_ref().unwrap_or(model);
        let cancellation = session.cancellation();
        if !session.is_trial() {
            check_stop(session)?;
        }
        let found = match evaluations {
            Some(evaluations) => outcome(evaluations, model, cancellation).map_err(refuse)?.into(),
            None => {
                let options = RunOptions { cancellation: cancellation.clone(), ..RunOptions::default() };
                let ran = simulate::run_with(model, options, &mut |_| {});
                Some(ran.map_err(|error| NoOutcome::from_error(&error, model)))
            }
        };
        let Some(found) = found else { return Ok(None) };
        let outcome = found.map_err(|NoOutcome { cause, is_numerical }| {
            let cause = format!("{}: {cause}", model.name);
            if is_numerical { numerical_failure(cause) } else { refuse(cause) }
        })?;
        if let Some(time) = outcome.rupture_time {
            session.add_rupture(&model.name, time);
        }
        let mut results = measure(plan, model, &outcome).map_err(refuse)?;
        if model.run_time() < self.0.model.run_time() {
            results = results.ended_early();
        }
        let mut found = RunFindings::default();
        found.count(results.findings.iter().map(|finding| finding.code.as_str()));
        session.count_runs(&found);
        Ok(Some(Run::new(model, &outcome, &results, Some(session.budget()))))
    }

    /// The material of the specimen as a material file; none where its faces have materials of their own.
    pub(crate) fn film(&self) -> Option<String> {
        self.0.document.material_text()
    }

    /// What is written at a key, `()` where nothing is.
    fn written(&self, key: &str) -> HostResult<Dynamic> {
        if grammar::scenario().at(key).is_none() {
            return Err(refuse!("a scenario has no key `{key}`"));
        }
        let Some(node) = self.0.document.find(key) else { return Ok(Dynamic::UNIT) };
        let json = serde_json::to_value(node.to_toml()).map_err(|error| refuse!("`{key}`: {error}"))?;
        Ok(from_json(&json))
    }

    /// The curve of one fibre set or of shear, with its multipliers, of all faces or of one.
    fn curve(&self, name: &str, face: Option<INT>) -> HostResult<Curve> {
        let faces = &self.0.model.faces;
        let chosen = match face {
            Some(face) => usize::try_from(face).ok().and_then(|face| faces.get(face)).map(std::slice::from_ref),
            None => Some(&faces[..]),
        };
        let Some([first, others @ ..]) = chosen else {
            return Err(refuse!("the number of the face is out of range; {} has {}", self.0.model.name, faces.len()));
        };
        let found = points(&first.material.law, name)?;
        for other in others {
            if points(&other.material.law, name)? != found {
                return Err(refuse!("the curves of the faces differ: choose one, `curve({name:?}, 0)`"));
            }
        }
        let (strains, stresses) = found.into_iter().map(|[strain, stress]| (strain, stress)).unzip();
        Curve::new(strains, stresses).map_err(refuse)
    }

    /// The curve of a single element of the film at `strains`.
    fn pull(&self, strains: Vec<f64>, options: &Map) -> HostResult<Curve> {
        let options = Options::new("pull", options, &["across"])?;
        let stresses = self.pulled(&strains, across(&options)?)?;
        Curve::new(strains, stresses).map_err(refuse)
    }

    /// Stresses (Pa) of a single element of the film at increasing strains.
    pub(crate) fn pulled(&self, strains: &[f64], across: Across) -> HostResult<Vec<f64>> {
        simulate::pull(&self.0.model, strains, across).map_err(|error| self.failed(error))
    }

    /// Stresses (Pa) of a single element of the film at `strains`, forth and back, at the rate of the jaws or at given
    /// times.
    fn stresses(&self, strains: &[f64], options: &Map) -> HostResult<Array> {
        let options = Options::new("stresses", options, &["across", "times"])?;
        let (model, across) = (&self.0.model, across(&options)?);
        let found = match options.map.get("times") {
            None => simulate::pull(model, strains, across),
            Some(times) => {
                let times = times.clone().into_array();
                let times = times.map_err(|found| refuse!("expected a list as times, found {found}"))?;
                if times.len() != strains.len() {
                    return Err(refuse!("{} times for {} strains", times.len(), strains.len()));
                }
                let point = |(time, strain): (&Dynamic, &f64)| Ok([number(time, "a time")?, *strain]);
                let path = times.iter().zip(strains).map(point).collect::<HostResult<Vec<_>>>()?;
                simulate::pull_along(model, &path, across)
            }
        };
        Ok(list(&found.map_err(|error| self.failed(error))?))
    }

    fn failed(&self, error: PullError) -> Box<EvalAltResult> {
        refuse!("{}: {error}", self.0.model.name)
    }

    pub(crate) fn comparison(&self) -> HostResult<&ReferenceComparison> {
        let comparison = self.0.plan.comparison();
        comparison.ok_or_else(|| refuse!("{} names no [reference]", self.0.model.name))
    }
}

/// The option `across` of a single element.
fn across(options: &Options<'_>) -> HostResult<Across> {
    let given = options.map.get("across").map_or_else(|| "held".into(), Dynamic::to_string);
    across_named(&given).ok_or_else(|| refuse!("across is \"held\", \"free\", \"strip\" or \"equal\", not \"{given}\""))
}

/// What scripts call what holds a single element across.
pub(crate) fn across_named(name: &str) -> Option<Across> {
    let all = [("held", Across::Held), ("free", Across::Free), ("strip", Across::Strip), ("equal", Across::Equal)];
    all.into_iter().find(|(own, _)| *own == name).map(|(_, across)| across)
}

/// Points of a curve of a fabric, with the origin: strain, stress (Pa).
fn points(law: &Law, name: &str) -> HostResult<Vec<[f64; 2]>> {
    let curve = match (law, name) {
        (Law::Elastic(_) | Law::TensionField(_) | Law::Hyperelastic(_) | Law::Plastic(_), _) => {
            let film = match law {
                Law::Hyperelastic(_) => "a hyperelastic",
                Law::Plastic(_) => "a plastic",
                _ => "an elastic",
            };
            return Err(refuse!("{film} film has no curves; only a fabric has md, td and shear"));
        }
        (Law::Fabric(fabric), "md") => Some(fabric.md()),
        (Law::Fabric(fabric), "td") => Some(fabric.td()),
        (Law::Fabric(fabric), "shear") => Some(fabric.shear()),
        (Law::RateFabric(fabric), "md") => fabric.md().single(),
        (Law::RateFabric(fabric), "td") => fabric.td().single(),
        (Law::RateFabric(fabric), "shear") => Some(fabric.shear()),
        _ => return Err(refuse!("there is no curve `{name}`; a fabric has md, td and shear")),
    };
    let Some(curve) = curve else {
        return Err(refuse!("`{name}` is not a single curve: its curves depend on the strain rate (`rates`)"));
    };
    Ok(std::iter::once([0.0, 0.0]).chain(curve.points().iter().copied()).collect())
}

/// Simulates all in parallel; the runs are in the order of the scenarios.
fn simulate_all(context: NativeCallContext, scenarios: Array) -> HostResult<Array> {
    let session = Session::from_context(&context);
    let scenario = |item: Dynamic| {
        let found = item.type_name();
        let scenario = item.try_cast::<ScenarioHandle>();
        scenario.ok_or_else(|| refuse!("expected a list of scenarios, found {found} in it"))
    };
    let handles = scenarios.into_iter().map(scenario).collect::<HostResult<Vec<_>>>()?;
    // All have the evaluations of the script.
    let keeping = handles.iter().find(|scenario| scenario.0.evaluations.is_some());
    keeping.into_iter().for_each(|scenario| scenario.ask_for(handles.len()));
    let share = keeping.and_then(|scenario| scenario.0.evaluations.as_ref()).map_or(Share::WHOLE, |own| own.share());
    let unless_claimed =
        |place: usize| handles[place].simulate_with(&session, Evaluations::outcome_unless_claimed, Plan::measure);
    let found = run_all(&session, &share.order(handles.len()), unless_claimed)?;
    // What other processes compute comes last.
    let found: Vec<(&ScenarioHandle, Option<Run>)> = handles.iter().zip(found).collect();
    let runs = run_list(&session, &found, |(scenario, run)| match run {
        Some(run) => Ok(run.clone()),
        None => scenario.simulate_or_wait(&session, Plan::measure),
    });
    Ok(runs?.into_iter().map(Dynamic::from).collect())
}

/// The changes of a scenario in the map of a script, where `()` leaves a key out.
pub(crate) fn changes_of(map: &Map) -> HostResult<Changes> {
    let change = |(key, value): (&Identifier, &Dynamic)| match (value.is_unit(), to_json(value)?) {
        (false, Value::Null) => Err(refuse!("`{key}` cannot be written in a scenario: {value}")),
        (_, json) => Ok((key.to_string(), json)),
    };
    map.iter().map(change).collect()
}

/// The change of a key; null leaves it out.
fn assignment(key: &str, value: &Value) -> HostResult<Assignment> {
    if value.is_null() {
        return Ok(Assignment::unset(key, "script"));
    }
    let value = toml::Value::try_from(value);
    let value = value.map_err(|error| refuse!("`{key}` cannot be written in a scenario: {error}"))?;
    Assignment::from_value(key, &value, &format!("{CHANGED}{key}")).map_err(mistakes)
}

/// Beginning of the name of the source of a changed value, before its key.
const CHANGED: &str = "script: ";

/// One mistake in a changed value is reported at its key, several with their keys.
fn mistakes(mistakes: Vec<Diagnostic>) -> Box<EvalAltResult> {
    let key = |mistake: &Diagnostic| {
        let source = mistake.span.as_ref().map(|span| span.source.name.clone())?;
        source.strip_prefix(CHANGED).map(str::to_owned)
    };
    if let [mistake] = &mistakes[..]
        && let Some(key) = key(mistake)
    {
        return refuse_key(&key, &mistake.message, mistake.hint.clone());
    }
    let line = |mistake: &Diagnostic| match (key(mistake), &mistake.span) {
        (Some(key), _) => format!("`{key}`: {}", mistake.in_line()),
        (None, Some(span)) => format!("{span:?}: {}", mistake.in_line()),
        (None, None) => mistake.in_line(),
    };
    refuse(mistakes.iter().map(line).collect::<Vec<_>>().join("; "))
}

/// Offers scenarios to scripts; `changes` apply to each that a script reads. Runs are taken from `evaluations` and added to
/// them.
pub fn register(engine: &mut Engine, scenarios: &Scenarios) {
    run::register(engine);
    let scenarios = scenarios.clone();
    register_coupon_material(engine);
    Session::of_engine(engine).ship(&[FILM]);
    engine
        .register_type_with_name::<ScenarioHandle>("scenario")
        .register_fn("scenario", move |context: NativeCallContext, path: &str| {
            scenarios.read(Path::new(path), &Session::from_context(&context))
        })
        .register_fn("with", |context: NativeCallContext, scenario: &mut ScenarioHandle, changes: Map| {
            scenario.with(changes_of(&changes)?, &Session::from_context(&context))
        })
        .register_fn("simulate", |context: NativeCallContext, scenario: &mut ScenarioHandle| {
            scenario.simulate(&Session::from_context(&context))
        })
        .register_fn("simulate_all", simulate_all)
        .register_fn("pull", |scenario: &mut ScenarioHandle, strains: Array| {
            scenario.pull(numbers(&strains, "a strain")?, &Map::new())
        })
        .register_fn("pull", |scenario: &mut ScenarioHandle, strains: Array, more: Map| {
            scenario.pull(numbers(&strains, "a strain")?, &more)
        })
        .register_fn("pull", |scenario: &mut ScenarioHandle, at: Curve| {
            scenario.pull(at.strain().to_vec(), &Map::new())
        })
        .register_fn("pull", |scenario: &mut ScenarioHandle, at: Curve, more: Map| {
            scenario.pull(at.strain().to_vec(), &more)
        })
        .register_fn("stresses", |scenario: &mut ScenarioHandle, strains: Array| {
            scenario.stresses(&numbers(&strains, "a strain")?, &Map::new())
        })
        .register_fn("stresses", |scenario: &mut ScenarioHandle, strains: Array, more: Map| {
            scenario.stresses(&numbers(&strains, "a strain")?, &more)
        })
        .register_get("reference", |scenario: &mut ScenarioHandle| scenario.comparison().cloned().map(ReferenceSignals))
        .register_get("window", |scenario: &mut ScenarioHandle| scenario.comparison().map(|own| list(&own.window)))
        .register_fn("curve", |scenario: &mut ScenarioHandle, name: &str| scenario.curve(name, None))
        .register_fn("curve", |scenario: &mut ScenarioHandle, name: &str, face: INT| scenario.curve(name, Some(face)))
        .register_fn("written", |scenario: &mut ScenarioHandle, key: &str| scenario.written(key))
        .register_fn("material_text", |scenario: &mut ScenarioHandle| {
            let none = || refuse!("the specimen of {} has no material: its faces have", scenario.0.model.name);
            scenario.film().ok_or_else(none)
        })
        .register_get("model", |scenario: &mut ScenarioHandle| from_json(&Value::Object(run::facts(&scenario.0.model))))
        .register_get("name", |scenario: &mut ScenarioHandle| scenario.0.model.name.clone())
        .register_get("title", |scenario: &mut ScenarioHandle| scenario.0.model.title.clone());
}

/// Default name of the file of the shear curve.
const SHEAR_FILE: &str = "material-shear.csv";

/// Offers `coupon_material` to scripts.
fn register_coupon_material(engine: &mut Engine) {
    engine
        .register_fn("coupon_material", |reduced: Reduced, coupon: Coupon| texts(&reduced, coupon, &Map::new()))
        .register_fn("coupon_material", |reduced: Reduced, coupon: Coupon, more: Map| texts(&reduced, coupon, &more));
}

fn texts(reduced: &Reduced, coupon: Coupon, more: &Map) -> HostResult<Map> {
    let more = Options::new("coupon_material", more, &["density", "shear_file", "shear_by", "elastic_corner"])?;
    let density = more.map.get("density").map(|_| more.quantity("density", Density::DIMENSION)).transpose()?;
    let shear_file = more.map.get("shear_file").map_or(SHEAR_FILE.into(), Dynamic::to_string);
    let shear_by: Option<ShearMethod> =
        more.map.get("shear_by").map(|method| method.to_string().parse()).transpose().map_err(refuse)?;
    let shear_by = shear_by.unwrap_or_default();
    let elastic_corner = more.optional_number("elastic_corner")?;
    let reduction = &reduced.0;
    let material =
        CouponMaterial { reduction, coupon, density, shear_file: &shear_file, elastic_corner, shear_by, shear: None };
    let texts = material.texts().map_err(refuse)?;
    Ok(Map::from([("material".into(), texts.material.into()), ("shear".into(), texts.shear.into())]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use membrane::material::{
        self, Elastic, Fabric, Hyperelastic, HyperelasticLaw, Polynomial, RateCurves, TensionField,
    };

    fn straight(stress: f64) -> material::Curve {
        material::Curve::new(vec![[1.0, stress]]).unwrap()
    }

    #[test]
    fn only_fabric_with_one_curve_has_it() {
        let rates = vec![(1.0, straight(1e6)), (9.0, straight(2e6))];
        let by_rate = RateCurves::new(rates, 0.01).unwrap();
        let law = Law::RateFabric(Fabric::new(by_rate, RateCurves::from(straight(3e6)), straight(4e6), 0.0));
        assert_eq!(points(&law, "td").unwrap(), [[0.0, 0.0], [1.0, 3e6]]);
        assert_eq!(points(&law, "shear").unwrap(), [[0.0, 0.0], [1.0, 4e6]]);
        let elastic = Elastic { young: 5e7, poisson: 0.44 };
        let energy = Polynomial::neo_hookean(1e6);
        let rubber = Law::Hyperelastic(HyperelasticLaw::Polynomial(Hyperelastic { energy, wrinkling: false }));
        for (law, name, expected) in [
            (&law, "md", "`md` is not a single curve: its curves depend on the strain rate (`rates`)"),
            (&law, "bias", "there is no curve `bias`; a fabric has md, td and shear"),
            (&Law::Elastic(elastic.clone()), "md", "an elastic film has no curves"),
            (&Law::TensionField(TensionField(elastic)), "td", "an elastic film has no curves"),
            (&rubber, "md", "a hyperelastic film has no curves"),
        ] {
            let message = points(law, name).unwrap_err().to_string();
            assert!(message.contains(expected), "{name}: {message}");
        }
    }
}
