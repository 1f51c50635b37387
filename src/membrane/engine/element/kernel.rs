//! Passes over the blocks of a film, for the vector instructions that the processor has: gather → kernel → scatter.

use std::ops::{AddAssign, Range, SubAssign};

use super::block::Block;
use super::elements::{BlockCorners, Elements};
use super::viscous::{ViscousBlock, ViscousPass};
use crate::engine::disjoint::Disjoint;
use crate::lane::{LANES, Lane, Lane3, Width, at_width, lanes, splat};
use crate::material::{Densities, MembraneLaw};

/// Energies of elements, J: of some together, or one a lane.
#[derive(Clone, Copy, Debug, Default)]
pub struct ElementEnergy<T = f64> {
    /// Returned on unloading.
    pub stored: T,
    /// Absorbed by the law.
    pub absorbed: T,
    /// In the stabilisation against hourglass modes.
    pub hourglass: T,
}

impl<T: Copy + AddAssign + SubAssign> ElementEnergy<T> {
    /// Adds those of other elements.
    #[inline(always)]
    pub fn add(&mut self, other: &ElementEnergy<T>) {
        self.stored += other.stored;
        self.absorbed += other.absorbed;
        self.hourglass += other.hourglass;
    }

    /// Subtracts those of other elements.
    pub fn subtract(&mut self, other: &ElementEnergy<T>) {
        self.stored -= other.stored;
        self.absorbed -= other.absorbed;
        self.hourglass -= other.hourglass;
    }
}

impl<const L: usize> ElementEnergy<Lane<L>> {
    /// Of the element in a lane for each of its `volume` (m³), J/m³: a tear, as softening, releases the energy of the
    /// stabilisation, too.
    #[inline(always)]
    pub(super) fn densities(&self, volume: &Lane<L>, lane: usize) -> Densities {
        // Padding and deleted elements: 0/0 would be a NaN in history variables that are saved.
        let density = |energy: f64| if volume[lane] > 0.0 { energy / volume[lane] } else { 0.0 };
        Densities { stored: density(self.stored[lane] + self.hourglass[lane]), absorbed: density(self.absorbed[lane]) }
    }
}

/// Strains of one element, or of one a lane, averaged over its integration points, and what they left of it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ElementStrain<T = f64> {
    /// Engineering strain along MD and TD, shear angle (rad).
    pub strain: [T; 3],
    /// Largest MD and TD strain so far.
    pub peak: [T; 2],
    /// Share of the layers whose MD and TD fibres are not broken; zero where it is deleted.
    pub left: [T; 2],
    /// Volume of stress-free film, m³; zero once it is deleted.
    pub volume: T,
    /// Equivalent plastic strain; zero of a law without.
    pub plastic: T,
    /// Share of its forces that the element lost by tearing.
    pub damage: T,
}

impl ElementStrain {
    /// Whether the MD or the TD fibres of all layers are broken.
    pub fn has_failed(&self) -> bool {
        self.left.contains(&0.0)
    }
}

/// Stress, thickness and fibres of one element, averaged over its integration points.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ElementDetail {
    /// Nominal stresses along MD and TD and in shear, Pa of one layer on its stress-free cross-section.
    pub stress: [f64; 3],
    /// Thickness over that of stress-free film; NaN where the law does not define it.
    pub thickness_ratio: f64,
    /// Growth of its temperature since it was mounted, K; zero of film that does not warm up.
    pub warming: f64,
    /// Images of unit vectors along MD and TD of the stress-free film.
    pub fibres: [[f64; 3]; 2],
}

/// Nodal forces that several threads add to, each to those of its own nodes.
pub(crate) struct Forces<'a>([Disjoint<'a, f64>; 3]);

/// Forces on nodes that one thread alone adds to.
#[derive(Clone, Copy)]
pub(crate) struct OwnForces<'a>(&'a [Disjoint<'a, f64>; 3]);

impl<'a> Forces<'a> {
    /// Forces to add to, an array an axis.
    pub(crate) fn new(axes: [&'a mut [f64]; 3]) -> Forces<'a> {
        Forces(axes.map(Disjoint::new))
    }

    /// The forces for one thread.
    ///
    /// # Safety
    /// While it is in use, no other thread may be at work on the nodes of the elements that it is used for.
    pub(crate) unsafe fn own(&self) -> OwnForces<'_> {
        OwnForces(&self.0)
    }
}

/// Positions of a block's nodes.
#[inline(always)]
pub(super) fn gather<const NODES: usize, const L: usize>(
    BlockCorners { nodes, is_row }: BlockCorners<'_, L>,
    position: &[&[f64]; 3],
    x: &mut [Lane3<L>; NODES],
) {
    // Structured meshes have their nodes in rows: one load of a vector instead of a gather.
    if is_row {
        for a in 0..NODES {
            for axis in 0..3 {
                let from = &position[axis][nodes[0][a] as usize..][..L];
                x[a][axis] = lanes(|l| from[l]);
            }
        }
    } else {
        for a in 0..NODES {
            for l in 0..L {
                let n = nodes[l][a] as usize;
                for axis in 0..3 {
                    x[a][axis][l] = position[axis][n];
                }
            }
        }
    }
}

/// Adds the forces on a block's nodes to those of the film.
#[inline(always)]
fn scatter<const NODES: usize, const L: usize>(
    BlockCorners { nodes, is_row }: BlockCorners<'_, L>,
    out: &[Lane3<L>; NODES],
    OwnForces(force): OwnForces<'_>,
) {
    if is_row {
        for a in 0..NODES {
            let first = nodes[0][a] as usize;
            for axis in 0..3 {
                // SAFETY: no other thread accesses these nodes.
                let to = unsafe { force[axis].range(first..first + L) };
                for l in 0..L {
                    to[l] += out[a][axis][l];
                }
            }
        }
    } else {
        for a in 0..NODES {
            for l in 0..L {
                for axis in 0..3 {
                    // SAFETY: as above.
                    unsafe { *force[axis].entry(nodes[l][a] as usize) += out[a][axis][l] };
                }
            }
        }
    }
}

/// Multiplies the forces on a block's nodes by the `share` of each element.
#[inline(always)]
fn take_share<const NODES: usize, const L: usize>(out: &mut [Lane3<L>; NODES], share: &Lane<L>) {
    for force in out {
        *force = *share * *force;
    }
}

at_width! {
    /// Adds the forces of all elements, whose nodes moved to `position` in `dt` (s), to `force`, and updates their
    /// history variables. Whether a fibre is past its break strain, where film has no rupture criterion of its own.
    pub(crate) fn add_forces[M: MembraneLaw, B: Block<M, NODES, L>, const NODES: usize, const L: usize](
        elements: &mut Elements<M, B, NODES, L>, position: &[&[f64]; 3], dt: f64, force: OwnForces<'_>,
    ) -> bool {
        let mut failed = false;
        let [mut x, mut out] = [[Lane3::ZERO; NODES]; 2];
        let Elements { law, blocks, viscous, common } = elements;
        // Known to the compiler, which leaves the viscous path out of laws that cannot have one.
        let mut viscous = match M::MEASURE {
            Some(_) => viscous.as_mut().map(|viscous| viscous.pass(dt)),
            None => {
                assert!(viscous.is_none(), "a Prony series on a law that cannot have one");
                None
            }
        };
        let (heating, tearing) = (common.heating.as_ref(), common.tearing.as_ref());
        for (b, (corners, block)) in common.corners.blocks().zip(blocks).enumerate() {
            gather(corners, position, &mut x);
            let viscous = viscous.as_mut().and_then(ViscousPass::next_block);
            // Gather, law, scatter one after another, each over all lanes: the law is the only part that a new one brings.
            let beyond = block.forces(law, viscous, &x, dt, &mut out);
            // Heat and tears take a share of the forces of the law, which with its history knows nothing of them.
            if let Some(heating) = heating {
                take_share(&mut out, heating.next(b));
            }
            match tearing {
                Some(tearing) => take_share(&mut out, tearing.next(b)),
                None => failed |= beyond,
            }
            scatter(corners, &out, force);
        }
        failed
    }
}

at_width! {
    up to AVX2
    /// Energies of the elements of a block whose nodes are at `x`, J, without what heat and tears took. The laws are
    /// compiled into this one function for all who need it.
    pub(super) fn block_energies[M: MembraneLaw, B: Block<M, NODES, L>, const NODES: usize, const L: usize](
        block: &B, law: &M, viscous: Option<ViscousBlock<'_, L>>, x: &[Lane3<L>; NODES],
    ) -> ElementEnergy<Lane<L>> {
        block.energies(law, viscous, x)
    }
}

at_width! {
    up to AVX2
    /// Bound on the stiffness of the elements of a block whose nodes are at `x`, N/m. The laws are compiled into this
    /// one function for all who need it.
    pub(super) fn block_stiffness[M: MembraneLaw, B: Block<M, NODES, L>, const NODES: usize, const L: usize](
        block: &B, law: &M, viscous: Option<ViscousBlock<'_, L>>, x: &[Lane3<L>; NODES],
    ) -> Lane<L> {
        block.stiffness(law, viscous, x)
    }
}

at_width! {
    up to AVX2
    /// Strains of all elements, in order.
    pub(super) fn strains[M: MembraneLaw, B: Block<M, NODES, LANES>, const NODES: usize](
        elements: &Elements<M, B, NODES>, position: &[&[f64]; 3], out: &mut [ElementStrain],
    ) {
        let mut x = [Lane3::ZERO; NODES];
        let blocks = elements.common.corners.blocks().zip(&elements.blocks);
        for (b, ((corners, block), out)) in blocks.zip(out.chunks_mut(LANES)).enumerate() {
            gather(corners, position, &mut x);
            let ElementStrain { strain, peak, left, volume, plastic, .. } = block.strains(&elements.law, &x);
            let whole = elements.common.tearing.as_ref().map_or(splat(1.0), |tearing| *tearing.share(b));
            for (l, out) in out.iter_mut().enumerate() {
                // A deleted element keeps the history that it had; that it is gone shows in its volume alone.
                let left = if volume[l] == 0.0 { [0.0; 2] } else { [left[0][l], left[1][l]] };
                let strain = [strain[0][l], strain[1][l], strain[2][l]];
                let (peak, damage) = ([peak[0][l], peak[1][l]], 1.0 - whole[l]);
                *out = ElementStrain { strain, peak, left, volume: volume[l], plastic: plastic[l], damage };
            }
        }
    }
}

impl<M: MembraneLaw, B: Block<M, NODES, LANES>, const NODES: usize> Elements<M, B, NODES> {
    /// Positions of the nodes of a block.
    #[inline(always)]
    pub(super) fn gather(&self, block: usize, position: &[&[f64]; 3]) -> [Lane3; NODES] {
        let mut x = [Lane3::ZERO; NODES];
        gather(self.common.corners.block(block), position, &mut x);
        x
    }

    /// Energies of the elements of a block whose nodes are at `x`, J, with its heat and without what their tears took.
    #[cfg_attr(not(test), inline)]
    pub(super) fn warm_energies(&self, width: Width, block: usize, x: &[Lane3; NODES]) -> ElementEnergy<Lane> {
        let mut energies = block_energies(width, &self.blocks[block], &*self.law, self.viscous_block(block), x);
        if let Some(heating) = &self.common.heating {
            let (share, absorbed, volume) =
                (heating.share(block), heating.absorbed(block), self.blocks[block].volume());
            energies.stored *= *share;
            energies.hourglass *= *share;
            energies.absorbed = volume * absorbed;
        }
        energies
    }

    /// Energies of the elements of `blocks`, J: `of_lanes` those of the same lane, which are summed.
    #[cfg_attr(not(test), inline)]
    pub(super) fn energy_of(
        &self,
        width: Width,
        blocks: Range<usize>,
        position: &[&[f64]; 3],
        of_lanes: impl Fn(Lane) -> f64,
    ) -> ElementEnergy {
        let mut sums = ElementEnergy::<Lane>::default();
        for b in blocks {
            // Summed lane by lane and over the lanes at the end: one order for any number of threads and any width.
            let energies = self.warm_energies(width, b, &self.gather(b, position));
            let share = self.common.tearing.as_ref().map_or(splat(1.0), |tearing| *tearing.share(b));
            sums.stored += share * energies.stored;
            sums.absorbed += share * energies.absorbed;
            sums.hourglass += share * energies.hourglass;
        }
        ElementEnergy {
            stored: of_lanes(sums.stored),
            absorbed: of_lanes(sums.absorbed),
            hourglass: of_lanes(sums.hourglass),
        }
    }

    /// Counts the energy of viscous film that was just mounted as work done on it: it is mounted at once and rests then.
    #[cfg_attr(not(test), inline)]
    pub(super) fn count_mounting(&mut self, width: Width, position: &[&[f64]; 3]) {
        let Elements { law, blocks, viscous: Some(viscous), common } = self else { return };
        let mut x = [Lane3::ZERO; NODES];
        for (b, (corners, block)) in common.corners.blocks().zip(blocks).enumerate() {
            gather(corners, position, &mut x);
            let energies = block_energies(width, block, &**law, None, &x);
            let volume = block.volume();
            // Padding and deleted elements: 0/0 would be a NaN in history variables that are saved.
            let density = (energies.stored + energies.absorbed) / volume;
            viscous.count_mounting(b, volume.equals(0.0).select(0.0, density));
        }
    }
}
