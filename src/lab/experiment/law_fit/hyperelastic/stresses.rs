//! Stresses of a law in the states of a test.

use crate::experiment::law_fit::Measured;
use membrane::material::{HyperelasticLaw, Tension};

/// Points of a curve.
const POINTS: u32 = 120;

impl Measured {
    /// Principal stretches of all points in the plane, for film of this law.
    pub(super) fn states(&self, law: &HyperelasticLaw) -> Vec<[f64; 2]> {
        match self {
            Measured::Tension(tension, points) => {
                points.iter().map(|point| law.stretches(*tension, point[0])).collect()
            }
            Measured::Biaxial(points) => points.iter().map(|point| point.stretches).collect(),
        }
    }
}

/// The law's stresses (Pa) in the order of the measured ones.
pub(super) fn stresses(law: &HyperelasticLaw, measured: &Measured) -> Vec<f64> {
    let states = measured.states(law).into_iter().map(|state| law.nominal_stress(state));
    match measured {
        Measured::Tension(..) => states.map(|stress| stress[0]).collect(),
        Measured::Biaxial(_) => states.flatten().collect(),
    }
}

/// The law's stress (Pa) over the stretch between two stretches.
pub(super) fn curve(law: &HyperelasticLaw, tension: Tension, [from, to]: [f64; 2]) -> Vec<[f64; 2]> {
    let stretches = (0..=POINTS).map(|k| from + (to - from) * f64::from(k) / f64::from(POINTS));
    stretches.map(|stretch| [stretch, law.nominal_stress(law.stretches(tension, stretch))[0]]).collect()
}
