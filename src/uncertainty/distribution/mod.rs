//! How an input varies: uniform, normal, log-normal or Weibull, each truncated or not.

mod family;
mod moments;

use std::fmt;

use serde::{Deserialize, Serialize};
use thiserror::Error;

pub use family::Family;
use family::Tails;

/// Why there is no such distribution.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum DistributionError {
    /// A parameter, or what follows from it, is no finite number.
    #[error("{what} is {value}, but must be finite")]
    NotFinite {
        /// The parameter.
        what: &'static str,
        /// Its value.
        value: f64,
    },
    /// A parameter must be positive.
    #[error("{what} is {value}, but must be positive and finite")]
    NotPositive {
        /// The parameter.
        what: &'static str,
        /// Its value.
        value: f64,
    },
    /// The ends of a uniform distribution, or of a truncation, are not in order or too far apart.
    #[error("the lower end {low} must be below the upper end {high}, at a finite distance")]
    Ends {
        /// Lower end.
        low: f64,
        /// Upper end.
        high: f64,
    },
    /// The quantity is practically never between the ends of the truncation.
    #[error("the probability between {low} and {high} is {probability:e}; nothing is left by the truncation")]
    NothingLeft {
        /// Lower end, −∞ where there is none.
        low: f64,
        /// Upper end, ∞ where there is none.
        high: f64,
        /// Probability between them before the truncation.
        probability: f64,
    },
}

/// Least probability between the ends of a truncation: below it the tails have lost their digits.
const LEAST_LEFT: f64 = 1e-280;

/// Distribution of one input: a family, conditional on lying between two ends where it is truncated.
///
/// Serialized as it is written (`family`, `low`, `high`), and checked when it is read.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Written", into = "Written")]
pub struct Distribution {
    family: Family,
    low: Option<f64>,
    high: Option<f64>,
    /// Probabilities of the family that the truncation cuts off below and above.
    cut: Tails,
    /// Probability of the family that is left.
    left: f64,
}

#[derive(Serialize, Deserialize)]
struct Written {
    #[serde(flatten)]
    family: Family,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    low: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    high: Option<f64>,
}

impl TryFrom<Written> for Distribution {
    type Error = DistributionError;

    fn try_from(written: Written) -> Result<Self, DistributionError> {
        Self::new(written.family)?.truncated(written.low, written.high)
    }
}

impl From<Distribution> for Written {
    fn from(distribution: Distribution) -> Self {
        Self { family: distribution.family, low: distribution.low, high: distribution.high }
    }
}

/// In words: `normal, mean 12, deviation 0.5, at least 10`.
impl fmt::Display for Distribution {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.describe(|value| value.to_string()))
    }
}

impl Distribution {
    /// The distribution in words, its values as `shown` writes them.
    pub fn describe(&self, shown: impl Fn(f64) -> String) -> String {
        let family = match self.family {
            Family::Uniform { low, high } => format!("uniform from {} to {}", shown(low), shown(high)),
            Family::Normal { mean, deviation } => {
                format!("normal, mean {}, deviation {}", shown(mean), shown(deviation))
            }
            Family::LogNormal { mean, deviation } => {
                format!("log-normal, mean {}, deviation {}", shown(mean), shown(deviation))
            }
            Family::Weibull { scale, shape } => format!("Weibull, scale {}, shape {shape}", shown(scale)),
        };
        let cut = match (self.low, self.high) {
            (None, None) => String::new(),
            (Some(low), None) => format!(", at least {}", shown(low)),
            (None, Some(high)) => format!(", at most {}", shown(high)),
            (Some(low), Some(high)) => format!(", from {} to {}", shown(low), shown(high)),
        };
        family + &cut
    }
}

impl Distribution {
    /// The whole of a family.
    ///
    /// # Errors
    /// A parameter is out of its range, or mean and standard deviation are not finite.
    pub fn new(family: Family) -> Result<Self, DistributionError> {
        let cut = Tails { below: 0.0, above: 0.0 };
        Ok(Self { family: family.check()?, low: None, high: None, cut, left: 1.0 })
    }

    /// Equal density between two ends.
    ///
    /// # Errors
    /// The ends are not finite and in order.
    pub fn uniform(low: f64, high: f64) -> Result<Self, DistributionError> {
        Self::new(Family::Uniform { low, high })
    }

    /// Normal of this mean and standard deviation.
    ///
    /// # Errors
    /// The deviation is not positive.
    pub fn normal(mean: f64, deviation: f64) -> Result<Self, DistributionError> {
        Self::new(Family::Normal { mean, deviation })
    }

    /// Log-normal of this mean and standard deviation of the quantity itself.
    ///
    /// # Errors
    /// One of them is not positive.
    pub fn log_normal(mean: f64, deviation: f64) -> Result<Self, DistributionError> {
        Self::new(Family::LogNormal { mean, deviation })
    }

    /// Weibull of two parameters.
    ///
    /// # Errors
    /// One of them is not positive, or the shape so small that the deviation overflows.
    pub fn weibull(scale: f64, shape: f64) -> Result<Self, DistributionError> {
        Self::new(Family::Weibull { scale, shape })
    }

    /// This family conditional on lying between these ends, of which either may be open; they replace ends that
    /// were set before.
    ///
    /// # Errors
    /// The ends are not in order, or the probability between them is below 1e-280.
    pub fn truncated(self, low: Option<f64>, high: Option<f64>) -> Result<Self, DistributionError> {
        let ends = [("the lower end", low), ("the upper end", high)];
        if let Some((what, Some(value))) = ends.into_iter().find(|(_, end)| end.is_some_and(|end| !end.is_finite())) {
            return Err(DistributionError::NotFinite { what, value });
        }
        // Both tails are kept: 1 − p has no digits left for a far one.
        let at = |end: Option<f64>, open| end.map_or(open, |end| self.family.tails(end));
        let bottom = at(low, Tails { below: 0.0, above: 1.0 });
        let top = at(high, Tails { below: 1.0, above: 0.0 });
        let (low_end, high_end) = (low.unwrap_or(f64::NEG_INFINITY), high.unwrap_or(f64::INFINITY));
        if low_end >= high_end {
            return Err(DistributionError::Ends { low: low_end, high: high_end });
        }
        let left = between(bottom, top);
        if left < LEAST_LEFT {
            return Err(DistributionError::NothingLeft { low: low_end, high: high_end, probability: left });
        }
        let cut = Tails { below: bottom.below, above: top.above };
        Ok(Self { family: self.family, low, high, cut, left })
    }

    /// The family and its parameters, without the truncation.
    pub fn family(&self) -> Family {
        self.family
    }

    /// Ends of the truncation, lower and upper, where there are any.
    pub fn ends(&self) -> (Option<f64>, Option<f64>) {
        (self.low, self.high)
    }

    /// The value that the quantity is at most with probability `p`; finite for every `p` within (0, 1).
    ///
    /// Its probability differs from `p` by less than 1e-12 `p` and what the rounding of the value itself changes. At 0
    /// and 1 it is the end of the support, which may be infinite; outside of them it is no number.
    pub fn quantile(&self, p: f64) -> f64 {
        self.quantile_of(Tails { below: p, above: 1.0 - p })
    }

    fn quantile_of(&self, tails: Tails) -> f64 {
        if !(0.0..=1.0).contains(&tails.below) {
            return f64::NAN;
        }
        let within =
            Tails { below: self.cut.below + self.left * tails.below, above: self.cut.above + self.left * tails.above };
        let value = self.family.quantile(within);
        // Rounding must not lead out of the ends, where density and cumulative probability are zero and one.
        value.max(self.low.unwrap_or(value)).min(self.high.unwrap_or(value))
    }

    /// Probability of at most `x`.
    pub fn cumulative(&self, x: f64) -> f64 {
        if self.low.is_some_and(|low| x <= low) {
            return 0.0;
        }
        if self.high.is_some_and(|high| x >= high) {
            return 1.0;
        }
        let bottom = self.low.map_or(Tails { below: 0.0, above: 1.0 }, |low| self.family.tails(low));
        (between(bottom, self.family.tails(x)) / self.left).min(1.0)
    }

    /// Probability density at `x`, in one over the unit of the quantity.
    pub fn density(&self, x: f64) -> f64 {
        if self.low.is_some_and(|low| x < low) || self.high.is_some_and(|high| x > high) {
            return 0.0;
        }
        self.family.density(x) / self.left
    }

    /// Mean, in the unit of the quantity: a closed form of the family, or of a truncated one by quadrature to a
    /// relative error of about 1e-12.
    pub fn mean(&self) -> f64 {
        if self.is_truncated() { moments::of_quantile(|tails| self.quantile_of(tails)).0 } else { self.family.mean() }
    }

    /// Standard deviation, in the unit of the quantity, computed as the mean is.
    pub fn deviation(&self) -> f64 {
        if self.is_truncated() {
            moments::of_quantile(|tails| self.quantile_of(tails)).1
        } else {
            self.family.deviation()
        }
    }

    fn is_truncated(&self) -> bool {
        self.low.is_some() || self.high.is_some()
    }
}

/// Probability between two values, by the tails in which it has most digits.
fn between(bottom: Tails, top: Tails) -> f64 {
    let difference = if bottom.below <= bottom.above && top.above <= top.below {
        1.0 - bottom.below - top.above
    } else if top.below <= top.above {
        top.below - bottom.below
    } else {
        bottom.above - top.above
    };
    difference.max(0.0)
}

#[cfg(test)]
mod tests;
