//! Film as a fabric: two fibre sets and shear.
//!
//! Energy per volume of stress-free film (theory.md, equations 4–7), with λ_i = |f_i|, ε_i = λ_i − 1:
//!
//! ```text
//! W = W_md(ε₁) + W_td(ε₂) + W_s(γ),    sin γ = f₁·f₂ / (m₁ m₂),   m_i = max(λ_i, 1)
//! ∂W/∂f₁ = σ_md f₁/λ₁ + τ(γ)/cos γ · ( f₂/(m₁ m₂) − [λ₁ > 1] sin γ · f₁/λ₁² )
//! ```
//!
//! and the same with the indices exchanged. γ is the angle by which taut fibres deviate from their right angle;
//! a slack fibre carries no stress, and its part in shear decreases with its length instead of growing without bound.
//! Beyond |sin γ| = 0.95 the angle is continued along its tangent, so that the force is bounded as the fibres align.
//! Biaxial coupling adds W_b(ε₁ + ε₂) (equation 4b).

use serde::{Deserialize, Serialize};

use super::fibre::FibreLaw;
use super::fibre_strains::Fibres;
use super::history::PointHistory;
use super::{
    Absorption, Curve, Deformation, Energy, LayerBreaks, Measure, MembraneLaw, Stiffness, Stress, ViscousBase,
    WithoutCompression,
};
use crate::lane::{Lane, splat};

/// Two fibre sets at 90° in the stress-free film, each with a curve or with curves by strain rate, and a shear curve,
/// with energy absorption on unloading.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Fabric<F = Curve> {
    md: F,
    td: F,
    shear: Curve,
    absorption: Absorption,
    layer_breaks: LayerBreaks,
    /// The stress σ_b over (ε₁ + ε₂)/2 that both directions carry besides their own.
    biaxial: Option<F>,
}

impl<F: FibreLaw> Fabric<F> {
    /// Nominal stress (Pa) over engineering strain for MD and TD, shear stress (Pa) over shear angle (rad),
    /// and the share 0 ≤ `absorption` < 1 of the stored energy that is lost on unloading, in the fibres and in shear.
    pub fn new(md: F, td: F, shear: Curve, absorption: f64) -> Fabric<F> {
        let absorption = Absorption::new(absorption);
        Fabric { md, td, shear, absorption, layer_breaks: LayerBreaks::default(), biaxial: None }
    }

    /// This film with biaxial coupling: where the strains of both directions are equal, each carries `ratio` > 0
    /// times the mean stress of both curves besides its own (theory.md, equation 4b).
    pub fn with_biaxial(self, ratio: f64) -> Fabric<F> {
        assert!(ratio > 0.0 && ratio.is_finite(), "ratio of biaxial coupling: {ratio}");
        let biaxial = Some(F::mean(&self.md, &self.td, ratio));
        Fabric { biaxial, ..self }
    }

    /// This film of layers that break one after another.
    pub fn with_layer_breaks(self, layer_breaks: LayerBreaks) -> Fabric<F> {
        Fabric { layer_breaks, ..self }
    }

    /// Curve of the MD fibres.
    pub fn md(&self) -> &F {
        &self.md
    }

    /// Curve of the TD fibres.
    pub fn td(&self) -> &F {
        &self.td
    }

    /// Shear stress over shear angle.
    pub fn shear(&self) -> &Curve {
        &self.shear
    }

    /// Whether MD and TD are coupled under biaxial load.
    pub fn has_biaxial(&self) -> bool {
        self.biaxial.is_some()
    }

    /// Whether its layers break one after another.
    pub fn breaks_by_layers(&self) -> bool {
        self.layer_breaks != LayerBreaks::default()
    }

    /// Share of the stored energy that is lost on unloading.
    pub fn absorption(&self) -> f64 {
        self.absorption.share()
    }
}

impl<F: FibreLaw> MembraneLaw for Fabric<F> {
    type History<const L: usize> = PointHistory<F::History<L>, L>;
    const MEASURE: Option<Measure> = Some(Measure::Fibres);

    #[inline(always)]
    fn stress<const L: usize>(&self, d: &Deformation<L>, history: &mut Self::History<L>, dt: f64) -> Stress<L> {
        let fibres = Fibres::from_deformation(d);
        let [history_md, history_td] = &mut history.fibres;
        let md = self.md.stress(self.absorption.at(fibres.strain(0)), history_md, dt);
        let td = self.td.stress(self.absorption.at(fibres.strain(1)), history_td, dt);
        let shear = self.absorption.stress(&self.shear, fibres.shear(), &mut history.shear);
        let mut tensions = fibres.tensions(of_layers_left([md, td, shear], &history.left));
        if let Some(law) = &self.biaxial {
            let stress = law.stress(self.absorption.at(fibres.mean_strain()), &mut history.biaxial, dt);
            tensions.add_biaxial(&fibres, of_both_left(stress, &history.left));
        }
        tensions.stress(d)
    }

    #[inline(always)]
    fn energy<const L: usize>(&self, d: &Deformation<L>, history: &Self::History<L>) -> Energy<L> {
        let fibres = Fibres::from_deformation(d);
        let parts = [
            self.md.energy(self.absorption.at(fibres.strain(0)), &history.fibres[0]),
            self.td.energy(self.absorption.at(fibres.strain(1)), &history.fibres[1]),
            self.absorption.energy(&self.shear, fibres.shear(), history.shear),
        ];
        let [md, td, shear] = parts;
        let stored = of_layers_left([md.0, td.0, shear.0], &history.left);
        let absorbed = of_layers_left([md.1, td.1, shear.1], &history.left);
        let mut total =
            Energy { stored: stored[0] + stored[1] + stored[2], absorbed: absorbed[0] + absorbed[1] + absorbed[2] };
        if let Some(law) = &self.biaxial {
            let (stored, absorbed) = law.energy(self.absorption.at(fibres.mean_strain()), &history.biaxial);
            // The curve is over the mean strain, W_b over the sum of both: dW_b = σ_b d(ε₁ + ε₂) = 2 σ_b d(mean).
            total.stored += 2.0 * of_both_left(stored, &history.left);
            total.absorbed += 2.0 * of_both_left(absorbed, &history.left);
        }
        total
    }

    #[inline(always)]
    fn stiffness<const L: usize>(&self, d: &Deformation<L>, history: &Self::History<L>) -> Stiffness<L> {
        /// Change of strain for which the bound holds.
        const REACH: f64 = 0.005;
        let fibres = Fibres::from_deformation(d);
        let angle = fibres.shear();
        let at = [self.absorption.at(fibres.strain(0)), self.absorption.at(fibres.strain(1))];
        let near = [
            self.md.stress_near(at[0], &history.fibres[0]),
            self.td.stress_near(at[1], &history.fibres[1]),
            self.absorption.stress(&self.shear, angle, &mut { history.shear }),
        ];
        let mut tensions = fibres.tensions(of_layers_left(near, &history.left));
        let mut biaxial = splat(0.0);
        if let Some(law) = &self.biaxial {
            let mean = self.absorption.at(fibres.mean_strain());
            let stress = law.stress_near(mean, &history.biaxial);
            tensions.add_biaxial(&fibres, of_both_left(stress, &history.left));
            let slope = law.largest_slope(mean, &history.biaxial, REACH);
            biaxial = of_both_left(slope, &history.left);
        }
        let across = [tensions.tension[0].abs(), tensions.tension[1].abs()];
        let slopes = [
            self.md.largest_slope(at[0], &history.fibres[0], REACH),
            self.td.largest_slope(at[1], &history.fibres[1], REACH),
            self.absorption.largest_slope(&self.shear, angle, history.shear, REACH),
        ];
        let [md, td, shear] = of_layers_left(slopes, &history.left);
        // (a₁ + a₂)² ≤ 2 (a₁² + a₂²), and the slope by ε₁ + ε₂ is half of that by their mean. `across` acts on every motion
        // of the fibre, also on that along it: what is counted there is not counted twice.
        let along = [(md + biaxial - across[0]).max(0.0), (td + biaxial - across[1]).max(0.0)];
        // The curve's own slope, and what its stress adds as directions turn; the larger of loading and largest stress so
        // far bounds unloading.
        let stress = of_both_left(self.shear.stress_lanes(angle.max(history.shear)), &history.left);
        let secant = fibres.secant;
        let shear = shear * secant * secant + stress * secant * (secant * secant + 3.0);
        Stiffness { along, across, shear, alignment: fibres.sine, any: splat(0.0) }
    }

    /// Undefined: the curves are of the stress-free cross-section and do not include the change of thickness.
    fn thickness_ratio<const L: usize>(&self, _d: &Deformation<L>, _stress: &Stress<L>) -> Lane<L> {
        splat(f64::NAN)
    }

    fn has_thickness(&self) -> bool {
        false
    }

    /// None where a curve does not rise from the origin.
    fn viscous(&self) -> Option<ViscousBase> {
        let ([md, td], shear) = (self.moduli(), self.shear.initial_slope());
        let between = self.biaxial.as_ref().map_or(0.0, |law| 0.5 * law.initial_slope());
        let determinant = (md + between) * (td + between) - between * between;
        let compliance =
            [(td + between) / determinant, (md + between) / determinant, -between / determinant, 1.0 / shear];
        let rises = determinant > 0.0 && shear > 0.0;
        rises.then_some(ViscousBase { measure: Measure::Fibres, compression: WithoutCompression::Fibres, compliance })
    }

    fn moduli(&self) -> [f64; 2] {
        [self.md.initial_slope(), self.td.initial_slope()]
    }

    fn early_modulus(&self) -> f64 {
        let fibres = [Some(&self.md), Some(&self.td), self.biaxial.as_ref()].into_iter().flatten();
        fibres.map(F::early_modulus).fold(self.shear.early_slope(), f64::max)
    }

    #[inline(always)]
    fn break_strains<const L: usize>(&self, history: &Self::History<L>) -> [Lane<L>; 2] {
        let first = self.layer_breaks.first();
        let (md, td) = (self.md.break_strain(&history.fibres[0]), self.td.break_strain(&history.fibres[1]));
        [md * first, td * first]
    }

    fn share_left(&self, ratio: f64) -> f64 {
        self.layer_breaks.share_left(ratio)
    }

    fn break_range(&self) -> [[f64; 2]; 2] {
        let ([md, longest_md], [td, longest_td]) = (self.md.break_strains(), self.td.break_strains());
        let last = self.layer_breaks.last();
        [[md, td], [last * longest_md, last * longest_td]]
    }
}

/// Values of one layer along MD, along TD and in shear as means over all layers: those in which one set of fibres is
/// broken carry no shear.
#[inline(always)]
fn of_layers_left<const L: usize>([md, td, shear]: [Lane<L>; 3], left: &[Lane<L>; 2]) -> [Lane<L>; 3] {
    [md * left[0], td * left[1], of_both_left(shear, left)]
}

/// A value of one layer for the coupling of both directions as a mean over all layers.
#[inline(always)]
fn of_both_left<const L: usize>(value: Lane<L>, left: &[Lane<L>; 2]) -> Lane<L> {
    value * left[0].min(left[1])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::{History, RateCurves};

    /// In pure tension the first Piola–Kirchhoff stress is the nominal stress of the curve.
    #[test]
    fn uniaxial_stress_is_that_of_the_curve() {
        let md = Curve::new(vec![[0.26, 8.4e6], [0.84, 20e6], [1.39, 29.3e6]]).unwrap();
        let td = Curve::new(vec![[0.33, 8e6], [0.69, 10e6], [7.01, 16.2e6]]).unwrap();
        let film = Fabric::new(md.clone(), td.clone(), Curve::new(vec![[1.0, 1e7]]).unwrap(), 0.9);
        for strain in [0.1, 0.26, 0.5, 1.0, 1.39] {
            let p =
                |[a, b]: [f64; 2]| film.stress(&[[a, 0.0, 0.0], [0.0, b, 0.0]].into(), &mut History::virgin(), 0.0).p;
            assert!((p([1.0 + strain, 1.0])[0][0][0] / md.stress(strain) - 1.0).abs() < 1e-14);
            assert!((p([1.0, 1.0 + strain])[1][1][0] / td.stress(strain) - 1.0).abs() < 1e-14);
        }
    }

    /// Both directions carry their part of the mean stress where their strains are equal, and the curve alone where
    /// film contracts across as much as it is stretched; the same with equal curves at several rates.
    #[test]
    fn biaxial_coupling_adds_its_stress_at_equal_strains() {
        let md = Curve::new(vec![[0.26, 8.4e6], [0.84, 20e6], [1.39, 29.3e6]]).unwrap();
        let td = Curve::new(vec![[0.33, 8e6], [0.69, 10e6], [7.01, 16.2e6]]).unwrap();
        let shear = Curve::new(vec![[1.0, 1e7]]).unwrap();
        let stress = |law: &dyn Fn(&Deformation<1>) -> Stress<1>, [first, second]: [f64; 2]| {
            let f = [[1.0 + first, 0.0, 0.0], [0.0, 1.0 + second, 0.0]];
            let p = law(&f.into()).p;
            [p[0][0][0], p[1][1][0]]
        };
        let one = Fabric::new(md.clone(), td.clone(), shear.clone(), 0.9).with_biaxial(0.8);
        let rates = [1.0, 10.0].map(|rate| (rate, md.clone()));
        let by_rate = [RateCurves::new(rates.to_vec(), 0.01).unwrap(), RateCurves::from(td.clone())];
        let [md_by_rate, td_by_rate] = by_rate;
        let by_rate = Fabric::new(md_by_rate, td_by_rate, shear, 0.9).with_biaxial(0.8);
        let laws: [&dyn Fn(&Deformation<1>) -> Stress<1>; 2] =
            [&|d| one.stress(d, &mut History::virgin(), 0.0), &|d| by_rate.stress(d, &mut History::virgin(), 0.01)];
        for law in laws {
            for strain in [0.1, 0.3, 0.5, 0.8, 1.2] {
                let added = 0.4 * (md.stress(strain) + td.stress(strain));
                let [along, across] = stress(law, [strain; 2]);
                assert!((along / (md.stress(strain) + added) - 1.0).abs() < 1e-12, "{along} at {strain}");
                assert!((across / (td.stress(strain) + added) - 1.0).abs() < 1e-12, "{across} at {strain}");
                let contracts = strain.min(0.9);
                let [along, across] = stress(law, [contracts, -contracts]);
                assert!((along / md.stress(contracts) - 1.0).abs() < 1e-12 && across.abs() < 1e-6, "{along} {across}");
            }
        }
    }
}
