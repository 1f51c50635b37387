//! Mean and deviation of a distribution that is known by its quantiles.

use std::f64::consts::FRAC_PI_2;

use super::family::Tails;

/// Mean and standard deviation, as integrals of the quantile over the probability.
///
/// Quadrature by the tanh–sinh rule (Takahasi, Mori 1974), whose nodes are known from either end and so resolve both
/// tails: p = 1/(1 + exp(−π sinh t)).
pub(super) fn of_quantile(quantile: impl Fn(Tails) -> f64) -> (f64, f64) {
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
