//! Stress, energy and slope of fibres with curves by strain rate.

use super::super::fibre::FibreLaw;
use super::super::{Absorption, Curve, Strained};
use super::{RateCurves, RateHistory, mix};
use crate::lane::{Lane, splat};

impl RateCurves {
    /// Change of the energy at one strain from the curve of one rate to that of another, J/m³.
    #[inline(always)]
    fn energy_change<const L: usize>(&self, before: Lane<L>, after: Lane<L>, strain: Lane<L>) -> Lane<L> {
        let mut below = self.slowest.read(strain).energy;
        let mut change = splat(0.0);
        for interval in &self.intervals {
            let above = interval.curve.read(strain).energy;
            change += (interval.weight(after) - interval.weight(before)) * (above - below);
            below = above;
        }
        change
    }

    /// Updates the history for a strain that grows to `strain` in `dt` (s).
    #[inline(always)]
    fn update<const L: usize>(&self, strain: Lane<L>, history: &mut RateHistory<L>, dt: f64) {
        // Below the largest strain nothing changes.
        if strain.at_most(history.peak).all() {
            return;
        }
        let old = *history;
        let growth = strain - old.peak;
        // Mounting takes no time and counts as the lowest rate.
        let time = if dt > 0.0 { splat(dt) } else { growth * self.slowness[1] };
        let length = old.peak.min(self.averaging_strain);
        let slowness = (length * old.slowness + time) / (length + growth);
        history.slowness = growth.above(0.0).select(slowness, old.slowness);
        history.peak = strain.max(old.peak);
        let first = length.above(0.0).select(old.slowness, history.slowness);
        let (before, after) = (self.log_rate(first), self.log_rate(history.slowness));
        let (from, to) = (self.energy_change(before, after, old.peak), self.energy_change(before, after, history.peak));
        history.surplus -= 0.5 * (from + to);
    }

    /// Energy of the present curve up to the largest strain, W(ε_m, r), J/m³.
    #[inline(always)]
    pub(super) fn peak_energy<const L: usize>(&self, log_rate: Lane<L>, history: &RateHistory<L>) -> Lane<L> {
        mix!(self, log_rate, curve => curve.read(history.peak).energy)
    }

    /// Strain on the present curve that has the stress of fibres at `strain`: ε_m − β(ε_m − ε).
    #[inline(always)]
    fn curve_strain<const L: usize>(at: Strained<'_, L>, history: &RateHistory<L>, peak_energy: Lane<L>) -> Lane<L> {
        history.peak - (history.peak - at.strain) * RateCurves::steepening(at.absorption, history, peak_energy)
    }

    /// β: slope on unloading over that of the present curve.
    #[inline(always)]
    fn steepening<const L: usize>(absorption: &Absorption, history: &RateHistory<L>, peak_energy: Lane<L>) -> Lane<L> {
        // w = W + surplus is the work that was put in. Where the rate has grown since, it is less than the present curve
        // has, and the fibre unloads steeper to return no more (theory.md, equation 144).
        (peak_energy / (peak_energy + history.surplus)).max(absorption.steepening())
    }

    /// Stress (Pa) at a strain that is not above the largest so far.
    #[inline(always)]
    fn stress_below<const L: usize>(&self, at: Strained<'_, L>, history: &RateHistory<L>) -> Lane<L> {
        let log_rate = self.log_rate(history.slowness);
        let curve_strain = RateCurves::curve_strain(at, history, self.peak_energy(log_rate, history));
        mix!(self, log_rate, curve => curve.stress_lanes(curve_strain))
    }
}

impl FibreLaw for RateCurves {
    type History<const L: usize> = RateHistory<L>;

    #[inline(always)]
    fn stress<const L: usize>(&self, at: Strained<'_, L>, history: &mut RateHistory<L>, dt: f64) -> Lane<L> {
        self.update(at.strain, history, dt);
        self.stress_below(at, history)
    }

    #[inline(always)]
    fn stress_near<const L: usize>(&self, at: Strained<'_, L>, history: &RateHistory<L>) -> Lane<L> {
        let raised = RateHistory { peak: at.strain.max(history.peak), ..*history };
        self.stress_below(at, &raised)
    }

    #[inline(always)]
    fn energy<const L: usize>(&self, at: Strained<'_, L>, history: &RateHistory<L>) -> (Lane<L>, Lane<L>) {
        let log_rate = self.log_rate(history.slowness);
        let peak_energy = self.peak_energy(log_rate, history);
        let curve_strain = RateCurves::curve_strain(at, history, peak_energy);
        let whole = mix!(self, log_rate, curve => curve.read(curve_strain).energy);
        let returned = ((peak_energy + history.surplus) / peak_energy).min(1.0 - at.absorption.share());
        (whole * returned, history.surplus + (1.0 - returned) * peak_energy)
    }

    #[inline(always)]
    fn largest_slope<const L: usize>(&self, at: Strained<'_, L>, history: &RateHistory<L>, reach: f64) -> Lane<L> {
        let Strained { strain, absorption } = at;
        // The rate grows by at most the factor e within λ, and from zero to any rate.
        let fastest = self.log_rate(history.slowness) + reach / history.peak.min(self.averaging_strain);
        let mut steepening = splat(absorption.steepening());
        for interval in &self.intervals {
            let reachable = fastest.above(interval.log.log());
            steepening = reachable.select(steepening.max(interval.stress_ratio), steepening);
        }
        let below = history.peak - strain;
        let least = history.peak - below * absorption.steepening();
        let most_steep = history.peak - below * steepening;
        // Either steepening may turn out to act: the range of the curve is that of both.
        let from = least.min(most_steep) - reach * steepening;
        let to = least.max(most_steep) + reach * steepening;
        let mut slope = self.slowest.largest_slope(from, to);
        let mut hardening = splat(0.0);
        for interval in &self.intervals {
            let own = interval.curve.largest_slope(from, to);
            let rising = interval.hardening(history.peak, strain + reach, self.averaging_strain);
            let reachable = fastest.above(interval.log.log());
            slope = reachable.select(own.max(slope), slope);
            hardening = reachable.select(rising.max(hardening), hardening);
        }
        // Equation 142: slope of the slowest to the fastest curve in reach, and growth of the rate from one to the next.
        to.below(0.0).select(0.0, steepening * slope + hardening)
    }

    fn mean(first: &RateCurves, second: &RateCurves, factor: f64) -> RateCurves {
        let mut rates: Vec<f64> = first.rates().chain(second.rates()).collect();
        rates.sort_by(f64::total_cmp);
        rates.dedup();
        let both = |rate: f64| Curve::weighted(&first.curve_at(rate), &second.curve_at(rate), [0.5 * factor; 2]);
        if rates.is_empty() {
            return RateCurves::from(both(1.0));
        }
        let averaged = [first, second].map(|law| (!law.intervals.is_empty()).then_some(law.averaging_strain));
        if let [Some(a), Some(b)] = averaged {
            assert!(a == b, "the rate is averaged over {a} and over {b}");
        }
        let averaging_strain =
            if first.intervals.is_empty() { second.averaging_strain } else { first.averaging_strain };
        RateCurves::assembled(rates.into_iter().map(|rate| (rate, both(rate))).collect(), averaging_strain)
    }

    fn initial_slope(&self) -> f64 {
        self.slowest.initial_slope()
    }

    fn early_modulus(&self) -> f64 {
        let intervals = self.intervals.iter().map(|interval| &interval.curve);
        intervals.map(Curve::early_slope).fold(self.slowest.early_slope(), f64::max)
    }

    #[inline(always)]
    fn break_strain<const L: usize>(&self, history: &RateHistory<L>) -> Lane<L> {
        mix!(self, self.log_rate(history.slowness), curve => splat(curve.end()))
    }

    fn break_strains(&self) -> [f64; 2] {
        [self.slowest.end(), self.longest]
    }
}
