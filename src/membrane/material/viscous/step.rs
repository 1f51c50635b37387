//! Coefficients of a Prony series over one time step.

use super::Viscosity;
use crate::lane::{Lane, exp, splat};

/// Δt/τ below which the mean of the decay is its series.
const SHORT: f64 = 0.5;

/// Coefficients of a step, the same at every point. They are stored in every lane, so that kernels load them as they
/// load what they multiply.
#[derive(Clone, Debug, PartialEq)]
pub struct ViscousStep<const L: usize> {
    /// Of each term: the share of its overstress that is kept over the step, and the part of the change of the
    /// instantaneous stress that it takes up.
    pub(super) terms: Vec<[Lane<L>; 2]>,
    /// Change of the stress over that of the instantaneous one within the step.
    pub(super) fresh: f64,
}

impl<const L: usize> ViscousStep<L> {
    /// A step of `dt` ≥ 0 (s) over which the instantaneous stress changes steadily: exact (theory.md, equation 281).
    pub fn over(viscosity: &Viscosity, dt: f64) -> ViscousStep<L> {
        let of_term = |term: &super::PronyTerm| {
            let [kept, mean] = decay(dt / term.time);
            [kept, term.share * mean]
        };
        ViscousStep::from_terms(viscosity, viscosity.terms.iter().map(of_term).collect())
    }

    /// Mounting of film that is free of stress and rests then.
    pub fn mounting(viscosity: &Viscosity) -> ViscousStep<L> {
        let of_term = |term: &super::PronyTerm| [0.0, term.share * viscosity.left(term)];
        ViscousStep::from_terms(viscosity, viscosity.terms.iter().map(of_term).collect())
    }

    fn from_terms(viscosity: &Viscosity, terms: Vec<[f64; 2]>) -> ViscousStep<L> {
        let fresh = viscosity.long_term() + terms.iter().map(|[_, taken]| taken).sum::<f64>();
        let terms = terms.into_iter().map(|term| term.map(splat)).collect();
        ViscousStep { terms, fresh }
    }
}

/// e^(−x) and its mean (1 − e^(−x))/x from 0 to `x` ≥ 0, both within 2e-15 of themselves.
pub(super) fn decay(x: f64) -> [f64; 2] {
    if x < SHORT {
        // Σ (−x)ᵏ/(k + 1)!: what is left out is below 1e-18.
        let series = (2..=16).rev().fold(1.0, |rest, k| 1.0 - x / f64::from(k) * rest);
        return [1.0 - x * series, series];
    }
    if x > 700.0 {
        return [0.0, 1.0 / x];
    }
    let kept = exp(-x);
    [kept, (1.0 - kept) / x]
}
