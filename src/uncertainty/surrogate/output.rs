//! Surrogate of one output, which may not vary.

use super::{Family, Options, Polynomials, Surrogate, SurrogateError};
use crate::statistics::variance;

/// An output as a function of the inputs: a polynomial chaos, or a constant where it is the same in all samples.
#[derive(Clone, Debug, PartialEq)]
pub struct Output {
    kind: Kind,
    error: f64,
}

#[derive(Clone, Debug, PartialEq)]
enum Kind {
    Constant(f64),
    Varying(Surrogate),
}

impl Output {
    /// Fits outputs at points of the open unit cube.
    ///
    /// # Errors
    /// See [`SurrogateError`].
    pub fn fit(
        families: &[Family],
        points: &[Vec<f64>],
        outputs: &[f64],
        options: &Options,
    ) -> Result<Output, SurrogateError> {
        if let Some(first) = outputs.first().filter(|first| outputs.iter().all(|output| output == *first)) {
            return Ok(Output { kind: Kind::Constant(*first), error: 0.0 });
        }
        let given: Vec<Option<f64>> = outputs.iter().copied().map(Some).collect();
        let surrogate = Surrogate::fit(families, points, &given, options)?;
        let error = variance(outputs).unwrap_or(0.0) * (1.0 - surrogate.q2()).max(0.0);
        Ok(Output { kind: Kind::Varying(surrogate), error })
    }

    /// Its value at a point of the open unit cube.
    ///
    /// # Panics
    /// The point has another number of coordinates than the fit.
    pub fn at(&self, point: &[f64]) -> f64 {
        match &self.kind {
            Kind::Constant(value) => *value,
            Kind::Varying(surrogate) => surrogate.predict(point),
        }
    }

    /// Variance of its error, by cross-validation.
    pub fn error(&self) -> f64 {
        self.error
    }

    /// The polynomial chaos of an output that varies.
    pub(super) fn surrogate(&self) -> Option<&Surrogate> {
        match &self.kind {
            Kind::Constant(_) => None,
            Kind::Varying(surrogate) => Some(surrogate),
        }
    }

    /// Its value where the polynomials of the inputs have these values, of at least its degree.
    pub(super) fn with(&self, values: &Polynomials) -> f64 {
        match &self.kind {
            Kind::Constant(value) => *value,
            Kind::Varying(surrogate) => surrogate.sum_of_terms(values),
        }
    }
}
