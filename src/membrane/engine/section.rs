//! The membrane section: what the elements of a face are made of.

use crate::material::{Law, Rupture, Thermal, Viscosity};

/// Properties of the elements of a face, which act as one membrane.
#[derive(Clone, Debug)]
pub struct Section {
    /// Constitutive law of one layer.
    pub law: Law,
    /// Prony series on the law, where film is viscous.
    pub viscosity: Option<Viscosity>,
    /// Rupture by a criterion of its own; without it fibres break at the end of their curves, and other film does not.
    pub rupture: Option<Rupture>,
    /// How film warms up by what it absorbs; without it film keeps its temperature.
    pub thermal: Option<Thermal>,
    /// kg/m³, with mass scaling.
    pub density: f64,
    /// Thickness of all layers, m.
    pub thickness: f64,
    /// Angle from the x axis to MD, rad.
    pub md_angle: f64,
    /// Engineering pre-strain along MD and TD: the stress-free length is the mounted one / (1 + pre-strain).
    pub prestrain: [f64; 2],
    /// Whether quadrilaterals have 2×2 integration points instead of one with hourglass control.
    pub full_integration: bool,
}

impl Section {
    /// Film without pre-strain, MD along x, of a law that does nothing besides it; one integration point an element.
    pub fn new(law: Law, density: f64, thickness: f64) -> Section {
        Section {
            law,
            viscosity: None,
            rupture: None,
            thermal: None,
            density,
            thickness,
            md_angle: 0.0,
            prestrain: [0.0; 2],
            full_integration: false,
        }
    }
}
