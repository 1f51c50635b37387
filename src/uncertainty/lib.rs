//! Inputs that vary and what follows for outputs (docs/methods.md, section 26): pure mathematics that knows nothing else of
//! droptower.
//!
//! [`distribution`] says how an input varies, [`design`] which points of the unit cube a study evaluates, and
//! [`correlation`] couples them. [`effects`] and [`surrogate`] tell which inputs matter.
//!
//! Every design and every estimate is decided by its seed, with the same bits on every machine: random numbers are of
//! ChaCha8, elementary functions of `libm`, and no matrix product depends on the processor. Compiled and tested alone:
//! `cargo test --release -p droptower-uncertainty`.
#![warn(missing_docs)]

pub mod normal;
pub mod random;
pub mod distribution;
pub mod design;
pub mod correlation;
pub mod statistics;
pub mod surrogate;
pub mod effects;
pub mod reliability;
pub mod staircase;
pub mod ensemble;

/// Why there is no result.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{message}")]
pub struct Error {
    /// What callers tell apart.
    pub kind: Kind,
    message: String,
}

/// The kind of an error.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// What was given is not valid.
    Input,
    /// Outcomes of specimens have no fit.
    NoFit,
    /// No level of subset simulation leads on to failure.
    NoProgress,
}

impl Error {
    /// Input that is not valid.
    pub fn new(message: impl Into<String>) -> Error {
        Error { kind: Kind::Input, message: message.into() }
    }

    /// The same message with another kind.
    pub(crate) fn of_kind(self, kind: Kind) -> Error {
        Error { kind, ..self }
    }
}

/// Refuses input for which something does not hold, in the words of `message`.
pub(crate) fn ensure<M: Into<String>>(holds: bool, message: impl FnOnce() -> M) -> Result<(), Error> {
    if holds { Ok(()) } else { Err(Error::new(message())) }
}

#[cfg(test)]
mod functions {
    //! Functions whose indices are known in closed form.

    use std::f64::consts::PI;

    /// Function of Ishigami and Homma (1990), a = 7, b = 0.1, over (−π, π)³, at a point of the unit cube.
    pub(crate) fn ishigami(u: &[f64]) -> f64 {
        let x: Vec<f64> = u.iter().map(|u| PI * (2.0 * u - 1.0)).collect();
        x[0].sin() + 7.0 * x[1].sin().powi(2) + 0.1 * x[2].powi(4) * x[0].sin()
    }

    /// First-order and total indices of [`ishigami`], and its variance.
    pub(crate) fn ishigami_indices() -> ([f64; 3], [f64; 3], f64) {
        let (a, b) = (7.0, 0.1);
        let first = 0.5 * (1.0 + b * PI.powi(4) / 5.0_f64).powi(2);
        let second = a * a / 8.0;
        let both = b * b * PI.powi(8) * 8.0 / 225.0;
        let variance = first + second + both;
        ([first, second, 0.0].map(|v| v / variance), [first + both, second, both].map(|v| v / variance), variance)
    }

    /// The g-function (Saltelli, Sobol' 1995) with coefficients `a`.
    pub(crate) fn g(a: &[f64], u: &[f64]) -> f64 {
        a.iter().zip(u).map(|(a, u)| ((4.0 * u - 2.0).abs() + a) / (1.0 + a)).product()
    }

    /// First-order and total indices of [`g`].
    pub(crate) fn g_indices(a: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let own: Vec<f64> = a.iter().map(|a| 1.0 / (3.0 * (1.0 + a) * (1.0 + a))).collect();
        let all: f64 = own.iter().map(|v| 1.0 + v).product();
        let variance = all - 1.0;
        (own.iter().map(|v| v / variance).collect(), own.iter().map(|v| v * all / (1.0 + v) / variance).collect())
    }
}
