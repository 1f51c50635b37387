//! The logarithm of a posterior: tests given their unknowns, what is known before, the model's error, and specimens that
//! scatter about a mean.

use super::surrogate::{Shares, TestSurrogate};
use crate::calibrate::plan::{BreakUnknowns, Plan, SHARE_BEFORE};
use uncertainty::normal;

/// Model errors that are considered.
const SHARES: [f64; 2] = [1e-5, 1.0];

/// The coordinates of a posterior, in this order: the unknowns; of every unknown that scatters the logarithm of its standard
/// deviation, then its value in every test; the logarithm of the model's error where it is estimated.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Layout {
    pub(super) unknowns: usize,
    pub(super) scattered: Vec<Scattered>,
    /// Place of the logarithm of the model's error.
    pub(super) share: Option<usize>,
}

/// An unknown whose value differs from specimen to specimen.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Scattered {
    pub(super) unknown: usize,
    /// Place of the logarithm of its standard deviation.
    pub(super) deviation: usize,
    /// Test and place of the value there.
    pub(super) values: Vec<(usize, usize)>,
    /// Standard deviation that is expected at most, as the one of a half-normal distribution (assumed).
    pub(super) expected: f64,
}

impl Layout {
    /// Of a plan in which these unknowns scatter, each with what is expected of it.
    pub(super) fn new(plan: &Plan, scattered: &[(usize, f64)]) -> Layout {
        let mut next = plan.unknowns.len();
        let mut place = || {
            next += 1;
            next - 1
        };
        let scattered = scattered
            .iter()
            .map(|(unknown, expected)| Scattered {
                unknown: *unknown,
                deviation: place(),
                values: plan.sharing(plan.unknowns[*unknown].parameter).map(|test| (test, place())).collect(),
                expected: *expected,
            })
            .collect();
        let share = plan.estimates_share().then(&mut place);
        Layout { unknowns: plan.unknowns.len(), scattered, share }
    }

    /// Number of coordinates.
    pub(super) fn len(&self) -> usize {
        let scattered: usize = self.scattered.iter().map(|own| 1 + own.values.len()).sum();
        self.unknowns + scattered + usize::from(self.share.is_some())
    }

    /// The unknowns as they are in one test.
    pub(super) fn in_test(&self, state: &[f64], test: usize) -> Vec<f64> {
        let mut x = state[..self.unknowns].to_vec();
        for own in &self.scattered {
            if let Some((_, place)) = own.values.iter().find(|(of, _)| *of == test) {
                x[own.unknown] = state[*place];
            }
        }
        x
    }

    /// The model's error of a state.
    pub(super) fn share(&self, state: &[f64], plan: &Plan) -> f64 {
        self.share.map_or_else(|| plan.first_share(), |place| state[place].exp())
    }

    /// The model's errors that states can have.
    pub(super) fn shares(&self, plan: &Plan) -> Shares {
        if self.share.is_some() { Shares::Between(SHARES) } else { Shares::Given(plan.first_share()) }
    }

    /// The unknown whose value in a specimen a coordinate is, where it is one.
    pub(super) fn specimen(&self, place: usize) -> Option<usize> {
        let is_of = |own: &&Scattered| own.values.iter().any(|(_, own)| *own == place);
        self.scattered.iter().find(is_of).map(|own| own.unknown)
    }

    /// What a coordinate is called in results.
    pub(super) fn name(&self, place: usize, plan: &Plan) -> String {
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

/// A posterior on surrogates of the tests.
pub(super) struct Density<'a> {
    pub(super) plan: &'a Plan,
    pub(super) layout: &'a Layout,
    /// The unknowns that act on each test.
    pub(super) acting: &'a [Vec<usize>],
    /// Unknowns of the break strains of each test.
    pub(super) breaks: &'a [BreakUnknowns],
    pub(super) surrogates: &'a [TestSurrogate],
}

impl Density<'_> {
    /// Its logarithm at a state, up to a constant.
    pub(super) fn log(&self, state: &[f64]) -> f64 {
        let before = self.before(state);
        if !before.is_finite() {
            return f64::NEG_INFINITY;
        }
        let share = self.layout.share(state, self.plan);
        let mut sum = before;
        for (test, surrogate) in self.surrogates.iter().enumerate() {
            let x = self.layout.in_test(state, test);
            let own: Vec<f64> = self.acting[test].iter().map(|index| x[*index]).collect();
            let Some(found) = surrogate.predicted(&own) else { return f64::NEG_INFINITY };
            let own = &self.plan.tests[test];
            sum += own.weight * surrogate.log_likelihood(&found, share);
            if let Some(outcomes) = &own.outcomes {
                let breaks = self.breaks[test].with_values(&self.plan.values(&x));
                sum += own.weight * outcomes.log_likelihood(&found.demands, surrogate.demand_errors(), &breaks);
            }
        }
        sum
    }

    /// What is known before the tests.
    fn before(&self, state: &[f64]) -> f64 {
        let unknowns = self.plan.unknowns.iter().zip(state);
        let mut sum: f64 = unknowns.map(|(unknown, x)| self.plan.parameter_of(unknown).log_prior(*x)).sum();
        for own in &self.layout.scattered {
            let logarithm = state[own.deviation];
            let deviation = logarithm.exp();
            // A half-normal distribution of the deviation; the logarithm has its density times the deviation.
            sum += logarithm - 0.5 * (deviation / own.expected).powi(2);
            let ends = self.plan.parameter_of(&self.plan.unknowns[own.unknown]).ends();
            let standard = |x: f64| (x - state[own.unknown]) / deviation;
            // Specimens lie within the bounds, too: what lies beyond them of the normal distribution is shared out.
            let inside = mass_between(standard(ends[0]), standard(ends[1])).ln();
            for (_, place) in &own.values {
                if !(ends[0]..=ends[1]).contains(&state[*place]) {
                    return f64::NEG_INFINITY;
                }
                sum -= 0.5 * standard(state[*place]).powi(2) + logarithm + inside;
            }
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
