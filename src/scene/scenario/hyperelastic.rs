//! `[specimen.material.hyperelastic]`: an energy of rubber-like film.

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Serialize};

use super::schema;
use base::units::{Pressure, Rate};

/// An energy of rubber-like film and its coefficients. Each law has its own keys.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
pub struct Hyperelastic {
    /// The energy.
    pub law: Energy,
    /// Shear modulus of `neo-hookean` and `gent`; the moduli of the terms of `ogden`.
    #[serde(default)]
    #[schemars(schema_with = "moduli_schema")]
    pub mu: Option<Moduli>,
    /// Exponents of the terms of `ogden`, as many as `mu`, none of them zero.
    #[schemars(length(min = 1, max = 6), extend("x-likely" = [-30.0, 30.0]))]
    pub alpha: Option<Vec<f64>>,
    /// Limit of I₁ − 3, at which the chains of `gent` are straight.
    #[schemars(extend("exclusiveMinimum" = 0, "x-likely" = [0.1, 1e4]))]
    pub jm: Option<f64>,
    /// Coefficient of I₁ − 3 of `mooney-rivlin` and `yeoh`.
    #[schemars(extend("x-likely" = [1e2, 1e9]))]
    pub c10: Option<Pressure>,
    /// Coefficient of I₂ − 3 of `mooney-rivlin`.
    #[schemars(extend("x-likely" = [-1e9, 1e9]))]
    pub c01: Option<Pressure>,
    /// Coefficient of (I₁ − 3)² of `yeoh`.
    #[schemars(extend("x-likely" = [-1e9, 1e9]))]
    pub c20: Option<Pressure>,
    /// Coefficient of (I₁ − 3)³ of `yeoh`.
    #[schemars(extend("x-likely" = [-1e9, 1e9]))]
    pub c30: Option<Pressure>,
    /// Young's modulus at small strain of `compressible-neo-hookean`.
    #[schemars(extend("exclusiveMinimum" = 0, "x-likely" = [1e3, 1e12]))]
    pub young: Option<Pressure>,
    /// Poisson's ratio at small strain of `compressible-neo-hookean`.
    #[schemars(extend("minimum" = 0, "exclusiveMaximum" = 0.5))]
    pub poisson: Option<f64>,
    /// Whether the film wrinkles under compression, so that it carries tension only (tension field).
    #[serde(default)]
    pub wrinkling: bool,
    /// Lowest and highest strain rate at which the coefficients were measured.
    #[schemars(transform = schema::positive_items)]
    pub measured_rates: Option<[Rate; 2]>,
}

/// Energies of rubber-like film.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Energy {
    /// μ/2 (I₁ − 3), incompressible: `mu`.
    NeoHookean,
    /// μ/2 (I₁ − 3) − μ ln J + λ/2 ln² J: `young`, `poisson`.
    CompressibleNeoHookean,
    /// c₁₀ (I₁ − 3) + c₀₁ (I₂ − 3), incompressible: `c10`, `c01`.
    MooneyRivlin,
    /// Σ c_i0 (I₁ − 3)^i, incompressible: `c10`, `c20`, `c30`.
    Yeoh,
    /// −μ J_m/2 ln(1 − (I₁ − 3)/J_m), incompressible: `mu`, `jm`.
    Gent,
    /// Σ μ_k/α_k (λ₁^α_k + λ₂^α_k + λ₃^α_k − 3), incompressible: `mu`, `alpha`.
    Ogden,
}

/// One modulus, or one a term. The validator has reported mistakes before serde tries the two forms.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Moduli {
    /// A shear modulus.
    One(Pressure),
    /// One a term.
    Terms(Vec<Pressure>),
}

fn moduli_schema(generator: &mut SchemaGenerator) -> Schema {
    let mut likely = |range: [f64; 2]| {
        let mut modulus = generator.subschema_for::<Pressure>();
        modulus.insert("x-likely".into(), serde_json::json!(range));
        modulus
    };
    // Moduli of terms may be small beside others, or negative.
    let (one, term) = (likely([1e3, 1e9]), likely([-1e9, 1e9]));
    json_schema!({ "anyOf": [one, { "type": "array", "items": term, "minItems": 1, "maxItems": 6 }] })
}
