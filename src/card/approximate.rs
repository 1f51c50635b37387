//! The nearest law that a target has for one that it has not, and how far off it is.

use std::f64::consts::FRAC_PI_4;

use super::target::Target;
use membrane::material::{
    Elastic, Gradient, History, Hyperelastic, HyperelasticLaw, Law, LawVisitor, MembraneLaw, Polynomial, TensionField,
};

/// A law in place of another.
pub(crate) struct Nearest {
    /// Which.
    pub(crate) law: Law,
    /// In words.
    pub(crate) words: &'static str,
}

/// The nearest law that `target` holds for `law`, where it does not hold that; none where none is near.
pub(crate) fn nearest(law: &Law, target: Target) -> Option<Nearest> {
    let has_yeoh = matches!(target, Target::LsDyna | Target::Abaqus | Target::CalculiX);
    let has_rubber = has_yeoh || matches!(target, Target::OpenRadioss | Target::Febio);
    match law {
        Law::Hyperelastic(rubber) if has_rubber => match rubber {
            // The first terms of the series of −½ μ J_m ln(1 − (I₁ − 3)/J_m).
            HyperelasticLaw::Gent(Hyperelastic { energy, wrinkling }) if has_yeoh => {
                let (mu, jm) = (energy.mu, energy.jm);
                let energy = Polynomial::yeoh([0.5 * mu, 0.25 * mu / jm, mu / (6.0 * jm * jm)]);
                Some(rubber_like(energy, *wrinkling, "Yeoh's energy, the first three terms of Gent's"))
            }
            HyperelasticLaw::Gent(Hyperelastic { energy, wrinkling }) => Some(rubber_like(
                Polynomial::neo_hookean(energy.mu),
                *wrinkling,
                "neo-Hookean film of the same modulus",
            )),
            HyperelasticLaw::Polynomial(Hyperelastic { energy, wrinkling }) if !has_yeoh => {
                let [c10, ..] = energy.first;
                let energy = Polynomial::mooney_rivlin(c10, energy.second);
                Some(rubber_like(energy, *wrinkling, "the terms of Yeoh's energy that are linear in the invariants"))
            }
            HyperelasticLaw::CompressibleNeoHookean(Hyperelastic { energy, wrinkling }) => {
                let mu = energy.young / (2.0 + 2.0 * energy.poisson);
                Some(rubber_like(Polynomial::neo_hookean(mu), *wrinkling, "incompressible neo-Hookean film"))
            }
            HyperelasticLaw::Polynomial(_) | HyperelasticLaw::Ogden(_) => None,
        },
        Law::Hyperelastic(rubber) if target == Target::Kratos => {
            let young = 3.0 * super::film::shear_modulus(rubber);
            let elastic = Elastic { young, poisson: 0.5 - 1e-6 };
            let law = if super::film::wrinkles(law) {
                Law::TensionField(TensionField(elastic))
            } else {
                Law::Elastic(elastic)
            };
            Some(Nearest { law, words: "linear film of the same modulus" })
        }
        Law::Plastic(plastic) if matches!(target, Target::Kratos | Target::Febio) => {
            Some(Nearest { law: Law::Elastic(plastic.elastic().clone()), words: "its elasticity" })
        }
        Law::Hyperelastic(_)
        | Law::Plastic(_)
        | Law::Fabric(_)
        | Law::RateFabric(_)
        | Law::Elastic(_)
        | Law::TensionField(_) => None,
    }
}

fn rubber_like(energy: Polynomial, wrinkling: bool, words: &'static str) -> Nearest {
    let law = Law::Hyperelastic(HyperelasticLaw::Polynomial(Hyperelastic { energy, wrinkling }));
    Nearest { law, words }
}

/// Largest difference of the nominal stresses of two laws on common paths of deformation up to the strain `most`, over the
/// largest stress of the first on each: stretched along MD, TD and at 45° with the width of incompressible film, along both
/// at once, sheared, and back along MD.
pub(crate) fn difference(first: &Law, second: &Law, most: f64) -> f64 {
    const STEPS: usize = 50;
    let strains = |to: f64| (1..=STEPS).map(move |i| to * i as f64 / STEPS as f64);
    let width = |stretch: f64| 1.0 / stretch.sqrt();
    let paths: [Vec<Gradient<1>>; 6] = [
        strains(most).map(|e| turned([1.0 + e, width(1.0 + e)], 0.0)).collect(),
        strains(most).map(|e| turned([width(1.0 + e), 1.0 + e], 0.0)).collect(),
        strains(most).map(|e| turned([1.0 + e, width(1.0 + e)], FRAC_PI_4)).collect(),
        strains(most).map(|e| turned([1.0 + e; 2], 0.0)).collect(),
        strains(most).map(|shear| [[[1.0], [0.0], [0.0]], [[shear], [1.0], [0.0]]]).collect(),
        strains(most).chain(strains(most).map(|e| most - e)).map(|e| turned([1.0 + e, width(1.0 + e)], 0.0)).collect(),
    ];
    let off = |path: &Vec<Gradient<1>>| {
        let [first, second] = [first, second].map(|law| law.visit(Along(path)));
        let size = first.iter().flatten().fold(f64::MIN_POSITIVE, |size, stress| size.max(stress.abs()));
        let pairs = first.iter().flatten().zip(second.iter().flatten());
        pairs.fold(0.0_f64, |most, (a, b)| most.max((a - b).abs())) / size
    };
    paths.iter().map(off).fold(0.0, f64::max)
}

/// The gradient of these stretches along directions at `angle` (rad) from MD and TD.
fn turned([along, across]: [f64; 2], angle: f64) -> Gradient<1> {
    let (sin, cos) = angle.sin_cos();
    let (mean, half) = (0.5 * (along + across), 0.5 * (along - across));
    let (cos2, sin2) = (cos * cos - sin * sin, 2.0 * sin * cos);
    [[[mean + half * cos2], [half * sin2], [0.0]], [[half * sin2], [mean - half * cos2], [0.0]]]
}

/// Nominal stresses along a path of gradients, Pa.
struct Along<'a>(&'a [Gradient<1>]);

impl LawVisitor for Along<'_> {
    type Output = Vec<[f64; 4]>;

    fn visit<M: MembraneLaw + Clone + Send + Sync + 'static>(self, law: &M) -> Vec<[f64; 4]> {
        let mut history = M::History::virgin();
        let at = |gradient: &Gradient<1>| {
            let [p, q] = law.stress(&(*gradient).into(), &mut history, 0.0).p;
            [p[0][0], p[1][0], q[0][0], q[1][0]]
        };
        self.0.iter().map(at).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use membrane::material::Gent;

    /// Gent's series to the third term leaves (I₁ − 3)³/J_m³ of the slope.
    #[test]
    fn the_series_of_gents_energy_is_near_below_its_limit() {
        let film = |jm: f64| {
            Law::Hyperelastic(HyperelasticLaw::Gent(Hyperelastic { energy: Gent { mu: 4e5, jm }, wrinkling: false }))
        };
        for (jm, within) in [(80.0, 1e-3), (20.0, 5e-2)] {
            let law = film(jm);
            let near = nearest(&law, Target::Abaqus).expect("Yeoh's");
            let off = difference(&law, &near.law, 1.0);
            assert!(off < within && off > 1e-6, "{off}");
        }
        assert_eq!(difference(&film(80.0), &film(80.0), 1.0), 0.0);
        assert!(nearest(&film(80.0), Target::Curves).is_none());
    }

    /// Uniaxial at 45° of isotropic film is that along MD, turned.
    #[test]
    fn paths_turn_with_their_angle() {
        let law = Law::Elastic(Elastic { young: 1e8, poisson: 0.3 });
        let [straight, oblique] = [0.0, FRAC_PI_4].map(|angle| law.visit(Along(&[turned([1.2, 0.9], angle)]))[0]);
        // The trace stays, and so does the sum of squares.
        assert!((straight[0] + straight[3] - oblique[0] - oblique[3]).abs() < 1e-6);
        let squares = |p: [f64; 4]| p.iter().map(|x| x * x).sum::<f64>();
        assert!((squares(straight) / squares(oblique) - 1.0).abs() < 1e-12);
    }
}
