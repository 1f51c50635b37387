//! `[specimen.material.thermal]`: film that warms up by what it absorbs, and softens.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use base::units::{HeatCapacity, SharePerTemperature};

/// Adiabatic heating: all energy that the film absorbs stays in it as heat, and stress and stiffness of the law fall with its
/// temperature. The law as written is that of film at the temperature of the room, as slow coupons measure it; curves measured
/// at the rates of the test have the heat in them already. Film is mounted at that temperature, and warms up from then on.
#[derive(Clone, Copy, Debug, Serialize, Deserialize, JsonSchema)]
pub struct Thermal {
    /// Specific heat capacity of the film; 2.3 kJ/(kg K) for polyethylene.
    #[schemars(extend("exclusiveMinimum" = 0, "x-likely" = [300.0, 6000.0]))]
    pub heat: HeatCapacity,
    /// Share of its stress that film loses with each kelvin, of what it has left: −d ln σ/dT. Some 0.6 to 0.9 %/K for
    /// polyethylene near room temperature.
    #[schemars(extend("minimum" = 0, "maximum" = 0.2, "x-likely" = [0.0, 0.05]))]
    pub softening: SharePerTemperature,
}
