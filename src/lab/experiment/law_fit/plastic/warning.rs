//! What the fit of a plastic law reports.

use std::fmt;

use serde_json::{Map, Value};

use super::PlasticDirection;
use base::codes;
use base::finding::{Code, Report};
use base::number::significant;

codes! {
    UNLOADING_NOT_MEASURED = "unloading-not-measured", Warning,
        "the coupons were only stretched, so nothing shows what part of their strain stays as a set: it is taken to be what is \
         beyond the stress over the modulus, as in film that unloads along its first slope",
        "unload some coupons and compare their set with the plastic strain of the law; film that recovers is not plastic";
    YIELD_RATIO_ASSUMED = "yield-ratio-assumed", Note,
        "no coupon shows a ratio of yield stress, which is taken as 1, that of isotropic film",
        "measure coupons in this direction, or the width of the others";
    HARDENING_SCATTERS = "hardening-scatters", Note,
        "the fitted law differs from a coupon by more than coupons of one direction do from each other",
        "look at the coupon; isotropic hardening has one shape of curve for all directions";
}

/// A finding of the fit.
#[derive(Clone, Debug, PartialEq)]
pub enum Warning {
    /// Coupons that were only stretched.
    UnloadingNotMeasured,
    /// A ratio that no coupon shows.
    RatioAssumed {
        /// Its key.
        key: &'static str,
        /// The direction of coupons that would show it.
        direction: PlasticDirection,
    },
    /// A coupon that the law does not follow.
    Scatters {
        /// Name of the coupon.
        name: String,
        /// Largest difference over the largest stress.
        difference: f64,
        /// Largest difference of coupons of one direction over their stress.
        scatter: f64,
    },
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Warning::UnloadingNotMeasured => write!(
                f,
                "no coupon was unloaded: the plastic strain is what exceeds the stress over the modulus, assumed"
            ),
            Warning::RatioAssumed { key, direction } => {
                write!(f, "no coupon along {direction}: `{key}` is 1, assumed")
            }
            Warning::Scatters { name, difference, scatter } => write!(
                f,
                "{name}: the law differs by up to {} %, coupons of one direction by up to {} %",
                significant(100.0 * difference, 2),
                significant(100.0 * scatter, 2)
            ),
        }
    }
}

impl Report for Warning {
    fn code(&self) -> &'static Code {
        match self {
            Warning::UnloadingNotMeasured => &UNLOADING_NOT_MEASURED,
            Warning::RatioAssumed { .. } => &YIELD_RATIO_ASSUMED,
            Warning::Scatters { .. } => &HARDENING_SCATTERS,
        }
    }

    fn figures(&self) -> Map<String, Value> {
        let figures: Vec<(&str, Value)> = match self {
            Warning::UnloadingNotMeasured => vec![],
            Warning::RatioAssumed { key, .. } => vec![("key", (*key).into())],
            Warning::Scatters { name, difference, scatter } => vec![
                ("coupon", name.as_str().into()),
                ("difference", (*difference).into()),
                ("scatter", (*scatter).into()),
            ],
        };
        figures.into_iter().map(|(name, value)| (name.into(), value)).collect()
    }
}
