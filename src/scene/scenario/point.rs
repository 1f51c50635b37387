//! Points of the curves of materials.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use base::units::Pressure;

/// One point of a curve: engineering strain (shear angle in rad, equivalent plastic strain) and stress.
#[derive(Clone, Copy, Debug, Serialize, Deserialize, JsonSchema)]
pub struct Point(
    #[schemars(range(min = 0), extend("x-likely" = [0.0, 15.0]))] pub f64,
    #[schemars(range(min = 0), extend("x-likely" = [1e5, 1e11]))] pub Pressure,
);
