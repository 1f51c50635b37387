//! Closed forms of the families, each in both tails.

use serde::{Deserialize, Serialize};

use super::DistributionError;
use crate::normal;

/// Family of a distribution and its parameters, in the unit of the quantity.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Family {
    /// Equal density from low to high.
    Uniform {
        /// Lower end.
        low: f64,
        /// Upper end.
        high: f64,
    },
    /// Normal.
    Normal {
        /// Mean.
        mean: f64,
        /// Standard deviation.
        deviation: f64,
    },
    /// Its logarithm is normal.
    LogNormal {
        /// Mean of the quantity, not of its logarithm.
        mean: f64,
        /// Standard deviation of the quantity, not of its logarithm.
        deviation: f64,
    },
    /// F(x) = 1 − exp(−(x/scale)^shape).
    Weibull {
        /// The quantile of 1 − 1/e.
        scale: f64,
        /// Weibull modulus.
        shape: f64,
    },
}

/// A probability and one minus it: where one of them rounds, the other is exact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Tails {
    /// Probability of at most the value.
    pub below: f64,
    /// Probability of more than the value.
    pub above: f64,
}

impl Family {
    pub(super) fn check(self) -> Result<Self, DistributionError> {
        let finite = |what, value: f64| match value.is_finite() {
            true => Ok(()),
            false => Err(DistributionError::NotFinite { what, value }),
        };
        let positive = |what, value: f64| match value > 0.0 && value.is_finite() {
            true => Ok(()),
            false => Err(DistributionError::NotPositive { what, value }),
        };
        match self {
            Self::Uniform { low, high } => {
                finite("the lower end", low)?;
                finite("the upper end", high)?;
                if low >= high || !(high - low).is_finite() {
                    return Err(DistributionError::Ends { low, high });
                }
            }
            Self::Normal { mean, deviation } => {
                finite("the mean", mean)?;
                positive("the standard deviation", deviation)?;
            }
            Self::LogNormal { mean, deviation } => {
                positive("the mean", mean)?;
                positive("the standard deviation", deviation)?;
            }
            Self::Weibull { scale, shape } => {
                positive("the scale", scale)?;
                positive("the shape", shape)?;
            }
        }
        let moments = [("the mean", self.mean()), ("the standard deviation", self.deviation())];
        match moments.into_iter().find(|(_, value)| !value.is_finite()) {
            Some((what, value)) => Err(DistributionError::NotFinite { what, value }),
            None => Ok(self),
        }
    }

    /// Mean and standard deviation of the logarithm of a log-normal quantity.
    fn of_logarithm(mean: f64, deviation: f64) -> (f64, f64) {
        let variance = libm::log1p((deviation / mean) * (deviation / mean));
        (libm::log(mean) - 0.5 * variance, variance.sqrt())
    }

    pub(super) fn tails(self, x: f64) -> Tails {
        let of_normal = |z: f64| Tails { below: normal::cumulative(z), above: normal::cumulative(-z) };
        match self {
            Self::Uniform { low, high } => Tails {
                below: ((x - low) / (high - low)).clamp(0.0, 1.0),
                above: ((high - x) / (high - low)).clamp(0.0, 1.0),
            },
            Self::Normal { mean, deviation } => of_normal((x - mean) / deviation),
            Self::LogNormal { .. } | Self::Weibull { .. } if x <= 0.0 => Tails { below: 0.0, above: 1.0 },
            Self::LogNormal { mean, deviation } => {
                let (location, scale) = Self::of_logarithm(mean, deviation);
                of_normal((libm::log(x) - location) / scale)
            }
            Self::Weibull { scale, shape } => {
                let exponent = libm::pow(x / scale, shape);
                Tails { below: -libm::expm1(-exponent), above: libm::exp(-exponent) }
            }
        }
    }

    /// The value of these tails, by the smaller of them.
    pub(super) fn quantile(self, tails: Tails) -> f64 {
        let lower = tails.below <= tails.above;
        let of_normal = || if lower { normal::quantile(tails.below) } else { -normal::quantile(tails.above) };
        match self {
            Self::Uniform { low, high } if lower => low + tails.below * (high - low),
            Self::Uniform { low, high } => high - tails.above * (high - low),
            Self::Normal { mean, deviation } => mean + deviation * of_normal(),
            Self::LogNormal { mean, deviation } => {
                let (location, scale) = Self::of_logarithm(mean, deviation);
                libm::exp(location + scale * of_normal())
            }
            Self::Weibull { scale, shape } => {
                let exponent = if lower { -libm::log1p(-tails.below) } else { -libm::log(tails.above) };
                scale * libm::pow(exponent, 1.0 / shape)
            }
        }
    }

    pub(super) fn density(self, x: f64) -> f64 {
        match self {
            Self::Uniform { low, high } if x < low || x > high => 0.0,
            Self::Uniform { low, high } => 1.0 / (high - low),
            Self::Normal { mean, deviation } => normal::density((x - mean) / deviation) / deviation,
            Self::LogNormal { .. } if x <= 0.0 => 0.0,
            Self::Weibull { .. } if x < 0.0 => 0.0,
            Self::LogNormal { mean, deviation } => {
                let (location, scale) = Self::of_logarithm(mean, deviation);
                normal::density((libm::log(x) - location) / scale) / (scale * x)
            }
            Self::Weibull { scale, shape } => {
                let [before, exponent] = [shape - 1.0, shape].map(|power| libm::pow(x / scale, power));
                shape / scale * before * libm::exp(-exponent)
            }
        }
    }

    pub(super) fn mean(self) -> f64 {
        match self {
            Self::Uniform { low, high } => low + 0.5 * (high - low),
            Self::Normal { mean, .. } | Self::LogNormal { mean, .. } => mean,
            Self::Weibull { scale, shape } => scale * libm::tgamma(1.0 + 1.0 / shape),
        }
    }

    pub(super) fn deviation(self) -> f64 {
        match self {
            Self::Uniform { low, high } => (high - low) / 12.0_f64.sqrt(),
            Self::Normal { deviation, .. } | Self::LogNormal { deviation, .. } => deviation,
            Self::Weibull { scale, shape } => {
                // Γ(1 + 2/k)/Γ(1 + 1/k)² − 1 by logarithms loses as many digits as the shape k has, not twice as many.
                let [first, second] = [1.0, 2.0].map(|moment| libm::lgamma(1.0 + moment / shape));
                scale * libm::exp(first) * libm::expm1(second - 2.0 * first).sqrt()
            }
        }
    }
}
