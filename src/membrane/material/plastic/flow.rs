//! The plastic part of a step: the amount of flow after which stress and flow stress agree.
//!
//! While a trial relaxes by the flow `γ` to `σ̄`, p grows by `γ σ̄` (theory.md, equations 258 and 261). Both are
//! monotone, so the root is unique.

use super::hardening::Hardening;
use super::rate::{FlowRate, RateTable};
use crate::lane::{Lane, Mask, ln, splat};
use crate::material::elastic::Plane;

/// Range of ln γ that is searched.
const DEEPEST: f64 = 200.0;

impl<const L: usize> Trial<L> {
    /// γ of this step of `dt` (s), zero where the trial does not flow; none where no lane flows. Without time, flow is
    /// slow.
    #[inline(always)]
    pub(super) fn flow(&self, hardening: &Hardening, rate: &FlowRate, dt: f64) -> Option<Lane<L>> {
        let excess = self.excess();
        let flows = excess.above(ROUND_OFF);
        // Most steps of most elements are elastic, and the search costs many times the trial.
        if !flows.any() {
            return None;
        }
        Some(match rate {
            FlowRate::Table(table) if dt > 0.0 => self.rated(hardening, table, dt, excess, flows),
            FlowRate::Independent | FlowRate::Table(_) => self.slow(hardening, excess, flows),
        })
    }

    /// The root of σ_y(p + γσ̄)/σ̄ = 1 where the trial `flows`.
    #[inline(always)]
    fn slow(&self, hardening: &Hardening, excess: Lane<L>, flows: Mask<L>) -> Lane<L> {
        let most = flows.select(self.most(excess), 0.0);
        let mut search = Search::new(splat(0.0), [splat(0.0), most], flows);
        while search.goes_on() {
            let gamma = search.x;
            let Relaxed { stress, slope, .. } = self.relaxed(gamma);
            let flow = hardening.flow(self.before + gamma * stress);
            let per_stress = 1.0 / stress;
            // Over σ̄ instead of as a difference: the ratio has no unit, so one tolerance serves every film.
            let ratio = flow.stress * per_stress;
            let derivative = (flow.slope * (stress - gamma * slope) + ratio * slope) * per_stress;
            search.step(ratio - 1.0, derivative);
        }
        search.x
    }

    /// The root with the flow stress at the rate γσ̄/dt, in ln γ.
    #[inline(always)]
    fn rated(&self, hardening: &Hardening, rate: &RateTable, dt: f64, excess: Lane<L>, flows: Mask<L>) -> Lane<L> {
        // In ln γ: the flow stress is linear in the logarithm of the rate, and γ may lie orders of magnitude below its
        // bound.
        let most = flows.select(self.most(excess), 1.0).ln();
        let log_dt = ln(dt);
        let mut search = Search::new(most, [most - DEEPEST, most], flows);
        while search.goes_on() {
            let gamma = search.x.exp();
            let Relaxed { stress, slope, .. } = self.relaxed(gamma);
            let p = self.before + gamma * stress;
            let flow = rate.flow(&hardening.flow(p), p, search.x + stress.ln() - log_dt);
            let per_stress = 1.0 / stress;
            let ratio = flow.stress * per_stress;
            // dσ̄/d ln γ = −falls.
            let falls = gamma * slope;
            let grows = 1.0 - falls * per_stress;
            let derivative = flow.by_strain * gamma * grows + (flow.by_log_rate * grows + ratio * falls) * per_stress;
            search.step(ratio - 1.0, derivative);
        }
        flows.select(search.x.exp(), 0.0)
    }
}

/// Value at which Newton's method takes its last step, which squares it.
const TOLERANCE: f64 = 1e-10;

/// Most steps of Newton's method or bisections: beyond the bisections of any bracket to round-off.
const STEPS: usize = 120;

/// A search for the root of a function that grows. The caller evaluates the function: a closure that all vector widths
/// share may not be inlined, and would run without vector instructions.
struct Search<const L: usize> {
    x: Lane<L>,
    /// The root lies between.
    low: Lane<L>,
    high: Lane<L>,
    /// Size of the last step.
    last: Lane<L>,
    /// Where it goes on.
    open: Mask<L>,
    steps: usize,
}

impl<const L: usize> Search<L> {
    /// The search between `low` and `high` from `x` on, in `open` lanes.
    #[inline(always)]
    fn new(x: Lane<L>, [low, high]: [Lane<L>; 2], open: Mask<L>) -> Search<L> {
        Search { x, low, high, last: splat(f64::INFINITY), open, steps: STEPS }
    }

    /// Whether the function at `x` is asked for.
    #[inline(always)]
    fn goes_on(&self) -> bool {
        self.steps > 0 && self.open.any()
    }

    /// Moves `x`, where the function has this value and derivative.
    #[inline(always)]
    fn step(&mut self, value: Lane<L>, derivative: Lane<L>) {
        let Search { x, low, high, last, open, steps } = self;
        let is_below = value.below(0.0);
        // The bracket shrinks with every value, so bisection is always at hand.
        *low = is_below.select(*x, *low);
        *high = is_below.select(*high, *x);
        // A kink of a table may have Newton's method jump to and fro: it must at least halve its last step, or bisection
        // takes over.
        let newton = *x - value / derivative;
        let is_close = value.abs().at_most(TOLERANCE);
        let is_outside = newton.at_most(*low) | newton.at_least(*high) | (newton - *x).abs().above(0.5 * *last);
        // A NaN must propagate.
        let next = (is_outside & !is_close).select(0.5 * (*low + *high), newton);
        *last = (next - *x).abs();
        // A lane that is done keeps its bits whatever its neighbours still search: no lane depends on another.
        *x = open.select(next, *x);
        *open = *open & value.abs().above(TOLERANCE);
        *steps -= 1;
    }
}

/// Trials above the flow stress by less than this share do not flow.
pub(super) const ROUND_OFF: f64 = 4e-15;

/// An elastic trial.
pub(super) struct Trial<const L: usize> {
    /// κ_i, Pa.
    pub(super) stiffness: [f64; 3],
    /// The least of them.
    pub(super) softest: f64,
    /// a_i.
    pub(super) squares: Plane<L>,
    /// p before the step.
    pub(super) before: Lane<L>,
    /// Flow stress at p before the step, slow, Pa.
    pub(super) flow_stress: Lane<L>,
}

/// σ̄, 1/(1 + γκ_i) and −dσ̄/dγ.
pub(super) struct Relaxed<const L: usize> {
    pub(super) stress: Lane<L>,
    pub(super) shares: Plane<L>,
    pub(super) slope: Lane<L>,
}

impl<const L: usize> Trial<L> {
    /// σ̄ of the trial over the flow stress, less one.
    #[inline(always)]
    pub(super) fn excess(&self) -> Lane<L> {
        let [a, b, c] = self.squares;
        (a + b + c).sqrt() / self.flow_stress - 1.0
    }

    /// The stress after the flow γ.
    #[inline(always)]
    pub(super) fn relaxed(&self, gamma: Lane<L>) -> Relaxed<L> {
        let ([a, b, c], [k1, k2, k3]) = (self.squares, self.stiffness);
        let shares @ [first, second, shear] =
            [1.0 / (1.0 + gamma * k1), 1.0 / (1.0 + gamma * k2), 1.0 / (1.0 + gamma * k3)];
        let [a, b, c] = [a * first * first, b * second * second, c * shear * shear];
        let stress = (a + b + c).sqrt();
        // The derivative comes with the value: both need the same quotients.
        let slope = (a * first * k1 + b * second * k2 + c * shear * k3) / stress;
        Relaxed { stress, shares, slope }
    }

    /// A bound on γ from above: σ̄ is at most that of the trial over 1 + γ min κ; a margin for round-off.
    #[inline(always)]
    pub(super) fn most(&self, excess: Lane<L>) -> Lane<L> {
        excess / self.softest * (1.0 + 1e-6)
    }
}
