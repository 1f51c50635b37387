//! The search of a calibration: stage by stage, again with the model's error that it leaves, and linearized at its end.

use std::time::{Duration, Instant};

use nalgebra::DMatrix;
use serde_json::Value;

use super::error_model::{Correlation, Left, Shape, likelier, most_likely};
use super::mesh;
use super::objective::CalibrationObjective;
use super::plan::Plan;
use super::recorded_test::Test;
use super::verdict::{self, Knowledge, Verdict};
use super::warning::Warning;
use crate::identify::{
    self, HostSearch, Labels, Method, Phase, Search, SearchError, SearchHost, SearchResult, SignalLabel, failure,
    weigh_at_start,
};
use crate::post::{VIRTUAL_REFERENCE, left_open};
use crate::script::{HostResult, Session, cause, check_stop, refuse, run_all};
use base::finding::Finding;
use base::group;
use base::number::wall_time;
use lab::signal::Series;
use scene::simulate::COARSE_CONTACT;

/// Least error of the model in the searches that lead to the neighbourhood of the minimum.
const LEAST_SMOOTH: f64 = 0.01;
/// Searches with the noise and the model's error that the last one leaves, at most.
const ROUNDS: usize = 3;
/// About how many runs of each test a search takes for each unknown, at least and at most, with its starts and the searches after
/// the first.
const RUNS_OF_A_SEARCH: [usize; 2] = [40, 100];
/// Logarithm of a likelihood over another from which on it counts as larger.
const LIKELIER: f64 = 2.0;
/// Change of their logarithms below which the search is not repeated.
const SAME: f64 = 0.15;

/// What the verdicts at the end of a search rest on.
pub(super) const LINEAR: &str = "linear model at the best point";

/// The result of a search and what it tells.
#[derive(Clone)]
pub(super) struct Fit {
    /// The last search.
    pub(super) result: SearchResult,
    /// Iterations of the best start of each search, together.
    pub(super) iterations: usize,
    /// Evaluations of the objective by all searches, a run or more of every test each; the runs before the first search, between
    /// two and for the slopes at the end are not among them.
    pub(super) evaluations: usize,
    /// The best values.
    pub(super) values: Vec<f64>,
    /// Their coordinates.
    pub(super) x: Vec<f64>,
    /// The model's error, as a share of each signal.
    pub(super) share: f64,
    /// Derivatives of the residuals by the coordinates.
    pub(super) jacobian: DMatrix<f64>,
    pub(super) known: Vec<Knowledge>,
    /// Simulated signals of every test at the best point.
    pub(super) simulated: Vec<Vec<Series>>,
    /// What every test demands of its film there.
    pub(super) demands: Vec<Vec<f64>>,
    pub(super) findings: Vec<Finding>,
}

impl Fit {
    /// Searches for the parameters of a plan.
    ///
    /// The roughness of the simulated signals, at the start and after each search, becomes noise of the plan's signals.
    pub(super) fn search(plan: &mut Plan, host: &SearchHost, session: &Session) -> HostResult<Fit> {
        let mut so_far = SoFar::default();
        let values = stage_by_stage(plan, host, session, &mut so_far)?;
        let (result, simulated, share) = with_what_is_left(plan, values, host, session, &mut so_far)?;
        let values = result.best.x.clone();
        let SoFar { mut findings, phases, iterations, evaluations } = so_far;
        // It begins where another search ended: at a bound, if that did.
        let own = result.warnings.iter().filter(|own| !matches!(own, identify::Warning::StartOnBound { .. }));
        findings.extend(own.map(Finding::new));
        findings.extend(of_errors(plan, &simulated, share)?.iter().map(Finding::new));
        findings.extend(over_travel(plan).map(|warning| Finding::new(&warning)));
        let search = plan.search_from(values.clone(), false, true)?;
        let jacobian = slopes(plan, &search, share, host, session, phases)?;
        let at_bounds = search.bounds.active(&values);
        let x = plan.coordinates(&values);
        let runs = of_runs(plan, &values, session)?;
        plan.mesh = mesh::Known::new(plan, &jacobian, share, coarse(plan, &runs));
        let known = verdict::linear(plan, &x, &jacobian, &at_bounds);
        let objective = CalibrationObjective::new(plan, share, session);
        let trial = session.with_trial(session.cancellation());
        let demands = of_tests(plan, session, |test| match plan.tests[test].outcomes {
            Some(_) => Ok(objective.simulated(test, &values, &trial)?.1),
            None => Ok(Vec::new()),
        })?;
        findings.extend(doubts(plan, &known, LINEAR).map(|warning| Finding::new(&warning)));
        findings.extend(runs.iter().map(Finding::new));
        Ok(Fit { result, iterations, evaluations, values, x, share, jacobian, known, simulated, demands, findings })
    }
}

/// Searches without the correlation of the model's error, from the start of the plan: the best point.
fn stage_by_stage(plan: &mut Plan, host: &SearchHost, session: &Session, so_far: &mut SoFar) -> HostResult<Vec<f64>> {
    let mut values = plan.start();
    let counts = |plan: &Plan| plan.tests.first().map_or([0; 2], |test| test.study.counts());
    let (begin, before) = (Instant::now(), counts(plan));
    let simulated = simulated_at(plan, &values, session)?;
    host.tell(&beforehand(plan, is_timed(before, counts(plan)).then(|| begin.elapsed())));
    set_simulated(plan, &simulated);
    so_far.add_findings(&add_contacts(plan, &simulated, &values, session)?);
    let stages: Vec<_> = plan.stages.clone().into_iter().chain([plan.last_stage()]).collect();
    // Coarse searches from all starts, stage by stage, then one to the minimum: in a curved valley a coarse tolerance
    // ends far from it.
    for number in 0..=stages.len() {
        let stage = &stages[number.min(stages.len() - 1)];
        if number > 0 && plan.has_contact_errors() {
            let simulated = simulated_at(plan, &values, session)?;
            so_far.add_findings(&add_contacts(plan, &simulated, &values, session)?);
        }
        let smooth = CalibrationObjective::new(plan, plan.first_share().max(LEAST_SMOOTH), session);
        let objective = CalibrationObjective { stage: stage.clone(), is_plain: true, ..smooth };
        let is_last = number == stages.len();
        let name = if is_last {
            "differences without correlation".into()
        } else {
            format!("stage {} of {}", number + 1, stages.len())
        };
        let labels = so_far.labels(plan, name);
        let found = searched(plan, host, &objective, values, [number == 0, is_last], &labels)?;
        so_far.add(&found);
        // The start that was given counts, and where the last search ends; the coarse ones only lead there.
        let of_bounds = |own: &&identify::Warning| match own {
            identify::Warning::OnBound { .. } => true,
            identify::Warning::StartOnBound { .. } => number > 0,
            _ => false,
        };
        let others = found.warnings.iter().filter(|own| !of_bounds(own));
        so_far.findings.extend(others.map(Finding::new));
        values = found.best.x;
    }
    Ok(values)
}

/// Whether the time of runs says how long others take, by how many were taken and computed before and after them: that
/// of runs which a former study left does not.
fn is_timed(before: [usize; 2], after: [usize; 2]) -> bool {
    after[1] > before[1] || after[0] == before[0]
}

/// What is ahead: runs, and how long they take by the time of the first run of all tests, where that is known.
fn beforehand(plan: &Plan, first: Option<Duration>) -> String {
    let (tests, unknowns, cores) = (plan.tests.len(), plan.unknowns.len(), rayon::current_num_threads());
    // All tests at once may leave cores idle; the runs of a search do not. Stages on larger elements cost little.
    let each = first.unwrap_or_default().as_secs_f64() * tests.min(cores) as f64 / cores as f64;
    let cheap = if plan.stages.is_empty() { 1.0 } else { 0.5 };
    let some = |[least, most]: [usize; 2], share: f64| {
        let (shortest, longest) = (each * share * least as f64, each * most as f64);
        let time = match shortest {
            ..1.0 => String::new(),
            _ => format!(" ({} to {})", wall_time(shortest), wall_time(longest)),
        };
        format!("some {least} to {most} runs of each test{time}")
    };
    let search = some(RUNS_OF_A_SEARCH.map(|runs| runs * unknowns), cheap);
    // A first round and its check, and what up to six more add.
    let posterior = some([16 * (unknowns + 1), 40 * (unknowns + 1)], 1.0);
    format!("{}: {unknowns} unknowns; the search takes {search}, a posterior {posterior}", plan.title())
}

/// Searches with the noise and the model's error that the last search leaves, until both stay: the last search, the signals at its
/// best point, and the model's error.
fn with_what_is_left(
    plan: &mut Plan,
    mut values: Vec<f64>,
    host: &SearchHost,
    session: &Session,
    so_far: &mut SoFar,
) -> HostResult<(SearchResult, Vec<Vec<Series>>, f64)> {
    let mut rounds = 0;
    let mut simulated = simulated_at(plan, &values, session)?;
    set_simulated(plan, &simulated);
    so_far.add_findings(&add_contacts(plan, &simulated, &values, session)?);
    so_far.add_findings(&mesh::add(plan, &simulated, &values, session)?.warnings);
    let mut share = estimated(plan, &simulated)?;
    loop {
        let objective = CalibrationObjective::new(plan, share, session);
        let labels = so_far.labels(plan, format!("weighted by noise and model error, {}", rounds + 1));
        let found = searched(plan, host, &objective, values, [false, true], &labels)?;
        so_far.add(&found);
        values = found.best.x.clone();
        rounds += 1;
        let before = noises(plan);
        simulated = simulated_at(plan, &values, session)?;
        set_simulated(plan, &simulated);
        so_far.add_findings(&add_contacts(plan, &simulated, &values, session)?);
        let of_mesh = mesh::add(plan, &simulated, &values, session)?;
        so_far.add_findings(&of_mesh.warnings);
        let changes = noises(plan).into_iter().zip(before).map(|(now, before)| (now / before).ln().abs());
        let then = estimated(plan, &simulated)?;
        // A correction for the elements that moves by the noise is another fit.
        let change = changes.fold((then.max(1e-4) / share.max(1e-4)).ln().abs(), f64::max).max(SAME * of_mesh.change);
        share = then;
        if change < SAME {
            return Ok((found, simulated, share));
        }
        if rounds == ROUNDS {
            so_far.findings.push(Finding::new(&Warning::ErrorsNotSettled { change: change.exp_m1(), rounds }));
            return Ok((found, simulated, share));
        }
    }
}

/// The model's error that these simulated signals leave, where it is estimated; its shape becomes that of the signals, of a
/// test where another is likelier by far than the one that they have. None is all along a signal, so that the fit meets signals all
/// along: only a posterior weighs one error against another.
fn estimated(plan: &mut Plan, simulated: &[Vec<Series>]) -> HostResult<f64> {
    if !plan.has_residuals() {
        return Ok(plan.first_share());
    }
    let short = |test| plan.shapes(test).into_iter().filter(|shape| !shape.is_long()).collect();
    let shapes: Vec<Vec<Shape>> = (0..plan.tests.len()).map(short).collect();
    let given = (!plan.estimates_share()).then(|| plan.first_share());
    let (share, found) = most_likely(&left(plan, simulated, &shapes)?, given);
    for (test, found) in plan.tests.iter_mut().zip(found) {
        if found.log - found.of_present > LIKELIER {
            test.signals.iter_mut().for_each(|signal| signal.errors.set_shape(found.shape));
        }
    }
    Ok(share)
}

/// What is said of the model's error: its estimate, and where another length than the one that is given is likelier.
fn of_errors(plan: &Plan, simulated: &[Vec<Series>], share: f64) -> HostResult<Vec<Warning>> {
    let along = |test: &&Test| test.signals.iter().any(|own| own.distance.is_residuals());
    let mut found = Vec::new();
    if plan.estimates_share() {
        let shapes = plan.tests.iter().filter(along).map(|test| test.signals[0].errors.shape().to_string());
        let shapes = group::unique(shapes);
        found.push(Warning::ModelError { share, correlation: shapes.join("; ") });
    }
    if plan.correlation.is_some() {
        let given: Vec<Vec<Shape>> = plan.tests.iter().map(|test| test.shapes(plan.correlation)).collect();
        let others = likelier(&left(plan, simulated, &given)?);
        for (test, (shape, gain)) in plan.tests.iter().zip(others).filter(|(test, _)| along(test)) {
            if gain > LIKELIER {
                found.push(Warning::ModelErrorShape { test: test.name.clone(), shape: shape.to_string(), gain });
            }
        }
    }
    Ok(found)
}

/// Derivatives of the residuals by the coordinates, where a search begins.
fn slopes(
    plan: &Plan,
    search: &Search,
    share: f64,
    host: &SearchHost,
    session: &Session,
    phase: usize,
) -> HostResult<DMatrix<f64>> {
    let objective = CalibrationObjective::new(plan, share, session);
    let labels = Labels { phase: Some(Phase { number: phase, name: "slopes at its end".into() }), ..labels(plan) };
    let own = [HostSearch { function: "calibrate", search, labels: &labels, objective: &objective }];
    let found = host.run(session, &own, |evaluator, _| weigh_at_start(search, evaluator))?;
    let found = found.map_err(|(_, error)| ended(session, &error))?.remove(0);
    let mut jacobian = found.jacobian;
    for (index, unknown) in plan.unknowns.iter().enumerate() {
        jacobian.column_mut(index).scale_mut(plan.parameter_of(unknown).slope(search.start[index]));
    }
    Ok(jacobian)
}

/// What the searches of a calibration came to so far.
#[derive(Default)]
struct SoFar {
    /// Searches, which are the phases of one on its page.
    phases: usize,
    iterations: usize,
    evaluations: usize,
    findings: Vec<Finding>,
}

impl SoFar {
    /// The labels of the next search.
    fn labels(&mut self, plan: &Plan, name: String) -> Labels {
        let phase = Phase { number: self.phases, name };
        self.phases += 1;
        Labels { phase: Some(phase), ..labels(plan) }
    }

    /// Each finding once.
    fn add_findings(&mut self, warnings: &[Warning]) {
        for own in warnings.iter().map(Finding::new) {
            if !self.findings.iter().any(|known| known.message == own.message) {
                self.findings.push(own);
            }
        }
    }

    fn add(&mut self, found: &SearchResult) {
        self.iterations += found.best.iterations;
        self.evaluations += found.screened + found.starts.iter().map(|start| start.evaluations).sum::<usize>();
    }
}

/// One search of an objective.
fn searched(
    plan: &Plan,
    host: &SearchHost,
    objective: &CalibrationObjective<'_>,
    start: Vec<f64>,
    [is_first, is_last]: [bool; 2],
    labels: &Labels,
) -> HostResult<SearchResult> {
    let search = plan.search_from(start, is_first, is_last)?;
    let priors = plan.unknowns.iter().filter(|unknown| plan.parameter_of(unknown).is_scored()).count();
    if search.method == Method::LevenbergMarquardt
        && objective.ends().last().is_some_and(|end| end + priors < search.start.len())
    {
        return Err(refuse("there are fewer numbers to compare than parameters: compare signals, or more of them"));
    }
    let own = [HostSearch { function: "calibrate", search: &search, labels, objective }];
    let session = &objective.session;
    let found = host.minimize_all(session, &own)?;
    let mut found = found.map_err(|(_, error)| ended(session, &error))?;
    found.pop().ok_or_else(|| refuse("the search has no result"))
}

/// Why a search ended without a result: the study was told to stop, or this error.
pub(super) fn ended(session: &Session, error: &SearchError) -> Box<rhai::EvalAltResult> {
    check_stop(session).err().unwrap_or_else(|| failure(error, ""))
}

/// Title and signals of the plots of a search.
pub(super) fn labels(plan: &Plan) -> Labels {
    let signals = plan.tests.iter().flat_map(|test| {
        test.signals.iter().map(move |signal| format!("{} of {} ({})", signal.name, test.name, signal.column.unit))
    });
    Labels {
        title: Some(plan.title().into()),
        phase: None,
        signals: signals.map(|text| SignalLabel::parse(&text)).collect(),
    }
}

/// What these simulated signals leave of every test, of those signals that are compared along their length; the model's error
/// of a test may have these shapes.
fn left<'p>(plan: &'p Plan, simulated: &[Vec<Series>], shapes: &'p [Vec<Shape>]) -> HostResult<Vec<Left<'p>>> {
    let of_test = |((test, simulated), shapes): ((&'p Test, &Vec<Series>), &'p Vec<Shape>)| {
        let along = test.signals.iter().zip(simulated).filter(|(signal, _)| signal.distance.is_residuals());
        let scaled = along.map(|(signal, simulated)| {
            let scaled = signal.errors.scaled(simulated);
            Ok((&signal.errors, scaled.map_err(|error| refuse!("{}: {error}", test.name))?))
        });
        Ok(Left { signals: scaled.collect::<HostResult<_>>()?, weight: test.weight * test.of_signals, shapes })
    };
    plan.tests.iter().zip(simulated).zip(shapes).map(of_test).collect()
}

/// Simulated signals of every test with these values.
fn simulated_at(plan: &Plan, values: &[f64], session: &Session) -> HostResult<Vec<Vec<Series>>> {
    let objective = CalibrationObjective::new(plan, 0.0, session);
    let trial = session.with_trial(session.cancellation());
    of_tests(plan, session, |test| Ok(objective.simulated(test, values, &trial)?.0))
}

/// Something of every test, evaluated at once.
fn of_tests<T: Send>(plan: &Plan, session: &Session, of: impl Fn(usize) -> HostResult<T> + Sync) -> HostResult<Vec<T>> {
    run_all(session, &(0..plan.tests.len()).collect::<Vec<_>>(), of)
}

/// Takes the roughness of the simulated signals as noise, and their size; a signal that ends before its window has none yet.
fn set_simulated(plan: &mut Plan, simulated: &[Vec<Series>]) {
    for (test, simulated) in plan.tests.iter_mut().zip(simulated) {
        for (signal, simulated) in test.signals.iter_mut().zip(simulated) {
            drop(signal.errors.set_simulated(simulated));
        }
    }
}

/// Takes what the recordings are uncertain in at contact as errors of the differences, by these simulated signals and, where a
/// speed is uncertain, by those of a faster impactor; the findings of runs of that which fail.
fn add_contacts(
    plan: &mut Plan,
    simulated: &[Vec<Series>],
    values: &[f64],
    session: &Session,
) -> HostResult<Vec<Warning>> {
    /// By so much is the impactor faster, m/s: well above what a run rounds, well below what its film notices.
    const FASTER: f64 = 0.02;
    let faster = of_tests(plan, session, |test| {
        let own = &plan.tests[test];
        if !own.signals.iter().any(|signal| signal.errors.contact_errors()[1]) {
            return Ok(None);
        }
        let study = own.compared_study().with(plan.changes(test, values), session)?.faster(FASTER, session);
        Ok(Some(plan.simulated(test, &study, session)))
    })?;
    let mut warnings = Vec::new();
    for ((test, simulated), faster) in plan.tests.iter_mut().zip(simulated).zip(faster) {
        let faster = match faster.transpose() {
            Ok(found) => found,
            Err(cause) => {
                warnings.push(Warning::RunFailed { test: test.name.clone(), cause });
                None
            }
        };
        for (place, (signal, simulated)) in test.signals.iter_mut().zip(simulated).enumerate() {
            // A signal that ends before its window shows none yet.
            drop(signal.add_contact(simulated, faster.as_ref().map(|all| (&all[place], FASTER))));
        }
    }
    Ok(warnings)
}

fn noises(plan: &Plan) -> Vec<f64> {
    plan.tests.iter().flat_map(|test| &test.signals).map(|signal| signal.errors.noise()).collect()
}

/// The finding of signals over travel where the correlation of the model's error was given as a time.
fn over_travel(plan: &Plan) -> Option<Warning> {
    let Some(Correlation::Length(_)) = plan.correlation else { return None };
    let along = |test: &&Test| test.signals.iter().any(|own| own.is_over_travel() && own.distance.is_residuals());
    let tests: Vec<String> = plan.tests.iter().filter(along).map(|test| test.name.clone()).collect();
    (!tests.is_empty()).then_some(Warning::CorrelationOverTravel { tests })
}

/// The tests whose runs have elements that are coarse in contact.
fn coarse(plan: &Plan, runs: &[Warning]) -> Vec<usize> {
    let names = runs.iter().filter_map(|own| match own {
        Warning::OfRuns { tests, of, .. } if of == COARSE_CONTACT.name => Some(tests),
        _ => None,
    });
    let names: Vec<&String> = names.flatten().collect();
    (0..plan.tests.len()).filter(|test| names.contains(&&plan.tests[*test].name)).collect()
}

/// What the runs of the tests with these values warn of, each warning once with the tests that have it.
fn of_runs(plan: &Plan, values: &[f64], session: &Session) -> HostResult<Vec<Warning>> {
    let runs = of_tests(plan, session, |place| {
        let test = &plan.tests[place];
        if test.pull.is_some() {
            return Ok(None);
        }
        let study = test.study.with(plan.changes_with_breaks(place, values), session)?;
        Ok(Some(study.simulate(session)))
    })?;
    let mut found: Vec<Warning> = Vec::new();
    for (test, run) in plan.tests.iter().zip(runs).filter_map(|(test, run)| Some((test, run?))) {
        let run = match run {
            Ok(run) => run,
            Err(error) => {
                // A run goes on behind the window of its recording, where it was not needed.
                found.push(Warning::RunFailed { test: test.name.clone(), cause: cause(&error) });
                continue;
            }
        };
        let all = run.summary().get("findings").and_then(Value::as_array).into_iter().flatten();
        for finding in all.filter(|own| own["severity"] == "warning") {
            let [Some(code), Some(message)] = ["code", "message"].map(|key| finding[key].as_str()) else { continue };
            // Of recordings, and of what the film's data leave open, the script says so itself.
            if code == VIRTUAL_REFERENCE.name || left_open(code).is_some() {
                continue;
            }
            let same = found.iter_mut().find_map(|own| match own {
                Warning::OfRuns { tests, of, .. } if of == code => Some(tests),
                _ => None,
            });
            match same {
                Some(tests) => tests.push(test.name.clone()),
                None => found.push(Warning::OfRuns {
                    tests: vec![test.name.clone()],
                    of: code.into(),
                    message: message.into(),
                }),
            }
        }
    }
    Ok(found)
}

/// Findings of what is not determined, by a basis such as the posterior.
pub(super) fn doubts<'a>(plan: &'a Plan, known: &'a [Knowledge], basis: &'a str) -> impl Iterator<Item = Warning> + 'a {
    plan.unknowns.iter().zip(known).filter_map(move |(unknown, known)| {
        let (parameter, basis) = (unknown.name.clone(), basis.to_owned());
        let Knowledge { half_width, half_width_alone, prior_share, .. } = *known;
        match &known.verdict {
            Verdict::NotDetermined => Some(Warning::NotDetermined { parameter, half_width, prior_share, basis }),
            Verdict::OnlyTogether(others) => {
                let others = others.clone();
                Some(Warning::DeterminedTogether { parameter, others, half_width, half_width_alone, basis })
            }
            Verdict::MeshLimited => {
                let half = verdict::NORMAL_95 * known.deviation;
                let moved = if plan.parameter_of(unknown).is_logarithmic {
                    known.mesh_shift.exp_m1()
                } else {
                    known.mesh_shift
                };
                let sizes = mesh::sizes(plan, unknown, known.mesh_shift, half);
                let coarse = plan.mesh.coarse_of(plan, unknown).map(|test| plan.tests[test].name.clone()).collect();
                Some(Warning::MeshLimited { parameter, moved, half_width, coarse, sizes, basis })
            }
            Verdict::Determined | Verdict::AtBound(_) => None,
        }
    })
}

#[cfg(test)]
mod tests {
    use super::is_timed;

    /// The second of two tests that share a run takes what the first left: that time counts.
    #[test]
    fn a_study_of_runs_that_are_kept_has_no_forecast() {
        for (after, expected) in [([3, 4], true), ([5, 5], true), ([5, 4], false), ([3, 6], true)] {
            assert_eq!(is_timed([3, 4], after), expected, "{after:?}");
        }
    }
}
