//! What fits of laws report, by code.

use serde_json::{Map, Value};
use thiserror::Error;

use base::codes;
use base::finding::{Code, Report};
use base::number::significant;
use membrane::material::Tension;

codes! {
    UNIAXIAL_ONLY = "uniaxial-only", Warning,
        "a law was fitted to uniaxial tests alone: many sets of coefficients agree there and differ in biaxial tension, so \
         that film under a dart, a pressure or a head is predicted without any basis",
        "add an equibiaxial test, or one of plane tension (pure shear)";
    UNSTABLE_REJECTED = "unstable-fit-rejected", Note,
        "coefficients with smaller residuals were found, and the law is unstable with them in the range of stretch; the \
         best stable fit was taken",
        "none is needed; --stable-to changes the range, another law or more tests may fit better";
    UNSTABLE_IN_RANGE = "unstable-fit", Warning,
        "the fitted law is unstable in the range of stretch (Hill's criterion): its stresses fall while film is stretched, \
         and a run tears or collapses there",
        "fit another law, or ask for a smaller range with --stable-to";
    TERMS_LEFT_OUT = "terms-left-out", Note,
        "terms of a law have no stress in the best fit and are left out",
        "none is needed; the tests do not show more terms";
    COEFFICIENT_ON_BOUND = "coefficient-on-bound", Warning,
        "a coefficient of a fit lies on the bound of its range, so that the tests do not determine it",
        "fit a law with fewer coefficients, or add tests of another kind";
    NO_INTERVALS = "no-intervals", Warning,
        "the coefficients of a fit have no confidence intervals",
        "add measured points, or fit a law with fewer coefficients";
}

/// What a fit reports although it continues.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum Warning {
    /// All tests are uniaxial.
    #[error("fitted to uniaxial tests alone: unsafe for film that is stretched in two directions")]
    UniaxialOnly,
    /// A better fit is unstable.
    #[error(
        "a fit with residuals of {} in place of {} is unstable below the stretch {} and was not taken",
        significant(*unstable, 3), significant(*stable, 3), significant(*stable_to, 4)
    )]
    UnstableRejected {
        /// Norm of the residuals of the fit that was taken.
        stable: f64,
        /// That of the unstable one.
        unstable: f64,
        /// Stretch up to which the law is to be stable.
        stable_to: f64,
    },
    /// The law is unstable in the range that is asked for.
    #[error(
        "the law is unstable in {tension} from the stretch {} on, below {}",
        significant(*stretch, 4), significant(*stable_to, 4)
    )]
    UnstableInRange {
        /// Kind of tension.
        tension: Tension,
        /// Least stretch.
        stretch: f64,
        /// Stretch up to which the law is to be stable.
        stable_to: f64,
    },
    /// The law is unstable in a state that was measured.
    #[error("the law is unstable in a state that was measured")]
    UnstableWhereMeasured,
    /// Terms without stress are left out.
    #[error("{left} of {asked} terms are left: the others have no stress in the best fit")]
    TermsLeftOut {
        /// Number of terms that were asked for.
        asked: usize,
        /// Number of terms that are left.
        left: usize,
    },
    /// A coefficient lies on a bound.
    #[error("{coefficient} = {} lies on the bound of its range: the tests do not determine it", significant(*value, 4))]
    OnBound {
        /// Name of the coefficient.
        coefficient: String,
        /// Its value.
        value: f64,
    },
    /// There are no intervals.
    #[error("the coefficients have no intervals: {why}")]
    NoIntervals {
        /// Why.
        why: String,
    },
}

impl Report for Warning {
    fn code(&self) -> &'static Code {
        match self {
            Warning::UniaxialOnly => &UNIAXIAL_ONLY,
            Warning::UnstableRejected { .. } => &UNSTABLE_REJECTED,
            Warning::UnstableInRange { .. } | Warning::UnstableWhereMeasured => &UNSTABLE_IN_RANGE,
            Warning::TermsLeftOut { .. } => &TERMS_LEFT_OUT,
            Warning::OnBound { .. } => &COEFFICIENT_ON_BOUND,
            Warning::NoIntervals { .. } => &NO_INTERVALS,
        }
    }

    fn figures(&self) -> Map<String, Value> {
        let figures: Vec<(&str, Value)> = match self {
            Warning::UnstableRejected { stable, unstable, stable_to } => vec![
                ("residuals", (*stable).into()),
                ("unstable_residuals", (*unstable).into()),
                ("stable_to_stretch", (*stable_to).into()),
            ],
            Warning::UnstableInRange { tension, stretch, stable_to } => vec![
                ("tension", tension.to_string().into()),
                ("stretch", (*stretch).into()),
                ("stable_to_stretch", (*stable_to).into()),
            ],
            Warning::TermsLeftOut { asked, left } => vec![("asked", (*asked).into()), ("left", (*left).into())],
            Warning::OnBound { coefficient, value } => {
                vec![("coefficient", coefficient.as_str().into()), ("value", (*value).into())]
            }
            Warning::UniaxialOnly | Warning::UnstableWhereMeasured | Warning::NoIntervals { .. } => vec![],
        };
        figures.into_iter().map(|(name, value)| (name.into(), value)).collect()
    }
}
