//! The plastic part of a step: the amount of flow after which stress and flow stress agree.
//!
//! While a trial relaxes by the flow `γ` to `σ̄`, p grows by `γ σ̄` (theory.md, equations 258 and 261). Both are
//! monotone, so the root is unique.

use super::hardening::Hardening;
use super::rate::{FlowRate, RateTable};
use crate::lane::{Lane, exp, lanes, larger, ln, splat};
use crate::material::elastic::Plane;

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

/// Value at which Newton's method takes its last step, which squares it.
const TOLERANCE: f64 = 1e-10;

/// Most steps of Newton's method or bisections: beyond the bisections of any bracket to round-off.
const STEPS: usize = 120;

/// The root of a function that grows, between `low` and `high`, from `x` on in lanes where `open` is not zero. `of`
/// gives value and derivative.
#[inline(always)]
fn root<const L: usize>(
    mut x: Lane<L>,
    [mut low, mut high]: [Lane<L>; 2],
    mut open: Lane<L>,
    of: impl Fn(&Lane<L>) -> [Lane<L>; 2],
) -> Lane<L> {
    let mut last = splat::<L>(f64::INFINITY);
    for _ in 0..STEPS {
        let [value, derivative] = of(&x);
        let mut widest = 0.0;
        for l in 0..L {
            let is_below = value[l] < 0.0;
            // The bracket shrinks with every value, so bisection is always at hand.
            low[l] = if is_below { x[l] } else { low[l] };
            high[l] = if is_below { high[l] } else { x[l] };
            // A kink of a table may have Newton's method jump to and fro: it must at least halve its last step, or
            // bisection takes over.
            let newton = x[l] - value[l] / derivative[l];
            let is_close = value[l].abs() <= TOLERANCE;
            let is_outside = (newton <= low[l]) | (newton >= high[l]) | ((newton - x[l]).abs() > 0.5 * last[l]);
            // A NaN must propagate.
            let next = if is_outside & !is_close { 0.5 * (low[l] + high[l]) } else { newton };
            let is_open = open[l] > TOLERANCE;
            last[l] = (next - x[l]).abs();
            // A lane that is done keeps its bits whatever its neighbours still search: no lane depends on another.
            x[l] = if is_open { next } else { x[l] };
            open[l] = if is_open { value[l].abs() } else { open[l] };
            widest = larger(open[l], widest);
        }
        if widest <= TOLERANCE {
            break;
        }
    }
    x
}

/// Trials above the flow stress by less than this share do not flow.
pub(super) const ROUND_OFF: f64 = 4e-15;

/// An elastic trial.
pub(super) struct Trial<'a, const L: usize> {
    /// κ_i, Pa.
    pub(super) stiffness: [f64; 3],
    /// The least of them.
    pub(super) softest: f64,
    /// a_i.
    pub(super) squares: Plane<L>,
    /// p before the step.
    pub(super) before: &'a Lane<L>,
    /// Flow stress at p before the step, slow, Pa.
    pub(super) flow_stress: Lane<L>,
}

/// σ̄, 1/(1 + γκ_i) and −dσ̄/dγ.
pub(super) struct Relaxed<const L: usize> {
    pub(super) stress: Lane<L>,
    pub(super) shares: Plane<L>,
    pub(super) slope: Lane<L>,
}

impl<const L: usize> Trial<'_, L> {
    /// σ̄ of the trial over the flow stress, less one.
    #[inline(always)]
    pub(super) fn excess(&self) -> Lane<L> {
        let [a, b, c] = &self.squares;
        lanes(|l| (a[l] + b[l] + c[l]).sqrt() / self.flow_stress[l] - 1.0)
    }

    /// The stress after the flow γ.
    #[inline(always)]
    pub(super) fn relaxed(&self, gamma: &Lane<L>) -> Relaxed<L> {
        let nothing = splat(0.0);
        let mut out = Relaxed { stress: nothing, shares: [nothing; 3], slope: nothing };
        let mut falls = splat::<L>(0.0);
        for i in 0..3 {
            for l in 0..L {
                let share = 1.0 / (1.0 + gamma[l] * self.stiffness[i]);
                let square = self.squares[i][l] * share * share;
                out.shares[i][l] = share;
                out.stress[l] += square;
                // The derivative comes with the value: both need the same quotient.
                falls[l] += square * share * self.stiffness[i];
            }
        }
        for l in 0..L {
            out.stress[l] = out.stress[l].sqrt();
            out.slope[l] = falls[l] / out.stress[l];
        }
        out
    }

    /// A bound on γ from above: σ̄ is at most that of the trial over 1 + γ min κ; a margin for round-off.
    #[inline(always)]
    pub(super) fn most(&self, excess: f64) -> f64 {
        excess / self.softest * (1.0 + 1e-6)
    }
}
