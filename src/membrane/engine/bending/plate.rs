//! Plate stiffness of a film: its law at rest times h³/12.

use crate::engine::Section;
use crate::material::{Gradient, Law};

/// Strain at which the slopes of a law are taken: taut, so that a law without compression has its stiffness, and small
/// beside any strain at which a law is curved.
const STRAIN: f64 = 1e-6;

/// Moments over curvatures of film, in the axes MD and TD: of κ₁₁, κ₂₂ and 2κ₁₂, N m (theory.md, equation 350).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Plate(pub(super) [[f64; 3]; 3]);

impl Plate {
    /// That of the film of `section`, made of `layers` that slide on each other without friction.
    pub(super) fn new(section: &Section, layers: u32) -> Plate {
        // n (h/n)³: each layer bends by itself. Of viscous film, what has relaxed.
        let cubes = section.thickness.powi(3) / f64::from(layers).powi(2);
        let share = section.viscosity.as_ref().map_or(1.0, |viscosity| viscosity.instant() * viscosity.long_term());
        Plate(tangent(&section.law).map(|row| row.map(|slope| share * slope * cubes / 12.0)))
    }

    /// That of a free edge whose tangent has the direction `along` (cosine and sine to MD), in the axes of the edge:
    /// its moments of the curvature along the edge and of twice the twist, where those across it vanish.
    pub(super) fn at_edge(&self, along: [f64; 2]) -> [[f64; 2]; 2] {
        let [[tt, tn, ts], [_, nn, ns], [_, _, ss]] = self.turned(along);
        let freed = |stiffness: f64, a: f64, b: f64| if nn > 0.0 { stiffness - a * b / nn } else { stiffness };
        let twist = freed(ts, tn, ns);
        [[freed(tt, tn, tn), twist], [twist, freed(ss, ns, ns)]]
    }

    /// That of a free edge where its twist is free as well.
    pub(super) fn along_edge(&self, along: [f64; 2]) -> f64 {
        let [[tt, ts], [_, ss]] = self.at_edge(along);
        if ss > 0.0 { tt - ts * ts / ss } else { tt }
    }

    /// In axes that are turned so that the first has this direction.
    fn turned(&self, [c, s]: [f64; 2]) -> [[f64; 3]; 3] {
        // Curvatures in MD and TD of those in the turned axes: κ = T κ', so that D' = Tᵀ D T.
        let t = [[c * c, s * s, -c * s], [s * s, c * c, c * s], [2.0 * c * s, -2.0 * c * s, c * c - s * s]];
        let of = |i: usize, j: usize| {
            let sum = |a: usize| (0..3).map(|b| t[a][i] * self.0[a][b] * t[b][j]).sum::<f64>();
            (0..3).map(sum).sum::<f64>()
        };
        [0, 1, 2].map(|i| [0, 1, 2].map(|j| of(i, j)))
    }
}

/// Slopes of the stresses of `law` at rest over the strains ε₁₁, ε₂₂ and 2ε₁₂, Pa.
fn tangent(law: &Law) -> [[f64; 3]; 3] {
    // f₁ and f₂ with the strains added to a taut state.
    let stress = |fibre: usize, axis: usize, change: f64| {
        let mut f: Gradient<1> = [[[1.0 + STRAIN], [0.0], [0.0]], [[0.0], [1.0 + STRAIN], [0.0]]];
        f[fibre][axis][0] += change;
        law.virgin_stress(f)
    };
    let step = 0.5 * STRAIN;
    let slope = |fibre: usize, axis: usize| {
        let (ahead, behind) = (stress(fibre, axis, step), stress(fibre, axis, -step));
        move |of: usize, along: usize| (ahead[of][along][0] - behind[of][along][0]) / (2.0 * step)
    };
    let (md, td, shear) = (slope(0, 0), slope(1, 1), slope(1, 0));
    let coupling = 0.5 * (md(1, 1) + td(0, 0));
    // What the taut state itself has against shear is its stress, a part in a million.
    [[md(0, 0), coupling, 0.0], [coupling, td(1, 1), 0.0], [0.0, 0.0, shear(1, 0)]]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::{
        CompressibleNeoHookean, Elastic, Hyperelastic, HyperelasticLaw, LawVisitor, MembraneLaw, TensionField,
    };

    struct Moduli;
    impl LawVisitor for Moduli {
        type Output = [f64; 2];

        fn visit<M: MembraneLaw + Clone + Send + Sync + 'static>(self, law: &M) -> [f64; 2] {
            law.moduli()
        }
    }

    /// Of isotropic laws E/(1 − ν²), ν E/(1 − ν²) and G.
    #[test]
    fn slopes_are_those_of_the_law_at_rest() {
        let (young, poisson) = (2e8, 0.3);
        let elastic = Elastic { young, poisson };
        let shear = young / (2.0 * (1.0 + poisson));
        let energy = CompressibleNeoHookean { young, poisson };
        for law in [
            Law::Elastic(elastic.clone()),
            Law::TensionField(TensionField(elastic)),
            Law::Hyperelastic(HyperelasticLaw::CompressibleNeoHookean(Hyperelastic { energy, wrinkling: true })),
        ] {
            let plane = young / (1.0 - poisson * poisson);
            let expected = [[plane, poisson * plane, 0.0], [poisson * plane, plane, 0.0], [0.0, 0.0, shear]];
            let found = tangent(&law);
            for (found, expected) in found.iter().flatten().zip(expected.iter().flatten()) {
                assert!((found - expected).abs() < 1e-5 * plane, "{law:?}: {found} for {expected}");
            }
            let [md, _] = law.visit(Moduli);
            assert!((found[0][0] / md - 1.0).abs() < 1e-5, "{law:?}: {} for {md}", found[0][0]);
        }
    }

    /// An isotropic plate has the same stiffness at any edge, E h³/12 along it.
    #[test]
    fn free_edges_bend_as_beams() {
        let (young, poisson) = (2e9, 0.4);
        let plane = young / (1.0 - poisson * poisson);
        let shear = young / (2.0 * (1.0 + poisson));
        let plate = Plate([[plane, poisson * plane, 0.0], [poisson * plane, plane, 0.0], [0.0, 0.0, shear]]);
        for angle in [0.0_f64, 0.3, 1.2, 2.0] {
            let [[tt, ts], [_, ss]] = plate.at_edge([angle.cos(), angle.sin()]);
            assert!((tt / young - 1.0).abs() < 1e-12 && (ss / shear - 1.0).abs() < 1e-12 && ts.abs() < 1e-3);
            assert!((plate.along_edge([angle.cos(), angle.sin()]) / young - 1.0).abs() < 1e-12);
        }
        // Fibres without coupling: across them, the edge is as stiff as the other set.
        let fibres = Plate([[3.0, 0.0, 0.0], [0.0, 5.0, 0.0], [0.0, 0.0, 0.0]]);
        assert!(
            (fibres.along_edge([1.0, 0.0]) - 3.0).abs() < 1e-12 && (fibres.along_edge([0.0, 1.0]) - 5.0).abs() < 1e-12
        );
    }
}
