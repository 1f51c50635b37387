//! Hill's criterion of stability: stretches from which on a law gives way.

use super::{Hyperelastic, HyperelasticLaw, StrainEnergy, Tension, with_energy};
use crate::lane::one;

/// Largest stretch that is checked.
const MOST: f64 = 10.0;

/// Step from one checked stretch to the next.
const STEP: f64 = 0.01;

/// Half the difference of ln λ over which the stress is differentiated.
const DIFFERENCE: f64 = 1e-5;

impl HyperelasticLaw {
    /// The least stretch up to 10, and the kind of tension, from which on the law is unstable: ∂τ_i/∂ln λ_j of the
    /// Kirchhoff stresses τ_i = c_i S_i in the plane is no longer positive definite (Hill, J. Mech. Phys. Solids 5,
    /// 1957).
    pub fn instability(&self) -> Option<(Tension, f64)> {
        self.instability_up_to(MOST)
    }

    /// Stability up to the stretch `most`.
    pub fn instability_up_to(&self, most: f64) -> Option<(Tension, f64)> {
        with_energy!(self, energy => instability(energy, most))
    }

    /// Whether the law is stable at these principal stretches in the plane, by the same criterion.
    pub fn is_stable_at(&self, stretches: [f64; 2]) -> bool {
        with_energy!(self, energy => is_stable(energy, stretches.map(|stretch| stretch * stretch)))
    }
}

fn instability(energy: &impl StrainEnergy, most: f64) -> Option<(Tension, f64)> {
    let steps = ((most.min(MOST) - 1.0) / STEP).round() as u32;
    let near = (0..=steps).map(|step| 1.0 + STEP * f64::from(step));
    // Beyond, in proportion: nobody's number makes the search endless.
    let beyond = std::iter::successors(Some(MOST), |stretch| Some(stretch * (1.0 + STEP))).skip(1);
    let stretches = near.chain(beyond.take_while(|stretch| *stretch <= most));
    let tensions = [Tension::Uniaxial, Tension::Equibiaxial, Tension::Plane];
    let mut states = stretches.flat_map(|stretch| tensions.map(|tension| (tension, stretch)));
    states.find(|(tension, stretch)| !is_stable(energy, tension.squares(energy, *stretch)))
}

/// Whether the stresses grow with the strains; also beyond the limit of a law, where there are none.
fn is_stable(energy: &impl StrainEnergy, squares: [f64; 2]) -> bool {
    let kirchhoff = |squares: [f64; 2]| {
        let stress = energy.stress(&squares.map(one));
        [0, 1].map(|i| squares[i] * stress[i][0])
    };
    let slope = |j: usize| {
        let at = |way: f64| {
            let mut moved = squares;
            moved[j] *= (2.0 * way * DIFFERENCE).exp();
            kirchhoff(moved)
        };
        let (above, below) = (at(1.0), at(-1.0));
        [0, 1].map(|i| (above[i] - below[i]) / (2.0 * DIFFERENCE))
    };
    let [[a, b], [c, d]] = [slope(0), slope(1)];
    let between = 0.5 * (b + c);
    let is_unstable = a <= 0.0 || d <= 0.0 || a * d <= between * between;
    !is_unstable
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::{Gent, Ogden, Polynomial};

    #[test]
    fn common_rubbers_are_stable() {
        assert_eq!(instability(&Ogden::new(&Ogden::TRELOAR), MOST), None);
        assert_eq!(instability(&Polynomial::neo_hookean(1.0), MOST), None);
        assert_eq!(instability(&Polynomial::mooney_rivlin(0.4, 0.1), MOST), None);
        assert_eq!(instability(&Polynomial::yeoh([0.18, -0.002, 0.000_05]), MOST), None);
        assert_eq!(instability(&Gent { mu: 1.0, jm: 30.0 }, MOST), None);
    }

    /// In equibiaxial tension τ = 2 (λ² − λ⁻⁴)(c₁₀ + c₀₁ λ²) falls where the derivative by λ vanishes; shear gives way
    /// at or before that.
    #[test]
    fn a_negative_second_coefficient_is_unstable() {
        let (c10, c01) = (1.0, -0.05);
        let stress = |stretch: f64| (stretch.powi(2) - stretch.powi(-4)) * (c10 + c01 * stretch.powi(2));
        let falls = (100..1000).map(|k| 0.01 * f64::from(k)).find(|stretch| stress(stretch + 1e-4) < stress(*stretch));
        let law =
            HyperelasticLaw::Polynomial(Hyperelastic { energy: Polynomial::mooney_rivlin(c10, c01), wrinkling: true });
        let (tension, found) = law.instability().expect("an instability");
        assert_eq!(tension, Tension::Equibiaxial);
        assert!(falls.is_some_and(|falls| found <= falls + 0.011 && found > 1.5), "{found} {falls:?}");
    }
}
