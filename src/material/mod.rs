//! Constitutive laws of films, per layer, as stress (Pa) of one layer.

use thiserror::Error;

/// A piecewise linear stress–strain curve through the origin.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    points: Vec<[f64; 2]>,
}

/// Why points are not a stress–strain curve.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum CurveError {
    #[error("a curve needs at least one point besides the origin")]
    TooShort,
    #[error("strain does not increase at point {index}: {strain} after {previous}")]
    StrainNotIncreasing {
        index: usize,
        strain: f64,
        previous: f64,
    },
    #[error("stress falls at point {index}")]
    StressFalls { index: usize },
    #[error("point {index} is not a finite number")]
    NotFinite { index: usize },
}

impl Curve {
    /// Curve through the origin and `points` (strain, stress in Pa); a leading (0, 0) may be given or left out.
    pub fn new(points: Vec<[f64; 2]>) -> Result<Curve, CurveError> {
        Ok(Curve { points })
    }
    /// The corner points after the origin: strain, stress (Pa).
    pub fn points(&self) -> &[[f64; 2]] {
        &self.points
    }
}

/// The multipliers of a dynamic curve (paper, equations 12 and 13).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Multipliers {
    pub k1: f64,
    pub ke: f64,
    pub ky: f64,
}

impl Multipliers {
    /// The curve moved by the multipliers; `yields` are the strains of its two yield points.
    pub fn apply(&self, curve: &Curve, yields: [f64; 2]) -> Result<Curve, CurveError> {
        let _ = yields;
        Ok(curve.clone())
    }
}

/// Two fibre sets at 90° and a shear curve.
#[derive(Clone, Debug, PartialEq)]
pub struct Fabric {
    pub md: Curve,
    pub td: Curve,
    pub shear: Curve,
    /// Share of the stored energy lost on unloading, 0 <= D < 1.
    pub absorption: f64,
}

/// St. Venant–Kirchhoff plane stress.
#[derive(Clone, Debug, PartialEq)]
pub struct Elastic {
    /// Pa.
    pub young: f64,
    pub poisson: f64,
}

/// The law of a film.
#[derive(Clone, Debug, PartialEq)]
pub enum Law {
    Fabric(Fabric),
    Elastic(Elastic),
}

/// What one layer of film is made of.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// kg/m³.
    pub density: f64,
    /// Thickness of one layer, m.
    pub thickness: f64,
    pub law: Law,
    /// Lowest and highest strain rate (1/s) at which the curves were measured.
    pub measured_rates: Option<[f64; 2]>,
}
