//! The flow of a step with the law of Cowper and Symonds.
//!
//! The unknown is q, the share of the slow flow stress by which σ̄ is above it. Growth of p, σ̄ and γ follow from it,
//! and the trial must relax to σ̄ by γ (theory.md, equation 261a):
//!
//! ```text
//! Δp = D q^P Δt ,   σ̄ = σ_y(p + Δp) (1 + q) ,   γ = Δp/σ̄
//! ```
//!
//! From p to p + Δp the flow stress does not fall, and γ σ̄ grows with γ where the trial relaxes to σ̄: a q below the
//! root gives a stress below the one to which the trial relaxes, a q above it one above.

use super::hardening::Hardening;
use super::rate::CowperSymonds;
use super::root::root;
use super::trial::{ROUND_OFF, Trial};
use crate::lane::{Lane, larger, smaller, splat};

/// A trial that relaxes to an overstress in `dt` (s).
pub(super) struct Overstress<'a, const L: usize> {
    pub(super) trial: &'a Trial<'a, L>,
    pub(super) hardening: &'a Hardening,
    pub(super) law: &'a CowperSymonds,
    pub(super) dt: f64,
}

/// Quantities that follow from q.
struct Flowing<const L: usize> {
    /// σ̄, Pa, and its derivative by q.
    stress: [Lane<L>; 2],
    /// γ, 1/Pa.
    gamma: Lane<L>,
    /// Derivative of Δp by q.
    grows: Lane<L>,
}

impl<const L: usize> Overstress<'_, L> {
    /// γ of the step in `open` lanes, from the q of the last step on; zero in others. `excess` is σ̄ of the trial over
    /// the flow stress, less one.
    #[inline(always)]
    pub(super) fn flow(&self, excess: &Lane<L>, open: Lane<L>) -> Lane<L> {
        let (mut most, mut start, mut most_growth) = (splat::<L>(0.0), splat::<L>(0.0), splat::<L>(0.0));
        for l in 0..L {
            most[l] = larger(excess[l], ROUND_OFF);
            let last = self.trial.overstress[l] / self.trial.flow_stress[l];
            let least = smaller(last, most[l]);
            // The overstress hardly changes from step to step; a first one begins at its bound, from which Newton's
            // method descends.
            start[l] = if last > 0.0 { least } else { most[l] };
        }
        for l in 0..L {
            // Far from the root the growth may overflow.
            most_growth[l] = self.trial.most(most[l]) * (1.0 + most[l]) * self.trial.flow_stress[l];
        }
        let q = root(start, [splat(0.0), most], open, |q| {
            let Flowing { stress: [stress, rises], gamma, grows } = self.flowing(q, &most_growth);
            let relaxed = self.trial.relaxed(&gamma);
            let (mut value, mut derivative) = (splat(0.0), splat(0.0));
            for l in 0..L {
                let per_relaxed = 1.0 / relaxed.stress[l];
                let ratio = stress[l] * per_relaxed;
                value[l] = ratio - 1.0;
                let flows = (grows[l] - gamma[l] * rises[l]) / stress[l];
                derivative[l] = (rises[l] + ratio * relaxed.slope[l] * flows) * per_relaxed;
            }
            [value, derivative]
        });
        let mut gamma = self.flowing(&q, &most_growth).gamma;
        for l in 0..L {
            gamma[l] = if open[l] > 0.0 { gamma[l] } else { 0.0 };
        }
        gamma
    }

    #[inline(always)]
    fn flowing(&self, q: &Lane<L>, most_growth: &Lane<L>) -> Flowing<L> {
        let power = self.law.power_below(q);
        let (mut growth, mut grows, mut p) = (splat::<L>(0.0), splat::<L>(0.0), *self.trial.before);
        for l in 0..L {
            let per_share = self.dt * self.law.reference * power[l];
            growth[l] = smaller(per_share * q[l], most_growth[l]);
            grows[l] = self.law.exponent * per_share;
            p[l] += growth[l];
        }
        let slow = self.hardening.flow(&p);
        let (mut stress, mut gamma) = ([splat::<L>(0.0); 2], splat::<L>(0.0));
        for l in 0..L {
            let factor = 1.0 + q[l];
            stress[0][l] = slow.stress[l] * factor;
            stress[1][l] = slow.slope[l] * grows[l] * factor + slow.stress[l];
            // The unknown is q, not γ: Δp = D q^P Δt follows from it directly for any power P (theory.md, equation
            // 261a).
            gamma[l] = growth[l] / stress[0][l];
        }
        Flowing { stress, gamma, grows }
    }
}
