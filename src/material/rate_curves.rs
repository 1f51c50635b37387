//! Fibre curves by strain rate (theory.md, equations 140–144).
//!
//! Between the curves σ_i measured at the rates r_i the stress at one strain is interpolated linearly in the logarithm of the rate, and is
//! constant below the lowest and above the highest rate, as explicit codes read tables of curves (LS-DYNA's
//! `*MAT_PIECEWISE_LINEAR_PLASTICITY` with the option `LOG_INTERPOLATION`):
//!
//! ```text
//! σ(ε, r) = σ_i(ε) + s (σ_{i+1}(ε) − σ_i(ε)) ,   s = ln(r/r_i) / ln(r_{i+1}/r_i)
//! ```
//!
//! Rates of single elements are noisy in explicit dynamics, so r is the mean over the growth ℓ of the largest strain ε_m that came last
//! (`rate_memory`), the older the less: its inverse, the slowness p = 1/r, is the time that this growth took,
//!
//! ```text
//! dp/dε_m = (dt/dε_m − p)/λ ,  λ = min(ε_m, ℓ)      p' = (λ p + Δt)/(λ + Δε_m)  in a step
//! ```
//!
//! Below ε_m nothing grows and r is held. A filter over strain in place of time keeps the fibre's tangent bounded: ∂ln r/∂ε = 1/λ however
//! slow the fibre was, where a time constant τ would give 1/(r τ).
//!
//! The work w done while ε_m grew depends on the rates on the way. The state holds its surplus over the energy of the present curve,
//! X = w − W(ε_m, r): zero as long as the rate is constant, so that nothing has to be summed up along a curve. Unloading follows
//!
//! ```text
//! σ_u(ε) = σ(ε_m − β (ε_m − ε), r) ,   β = max( 1/(1 − D), W(ε_m, r)/w )
//! ```
//!
//! and returns W/β: the share 1 − D of the curve's energy, but never more than was put in.

use serde::{Deserialize, Serialize};
use thiserror::Error;

use super::fibre::FibreLaw;
use super::history::FibreHistory;
use super::{Absorption, Curve};
use crate::lane::{Lane, larger, ln, smaller, splat};

/// Curves of one fibre set by strain rate.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RateCurves {
    /// At the lowest rate and below.
    slowest: Curve,
    /// From each rate to the next.
    steps: Vec<Step>,
    /// 1/r at the highest and the lowest rate, s.
    slowness: [f64; 2],
    /// ℓ.
    memory: f64,
    /// Largest break strain of all curves.
    longest: f64,
}

/// From the curve of one rate to that of the next.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Step {
    /// Logarithm of the lower rate (1/s).
    log: f64,
    /// 1/ln(r_{i+1}/r_i).
    per_log: f64,
    /// The curve of the higher rate.
    curve: Curve,
    /// Corners of the difference of both curves, from the origin on: strain, σ_{i+1} − σ_i (Pa).
    gap: Vec<[f64; 2]>,
    /// Largest |σ_{i+1} − σ_i|/ε up to the strain ℓ, Pa.
    secant: f64,
    /// Largest ratio of the stress on this or a slower curve to that on any curve at the same strain: bounds W(ε_m, r)/w.
    contrast: f64,
}

/// What such fibres remember.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RateHistory<const L: usize> {
    /// Largest engineering strain so far, ε_m.
    peak: Lane<L>,
    /// Time that the last growth of ε_m took, over the growth, p = 1/r, s.
    slowness: Lane<L>,
    /// Work done over the energy of the present curve, X, J/m³.
    surplus: Lane<L>,
}

/// Why curves are no curves by rate.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum RateCurvesError {
    #[error("there is no curve")]
    Empty,
    #[error("rate {index} is not a number above zero: {rate} 1/s")]
    NoRate { index: usize, rate: f64 },
    #[error("the rates do not increase: {rate} 1/s after {previous} 1/s")]
    RateNotIncreasing { index: usize, rate: f64, previous: f64 },
    #[error(
        "curve {index} has no stress at first, so no share of the energy that other rates put in can come back along it"
    )]
    Slack { index: usize },
    #[error("the memory of the rate is not a strain above zero: {memory}")]
    NoMemory { memory: f64 },
}

impl RateCurves {
    /// `curves` at their rates (1/s), lowest first; `memory` is the strain ℓ over which the rate is averaged.
    ///
    /// # Errors
    /// [`RateCurvesError`] where the rates are none or do not increase, or a curve among several begins without slope.
    pub fn new(curves: Vec<(f64, Curve)>, memory: f64) -> Result<RateCurves, RateCurvesError> {
        if !(memory > 0.0 && memory.is_finite()) {
            return Err(RateCurvesError::NoMemory { memory });
        }
        check(&curves)?;
        let (Some((lowest, slowest)), Some((highest, _))) = (curves.first(), curves.last()) else {
            return Err(RateCurvesError::Empty);
        };
        let longest = curves.iter().map(|(_, curve)| curve.end()).fold(0.0, f64::max);
        let slowness = [1.0 / highest, 1.0 / lowest];
        let all: Vec<&Curve> = curves.iter().map(|(_, curve)| curve).collect();
        let step = |index: usize| {
            let ((from, lower), (to, upper)) = (&curves[index], &curves[index + 1]);
            let log = ln(*from);
            let gap = gap(lower, upper, longest);
            let secant = secant(&gap, memory);
            let contrast = contrast(&all[..index + 2], &all, longest);
            Step { log, per_log: 1.0 / (ln(*to) - log), curve: upper.clone(), gap, secant, contrast }
        };
        let steps = (0..curves.len() - 1).map(step).collect();
        Ok(RateCurves { slowest: slowest.clone(), steps, slowness, memory, longest })
    }

    /// Lowest and highest rate (1/s), where there are several curves.
    pub fn range(&self) -> Option<[f64; 2]> {
        (!self.steps.is_empty()).then(|| [1.0 / self.slowness[1], 1.0 / self.slowness[0]])
    }

    /// The curve at all rates, where there is one only.
    pub fn single(&self) -> Option<&Curve> {
        self.steps.is_empty().then_some(&self.slowest)
    }

    /// Stress (Pa) at `strain` when it is reached at the constant `rate` (1/s).
    pub fn stress_at(&self, strain: f64, rate: f64) -> f64 {
        self.mix(&self.log_rate(&[1.0 / rate]), |curve| curve.stress_lanes(&[strain]))[0]
    }

    /// Strain at which fibres break that are strained at the constant `rate` (1/s).
    pub fn break_strain_at(&self, rate: f64) -> f64 {
        self.mix(&self.log_rate(&[1.0 / rate]), |curve| [curve.end()])[0]
    }

    /// Logarithm of the rate (1/s) within those of the curves.
    #[inline(always)]
    fn log_rate<const L: usize>(&self, slowness: &Lane<L>) -> Lane<L> {
        let [shortest, longest] = self.slowness;
        slowness.map(|p| -ln(smaller(larger(p, shortest), longest)))
    }

    /// What each curve has, interpolated at `log_rate`; exactly that of one curve where all have the same.
    #[inline(always)]
    fn mix<const L: usize>(&self, log_rate: &Lane<L>, of: impl Fn(&Curve) -> Lane<L>) -> Lane<L> {
        let mut below = of(&self.slowest);
        let mut mixed = below;
        for step in &self.steps {
            let above = of(&step.curve);
            for l in 0..L {
                mixed[l] += step.share(log_rate[l]) * (above[l] - below[l]);
            }
            below = above;
        }
        mixed
    }

    /// By how much the energy of the curve at one strain changes from one rate to another, J/m³.
    #[inline(always)]
    fn gained<const L: usize>(&self, before: &Lane<L>, after: &Lane<L>, strain: &Lane<L>) -> Lane<L> {
        let mut below = self.slowest.read(strain).energy;
        let mut gained = splat(0.0);
        for step in &self.steps {
            let above = step.curve.read(strain).energy;
            for l in 0..L {
                gained[l] += (step.share(after[l]) - step.share(before[l])) * (above[l] - below[l]);
            }
            below = above;
        }
        gained
    }

    /// Lets the largest strain grow to `strain` within `dt` (s).
    #[inline(always)]
    fn grow<const L: usize>(&self, strain: &Lane<L>, history: &mut RateHistory<L>, dt: f64) {
        // Film on its way back spends no time here.
        if (0..L).all(|l| strain[l] <= history.peak[l]) {
            return;
        }
        let old = *history;
        let mut first = splat::<L>(0.0);
        for l in 0..L {
            let growth = strain[l] - old.peak[l];
            // Film is mounted as slowly as it was ever measured.
            let time = if dt > 0.0 { dt } else { growth * self.slowness[1] };
            let length = smaller(old.peak[l], self.memory);
            let slowness = (length * old.slowness[l] + time) / (length + growth);
            history.slowness[l] = if growth > 0.0 { slowness } else { old.slowness[l] };
            history.peak[l] = larger(strain[l], old.peak[l]);
            first[l] = if length > 0.0 { old.slowness[l] } else { history.slowness[l] };
        }
        let (before, after) = (self.log_rate(&first), self.log_rate(&history.slowness));
        let [gained_first, gained_last] =
            [self.gained(&before, &after, &old.peak), self.gained(&before, &after, &history.peak)];
        for l in 0..L {
            history.surplus[l] -= 0.5 * (gained_first[l] + gained_last[l]);
        }
    }

    /// Energy of the present curve up to the largest strain, W(ε_m, r).
    #[inline(always)]
    fn enclosed<const L: usize>(&self, log_rate: &Lane<L>, history: &RateHistory<L>) -> Lane<L> {
        self.mix(log_rate, |curve| curve.read(&history.peak).energy)
    }

    /// Where on the present curve fibres at `strain` stand: ε_m − β(ε_m − ε).
    #[inline(always)]
    fn place<const L: usize>(
        absorption: &Absorption,
        strain: &Lane<L>,
        history: &RateHistory<L>,
        enclosed: &Lane<L>,
    ) -> Lane<L> {
        let mut place = splat(0.0);
        for l in 0..L {
            let steepening = larger(enclosed[l] / (enclosed[l] + history.surplus[l]), absorption.steepening());
            place[l] = history.peak[l] - (history.peak[l] - strain[l]) * steepening;
        }
        place
    }

    /// Stress at `strain`, which is not above the largest so far.
    #[inline(always)]
    fn stress_below<const L: usize>(
        &self,
        absorption: &Absorption,
        strain: &Lane<L>,
        history: &RateHistory<L>,
    ) -> Lane<L> {
        let log_rate = self.log_rate(&history.slowness);
        let place = RateCurves::place(absorption, strain, history, &self.enclosed(&log_rate, history));
        self.mix(&log_rate, |curve| curve.stress_lanes(&place))
    }
}

/// One curve at all rates.
impl From<Curve> for RateCurves {
    fn from(curve: Curve) -> RateCurves {
        let longest = curve.end();
        RateCurves { slowest: curve, steps: vec![], slowness: [1.0; 2], memory: 1.0, longest }
    }
}

impl Step {
    /// s between the two rates, 0 below and 1 above them.
    #[inline(always)]
    fn share(&self, log_rate: f64) -> f64 {
        smaller(larger((log_rate - self.log) * self.per_log, 0.0), 1.0)
    }

    /// Bound on |∂σ/∂r · ∂r/∂ε| (Pa) for a strain that grows from `from` to `to` (theory.md, equation 142).
    #[inline(always)]
    fn hardening<const L: usize>(&self, from: &Lane<L>, to: &Lane<L>, memory: f64) -> Lane<L> {
        let mut largest = splat::<L>(0.0);
        for piece in self.gap.windows(2) {
            let [[start, first], [end, last]] = [piece[0], piece[1]];
            let slope = (last - first) / (end - start);
            for l in 0..L {
                let (a, b) = (larger(from[l], start), smaller(to[l], end));
                let at = |strain: f64| (first + slope * (strain - start)).abs();
                let inside = larger(at(a), at(b));
                largest[l] = if a <= b { larger(inside, largest[l]) } else { largest[l] };
            }
        }
        let mut bound = splat(0.0);
        for l in 0..L {
            let early = if from[l] < memory { self.secant } else { 0.0 };
            let hardening = self.per_log * larger(early, largest[l] / memory);
            bound[l] = if to[l] >= from[l] { hardening } else { 0.0 };
        }
        bound
    }
}

impl FibreLaw for RateCurves {
    type History<const L: usize> = RateHistory<L>;

    #[inline(always)]
    fn stress<const L: usize>(
        &self,
        absorption: &Absorption,
        strain: &Lane<L>,
        history: &mut RateHistory<L>,
        dt: f64,
    ) -> Lane<L> {
        self.grow(strain, history, dt);
        self.stress_below(absorption, strain, history)
    }

    #[inline(always)]
    fn stress_near<const L: usize>(
        &self,
        absorption: &Absorption,
        strain: &Lane<L>,
        history: &RateHistory<L>,
    ) -> Lane<L> {
        let mut raised = *history;
        for l in 0..L {
            raised.peak[l] = larger(strain[l], history.peak[l]);
        }
        self.stress_below(absorption, strain, &raised)
    }

    #[inline(always)]
    fn energy<const L: usize>(
        &self,
        absorption: &Absorption,
        strain: &Lane<L>,
        history: &RateHistory<L>,
    ) -> (Lane<L>, Lane<L>) {
        let log_rate = self.log_rate(&history.slowness);
        let enclosed = self.enclosed(&log_rate, history);
        let place = RateCurves::place(absorption, strain, history, &enclosed);
        let mut stored = self.mix(&log_rate, |curve| curve.read(&place).energy);
        let mut absorbed = splat(0.0);
        for l in 0..L {
            let returned = smaller((enclosed[l] + history.surplus[l]) / enclosed[l], 1.0 - absorption.share());
            stored[l] *= returned;
            absorbed[l] = history.surplus[l] + (1.0 - returned) * enclosed[l];
        }
        (stored, absorbed)
    }

    #[inline(always)]
    fn steepest<const L: usize>(
        &self,
        absorption: &Absorption,
        strain: &Lane<L>,
        history: &RateHistory<L>,
        reach: f64,
    ) -> Lane<L> {
        let log_rate = self.log_rate(&history.slowness);
        // The rate grows by the factor e within λ at most, and from nothing to any rate.
        let mut fastest = splat::<L>(0.0);
        for l in 0..L {
            fastest[l] = log_rate[l] + reach / smaller(history.peak[l], self.memory);
        }
        let mut steepening = splat::<L>(absorption.steepening());
        for step in &self.steps {
            for l in 0..L {
                steepening[l] =
                    if step.log < fastest[l] { larger(step.contrast, steepening[l]) } else { steepening[l] };
            }
        }
        let (mut from, mut to, mut most) = (splat::<L>(0.0), splat::<L>(0.0), splat::<L>(0.0));
        for l in 0..L {
            let below = history.peak[l] - strain[l];
            let places =
                [absorption.steepening(), steepening[l]].map(|steepening| history.peak[l] - below * steepening);
            from[l] = smaller(places[0], places[1]) - reach * steepening[l];
            to[l] = larger(places[0], places[1]) + reach * steepening[l];
            most[l] = strain[l] + reach;
        }
        let mut slope = self.slowest.steepest(&from, &to);
        let mut hardening = splat::<L>(0.0);
        for step in &self.steps {
            let own = step.curve.steepest(&from, &to);
            let rising = step.hardening(&history.peak, &most, self.memory);
            for l in 0..L {
                let touched = step.log < fastest[l];
                slope[l] = if touched { larger(own[l], slope[l]) } else { slope[l] };
                hardening[l] = if touched { larger(rising[l], hardening[l]) } else { hardening[l] };
            }
        }
        for l in 0..L {
            slope[l] = if to[l] < 0.0 { 0.0 } else { steepening[l] * slope[l] + hardening[l] };
        }
        slope
    }

    fn initial_slope(&self) -> f64 {
        self.slowest.initial_slope()
    }

    #[inline(always)]
    fn break_strain<const L: usize>(&self, history: &RateHistory<L>) -> Lane<L> {
        self.mix(&self.log_rate(&history.slowness), |curve| splat(curve.end()))
    }

    fn break_strains(&self) -> [f64; 2] {
        [self.slowest.end(), self.longest]
    }
}

impl<const L: usize> FibreHistory<L> for RateHistory<L> {
    fn virgin() -> Self {
        RateHistory { peak: splat(0.0), slowness: splat(0.0), surplus: splat(0.0) }
    }

    #[inline(always)]
    fn peak(&self) -> &Lane<L> {
        &self.peak
    }

    fn variables(&self) -> impl Iterator<Item = &Lane<L>> {
        [&self.peak, &self.slowness, &self.surplus].into_iter()
    }

    fn variables_mut(&mut self) -> impl Iterator<Item = &mut Lane<L>> {
        [&mut self.peak, &mut self.slowness, &mut self.surplus].into_iter()
    }
}

fn check(curves: &[(f64, Curve)]) -> Result<(), RateCurvesError> {
    let mut previous = 0.0;
    for (index, (rate, curve)) in curves.iter().enumerate() {
        if !(*rate > 0.0 && rate.is_finite()) {
            return Err(RateCurvesError::NoRate { index, rate: *rate });
        }
        if *rate <= previous {
            return Err(RateCurvesError::RateNotIncreasing { index, rate: *rate, previous });
        }
        if curves.len() > 1 && curve.initial_slope() == 0.0 {
            return Err(RateCurvesError::Slack { index });
        }
        previous = *rate;
    }
    Ok(())
}

/// Strains of the corners of all `curves` up to `end`, which is the last, without the origin.
fn corners(curves: &[&Curve], end: f64) -> Vec<f64> {
    let points = curves.iter().flat_map(|curve| curve.points());
    let mut strains: Vec<f64> = points.map(|point| point[0]).filter(|strain| *strain <= end).chain([end]).collect();
    strains.sort_by(f64::total_cmp);
    strains.dedup();
    strains
}

/// Corners of the difference of two curves: strain, stress (Pa).
fn gap(lower: &Curve, upper: &Curve, end: f64) -> Vec<[f64; 2]> {
    let difference = |strain: f64| [strain, upper.stress(strain) - lower.stress(strain)];
    std::iter::once(0.0).chain(corners(&[lower, upper], end)).map(difference).collect()
}

/// Largest |difference| over strain up to the strain `memory`: on a straight piece it is at one of the ends.
fn secant(gap: &[[f64; 2]], memory: f64) -> f64 {
    let mut largest = 0.0_f64;
    for piece in gap.windows(2) {
        let [[start, first], [end, last]] = [piece[0], piece[1]];
        if start >= memory {
            break;
        }
        let slope = (last - first) / (end - start);
        let until = end.min(memory);
        let at_start = if start == 0.0 { slope } else { first / start };
        largest = largest.max(at_start.abs()).max(((first + slope * (until - start)) / until).abs());
    }
    largest
}

/// Largest ratio of the stress on one of `some` curves to that on one of `all` at the same strain up to `end`: on straight pieces, at a corner.
fn contrast(some: &[&Curve], all: &[&Curve], end: f64) -> f64 {
    let ratio = |of: &dyn Fn(&Curve) -> f64| {
        let most = some.iter().map(|curve| of(curve)).fold(0.0, f64::max);
        let least = all.iter().map(|curve| of(curve)).fold(f64::INFINITY, f64::min);
        most / least
    };
    let at_corners = corners(all, end).into_iter().map(|strain| ratio(&|curve| curve.stress(strain)));
    at_corners.fold(ratio(&Curve::initial_slope), f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    const MEMORY: f64 = 0.01;
    const RATES: [f64; 3] = [0.04, 4.0, 100.0];

    fn curves() -> [Curve; 3] {
        [
            Curve::new(vec![[0.26, 8.4e6], [0.84, 20e6], [1.39, 29.3e6]]).unwrap(),
            // Softer at first: curves may cross.
            Curve::new(vec![[0.36, 8.4e6], [0.84, 24e6], [1.2, 29e6]]).unwrap(),
            Curve::new(vec![[0.03, 8.4e6], [0.2, 20e6], [0.75, 29e6]]).unwrap(),
        ]
    }

    fn family() -> RateCurves {
        RateCurves::new(RATES.into_iter().zip(curves()).collect(), MEMORY).unwrap()
    }

    /// A fibre set and what was done to it.
    struct Pulled {
        law: RateCurves,
        absorption: Absorption,
        history: RateHistory<1>,
        strain: f64,
        stress: f64,
        /// By the trapezoid rule from the stresses alone, J/m³.
        work: f64,
    }

    impl Pulled {
        fn new(law: RateCurves, share: f64) -> Pulled {
            let (absorption, history) = (Absorption::new(share), RateHistory::virgin());
            Pulled { law, absorption, history, strain: 0.0, stress: 0.0, work: 0.0 }
        }

        /// Goes to `strain` at `rate` (1/s) in steps of 10⁻⁵.
        fn to(&mut self, strain: f64, rate: f64) {
            let steps = ((strain - self.strain).abs() / 1e-5).ceil();
            let (from, step) = (self.strain, (strain - self.strain) / steps);
            for k in 1..=steps as usize {
                self.at(from + k as f64 * step, step.abs() / rate);
            }
        }

        fn at(&mut self, strain: f64, dt: f64) {
            let stress = self.law.stress(&self.absorption, &[strain], &mut self.history, dt)[0];
            self.work += 0.5 * (self.stress + stress) * (strain - self.strain);
            (self.strain, self.stress) = (strain, stress);
        }

        fn energy(&self) -> [f64; 2] {
            let (stored, absorbed) = self.law.energy(&self.absorption, &[self.strain], &self.history);
            [stored[0], absorbed[0]]
        }
    }

    #[test]
    fn reads_each_curve_at_its_rate_and_between_in_the_logarithm() {
        let [slow, middle, fast] = curves();
        for strain in [0.01, 0.2, 0.5, 0.9] {
            let expected = [
                (0.001, slow.stress(strain)),
                (0.04, slow.stress(strain)),
                (0.4, 0.5 * (slow.stress(strain) + middle.stress(strain))),
                (4.0, middle.stress(strain)),
                (20.0, 0.5 * (middle.stress(strain) + fast.stress(strain))),
                (100.0, fast.stress(strain)),
                (1e4, fast.stress(strain)),
            ];
            for (rate, stress) in expected {
                let mut pulled = Pulled::new(family(), 0.9);
                pulled.to(strain, rate);
                assert!(
                    (pulled.stress / stress - 1.0).abs() < 1e-9,
                    "{strain} at {rate}: {} for {stress}",
                    pulled.stress
                );
                assert!((family().stress_at(strain, rate) / stress - 1.0).abs() < 1e-12);
            }
        }
        assert!((family().break_strain_at(0.4) - 0.5 * (1.39 + 1.2)).abs() < 1e-12);
    }

    #[test]
    fn the_rate_is_a_mean_over_the_last_growth_and_is_held_below_it() {
        let mut pulled = Pulled::new(family(), 0.5);
        pulled.to(0.1, 1.0);
        let rate = |pulled: &Pulled| 1.0 / pulled.history.slowness[0];
        assert!((rate(&pulled) - 1.0).abs() < 1e-9);
        let held = pulled.history;
        pulled.to(0.05, 300.0);
        pulled.to(0.0999, 0.01);
        assert_eq!(pulled.history, held);
        // 1/r goes to the new slowness as e^(−growth/ℓ).
        pulled.to(0.1, 10.0);
        pulled.to(0.11, 10.0);
        let expected = 0.1 + 0.9 * (-1.0_f64).exp();
        assert!((1.0 / rate(&pulled) - expected).abs() < 1e-3, "{}", 1.0 / rate(&pulled));
    }

    #[test]
    fn mounting_is_slow() {
        let mut pulled = Pulled::new(family(), 0.9);
        pulled.at(0.1, 0.0);
        assert!((pulled.stress / curves()[0].stress(0.1) - 1.0).abs() < 1e-12);
        let [stored, absorbed] = pulled.energy();
        assert!(((stored + absorbed) / curves()[0].energy(0.1) - 1.0).abs() < 1e-12);
    }

    /// Equal curves are one curve: the same bits of stress and slope, and the same energy.
    #[test]
    fn equal_curves_are_one() {
        let curve = &curves()[2];
        let same = RateCurves::new(RATES.map(|rate| (rate, curve.clone())).to_vec(), MEMORY).unwrap();
        let absorption = Absorption::new(0.8896);
        let (mut history, mut peak) = (RateHistory::virgin(), [0.0]);
        for (strain, dt) in
            [(0.1, 0.0), (0.11, 1e-3), (0.1, 1e-3), (0.3, 1e-2), (0.2999, 1e-4), (0.5, 1e-3), (-0.1, 1.0)]
        {
            let strain = [strain];
            let found = same.stress(&absorption, &strain, &mut history, dt);
            assert_eq!(found, absorption.stress(curve, &strain, &mut peak));
            assert_eq!(
                same.steepest(&absorption, &strain, &history, 0.005),
                absorption.steepest(curve, &strain, &peak, 0.005)
            );
            assert_eq!(same.break_strain(&history), [curve.end()]);
            let (stored, absorbed) = same.energy(&absorption, &strain, &history);
            let expected = absorption.energy(curve, &strain, &peak);
            assert!((stored[0] - expected.0[0]).abs() <= 1e-12 * expected.1[0].max(1.0));
            assert!((absorbed[0] - expected.1[0]).abs() <= 1e-12 * expected.1[0].max(1.0));
        }
    }

    /// Rates of three decades, jumping and creeping: the energy is the work all the time.
    #[test]
    fn the_energy_is_the_work() {
        for share in [0.0, 0.3, 0.8896] {
            let mut pulled = Pulled::new(family(), share);
            let mut largest = 0.0_f64;
            for (strain, rate) in [
                (0.05, 200.0),
                (0.1, 0.02),
                (0.12, 50.0),
                (0.06, 1.0),
                (0.3, 5.0),
                (0.1, 9.0),
                (0.5, 0.5),
                (0.7, 80.0),
                (0.0, 3.0),
            ] {
                pulled.to(strain, rate);
                largest = largest.max(pulled.work);
                let [stored, absorbed] = pulled.energy();
                let error = (stored + absorbed - pulled.work).abs() / largest;
                assert!(error < 1e-6, "D {share}, at {strain}: {error}");
                assert!(stored >= 0.0 && absorbed >= -1e-9 * largest, "D {share}, at {strain}: {stored}, {absorbed}");
            }
        }
    }

    /// Unloading returns 1 − D of the curve of the rate at its peak, or all that was put in where that is less.
    #[test]
    fn unloading_returns_its_share_and_never_more_than_was_put_in() {
        for share in [0.0, 0.3, 0.8896] {
            for (slow, fast) in [(2.0, 2.0), (0.04, 100.0), (100.0, 0.04)] {
                let mut pulled = Pulled::new(family(), share);
                pulled.to(0.2, slow);
                pulled.to(0.3, fast);
                let rate = 1.0 / pulled.history.slowness[0];
                let log_rate = pulled.law.log_rate(&[1.0 / rate]);
                let (given, curve) = (pulled.work, pulled.law.enclosed(&log_rate, &pulled.history)[0]);
                pulled.to(0.0, 1.0);
                let returned = given - pulled.work;
                let expected = ((1.0 - share) * curve).min(given);
                assert!(
                    (returned - expected).abs() < 1e-4 * given,
                    "D {share}, {slow} to {fast}: {returned} for {expected}"
                );
            }
        }
    }

    /// The bound on the slope holds for every step within reach, at any speed, up and down.
    #[test]
    fn the_slope_is_bounded_at_any_rate() {
        const REACH: f64 = 0.005;
        for share in [0.0, 0.5, 0.8896] {
            for (before, until) in [(0.001, 0.004), (0.04, 0.02), (0.5, 0.1), (30.0, 0.3), (1000.0, 0.6), (0.04, 0.8)] {
                let mut pulled = Pulled::new(family(), share);
                pulled.to(until, before);
                for back in [0.0, 0.002, 0.01] {
                    pulled.to(until - back, 1.0);
                    let bound = pulled.law.steepest(&pulled.absorption, &[pulled.strain], &pulled.history, REACH)[0];
                    for rate in [1e-3, 0.1, 7.0, 69.0, 1e4] {
                        for sign in [1.0, -1.0] {
                            let mut moved = Pulled { law: pulled.law.clone(), ..pulled };
                            let (step, start) = (1e-5, moved.strain);
                            for k in 1..=(REACH / step) as usize {
                                // ∂σ/∂ε of this step: two strains that it may go to in the same time.
                                let strain = start + sign * step * (k as f64 - 0.5);
                                let at = |strain: f64| {
                                    let mut history = moved.history;
                                    moved.law.stress(&moved.absorption, &[strain], &mut history, step / rate)[0]
                                };
                                let slope = (at(strain + 1e-8) - at(strain - 1e-8)) / 2e-8;
                                assert!(
                                    slope <= bound * (1.0 + 1e-6) + 1.0,
                                    "D {share}, {before} then {rate}: {slope} over {bound}"
                                );
                                moved.at(strain, step / rate);
                            }
                        }
                    }
                }
            }
        }
    }

    /// Time counts from where growth begins: the stress steps by no more than its slope gives over the strain of such a time.
    #[test]
    fn growth_that_begins_slowly_steps_within_the_slope() {
        for until in [0.002, 0.1, 0.5] {
            for rate in [0.1, 7.0, 1000.0] {
                let mut pulled = Pulled::new(family(), 0.9);
                pulled.to(until, rate);
                let bound = pulled.law.steepest(&pulled.absorption, &[until], &pulled.history, 0.005)[0];
                for dt in [1e-6, 5e-5] {
                    let stress =
                        pulled.law.stress(&pulled.absorption, &[until + 1e-12], &mut pulled.history.clone(), dt)[0];
                    let step = (stress - pulled.stress).abs();
                    assert!(step <= bound * rate * dt + 1.0, "{until} at {rate}, {dt} s: {step}");
                }
            }
        }
    }

    #[test]
    fn refuses_what_are_no_curves_by_rate() {
        let [slow, _, fast] = curves();
        let late = Curve::new(vec![[0.1, 0.0], [0.2, 1e6]]).unwrap();
        let cases = [
            (vec![], MEMORY, RateCurvesError::Empty),
            (vec![(0.0, slow.clone())], MEMORY, RateCurvesError::NoRate { index: 0, rate: 0.0 }),
            (
                vec![(4.0, slow.clone()), (4.0, fast.clone())],
                MEMORY,
                RateCurvesError::RateNotIncreasing { index: 1, rate: 4.0, previous: 4.0 },
            ),
            (vec![(4.0, slow.clone()), (5.0, late)], MEMORY, RateCurvesError::Slack { index: 1 }),
            (vec![(4.0, slow), (5.0, fast)], 0.0, RateCurvesError::NoMemory { memory: 0.0 }),
        ];
        for (curves, memory, error) in cases {
            assert_eq!(RateCurves::new(curves, memory), Err(error));
        }
    }
}
