//! What fits of relaxation report, by code.

use serde_json::{Map, Value};
use thiserror::Error;

use crate::finding::{Code, Report, codes};
use crate::number::significant;

codes! {
    PRONY_TERMS_LEFT_OUT = "prony-terms-left-out", Note,
        "terms of a Prony series have no share in the best fit and are left out",
        "none is needed; runs cost less with fewer terms";
    POISSON_ASSUMED = "poisson-assumed", Warning,
        "no Poisson's ratio was given, so the material file states one that is assumed",
        "give --poisson";
    MATERIAL_INCOMPLETE = "material-incomplete", Warning,
        "the material file lacks keys that a material needs, since they were not given: a scenario cannot use it before they \
         are written",
        "give --density and --thickness, or write them into the file or into the scenario that names it";
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
    /// Poisson's ratio is assumed.
    #[error("Poisson's ratio in the material file is assumed: {}", significant(*poisson, 3))]
    PoissonAssumed {
        /// As assumed.
        poisson: f64,
    },
    /// Keys of the material file were not given.
    #[error("the material file lacks {keys}: not given")]
    MaterialIncomplete {
        /// The keys in words.
        keys: String,
    },
}

impl Report for Warning {
    fn code(&self) -> &'static Code {
        match self {
            Warning::TermsLeftOut { .. } => &PRONY_TERMS_LEFT_OUT,
            Warning::PoissonAssumed { .. } => &POISSON_ASSUMED,
            Warning::MaterialIncomplete { .. } => &MATERIAL_INCOMPLETE,
        }
    }

    fn figures(&self) -> Map<String, Value> {
        let figures: Vec<(&str, Value)> = match self {
            Warning::TermsLeftOut { asked, left } => vec![("asked", (*asked).into()), ("left", (*left).into())],
            Warning::PoissonAssumed { poisson } => vec![("poisson", (*poisson).into())],
            Warning::MaterialIncomplete { keys } => vec![("keys", keys.as_str().into())],
        };
        figures.into_iter().map(|(name, value)| (name.into(), value)).collect()
    }
}
