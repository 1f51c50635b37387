//! The four-node element with one integration point, and its hourglass mode.
//!
//! The mode ξη has the amplitude q = Σ γ_a x_a (theory.md, equations 11–14). Across the element f_I varies by q times
//! the mode's gradient, with mean square H_I |q|². It enters the law as [`Deformation::stretch_variance`], so tension
//! resists the mode as full integration would, from the same energy. Along the fibres a small stiffness κ_I is added, ½
//! κ_I H_I (f_I·q)², because strains that cancel in the mean do not change it.
//!
//! At the centre, gradients of opposite nodes are equal and opposite, so those of the first two nodes suffice:
//! with the diagonals d₀ = x₀ − x₂ and d₁ = x₁ − x₃,
//!
//! ```text
//! f_I = b₀I d₀ + b₁I d₁ ,   q = ¼(x₀ − x₁ + x₂ − x₃) − s₀ d₀ − s₁ d₁ ,   H_I = 8/3 (b₀I² + b₁I²) ,
//! b_aI = ∂N_a/∂X_I ,   s_a = ¼ Σ_I (h·X_I) b_aI
//! ```

use super::block::{Block, is_beyond, point_energy, point_stiffness};
use super::kernel::ElementEnergy;
use super::viscous::{MovedBlock, ViscousBlock};
use crate::lane::{Lane, Lane3, dot, lanes, splat};
use crate::material::{Deformation, History, MembraneLaw, PeakStrains, Stress};

/// Elements with one point each.
#[derive(Clone, Debug)]
pub(crate) struct OnePoint<const L: usize, P = PeakStrains<L>> {
    /// b_aI of the first two nodes, along MD and TD of the stress-free film, 1/m.
    gradient: [[Lane<L>; 2]; 2],
    /// s₀ and s₁; zero in a parallelogram.
    skew: [Lane<L>; 2],
    /// Whether one of the elements is not a parallelogram.
    skewed: bool,
    /// Volume of stress-free film (all layers), m³; zero once it is deleted.
    volume: Lane<L>,
    history: P,
}

/// One element.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OnePointElement {
    pub(super) gradient: [[f64; 2]; 2],
    pub(super) skew: [f64; 2],
    /// Area of stress-free film, m².
    pub(super) area: f64,
}

/// Hourglass stiffness along the fibres over the initial modulus.
const IN_PLANE_STABILISATION: f64 = 0.05;

/// Deformation and hourglass mode of a block.
struct Shape<const L: usize> {
    deformation: Deformation<L>,
    /// Amplitude q of the mode, m.
    q: Lane3<L>,
    /// H_I, 1/m².
    mean_square: [Lane<L>; 2],
}

impl<P: History<L>, const L: usize> OnePoint<L, P> {
    #[inline(always)]
    fn shape<const SKEWED: bool>(&self, x: &[Lane3<L>; 4]) -> Shape<L> {
        let [b0, b1] = self.gradient;
        // At the centre, gradients of opposite nodes are opposite: diagonals take the place of four nodes, with half of the
        // products.
        let (d0, d1) = (x[0] - x[2], x[1] - x[3]);
        let mut q = 0.25 * ((x[0] + x[2]) - (x[1] + x[3]));
        if SKEWED {
            q -= self.skew[0] * d0 + self.skew[1] * d1;
        }
        let f = [b0[0] * d0 + b1[0] * d1, b0[1] * d0 + b1[1] * d1];
        let squared = dot(&q, &q);
        // H_I of equation 13, whose ∂ξ/∂X are combinations of the gradients of the first two nodes.
        let mean_square =
            [(8.0 / 3.0) * (b0[0] * b0[0] + b1[0] * b1[0]), (8.0 / 3.0) * (b0[1] * b0[1] + b1[1] * b1[1])];
        let stretch_variance = [mean_square[0] * squared, mean_square[1] * squared];
        Shape { deformation: Deformation { f, stretch_variance }, q, mean_square }
    }

    /// Forces on the nodes by `stress` and the hourglass force `h`.
    #[inline(always)]
    fn scatter<const SKEWED: bool>(&self, stress: &Stress<L>, h: &Lane3<L>, out: &mut [Lane3<L>; 4]) {
        let [b0, b1] = self.gradient;
        let (vp, vq) = (self.volume * stress.p[0], self.volume * stress.p[1]);
        // Forces on opposite nodes differ in the sign of this part alone, so it is computed for two nodes, and momentum is
        // conserved.
        let mut first = b0[0] * vp + b0[1] * vq;
        let mut second = b1[0] * vp + b1[1] * vq;
        if SKEWED {
            first -= self.skew[0] * *h;
            second -= self.skew[1] * *h;
        }
        let quarter = 0.25 * *h;
        *out = [-first - quarter, quarter - second, first - quarter, quarter + second];
    }
}

impl<const L: usize> Shape<L> {
    /// h = V Σ_I H_I [ 2∂W/∂|f_I|² q + κ_I (f_I·q) f_I ], of which node a gets −γ_a h; adds the part of the
    /// stabilisation, which the share of layers `left` has, in ∂W/∂f_I, κ_I H_I (f_I·q) q, to the stress (theory.md,
    /// equation 14).
    #[inline(always)]
    fn hourglass_force(
        &self,
        volume: Lane<L>,
        stress: &mut Stress<L>,
        stabilisation: [f64; 2],
        left: [&Lane<L>; 2],
    ) -> Lane3<L> {
        let (f, q, square) = (self.deformation.f, self.q, self.mean_square);
        // Broken fibres stabilise nothing, as otherwise torn film would keep a stiffness against the hourglass mode.
        let s0 = dot(&f[0], &q) * (stabilisation[0] * square[0] * *left[0]);
        let s1 = dot(&f[1], &q) * (stabilisation[1] * square[1] * *left[1]);
        let tension = square[0] * stress.tension[0] + square[1] * stress.tension[1];
        // Second half of equation 14: the energy depends on f_I as well, and without this part it would not be conserved.
        stress.p[0] += s0 * q;
        stress.p[1] += s1 * q;
        volume * (tension * q + (s0 * f[0] + s1 * f[1]))
    }
}

/// Hourglass stiffness κ_I along the fibres, Pa.
#[inline(always)]
fn stabilisation(law: &impl MembraneLaw) -> [f64; 2] {
    let [md, td] = law.moduli();
    [IN_PLANE_STABILISATION * md, IN_PLANE_STABILISATION * td]
}

impl<M: MembraneLaw, const L: usize> Block<M, 4, L> for OnePoint<L, M::History<L>> {
    type Element = OnePointElement;
    const POINTS: usize = 1;

    fn new<'a>(lane: impl Fn(usize) -> (&'a OnePointElement, f64)) -> Self {
        let all = |value: &dyn Fn(&OnePointElement) -> f64| lanes(|l| value(lane(l).0));
        OnePoint {
            gradient: [0, 1].map(|a| [0, 1].map(|i| all(&|e| e.gradient[a][i]))),
            skew: [0, 1].map(|a| all(&|e| e.skew[a])),
            skewed: (0..L).any(|l| lane(l).0.skew != [0.0; 2]),
            volume: lanes(|l| lane(l).1 * lane(l).0.area),
            history: M::History::virgin(),
        }
    }

    #[inline(always)]
    fn forces(
        &mut self,
        law: &M,
        viscous: Option<MovedBlock<'_, L>>,
        x: &[Lane3<L>; 4],
        dt: f64,
        out: &mut [Lane3<L>; 4],
    ) -> bool {
        // Structured meshes are made of parallelograms, and theirs is the hot path. The law is compiled once for both.
        let shape = if self.skewed { self.shape::<true>(x) } else { self.shape::<false>(x) };
        let mut stress = law.stress(&shape.deformation, &mut self.history, dt);
        if let (Some(measure), Some(mut viscous)) = (M::MEASURE, viscous) {
            viscous.advance(measure, 0, &shape.deformation, &mut stress);
        }
        let left = [self.history.left(0), self.history.left(1)];
        let h = shape.hourglass_force(self.volume, &mut stress, stabilisation(law), left);
        if self.skewed {
            self.scatter::<true>(&stress, &h, out);
        } else {
            self.scatter::<false>(&stress, &h, out);
        }
        is_beyond(law, &self.history, &self.volume)
    }

    #[inline(always)]
    fn energies(&self, law: &M, viscous: Option<ViscousBlock<'_, L>>, x: &[Lane3<L>; 4]) -> ElementEnergy<Lane<L>> {
        let shape = self.shape::<true>(x);
        let energy = point_energy(law, viscous, 0, &shape.deformation, &self.history);
        let stabilisation = stabilisation(law);
        let f = &shape.deformation.f;
        let mut stabilising = splat(0.0);
        for i in 0..2 {
            let along = dot(&f[i], &shape.q);
            stabilising += 0.5 * stabilisation[i] * shape.mean_square[i] * along * along * *self.history.left(i);
        }
        ElementEnergy {
            stored: self.volume * energy.stored,
            absorbed: self.volume * energy.absorbed,
            hourglass: self.volume * stabilising,
        }
    }

    #[inline(always)]
    fn stiffness(&self, law: &M, viscous: Option<ViscousBlock<'_, L>>, x: &[Lane3<L>; 4]) -> Lane<L> {
        let shape = self.shape::<true>(x);
        let f = &shape.deformation.f;
        let [b0, b1] = self.gradient;
        let between = 2.0 * (b0[0] * b0[1] + b1[0] * b1[1]);
        let g = [[2.0 * (b0[0] * b0[0] + b1[0] * b1[0]), between], [between, 2.0 * (b0[1] * b0[1] + b1[1] * b1[1])]];
        // Σ γ_a² over the four nodes, from equation 11 with opposite gradients.
        let modes = 0.25 + 2.0 * (self.skew[0] * self.skew[0] + self.skew[1] * self.skew[1]);
        let mut bound = point_stiffness(law, viscous, 0, &shape.deformation, &self.history).eigenvalue_bound(&g);
        let stabilisation = stabilisation(law);
        let amplitude = dot(&shape.q, &shape.q);
        for i in 0..2 {
            // The two parts of the gradient of f_I·q, each doubled for the product of both.
            let moved = dot(&f[i], &f[i]) * modes + amplitude * g[i][i];
            bound += 2.0 * stabilisation[i] * shape.mean_square[i] * moved * *self.history.left(i);
        }
        bound * self.volume
    }

    #[inline(always)]
    fn deformation_at(&self, _point: usize, x: &[Lane3<L>; 4]) -> Deformation<L> {
        self.shape::<true>(x).deformation
    }

    fn gradients(&self) -> [[Lane<L>; 2]; 4] {
        let [first, second] = self.gradient;
        let opposite = |of: [Lane<L>; 2]| of.map(|b| -b);
        [first, second, opposite(first), opposite(second)]
    }

    fn history(&self) -> impl Iterator<Item = (&M::History<L>, &Lane<L>)> {
        std::iter::once((&self.history, &self.volume))
    }

    fn history_mut(&mut self) -> impl Iterator<Item = (&mut M::History<L>, &mut Lane<L>)> {
        std::iter::once((&mut self.history, &mut self.volume))
    }
}
