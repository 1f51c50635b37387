//! What fits of relaxation report, by code.

use serde_json::{Map, Value};
use thiserror::Error;

use base::codes;
use base::finding::{Code, Report};

codes! {
    PRONY_TERMS_LEFT_OUT = "prony-terms-left-out", Note,
        "terms of a Prony series have no share in the best fit and are left out",
        "none is needed; runs cost less with fewer terms";
}

/// What a fit reports although it continues.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum Warning {
    /// Terms without a share are left out.
    #[error("{left} of {asked} terms are left: the others have no share in the best fit")]
    TermsLeftOut {
        /// Number of terms that were asked for.
        asked: usize,
        /// Number of terms that are left.
        left: usize,
    },
}

impl Report for Warning {
    fn code(&self) -> &'static Code {
        match self {
            Warning::TermsLeftOut { .. } => &PRONY_TERMS_LEFT_OUT,
        }
    }

    fn figures(&self) -> Map<String, Value> {
        let figures: Vec<(&str, Value)> = match self {
            Warning::TermsLeftOut { asked, left } => vec![("asked", (*asked).into()), ("left", (*left).into())],
        };
        figures.into_iter().map(|(name, value)| (name.into(), value)).collect()
    }
}
