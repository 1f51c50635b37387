use proptest::prelude::*;
use statrs::distribution::{Continuous, ContinuousCDF};

use super::*;
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
            let tail = standard.cumulative(truncated.quantile(p)).min(1.0 - standard.cumulative(truncated.quantile(p)));
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
        -0.5 * x * x - x.ln() + (1.0 - y * (1.0 - 3.0 * y * (1.0 - 5.0 * y * (1.0 - 7.0 * y * (1.0 - 9.0 * y))))).ln()
    };
    let truncated = Distribution::normal(0.0, 1.0).unwrap().truncated(Some(30.0), None).unwrap();
    for p in [1e-6, 0.1, 0.5, 0.999] {
        let above = (survival(truncated.quantile(p)) - survival(30.0)).exp();
        assert!((1.0 - above - p).abs() < 1e-12, "{p}: {above}");
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
        let (mean, deviation) = moments::of_quantile(|tails| whole.quantile_of(tails));
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
    let refused = |made: Result<Distribution, DistributionError>| made.unwrap_err().to_string();
    assert_eq!(
        refused(Distribution::uniform(2.0, 1.0)),
        "the lower end 2 must be below the upper end 1, at a finite distance"
    );
    assert_eq!(refused(Distribution::normal(0.0, 0.0)), "the standard deviation is 0, but must be positive and finite");
    assert_eq!(refused(Distribution::log_normal(-1.0, 1.0)), "the mean is -1, but must be positive and finite");
    assert_eq!(refused(Distribution::weibull(1.0, 1e-3)), "the mean is inf, but must be finite");
    let standard = Distribution::normal(0.0, 1.0).unwrap();
    assert!(refused(standard.truncated(Some(40.0), None)).contains("nothing is left"));
    assert!(matches!(standard.truncated(Some(1.0), Some(1.0)), Err(DistributionError::Ends { .. })));
    assert!(matches!(standard.truncated(Some(f64::NAN), None), Err(DistributionError::NotFinite { .. })));
}

#[test]
fn what_is_read_is_checked_and_what_is_written_is_read_back() {
    let truncated = Distribution::weibull(2.0, 3.0).unwrap().truncated(Some(0.5), None).unwrap();
    let text = serde_json::to_string(&truncated).unwrap();
    assert_eq!(text, r#"{"weibull":{"scale":2.0,"shape":3.0},"low":0.5}"#);
    assert_eq!(serde_json::from_str::<Distribution>(&text).unwrap(), truncated);
    let bad = r#"{"normal":{"mean":1.0,"deviation":-1.0}}"#;
    let message = serde_json::from_str::<Distribution>(bad).unwrap_err().to_string();
    assert!(message.contains("the standard deviation is -1"), "{message}");
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
