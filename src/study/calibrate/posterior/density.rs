//! The logarithm of a posterior: tests given their unknowns, what is known before, the model's error, and specimens that
//! scatter about a mean.

use std::sync::Arc;

use nalgebra::DMatrix;

use crate::calibrate::fit::Fit;
use crate::calibrate::plan::{BreakUnknowns, Plan, SHARE_BEFORE};
use crate::calibrate::posterior::surrogate::{Shares, TestSurrogate};
use crate::script::HostResult;
use uncertainty::{ensemble, normal};

/// Model errors that are considered.
const SHARES: [f64; 2] = [1e-5, 1.0];

/// The coordinates of a posterior, in this order: the unknowns; of every unknown that scatters the logarithm of its standard
/// deviation, then its value in every test; the logarithm of the model's error where it is estimated.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Layout {
    pub(crate) unknowns: usize,
    pub(crate) scattered: Vec<Scattered>,
    /// Place of the logarithm of the model's error.
    pub(crate) share: Option<usize>,
    /// What scatters, test by test, and these tests: given the rest, one test does not depend on the other.
    blocks: Vec<Vec<ensemble::Scattered>>,
    of_blocks: Vec<usize>,
}

/// An unknown whose value differs from specimen to specimen.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Scattered {
    pub(crate) unknown: usize,
    /// Place of the logarithm of its standard deviation.
    pub(crate) deviation: usize,
    /// Test and place of the value there.
    pub(crate) values: Vec<(usize, usize)>,
    /// Standard deviation that is expected at most, as the one of a half-normal distribution (assumed).
    pub(crate) expected: f64,
}

impl Layout {
    /// Of a plan in which these unknowns scatter, each with what is expected of it.
    pub(crate) fn new(plan: &Plan, scattered: &[(usize, f64)]) -> Layout {
        let mut next = plan.unknowns.len();
        let mut place = || {
            next += 1;
            next - 1
        };
        let scattered: Vec<Scattered> = scattered
            .iter()
            .map(|(unknown, expected)| Scattered {
                unknown: *unknown,
                deviation: place(),
                values: plan.sharing(plan.unknowns[*unknown].parameter).map(|test| (test, place())).collect(),
                expected: *expected,
            })
            .collect();
        let share = plan.estimates_share().then(&mut place);
        let in_test = |test: usize| {
            let own = scattered.iter().flat_map(|own| own.values.iter().map(move |(of, place)| (own, *of, *place)));
            let own = own.filter(|(_, of, _)| *of == test);
            own.map(|(own, _, place)| ensemble::Scattered { place, mean: own.unknown, deviation: own.deviation })
                .collect()
        };
        let blocks = (0..plan.tests.len()).map(|test| (test, in_test(test)));
        let blocks = blocks.filter(|(_, own): &(usize, Vec<ensemble::Scattered>)| !own.is_empty());
        let (of_blocks, blocks) = blocks.unzip();
        Layout { unknowns: plan.unknowns.len(), scattered, share, blocks, of_blocks }
    }

    /// Number of coordinates.
    pub(crate) fn len(&self) -> usize {
        let scattered: usize = self.scattered.iter().map(|own| 1 + own.values.len()).sum();
        self.unknowns + scattered + usize::from(self.share.is_some())
    }

    /// The unknowns as they are in one test.
    pub(crate) fn in_test(&self, state: &[f64], test: usize) -> Vec<f64> {
        let mut x = state[..self.unknowns].to_vec();
        for own in &self.scattered {
            if let Some((_, place)) = own.values.iter().find(|(of, _)| *of == test) {
                x[own.unknown] = state[*place];
            }
        }
        x
    }

    /// The model's error of a state.
    pub(crate) fn share(&self, state: &[f64], plan: &Plan) -> f64 {
        self.share.map_or_else(|| plan.first_share(), |place| state[place].exp())
    }

    /// The model's errors that states can have.
    pub(crate) fn shares(&self, plan: &Plan) -> Shares {
        if self.share.is_some() { Shares::Between(SHARES) } else { Shares::Given(plan.first_share()) }
    }

    /// The unknown whose value in a specimen a coordinate is, where it is one.
    pub(crate) fn specimen(&self, place: usize) -> Option<usize> {
        let is_of = |own: &&Scattered| own.values.iter().any(|(_, own)| *own == place);
        self.scattered.iter().find(is_of).map(|own| own.unknown)
    }

    /// What a coordinate is called in results.
    pub(crate) fn name(&self, place: usize, plan: &Plan) -> String {
        if let Some(unknown) = plan.unknowns.get(place) {
            return unknown.name.clone();
        }
        let of = |own: &Scattered| {
            let unknown = &plan.unknowns[own.unknown];
            if own.deviation == place {
                let along = if plan.parameter_of(unknown).is_logarithmic { "relative deviation" } else { "deviation" };
                return Some(format!("{along} of {} over specimens", unknown.name));
            }
            let (test, _) = own.values.iter().find(|(_, own)| *own == place)?;
            Some(format!("{} of {}", unknown.name, plan.tests[*test].name))
        };
        self.scattered.iter().find_map(of).unwrap_or_else(|| "model error".into())
    }
}

/// Probability of a standard normal value between two others; of the tail that they lie in where both are far from zero.
fn mass_between(low: f64, high: f64) -> f64 {
    let (low, high) = if low > 0.0 { (-high, -low) } else { (low, high) };
    (normal::cumulative(high) - normal::cumulative(low)).max(f64::MIN_POSITIVE)
}

/// A posterior on surrogates of the tests; its logarithm is one up to a constant.
pub(crate) struct Density<'a> {
    pub(crate) plan: &'a Plan,
    pub(crate) layout: &'a Layout,
    /// The unknowns that act on each test.
    pub(crate) acting: &'a [Vec<usize>],
    /// Unknowns of the break strains of each test.
    pub(crate) breaks: &'a [BreakUnknowns],
    pub(crate) surrogates: &'a [TestSurrogate],
}

impl ensemble::Density for Density<'_> {
    fn log(&self, state: &[f64]) -> f64 {
        let before = self.before(state);
        if !before.is_finite() {
            return f64::NEG_INFINITY;
        }
        let is_other = |test: &usize| !self.layout.of_blocks.contains(test);
        before + (0..self.surrogates.len()).filter(is_other).map(|test| self.of_test(test, state)).sum::<f64>()
    }

    fn blocks(&self) -> &[Vec<ensemble::Scattered>] {
        &self.layout.blocks
    }

    /// The specimen of a test about the mean, and what the test says of it.
    fn log_of_block(&self, block: usize, state: &[f64]) -> f64 {
        let mut sum = 0.0;
        for own in &self.layout.blocks[block] {
            let [low, high] = self.plan.parameter_at(own.mean).ends();
            let logarithm = state[own.deviation];
            let standard = |x: f64| (x - state[own.mean]) / logarithm.exp();
            if !(low..=high).contains(&state[own.place]) {
                return f64::NEG_INFINITY;
            }
            // Specimens lie within the bounds, too: what lies beyond them of the normal distribution is shared out.
            let inside = mass_between(standard(low), standard(high)).ln();
            sum -= 0.5 * standard(state[own.place]).powi(2) + logarithm + inside;
        }
        sum + self.of_test(self.layout.of_blocks[block], state)
    }
}

impl Density<'_> {
    /// What a test says of a state.
    fn of_test(&self, test: usize, state: &[f64]) -> f64 {
        let x = self.layout.in_test(state, test);
        let acting: Vec<f64> = self.acting[test].iter().map(|index| x[*index]).collect();
        let (own, surrogate) = (&self.plan.tests[test], &self.surrogates[test]);
        let Some(found) = surrogate.predicted(&acting) else { return f64::NEG_INFINITY };
        let of_signals = surrogate.log_likelihood(&found, self.layout.share(state, self.plan));
        let of_outcomes = own.outcomes.as_ref().map_or(0.0, |outcomes| {
            let breaks = self.breaks[test].with_values(&self.plan.values(&x));
            outcomes.log_likelihood(&found.demands, &surrogate.demand_errors, &breaks)
        });
        own.weight * (own.of_signals * of_signals + of_outcomes)
    }

    /// What is known before the tests of all but the specimens.
    fn before(&self, state: &[f64]) -> f64 {
        let unknowns = self.plan.unknowns.iter().zip(state);
        let mut sum: f64 = unknowns.map(|(unknown, x)| self.plan.parameter_of(unknown).log_prior(*x)).sum();
        for own in &self.layout.scattered {
            // A half-normal distribution of the deviation; the logarithm has its density times the deviation.
            sum += state[own.deviation] - 0.5 * (state[own.deviation].exp() / own.expected).powi(2);
        }
        if let Some(place) = self.layout.share {
            let [median, spread] = SHARE_BEFORE;
            let [low, high] = SHARES.map(f64::ln);
            if !(low..=high).contains(&state[place]) {
                return f64::NEG_INFINITY;
            }
            sum -= 0.5 * ((state[place] - median.ln()) / spread).powi(2);
        }
        sum
    }
}

/// The best point of a search. What tests had of their own there, but scatters about a mean here, is one unknown, which each
/// test has another value of.
pub(in crate::calibrate) struct Beginning {
    pub(in crate::calibrate) plan: Arc<Plan>,
    /// Coordinates of the unknowns; the mean over the tests of what they had of their own.
    pub(crate) x: Vec<f64>,
    /// Coordinates of the unknowns in each test.
    pub(crate) in_tests: Vec<Vec<f64>>,
    /// Derivatives of the residuals of tests and distributions by the coordinates.
    pub(in crate::calibrate) jacobian: DMatrix<f64>,
    /// The model's error, as a share of each signal.
    pub(crate) share: f64,
}

impl Beginning {
    /// At the end of a search, where no test has these parameters of its own.
    pub(in crate::calibrate) fn new(plan: &Plan, fit: &Fit, pooled: &[usize]) -> HostResult<Beginning> {
        let joint = plan.without_own(pooled)?;
        // What an unknown was in the search: itself, or the same parameter of one test and of another.
        let of_search = |index: usize| -> Vec<usize> {
            let own = &joint.unknowns[index];
            let is_same = |other: &usize| {
                let other = &plan.unknowns[*other];
                other.parameter == own.parameter && (pooled.contains(&own.parameter) || other.test == own.test)
            };
            (0..plan.unknowns.len()).filter(is_same).collect()
        };
        let places: Vec<Vec<usize>> = (0..joint.unknowns.len()).map(of_search).collect();
        let mean = |places: &Vec<usize>| places.iter().map(|place| fit.x[*place]).sum::<f64>() / places.len() as f64;
        let x: Vec<f64> = places.iter().map(mean).collect();
        let in_test = |test: usize| {
            let acts = |place: &&usize| plan.tests_of(&plan.unknowns[**place]).contains(&test);
            let own =
                |(places, mean): (&Vec<usize>, &f64)| places.iter().find(acts).map_or(*mean, |place| fit.x[*place]);
            places.iter().zip(&x).map(own).collect()
        };
        let in_tests = (0..plan.tests.len()).map(in_test).collect();
        let jacobian = if pooled.is_empty() { fit.jacobian.clone() } else { jacobian([plan, &joint], fit, &places) };
        Ok(Beginning { plan: Arc::new(joint), x, in_tests, jacobian, share: fit.share })
    }
}

/// Of what every test had of its own, one column: residuals of a test depend on its own value alone. Each distribution counts
/// once.
fn jacobian([searched, joint]: [&Plan; 2], fit: &Fit, places: &[Vec<usize>]) -> DMatrix<f64> {
    let with_prior = |plan: &Plan| -> Vec<usize> {
        (0..plan.unknowns.len()).filter(|index| plan.parameter_at(*index).is_scored()).collect()
    };
    let of_tests = fit.jacobian.nrows() - with_prior(searched).len();
    let priors = with_prior(joint);
    DMatrix::from_fn(of_tests + priors.len(), places.len(), |row, column| {
        match priors.get(row.wrapping_sub(of_tests)) {
            None => places[column].iter().map(|place| fit.jacobian[(row, *place)]).sum(),
            Some(index) if *index == column => joint.parameter_of(&joint.unknowns[column]).prior_deviation().recip(),
            Some(_) => 0.0,
        }
    })
}
