//! `[contact]`: film on film.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Contact of film with film.
#[derive(Clone, Debug, Default, Serialize, Deserialize, JsonSchema)]
pub struct Contact {
    /// Whether faces meet each other, also where the impactor is not; without it each face meets the impactor alone,
    /// through the film above it.
    #[serde(default)]
    pub film: bool,
    /// Whether each face meets itself, where it folds and where the lips of a cut or a tear meet; without it film passes
    /// through itself.
    #[serde(default)]
    pub itself: bool,
    /// Coulomb coefficient of film on film. Where it is left out, film is assumed to have the coefficient that it has on the
    /// impactor; impactors that differ in `friction` need it, and so does `loading.pressure`.
    #[schemars(range(min = 0, max = 10), extend("x-likely" = [1e-3, 2.0]))]
    pub film_friction: Option<f64>,
}
