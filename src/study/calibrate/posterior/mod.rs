//! The posterior of a calibration, sampled on surrogates of the tests that are refined where it is.

mod density;
mod surrogate;

use std::sync::{Arc, Mutex};

use nalgebra::{DMatrix, DVector, SymmetricEigen};
use rayon::prelude::*;

use crate::calibrate::error_model::{ErrorSize, Shape, Spectrum};
use crate::calibrate::mesh;
use crate::calibrate::objective::CalibrationObjective;
use crate::calibrate::plan::{BreakUnknowns, Plan};
use crate::calibrate::posterior::density::{Density, Layout};
use crate::calibrate::posterior::surrogate::{Region, TestSurrogate};
use crate::calibrate::verdict;
use crate::calibrate::warning::Warning;
use crate::identify::{SearchHost, Side};
use crate::script::{HostResult, Session, cause, check_stop, refuse};
use uncertainty::design::{self, Levels, Method};
use uncertainty::ensemble::{self, LARGEST_R_HAT, Samples};
use uncertainty::random::Stream;
use uncertainty::statistics::quantiles;

pub(super) use crate::calibrate::posterior::density::Beginning;

/// Half width of the first region of a surrogate, in standard deviations of the linear model whose tests are tempered.
const FIRST_REGION: f64 = 3.0;
/// What the squared residuals of tests are divided by for that region: contact makes signals rough, so that the best point may
/// be a local minimum many deviations from the posterior, whose width the linear model there does not tell.
const TEMPER: f64 = 25.0;
/// What a region reaches beyond the samples on either side, as a share of their range.
const BEYOND: f64 = 0.25;
/// What a region reaches beyond samples that it has cut off, as a share of their range.
const CUT: f64 = 1.5;
/// Distance from the face of a region, as a share of it, at which it counts as what ends the samples.
const NEAR: f64 = 0.02;
/// Rounds over those of refinement in which regions may move after the samples.
const MOVES: usize = 3;
/// Error of a surrogate at new points, in standard deviations over all of its coordinates, that the posterior does not show.
const SMALL_ERROR: f64 = 0.5;
/// Most steps of the walkers of rounds before the last.
const LOOK: usize = 1000;
/// Drawings of points of a region at most, of which the model refuses a part.
const DRAWINGS: usize = 8;
/// Least share of samples that the model does not refuse.
const LEAST_SUPPORTED: f64 = 0.02;
/// Samples that are kept.
const KEPT: usize = 4000;
/// Distance of an end of an interval of 95 % from a bound, as a share of the distance of the bounds, at which the posterior is
/// at that bound.
const AT_BOUND: f64 = 0.01;
/// Least effective size of a coordinate whose interval of 95 % counts.
const LEAST_EFFECTIVE: f64 = 400.0;

/// How a posterior is sampled.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct PosteriorOptions {
    /// Runs of each test in its region, in every round; twelve a parameter and twelve more at least.
    pub(super) runs: usize,
    /// Rounds after which a surrogate that is rough counts; regions may move for [`MOVES`] times as many.
    pub(super) rounds: usize,
    /// Most steps of each walker.
    pub(super) steps: usize,
    pub(super) seed: u64,
    /// Unknowns that scatter from specimen to specimen, and what is expected of their standard deviation.
    pub(super) scattered: Vec<(usize, f64)>,
}

/// Samples of the posterior of a calibration.
#[derive(Clone)]
pub(super) struct Posterior {
    /// What it is of.
    pub(super) plan: Arc<Plan>,
    layout: Layout,
    /// States, thinned.
    states: Vec<Vec<f64>>,
    /// R̂ and effective size of every coordinate.
    pub(super) r_hat: Vec<f64>,
    pub(super) effective: Vec<f64>,
    pub(super) acceptance: f64,
    /// Runs of all tests, and of those that failed.
    pub(super) runs: usize,
    /// Runs of each test that have a value.
    pub(super) runs_of_tests: Vec<usize>,
    /// Error of the surrogate of each test at new points.
    pub(super) errors: Vec<f64>,
    /// Of each state, the share of the variance of the model's error that is in proportion to the signal, mean over the tests.
    in_proportion: Vec<f64>,
    pub(super) warnings: Vec<Warning>,
}

/// A draw of a posterior, for a specimen that was not tested.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Draw {
    /// The unknowns; of what scatters over specimens, the value of this one.
    pub(super) x: Vec<f64>,
    /// The model's error.
    pub(super) error: ErrorSize,
    /// How far its break strains along MD and TD are from their medians, in deviations of their logarithm.
    pub(super) breaks: [f64; 2],
}

/// The runs of one test: unknowns that act on it, and differences.
type Runs = Vec<(Vec<f64>, Vec<f64>)>;

/// A run of a test: its index, the unknowns, and the differences or why there are none.
type Computed<'a> = (usize, &'a Vec<f64>, Result<Vec<f64>, String>);

/// What the rounds so far have come to.
struct SoFar {
    regions: Vec<Region>,
    runs: Vec<Runs>,
    /// Of every test, how many of its runs failed, and why the first did.
    failed: Vec<(usize, String)>,
    computed: usize,
    rounds: usize,
    surrogates: Vec<TestSurrogate>,
    samples: Samples,
    /// Error of each surrogate at new points.
    errors: Vec<f64>,
    /// Whether no region cuts the samples off.
    is_inside: bool,
    stream: Stream,
}

/// What stays the same over all rounds.
struct Sampling<'a> {
    plan: &'a Arc<Plan>,
    objective: CalibrationObjective<'a>,
    layout: Layout,
    /// Of every test and every shape that the model's error may have there.
    spectra: Vec<Vec<Spectrum>>,
    acting: Vec<Vec<usize>>,
    breaks: Vec<BreakUnknowns>,
    /// Why the scenario of each test refused the first point that it did.
    refused: Vec<Mutex<Option<String>>>,
    session: &'a Session,
    host: &'a SearchHost,
    options: &'a PosteriorOptions,
}

impl Posterior {
    /// Samples the posterior about the best point of a search: first with the error that elements have there, then with what that
    /// changes by where the samples are.
    pub(super) fn sample(
        from: &Beginning,
        options: &PosteriorOptions,
        host: &SearchHost,
        session: &Session,
    ) -> HostResult<Posterior> {
        let first = Sampling::new(&from.plan, from.share, options, host, session);
        let mut so_far = first.begun(from);
        first.refine(&mut so_far, options.rounds)?;
        let points = first.on_either_side(&so_far.samples);
        let Some((plan, warnings)) = mesh::with_moving(&from.plan, &points, session)? else {
            return first.result(so_far);
        };
        let plan = Arc::new(plan);
        let sampling = Sampling { refused: first.refused, ..Sampling::new(&plan, from.share, options, host, session) };
        // The surrogates are good already; errors that are wider may ask for wider ones.
        sampling.refine(&mut so_far, 1)?;
        let mut found = sampling.result(so_far)?;
        found.warnings.extend(warnings);
        Ok(found)
    }

    /// Samples of the unknowns; of one that scatters, its mean.
    pub(super) fn unknowns(&self) -> impl Iterator<Item = &[f64]> {
        self.states.iter().map(|state| &state[..self.layout.unknowns])
    }

    /// So many draws.
    pub(super) fn draws(&self, count: usize, seed: u64) -> Vec<Draw> {
        let plan = &*self.plan;
        let mut stream = Stream::new(seed);
        let draw = |place: usize| {
            // Evenly over the samples, so that few draws are of all ensembles.
            let number = (place * self.states.len()) / count;
            let state = &self.states[number];
            let mut x = state[..self.layout.unknowns].to_vec();
            for own in &self.layout.scattered {
                let ends = plan.parameter_at(own.unknown).ends();
                x[own.unknown] = within(ends, x[own.unknown], state[own.deviation].exp(), &mut stream);
            }
            let breaks = [stream.normal(), stream.normal()];
            let error = ErrorSize { share: self.layout.share(state, plan), in_proportion: self.in_proportion[number] };
            Draw { x, error, breaks }
        };
        (0..count).map(draw).collect()
    }

    /// The unknowns whose interval of 95 % begins or ends at a bound.
    pub(super) fn at_bounds(&self) -> Vec<(usize, Side)> {
        let plan = &*self.plan;
        let side = |index: usize| {
            let own: Vec<f64> = self.states.iter().map(|state| state[index]).collect();
            let [low, high] = plan.parameter_at(index).ends();
            let near = AT_BOUND * (high - low);
            let interval = quantiles(&own, &[0.025, 0.975])?;
            match (interval[0] - low < near, high - interval[1] < near) {
                (true, false) => Some((index, Side::Lower)),
                (false, true) => Some((index, Side::Upper)),
                _ => None,
            }
        };
        (0..self.layout.unknowns).filter_map(side).collect()
    }

    /// What is sampled beside the unknowns, the deviations and specimens of what scatters and the model's error: the name in
    /// results, the samples, R̂ and effective size of each.
    pub(super) fn beside_unknowns(&self) -> impl Iterator<Item = (String, Vec<f64>, [f64; 2])> + '_ {
        (self.layout.unknowns..self.layout.len()).map(|place| {
            let parameter = self.layout.specimen(place).map(|index| self.plan.parameter_at(index));
            let value = |coordinate: f64| parameter.map_or_else(|| coordinate.exp(), |own| own.value(coordinate));
            let samples = self.states.iter().map(|state| value(state[place])).collect();
            (self.layout.name(place, &self.plan), samples, [self.r_hat[place], self.effective[place]])
        })
    }

    /// Medians of the unknowns.
    pub(super) fn median(&self) -> Vec<f64> {
        let mut all = medians(&self.states);
        all.truncate(self.layout.unknowns);
        all
    }

    /// Covariance of the unknowns.
    pub(super) fn covariance(&self) -> DMatrix<f64> {
        covariance(&self.states, self.layout.unknowns)
    }
}

impl<'a> Sampling<'a> {
    fn new(
        plan: &'a Arc<Plan>,
        share: f64,
        options: &'a PosteriorOptions,
        host: &'a SearchHost,
        session: &'a Session,
    ) -> Sampling<'a> {
        Sampling {
            plan,
            objective: CalibrationObjective::new(plan, share, session),
            layout: Layout::new(plan, &options.scattered),
            spectra: (0..plan.tests.len()).map(|test| spectra(plan, test)).collect(),
            acting: (0..plan.tests.len()).map(|test| plan.acting_on(test)).collect(),
            breaks: (0..plan.tests.len()).map(|test| plan.break_unknowns(test)).collect(),
            refused: plan.tests.iter().map(|_| Mutex::default()).collect(),
            session,
            host,
            options,
        }
    }

    /// Before the first round.
    fn begun(&self, from: &Beginning) -> SoFar {
        let tests = self.plan.tests.len();
        let regions = self.first_regions(from);
        SoFar {
            samples: self.first_states(from, &regions),
            regions,
            runs: vec![Vec::new(); tests],
            failed: vec![(0, String::new()); tests],
            computed: 0,
            rounds: 0,
            surrogates: Vec::new(),
            errors: Vec::new(),
            is_inside: false,
            stream: Stream::new(self.options.seed),
        }
    }

    /// Rounds of surrogates and samples until the surrogates are good where the samples are, or as good as so many rounds make
    /// them.
    fn refine(&self, so_far: &mut SoFar, rounds: usize) -> HostResult<()> {
        let tests = self.plan.tests.len();
        for round in 1..=MOVES * rounds {
            let SoFar { regions, runs, failed, computed, rounds: before, .. } = &mut *so_far;
            let points = regions.iter().zip(&*runs).enumerate();
            let points = points.map(|(test, (region, runs))| self.design(test, region, runs, *before));
            let points = points.collect::<HostResult<Vec<_>>>()?;
            *computed += self.compute(&points, runs, failed)?;
            let surrogates = regions.iter().zip(&*runs).enumerate().map(|(test, (region, runs))| {
                let name = &self.plan.tests[test].name;
                let compared = self.objective.compared(test);
                let shares = self.layout.shares(self.plan);
                TestSurrogate::fit(region.clone(), runs, compared, shares, &self.spectra[test]).map_err(|error| {
                    let (count, cause) = &failed[test];
                    let of_runs = match count {
                        0 => String::new(),
                        _ => format!("; {count} of its runs failed, the first: {cause}"),
                    };
                    refuse!("the surrogate of {name}: {error}{of_runs}")
                })
            });
            so_far.surrogates = surrogates.collect::<HostResult<Vec<_>>>()?;
            so_far.samples = self.samples(so_far, false)?;
            let drawn = self.new_points(&so_far.samples, &mut so_far.stream);
            let before: Vec<usize> = so_far.runs.iter().map(Vec::len).collect();
            so_far.computed += self.compute(&drawn, &mut so_far.runs, &mut so_far.failed)?;
            so_far.rounds += 1;
            let state = medians(&so_far.samples.points);
            let new = |test: usize| &so_far.runs[test][before[test]..];
            let error = |test: usize| self.error(test, &so_far.surrogates[test], new(test), &state);
            so_far.errors = (0..tests).map(error).collect();
            so_far.is_inside = self.is_inside(&so_far.samples, &so_far.regions);
            self.tell(so_far, so_far.rounds + MOVES * rounds - round);
            // Contact makes signals rough, which no surrogate meets: after some rounds its error is in the likelihood.
            let is_good = so_far.errors.iter().all(|error| *error < SMALL_ERROR) || round >= rounds;
            if is_good && so_far.is_inside {
                break;
            }
            if round < MOVES * rounds {
                so_far.regions = self.regions(&so_far.samples, &so_far.regions);
            }
        }
        Ok(())
    }

    /// Values of the unknowns one standard deviation from their medians to either side, along which the samples are widest, each
    /// unknown over what was known of it before.
    fn on_either_side(&self, samples: &Samples) -> [Vec<f64>; 2] {
        let count = self.layout.unknowns;
        let middle = medians(&samples.points);
        let known = |index: usize| self.plan.parameter_of(&self.plan.unknowns[index]).prior_deviation();
        let covariance = covariance(&samples.points, count);
        let over = DMatrix::from_fn(count, count, |row, column| covariance[(row, column)] / known(row) / known(column));
        let eigen = SymmetricEigen::new(over);
        let widest = eigen.eigenvalues.iamax();
        [1.0, -1.0].map(|side| {
            let moved = |index: usize| {
                let [low, high] = self.plan.parameter_of(&self.plan.unknowns[index]).ends();
                let along = eigen.eigenvectors[(index, widest)] * eigen.eigenvalues[widest].max(0.0).sqrt();
                (middle[index] + side * along * known(index)).clamp(low, high)
            };
            self.plan.values(&(0..count).map(moved).collect::<Vec<_>>())
        })
    }

    /// Says how far it is after a round.
    fn tell(&self, so_far: &SoFar, most: usize) {
        let SoFar { rounds, computed, errors, is_inside, .. } = so_far;
        let largest = errors.iter().copied().fold(0.0, f64::max);
        let cut = if *is_inside { "" } else { ", samples reach the ends of a region" };
        let of = format!("{}, posterior, round {rounds} of {most}", self.plan.title());
        let off = match largest.is_finite() {
            true => format!("surrogates off by at most {} deviations", base::number::significant(largest, 2)),
            false => "no run at new points has a value".into(),
        };
        self.host.tell(&format!("{of} at most: {computed} runs, {off}{cut}"));
    }

    /// The covariance of a linear model about the best point whose tests are tempered, of all tests or of one.
    fn tempered(&self, from: &Beginning, test: Option<usize>) -> DMatrix<f64> {
        let ends = self.objective.ends();
        let (first, count) = match test {
            None => (0, ends[ends.len() - 1]),
            Some(test) => (ends[test], ends[test + 1] - ends[test]),
        };
        let rows = from.jacobian.rows(first, count);
        let mut information = rows.tr_mul(&rows) / TEMPER;
        for (index, unknown) in self.plan.unknowns.iter().enumerate() {
            information[(index, index)] += self.plan.parameter_of(unknown).prior_deviation().powi(-2);
        }
        verdict::inverse(&information)
    }

    /// Boxes about the best point, by the linear model of each test's own unknowns.
    fn first_regions(&self, from: &Beginning) -> Vec<Region> {
        let region = |test: usize| {
            // Where specimens scatter, each test alone decides its own values.
            let covariance = self.tempered(from, Some(test).filter(|_| !self.layout.scattered.is_empty()));
            let side = |sign: f64| {
                let end = |index: &usize| {
                    let [low, high] = self.plan.parameter_at(*index).ends();
                    (from.in_tests[test][*index] + sign * FIRST_REGION * covariance[(*index, *index)].sqrt())
                        .clamp(low, high)
                };
                self.acting[test].iter().map(end).collect()
            };
            Region { low: side(-1.0), high: side(1.0) }
        };
        (0..self.plan.tests.len()).map(region).collect()
    }

    /// Points that a region lacks beside these runs: a Latin hypercube.
    fn design(&self, test: usize, region: &Region, runs: &Runs, round: usize) -> HostResult<Vec<Vec<f64>>> {
        if region.low.is_empty() {
            return Ok(if runs.is_empty() { vec![Vec::new()] } else { Vec::new() });
        }
        let factors = vec![Levels::Continuous; region.low.len()];
        let wanted = self.options.runs.max(12 * region.low.len() + 12);
        let missing = wanted.saturating_sub(runs.iter().filter(|(point, _)| region.unit(point).is_some()).count());
        if missing == 0 {
            return Ok(Vec::new());
        }
        // Where the model refuses a part of the region, points are drawn until the rest of it has enough.
        let mut found = Vec::new();
        for drawing in 0..DRAWINGS {
            let seed = self.options.seed.wrapping_add((round * DRAWINGS + drawing) as u64);
            let points = design::points(Method::LatinHypercube, &factors, missing, seed).map_err(refuse)?;
            let points = points.iter().map(|unit| region.point(unit)).collect::<Vec<_>>();
            let count = found.len() + points.len();
            found.extend(self.supported(test, points));
            if found.len() == count {
                break;
            }
        }
        found.truncate(missing);
        Ok(found)
    }

    /// Those of the points of a test that its scenario does not refuse: the others have no probability before the tests.
    fn supported(&self, test: usize, points: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
        let is_supported = |point: &Vec<f64>| {
            let changes = self.plan.changes(test, &self.values_at(test, point));
            match self.plan.tests[test].study.with(changes, self.session) {
                Ok(_) => true,
                Err(error) => {
                    let mut refused = base::lock(&self.refused[test]);
                    refused.get_or_insert_with(|| cause(&error));
                    false
                }
            }
        };
        points.into_par_iter().filter(is_supported).collect()
    }

    /// The samples that no test refuses, of tests that have refused any point: at most [`KEPT`] of them.
    fn within_support(&self, samples: Samples) -> HostResult<Samples> {
        let refusing: Vec<usize> = (0..self.refused.len()).filter(|test| self.refusal(*test).is_some()).collect();
        if refusing.is_empty() {
            return Ok(samples);
        }
        let mut points = kept(samples.points, self.options.seed);
        let before = points.len() as f64;
        for test in &refusing {
            let in_test = |state: &Vec<f64>| {
                self.acting[*test].iter().map(|index| self.layout.in_test(state, *test)[*index]).collect()
            };
            let supported = self.supported(*test, points.iter().map(in_test).collect());
            let mut supported = supported.into_iter().peekable();
            points.retain(|state| supported.next_if_eq(&in_test(state)).is_some());
        }
        let share = points.len() as f64 / before;
        if share < LEAST_SUPPORTED {
            let cause = refusing.iter().find_map(|test| self.refusal(*test)).unwrap_or_default();
            return Err(refuse!("the posterior lies where scenarios are refused: {cause}"));
        }
        let effective = samples.effective.iter().map(|size| size * share).collect();
        Ok(Samples { points, effective, ..samples })
    }

    fn refusal(&self, test: usize) -> Option<String> {
        base::lock(&self.refused[test]).clone()
    }

    /// Values of all unknowns at a point of a test.
    fn values_at(&self, test: usize, point: &[f64]) -> Vec<f64> {
        let mut values = self.plan.start();
        for (index, coordinate) in self.acting[test].iter().zip(point) {
            values[*index] = self.plan.parameter_at(*index).value(*coordinate);
        }
        values
    }

    /// Computes the differences of all tests at points of theirs; the number of runs.
    fn compute(
        &self,
        points: &[Vec<Vec<f64>>],
        runs: &mut [Runs],
        failed: &mut [(usize, String)],
    ) -> HostResult<usize> {
        let all: Vec<(usize, &Vec<f64>)> = points
            .iter()
            .enumerate()
            .flat_map(|(test, points)| points.iter().map(move |point| (test, point)))
            .collect();
        let found: Vec<Computed<'_>> =
            all.into_par_iter().map(|(test, point)| (test, point, self.differences(test, point))).collect();
        check_stop(self.session)?;
        let count = found.len();
        for (test, point, found) in found {
            match found {
                Ok(found) => runs[test].push((point.clone(), found)),
                Err(cause) => {
                    failed[test].0 += 1;
                    if failed[test].1.is_empty() {
                        failed[test].1 = cause;
                    }
                }
            }
        }
        Ok(count)
    }

    /// The differences of a test at values of the unknowns that act on it.
    fn differences(&self, test: usize, point: &[f64]) -> Result<Vec<f64>, String> {
        // No run begins once the study is told to stop.
        check_stop(self.session).map_err(|error| cause(&error))?;
        let values = self.values_at(test, point);
        let session = self.session.with_trial(self.session.cancellation());
        let (simulated, demands) = self.objective.simulated(test, &values, &session).map_err(|error| cause(&error))?;
        if let Some(rupture) = self.plan.rupture_in(&session) {
            return Err(rupture);
        }
        let own = &self.plan.tests[test];
        let mut all = Vec::new();
        for (signal, simulated) in own.signals.iter().zip(&simulated) {
            all.extend(signal.scaled(simulated)?.iter());
        }
        all.extend(demands);
        Ok(all)
    }

    /// Starts of the walkers, within all regions: of the linear model of all tests, and of each test what scatters.
    fn first_states(&self, from: &Beginning, regions: &[Region]) -> Samples {
        let mut stream = Stream::new(self.options.seed);
        let factor = |test| self.tempered(from, test).cholesky().map(|own| own.l());
        let (of_all, of_tests) = (factor(None), (0..regions.len()).map(|test| factor(Some(test))).collect::<Vec<_>>());
        let draw = |centre: &[f64], factor: &Option<DMatrix<f64>>, stream: &mut Stream| {
            let normals = DVector::from_fn(self.layout.unknowns, |_, _| stream.normal());
            let shift = factor.as_ref().map_or(normals.clone() * 1e-3, |factor| factor * normals);
            centre.iter().zip(shift.iter()).map(|(x, shift)| x + 0.5 * shift).collect::<Vec<f64>>()
        };
        // Within the bounds, and within the region of every test on which an unknown acts.
        let inside = |index: usize, tests: &[usize]| {
            let [mut low, mut high] = self.plan.parameter_at(index).ends();
            for test in tests {
                if let Some(place) = self.acting[*test].iter().position(|own| *own == index) {
                    (low, high) = (low.max(regions[*test].low[place]), high.min(regions[*test].high[place]));
                }
            }
            let margin = 1e-3 * (high - low);
            [low + margin, high - margin]
        };
        let all: Vec<usize> = (0..regions.len()).collect();
        let is_scattered = |index: usize| self.layout.scattered.iter().any(|own| own.unknown == index);
        let state = |_: usize| {
            let mut state = draw(&from.x, &of_all, &mut stream);
            for (index, x) in state.iter_mut().enumerate() {
                let [low, high] = inside(index, if is_scattered(index) { &[] } else { &all });
                *x = x.clamp(low, high);
            }
            state.resize(self.layout.len(), 0.0);
            for own in &self.layout.scattered {
                state[own.deviation] = (0.3 * own.expected).ln() + 0.3 * stream.normal();
                for (test, place) in &own.values {
                    let [low, high] = inside(own.unknown, &[*test]);
                    let specimen = draw(&from.in_tests[*test], &of_tests[*test], &mut stream);
                    state[*place] = specimen[own.unknown].clamp(low, high);
                }
            }
            if let Some(place) = self.layout.share {
                state[place] = from.share.max(1e-3).ln() + 0.2 * stream.normal();
            }
            state
        };
        let points = (0..KEPT).map(state).collect();
        Samples { points, r_hat: Vec::new(), effective: Vec::new(), acceptance: 0.0, steps: 0 }
    }

    fn samples(&self, so_far: &mut SoFar, is_last: bool) -> HostResult<Samples> {
        let SoFar { surrogates, samples: centre, rounds, stream, .. } = so_far;
        let density =
            Density { plan: self.plan, layout: &self.layout, acting: &self.acting, breaks: &self.breaks, surrogates };
        let seed = self.options.seed.wrapping_add((*rounds).saturating_sub(usize::from(is_last)) as u64);
        // Samples that only tell where surrogates are needed may be few.
        let (most_steps, effective) =
            if is_last { (self.options.steps, 1000.0) } else { (LOOK.min(self.options.steps), 200.0) };
        let usual = ensemble::Options::default();
        let options = ensemble::Options { seed, steps: usual.steps.min(most_steps), most_steps, effective };
        let mut place = 0;
        let start = || {
            place += 1;
            let first = stream.below(centre.points.len());
            if place % 2 == 0 {
                return centre.points[first].clone();
            }
            // Between two states, where one of them alone may lie outside of a region.
            let (other, share) = (stream.below(centre.points.len()), stream.uniform());
            let between = centre.points[first].iter().zip(&centre.points[other]);
            between.map(|(a, b)| a + 0.5 * share * (b - a)).collect()
        };
        let found = ensemble::sample(&density, start, &options)
            .map_err(|error| refuse!("the posterior cannot be sampled: {error}"))?;
        self.within_support(found)
    }

    /// New points of every test: draws of the posterior.
    fn new_points(&self, samples: &Samples, stream: &mut Stream) -> Vec<Vec<Vec<f64>>> {
        let of_test = |(test, acting): (usize, &Vec<usize>)| {
            let count = if acting.is_empty() { 0 } else { 4 * acting.len() + 4 };
            let draw = |_: usize| {
                let state = &samples.points[stream.below(samples.points.len())];
                let x = self.layout.in_test(state, test);
                acting.iter().map(|index| x[*index]).collect()
            };
            (0..count).map(draw).collect()
        };
        self.acting.iter().enumerate().map(of_test).collect()
    }

    /// Root mean square over runs of the norm of a surrogate's error, each coordinate over its standard deviation.
    fn error(&self, test: usize, surrogate: &TestSurrogate, runs: &[(Vec<f64>, Vec<f64>)], state: &[f64]) -> f64 {
        if self.acting[test].is_empty() {
            return 0.0;
        }
        let share = self.layout.share(state, self.plan);
        let scatter = self.breaks[test].with_values(&self.plan.values(&self.layout.in_test(state, test))).scatter;
        let own = &self.plan.tests[test];
        let demands = own.outcomes.as_ref().map_or(0, |outcomes| outcomes.numbers());
        let spectrum = Spectrum::joined(&own.signals.iter().map(|signal| signal.spectrum(None)).collect::<Vec<_>>());
        // Demands alternate between MD and TD.
        let of_demands = (0..demands).map(|place| scatter[place % 2].powi(2));
        let variances: Vec<f64> = spectrum.variances(share).chain(of_demands).collect();
        let squares: Vec<f64> = runs
            .iter()
            .filter_map(|(point, found)| {
                let expected = surrogate.predicted(point)?;
                let (compared, demanded) = found.split_at(found.len() - demands);
                let off = &*spectrum.basis * (surrogate.differences(&expected) - DVector::from_column_slice(compared));
                let of_demands = expected.demands.iter().zip(demanded).map(|(own, found)| own - found);
                let off = off.iter().copied().chain(of_demands);
                Some(off.zip(&variances).map(|(off, variance)| off * off / variance).sum::<f64>())
            })
            .collect();
        if squares.is_empty() { f64::INFINITY } else { (squares.iter().sum::<f64>() / squares.len() as f64).sqrt() }
    }

    /// Ranges of 99.8 % of the samples in a test.
    fn ranges(&self, samples: &Samples, test: usize) -> Vec<[f64; 2]> {
        let columns: Vec<Vec<f64>> = samples.points.iter().map(|state| self.layout.in_test(state, test)).collect();
        let range = |index: &usize| {
            let mut own: Vec<f64> = columns.iter().map(|x| x[*index]).collect();
            own.sort_by(f64::total_cmp);
            let at = |share: f64| own[((own.len() - 1) as f64 * share) as usize];
            [at(0.001), at(0.999)]
        };
        self.acting[test].iter().map(range).collect()
    }

    /// Whether no region cuts the samples off where the bounds do not.
    fn is_inside(&self, samples: &Samples, regions: &[Region]) -> bool {
        let inside = |(test, region): (usize, &Region)| {
            let ranges = self.ranges(samples, test);
            ranges.into_iter().enumerate().all(|(place, range)| self.cut(test, place, range, region) == [false; 2])
        };
        regions.iter().enumerate().all(inside)
    }

    /// Whether a region, and no bound, ends the range of an unknown that acts on a test below and above.
    fn cut(&self, test: usize, place: usize, [from, to]: [f64; 2], region: &Region) -> [bool; 2] {
        let [low, high] = self.plan.parameter_at(self.acting[test][place]).ends();
        let near = NEAR * (region.high[place] - region.low[place]);
        let (below, above) = (region.low[place], region.high[place]);
        [from - below < near && below > low, above - to < near && above < high]
    }

    /// Regions about the samples; farther where the last region ended them.
    fn regions(&self, samples: &Samples, last: &[Region]) -> Vec<Region> {
        let region = |test: usize| {
            let ends = self.ranges(samples, test).into_iter().enumerate().map(|(place, [from, to])| {
                let [low, high] = self.plan.parameter_at(self.acting[test][place]).ends();
                let range = (to - from).max(1e-6 * (high - low));
                let beyond =
                    self.cut(test, place, [from, to], &last[test]).map(|is_cut| if is_cut { CUT } else { BEYOND });
                [(from - beyond[0] * range).max(low), (to + beyond[1] * range).min(high)]
            });
            let (low, high) = ends.map(|[low, high]| (low, high)).unzip();
            Region { low, high }
        };
        (0..self.plan.tests.len()).map(region).collect()
    }

    /// The share of the variance of the model's error that is in proportion to the signal at a state, mean over the tests whose error
    /// may have one of several `shapes`; zero where none may.
    fn in_proportion(&self, surrogates: &[TestSurrogate], shapes: &[Vec<Shape>], state: &[f64]) -> f64 {
        let of_test = |(test, surrogate): (usize, &TestSurrogate)| {
            let shapes = &shapes[test];
            let x = self.layout.in_test(state, test);
            let point: Vec<f64> = self.acting[test].iter().map(|index| x[*index]).collect();
            let found = surrogate.predicted(&point).filter(|_| shapes.len() > 1)?;
            let logs = surrogate.of_shapes(&found, self.layout.share(state, self.plan));
            let largest = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            let weights = logs.iter().map(|log| (log - largest).exp());
            let own = weights.clone().zip(shapes).map(|(weight, shape)| weight * shape.in_proportion()).sum::<f64>();
            Some(own / weights.sum::<f64>())
        };
        let found: Vec<f64> = surrogates.iter().enumerate().filter_map(of_test).collect();
        found.iter().sum::<f64>() / found.len().max(1) as f64
    }

    /// Many samples on the last surrogates.
    fn result(&self, mut so_far: SoFar) -> HostResult<Posterior> {
        let samples = self.samples(&mut so_far, true)?;
        let SoFar { runs, failed, computed, rounds, surrogates, errors, is_inside, .. } = so_far;
        let states = kept(samples.points, self.options.seed);
        let shapes: Vec<Vec<Shape>> = (0..self.plan.tests.len()).map(|test| self.plan.shapes(test)).collect();
        let in_proportion = states.par_iter().map(|state| self.in_proportion(&surrogates, &shapes, state)).collect();
        let mut warnings = Vec::new();
        if !is_inside {
            warnings.push(Warning::PosteriorCut { rounds });
        }
        for (place, (r_hat, effective)) in
            samples.r_hat.iter().copied().zip(samples.effective.iter().copied()).enumerate()
        {
            if r_hat > LARGEST_R_HAT || effective < LEAST_EFFECTIVE {
                let parameter = self.layout.name(place, self.plan);
                warnings.push(Warning::PosteriorNotConverged { parameter, r_hat, effective });
            }
        }
        for (test, own) in self.plan.tests.iter().enumerate() {
            // Without a run at new points there is no error; that they fail is said below.
            if errors[test] >= SMALL_ERROR && errors[test].is_finite() {
                let (error, runs) = (errors[test], runs[test].len());
                warnings.push(Warning::SurrogateError { test: own.name.clone(), error, runs });
            }
            let (count, cause) = failed[test].clone();
            if count > 0 {
                let runs = runs[test].len() + count;
                warnings.push(Warning::PosteriorRuns { test: own.name.clone(), failed: count, runs, cause });
            }
        }
        Ok(Posterior {
            plan: Arc::clone(self.plan),
            layout: self.layout.clone(),
            states,
            r_hat: samples.r_hat,
            effective: samples.effective,
            acceptance: samples.acceptance,
            runs: computed,
            runs_of_tests: runs.iter().map(Vec::len).collect(),
            errors,
            in_proportion,
            warnings,
        })
    }
}

/// The coordinates of the differences of a test, of every shape that the model's error may have there.
fn spectra(plan: &Plan, test: usize) -> Vec<Spectrum> {
    let of = |shape: &Shape| {
        let signals = plan.tests[test].signals.iter();
        Spectrum::joined(&signals.map(|signal| signal.spectrum(Some(*shape))).collect::<Vec<_>>())
    };
    plan.shapes(test).par_iter().map(of).collect()
}

/// Covariance of the first coordinates of states.
fn covariance(states: &[Vec<f64>], coordinates: usize) -> DMatrix<f64> {
    let count = states.len() as f64;
    let mean = |index: usize| states.iter().map(|state| state[index]).sum::<f64>() / count;
    let means: Vec<f64> = (0..coordinates).map(mean).collect();
    DMatrix::from_fn(coordinates, coordinates, |row, column| {
        let product = |state: &Vec<f64>| (state[row] - means[row]) * (state[column] - means[column]);
        states.iter().map(product).sum::<f64>() / (count - 1.0)
    })
}

/// Medians of all coordinates.
fn medians(states: &[Vec<f64>]) -> Vec<f64> {
    let of = |place: usize| {
        let own: Vec<f64> = states.iter().map(|state| state[place]).collect();
        quantiles(&own, &[0.5]).map_or(f64::NAN, |at| at[0])
    };
    (0..states.first().map_or(0, Vec::len)).map(of).collect()
}

/// At most [`KEPT`] of the samples, drawn one from each of as many parts: every so many would be the same few walkers throughout
/// where that number and the number of walkers have a common factor.
fn kept(samples: Vec<Vec<f64>>, seed: u64) -> Vec<Vec<f64>> {
    if samples.len() <= KEPT {
        return samples;
    }
    let mut stream = Stream::new(seed);
    let edge = |part: usize| part * samples.len() / KEPT;
    (0..KEPT).map(|part| samples[edge(part) + stream.below(edge(part + 1) - edge(part))].clone()).collect()
}

/// A draw of a normal distribution between two ends.
fn within([low, high]: [f64; 2], mean: f64, deviation: f64, stream: &mut Stream) -> f64 {
    /// Draws before the nearer end counts, of a distribution that hardly lies between the ends.
    const DRAWS: usize = 1000;
    let draws = (0..DRAWS).map(|_| mean + deviation * stream.normal()).find(|x| (low..=high).contains(x));
    draws.unwrap_or_else(|| mean.clamp(low, high))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Walkers that never move, 64 of them: the samples that are kept are of all.
    #[test]
    fn samples_of_all_walkers_are_kept() {
        for (walkers, steps) in [(64, 250), (64, 500), (64, 4000), (63, 1000)] {
            let samples: Vec<Vec<f64>> = (0..walkers * steps).map(|place| vec![(place % walkers) as f64]).collect();
            let mut counts = vec![0_usize; walkers];
            kept(samples, 1).iter().for_each(|state| counts[state[0] as usize] += 1);
            let mean = counts.iter().sum::<usize>() as f64 / walkers as f64;
            let off = counts.iter().map(|count| (*count as f64 - mean).abs()).fold(0.0, f64::max);
            assert!(off < 5.0 * mean.sqrt(), "{walkers} walkers, {steps} steps: {counts:?}");
        }
    }

    #[test]
    fn a_specimen_lies_within_the_bounds_and_not_on_them() {
        let mut stream = Stream::new(2);
        let drawn: Vec<f64> = (0..4000).map(|_| within([0.0, 1.0], 0.0, 0.5, &mut stream)).collect();
        assert!(drawn.iter().all(|x| *x > 0.0 && *x < 1.0));
        // The mean of a half-normal distribution that is cut at two deviations: 0.5 √(2/π) (1 − e⁻²)/(2 Φ(2) − 1).
        let expected = 0.5 * (2.0 / std::f64::consts::PI).sqrt() * (1.0 - (-2.0_f64).exp()) / 0.954_499_7;
        let mean = drawn.iter().sum::<f64>() / 4000.0;
        assert!((mean - expected).abs() < 0.015, "{mean} for {expected}");
    }
}
