//! `[[specimen.material.prony]]` and `[specimen.material.shift]`: the relaxation of viscous film.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use base::units::{MolarEnergy, Temperature, TemperatureDifference, Time};

/// One term of a Prony series on the material's law.
#[derive(Clone, Copy, Debug, Serialize, Deserialize, JsonSchema)]
pub struct PronyTerm {
    /// Share of the instantaneous stiffness that relaxes with `time`; the shares of all terms sum to less than 1.
    #[schemars(extend("exclusiveMinimum" = 0, "exclusiveMaximum" = 1))]
    pub share: f64,
    /// Relaxation time, at the reference temperature where there is a `shift`.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub time: Time,
}

/// Which film the law as written describes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum PronyOf {
    /// Film strained at once: the long-term stiffness is (1 − Σ share) of it.
    #[default]
    Instantaneous,
    /// Film that has relaxed, e.g. in a slow tensile test: the instantaneous stiffness is 1/(1 − Σ share) of it.
    LongTerm,
}

/// Shift of the relaxation times from a reference temperature to that of the film.
#[derive(Clone, Copy, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Shift {
    /// Williams, Landel and Ferry: log₁₀ a = −c1 (T − reference)/(c2 + T − reference), above the glass transition.
    Wlf(Wlf),
    /// Arrhenius: ln a = energy/R (1/T − 1/reference).
    Arrhenius(Arrhenius),
}

/// Constants of Williams, Landel and Ferry.
#[derive(Clone, Copy, Debug, Serialize, Deserialize, JsonSchema)]
pub struct Wlf {
    /// Constant c₁.
    #[schemars(extend("exclusiveMinimum" = 0, "x-likely" = [1.0, 100.0]))]
    pub c1: f64,
    /// Constant c₂.
    #[schemars(extend("exclusiveMinimum" = 0, "x-likely" = [5.0, 500.0]))]
    pub c2: TemperatureDifference,
    /// Temperature of the relaxation times as written.
    #[schemars(extend("exclusiveMinimum" = 0, "x-likely" = [150.0, 600.0]))]
    pub reference: Temperature,
}

/// Constants of Arrhenius.
#[derive(Clone, Copy, Debug, Serialize, Deserialize, JsonSchema)]
pub struct Arrhenius {
    /// Activation energy.
    #[schemars(extend("exclusiveMinimum" = 0, "x-likely" = [1e3, 1e6]))]
    pub energy: MolarEnergy,
    /// Temperature of the relaxation times as written.
    #[schemars(extend("exclusiveMinimum" = 0, "x-likely" = [150.0, 600.0]))]
    pub reference: Temperature,
}
