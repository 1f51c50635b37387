//! Viscous film: a Prony series on the stress of an elastic, hyperelastic or fibre law.
//!
//! The stress of a law, of film that is strained at once, relaxes by the shares `g_i` with the times `τ_i`
//! (quasi-linear viscoelasticity; Simo 1987, Holzapfel 2000, section 6.10; theory.md, equations 280 to 288):
//!
//! ```text
//! S = (1 − Σ g_i) S° + Σ q_i ,   dq_i/dt = g_i dS°/dt − q_i/τ_i
//! ```
//!
//! It follows the law and precedes whatever reduces the stress afterwards: [`ViscousLaw::advance`] replaces the stress
//! that a law returned, the same for every law.

mod point;
#[cfg(test)]
mod tests;

pub use point::ViscousLaw;

use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::lane::{Lane, exp, splat};

/// One term of a Prony series: the share of the stiffness that relaxes with a time.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct PronyTerm {
    /// Share g of the instantaneous stress.
    pub share: f64,
    /// Relaxation time τ, s.
    pub time: f64,
}

/// The film that the law as written describes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Written {
    /// Film strained at once.
    #[default]
    Instantaneous,
    /// Film strained so slowly that all terms have relaxed.
    LongTerm,
}

/// A Prony series.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Viscosity {
    terms: Vec<PronyTerm>,
    written: Written,
    /// Time between mounting and loading, s; none where all terms have relaxed.
    rest: Option<f64>,
}

/// Why terms are no Prony series.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum ViscosityError {
    /// There is no term.
    #[error("a Prony series has at least one term")]
    Empty,
    /// A share is not above zero, or a time is not above zero, or one of them is not finite.
    #[error("share and time of a term are above zero")]
    InvalidTerm {
        /// Its place.
        index: usize,
    },
    /// The shares leave nothing that does not relax.
    #[error("the shares sum to {sum}, and film that has relaxed would carry nothing")]
    NothingLeft {
        /// Σ g.
        sum: f64,
    },
}

impl Viscosity {
    /// The series of these terms on a law of film strained at once; the film has relaxed when it is loaded.
    ///
    /// # Errors
    /// [`ViscosityError`] where the terms are no Prony series.
    pub fn new(terms: Vec<PronyTerm>) -> Result<Viscosity, ViscosityError> {
        if terms.is_empty() {
            return Err(ViscosityError::Empty);
        }
        let is_valid = |term: &PronyTerm| [term.share, term.time].iter().all(|value| *value > 0.0 && value.is_finite());
        if let Some(index) = terms.iter().position(|term| !is_valid(term)) {
            return Err(ViscosityError::InvalidTerm { index });
        }
        let sum: f64 = terms.iter().map(|term| term.share).sum();
        if sum >= 1.0 {
            return Err(ViscosityError::NothingLeft { sum });
        }
        Ok(Viscosity { terms, written: Written::Instantaneous, rest: None })
    }

    /// This series on a law of film that is `written`.
    pub fn with_written(self, written: Written) -> Viscosity {
        Viscosity { written, ..self }
    }

    /// This film, mounted at once and loaded `rest` (s) later.
    pub fn rested(self, rest: f64) -> Viscosity {
        Viscosity { rest: Some(rest), ..self }
    }

    /// This film with all times multiplied by `factor`, a_T.
    pub fn shifted(mut self, factor: f64) -> Viscosity {
        self.terms.iter_mut().for_each(|term| term.time *= factor);
        self
    }

    /// The terms.
    pub fn terms(&self) -> &[PronyTerm] {
        &self.terms
    }

    /// 1 − Σ g: the share of the instantaneous stress that does not relax.
    pub fn long_term(&self) -> f64 {
        1.0 - self.terms.iter().map(|term| term.share).sum::<f64>()
    }

    /// Instantaneous stress over that of the law as written.
    pub fn instant(&self) -> f64 {
        match self.written {
            Written::Instantaneous => 1.0,
            Written::LongTerm => 1.0 / self.long_term(),
        }
    }

    /// Stress of mounted film over that of the law as written, once the film has rested.
    pub fn mounted(&self) -> f64 {
        let overstress: f64 = self.terms.iter().map(|term| term.share * self.left(term)).sum();
        self.instant() * (self.long_term() + overstress)
    }

    /// Share of a term's stress that is left after mounting and rest.
    fn left(&self, term: &PronyTerm) -> f64 {
        self.rest.map_or(0.0, |rest| decay(rest / term.time)[0])
    }

    /// History variables at an integration point.
    pub fn variables(&self) -> usize {
        point::FIRST_TERM + 3 * self.terms.len()
    }
}

/// Δt/τ below which the mean of the decay is its series.
const SHORT: f64 = 0.5;

/// Coefficients of a step, the same at every point. They are stored in every lane, so that kernels load them as they
/// load what they multiply.
#[derive(Clone, Debug, PartialEq)]
pub struct ViscousStep<const L: usize> {
    /// Of each term: the share of its overstress that is kept over the step, and the part of the change of the
    /// instantaneous stress that it takes up.
    terms: Vec<[Lane<L>; 2]>,
    /// Change of the stress over that of the instantaneous one within the step.
    fresh: f64,
}

impl<const L: usize> ViscousStep<L> {
    /// A step of `dt` ≥ 0 (s) over which the instantaneous stress changes steadily: exact (theory.md, equation 281).
    pub fn over(viscosity: &Viscosity, dt: f64) -> ViscousStep<L> {
        let of_term = |term: &PronyTerm| {
            let [kept, mean] = decay(dt / term.time);
            [kept, term.share * mean]
        };
        ViscousStep::from_terms(viscosity, viscosity.terms.iter().map(of_term).collect())
    }

    /// Mounting of film that is free of stress and rests then.
    pub fn mounting(viscosity: &Viscosity) -> ViscousStep<L> {
        let of_term = |term: &PronyTerm| [0.0, term.share * viscosity.left(term)];
        ViscousStep::from_terms(viscosity, viscosity.terms.iter().map(of_term).collect())
    }

    fn from_terms(viscosity: &Viscosity, terms: Vec<[f64; 2]>) -> ViscousStep<L> {
        let fresh = viscosity.long_term() + terms.iter().map(|[_, taken]| taken).sum::<f64>();
        let terms = terms.into_iter().map(|term| term.map(splat)).collect();
        ViscousStep { terms, fresh }
    }
}

/// e^(−x) and its mean (1 − e^(−x))/x from 0 to `x` ≥ 0, both within 2e-15 of themselves.
fn decay(x: f64) -> [f64; 2] {
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

/// Molar gas constant (CODATA 2018, exact), J/(mol K).
pub const GAS_CONSTANT: f64 = 8.314_462_618_153_24;

/// log₁₀ a_T = −c₁ (T − T_r)/(c₂ + T − T_r) (Williams, Landel and Ferry, J. Am. Chem. Soc. 77, 1955; theory.md,
/// equation 287).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Wlf {
    /// c₁.
    pub c1: f64,
    /// c₂, K.
    pub c2: f64,
    /// T_r, K.
    pub reference: f64,
}

/// ln a_T = E/R (1/T − 1/T_r) (theory.md, equation 287).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Arrhenius {
    /// Activation energy E, J/mol.
    pub energy: f64,
    /// T_r, K.
    pub reference: f64,
}

/// A factor on relaxation times.
pub trait ShiftFactor {
    /// a_T at `temperature` (K): relaxation times there over those at the reference temperature; none where the
    /// equation has no value.
    fn factor_at(&self, temperature: f64) -> Option<f64>;
}

impl ShiftFactor for Wlf {
    fn factor_at(&self, temperature: f64) -> Option<f64> {
        let above = temperature - self.reference;
        let factor = 10.0_f64.powf(-self.c1 * above / (self.c2 + above));
        (self.c2 + above > 0.0 && factor.is_normal()).then_some(factor)
    }
}

impl ShiftFactor for Arrhenius {
    fn factor_at(&self, temperature: f64) -> Option<f64> {
        let factor = (self.energy / GAS_CONSTANT * (1.0 / temperature - 1.0 / self.reference)).exp();
        factor.is_normal().then_some(factor)
    }
}
