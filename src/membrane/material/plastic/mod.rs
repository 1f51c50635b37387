//! Plastic films: elastoplasticity in plane stress on logarithmic strain, with Hill's orthotropic yield function,
//! isotropic hardening and rate dependence.
//!
//! The plastic strain is subtracted from the logarithmic strain of Lagrange (Miehe, Apel and Lambrecht, Comput. Methods
//! Appl. Mech. Engng 191, 2002; theory.md, equations 250 to 267), so that the law of small strain holds between E and
//! T, with MD and TD of stress-free film as axes:
//!
//! ```text
//! E = ½ ln C ,   T = ℂ (E − E_p) ,   S = T : 2 ∂E/∂C
//! σ̄(T) ≤ σ_y(p, ṗ) ,   Ė_p = ṗ ∂σ̄/∂T
//! ```

mod flow;
mod hardening;
mod hill;
mod logarithm;
mod modes;
mod rate;
#[cfg(test)]
mod tests;

use flow::Trial;
use logarithm::Logarithm;
use modes::Modes;
use serde::{Deserialize, Serialize};

use super::elastic::{Elastic, Plane};
use super::history::History;
use super::{Deformation, Energy, MembraneLaw, Stiffness, Stress};
use crate::lane::{Lane, one, splat};

pub use hardening::{FlowCurve, FlowCurveError, Hardening, Voce};
pub use hill::Hill;
pub use rate::{FlowRate, RateTable, RateTableError};

/// A plastic film.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Plastic {
    elastic: Elastic,
    hill: Hill,
    hardening: Hardening,
    rate: FlowRate,
    modes: Modes,
}

/// History variables of plastic film, one integration point a lane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlasticHistory<const L: usize> {
    /// Plastic strain E_p, logarithmic: components 11, 22 and 12.
    strain: Plane<L>,
    /// Equivalent plastic strain p.
    equivalent: Lane<L>,
    /// σ̄ over the slow flow stress at the end of the last step, Pa; zero where it is not above.
    overstress: Lane<L>,
    /// Plastic work beyond that of slow flow, J/m³.
    surplus: Lane<L>,
    /// Share of the layers that are not broken, MD and TD; all of them, since the law has no break strain.
    left: [Lane<L>; 2],
}

impl<const L: usize> History<L> for PlasticHistory<L> {
    fn virgin() -> Self {
        let nothing = splat(0.0);
        PlasticHistory {
            strain: [nothing; 3],
            equivalent: nothing,
            overstress: nothing,
            surplus: nothing,
            left: [splat(1.0); 2],
        }
    }

    /// Zero: the law depends on no largest strain.
    #[inline(always)]
    fn peak(&self, _fibre: usize) -> &Lane<L> {
        const { &splat(0.0) }
    }

    #[inline(always)]
    fn left(&self, fibre: usize) -> &Lane<L> {
        &self.left[fibre]
    }

    fn left_mut(&mut self, fibre: usize) -> &mut Lane<L> {
        &mut self.left[fibre]
    }

    fn variables(&mut self) -> impl Iterator<Item = &mut Lane<L>> {
        let scalars = [&mut self.equivalent, &mut self.overstress, &mut self.surplus];
        self.strain.iter_mut().chain(scalars).chain(&mut self.left)
    }
}

impl Plastic {
    /// Film with isotropic elasticity, Hill's yield function, whose yield surface must be closed, and the flow stress
    /// of `hardening` along MD at the lowest `rate`.
    pub fn new(elastic: Elastic, hill: Hill, hardening: Hardening, rate: FlowRate) -> Plastic {
        let modes = Modes::new(elastic.young, elastic.poisson, &hill);
        Plastic { elastic, hill, hardening, rate, modes }
    }

    /// Its isotropic elasticity.
    pub fn elastic(&self) -> &Elastic {
        &self.elastic
    }

    /// How the flow stress depends on the rate.
    pub fn rate(&self) -> &FlowRate {
        &self.rate
    }

    /// The flow stress of slow flow.
    pub fn hardening(&self) -> &Hardening {
        &self.hardening
    }

    /// Strain along MD at which slow flow begins.
    pub fn yield_strain(&self) -> f64 {
        self.hardening.initial() / self.elastic.young
    }

    /// The yield function.
    pub fn hill(&self) -> &Hill {
        &self.hill
    }

    /// Lowest and highest rate of plastic strain of a table by rate, 1/s.
    pub fn rates(&self) -> Option<[f64; 2]> {
        self.rate.range()
    }

    /// Flow stress at the equivalent plastic strain `p` and its constant rate, 1/s, Pa.
    pub fn flow_stress(&self, p: f64, rate: f64) -> f64 {
        self.rate.stress_at(self.hardening.flow(one(p)), p, rate)
    }

    /// Amplitudes of the elastic strain with the plastic strain `plastic`.
    #[inline(always)]
    fn amplitudes<const L: usize>(&self, log: &Logarithm<L>, plastic: &Plane<L>) -> Plane<L> {
        let mut elastic = log.strain;
        for i in 0..3 {
            elastic[i] -= plastic[i];
        }
        self.modes.amplitudes(&elastic)
    }

    /// The stress after the flow `gamma` of `trial`, whose amplitudes relax; updates the history.
    #[inline(always)]
    fn relax<const L: usize>(
        &self,
        trial: &Trial<L>,
        gamma: Lane<L>,
        amplitudes: &mut Plane<L>,
        history: &mut PlasticHistory<L>,
    ) -> Plane<L> {
        // In the modes of equation 257 elasticity and yield function are both diagonal, so relaxation scales each
        // amplitude by itself.
        let relaxed = trial.relaxed(gamma);
        for i in 0..3 {
            amplitudes[i] *= relaxed.shares[i];
        }
        let t = self.modes.stress(amplitudes);
        let ([along, across], Hill { h, n, .. }) = (self.hill.normal(), self.hill);
        // Δp = γ σ̄, as σ̄ is homogeneous of degree one.
        let p = trial.before + gamma * relaxed.stress;
        // ΔE_p = γ P T with the stress at the end of the step (equation 258): backward Euler, stable for any step.
        history.strain[0] += gamma * (along * t[0] - h * t[1]);
        history.strain[1] += gamma * (across * t[1] - h * t[0]);
        history.strain[2] += gamma * n * t[2];
        if !matches!(self.rate, FlowRate::Independent) {
            let above = (relaxed.stress - self.hardening.flow(p).stress).max(0.0);
            // Of a lane that does not flow what is left is round-off.
            let over = gamma.above(0.0).select(above, 0.0);
            // Trapezoid of the overstress over p (equation 262); the slow part is the integral of the curve and needs
            // no sum.
            history.surplus += 0.5 * (history.overstress + over) * (p - history.equivalent);
            history.overstress = over;
        }
        history.equivalent = p;
        t
    }
}

impl MembraneLaw for Plastic {
    type History<const L: usize> = PlasticHistory<L>;

    #[inline(always)]
    fn stress<const L: usize>(&self, d: &Deformation<L>, history: &mut PlasticHistory<L>, dt: f64) -> Stress<L> {
        let log = Logarithm::from_cauchy_green(&d.metric());
        let mut amplitudes = self.amplitudes(&log, &history.strain);
        let before = history.equivalent;
        let trial = Trial {
            stiffness: self.modes.stiffness,
            softest: self.modes.softest(),
            squares: self.modes.squares(&amplitudes),
            before,
            flow_stress: self.hardening.flow(before).stress,
        };
        // Where no lane flows, the rest changes nothing.
        let t = match trial.flow(&self.hardening, &self.rate, dt) {
            Some(gamma) => self.relax(&trial, gamma, &mut amplitudes, history),
            None => {
                history.overstress = splat(0.0);
                self.modes.stress(&amplitudes)
            }
        };
        Elastic::first_piola(d, log.second_piola(&t))
    }

    #[inline(always)]
    fn stress_of<const L: usize>(&self, d: &Deformation<L>, history: &PlasticHistory<L>) -> Stress<L> {
        let log = Logarithm::from_cauchy_green(&d.metric());
        let t = self.modes.stress(&self.amplitudes(&log, &history.strain));
        Elastic::first_piola(d, log.second_piola(&t))
    }

    /// All plastic work is absorbed: what hardening stores in the film does not come back.
    #[inline(always)]
    fn energy<const L: usize>(&self, d: &Deformation<L>, history: &PlasticHistory<L>) -> Energy<L> {
        let amplitudes = self.amplitudes(&Logarithm::from_cauchy_green(&d.metric()), &history.strain);
        let absorbed = self.hardening.work(history.equivalent) + history.surplus;
        Energy { stored: self.modes.stored(&amplitudes), absorbed }
    }

    /// Bound of elastic loading: flow lowers it.
    #[inline(always)]
    fn stiffness<const L: usize>(&self, d: &Deformation<L>, history: &PlasticHistory<L>) -> Stiffness<L> {
        let log = Logarithm::from_cauchy_green(&d.metric());
        let t = self.modes.stress(&self.amplitudes(&log, &history.strain));
        let Elastic { young, poisson } = self.elastic;
        Stiffness::in_any_direction(log.bound(&t, [self.elastic.plane(), poisson, 0.5 * young / (1.0 + poisson)]))
    }

    /// Plastic flow keeps the volume: ln λ₃ = (1 − 2ν)/Y (T₁₁ + T₂₂) − ½ ln det C, and T₁₁ + T₂₂ = C:S.
    fn thickness_ratio<const L: usize>(&self, d: &Deformation<L>, stress: &Stress<L>) -> Lane<L> {
        let c = d.metric();
        let trace = logarithm::trace(&c, &[stress.tension[0], stress.tension[1], stress.cross]);
        let volume = (1.0 - 2.0 * self.elastic.poisson) / self.elastic.young;
        (volume * trace).exp() / (c[0] * c[1] - c[2] * c[2]).sqrt()
    }

    fn moduli(&self) -> [f64; 2] {
        [self.elastic.plane(); 2]
    }

    fn plastic_strain<'a, const L: usize>(&self, history: &'a PlasticHistory<L>) -> Option<&'a Lane<L>> {
        Some(&history.equivalent)
    }
}
