//! Elements side by side, in blocks of lanes: what passes over a film compute of them.

use super::kernel::{ElementEnergy, ElementStrain};
use super::viscous::{MovedBlock, ViscousBlock};
use crate::lane::{Lane, Lane3, splat};
use crate::material::{Deformation, Energy, History, MembraneLaw, Stiffness, Stresses, strains, stresses};

/// `L` elements of one kind with `NODES` nodes each, of film with the law `M`.
pub(crate) trait Block<M: MembraneLaw, const NODES: usize, const L: usize>: Clone + Send + Sync {
    /// One element, outside of a block.
    type Element;
    /// Integration points of an element.
    const POINTS: usize;
    /// Share of each point in a mean over an element.
    const SHARE: f64 = 1.0 / Self::POINTS as f64;

    /// A block of the element and thickness (m, all layers) that `lane` returns for each lane.
    fn new<'a>(lane: impl Fn(usize) -> (&'a Self::Element, f64)) -> Self
    where
        Self::Element: 'a;

    /// Forces on nodes that moved to `x` in `dt` (s), into `out` (theory.md, equations 2 and 14); updates the history
    /// variables, and those of `viscous` film. Whether a fibre is past its break strain.
    fn forces(
        &mut self,
        law: &M,
        viscous: Option<MovedBlock<'_, L>>,
        x: &[Lane3<L>; NODES],
        dt: f64,
        out: &mut [Lane3<L>; NODES],
    ) -> bool;

    /// Energies of the elements with nodes at `x`.
    fn energies(&self, law: &M, viscous: Option<ViscousBlock<'_, L>>, x: &[Lane3<L>; NODES]) -> ElementEnergy<Lane<L>>;

    /// Bound on density × squared angular frequency × volume / nodes, summed over the points (theory.md, equation 17).
    fn stiffness(&self, law: &M, viscous: Option<ViscousBlock<'_, L>>, x: &[Lane3<L>; NODES]) -> Lane<L>;

    /// Deformation at a point.
    fn deformation_at(&self, point: usize, x: &[Lane3<L>; NODES]) -> Deformation<L>;

    /// ∂N_a/∂X_I along MD and TD of the stress-free film, averaged over the points, 1/m.
    fn gradients(&self) -> [[Lane<L>; 2]; NODES];

    /// History variables and volume (m³; zero once it is deleted) of every integration point.
    fn history(&self) -> impl Iterator<Item = (&M::History<L>, &Lane<L>)>;

    /// History variables and volume (m³) of every integration point, mutable.
    fn history_mut(&mut self) -> impl Iterator<Item = (&mut M::History<L>, &mut Lane<L>)>;

    /// Deformation, averaged over the points.
    #[inline(always)]
    fn deformation(&self, x: &[Lane3<L>; NODES]) -> Deformation<L> {
        if Self::POINTS == 1 {
            return self.deformation_at(0, x);
        }
        let mut mean = Deformation::from([Lane3::ZERO; 2]);
        for point in 0..Self::POINTS {
            let d = self.deformation_at(point, x);
            for fibre in 0..2 {
                mean.stretch_variance[fibre] += Self::SHARE * d.stretch_variance[fibre];
                mean.f[fibre] += Self::SHARE * d.f[fibre];
            }
        }
        mean
    }

    /// Strains, averaged over the points, without the damage by tears.
    #[inline(always)]
    fn strains(&self, law: &M, x: &[Lane3<L>; NODES]) -> ElementStrain<Lane<L>> {
        let (zero, volume) = (splat(0.0), self.volume());
        let (strain, peak, left) = ([zero; 3], [zero; 2], [splat(1.0); 2]);
        let mut out = ElementStrain { strain, peak, left, volume, plastic: zero, damage: zero };
        for (point, (history, _)) in self.history().enumerate() {
            let s = strains(&self.deformation_at(point, x));
            for (mean, value) in out.strain.iter_mut().zip([s.md, s.td, s.shear]) {
                *mean += Self::SHARE * value;
            }
            for fibre in 0..2 {
                out.peak[fibre] = history.peak(fibre).max(out.peak[fibre]);
                out.left[fibre] = history.left(fibre).min(out.left[fibre]);
            }
            if let Some(plastic) = law.plastic_strain(history) {
                out.plastic += Self::SHARE * *plastic;
            }
        }
        out
    }

    /// Stresses, thickness and fibres, averaged over the points.
    fn details(&self, law: &M, viscous: Option<ViscousBlock<'_, L>>, x: &[Lane3<L>; NODES]) -> BlockDetails<L> {
        let zero = splat(0.0);
        let mut out = BlockDetails { stress: [zero; 3], thickness_ratio: zero, fibres: [Lane3::ZERO; 2] };
        for (point, (history, _)) in self.history().enumerate() {
            let d = self.deformation_at(point, x);
            let mut response = law.stress_of(&d, history);
            // Stress relaxes with a constant Poisson's ratio: the thickness is that of film strained at once.
            out.thickness_ratio += Self::SHARE * law.thickness_ratio(&d, &response);
            if let Some(viscous) = viscous {
                response = viscous.stress(point, &d);
            }
            let Stresses { md, td, shear } = stresses(&d, &response);
            for (mean, value) in out.stress.iter_mut().zip([md, td, shear]) {
                *mean += Self::SHARE * value;
            }
            for fibre in 0..2 {
                out.fibres[fibre] += Self::SHARE * d.f[fibre];
            }
        }
        out
    }

    /// Second Piola–Kirchhoff stresses S₁₁, S₂₂ and S₁₂ (Pa of one layer), averaged over the points.
    fn stress(&self, law: &M, viscous: Option<ViscousBlock<'_, L>>, x: &[Lane3<L>; NODES]) -> [Lane<L>; 3] {
        let mut out = [splat(0.0); 3];
        for (point, (history, _)) in self.history().enumerate() {
            let d = self.deformation_at(point, x);
            let stress = match viscous {
                Some(viscous) => viscous.stress(point, &d),
                None => law.stress_of(&d, history),
            };
            for (mean, value) in out.iter_mut().zip([stress.tension[0], stress.tension[1], stress.cross]) {
                *mean += Self::SHARE * value;
            }
        }
        out
    }

    /// Volume of stress-free film, m³; zero once it is deleted.
    #[inline(always)]
    fn volume(&self) -> Lane<L> {
        let mut total = splat(0.0);
        for (_, volume) in self.history() {
            total += *volume;
        }
        total
    }

    /// Deletes the element in a lane: its volume becomes zero.
    fn delete(&mut self, lane: usize) {
        self.history_mut().for_each(|(_, volume)| volume[lane] = 0.0);
    }

    /// Largest strain of a fibre set so far over that at which its fibres break, in the element in a lane: the largest
    /// of its points.
    fn break_ratio(&self, law: &M, lane: usize) -> f64 {
        let of_point = |(history, _): (&M::History<L>, &Lane<L>)| {
            let breaks = law.break_strains::<L>(history);
            [0, 1].map(|fibre| history.peak(fibre)[lane] / breaks[fibre][lane])
        };
        self.history().flat_map(of_point).fold(0.0, f64::max)
    }

    /// Share of the layers whose MD and TD fibres are not broken in the element in a lane, at its present largest
    /// strains: the least of its points.
    fn layers_left(&self, law: &M, lane: usize) -> [f64; 2] {
        let mut least = [1.0_f64; 2];
        for (history, _) in self.history() {
            let first = law.break_strains::<L>(history);
            for fibre in 0..2 {
                let (peak, limit) = (history.peak(fibre)[lane], first[fibre][lane]);
                let left = if peak > limit { law.share_left(peak / limit) } else { 1.0 };
                // The break strain may rise again with the rate; broken layers stay broken.
                least[fibre] = least[fibre].min(left).min(history.left(fibre)[lane]);
            }
        }
        least
    }
}

/// Stress, thickness and fibres of the elements of one block.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BlockDetails<const L: usize> {
    /// Nominal stresses along MD and TD and in shear, Pa of one layer.
    pub stress: [Lane<L>; 3],
    /// Thickness over that of stress-free film; NaN where the law does not define it.
    pub thickness_ratio: Lane<L>,
    /// f₁ and f₂: the images of unit vectors along MD and TD of the stress-free film.
    pub fibres: [Lane3<L>; 2],
}

/// Energy of the point numbered `point` with deformation `d` and `history`.
#[inline(always)]
pub(super) fn point_energy<M: MembraneLaw, const L: usize>(
    law: &M,
    viscous: Option<ViscousBlock<'_, L>>,
    point: usize,
    d: &Deformation<L>,
    history: &M::History<L>,
) -> Energy<L> {
    let energy = law.energy(d, history);
    match viscous {
        Some(viscous) => viscous.energy(point, d, &law.stress(d, &mut history.clone(), 0.0), &energy),
        None => energy,
    }
}

/// Bound on the stiffness of the point numbered `point` with deformation `d` and `history`.
#[inline(always)]
pub(super) fn point_stiffness<M: MembraneLaw, const L: usize>(
    law: &M,
    viscous: Option<ViscousBlock<'_, L>>,
    point: usize,
    d: &Deformation<L>,
    history: &M::History<L>,
) -> Stiffness<L> {
    let stiffness = law.stiffness(d, history);
    match viscous {
        Some(viscous) => viscous.stiffness(point, d, stiffness),
        None => stiffness,
    }
}

/// Whether a fibre set with layers left is strained beyond the break of the first.
#[inline(always)]
pub(super) fn is_beyond<M: MembraneLaw, const L: usize>(law: &M, history: &M::History<L>, volume: &Lane<L>) -> bool {
    let limits = law.break_strains::<L>(history);
    let md = history.peak(0).above(limits[0]) & history.left(0).above(0.0);
    let td = history.peak(1).above(limits[1]) & history.left(1).above(0.0);
    (volume.above(0.0) & (md | td)).any()
}
