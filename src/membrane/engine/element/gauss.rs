//! Fully integrated elements: gradients of the shape functions at every integration point.

use super::block::{Block, is_beyond, point_energy, point_stiffness};
use super::kernel::ElementEnergy;
use super::viscous::{MovedBlock, ViscousBlock};
use crate::lane::{Lane, Lane3, lanes, splat};
use crate::material::{Deformation, History, MembraneLaw, PeakStrains};

/// Elements with `NODES` nodes and `POINTS` integration points each.
#[derive(Clone, Debug)]
pub(crate) struct Gauss<const NODES: usize, const POINTS: usize, const L: usize, P = PeakStrains<L>> {
    points: [Point<P, NODES, L>; POINTS],
}

/// An integration point of the elements of a block.
#[derive(Clone, Debug)]
struct Point<P, const NODES: usize, const L: usize> {
    /// ∂N_a/∂X_I along MD and TD of the stress-free film, 1/m.
    gradient: [[Lane<L>; 2]; NODES],
    /// Volume of stress-free film (all layers), m³; zero once it is deleted.
    volume: Lane<L>,
    history: P,
}

/// One element.
#[derive(Clone, Copy, Debug)]
pub(crate) struct GaussElement<const NODES: usize, const POINTS: usize> {
    pub(super) gradient: [[[f64; 2]; NODES]; POINTS],
    /// Area of stress-free film at each point, m².
    pub(super) area: [f64; POINTS],
}

impl<P, const NODES: usize, const L: usize> Point<P, NODES, L> {
    /// f_I = Σ_a ∂N_a/∂X_I x_a (theory.md, equation 1).
    #[inline(always)]
    fn deformation(&self, x: &[Lane3<L>; NODES]) -> Deformation<L> {
        let mut f = [Lane3::ZERO; 2];
        for fibre in 0..2 {
            for a in 0..NODES {
                f[fibre] += self.gradient[a][fibre] * x[a];
            }
        }
        Deformation::from(f)
    }

    /// Subtracts V Σ_I ∂N_a/∂X_I p_I from the forces (theory.md, equation 2).
    #[inline(always)]
    fn subtract_stress(&self, p: &[Lane3<L>; 2], out: &mut [Lane3<L>; NODES]) {
        for fibre in 0..2 {
            let vp = self.volume * p[fibre];
            for a in 0..NODES {
                out[a] -= self.gradient[a][fibre] * vp;
            }
        }
    }

    /// Σ_a ∂N_a/∂X_I ∂N_a/∂X_J, 1/m².
    #[inline(always)]
    fn metric(&self) -> [[Lane<L>; 2]; 2] {
        let mut g = [[splat(0.0); 2]; 2];
        for (i, j) in [(0, 0), (0, 1), (1, 1)] {
            for b in &self.gradient {
                g[i][j] += b[i] * b[j];
            }
        }
        g
    }
}

impl<M: MembraneLaw, const NODES: usize, const POINTS: usize, const L: usize> Block<M, NODES, L>
    for Gauss<NODES, POINTS, L, M::History<L>>
{
    type Element = GaussElement<NODES, POINTS>;
    const POINTS: usize = POINTS;

    fn new<'a>(lane: impl Fn(usize) -> (&'a Self::Element, f64)) -> Self {
        let point = |p: usize| Point {
            gradient: std::array::from_fn(|a| [0, 1].map(|i| lanes(|l| lane(l).0.gradient[p][a][i]))),
            volume: lanes(|l| lane(l).1 * lane(l).0.area[p]),
            history: M::History::virgin(),
        };
        Gauss { points: std::array::from_fn(point) }
    }

    #[inline(always)]
    fn forces(
        &mut self,
        law: &M,
        mut viscous: Option<MovedBlock<'_, L>>,
        x: &[Lane3<L>; NODES],
        dt: f64,
        out: &mut [Lane3<L>; NODES],
    ) -> bool {
        let mut beyond = false;
        *out = [Lane3::ZERO; NODES];
        for (p, point) in self.points.iter_mut().enumerate() {
            let d = point.deformation(x);
            let mut stress = law.stress(&d, &mut point.history, dt);
            if let (Some(measure), Some(viscous)) = (M::MEASURE, &mut viscous) {
                viscous.advance(measure, p, &d, &mut stress);
            }
            point.subtract_stress(&stress.p, out);
            beyond |= is_beyond(law, &point.history, &point.volume);
        }
        beyond
    }

    #[inline(always)]
    fn energies(&self, law: &M, viscous: Option<ViscousBlock<'_, L>>, x: &[Lane3<L>; NODES]) -> ElementEnergy<Lane<L>> {
        let mut out: ElementEnergy<Lane<L>> = ElementEnergy::default();
        for (p, point) in self.points.iter().enumerate() {
            let energy = point_energy(law, viscous, p, &point.deformation(x), &point.history);
            out.stored += point.volume * energy.stored;
            out.absorbed += point.volume * energy.absorbed;
        }
        out
    }

    #[inline(always)]
    fn stiffness(&self, law: &M, viscous: Option<ViscousBlock<'_, L>>, x: &[Lane3<L>; NODES]) -> Lane<L> {
        let mut bound = splat(0.0);
        for (p, point) in self.points.iter().enumerate() {
            let stiffness = point_stiffness(law, viscous, p, &point.deformation(x), &point.history);
            bound += point.volume * stiffness.eigenvalue_bound(&point.metric());
        }
        bound
    }

    #[inline(always)]
    fn deformation_at(&self, point: usize, x: &[Lane3<L>; NODES]) -> Deformation<L> {
        self.points[point].deformation(x)
    }

    fn gradients(&self) -> [[Lane<L>; 2]; NODES] {
        let mean = |a: usize, i: usize| {
            lanes(|l| self.points.iter().map(|point| point.gradient[a][i][l]).sum::<f64>() / POINTS as f64)
        };
        std::array::from_fn(|a| [mean(a, 0), mean(a, 1)])
    }

    fn history(&self) -> impl Iterator<Item = (&M::History<L>, &Lane<L>)> {
        self.points.iter().map(|point| (&point.history, &point.volume))
    }

    fn history_mut(&mut self) -> impl Iterator<Item = (&mut M::History<L>, &mut Lane<L>)> {
        self.points.iter_mut().map(|point| (&mut point.history, &mut point.volume))
    }
}
