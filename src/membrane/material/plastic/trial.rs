//! An elastic trial, and the stress to which it relaxes as film flows.
//!
//! A trial with the squares `a_i = κ_i y_i²` relaxes by the flow `γ` to `σ̄² = Σ a_i/(1 + γκ_i)²` (theory.md, equation
//! 258; Simo and Taylor, Int. J. Numer. Meth. Engng 22, 1986).

use crate::lane::{Lane, lanes, splat};
use crate::material::elastic::Plane;

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
