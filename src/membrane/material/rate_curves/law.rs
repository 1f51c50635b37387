//! Stress, energy and slope of fibres with curves by strain rate.

use super::super::fibre::FibreLaw;
use super::super::{Absorption, Curve};
use super::{RateCurves, RateHistory};
use crate::lane::{Lane, lanes, larger, smaller, splat};

impl RateCurves {
    /// Change of the energy at one strain from the curve of one rate to that of another, J/m³.
    #[inline(always)]
    fn energy_change<const L: usize>(&self, before: &Lane<L>, after: &Lane<L>, strain: &Lane<L>) -> Lane<L> {
        let mut below = self.slowest.read(strain).energy;
        let mut change = splat(0.0);
        for interval in &self.intervals {
            let above = interval.curve.read(strain).energy;
            for l in 0..L {
                change[l] += (interval.weight(after[l]) - interval.weight(before[l])) * (above[l] - below[l]);
            }
            below = above;
        }
        change
    }

    /// Updates the history for a strain that grows to `strain` in `dt` (s).
    #[inline(always)]
    fn update<const L: usize>(&self, strain: &Lane<L>, history: &mut RateHistory<L>, dt: f64) {
        // Below the largest strain nothing changes.
        if (0..L).all(|l| strain[l] <= history.peak[l]) {
            return;
        }
        let old = *history;
        let mut first = splat::<L>(0.0);
        for l in 0..L {
            let growth = strain[l] - old.peak[l];
            // Mounting takes no time and counts as the lowest rate.
            let time = if dt > 0.0 { dt } else { growth * self.slowness[1] };
            let length = smaller(old.peak[l], self.averaging_strain);
            let slowness = (length * old.slowness[l] + time) / (length + growth);
            history.slowness[l] = if growth > 0.0 { slowness } else { old.slowness[l] };
            history.peak[l] = larger(strain[l], old.peak[l]);
            first[l] = if length > 0.0 { old.slowness[l] } else { history.slowness[l] };
        }
        let (before, after) = (self.log_rate(&first), self.log_rate(&history.slowness));
        let [change_first, change_last] =
            [self.energy_change(&before, &after, &old.peak), self.energy_change(&before, &after, &history.peak)];
        for l in 0..L {
            history.surplus[l] -= 0.5 * (change_first[l] + change_last[l]);
        }
    }

    /// Energy of the present curve up to the largest strain, W(ε_m, r), J/m³.
    #[inline(always)]
    pub(super) fn peak_energy<const L: usize>(&self, log_rate: &Lane<L>, history: &RateHistory<L>) -> Lane<L> {
        self.mix(log_rate, |curve| curve.read(&history.peak).energy)
    }

    /// Strain on the present curve that has the stress of fibres at `strain`: ε_m − β(ε_m − ε).
    #[inline(always)]
    fn curve_strain<const L: usize>(
        absorption: &Absorption,
        strain: &Lane<L>,
        history: &RateHistory<L>,
        peak_energy: &Lane<L>,
    ) -> Lane<L> {
        let steepening = RateCurves::steepening(absorption, history, peak_energy);
        lanes(|l| history.peak[l] - (history.peak[l] - strain[l]) * steepening[l])
    }

    /// β: slope on unloading over that of the present curve.
    #[inline(always)]
    fn steepening<const L: usize>(absorption: &Absorption, history: &RateHistory<L>, peak_energy: &Lane<L>) -> Lane<L> {
        let mut steepening = splat(0.0);
        for l in 0..L {
            // w = W + surplus is the work that was put in. Where the rate has grown since, it is less than the present
            // curve has, and the fibre unloads steeper to return no more (theory.md, equation 144).
            steepening[l] = larger(peak_energy[l] / (peak_energy[l] + history.surplus[l]), absorption.steepening());
        }
        steepening
    }

    /// Stress (Pa) at `strain`, which is not above the largest so far.
    #[inline(always)]
    fn stress_below<const L: usize>(
        &self,
        absorption: &Absorption,
        strain: &Lane<L>,
        history: &RateHistory<L>,
    ) -> Lane<L> {
        let log_rate = self.log_rate(&history.slowness);
        let curve_strain = RateCurves::curve_strain(absorption, strain, history, &self.peak_energy(&log_rate, history));
        self.mix(&log_rate, |curve| curve.stress_lanes(&curve_strain))
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
        self.update(strain, history, dt);
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
        let peak_energy = self.peak_energy(&log_rate, history);
        let curve_strain = RateCurves::curve_strain(absorption, strain, history, &peak_energy);
        let mut stored = self.mix(&log_rate, |curve| curve.read(&curve_strain).energy);
        let mut absorbed = splat(0.0);
        for l in 0..L {
            let returned = smaller((peak_energy[l] + history.surplus[l]) / peak_energy[l], 1.0 - absorption.share());
            stored[l] *= returned;
            absorbed[l] = history.surplus[l] + (1.0 - returned) * peak_energy[l];
        }
        (stored, absorbed)
    }

    #[inline(always)]
    fn largest_slope<const L: usize>(
        &self,
        absorption: &Absorption,
        strain: &Lane<L>,
        history: &RateHistory<L>,
        reach: f64,
    ) -> Lane<L> {
        let log_rate = self.log_rate(&history.slowness);
        // The rate grows by at most the factor e within λ, and from zero to any rate.
        let mut fastest = splat::<L>(0.0);
        for l in 0..L {
            fastest[l] = log_rate[l] + reach / smaller(history.peak[l], self.averaging_strain);
        }
        let mut steepening = splat::<L>(absorption.steepening());
        for interval in &self.intervals {
            for l in 0..L {
                steepening[l] = if interval.log.log() < fastest[l] {
                    larger(interval.stress_ratio, steepening[l])
                } else {
                    steepening[l]
                };
            }
        }
        let (mut from, mut to, mut most) = (splat::<L>(0.0), splat::<L>(0.0), splat::<L>(0.0));
        for l in 0..L {
            let below = history.peak[l] - strain[l];
            let least = history.peak[l] - below * absorption.steepening();
            let most_steep = history.peak[l] - below * steepening[l];
            // Either steepening may turn out to act: the range of the curve is that of both.
            from[l] = smaller(least, most_steep) - reach * steepening[l];
            to[l] = larger(least, most_steep) + reach * steepening[l];
            most[l] = strain[l] + reach;
        }
        let mut slope = self.slowest.largest_slope(&from, &to);
        let mut hardening = splat::<L>(0.0);
        for interval in &self.intervals {
            let own = interval.curve.largest_slope(&from, &to);
            let rising = interval.hardening(&history.peak, &most, self.averaging_strain);
            for l in 0..L {
                let reachable = interval.log.log() < fastest[l];
                slope[l] = if reachable { larger(own[l], slope[l]) } else { slope[l] };
                hardening[l] = if reachable { larger(rising[l], hardening[l]) } else { hardening[l] };
            }
        }
        for l in 0..L {
            // Equation 142: slope of the slowest to the fastest curve in reach, and growth of the rate from one to the
            // next.
            slope[l] = if to[l] < 0.0 { 0.0 } else { steepening[l] * slope[l] + hardening[l] };
        }
        slope
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

    #[inline(always)]
    fn break_strain<const L: usize>(&self, history: &RateHistory<L>) -> Lane<L> {
        self.mix(&self.log_rate(&history.slowness), |curve| splat(curve.end()))
    }

    fn break_strains(&self) -> [f64; 2] {
        [self.slowest.end(), self.longest]
    }
}
