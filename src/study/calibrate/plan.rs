//! A calibration as a script writes it: tests, parameters, what signals may differ by, and the stages of the search.

use std::ops::RangeInclusive;

use rhai::{Array, Dynamic, Map};

use super::error_model::{Correlation, Noise, Shape};
use super::file;
use super::mesh::{self, Elements};
use super::outcome::{Breaks, Outcomes, USUAL_SCATTER};
use super::parameter::{self, Parameter, Role, Unknown};
use super::recorded_test::{self, Signal, Test, Tolerances};
use crate::identify::{Bounds, Method, Search, Starts};
use crate::scenario_functions::{Changes, ScenarioHandle, Scenarios, changes_of};
use crate::script::{HostResult, Options, Session, at_key, cause, number, refuse, refuse_key, refused_key};
use base::units::Time;
use lab::signal::Series;
use uncertainty::design::{self, Levels};

/// Share of the model's error with which a search begins that estimates it: the error of the study's own curves.
const FIRST_SHARE: f64 = 0.03;

/// Points of which the best are starts, for each unknown.
const SCREENED: usize = 6;

/// Median and deviation of the logarithm of the model's error before the tests, as a share of a signal (assumed): 0.3 to
/// 15 % with 95 %.
pub(super) const SHARE_BEFORE: [f64; 2] = [0.02, 1.0];
/// Seeds that scripts may give.
pub(super) const SEEDS: RangeInclusive<usize> = 0..=1_000_000_000;

/// A checked calibration.
#[derive(Clone)]
pub(super) struct Plan {
    /// Words before the names of its tables; none where it is the only one.
    pub(super) name: Option<String>,
    pub(super) tests: Vec<Test>,
    pub(super) parameters: Vec<Parameter>,
    pub(super) unknowns: Vec<Unknown>,
    pub(super) discrepancy: Discrepancy,
    /// Length over which the model's error is correlated; none where that is not known.
    pub(super) correlation: Option<Correlation>,
    /// Scenarios of the tests in the stages before the last, coarser as a rule.
    pub(super) stages: Vec<Vec<Stage>>,
    /// Method, tolerances and limits of its searches.
    pub(super) search: Search,
    /// Starts of the first of them.
    pub(super) starts: usize,
    /// Relative half width of an interval of 95 % up to which a parameter counts as determined.
    pub(super) precision: f64,
    /// Whether a run in which film breaks has a value.
    pub(super) keeps_ruptured: bool,
    /// Whether simulated signals are corrected for their elements, and what these are off by.
    pub(super) elements: Elements,
    pub(super) mesh: mesh::Known,
    /// Whether all recordings are virtual.
    pub(super) is_virtual: bool,
}

/// The break strains of a test: what is known of them, and the unknowns that say the rest.
#[derive(Clone, Debug)]
pub(super) struct BreakUnknowns {
    known: Breaks,
    unknown: Vec<(Role, usize)>,
}

impl BreakUnknowns {
    /// With these values of all unknowns.
    pub(super) fn with_values(&self, values: &[f64]) -> Breaks {
        let mut breaks = self.known;
        for (role, index) in &self.unknown {
            let (of, value, along) = match role {
                Role::Key => continue,
                Role::Break(along) => (&mut breaks.log_factors, values[*index].ln(), along),
                Role::Scatter(along) => (&mut breaks.scatter, values[*index], along),
            };
            (0..2).filter(|place| along[*place]).for_each(|place| of[place] = value);
        }
        breaks
    }
}

/// What is run of a test in a stage: the scenario of its signals, and its outcomes.
#[derive(Clone)]
pub(super) struct Stage {
    pub(super) study: ScenarioHandle,
    pub(super) outcomes: Option<Outcomes>,
}

/// The error of the model, as a share of the root mean square of each signal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Discrepancy {
    /// Of this size.
    Given(f64),
    /// Estimated from what is left.
    Estimated,
}

impl Plan {
    /// Reads the map of `calibrate`.
    pub(super) fn read(given: &Map, scenarios: &Scenarios, session: &Session) -> HostResult<Plan> {
        let options = Options::new("calibrate", given, &file::options())?;
        let (discrepancy, correlation) =
            discrepancy(given.get("discrepancy")).map_err(|text| refuse_key("discrepancy", &text, None))?;
        let noise = given.get("noise").map_or(Ok(Noise::FromRecording), recorded_test::noise)?;
        let tolerances = Tolerances { noise, correlation };
        let tests = tests(&options, scenarios, tolerances, session)?;
        let parameters = parameters(&options, &tests)?;
        let unknowns = unknowns(&tests, &parameters)?;
        let (search, starts) = search(&options)?;
        let precision = options.number("precision", 0.2)?;
        if !(precision > 0.0 && precision.is_finite()) {
            let text = format!("`precision` must be a relative half width above zero, such as 0.2, not {precision}");
            return Err(refuse_key("precision", &text, None));
        }
        let keeps_ruptured = options.word("on_rupture", &[("fail", false), ("keep", true)])?.unwrap_or(false);
        let known = [("corrected", Elements::Corrected), ("exact", Elements::Exact)];
        let elements = options.word("mesh", &known)?.unwrap_or(Elements::Corrected);
        let name = given.get("name").map(Dynamic::to_string);
        let mut plan = Plan {
            name,
            tests,
            parameters,
            unknowns,
            discrepancy,
            correlation,
            stages: Vec::new(),
            search,
            starts,
            precision,
            keeps_ruptured,
            elements,
            mesh: mesh::Known::default(),
            is_virtual: session.is_all_virtual(),
        };
        plan.check_start(session)?;
        plan.stages = stages(given.get("stages"), &plan.tests, session).map_err(|error| at_key("stages", *error))?;
        Ok(plan)
    }

    /// A key that the scenario of a test does not have, or a value that it refuses, is found before the search.
    fn check_start(&self, session: &Session) -> HostResult<()> {
        let start = self.start();
        for place in 0..self.tests.len() {
            let own = &self.tests[place];
            own.study.with(self.changes(place, &start), session).map_err(|error| {
                let takes = |other: &Test, at| other.study.with(self.changes(at, &start), session).is_ok();
                // What every test refuses is wrong in itself.
                let hint = match self.tests.iter().enumerate().any(|(at, other)| at != place && takes(other, at)) {
                    true => " (a parameter that only some tests have names them: `tests: [\"…\"]`)",
                    false => "",
                };
                let wrong = refuse!("test `{}` at the start: {}{hint}", own.name, cause(&error));
                let key = refused_key(&error);
                let has = |parameter: &&Parameter| key.as_ref().is_some_and(|key| parameter.has(key));
                match self.parameters.iter().find(has) {
                    Some(parameter) => at_key(&parameter.name, *wrong),
                    None => wrong,
                }
            })?;
        }
        Ok(())
    }

    /// The index of the test of this name.
    pub(super) fn place_of(&self, name: &str) -> HostResult<usize> {
        let known = || self.tests.iter().map(|test| test.name.as_str()).collect::<Vec<_>>().join(", ");
        let place = self.tests.iter().position(|test| test.name == name);
        place.ok_or_else(|| refuse!("there is no test `{name}`; there are {}", known()))
    }

    /// The values at which the search starts.
    pub(super) fn start(&self) -> Vec<f64> {
        self.unknowns.iter().map(|unknown| self.parameter_of(unknown).start).collect()
    }

    /// The tests as they are.
    pub(super) fn last_stage(&self) -> Vec<Stage> {
        let of_test = |test: &Test| Stage { study: test.study.clone(), outcomes: test.outcomes.clone() };
        self.tests.iter().map(of_test).collect()
    }

    /// The parameter that an unknown is.
    pub(super) fn parameter_of(&self, unknown: &Unknown) -> &Parameter {
        &self.parameters[unknown.parameter]
    }

    /// The parameter that the unknown of this index is.
    pub(super) fn parameter_at(&self, index: usize) -> &Parameter {
        self.parameter_of(&self.unknowns[index])
    }

    /// Coordinates of the unknowns with these values.
    pub(super) fn coordinates(&self, values: &[f64]) -> Vec<f64> {
        self.unknowns.iter().zip(values).map(|(unknown, value)| self.parameter_of(unknown).coordinate(*value)).collect()
    }

    /// Values of the unknowns at these coordinates.
    pub(super) fn values(&self, x: &[f64]) -> Vec<f64> {
        self.unknowns.iter().zip(x).map(|(unknown, coordinate)| self.parameter_of(unknown).value(*coordinate)).collect()
    }

    /// Indices of the unknowns that act on the runs of a test.
    pub(super) fn acting_on(&self, test: usize) -> Vec<usize> {
        self.of_test(test).filter(|index| self.parameter_at(*index).role == Role::Key).collect()
    }

    /// Indices of the unknowns of a test, those of its outcomes included.
    fn of_test(&self, test: usize) -> impl Iterator<Item = usize> + '_ {
        let is_of = move |unknown: &Unknown| {
            unknown.test.map_or_else(|| self.is_shared(unknown.parameter, test), |own| own == test)
        };
        (0..self.unknowns.len()).filter(move |index| is_of(&self.unknowns[*index]))
    }

    /// Whether signals are compared along their length, which the model's error is of.
    pub(super) fn has_residuals(&self) -> bool {
        self.tests.iter().flat_map(|test| &test.signals).any(|signal| signal.distance.is_residuals())
    }

    /// Whether the model's error is estimated.
    pub(super) fn estimates_share(&self) -> bool {
        self.discrepancy == Discrepancy::Estimated && self.has_residuals()
    }

    /// The model's error with which a search begins, which it keeps where it is not estimated; none of numbers that are no
    /// differences along a signal.
    pub(super) fn first_share(&self) -> f64 {
        match self.discrepancy {
            Discrepancy::Given(share) => share,
            Discrepancy::Estimated if self.estimates_share() => FIRST_SHARE,
            Discrepancy::Estimated => 0.0,
        }
    }

    /// The shapes that the model's error of a test may have: one where there is no error, or the test's numbers are no differences
    /// along a signal.
    pub(super) fn shapes(&self, test: usize) -> Vec<Shape> {
        let own = &self.tests[test];
        let mut shapes = own.shapes(self.correlation);
        let has_error = self.first_share() > 0.0 && own.signals.iter().any(|signal| signal.distance.is_residuals());
        shapes.truncate(if has_error { shapes.len() } else { 1 });
        shapes
    }

    /// The model's error of a signal of which no test tells: what is given, or its median before the tests.
    pub(super) fn share_before(&self) -> f64 {
        match self.discrepancy {
            Discrepancy::Given(share) => share,
            Discrepancy::Estimated => SHARE_BEFORE[0],
        }
    }

    /// The unknowns on which the outcomes of a test depend beside its runs.
    pub(super) fn break_unknowns(&self, test: usize) -> BreakUnknowns {
        let factors = self.tests[test].outcomes.as_ref().map_or([1.0; 2], |own| own.factors);
        self.breaks_by(self.of_test(test), |parameter| is_of(&self.parameters[parameter], &self.tests[test]), factors)
    }

    /// Whether any test tells of break strains.
    pub(super) fn has_outcomes(&self) -> bool {
        self.tests.iter().any(|test| test.outcomes.is_some())
    }

    /// The break strains of film that is in no test, so many times those of its curves where the tests say nothing else, or not the
    /// same.
    pub(super) fn shared_breaks(&self, factors: [f64; 2]) -> BreakUnknowns {
        let acts = |parameter: usize| self.rivals(parameter).next().is_none();
        let is_shared = |unknown: &Unknown| unknown.test.is_none() && acts(unknown.parameter);
        self.breaks_by((0..self.unknowns.len()).filter(|index| is_shared(&self.unknowns[*index])), acts, factors)
    }

    /// The break strains of film on which these unknowns act, and parameters by their indices.
    fn breaks_by(
        &self,
        unknowns: impl Iterator<Item = usize>,
        acts: impl Fn(usize) -> bool,
        factors: [f64; 2],
    ) -> BreakUnknowns {
        let mut known = Breaks { log_factors: factors.map(f64::ln), scatter: [USUAL_SCATTER; 2] };
        let mut unknown = Vec::new();
        for index in unknowns {
            let parameter = self.parameter_at(index);
            if parameter.role != Role::Key {
                unknown.push((parameter.role, index));
            }
        }
        // Also of break strains that each test has of its own: how much specimens scatter is given for all of them.
        for (_, parameter) in self.parameters.iter().enumerate().filter(|(index, _)| acts(*index)) {
            if let (Role::Break(along), Some([low, high])) = (parameter.role, parameter.scatter)
                && low == high
            {
                (0..2).filter(|place| along[*place]).for_each(|place| known.scatter[place] = low);
            }
        }
        BreakUnknowns { known, unknown }
    }

    /// Indices of the tests that have the value of a parameter that all share.
    pub(super) fn sharing(&self, parameter: usize) -> impl Iterator<Item = usize> + '_ {
        (0..self.tests.len()).filter(move |test| self.is_shared(parameter, *test))
    }

    /// Whether a test has the value of a parameter that all share.
    fn is_shared(&self, parameter: usize, test: usize) -> bool {
        is_of(&self.parameters[parameter], &self.tests[test])
            && !self.tests[test].own.contains(&self.parameters[parameter].name)
    }

    /// The changes of the scenario of a test with these values.
    pub(super) fn changes(&self, test: usize, values: &[f64]) -> Changes {
        let acting = self.acting_on(test).into_iter();
        parameter::changes(acting.map(|index| (self.parameter_at(index), values[index])))
    }

    /// The parameters that a scenario which is no test takes: those that all tests have, and of the others those whose
    /// keys it has, and no other parameter too.
    pub(super) fn taken_by(&self, study: &ScenarioHandle, session: &Session) -> Vec<usize> {
        let start = self.start();
        let takes = |index: &usize| {
            let parameter = &self.parameters[*index];
            let at = self.unknowns.iter().position(|own| own.parameter == *index && own.test.is_none());
            let Some(at) = at else { return false };
            let changes = parameter::changes(std::iter::once((parameter, start[at])));
            // Not every film has the break strains that outcomes tell of.
            let is_of_all = parameter.tests.is_empty() && parameter.role == Role::Key;
            is_of_all || self.rivals(*index).next().is_none() && study.with(changes, session).is_ok()
        };
        (0..self.parameters.len()).filter(takes).collect()
    }

    /// The other parameters that write one of the keys of a parameter, to other tests.
    pub(super) fn rivals(&self, parameter: usize) -> impl Iterator<Item = &Parameter> {
        let own = &self.parameters[parameter];
        self.parameters.iter().filter(move |other| *other != own && own.shares_a_key(other))
    }

    /// The changes of the scenario of a test with these values, break strains included, which its runs do not depend on in a
    /// search.
    pub(super) fn changes_with_breaks(&self, test: usize, values: &[f64]) -> Changes {
        let own = self.of_test(test).map(|index| (self.parameter_at(index), values[index]));
        parameter::changes(own)
    }

    /// Whether a recording is uncertain in its contact.
    pub(super) fn has_contact_errors(&self) -> bool {
        let of = |signal: &Signal| signal.errors.contact_errors() != [false; 2];
        self.tests.iter().any(|test| test.signals.iter().any(of))
    }

    /// The rupture in the runs of a trial that makes it fail.
    pub(super) fn rupture_in(&self, trial: &Session) -> Option<String> {
        trial.trial().ruptures.into_iter().next().filter(|_| !self.keeps_ruptured)
    }

    /// The signals of a test by a run of a scenario, or why there are none, as where its film breaks.
    pub(super) fn simulated(
        &self,
        test: usize,
        study: &ScenarioHandle,
        session: &Session,
    ) -> Result<Vec<Series>, String> {
        let trial = session.with_trial(session.cancellation());
        let found = self.tests[test].simulated(study, &trial).map_err(|error| cause(&error));
        self.rupture_in(&trial).map_or(found, Err)
    }

    /// The tests on which an unknown acts.
    pub(super) fn tests_of(&self, unknown: &Unknown) -> Vec<usize> {
        unknown.test.map_or_else(|| self.sharing(unknown.parameter).collect(), |test| vec![test])
    }

    /// The changes of a scenario that is no test: the shared unknowns of these parameters.
    pub(super) fn shared_changes(&self, values: &[f64], taken: &[usize]) -> Changes {
        let is_shared = |unknown: &Unknown| unknown.test.is_none() && taken.contains(&unknown.parameter);
        let shared = self.unknowns.iter().zip(values).filter(|(unknown, _)| is_shared(unknown));
        parameter::changes(shared.map(|(unknown, value)| (self.parameter_of(unknown), *value)))
    }

    /// The plan in which all tests share these parameters.
    pub(super) fn without_own(&self, parameters: &[usize]) -> HostResult<Plan> {
        let is_one = |name: &String| parameters.iter().any(|index| self.parameters[*index].name == *name);
        let mut plan = self.clone();
        plan.tests.iter_mut().for_each(|test| test.own.retain(|name| !is_one(name)));
        plan.unknowns = unknowns(&plan.tests, &plan.parameters)?;
        Ok(plan)
    }

    /// The tests on which a parameter acts, whether they share it or not.
    pub(super) fn with_parameter(&self, parameter: usize) -> impl Iterator<Item = &Test> {
        self.tests.iter().filter(move |test| is_of(&self.parameters[parameter], test))
    }

    /// The search from a point.
    pub(super) fn search_from(&self, start: Vec<f64>, is_first: bool, is_last: bool) -> HostResult<Search> {
        let names: Vec<String> = self.unknowns.iter().map(|unknown| unknown.name.clone()).collect();
        let ends: Vec<[f64; 2]> = self.unknowns.iter().map(|unknown| self.parameter_of(unknown).within).collect();
        let side = |side: usize| Some(ends.iter().map(|ends| ends[side]).collect());
        let is_logarithmic = self.unknowns.iter().map(|unknown| self.parameter_of(unknown).is_logarithmic).collect();
        let bounds = Bounds::new(&names, side(0), side(1)).map_err(refuse)?.along_logarithms(is_logarithmic);
        let own = self.search.clone();
        let [tol_x, tol_f] = if is_last { [own.tol_x, own.tol_f] } else { [own.tol_x.max(1e-2), own.tol_f.max(1e-3)] };
        let starts = match is_first && self.starts > 1 {
            true => Starts::Lowest(self.starts, self.screened()?),
            false => Starts::One,
        };
        Ok(Search { names, bounds, tol_x, tol_f, starts, start, ..own })
    }

    /// Points among which starts are chosen, spread over the bounds along the coordinates.
    fn screened(&self) -> HostResult<Vec<Vec<f64>>> {
        let count = SCREENED * self.unknowns.len();
        let factors = vec![Levels::Continuous; self.unknowns.len()];
        let points =
            design::points(design::Method::LatinHypercube, &factors, count, self.search.seed).map_err(refuse)?;
        let value = |(unknown, share): (&Unknown, &f64)| {
            let [low, high] = self.parameter_of(unknown).ends();
            let [least, most] = self.parameter_of(unknown).within;
            self.parameter_of(unknown).value(low + (high - low) * share).clamp(least, most)
        };
        Ok(points.iter().map(|point| self.unknowns.iter().zip(point).map(value).collect()).collect())
    }

    /// What it is called on pages and in lines of progress.
    pub(super) fn title(&self) -> &str {
        self.name.as_deref().unwrap_or("Calibration")
    }

    /// The name of a table of the results.
    pub(super) fn table(&self, table: &str) -> String {
        self.name.as_ref().map_or_else(|| table.to_owned(), |name| format!("{name}_{table}"))
    }
}

/// The tests that are listed, each of another name.
fn tests(
    options: &Options<'_>,
    scenarios: &Scenarios,
    tolerances: Tolerances,
    session: &Session,
) -> HostResult<Vec<Test>> {
    let listed = options.value("tests")?.clone().try_cast::<Array>().filter(|list| !list.is_empty());
    let listed = listed.ok_or_else(|| refuse("`tests` of calibrate must be an array of one test or more"))?;
    let tests = listed.iter().map(|given| Test::read(given, scenarios, tolerances, session));
    let mut tests = tests.collect::<HostResult<Vec<_>>>()?;
    recorded_test::share_errors(&mut tests);
    for (place, test) in tests.iter().enumerate() {
        if tests[..place].iter().any(|other| other.name == test.name) {
            return Err(refuse!("two tests are called `{}`: give one a `name`", test.name));
        }
    }
    Ok(tests)
}

/// The parameters that are listed, with the scatter of those that are break strains.
fn parameters(options: &Options<'_>, tests: &[Test]) -> HostResult<Vec<Parameter>> {
    let map = options.value("parameters")?.clone().try_cast::<Map>().filter(|map| !map.is_empty());
    let map = map.ok_or_else(|| refuse("`parameters` of calibrate is a map of names and their `key`s"))?;
    let read = |(name, given): (&rhai::Identifier, &Dynamic)| {
        parameter::read(name, given).map_err(|error| at_key(name, *error))
    };
    let mut parameters = map.iter().map(read).collect::<HostResult<Vec<_>>>()?.concat();
    if parameters.iter().any(|own| own.point.is_some()) && tests.iter().any(|own| own.outcomes.is_some()) {
        return Err(refuse("a curve that is a parameter ends where it breaks: it cannot stand beside outcomes"));
    }
    let scatters: Vec<Parameter> = parameters.iter().filter_map(Parameter::of_scatter).collect();
    parameters.extend(scatters);
    for (place, one) in parameters.iter().enumerate() {
        let is_both = |other: &&Parameter| tests.iter().any(|test| is_of(one, test) && is_of(other, test));
        if let Some(other) = parameters[..place].iter().filter(|other| other.shares_a_key(one)).find(is_both) {
            let text = format!("parameters `{}` and `{}` write the same key of one test", other.name, one.name);
            return Err(refuse_key(&one.name, &text, None));
        }
    }
    Ok(parameters)
}

/// Whether a parameter acts on a test.
fn is_of(parameter: &Parameter, test: &Test) -> bool {
    (parameter.tests.is_empty() || parameter.tests.contains(&test.name))
        && (parameter.role == Role::Key || test.outcomes.is_some())
}

/// The unknowns: a shared one of each parameter that any test shares, and one of each test that has its own.
fn unknowns(tests: &[Test], parameters: &[Parameter]) -> HostResult<Vec<Unknown>> {
    let names = || tests.iter().map(|test| test.name.as_str());
    for parameter in parameters {
        if let Some(other) = parameter.tests.iter().find(|name| !names().any(|own| own == name.as_str())) {
            let known = names().collect::<Vec<_>>().join(", ");
            return Err(refuse!("parameter `{}` names the test `{other}`; there are {known}", parameter.name));
        }
        if !tests.iter().any(|test| is_of(parameter, test)) {
            return Err(refuse!(
                "parameter `{}` is a break strain, of which signals tell nothing: give a test its `outcome`, \
                `failure_mass` or `rupture_time`",
                parameter.name
            ));
        }
    }
    for test in tests {
        if let Some(other) = test.own.iter().find(|own| !parameters.iter().any(|parameter| parameter.name == **own)) {
            return Err(refuse!("test `{}` has its own `{other}`, which is no parameter", test.name));
        }
        let acts = |own: &str| parameters.iter().any(|parameter| parameter.name == own && is_of(parameter, test));
        if let Some(other) = test.own.iter().find(|own| !acts(own)) {
            return Err(refuse!(
                "test `{}` has its own `{other}`, which does not act on it: the `tests` of that parameter do not name it, or it \
                is a break strain and the test has no outcome",
                test.name
            ));
        }
    }
    let mut unknowns = Vec::new();
    for (index, parameter) in parameters.iter().enumerate() {
        let of = |test: &&Test| is_of(parameter, test);
        if tests.iter().filter(of).any(|test| !test.own.contains(&parameter.name)) {
            unknowns.push(Unknown { name: parameter.name.clone(), parameter: index, test: None });
        }
        for (place, test) in tests.iter().enumerate().filter(|(_, test)| of(test)) {
            if test.own.contains(&parameter.name) {
                let name = format!("{} of {}", parameter.name, test.name);
                unknowns.push(Unknown { name, parameter: index, test: Some(place) });
            }
        }
    }
    Ok(unknowns)
}

/// The scenarios of the stages before the last; the last one is the tests themselves.
fn stages(given: Option<&Dynamic>, tests: &[Test], session: &Session) -> HostResult<Vec<Vec<Stage>>> {
    let Some(given) = given else { return Ok(Vec::new()) };
    let wrong =
        || refuse("`stages` must be an array of changes, such as [#{ \"specimen.mesh.size\": \"40 mm\" }, #{}]");
    let list = given.clone().try_cast::<Array>().ok_or_else(wrong)?;
    let of_stage = |item: Dynamic| changes_of(&item.try_cast::<Map>().ok_or_else(wrong)?);
    let changes = list.into_iter().map(of_stage).collect::<HostResult<Vec<_>>>()?;
    match changes.split_last() {
        Some((last, before)) if last.is_empty() => {
            let of_test = |test: &Test, changes: &Changes| {
                let study = test.study.with(changes.clone(), session)?;
                let outcomes = test.outcomes.as_ref().map(|own| own.with(changes.clone(), session)).transpose()?;
                Ok(Stage { study, outcomes })
            };
            before.iter().map(|changes| tests.iter().map(|test| of_test(test, changes)).collect()).collect()
        }
        _ => Err(refuse("the last of `stages` is #{}: the tests as they are, whose result counts")),
    }
}

/// Method, tolerances and limits of the searches, and the starts of the first.
fn search(options: &Options<'_>) -> HostResult<(Search, usize)> {
    let whole = |name: &str, usual: usize| options.whole(name, usual, 1..=100_000);
    let method = options.word("method", &Method::NAMES)?.unwrap_or(Method::LevenbergMarquardt);
    // Several starts cost a search by differences little, and tell local minima.
    let starts = whole("starts", if method == Method::LevenbergMarquardt { 3 } else { 1 })?;
    let most = whole("max_evaluations", 800)?;
    let search = Search {
        max_evaluations: most,
        max_iterations: most,
        tol_x: options.number("tol_x", 1e-4)?,
        tol_f: options.number("tol_f", 1e-4)?,
        difference: options.number("difference", 0.01)?,
        seed: options.whole("seed", 1, SEEDS)? as u64,
        ..Search::new(method, Vec::new())
    };
    Ok((search, starts))
}

/// The model's error that an option gives: a share, a map of share and correlation, or "estimated".
fn discrepancy(given: Option<&Dynamic>) -> Result<(Discrepancy, Option<Correlation>), String> {
    let Some(given) = given else { return Ok((Discrepancy::Estimated, None)) };
    let share = |value: &Dynamic| match (value.clone().into_string(), number(value, "share")) {
        (Ok(text), _) if text == "estimated" => Ok(Discrepancy::Estimated),
        (_, Ok(share)) if (0.0..1.0).contains(&share) => Ok(Discrepancy::Given(share)),
        _ => Err(format!("the share of `discrepancy` is \"estimated\" or 0 to 1, not {value}")),
    };
    let Some(map) = given.read_lock::<Map>() else { return Ok((share(given)?, None)) };
    if let Some(other) = map.keys().find(|key| !["share", "correlation"].contains(&key.as_str())) {
        return Err(format!("`discrepancy` has no option `{other}`; it takes share, correlation"));
    }
    let size = map.get("share").map_or(Ok(Discrepancy::Estimated), share)?;
    Ok((size, map.get("correlation").map(correlation).transpose()?))
}

/// The length over which the model's error is correlated: a time, or a share of the window.
fn correlation(given: &Dynamic) -> Result<Correlation, String> {
    const OF_WINDOW: &str = "% of the window";
    let text = given.clone().into_string().map_err(|_| {
        format!("`correlation` is a time such as \"2 ms\" or a share such as \"3 {OF_WINDOW}\", not the number {given}")
    })?;
    let found = match text.strip_suffix(OF_WINDOW) {
        Some(percent) => {
            let share = percent.trim().parse::<f64>();
            Correlation::Share(share.map_err(|_| format!("correlation: expected a number before {OF_WINDOW}"))? / 100.0)
        }
        None => Correlation::Length(Time::DIMENSION.parse(&text).map_err(|error| format!("correlation: {error}"))?),
    };
    let (Correlation::Length(length) | Correlation::Share(length)) = found;
    if length > 0.0 && length.is_finite() { Ok(found) } else { Err("`correlation` must be above zero".into()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two drops: break strains along MD of each, and one of both along TD.
    fn drops() -> Plan {
        let drop = format!("scenario: \"{}/../../scenarios/drop/1508.toml\"", env!("CARGO_MANIFEST_DIR"));
        let key = |along: &str| format!("key: \"specimen.material.fabric.{along}.break_factor\", within: [0.3, 3]");
        let [md, td] = ["md", "td"].map(key);
        let text = format!(
            "#{{ tests: [#{{ {drop}, name: \"a\", outcome: \"held\" }}, #{{ {drop}, name: \"b\", outcome: \"broke\" }}],
            parameters: #{{ md_a: #{{ {md}, start: 0.7, scatter: 0.2, tests: \"a\" }},
                md_b: #{{ {md}, start: 0.5, scatter: 0.3, tests: \"b\" }}, td: #{{ {td}, start: 0.9, scatter: [0.05, 0.5] }} }} }}"
        );
        let map = rhai::Engine::new_raw().eval::<Map>(&text).unwrap();
        Plan::read(&map, &Scenarios::default(), &Session::default()).unwrap()
    }

    fn is_near(found: &Breaks, factors: [f64; 2], scatter: [f64; 2]) -> bool {
        let pairs = found.log_factors.iter().zip(factors.map(f64::ln)).chain(found.scatter.iter().zip(scatter));
        pairs.into_iter().all(|(own, expected)| (own - expected).abs() < 1e-9)
    }

    #[test]
    fn specimens_scatter_as_the_parameter_of_their_test_says() {
        let plan = drops();
        let of = |test: usize| plan.break_unknowns(test).with_values(&plan.start());
        let td = 0.025_f64.sqrt();
        assert!(is_near(&of(0), [0.7, 0.9], [0.2, td]), "{:?}", of(0));
        assert!(is_near(&of(1), [0.5, 0.9], [0.3, td]), "{:?}", of(1));
    }

    #[test]
    fn a_test_without_weight_shares_no_error() {
        let mut tests = drops().tests;
        tests.iter_mut().for_each(|test| test.shared_error = Some("tower".into()));
        recorded_test::share_errors(&mut tests);
        assert_eq!([tests[0].of_signals, tests[1].of_signals], [0.5; 2]);
        tests[0].weight = 0.0;
        recorded_test::share_errors(&mut tests);
        assert_eq!(tests[1].of_signals, 1.0);
    }

    /// Of film in no test it is not known which of the two it has; nor, where it is estimated, which of two scatters.
    #[test]
    fn a_break_strain_that_tests_disagree_on_is_not_predicted() {
        let plan = drops();
        let found = plan.shared_breaks([1.2, 1.0]).with_values(&plan.start());
        assert!(is_near(&found, [1.2, 0.9], [USUAL_SCATTER, 0.025_f64.sqrt()]), "{found:?}");
        let scattered = |name: &str, index: usize| Parameter {
            name: name.into(),
            scatter: Some([0.05, 0.5]),
            ..plan.parameters[index].clone()
        };
        let scatters = [scattered("one", 0), scattered("other", 1)].map(|own| own.of_scatter().unwrap());
        assert!(scatters[0].shares_a_key(&scatters[1]));
    }
}
