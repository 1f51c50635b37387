//! Linear interpolation in the logarithm of a rate.

use serde::{Deserialize, Serialize};

use crate::lane::{Lane, ln};

/// The interval between two rates.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct LogInterval {
    /// Logarithm of the lower rate (1/s).
    log: f64,
    /// 1/ln(r_{i+1}/r_i).
    per_log: f64,
}

impl LogInterval {
    /// The interval between two rates, 1/s.
    pub(super) fn new(from: f64, to: f64) -> LogInterval {
        let log = ln(from);
        LogInterval { log, per_log: 1.0 / (ln(to) - log) }
    }

    /// Logarithm of the lower rate (1/s).
    #[inline(always)]
    pub(super) fn log(&self) -> f64 {
        self.log
    }

    /// 1/ln(r_{i+1}/r_i).
    #[inline(always)]
    pub(super) fn per_log(&self) -> f64 {
        self.per_log
    }

    /// The weight s of the upper rate: 0 below and 1 above the two rates.
    #[inline(always)]
    pub(super) fn weight<const L: usize>(&self, log_rate: Lane<L>) -> Lane<L> {
        ((log_rate - self.log) * self.per_log).max(0.0).min(1.0)
    }
}
