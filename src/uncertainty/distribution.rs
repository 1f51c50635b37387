//! How an input varies: uniform, normal, log-normal or Weibull, each truncated or not.

use std::f64::consts::FRAC_PI_2;
use std::fmt;

use crate::{Error, ensure, normal};

/// Least probability between the ends of a truncation: below it the tails have lost their digits.
const LEAST_LEFT: f64 = 1e-280;

/// Distribution of one input: a family, conditional on lying between two ends where it is truncated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Distribution {
    family: Family,
    low: Option<f64>,
    high: Option<f64>,
    /// Probabilities of the family that the truncation cuts off below and above.
    cut: Tails,
    /// Probability of the family that is left.
    left: f64,
}

/// In words: `normal, mean 12, deviation 0.5, at least 10`.
impl fmt::Display for Distribution {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let shown = |value: f64| match value.abs() {
            small if small > 0.0 && small < 1e-3 => format!("{value:e}"),
            _ => value.to_string(),
        };
        f.write_str(&self.describe(shown))
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
    pub fn new(family: Family) -> Result<Self, Error> {
        let cut = Tails { below: 0.0, above: 0.0 };
        Ok(Self { family: family.check()?, low: None, high: None, cut, left: 1.0 })
    }

    /// Equal density between two ends.
    ///
    /// # Errors
    /// The ends are not finite and in order.
    pub fn uniform(low: f64, high: f64) -> Result<Self, Error> {
        Self::new(Family::Uniform { low, high })
    }

    /// Normal of this mean and standard deviation.
    ///
    /// # Errors
    /// The deviation is not positive.
    pub fn normal(mean: f64, deviation: f64) -> Result<Self, Error> {
        Self::new(Family::Normal { mean, deviation })
    }

    /// Log-normal of this mean and standard deviation of the quantity itself.
    ///
    /// # Errors
    /// One of them is not positive.
    pub fn log_normal(mean: f64, deviation: f64) -> Result<Self, Error> {
        Self::new(Family::LogNormal { mean, deviation })
    }

    /// Weibull of two parameters.
    ///
    /// # Errors
    /// One of them is not positive, or the shape so small that the deviation overflows.
    pub fn weibull(scale: f64, shape: f64) -> Result<Self, Error> {
        Self::new(Family::Weibull { scale, shape })
    }

    /// This family conditional on lying between these ends, of which either may be open; they replace ends that
    /// were set before.
    ///
    /// # Errors
    /// The ends are not in order, or the probability between them is below 1e-280.
    pub fn truncated(self, low: Option<f64>, high: Option<f64>) -> Result<Self, Error> {
        low.map_or(Ok(()), |low| finite("the lower end", low))?;
        high.map_or(Ok(()), |high| finite("the upper end", high))?;
        // Both tails are kept: 1 − p has no digits left for a far one.
        let at = |end: Option<f64>, open| end.map_or(open, |end| self.family.tails(end));
        let bottom = at(low, Tails { below: 0.0, above: 1.0 });
        let top = at(high, Tails { below: 1.0, above: 0.0 });
        let (low_end, high_end) = (low.unwrap_or(f64::NEG_INFINITY), high.unwrap_or(f64::INFINITY));
        ensure(low_end < high_end, || {
            format!("the lower end {low_end} must be below the upper end {high_end}, at a finite distance")
        })?;
        let left = between(bottom, top);
        if left < LEAST_LEFT {
            return Err(Error::new(format!(
                "the probability between {low_end} and {high_end} is {left:e}; nothing is left by the truncation"
            )));
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

    /// The standard normal value of the same probability in the whole family, by the smaller tail; it goes on linearly where that
    /// has no digits.
    pub fn normal_score(&self, x: f64) -> f64 {
        const LEAST: f64 = 1e-100;
        let ends = [Tails { below: LEAST, above: 1.0 }, Tails { below: 1.0, above: LEAST }];
        let [low, high] = ends.map(|tails| self.family.quantile(tails));
        let near = x.clamp(low, high);
        let tails = self.family.tails(near);
        let lower = tails.below <= tails.above;
        let score = if lower { normal::quantile(tails.below) } else { -normal::quantile(tails.above) };
        score + (x - near) * self.family.density(near) / normal::density(score)
    }

    /// Mean, in the unit of the quantity: a closed form of the family, or of a truncated one by quadrature to a
    /// relative error of about 1e-12.
    pub fn mean(&self) -> f64 {
        if self.is_truncated() { moments_of_quantile(|tails| self.quantile_of(tails)).0 } else { self.family.mean() }
    }

    /// Standard deviation, in the unit of the quantity, computed as the mean is.
    pub fn deviation(&self) -> f64 {
        if self.is_truncated() {
            moments_of_quantile(|tails| self.quantile_of(tails)).1
        } else {
            self.family.deviation()
        }
    }

    fn is_truncated(&self) -> bool {
        self.low.is_some() || self.high.is_some()
    }
}

fn finite(what: &str, value: f64) -> Result<(), Error> {
    ensure(value.is_finite(), || format!("{what} is {value}, but must be finite"))
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

/// Family of a distribution and its parameters, in the unit of the quantity.
#[derive(Clone, Copy, Debug, PartialEq)]
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
struct Tails {
    /// Probability of at most the value.
    pub below: f64,
    /// Probability of more than the value.
    pub above: f64,
}

impl Family {
    fn check(self) -> Result<Self, Error> {
        let positive = |what, value: f64| {
            ensure(value > 0.0 && value.is_finite(), || format!("{what} is {value}, but must be positive and finite"))
        };
        match self {
            Self::Uniform { low, high } => {
                finite("the lower end", low)?;
                finite("the upper end", high)?;
                ensure(low < high && (high - low).is_finite(), || {
                    format!("the lower end {low} must be below the upper end {high}, at a finite distance")
                })?;
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
        finite("the mean", self.mean())?;
        finite("the standard deviation", self.deviation())?;
        Ok(self)
    }

    /// Mean and standard deviation of the logarithm of a log-normal quantity.
    fn of_logarithm(mean: f64, deviation: f64) -> (f64, f64) {
        let variance = libm::log1p((deviation / mean) * (deviation / mean));
        (libm::log(mean) - 0.5 * variance, variance.sqrt())
    }

    fn tails(self, x: f64) -> Tails {
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
    fn quantile(self, tails: Tails) -> f64 {
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

    fn density(self, x: f64) -> f64 {
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

    fn mean(self) -> f64 {
        match self {
            Self::Uniform { low, high } => low + 0.5 * (high - low),
            Self::Normal { mean, .. } | Self::LogNormal { mean, .. } => mean,
            Self::Weibull { scale, shape } => scale * libm::tgamma(1.0 + 1.0 / shape),
        }
    }

    fn deviation(self) -> f64 {
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

/// Mean and standard deviation, as integrals of the quantile over the probability.
///
/// Quadrature by the tanh–sinh rule (Takahasi, Mori 1974), whose nodes are known from either end and so resolve both
/// tails: p = 1/(1 + exp(−π sinh t)).
fn moments_of_quantile(quantile: impl Fn(Tails) -> f64) -> (f64, f64) {
    let nodes: Vec<(f64, f64)> = (-STEPS..=STEPS).map(|step| node(f64::from(step) * STEP, &quantile)).collect();
    let total: f64 = nodes.iter().map(|(weight, _)| weight).sum();
    let integral = |of: &dyn Fn(f64) -> f64| nodes.iter().map(|&(weight, x)| weight * of(x)).sum::<f64>() / total;
    // The first pass only centres the second, which then cancels nothing.
    let about = integral(&|x| x);
    let mean = about + integral(&|x| x - about);
    (mean, integral(&|x| (x - mean) * (x - mean)).sqrt())
}

const STEP: f64 = 1.0 / 64.0;
/// Up to t = 4.5, where a tail of 1e-61 is left.
const STEPS: i32 = 288;

/// Weight and value at `t`.
fn node(t: f64, quantile: impl Fn(Tails) -> f64) -> (f64, f64) {
    let exponent = 2.0 * FRAC_PI_2 * libm::sinh(t);
    let (up, down) = (libm::exp(exponent), libm::exp(-exponent));
    let tails = Tails { below: 1.0 / (1.0 + down), above: 1.0 / (1.0 + up) };
    (libm::cosh(t) * tails.below * tails.above, quantile(tails))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use statrs::distribution::{Continuous, ContinuousCDF};

    use crate::normal;

    fn families() -> Vec<Distribution> {
        let made = [
            Distribution::uniform(-1.0, 3.0),
            Distribution::normal(12e-6, 1e-6),
            Distribution::log_normal(10.0, 4.0),
            Distribution::log_normal(1.0, 1e-3),
            Distribution::weibull(2.0, 0.7),
            Distribution::weibull(40e6, 12.0),
        ];
        made.map(Result::unwrap).to_vec()
    }

    /// How far the probability of a quantile is from `p`, over what is allowed: 1e-12 p and four units of the value.
    fn excess(distribution: &Distribution, p: f64) -> f64 {
        let x = distribution.quantile(p);
        assert!(x.is_finite(), "{distribution:?} at {p:e}");
        let rounding = 4.0 * f64::EPSILON * x.abs() * distribution.density(x);
        (distribution.cumulative(x) - p).abs() / (1e-12 * p + rounding)
    }

    #[test]
    fn quantiles_have_their_probability_in_far_tails() {
        let mut probabilities: Vec<f64> = (1..120).map(|step| 10.0_f64.powf(-0.1 * f64::from(step))).collect();
        probabilities.extend((1..120).map(|step| 1.0 - 10.0_f64.powf(-0.1 * f64::from(step))));
        for distribution in families() {
            let worst = probabilities.iter().map(|&p| excess(&distribution, p)).fold(0.0, f64::max);
            println!("{:?}: {worst:.2} of what is allowed", distribution.family());
            assert!(worst < 1.0, "{distribution:?}: {worst}");
        }
    }

    #[test]
    fn quantiles_of_truncated_distributions_have_their_probability() {
        let standard = Distribution::normal(0.0, 1.0).unwrap();
        let ends = [
            (Some(-2.0), Some(3.0)),
            (Some(8.0), Some(10.0)),
            (Some(30.0), None),
            (None, Some(-30.0)),
            (None, Some(-1e-3)),
            (Some(-1e-9), Some(1e-9)),
            (Some(-40.0), Some(40.0)),
        ];
        for (low, high) in ends {
            let truncated = standard.truncated(low, high).unwrap();
            for p in [1e-12, 1e-9, 1e-3, 0.3, 0.5, 0.9, 1.0 - 1e-9, 1.0 - 1e-12] {
                // Between bounds that lie close, the difference of two tails has fewer digits than either.
                let tail =
                    standard.cumulative(truncated.quantile(p)).min(1.0 - standard.cumulative(truncated.quantile(p)));
                let cancelled = 4.0 * f64::EPSILON * tail / truncated.left;
                let x = truncated.quantile(p);
                let allowed = 1e-12 * p + 8.0 * f64::EPSILON * x.abs() * truncated.density(x) + cancelled;
                let error = (truncated.cumulative(x) - p).abs();
                assert!(error < allowed, "{low:?} {high:?} at {p:e}: {error:e} of {allowed:e}");
            }
        }
    }

    /// Above 30 deviations the excess is nearly exponential: 1 − F = φ(x)/x (1 − 1/x² + 3/x⁴ − …) is known to 1e-13.
    #[test]
    fn a_far_tail_agrees_with_the_asymptotic_series() {
        let survival = |x: f64| {
            let y = 1.0 / (x * x);
            -0.5 * x * x - x.ln()
                + (1.0 - y * (1.0 - 3.0 * y * (1.0 - 5.0 * y * (1.0 - 7.0 * y * (1.0 - 9.0 * y))))).ln()
        };
        let truncated = Distribution::normal(0.0, 1.0).unwrap().truncated(Some(30.0), None).unwrap();
        for p in [1e-6, 0.1, 0.5, 0.999] {
            let above = (survival(truncated.quantile(p)) - survival(30.0)).exp();
            assert!((1.0 - above - p).abs() < 1e-12, "{p}: {above}");
        }
    }

    /// That of a normal quantity is linear without end, whatever truncates it; others rise everywhere.
    #[test]
    fn normal_scores_have_a_slope_far_out() {
        let normal = Distribution::normal(1.6, 0.02).unwrap().truncated(Some(0.1), Some(1.7)).unwrap();
        for deviations in [-55.0, -30.0, -8.0, -0.5, 0.0, 3.0, 20.0, 40.0] {
            let score = normal.normal_score(1.6 + 0.02 * deviations);
            assert!((score - deviations).abs() < 1e-9 * f64::max(1.0, score.abs()), "{score} at {deviations}");
        }
        for positive in [Distribution::log_normal(10.0, 0.4).unwrap(), Distribution::weibull(10.0, 12.0).unwrap()] {
            let scores: Vec<f64> = (0..100).map(|place| positive.normal_score(0.5 * f64::from(place))).collect();
            assert!(scores.windows(2).all(|pair| pair[1] > pair[0] + 0.01), "{positive}: {scores:?}");
        }
    }

    /// Value, cumulative probability and density of the log-normal distribution of mean 10 and deviation 4, by the C
    /// library's `erfc`; the one of statrs is only good to 1e-10.
    const LOG_NORMAL: [(f64, f64, f64); 5] = [
        (0.01, 1.0707062412851796e-70, 4.94530980622317e-67),
        (0.5, 1.6832980634229472e-14, 6.738396263768756e-13),
        (1.0, 3.643265109118171e-09, 5.6249187354156764e-08),
        (7.0, 0.231720351158971, 0.11306638892780523),
        (20.0, 0.9768049098310748, 0.007122466946359408),
    ];

    #[test]
    fn other_implementations_give_the_same() {
        let same = |ours: f64, other: f64| assert!((ours / other - 1.0).abs() < 1e-12, "{ours:e} is not {other:e}");
        let log_normal = Distribution::log_normal(10.0, 4.0).unwrap();
        for (x, cumulative, density) in LOG_NORMAL {
            same(log_normal.cumulative(x), cumulative);
            same(log_normal.density(x), density);
        }
        let weibull = Distribution::weibull(2.0, 0.7).unwrap();
        let other = statrs::distribution::Weibull::new(0.7, 2.0).unwrap();
        for x in [0.01, 0.5, 1.0, 7.0, 20.0] {
            same(weibull.cumulative(x), other.cdf(x));
            same(weibull.density(x), other.pdf(x));
        }
    }

    #[test]
    fn moments_by_quadrature_are_those_of_the_closed_forms() {
        for whole in families() {
            let (mean, deviation) = moments_of_quantile(|tails| whole.quantile_of(tails));
            let errors = [mean / whole.mean() - 1.0, deviation / whole.deviation() - 1.0];
            println!("{:?}: relative errors {:.1e}, {:.1e}", whole.family(), errors[0], errors[1]);
            assert!(errors.iter().all(|error| error.abs() < 1e-12), "{whole:?}: {errors:?}");
        }
    }

    #[test]
    fn a_truncated_normal_has_the_textbook_moments() {
        let (low, high): (f64, f64) = (-0.5, 1.25);
        let truncated = Distribution::normal(0.0, 1.0).unwrap().truncated(Some(low), Some(high)).unwrap();
        let left = normal::cumulative(high) - normal::cumulative(low);
        let [at_low, at_high] = [low, high].map(normal::density);
        let mean = (at_low - at_high) / left;
        let variance = 1.0 + (low * at_low - high * at_high) / left - mean * mean;
        assert!((truncated.mean() - mean).abs() < 1e-9, "{} {mean}", truncated.mean());
        assert!((truncated.deviation() - variance.sqrt()).abs() < 1e-9, "{} {variance}", truncated.deviation());
        // Beyond 30 deviations the excess is all but exponential with mean 1/x (1 − 1/x² …).
        let tail = Distribution::normal(0.0, 1.0).unwrap().truncated(Some(30.0), None).unwrap();
        assert!((tail.mean() - 30.0 - (1.0 / 30.0) * (1.0 - 2.0 / 900.0)).abs() < 1e-6, "{}", tail.mean());
    }

    #[test]
    fn parameters_out_of_range_are_refused() {
        let refused = |made: Result<Distribution, Error>| made.unwrap_err().to_string();
        let standard = Distribution::normal(0.0, 1.0).unwrap();
        assert!(refused(standard.truncated(Some(40.0), None)).contains("nothing is left"));
        for (made, expected) in [
            (Distribution::uniform(2.0, 1.0), "the lower end 2 must be below the upper end 1, at a finite distance"),
            (Distribution::normal(0.0, 0.0), "the standard deviation is 0, but must be positive and finite"),
            (Distribution::log_normal(-1.0, 1.0), "the mean is -1, but must be positive and finite"),
            (Distribution::weibull(1.0, 1e-3), "the mean is inf, but must be finite"),
            (
                standard.truncated(Some(1.0), Some(1.0)),
                "the lower end 1 must be below the upper end 1, at a finite distance",
            ),
            (standard.truncated(Some(f64::NAN), None), "the lower end is NaN, but must be finite"),
        ] {
            assert_eq!(refused(made), expected);
        }
    }

    proptest! {
        #[test]
        fn quantiles_stay_finite_and_between_the_ends(p in 1e-300_f64..1.0, low in -5.0_f64..5.0, width in 1e-3_f64..9.0) {
            for family in families() {
                prop_assert!(family.quantile(p.min(1.0 - f64::EPSILON / 2.0)).is_finite());
            }
            let truncated = Distribution::normal(0.0, 1.0).unwrap().truncated(Some(low), Some(low + width)).unwrap();
            prop_assert!((low..=low + width).contains(&truncated.quantile(p)));
        }
    }
}
