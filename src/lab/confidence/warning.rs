//! What puts confidence intervals in doubt.

use serde::Serialize;
use serde_json::{Map, Value};
use thiserror::Error;

use base::codes;
use base::finding::{Code, Report};
use base::number;

/// A warning about a confidence interval.
#[derive(Clone, Debug, PartialEq, Error, Serialize)]
#[serde(untagged)]
pub enum Warning {
    /// The residuals do not depend on a combination of parameters.
    #[error("{combination} is not identifiable: it has no effect on the residuals")]
    NoEffect {
        /// The combination, such as `k1·ke^-0.8`.
        combination: String,
    },
    /// The confidence interval of a combination of parameters is wide in the linear model.
    #[error(
        "{combination} is poorly determined: in the linear model its interval of 95 % reaches a factor {}",
        number::figure(*.factor, 2)
    )]
    PoorlyDetermined {
        /// The combination.
        combination: String,
        /// Half-width of its interval of 95 %, as a factor.
        factor: f64,
    },
    /// The effect of a combination is small beside that of the best-determined one.
    #[error(
        "{combination} is weakly identifiable: its effect on the residuals is {} times smaller than that of the \
         best-determined combination, and small errors of model or sensor change it",
        number::figure(*.ratio, 2)
    )]
    WeaklyIdentifiable {
        /// The combination.
        combination: String,
        /// Largest singular value over its own.
        ratio: f64,
    },
    /// Two parameters are strongly correlated.
    #[error("{} and {} are correlated by {}", .parameters[0], .parameters[1], number::figure(*.correlation, 3))]
    Correlated {
        /// The two.
        parameters: [String; 2],
        /// Their coefficient of correlation.
        correlation: f64,
    },
    /// The residuals are so strongly correlated that few independent ones are left.
    #[error(
        "the {samples} residuals are correlated and count as {} independent ones for {parameters} parameters: they \
         show model error rather than noise, which the intervals do not cover",
        number::significant(*.effective_samples, 3)
    )]
    FewIndependentResiduals {
        /// Number of residuals.
        samples: usize,
        /// Effective number of independent residuals.
        effective_samples: f64,
        /// Number of parameters.
        parameters: usize,
    },
    /// The residuals are no larger than the roughness of the model.
    #[error(
        "the residuals ({}) are no larger than the roughness of the model or its curvature over the step of the \
         differences ({}): the intervals do not show the scatter of measurements",
        number::figure(*.norm, 3),
        number::figure(*.roughness, 3)
    )]
    ResidualsBelowRoughness {
        /// Norm of the residuals.
        norm: f64,
        /// Largest second difference of the residuals.
        roughness: f64,
    },
    /// The derivative along a parameter is a one-sided difference.
    #[error(
        "the derivative along {parameter} is one-sided (bound or failed trial): its interval is valid on that side \
         at best"
    )]
    OneSided {
        /// The parameter.
        parameter: String,
    },
    /// The gradient along a parameter is not zero at the estimate.
    #[error(
        "{parameter} is not at its minimum: a Gauss-Newton step would move it by {} standard errors",
        number::figure(*.standard_errors, 2)
    )]
    NotAtMinimum {
        /// The parameter.
        parameter: String,
        /// Length of the step, standard errors.
        standard_errors: f64,
    },
}

codes! {
    NO_EFFECT = "no-effect", Warning,
        "the residuals do not depend on a combination of parameters, which is structurally not identifiable",
        "fix one parameter of the combination, or add data that depend on it";
    POORLY_DETERMINED = "poorly-determined", Warning,
        "the confidence interval of a combination of parameters reaches a factor of 1.5 in the linear model; whether it \
         has an end at all is what profiles tell",
        "compute profiles; fix one parameter of the combination, or add signals or tests to the objective";
    WEAKLY_IDENTIFIABLE = "weakly-identifiable", Warning,
        "the effect of a combination of parameters on the residuals is below 1 % of the largest: errors of model and \
         sensor determine it",
        "add data on which the combination has more effect";
    CORRELATED = "correlated", Warning,
        "the correlation of two parameters exceeds 0.95: a change of one is compensated by the other",
        "report both together, or add data that separate them";
    FEW_INDEPENDENT_RESIDUALS = "few-independent-residuals", Warning,
        "the residuals are so strongly correlated that they count as few independent ones: they show model error \
         rather than noise",
        "improve the model; the intervals do not cover its error";
    RESIDUALS_BELOW_ROUGHNESS = "residuals-below-roughness", Warning,
        "the residuals are no larger than the roughness or the curvature of the model over the step of the differences",
        "do not read the intervals as scatter of measurements; change `difference` if the objective is rough";
    ONE_SIDED = "one-sided", Warning,
        "the derivative along a parameter is a one-sided difference, since the other side lies beyond a bound or \
         failed",
        "move the bound, or use profiles for the interval of that parameter";
    NOT_AT_MINIMUM = "not-at-minimum", Warning,
        "a Gauss-Newton step from the estimate moves a parameter by more than half a standard error",
        "search again from the estimate with tighter tolerances";
}

impl Report for Warning {
    fn code(&self) -> &'static Code {
        match self {
            Warning::NoEffect { .. } => &NO_EFFECT,
            Warning::PoorlyDetermined { .. } => &POORLY_DETERMINED,
            Warning::WeaklyIdentifiable { .. } => &WEAKLY_IDENTIFIABLE,
            Warning::Correlated { .. } => &CORRELATED,
            Warning::FewIndependentResiduals { .. } => &FEW_INDEPENDENT_RESIDUALS,
            Warning::ResidualsBelowRoughness { .. } => &RESIDUALS_BELOW_ROUGHNESS,
            Warning::OneSided { .. } => &ONE_SIDED,
            Warning::NotAtMinimum { .. } => &NOT_AT_MINIMUM,
        }
    }

    /// The fields of the variant.
    fn figures(&self) -> Map<String, Value> {
        match serde_json::to_value(self) {
            Ok(Value::Object(fields)) => fields,
            _ => Map::new(),
        }
    }
}
