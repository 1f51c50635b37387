//! The plastic part of a step: the amount of flow after which stress and flow stress agree.
//!
//! While a trial relaxes by the flow `γ` to `σ̄`, p grows by `γ σ̄` (theory.md, equations 258 and 261). Both are
//! monotone, so the root is unique.

use super::hardening::Hardening;
use super::rate::{FlowRate, RateTable};
use super::root::root;
use super::trial::{ROUND_OFF, Relaxed, Trial};
use crate::lane::{Lane, exp, ln, splat};

/// Range of ln γ that is searched.
const DEEPEST: f64 = 200.0;

impl<const L: usize> Trial<'_, L> {
    /// γ of this step of `dt` (s), zero where the trial does not flow; none where no lane flows. Without time, flow is
    /// slow.
    #[inline(always)]
    pub(super) fn flow(&self, hardening: &Hardening, rate: &FlowRate, dt: f64) -> Option<Lane<L>> {
        let excess = self.excess();
        let mut open = splat::<L>(0.0);
        for l in 0..L {
            // Also the residual with which `root` starts: infinite where there is something to be found.
            open[l] = if excess[l] > ROUND_OFF { f64::INFINITY } else { 0.0 };
        }
        // Most steps of most elements are elastic, and the search costs many times the trial.
        if open == splat(0.0) {
            return None;
        }
        Some(match rate {
            FlowRate::Table(table) if dt > 0.0 => self.rated(hardening, table, dt, &excess, open),
            FlowRate::Independent | FlowRate::Table(_) => self.slow(hardening, &excess, open),
        })
    }

    /// The root of σ_y(p + γσ̄)/σ̄ = 1 in `open` lanes.
    #[inline(always)]
    fn slow(&self, hardening: &Hardening, excess: &Lane<L>, open: Lane<L>) -> Lane<L> {
        let mut most = splat(0.0);
        for l in 0..L {
            most[l] = if open[l] > 0.0 { self.most(excess[l]) } else { 0.0 };
        }
        // Over σ̄ instead of as a difference: the ratio has no unit, so one tolerance serves every film.
        root(splat(0.0), [splat(0.0), most], open, |gamma| {
            let Relaxed { stress, slope, .. } = self.relaxed(gamma);
            let mut p = *self.before;
            for l in 0..L {
                p[l] += gamma[l] * stress[l];
            }
            let flow = hardening.flow(&p);
            let (mut value, mut derivative) = (splat(0.0), splat(0.0));
            for l in 0..L {
                let per_stress = 1.0 / stress[l];
                let ratio = flow.stress[l] * per_stress;
                value[l] = ratio - 1.0;
                derivative[l] = (flow.slope[l] * (stress[l] - gamma[l] * slope[l]) + ratio * slope[l]) * per_stress;
            }
            [value, derivative]
        })
    }

    /// The root with the flow stress at the rate γσ̄/dt, in ln γ.
    #[inline(always)]
    fn rated(&self, hardening: &Hardening, rate: &RateTable, dt: f64, excess: &Lane<L>, open: Lane<L>) -> Lane<L> {
        // In ln γ: the flow stress is linear in the logarithm of the rate, and γ may lie orders of magnitude below its
        // bound.
        let log_dt = ln(dt);
        let (mut least, mut most) = (splat(0.0), splat(0.0));
        for l in 0..L {
            let flows = open[l] > 0.0;
            let slow = ln(if flows { self.most(excess[l]) } else { 1.0 });
            most[l] = if flows { slow } else { 0.0 };
            least[l] = most[l] - DEEPEST;
        }
        let log = root(most, [least, most], open, |log| {
            let mut gamma = splat(0.0);
            for l in 0..L {
                gamma[l] = exp(log[l]);
            }
            let Relaxed { stress, slope, .. } = self.relaxed(&gamma);
            let (mut p, mut log_rate) = (*self.before, splat(0.0));
            for l in 0..L {
                let growth = gamma[l] * stress[l];
                p[l] += growth;
                log_rate[l] = log[l] + ln(stress[l]) - log_dt;
            }
            let flow = rate.flow(&hardening.flow(&p), &p, &log_rate);
            let (mut value, mut derivative) = (splat(0.0), splat(0.0));
            for l in 0..L {
                let per_stress = 1.0 / stress[l];
                let ratio = flow.stress[l] * per_stress;
                // dσ̄/d ln γ = −falls.
                let falls = gamma[l] * slope[l];
                let grows = 1.0 - falls * per_stress;
                value[l] = ratio - 1.0;
                derivative[l] =
                    flow.by_strain[l] * gamma[l] * grows + (flow.by_log_rate[l] * grows + ratio * falls) * per_stress;
            }
            [value, derivative]
        });
        let mut gamma = splat(0.0);
        for l in 0..L {
            gamma[l] = if open[l] > 0.0 { exp(log[l]) } else { 0.0 };
        }
        gamma
    }
}
