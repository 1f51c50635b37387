//! The motion of a four-node element that its single integration point does not see.

use crate::lane::{LANES, Lane, Lane3, dot, splat};
use crate::material::{Deformation, MembraneLaw, Stress};

/// The mode ξη, with amplitude q = Σ γ_a x_a (theory.md, equations 11–14).
///
/// Across the element f_I varies by q times the mode's gradient, with mean square H_I |q|². The law sees it as
/// [`Deformation::spread`], so tension resists the mode as full integration would, from the same energy. Along the
/// fibres a small stiffness κ_I is added, ½ κ_I H_I (f_I·q)², because strains that cancel in the mean leave no trace in it.
#[derive(Clone, Debug)]
pub struct Hourglass<const NODES: usize> {
    /// γ_a, orthogonal to every linear field.
    pub shape: [Lane; NODES],
    /// Mean squares of the mode's gradient along MD and TD over the element, 1/m².
    pub mean_square: [Lane; 2],
}

/// Share of the initial modulus with which hourglass motion along the fibres is resisted.
const IN_PLANE_STABILISATION: f64 = 0.05;

impl<const NODES: usize> Hourglass<NODES> {
    /// q = Σ γ_a x_a; zero in every linear deformation, so also in the undeformed element.
    #[inline(always)]
    pub(super) fn amplitude(&self, x: &[Lane3; NODES]) -> Lane3 {
        let mut q = [splat(0.0); 3];
        for axis in 0..3 {
            for a in 0..NODES {
                for l in 0..LANES {
                    q[axis][l] += self.shape[a][l] * x[a][axis][l];
                }
            }
        }
        q
    }

    /// H_I |q|².
    #[inline(always)]
    pub(super) fn spread(&self, q: &Lane3) -> [Lane; 2] {
        let squared = dot(q, q);
        let mut spread = [splat(0.0); 2];
        for fibre in 0..2 {
            for l in 0..LANES {
                spread[fibre][l] = self.mean_square[fibre][l] * squared[l];
            }
        }
        spread
    }

    /// −V γ_a Σ_I H_I [ 2∂W/∂|f_I|² q + κ_I (f_I·q) f_I ]; adds what the stabilisation gives to ∂W/∂f_I,
    /// κ_I H_I (f_I·q) q, to the stress (theory.md, equation 14).
    #[inline(always)]
    pub(super) fn subtract_force(
        &self,
        out: &mut [Lane3; NODES],
        q: &Lane3,
        d: &Deformation,
        volume: &Lane,
        stress: &mut Stress,
        stabilisation: [f64; 2],
    ) {
        let mut resisted = [dot(&d.f[0], q), dot(&d.f[1], q)];
        let mut followed = splat(0.0);
        for fibre in 0..2 {
            for l in 0..LANES {
                resisted[fibre][l] *= stabilisation[fibre] * self.mean_square[fibre][l];
                followed[l] += self.mean_square[fibre][l] * stress.tension[fibre][l];
            }
        }
        for axis in 0..3 {
            let mut h = splat(0.0);
            for l in 0..LANES {
                let along = resisted[0][l] * d.f[0][axis][l] + resisted[1][l] * d.f[1][axis][l];
                h[l] = volume[l] * (followed[l] * q[axis][l] + along);
                stress.p[0][axis][l] += resisted[0][l] * q[axis][l];
                stress.p[1][axis][l] += resisted[1][l] * q[axis][l];
            }
            for a in 0..NODES {
                for l in 0..LANES {
                    out[a][axis][l] -= self.shape[a][l] * h[l];
                }
            }
        }
    }

    /// Bound on the stabilisation's stiffness in one lane, with `g` = Σ_a (∂N_a/∂X_I)²: the two parts of
    /// ∂(f_I·q), each doubled for the product of both.
    pub(super) fn stiffness(
        &self,
        q: &Lane3,
        d: &Deformation,
        stabilisation: [f64; 2],
        g: [f64; 2],
        lane: usize,
    ) -> f64 {
        let square = |v: &Lane3| v.iter().map(|x| x[lane] * x[lane]).sum::<f64>();
        let shape = self.shape.iter().map(|s| s[lane] * s[lane]).sum::<f64>();
        (0..2)
            .map(|i| {
                let moved = square(&d.f[i]) * shape + square(q) * g[i];
                2.0 * stabilisation[i] * self.mean_square[i][lane] * moved
            })
            .sum()
    }

    /// Energy of the stabilisation, ½ Σ_I κ_I H_I (f_I·q)², J/m³.
    pub(super) fn energy(&self, q: &Lane3, d: &Deformation, stabilisation: [f64; 2]) -> Lane {
        let mut energy = splat(0.0);
        for fibre in 0..2 {
            let along = dot(&d.f[fibre], q);
            for l in 0..LANES {
                energy[l] += 0.5 * stabilisation[fibre] * self.mean_square[fibre][l] * along[l] * along[l];
            }
        }
        energy
    }
}

/// Stiffness κ_I with which hourglass motion along the fibres is resisted, Pa.
pub(super) fn stabilisation(law: &impl MembraneLaw) -> [f64; 2] {
    law.moduli().map(|modulus| IN_PLANE_STABILISATION * modulus)
}
