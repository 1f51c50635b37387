//! `[air]`: the air around the film.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use base::units::{Area, AreaDensity, Density, Pressure};

/// The air around the film, which has no effect where the table is left out.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
pub struct Air {
    /// How the air between the two faces of film behaves that the impactor compresses; no such air where it is left
    /// out. Torn film lets it out.
    pub cushion: Option<Compression>,
    /// Area of all openings through which the air between the faces leaves; closed where it is left out.
    #[serde(default = "closed")]
    #[schemars(extend("minimum" = 0, "maximum" = 100))]
    pub vent: Area,
    /// Discharge coefficient of the openings: the share of their area that a jet fills.
    #[serde(default = "discharge")]
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1))]
    pub discharge: f64,
    /// Mass of air per area of film that moves with it, on both sides together; it has inertia and no weight.
    #[serde(default = "none")]
    #[schemars(extend("minimum" = 0, "maximum" = 10))]
    pub added_mass: AreaDensity,
    /// Density of the air.
    #[serde(default = "density")]
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 100))]
    pub density: Density,
    /// Pressure of the air.
    #[serde(default = "pressure")]
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1e7, "x-likely" = [1e4, 2e5]))]
    pub pressure: Pressure,
}

/// How enclosed air is compressed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Compression {
    /// Without exchange of heat: too fast for it.
    Adiabatic,
    /// At constant temperature.
    Isothermal,
}

fn closed() -> Area {
    Area(0.0)
}

fn discharge() -> f64 {
    0.6
}

fn none() -> AreaDensity {
    AreaDensity(0.0)
}

fn density() -> Density {
    Density(1.2)
}

fn pressure() -> Pressure {
    Pressure(101_325.0)
}
