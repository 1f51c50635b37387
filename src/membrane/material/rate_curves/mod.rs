//! Fibre curves by strain rate (theory.md, equations 140–144).
//!
//! Between the curves σ_i measured at the rates r_i the stress at one strain is interpolated linearly in the logarithm
//! of the rate, and is constant below the lowest and above the highest rate, as explicit codes read tables of curves
//! (LS-DYNA's `*MAT_PIECEWISE_LINEAR_PLASTICITY` with the option `LOG_INTERPOLATION`):
//!
//! ```text
//! σ(ε, r) = σ_i(ε) + s (σ_{i+1}(ε) − σ_i(ε)) ,   s = ln(r/r_i) / ln(r_{i+1}/r_i)
//! ```
//!
//! Rates of single elements are noisy in explicit dynamics, so r is a weighted mean over the last growth ℓ of the
//! largest strain ε_m (`rate_memory`): its inverse, the slowness p = 1/r, is the time per growth,
//!
//! ```text
//! dp/dε_m = (dt/dε_m − p)/λ ,  λ = min(ε_m, ℓ)      p' = (λ p + Δt)/(λ + Δε_m)  in a step
//! ```
//!
//! Below ε_m the rate is constant. A filter over strain bounds the tangent of the fibre at any rate, ∂ln r/∂ε = 1/λ,
//! where one over time with the constant τ would give 1/(r τ).
//!
//! The work w done while ε_m grew depends on the history of the rate. The history variables include its surplus over
//! the energy of the present curve, X = w − W(ε_m, r): zero at a constant rate, so that no sum runs along a curve.
//! Unloading follows
//!
//! ```text
//! σ_u(ε) = σ(ε_m − β (ε_m − ε), r) ,   β = max( 1/(1 − D), W(ε_m, r)/w )
//! ```
//!
//! and returns W/β: the share 1 − D of the curve's energy, at most the work done.

mod law;
#[cfg(test)]
mod tests;

use serde::{Deserialize, Serialize};
use thiserror::Error;

use super::Curve;
use super::history::FibreHistory;
use super::log_interval::LogInterval;
use crate::lane::{Lane, ln, one, splat};

/// Curves of one fibre set by strain rate.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RateCurves {
    /// At the lowest rate and below.
    slowest: Curve,
    /// From each rate to the next.
    intervals: Vec<RateInterval>,
    /// The lowest rate, 1/s.
    lowest: f64,
    /// 1/r at the highest and the lowest rate, s.
    slowness: [f64; 2],
    /// The growth ℓ over which the rate is averaged.
    averaging_strain: f64,
    /// Largest break strain of all curves.
    longest: f64,
}

/// History variables of one fibre set, one integration point a lane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RateHistory<const L: usize> {
    /// Largest engineering strain so far, ε_m.
    peak: Lane<L>,
    /// Mean time per growth of ε_m, p = 1/r, s.
    slowness: Lane<L>,
    /// Work done over the energy of the present curve, X, J/m³.
    surplus: Lane<L>,
}

impl<const L: usize> FibreHistory<L> for RateHistory<L> {
    fn virgin() -> Self {
        RateHistory { peak: splat(0.0), slowness: splat(0.0), surplus: splat(0.0) }
    }

    #[inline(always)]
    fn peak(&self) -> &Lane<L> {
        &self.peak
    }

    fn variables(&mut self) -> impl Iterator<Item = &mut Lane<L>> {
        [&mut self.peak, &mut self.slowness, &mut self.surplus].into_iter()
    }
}

/// Why curves cannot be used by strain rate.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum RateCurvesError {
    /// There is no curve.
    #[error("there is no curve")]
    Empty,
    /// A rate is not positive or not finite.
    #[error("expected a rate above zero for curve {index}, found {rate} 1/s")]
    InvalidRate {
        /// Index of the curve.
        index: usize,
        /// Its rate, 1/s.
        rate: f64,
    },
    /// A rate is not above the one before.
    #[error("the rates do not increase: {rate} 1/s after {previous} 1/s")]
    RateNotIncreasing {
        /// Index of the curve.
        index: usize,
        /// Its rate, 1/s.
        rate: f64,
        /// Rate of the curve before, 1/s.
        previous: f64,
    },
    /// One of several curves begins without slope.
    #[error("curve {index} has no initial slope, so energy stored at other rates cannot be returned along it")]
    NoInitialSlope {
        /// Index of the curve.
        index: usize,
    },
    /// The strain over which the rate is averaged is not positive or not finite.
    #[error("expected an averaging strain above zero, found {strain}")]
    InvalidAveragingStrain {
        /// The strain.
        strain: f64,
    },
}

/// The `$value` of the curves of a law, interpolated at a logarithm of the rate; exactly that of one curve where all have the
/// same. Not a function with a closure, which would be compiled apart, without the kernel's vector instructions.
macro_rules! mix {
    ($law:expr, $log_rate:expr, $curve:ident => $value:expr) => {{
        let (law, log_rate) = ($law, $log_rate);
        let $curve = &law.slowest;
        let mut below = $value;
        let mut mixed = below;
        for interval in &law.intervals {
            let $curve = &interval.curve;
            let above = $value;
            mixed += interval.weight(log_rate) * (above - below);
            below = above;
        }
        mixed
    }};
}
use mix;

impl RateCurves {
    /// `curves` at their rates (1/s), lowest first; `averaging_strain` is the growth ℓ over which the rate is averaged.
    ///
    /// # Errors
    /// [`RateCurvesError`] where there is no curve, a rate is not positive or not above the one before,
    /// `averaging_strain` is not positive, or one of several curves begins without slope.
    pub fn new(curves: Vec<(f64, Curve)>, averaging_strain: f64) -> Result<RateCurves, RateCurvesError> {
        if !(averaging_strain > 0.0 && averaging_strain.is_finite()) {
            return Err(RateCurvesError::InvalidAveragingStrain { strain: averaging_strain });
        }
        check(&curves)?;
        if curves.is_empty() {
            return Err(RateCurvesError::Empty);
        }
        Ok(RateCurves::assembled(curves, averaging_strain))
    }

    /// Curves, one at least, that were checked.
    fn assembled(curves: Vec<(f64, Curve)>, averaging_strain: f64) -> RateCurves {
        let ((lowest, slowest), (highest, _)) = (&curves[0], &curves[curves.len() - 1]);
        let longest = curves.iter().map(|(_, curve)| curve.end()).fold(0.0, f64::max);
        let slowness = [1.0 / highest, 1.0 / lowest];
        let interval = |index| RateInterval::new(&curves, index, averaging_strain, longest);
        let intervals = (0..curves.len() - 1).map(interval).collect();
        RateCurves { slowest: slowest.clone(), intervals, lowest: *lowest, slowness, averaging_strain, longest }
    }

    /// The rates of the curves, 1/s; none where there is only one.
    fn rates(&self) -> impl Iterator<Item = f64> {
        let lowest = self.range().map(|[lowest, _]| lowest);
        lowest.into_iter().chain(self.intervals.iter().map(|interval| interval.upper))
    }

    /// All curves at their rates (1/s), lowest first.
    pub fn curves(&self) -> Vec<(f64, Curve)> {
        let others = self.intervals.iter().map(|interval| (interval.upper, interval.curve.clone()));
        std::iter::once((self.lowest, self.slowest.clone())).chain(others).collect()
    }

    /// The curve at the constant `rate` (1/s).
    pub fn curve_at(&self, rate: f64) -> Curve {
        let log_rate = one(ln(rate));
        let mut curve = self.slowest.clone();
        for interval in &self.intervals {
            let share = interval.weight(log_rate)[0];
            if share > 0.0 {
                curve = Curve::weighted(&curve, &interval.curve, [1.0 - share, share]);
            }
        }
        curve
    }

    /// Lowest and highest rate (1/s), where there are several.
    pub fn range(&self) -> Option<[f64; 2]> {
        (!self.intervals.is_empty()).then(|| [self.lowest, 1.0 / self.slowness[0]])
    }

    /// The curve, where there is only one.
    pub fn single(&self) -> Option<&Curve> {
        self.intervals.is_empty().then_some(&self.slowest)
    }

    /// Stress (Pa) at `strain`, reached at the constant `rate` (1/s).
    pub fn stress_at(&self, strain: f64, rate: f64) -> f64 {
        mix!(self, self.log_rate(one(1.0 / rate)), curve => curve.stress_lanes(one(strain)))[0]
    }

    /// Logarithm of the rate (1/s) within those of the curves.
    #[inline(always)]
    fn log_rate<const L: usize>(&self, slowness: Lane<L>) -> Lane<L> {
        let [shortest, longest] = self.slowness;
        -slowness.max(shortest).min(longest).ln()
    }
}

/// One curve at all rates.
impl From<Curve> for RateCurves {
    fn from(curve: Curve) -> RateCurves {
        let longest = curve.end();
        RateCurves {
            slowest: curve,
            intervals: vec![],
            lowest: 1.0,
            slowness: [1.0; 2],
            averaging_strain: 1.0,
            longest,
        }
    }
}

/// Refuses rates that do not increase and curves without initial slope.
fn check(curves: &[(f64, Curve)]) -> Result<(), RateCurvesError> {
    let mut previous = 0.0;
    for (index, (rate, curve)) in curves.iter().enumerate() {
        if !(*rate > 0.0 && rate.is_finite()) {
            return Err(RateCurvesError::InvalidRate { index, rate: *rate });
        }
        if *rate <= previous {
            return Err(RateCurvesError::RateNotIncreasing { index, rate: *rate, previous });
        }
        if curves.len() > 1 && curve.initial_slope() == 0.0 {
            return Err(RateCurvesError::NoInitialSlope { index });
        }
        previous = *rate;
    }
    Ok(())
}

/// The interval from the curve of one rate to that of the next.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct RateInterval {
    /// The higher rate, 1/s.
    upper: f64,
    /// Between the two rates.
    log: LogInterval,
    /// The curve of the higher rate.
    curve: Curve,
    /// Corners of the difference of both curves, from the origin on: strain, σ_{i+1} − σ_i (Pa).
    difference: Vec<[f64; 2]>,
    /// Largest |σ_{i+1} − σ_i|/ε up to the strain ℓ, Pa.
    secant: f64,
    /// Largest ratio of the stress on this or a slower curve to that on any curve at the same strain: bounds W(ε_m,
    /// r)/w.
    stress_ratio: f64,
}

impl RateInterval {
    /// The interval from curve `index` to the next of `curves` at their rates (1/s), up to the strain `longest`; ℓ is
    /// `averaging_strain`.
    fn new(curves: &[(f64, Curve)], index: usize, averaging_strain: f64, longest: f64) -> RateInterval {
        let all: Vec<&Curve> = curves.iter().map(|(_, curve)| curve).collect();
        let ((from, lower), (to, upper)) = (&curves[index], &curves[index + 1]);
        let difference = difference(lower, upper, longest);
        let secant = secant(&difference, averaging_strain);
        let stress_ratio = stress_ratio(&all[..index + 2], &all, longest);
        let (log, curve) = (LogInterval::new(*from, *to), upper.clone());
        RateInterval { upper: *to, log, curve, difference, secant, stress_ratio }
    }

    /// The weight s of the upper curve: 0 below and 1 above the two rates.
    #[inline(always)]
    fn weight<const L: usize>(&self, log_rate: Lane<L>) -> Lane<L> {
        self.log.weight(log_rate)
    }

    /// Bound on |∂σ/∂r · ∂r/∂ε| (Pa) for a strain that grows from `from` to `to` (theory.md, equation 142).
    #[inline(always)]
    fn hardening<const L: usize>(&self, from: Lane<L>, to: Lane<L>, averaging_strain: f64) -> Lane<L> {
        let mut largest = splat::<L>(0.0);
        for piece in self.difference.windows(2) {
            let [[start, first], [end, last]] = [piece[0], piece[1]];
            let slope = (last - first) / (end - start);
            let (a, b) = (from.max(start), to.min(end));
            let (at_a, at_b) = ((first + slope * (a - start)).abs(), (first + slope * (b - start)).abs());
            largest = a.at_most(b).select(at_a.max(at_b).max(largest), largest);
        }
        // Up to ℓ the averaging length is the strain itself, λ = min(ε_m, ℓ), so the bound is a secant there.
        let early = from.below(averaging_strain).select(self.secant, 0.0);
        let hardening = self.log.per_log() * early.max(largest / averaging_strain);
        to.at_least(from).select(hardening, 0.0)
    }
}

/// Strains at the corners of all `curves`, ascending, without the origin; `end` is the last.
fn corners(curves: &[&Curve], end: f64) -> Vec<f64> {
    let points = curves.iter().flat_map(|curve| curve.points());
    let mut strains: Vec<f64> = points.map(|point| point[0]).filter(|strain| *strain <= end).chain([end]).collect();
    strains.sort_by(f64::total_cmp);
    strains.dedup();
    strains
}

/// Corners of the difference of two curves: strain, stress (Pa).
fn difference(lower: &Curve, upper: &Curve, end: f64) -> Vec<[f64; 2]> {
    let at = |strain: f64| [strain, upper.stress(strain) - lower.stress(strain)];
    std::iter::once(0.0).chain(corners(&[lower, upper], end)).map(at).collect()
}

/// Largest |difference| over strain up to `averaging_strain`: on a straight piece it is at one end.
fn secant(difference: &[[f64; 2]], averaging_strain: f64) -> f64 {
    let mut largest = 0.0_f64;
    for piece in difference.windows(2) {
        let [[start, first], [end, last]] = [piece[0], piece[1]];
        if start >= averaging_strain {
            break;
        }
        let slope = (last - first) / (end - start);
        let until = end.min(averaging_strain);
        // 0/0 at the origin: the limit is the slope.
        let at_start = if start == 0.0 { slope } else { first / start };
        largest = largest.max(at_start.abs()).max(((first + slope * (until - start)) / until).abs());
    }
    largest
}

/// Largest ratio of the stress on one of `some` curves to that on one of `all` at the same strain up to `end`; of
/// straight pieces it is at a corner.
fn stress_ratio(some: &[&Curve], all: &[&Curve], end: f64) -> f64 {
    let ratio = |of: &dyn Fn(&Curve) -> f64| {
        let most = some.iter().map(|curve| of(curve)).fold(0.0, f64::max);
        let least = all.iter().map(|curve| of(curve)).fold(f64::INFINITY, f64::min);
        most / least
    };
    let at_corners = corners(all, end).into_iter().map(|strain| ratio(&|curve| curve.stress(strain)));
    at_corners.fold(ratio(&Curve::initial_slope), f64::max)
}
