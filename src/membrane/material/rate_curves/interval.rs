//! Two curves of neighbouring rates and the interpolation between them.

use serde::{Deserialize, Serialize};

use super::super::Curve;
use super::super::log_interval::LogInterval;
use crate::lane::{Lane, splat};

/// The interval from the curve of one rate to that of the next.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct RateInterval {
    /// The higher rate, 1/s.
    pub(super) upper: f64,
    /// Between the two rates.
    pub(super) log: LogInterval,
    /// The curve of the higher rate.
    pub(super) curve: Curve,
    /// Corners of the difference of both curves, from the origin on: strain, σ_{i+1} − σ_i (Pa).
    difference: Vec<[f64; 2]>,
    /// Largest |σ_{i+1} − σ_i|/ε up to the strain ℓ, Pa.
    secant: f64,
    /// Largest ratio of the stress on this or a slower curve to that on any curve at the same strain: bounds W(ε_m,
    /// r)/w.
    pub(super) stress_ratio: f64,
}

impl RateInterval {
    /// The interval from curve `index` to the next of `curves` at their rates (1/s), up to the strain `longest`; ℓ is
    /// `averaging_strain`.
    pub(super) fn new(curves: &[(f64, Curve)], index: usize, averaging_strain: f64, longest: f64) -> RateInterval {
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
    pub(super) fn weight<const L: usize>(&self, log_rate: Lane<L>) -> Lane<L> {
        self.log.weight(log_rate)
    }

    /// Bound on |∂σ/∂r · ∂r/∂ε| (Pa) for a strain that grows from `from` to `to` (theory.md, equation 142).
    #[inline(always)]
    pub(super) fn hardening<const L: usize>(&self, from: Lane<L>, to: Lane<L>, averaging_strain: f64) -> Lane<L> {
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
