//! Fully integrated elements: gradients of the shape functions at every integration point.

use super::block::{
    Block, BlockDetails, BlockEnergies, BlockStrains, add_deformation, add_stress, point_energy, point_stiffness,
};
use super::viscous::{MovedBlock, ViscousBlock};
use crate::lane::{Lane, Lane3, splat};
use crate::material::{Deformation, History, MembraneLaw, PeakStrains, strains};

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
        let mut f = [[splat(0.0); 3]; 2];
        for fibre in 0..2 {
            for axis in 0..3 {
                for a in 0..NODES {
                    for l in 0..L {
                        f[fibre][axis][l] += self.gradient[a][fibre][l] * x[a][axis][l];
                    }
                }
            }
        }
        Deformation::from(f)
    }

    /// Subtracts V Σ_I ∂N_a/∂X_I p_I from the forces (theory.md, equation 2).
    #[inline(always)]
    fn subtract_stress(&self, p: &[Lane3<L>; 2], out: &mut [Lane3<L>; NODES]) {
        for fibre in 0..2 {
            for axis in 0..3 {
                let mut vp = splat::<L>(0.0);
                for l in 0..L {
                    vp[l] = self.volume[l] * p[fibre][axis][l];
                }
                for a in 0..NODES {
                    for l in 0..L {
                        out[a][axis][l] -= self.gradient[a][fibre][l] * vp[l];
                    }
                }
            }
        }
    }

    /// Σ_a ∂N_a/∂X_I ∂N_a/∂X_J, 1/m².
    #[inline(always)]
    fn metric(&self) -> [[Lane<L>; 2]; 2] {
        let mut g = [[splat(0.0); 2]; 2];
        for (i, j) in [(0, 0), (0, 1), (1, 1)] {
            for a in 0..NODES {
                for l in 0..L {
                    g[i][j][l] += self.gradient[a][i][l] * self.gradient[a][j][l];
                }
            }
        }
        g
    }
}

impl<P: History<L>, const NODES: usize, const POINTS: usize, const L: usize> Block<NODES, L>
    for Gauss<NODES, POINTS, L, P>
{
    type Element = GaussElement<NODES, POINTS>;
    type History = P;

    fn new<'a>(lane: impl Fn(usize) -> (&'a Self::Element, f64)) -> Self {
        let point = |p: usize| Point {
            gradient: std::array::from_fn(|a| [0, 1].map(|i| std::array::from_fn(|l| lane(l).0.gradient[p][a][i]))),
            volume: std::array::from_fn(|l| lane(l).1 * lane(l).0.area[p]),
            history: P::virgin(),
        };
        Gauss { points: std::array::from_fn(point) }
    }

    #[inline(always)]
    fn forces<M>(
        &mut self,
        law: &M,
        mut viscous: Option<MovedBlock<'_, L>>,
        x: &[Lane3<L>; NODES],
        dt: f64,
        out: &mut [Lane3<L>; NODES],
    ) -> bool
    where
        M: MembraneLaw<History<L> = P>,
    {
        let mut beyond = false;
        *out = [[splat(0.0); 3]; NODES];
        for (p, point) in self.points.iter_mut().enumerate() {
            let d = point.deformation(x);
            let mut stress = law.stress(&d, &mut point.history, dt);
            if let (Some(measure), Some(viscous)) = (M::MEASURE, &mut viscous) {
                viscous.advance(measure, p, &d, &mut stress);
            }
            point.subtract_stress(&stress.p, out);
            beyond |= super::is_beyond(law, &point.history, &point.volume);
        }
        beyond
    }

    #[inline(always)]
    fn energies<M>(&self, law: &M, viscous: Option<ViscousBlock<'_, L>>, x: &[Lane3<L>; NODES]) -> BlockEnergies<L>
    where
        M: MembraneLaw<History<L> = P>,
    {
        let mut out = BlockEnergies::NONE;
        for (p, point) in self.points.iter().enumerate() {
            let energy = point_energy(law, viscous, p, &point.deformation(x), &point.history);
            for l in 0..L {
                out.stored[l] += point.volume[l] * energy.stored[l];
                out.absorbed[l] += point.volume[l] * energy.absorbed[l];
            }
        }
        out
    }

    #[inline(always)]
    fn stiffness<M>(&self, law: &M, viscous: Option<ViscousBlock<'_, L>>, x: &[Lane3<L>; NODES]) -> Lane<L>
    where
        M: MembraneLaw<History<L> = P>,
    {
        let mut bound = splat(0.0);
        for (p, point) in self.points.iter().enumerate() {
            let stiffness = point_stiffness(law, viscous, p, &point.deformation(x), &point.history);
            let eigenvalue = stiffness.eigenvalue_bound(&point.metric());
            for l in 0..L {
                bound[l] += point.volume[l] * eigenvalue[l];
            }
        }
        bound
    }

    #[inline(always)]
    fn strains(&self, x: &[Lane3<L>; NODES]) -> BlockStrains<L> {
        let mut out = BlockStrains { strain: [splat(0.0); 3], peak: [splat(0.0); 2], left: [splat(1.0); 2] };
        for point in &self.points {
            let s = strains(&point.deformation(x));
            for (mean, value) in out.strain.iter_mut().zip([s.md, s.td, s.shear]) {
                for l in 0..L {
                    mean[l] += value[l] / POINTS as f64;
                }
            }
            for fibre in 0..2 {
                for l in 0..L {
                    out.peak[fibre][l] = out.peak[fibre][l].max(point.history.peak(fibre)[l]);
                    out.left[fibre][l] = out.left[fibre][l].min(point.history.left(fibre)[l]);
                }
            }
        }
        out
    }

    fn details<M>(&self, law: &M, viscous: Option<ViscousBlock<'_, L>>, x: &[Lane3<L>; NODES]) -> BlockDetails<L>
    where
        M: MembraneLaw<History<L> = P>,
    {
        let mut out = BlockDetails::NONE;
        for (p, point) in self.points.iter().enumerate() {
            let viscous = viscous.map(|viscous| (viscous, p));
            out.add(law, &point.deformation(x), &point.history, viscous, 1.0 / POINTS as f64);
        }
        out
    }

    #[inline(always)]
    fn deformation(&self, x: &[Lane3<L>; NODES]) -> Deformation<L> {
        let mut out = Deformation::from([[splat(0.0); 3]; 2]);
        for point in &self.points {
            add_deformation(&mut out, &point.deformation(x), 1.0 / POINTS as f64);
        }
        out
    }

    fn stress<M>(&self, law: &M, viscous: Option<ViscousBlock<'_, L>>, x: &[Lane3<L>; NODES]) -> [Lane<L>; 3]
    where
        M: MembraneLaw<History<L> = P>,
    {
        let mut out = [splat(0.0); 3];
        for (p, point) in self.points.iter().enumerate() {
            let d = point.deformation(x);
            add_stress(&mut out, law, viscous, (p, &d, &point.history), 1.0 / POINTS as f64);
        }
        out
    }

    fn gradients(&self) -> [[Lane<L>; 2]; NODES] {
        let mean = |a: usize, i: usize, l: usize| {
            self.points.iter().map(|point| point.gradient[a][i][l]).sum::<f64>() / POINTS as f64
        };
        std::array::from_fn(|a| std::array::from_fn(|i| std::array::from_fn(|l| mean(a, i, l))))
    }

    #[inline(always)]
    fn volume(&self) -> Lane<L> {
        let mut volume = splat(0.0);
        for point in &self.points {
            for l in 0..L {
                volume[l] += point.volume[l];
            }
        }
        volume
    }

    fn layers_left<M: MembraneLaw<History<L> = P>>(&self, law: &M, lane: usize) -> [f64; 2] {
        let least = |[md, td]: [f64; 2], left: [f64; 2]| [md.min(left[0]), td.min(left[1])];
        self.points.iter().map(|point| super::layers_left(law, &point.history, lane)).fold([1.0; 2], least)
    }

    fn delete(&mut self, lane: usize) {
        self.points.iter_mut().for_each(|p| p.volume[lane] = 0.0);
    }

    fn history(&self) -> impl Iterator<Item = (&P, &Lane<L>)> {
        self.points.iter().map(|point| (&point.history, &point.volume))
    }

    fn history_mut(&mut self) -> impl Iterator<Item = (&mut P, &mut Lane<L>)> {
        self.points.iter_mut().map(|point| (&mut point.history, &mut point.volume))
    }
}
