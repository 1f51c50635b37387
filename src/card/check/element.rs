//! One element of film here: nominal stresses in three tests of tension.

use membrane::material::{Elastic, Gradient, History, Law, LawVisitor, MembraneLaw};

/// How an element is stretched along its first direction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// Its width is free.
    Uniaxial,
    /// As much across.
    Equibiaxial,
    /// Its width is held.
    Planar,
}

impl Mode {
    /// All of them.
    pub const ALL: [Mode; 3] = [Mode::Uniaxial, Mode::Equibiaxial, Mode::Planar];

    /// Its name in files.
    pub fn key(self) -> &'static str {
        match self {
            Mode::Uniaxial => "uniaxial",
            Mode::Equibiaxial => "equibiaxial",
            Mode::Planar => "planar",
        }
    }

    /// Stretch across that is imposed at the stretch along; none where the width is free.
    pub(crate) fn across(self, along: f64) -> Option<f64> {
        match self {
            Mode::Uniaxial => None,
            Mode::Equibiaxial => Some(along),
            Mode::Planar => Some(1.0),
        }
    }
}

/// Stretch up to which film of this law can be compared in plane stress; `is_solid` where the other element has a thickness
/// that the law changes.
pub(crate) fn valid_to(law: &Law, mode: Mode, is_solid: bool) -> f64 {
    /// Share of the stretch at which width or thickness, or the hardening, would end.
    const SHARE: f64 = 0.9;
    let of_strain = |strain: f64| (1.0 + 2.0 * SHARE * strain).sqrt();
    match law {
        // Width and thickness of St. Venant-Kirchhoff film vanish where a strain across reaches -1/2.
        Law::Elastic(Elastic { poisson, .. }) if *poisson > 0.0 => match mode {
            Mode::Uniaxial => of_strain(0.5 / poisson),
            Mode::Equibiaxial if is_solid => of_strain(0.25 * (1.0 - poisson) / poisson),
            Mode::Planar if is_solid => of_strain(0.5 * (1.0 - poisson) / poisson),
            Mode::Equibiaxial | Mode::Planar => f64::INFINITY,
        },
        Law::TensionField(field) => valid_to(&Law::Elastic(field.0.clone()), mode, is_solid),
        // Equivalent plastic strain of an incompressible film over its logarithmic strain along.
        Law::Plastic(plastic) => {
            let equivalent = match mode {
                Mode::Uniaxial => 1.0,
                Mode::Equibiaxial => 2.0,
                Mode::Planar => 2.0 / 3.0_f64.sqrt(),
            };
            (SHARE * plastic.hardening().end() / equivalent).exp()
        }
        Law::Elastic(_) | Law::Fabric(_) | Law::RateFabric(_) | Law::Hyperelastic(_) => f64::INFINITY,
    }
}

/// Nominal stresses along and across at each of the growing `stretches`, Pa, of film that is stretched slowly.
pub(crate) fn stresses(law: &Law, mode: Mode, stretches: &[f64]) -> Vec<[f64; 2]> {
    law.visit(Stretched { mode, stretches })
}

struct Stretched<'a> {
    mode: Mode,
    stretches: &'a [f64],
}

impl LawVisitor for Stretched<'_> {
    type Output = Vec<[f64; 2]>;

    fn visit<M: MembraneLaw + Clone + Send + Sync + 'static>(self, law: &M) -> Vec<[f64; 2]> {
        let mut history = M::History::virgin();
        let mut last = [1.0, 1.0];
        let at = |along: &f64| {
            let across = self.mode.across(*along).unwrap_or_else(|| width(law, &history, last, *along));
            last = [*along, across];
            nominal(law, &mut history, last)
        };
        self.stretches.iter().map(at).collect()
    }
}

fn nominal<M: MembraneLaw>(law: &M, history: &mut M::History<1>, [along, across]: [f64; 2]) -> [f64; 2] {
    let gradient: Gradient<1> = [[[along], [0.0], [0.0]], [[0.0], [across], [0.0]]];
    let [p, q] = law.stress(&gradient.into(), history, 0.0).p;
    [p[0][0], q[1][0]]
}

/// The largest stretch across without tension, from that at the `last` stretches: of film that wrinkles, the one at which it
/// begins to.
fn width<M: MembraneLaw>(law: &M, history: &M::History<1>, last: [f64; 2], along: f64) -> f64 {
    const HALVINGS: usize = 60;
    // Film whose width grows does so by no more than its length.
    let (mut narrow, mut wide) = (0.2 * last[1], 1.05 * last[1] * along / last[0]);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (narrow + wide);
        let [_, tension] = nominal(law, &mut history.clone(), [along, middle]);
        if tension > 0.0 { wide = middle } else { narrow = middle }
    }
    narrow
}

#[cfg(test)]
mod tests {
    use super::*;
    use membrane::material::{Hyperelastic, HyperelasticLaw, Polynomial};

    /// Neo-Hookean film: μ(λ − λ⁻²), μ(λ − λ⁻⁵), and μ(λ − λ⁻³) with μ(1 − λ⁻²) across.
    #[test]
    fn rubber_has_the_stresses_of_textbooks() {
        let mu = 4e5;
        let energy = || Polynomial::neo_hookean(mu);
        let stretches = [1.1, 2.0, 3.0];
        for wrinkling in [false, true] {
            let law = Law::Hyperelastic(HyperelasticLaw::Polynomial(Hyperelastic { energy: energy(), wrinkling }));
            for (mode, expected) in [
                (Mode::Uniaxial, (|l: f64| [l - l.powi(-2), 0.0]) as fn(f64) -> [f64; 2]),
                (Mode::Equibiaxial, |l| [l - l.powi(-5); 2]),
                (Mode::Planar, |l| [l - l.powi(-3), 1.0 - l.powi(-2)]),
            ] {
                for (found, stretch) in stresses(&law, mode, &stretches).iter().zip(stretches) {
                    let off = |axis: usize| (found[axis] / mu - expected(stretch)[axis]).abs();
                    assert!(off(0) < 1e-9 && off(1) < 1e-9, "{mode:?} {stretch}: {found:?}");
                }
            }
        }
    }

    /// Uniaxial: Y E λ, and a width of √(1 − 2νE) until it vanishes.
    #[test]
    fn linear_film_is_valid_until_its_width_vanishes() {
        let law = Law::Elastic(Elastic { young: 1e8, poisson: 0.3 });
        let top = valid_to(&law, Mode::Uniaxial, false);
        let strain = |stretch: f64| 0.5 * (stretch * stretch - 1.0);
        assert!((2.0 * 0.3 * strain(top) - 0.9).abs() < 1e-12);
        let found = stresses(&law, Mode::Uniaxial, &[1.4, top]);
        for ([along, _], stretch) in found.into_iter().zip([1.4, top]) {
            assert!((along / (1e8 * strain(stretch) * stretch) - 1.0).abs() < 1e-9, "{along}");
        }
    }
}
