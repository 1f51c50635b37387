//! How the flow stress depends on the rate of plastic strain.

use serde::{Deserialize, Serialize};
use thiserror::Error;

use super::FlowCurve;
use super::hardening::Flow;
use crate::lane::{Lane, ln, one, splat};
use crate::material::log_interval::LogInterval;

/// Dependence of the flow stress on the rate ṗ of the equivalent plastic strain.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum FlowRate {
    /// None.
    Independent,
    /// Curves by rate, from that of the hardening on: interpolated in the logarithm of the rate, constant outside.
    Table(RateTable),
}

/// Flow curves of rising rates after that of the hardening.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RateTable {
    steps: Vec<Step>,
    /// Of the hardening's curve, 1/s.
    lowest: f64,
    /// Of the last curve, 1/s.
    highest: f64,
}

/// From the curve of one rate to that of the next.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Step {
    interval: LogInterval,
    /// Of the curve, 1/s.
    rate: f64,
    curve: FlowCurve,
}

/// Why flow curves are no table by rate.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum RateTableError {
    /// There are fewer than two curves.
    #[error("there are fewer than two curves")]
    TooShort,
    /// A rate is not positive, not finite or not above the one before.
    #[error("the rates do not increase: {rate} 1/s after {previous} 1/s")]
    RateNotIncreasing {
        /// Index of the curve.
        index: usize,
        /// Its rate, 1/s.
        rate: f64,
        /// Rate of the curve before, 1/s; zero before the first.
        previous: f64,
    },
    /// A curve lies below that of the rate before: flow would not be unique.
    #[error(
        "the flow stress falls with the rate: curve {index} lies below the one before at the plastic strain {strain}"
    )]
    StressFalls {
        /// Index of the curve.
        index: usize,
        /// Where.
        strain: f64,
    },
}

impl RateTable {
    /// The first curve, which is the hardening, and the table of all `curves` at their rates (1/s), lowest first.
    ///
    /// # Errors
    /// [`RateTableError`].
    pub fn new(curves: Vec<(f64, FlowCurve)>) -> Result<(FlowCurve, RateTable), RateTableError> {
        let mut curves = curves.into_iter().enumerate();
        let (Some((_, (lowest, first))), true) = (curves.next(), curves.len() > 0) else {
            return Err(RateTableError::TooShort);
        };
        if !(lowest > 0.0 && lowest.is_finite()) {
            return Err(RateTableError::RateNotIncreasing { index: 0, rate: lowest, previous: 0.0 });
        }
        let (mut steps, mut below, mut previous) = (vec![], first.clone(), lowest);
        for (index, (rate, curve)) in curves {
            if !(rate > previous && rate.is_finite()) {
                return Err(RateTableError::RateNotIncreasing { index, rate, previous });
            }
            let corners: Vec<f64> = below.corners().chain(curve.corners()).collect();
            if let Some(strain) = std::iter::once(0.0).chain(corners).find(|p| curve.stress(*p) < below.stress(*p)) {
                return Err(RateTableError::StressFalls { index, strain });
            }
            steps.push(Step { interval: LogInterval::new(previous, rate), rate, curve: curve.clone() });
            (below, previous) = (curve, rate);
        }
        Ok((first, RateTable { steps, lowest, highest: previous }))
    }

    /// Rates (1/s) and curves above that of the hardening, which is at the lowest rate.
    pub fn above(&self) -> impl Iterator<Item = (f64, &FlowCurve)> {
        self.steps.iter().map(|step| (step.rate, &step.curve))
    }

    /// Rate of the hardening's curve, 1/s.
    pub fn lowest(&self) -> f64 {
        self.lowest
    }

    /// Flow stress at p and ln ṗ, where slow flow has that of `slow`.
    #[inline(always)]
    pub(super) fn flow<const L: usize>(&self, slow: &Flow<L>, p: Lane<L>, log_rate: Lane<L>) -> RatedFlow<L> {
        let mut out = RatedFlow { stress: slow.stress, by_strain: slow.slope, by_log_rate: splat(0.0) };
        let (mut below, mut slope) = (slow.stress, slow.slope);
        for Step { interval, curve, .. } in &self.steps {
            let above = curve.flow(p);
            let weight = interval.weight(log_rate);
            let rise = above.stress - below;
            out.stress += weight * rise;
            out.by_strain += weight * (above.slope - slope);
            let is_inside = weight.above(0.0) & weight.below(1.0);
            out.by_log_rate += is_inside.select(interval.per_log() * rise, 0.0);
            (below, slope) = (above.stress, above.slope);
        }
        out
    }
}

/// Flow stress at a rate, and its derivatives.
pub(super) struct RatedFlow<const L: usize> {
    /// Pa.
    pub(super) stress: Lane<L>,
    /// By p at this rate, Pa.
    pub(super) by_strain: Lane<L>,
    /// By ln ṗ at this p, Pa.
    pub(super) by_log_rate: Lane<L>,
}

impl FlowRate {
    /// Lowest and highest rate of a table, 1/s.
    pub fn range(&self) -> Option<[f64; 2]> {
        match self {
            FlowRate::Table(RateTable { lowest, highest, .. }) => Some([*lowest, *highest]),
            FlowRate::Independent => None,
        }
    }

    /// Flow stress at p and the constant rate (1/s) where slow flow has that of `slow`, Pa.
    pub(super) fn stress_at(&self, slow: Flow<1>, p: f64, rate: f64) -> f64 {
        match self {
            FlowRate::Independent => slow.stress[0],
            FlowRate::Table(table) => table.flow(&slow, one(p), one(ln(rate))).stress[0],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::plastic::Hardening;

    fn curve(factor: f64) -> FlowCurve {
        FlowCurve::new(&[[0.0, 8e6 * factor], [0.1, 12e6 * factor]]).unwrap()
    }

    #[test]
    fn tables_are_interpolated_in_the_logarithm_of_the_rate() {
        let (slow, table) = RateTable::new(vec![(0.1, curve(1.0)), (1.0, curve(1.2)), (100.0, curve(1.6))]).unwrap();
        let rate = FlowRate::Table(table);
        assert_eq!(rate.range(), Some([0.1, 100.0]));
        let slow = Hardening::Table(slow);
        for (at, factor) in [(1e-6, 1.0), (0.1, 1.0), (0.316_227_766, 1.1), (1.0, 1.2), (10.0, 1.4), (1e4, 1.6)] {
            let stress = rate.stress_at(slow.flow(one(0.05)), 0.05, at);
            assert!((stress / (factor * 10e6) - 1.0).abs() < 1e-9, "{at}: {stress}");
        }
    }

    #[test]
    fn refuses_what_is_no_table() {
        assert_eq!(RateTable::new(vec![(0.1, curve(1.0))]).unwrap_err(), RateTableError::TooShort);
        let twice = RateTable::new(vec![(0.1, curve(1.0)), (0.1, curve(1.2))]).unwrap_err();
        assert_eq!(twice, RateTableError::RateNotIncreasing { index: 1, rate: 0.1, previous: 0.1 });
        let zero = RateTable::new(vec![(0.0, curve(1.0)), (0.1, curve(1.2))]).unwrap_err();
        assert_eq!(zero, RateTableError::RateNotIncreasing { index: 0, rate: 0.0, previous: 0.0 });
        let falls = RateTable::new(vec![(0.1, curve(1.0)), (1.0, curve(0.9))]).unwrap_err();
        assert_eq!(falls, RateTableError::StressFalls { index: 1, strain: 0.0 });
    }
}
