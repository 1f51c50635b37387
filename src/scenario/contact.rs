//! `[contact]`: film on film.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Contact between faces of film.
#[derive(Clone, Debug, Default, Serialize, Deserialize, JsonSchema)]
#[schemars(extend("x-future" = {
    "film": "the impactor is in contact with the faces, which are not in contact with each other"
}))]
pub struct Contact {
    /// Coulomb coefficient between faces that the impactor presses on each other; that of the impactor where it is left
    /// out.
    #[schemars(range(min = 0, max = 10), extend("x-likely" = [1e-3, 2.0]))]
    pub film_friction: Option<f64>,
}
