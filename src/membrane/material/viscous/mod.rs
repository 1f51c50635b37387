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
mod shift;
mod step;
#[cfg(test)]
mod tests;

pub use point::ViscousLaw;
pub use shift::{Arrhenius, GAS_CONSTANT, ShiftFactor, Wlf};
pub use step::ViscousStep;

use serde::{Deserialize, Serialize};
use thiserror::Error;

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
        self.rest.map_or(0.0, |rest| step::decay(rest / term.time)[0])
    }

    /// History variables at an integration point.
    pub fn variables(&self) -> usize {
        point::FIRST_TERM + 3 * self.terms.len()
    }
}
