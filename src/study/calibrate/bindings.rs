//! `calibrate` in scripts, and what its result offers.

use std::borrow::Borrow;
use std::sync::{Arc, Mutex, MutexGuard};

use rhai::{Array, Dynamic, Engine, Map, NativeCallContext};
use serde_json::{Value, json};

use super::angles::{self, Angles};
use super::candidates;
use super::file::{self, StudyFile};
use super::fit::{self, Fit, LINEAR};
use super::left_out;
use super::parameter::{self, Role, Unknown};
use super::plan::{self, Plan};
use super::posterior::{Beginning, Posterior, PosteriorOptions};
use super::prediction::{Asked, Prediction};
use super::recorded_test::{self, Test};
use super::rows;
use super::verdict;
use super::warning::Warning;
use crate::identify::SearchHost;
use crate::scenario_functions::{ScenarioHandle, Scenarios};
use crate::script::{
    CallOptions, File, HostResult, Options, OutputCollector, Row, Session, from_json, number, refuse, refuse_key, texts,
};
use base::finding::Finding;
use uncertainty::statistics::quantiles;

/// What scripts are checked against before they run, since a search takes long.
const DECLARED: [CallOptions; 6] = [
    CallOptions { of: "calibrate", function: "calibrate", inside: None, names: file::options },
    CallOptions {
        of: "a test of calibrate",
        function: "calibrate",
        inside: Some("tests"),
        names: || file::options_at(file::TEST),
    },
    CallOptions {
        of: "a parameter of calibrate",
        function: "calibrate",
        inside: Some("parameters"),
        names: || [&file::parameter_options()[..], &parameter::CURVE_OPTIONS].concat(),
    },
    CallOptions { of: "posterior", function: "posterior", inside: None, names: || file::options_at("posterior") },
    CallOptions { of: "predict", function: "predict", inside: None, names: file::predict_options },
    CallOptions { of: "angles", function: "angles", inside: None, names: || angles::OPTIONS.into() },
];

/// What calibrations read scenarios, run searches and report with. Cheap to clone.
#[derive(Clone)]
pub(super) struct Surroundings {
    pub(super) scenarios: Scenarios,
    pub(super) host: SearchHost,
    pub(super) collector: OutputCollector,
}

/// A calibration that is done, for what follows from it.
#[derive(Clone, Copy)]
pub(super) struct Calibrated<'a> {
    pub(super) plan: &'a Plan,
    pub(super) fit: &'a Fit,
    pub(super) around: &'a Surroundings,
    pub(super) session: &'a Session,
}

/// The result of a calibration in a script. Cheap to clone.
#[derive(Clone)]
pub(super) struct Calibration(Arc<Parts>);

struct Parts {
    plan: Plan,
    fit: Fit,
    around: Surroundings,
    derived: Mutex<Derived>,
}

/// What was derived from a calibration so far; tables have all of it.
#[derive(Default)]
struct Derived {
    posterior: Option<Posterior>,
    predictions: Vec<Prediction>,
    candidates: Vec<Row>,
    left_out: Vec<Row>,
}

/// Offers `calibrate` to scripts, and the function of [`StudyFile::SCRIPT`] that runs a study, where there is one: scenarios are read
/// as `scenario` reads them, `host` runs the searches, and tables and findings go to `collector`.
pub fn register(
    engine: &mut Engine,
    scenarios: &Scenarios,
    host: &SearchHost,
    collector: &OutputCollector,
    study: Option<&Arc<StudyFile>>,
) {
    let around = Surroundings { scenarios: scenarios.clone(), host: host.clone(), collector: collector.clone() };
    if let Some(study) = study.map(Arc::clone) {
        let around = around.clone();
        engine.register_fn("calibrate_study", move |context: NativeCallContext| {
            study.run(&around, &Session::from_context(&context))
        });
    }
    let session = Session::of_engine(engine);
    DECLARED.iter().for_each(|options| session.declare_options(*options));
    engine
        .register_type_with_name::<Calibration>("calibration")
        .register_fn("calibrate", move |context: NativeCallContext, options: Map| {
            Calibration::new(&options, &around, &Session::from_context(&context))
        })
        .register_get("x", |own: &mut Calibration| own.values())
        .register_get("error", |own: &mut Calibration| own.0.fit.result.best.f)
        .register_get("converged", |own: &mut Calibration| own.0.fit.result.best.converged)
        .register_get("reason", |own: &mut Calibration| own.0.fit.result.best.reason.clone())
        .register_get("model_error", |own: &mut Calibration| match own.0.plan.has_residuals() {
            true => own.0.fit.share.into(),
            false => Dynamic::UNIT,
        })
        .register_get("iterations", |own: &mut Calibration| own.0.fit.iterations as rhai::INT)
        .register_get("evaluations", |own: &mut Calibration| own.0.fit.evaluations as rhai::INT)
        .register_get("parameters", |own: &mut Calibration| listed(&own.parameters()))
        .register_get("tests", |own: &mut Calibration| listed(&rows::tests(&own.0.plan, &own.0.fit)))
        .register_get("posterior_runs", |own: &mut Calibration| {
            own.derived().posterior.as_ref().map_or(0, |found| found.runs) as rhai::INT
        })
        .register_get("outcomes", |own: &mut Calibration| listed(&rows::outcomes(&own.0.plan, &own.0.fit)))
        .register_get("findings", |own: &mut Calibration| from_json(&json!(own.0.fit.findings)))
        .register_fn("test", |context: NativeCallContext, own: &mut Calibration, name: &str| {
            own.test(name, &Session::from_context(&context))
        })
        .register_fn("posterior", |context: NativeCallContext, own: &mut Calibration| {
            own.posterior(&Map::new(), &Session::from_context(&context))
        })
        .register_fn("posterior", |context: NativeCallContext, own: &mut Calibration, options: Map| {
            own.posterior(&options, &Session::from_context(&context))
        })
        .register_fn("predict", |context: NativeCallContext, own: &mut Calibration, scenarios: Array| {
            own.predict(&scenarios, &Map::new(), &Session::from_context(&context))
        })
        .register_fn("predict", |context: NativeCallContext, own: &mut Calibration, scenarios: Array, options: Map| {
            own.predict(&scenarios, &options, &Session::from_context(&context))
        })
        .register_fn("settles", |context: NativeCallContext, own: &mut Calibration, candidates: Array| {
            own.settles(&candidates, &Session::from_context(&context))
        })
        .register_fn("left_out", |context: NativeCallContext, own: &mut Calibration| {
            own.left_out(None, &Session::from_context(&context))
        })
        .register_fn("left_out", |context: NativeCallContext, own: &mut Calibration, tests: Array| {
            own.left_out(Some(&tests), &Session::from_context(&context))
        })
        .register_fn("angles", |context: NativeCallContext, own: &mut Calibration| {
            own.angles(&Map::new(), &Session::from_context(&context))
        })
        .register_fn("angles", |context: NativeCallContext, own: &mut Calibration, options: Map| {
            own.angles(&options, &Session::from_context(&context))
        })
        .register_fn("page", |own: &mut Calibration| own.page());
}

impl Calibration {
    pub(super) fn new(options: &Map, around: &Surroundings, session: &Session) -> HostResult<Calibration> {
        if session.is_trial() {
            return Err(refuse("an objective cannot search: `calibrate` is called within one"));
        }
        let mut plan = Plan::read(options, &around.scenarios, session)?;
        if around.collector.has_table(&plan.table("parameters")) {
            around.collector.report(Finding::new(&Warning::TablesReplaced)).map_err(refuse)?;
        }
        let fit = Fit::search(&mut plan, &around.host, session)?;
        let own = Calibration(Arc::new(Parts { plan, fit, around: around.clone(), derived: Mutex::default() }));
        own.report()?;
        own.films(session)?;
        Ok(own)
    }

    fn with<'a>(&'a self, session: &'a Session) -> Calibrated<'a> {
        let Parts { plan, fit, around, .. } = &*self.0;
        Calibrated { plan, fit, around, session }
    }

    /// Leaves a table of the results.
    fn table(&self, name: &str, rows: Vec<Row>) -> HostResult<()> {
        let Parts { plan, around, .. } = &*self.0;
        around.collector.table(&plan.table(name), rows).map_err(refuse)
    }

    /// Tables and findings of the result.
    fn report(&self) -> HostResult<()> {
        let Parts { plan, fit, around, .. } = &*self.0;
        self.table("parameters", self.parameters())?;
        let tests = rows::tests(plan, fit);
        let misfits: Vec<Finding> = rows::misfits(&tests).iter().map(Finding::new).collect();
        for (name, rows) in [("tests", tests), ("outcomes", rows::outcomes(plan, fit))] {
            if !rows.is_empty() {
                self.table(name, rows)?;
            }
        }
        let mut findings = fit.findings.iter().chain(&misfits);
        findings.try_for_each(|finding| around.collector.report(finding.clone())).map_err(refuse)
    }

    /// Leaves the film with the best values as a material file; where tests have films of their own, or values of their own for
    /// one, a file for each. None of film that no parameter changes.
    fn films(&self, session: &Session) -> HostResult<()> {
        let Parts { plan, around, .. } = &*self.0;
        let mut films: Vec<(String, Vec<&str>)> = Vec::new();
        for test in &plan.tests {
            // The faces of a specimen may have films of their own, which no one file holds.
            let Some(film) = self.test(&test.name, session)?.film() else { continue };
            if test.study.film().as_ref() == Some(&film) {
                continue;
            }
            match films.iter_mut().find(|(other, _)| *other == film) {
                Some((_, tests)) => tests.push(&test.name),
                None => films.push((film, vec![&test.name])),
            }
        }
        let is_one = films.len() == 1;
        for (place, (film, tests)) in films.into_iter().enumerate() {
            let name = plan.table(&if is_one { "film".to_owned() } else { format!("film_{}", place + 1) });
            let recordings = if session.virtual_recordings().is_empty() { "" } else { "VIRTUAL recordings of " };
            let (title, tests) = (plan.title(), tests.join(", "));
            let head = format!("The film that {title} found, calibrated to {recordings}{tests}.")
                .replace(char::is_control, " ");
            let content = format!("# {head}\n# The results beside it say how well each value is known.\n{film}");
            around.collector.file(File { name: format!("{name}.toml"), content }).map_err(refuse)?;
        }
        Ok(())
    }

    /// Reports findings.
    fn tell(&self, warnings: impl IntoIterator<Item = impl Borrow<Warning>>) -> HostResult<()> {
        let mut findings = warnings.into_iter().map(|warning| Finding::new(warning.borrow()));
        findings.try_for_each(|finding| self.0.around.collector.report(finding)).map_err(refuse)
    }

    fn parameters(&self) -> Vec<Row> {
        let Parts { plan, fit, .. } = &*self.0;
        rows::parameters(plan, &fit.values, &fit.known, LINEAR)
    }

    /// Values by the names of the unknowns.
    fn values(&self) -> Map {
        let Parts { plan, fit, .. } = &*self.0;
        let values = plan.unknowns.iter().zip(&fit.values);
        values.map(|(unknown, value)| (unknown.name.as_str().into(), Dynamic::from(*value))).collect()
    }

    /// The scenario of a test with the best values.
    fn test(&self, name: &str, session: &Session) -> HostResult<ScenarioHandle> {
        let Parts { plan, fit, .. } = &*self.0;
        let place = plan.place_of(name)?;
        plan.tests[place].study.with(plan.changes_with_breaks(place, &fit.values), session)
    }

    fn derived(&self) -> MutexGuard<'_, Derived> {
        base::lock(&self.0.derived)
    }

    /// Samples the posterior; its rows.
    pub(super) fn posterior(&self, options: &Map, session: &Session) -> HostResult<Dynamic> {
        let Parts { plan, fit, around, .. } = &*self.0;
        let options = Options { of: "posterior", map: options };
        let scattered = scattered(plan, &options)?;
        let from = Beginning::new(plan, fit, &scattered)?;
        let options = posterior_options(&from.plan, &options, &scattered)?;
        let found = Posterior::sample(&from, &options, &around.host, session)?;
        self.tell(&found.warnings)?;
        let median = found.median();
        let known =
            verdict::of_covariance(&from.plan, &median, &found.covariance(), &from.jacobian, &found.at_bounds());
        // What the linear model has said of a parameter already is not said again.
        let told: Vec<Warning> = fit::doubts(plan, &fit.known, LINEAR).collect();
        let doubts = fit::doubts(&from.plan, &known, "posterior");
        self.tell(doubts.filter(|own| !told.iter().any(|other| own.is_of_the_same(other))))?;
        self.tell(elsewhere(plan, fit, &found))?;
        let rows = rows::posterior(&found, &known);
        self.table("posterior", rows.clone())?;
        self.table("posterior_tests", rows::surrogates(&found))?;
        self.derived().posterior = Some(found);
        Ok(listed(&rows))
    }

    /// Predicts scenarios with draws of the posterior, which is sampled first where it was not.
    pub(super) fn predict(&self, scenarios: &Array, options: &Map, session: &Session) -> HostResult<Map> {
        let Parts { plan, around, .. } = &*self.0;
        // A scenario that cannot be read is known before the posterior is sampled.
        let (asked, predicted) = to_predict(scenarios, options, &around.scenarios, session)?;
        let is_sampled = self.derived().posterior.is_some();
        if !is_sampled {
            drop(self.posterior(&Map::new(), session)?);
        }
        let Some(posterior) = self.derived().posterior.clone() else { return Err(refuse("there is no posterior")) };
        let before = self.derived().predictions.len();
        for (name, study) in predicted {
            around.host.tell(&format!("{}, prediction of {name}: {} runs", plan.title(), asked.samples));
            let found = Prediction::new(&name, &study, &posterior, &asked, session)?;
            self.derived().predictions.push(found);
            // One by one: an error of the next leaves what the others took their runs for.
            self.report_predictions()?;
        }
        let derived = self.derived();
        let found = &derived.predictions[before..];
        Ok(PREDICTED.iter().map(|(name, rows)| ((*name).into(), listed(&joined(found, *rows)))).collect())
    }

    /// Tables of all predictions so far, and the findings of the last.
    fn report_predictions(&self) -> HostResult<()> {
        let derived = self.derived();
        for (name, rows) in PREDICTED {
            let rows = joined(&derived.predictions, rows);
            if !rows.is_empty() {
                self.table(&format!("predicted_{name}"), rows)?;
            }
        }
        self.tell(derived.predictions.last().into_iter().flat_map(|own| &own.warnings))
    }

    /// What each candidate would tell beside the tests.
    pub(super) fn settles(&self, given: &Array, session: &Session) -> HostResult<Dynamic> {
        let candidates::Compared { rows, advice } = candidates::compared(given, &self.with(session))?;
        self.tell(advice)?;
        let mut derived = self.derived();
        derived.candidates.extend(rows.clone());
        self.table("candidates", derived.candidates.clone())?;
        Ok(listed(&rows))
    }

    /// How well tests are predicted by fits without them.
    pub(super) fn left_out(&self, tests: Option<&Array>, session: &Session) -> HostResult<Dynamic> {
        let Parts { plan, fit, .. } = &*self.0;
        let groups = left_out::groups(tests, plan)?;
        if groups.is_empty() {
            self.tell([Warning::NothingToLeaveOut])?;
        }
        let found = left_out::searched(&groups, &self.with(session))?;
        self.tell(found.iter().flat_map(|left| left.doubts(plan)))?;
        let rows = left_out::rows(&found, plan, fit);
        let mut derived = self.derived();
        derived.left_out.extend(rows.clone());
        if !derived.left_out.is_empty() {
            self.table("left_out", derived.left_out.clone())?;
        }
        Ok(listed(&rows))
    }

    /// What the law makes of coupons at several angles.
    fn angles(&self, options: &Map, session: &Session) -> HostResult<Dynamic> {
        let asked = angles::Asked::read(&Options { of: "angles", map: options }, &self.0.plan)?;
        let found = Angles::compared(&asked, &self.with(session))?;
        self.table("angles", found.rows.clone())?;
        found.plots.into_iter().try_for_each(|plot| self.0.around.collector.plot(plot)).map_err(refuse)?;
        self.tell(&found.warnings)?;
        Ok(listed(&found.rows))
    }

    /// Plots of every test, measured and calibrated, of the posterior and of predictions.
    pub(super) fn page(&self) -> HostResult<()> {
        let Parts { plan, fit, around, .. } = &*self.0;
        let derived = self.derived();
        let pairs = derived.posterior.iter().flat_map(rows::pairs);
        let bands = derived.predictions.iter().flat_map(|own| own.bands.clone());
        let breaking = rows::breaking(plan, fit);
        let mut all = rows::plots(plan, fit).into_iter().chain(breaking).chain(bands).chain(pairs);
        all.try_for_each(|plot| around.collector.plot(plot)).map_err(refuse)
    }
}

/// The parameters that scatter over specimens, of `hierarchy`.
fn scattered(plan: &Plan, options: &Options<'_>) -> HostResult<Vec<usize>> {
    let acts_on_two = |index: usize| plan.with_parameter(index).count() > 1;
    // What some tests have of their own beside others that share it differs for a reason of its own.
    let is_one = |index: &usize| {
        let is_owner = |test: &&Test| test.own.contains(&plan.parameters[*index].name);
        let owners = plan.with_parameter(*index).filter(is_owner).count();
        owners == 0 || owners == plan.with_parameter(*index).count()
    };
    let given = options.map.get("hierarchy");
    let names = match given.map(|given| (given, given.as_bool())) {
        None | Some((_, Ok(false))) => return Ok(Vec::new()),
        Some((_, Ok(true))) => {
            let of_keys = |index: &usize| plan.parameters[*index].role == Role::Key && acts_on_two(*index);
            let found: Vec<usize> = (0..plan.parameters.len()).filter(of_keys).filter(is_one).collect();
            return match found.is_empty() {
                true => Err(refuse_key("hierarchy", "`hierarchy: true`: no parameter acts on two tests", None)),
                false => Ok(found),
            };
        }
        Some((given, Err(_))) => texts(given, "hierarchy")?,
    };
    let of_name = |name: &String| {
        let index = plan.parameters.iter().position(|own| own.name == *name).filter(|index| acts_on_two(*index));
        let index = index.ok_or_else(|| refuse!("`hierarchy` names `{name}`, which acts on no two tests"))?;
        if plan.parameters[index].role != Role::Key {
            return Err(refuse!("`hierarchy` names `{name}`: give that its `scatter`"));
        }
        Ok(index)
    };
    names.iter().map(of_name).collect()
}

/// `#{ scatter, runs, rounds, steps, seed }`, and what scatters over specimens.
fn posterior_options(plan: &Plan, options: &Options<'_>, scattered: &[usize]) -> HostResult<PosteriorOptions> {
    options.check(&file::options_at("posterior"))?;
    let scatter = options.optional_number("scatter")?;
    if scatter.is_some_and(|scatter| !(scatter > 0.0 && scatter.is_finite())) {
        return Err(refuse("`scatter` is the standard deviation over specimens that is expected at most, above zero"));
    }
    if scatter.is_some() && scattered.is_empty() {
        return Err(refuse_key("scatter", "`scatter` has no effect without `hierarchy`", None));
    }
    let of_unknown = |(index, unknown): (usize, &Unknown)| {
        let parameter = plan.parameter_of(unknown);
        let [low, high] = parameter.ends();
        // Assumed: 30 % of a value, or a tenth of the bounds.
        let usual = if parameter.is_logarithmic { 0.3 } else { 0.1 * (high - low) };
        scattered.contains(&unknown.parameter).then(|| (index, scatter.unwrap_or(usual)))
    };
    Ok(PosteriorOptions {
        runs: options.whole("runs", 0, 0..=100_000)?,
        rounds: options.whole("rounds", 4, 1..=20)?,
        steps: options.whole("steps", 8000, 100..=100_000)?,
        seed: options.whole("seed", 1, plan::SEEDS)? as u64,
        scattered: plan.unknowns.iter().enumerate().filter_map(of_unknown).collect(),
    })
}

/// Scenarios to predict, each itself, its path or `#{ scenario, name, set }`, with their names, and what is asked of
/// their runs.
pub(super) fn to_predict(
    given: &Array,
    options: &Map,
    scenarios: &Scenarios,
    session: &Session,
) -> HostResult<(Asked, Vec<(String, ScenarioHandle)>)> {
    let asked = asked(&Options { of: "predict", map: options })?;
    let one = |given: &Dynamic| -> HostResult<(String, ScenarioHandle)> {
        let map = given.read_lock::<Map>();
        let study = match &map {
            None => scenarios.named(given, session)?,
            Some(map) => {
                let options = Options::new("a scenario of predict", map, &["scenario", "name", "set"])?;
                scenarios.changed(&options, "`set`", session)?
            }
        };
        asked.check_names(&study)?;
        let name = map.as_ref().and_then(|map| map.get("name"));
        Ok((name.map_or_else(|| study.name().to_owned(), Dynamic::to_string), study))
    };
    let predicted = given.iter().map(one).collect::<HostResult<_>>()?;
    Ok((asked, predicted))
}

/// `#{ samples, figures, signals, above, errors, seed }`.
fn asked(options: &Options<'_>) -> HostResult<Asked> {
    options.check(&file::predict_options())?;
    let numbers = |name: &str, example: &str| -> HostResult<Vec<(String, f64)>> {
        let Some(given) = options.map.get(name) else { return Ok(Vec::new()) };
        let map = given.read_lock::<Map>().map(|map| map.clone());
        let map = map.ok_or_else(|| refuse!("`{name}` is a map of figures, such as #{{ {example} }}"))?;
        map.iter().map(|(figure, value)| Ok((figure.to_string(), number(value, figure)?))).collect()
    };
    let above = numbers("above", "hic15: 700")?;
    let errors = numbers("errors", "hic15: 0.1")?;
    if let Some((figure, error)) = errors.iter().find(|(_, error)| !(*error > 0.0 && error.is_finite())) {
        return Err(refuse!("`errors`: {figure} has {error}, a relative standard deviation is above zero"));
    }
    let figures = options.texts("figures")?;
    let is_asked = |figure: &String| {
        figures.is_empty() || figures.contains(figure) || above.iter().any(|(above, _)| above == figure)
    };
    if let Some((figure, _)) = errors.iter().find(|(figure, _)| !is_asked(figure)) {
        let text = format!("`errors` has `{figure}`, which is in neither `figures` nor `above`");
        return Err(refuse_key(figure, &text, None));
    }
    // The names of signals are known before the posterior is sampled, and what they stand for.
    let signals = options.texts("signals")?;
    let signals = signals.iter().map(|name| Ok(recorded_test::found_column(name).map_err(refuse)?.short.to_owned()));
    Ok(Asked {
        samples: options.whole("samples", 64, 2..=100_000)?,
        figures,
        signals: signals.collect::<HostResult<_>>()?,
        above,
        errors: errors.into_iter().collect(),
        seed: options.whole("seed", 1, plan::SEEDS)? as u64,
    })
}

/// The findings of parameters whose best values lie outside of the posterior.
fn elsewhere(plan: &Plan, fit: &Fit, posterior: &Posterior) -> Vec<Warning> {
    let found = |(index, unknown): (usize, &Unknown)| {
        // Of what each test has of its own but scatters in the posterior, there is no one best value.
        let place = posterior.plan.unknowns.iter().position(|own| own == unknown)?;
        let samples: Vec<f64> = posterior.unknowns().map(|x| plan.parameter_of(unknown).value(x[place])).collect();
        let [low, high] = quantiles(&samples, &[0.025, 0.975]).map(|ends| [ends[0], ends[1]])?;
        let value = fit.values[index];
        let (parameter, unit) = (unknown.name.clone(), plan.parameter_of(unknown).unit.clone().unwrap_or_default());
        (!(low..=high).contains(&value)).then_some(Warning::PosteriorElsewhere { parameter, value, low, high, unit })
    };
    plan.unknowns.iter().enumerate().filter_map(found).collect()
}

/// What predictions have, by the names of their tables.
const PREDICTED: [(&str, RowsOf); 3] =
    [("figures", |own| &own.figures), ("probabilities", |own| &own.probabilities), ("within_band", |own| &own.covered)];

/// The rows of one of the tables of a prediction.
type RowsOf = fn(&Prediction) -> &Vec<Row>;

/// The rows of several predictions.
fn joined(predictions: &[Prediction], rows: RowsOf) -> Vec<Row> {
    predictions.iter().flat_map(|own| rows(own).clone()).collect()
}

/// Rows as a list of maps.
fn listed(rows: &[Row]) -> Dynamic {
    from_json(&Value::Array(rows.iter().cloned().map(Value::Object).collect()))
}
