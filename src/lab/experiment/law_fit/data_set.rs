//! Measured nominal stresses over stretches.

use super::test_kind::TestKind;
use crate::error::{Error, refusal};
use membrane::material::Tension;

/// The measured stresses of one test.
#[derive(Clone, Debug, PartialEq)]
pub struct DataSet {
    /// Name in figures and legends: that of its file.
    pub name: String,
    /// Stretches and stresses.
    pub measured: Measured,
    /// Its weight in a fit: the factor of its squared residuals.
    pub weight: f64,
    /// Whether its file marks it as virtual.
    pub is_virtual: bool,
}

/// Stretches and nominal stresses (Pa).
#[derive(Clone, Debug, PartialEq)]
pub enum Measured {
    /// Stretch and stress along the tension.
    Tension(Tension, Vec<[f64; 2]>),
    /// Both principal stretches and both stresses.
    Biaxial(Vec<BiaxialPoint>),
}

/// Principal stretches in the plane and nominal stresses (Pa) along them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BiaxialPoint {
    /// λ₁ and λ₂.
    pub stretches: [f64; 2],
    /// P₁ and P₂, Pa.
    pub stresses: [f64; 2],
}

/// Largest stretch that is taken for one: the softest rubbers break at some 10.
const LARGEST_STRETCH: f64 = 100.0;

impl DataSet {
    /// The test `name` with the weight 1.
    ///
    /// # Errors
    /// Fewer than two points, numbers that are not finite, a stretch that is not positive, nothing but rest, or stresses
    /// that are all equal.
    pub fn new(name: impl Into<String>, measured: Measured) -> Result<DataSet, Error> {
        measured.check()?;
        Ok(DataSet { name: name.into(), measured, weight: 1.0, is_virtual: false })
    }

    /// The test with another weight.
    ///
    /// # Errors
    /// A weight below zero or not finite.
    pub fn with_weight(self, weight: f64) -> Result<DataSet, Error> {
        if weight.is_finite() && weight >= 0.0 {
            Ok(DataSet { weight, ..self })
        } else {
            Err(refusal!("expected a weight that is zero or above, found {weight}"))
        }
    }

    /// The kind of its test.
    pub fn kind(&self) -> TestKind {
        match self.measured {
            Measured::Tension(tension, _) => TestKind::Tension(tension),
            Measured::Biaxial(_) => TestKind::Biaxial,
        }
    }
}

impl Measured {
    /// All stresses, Pa: one a point, of biaxial tension P₁ and P₂ of each.
    pub fn stresses(&self) -> Vec<f64> {
        match self {
            Measured::Tension(_, points) => points.iter().map(|point| point[1]).collect(),
            Measured::Biaxial(points) => points.iter().flat_map(|point| point.stresses).collect(),
        }
    }

    /// The stretch that belongs to each of the [stresses](Measured::stresses).
    pub fn stretches(&self) -> Vec<f64> {
        match self {
            Measured::Tension(_, points) => points.iter().map(|point| point[0]).collect(),
            Measured::Biaxial(points) => points.iter().flat_map(|point| point.stretches).collect(),
        }
    }

    /// Number of points.
    pub fn len(&self) -> usize {
        match self {
            Measured::Tension(_, points) => points.len(),
            Measured::Biaxial(points) => points.len(),
        }
    }

    /// Whether there is no point.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    fn check(&self) -> Result<(), Error> {
        if self.len() < 2 {
            return Err(refusal!("{} measured points: a test has two at least", self.len()));
        }
        let (stretches, stresses) = (self.stretches(), self.stresses());
        let a_point = stresses.len() / self.len();
        for (place, (stretch, stress)) in stretches.iter().zip(&stresses).enumerate() {
            let row = place / a_point + 1;
            if !(stretch.is_finite() && stress.is_finite()) {
                return Err(refusal!("row {row} has no number for stretch or stress"));
            }
            if *stretch <= 0.0 {
                return Err(refusal!("the stretch {stretch} of row {row} is not above zero"));
            }
            if *stretch > LARGEST_STRETCH {
                return Err(refusal!(
                    "the stretch {stretch} of row {row} is larger than {LARGEST_STRETCH}, that of any film"
                ));
            }
        }
        if stretches.iter().all(|stretch| *stretch == 1.0) {
            return Err(refusal!("no stretch differs from 1"));
        }
        if stresses.iter().any(|stress| *stress != stresses[0]) {
            return Ok(());
        }
        // They have no scatter that a law could explain (R²).
        Err(match stresses[0] {
            0.0 => refusal!("no stress differs from 0"),
            stress => refusal!("all stresses are {stress} Pa: a test shows how stress changes with stretch"),
        })
    }
}

/// Smallest and largest stretch of all `sets`.
pub fn range(sets: &[DataSet]) -> [f64; 2] {
    let all = sets.iter().flat_map(|set| set.measured.stretches());
    all.fold([f64::INFINITY, 0.0], |[low, high], stretch| [low.min(stretch), high.max(stretch)])
}
