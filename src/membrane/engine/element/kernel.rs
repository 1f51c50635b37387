//! Passes over the blocks of a film, for the vector instructions that the processor has: gather → kernel → scatter.

use std::ops::Range;

use super::block::{Block, BlockDetails, BlockEnergies, BlockStrains};
use super::elements::{BlockCorners, Elements};
use super::viscous::{ViscousBlock, ViscousPass};
use crate::engine::disjoint::Disjoint;
use crate::lane::{LANES, Lane, Lane3, Width, at_width, lanes, splat};
use crate::material::MembraneLaw;

/// Energies of elements, J.
#[derive(Clone, Copy, Debug, Default)]
pub struct ElementEnergy {
    /// Returned on unloading.
    pub stored: f64,
    /// Absorbed by the law.
    pub absorbed: f64,
    /// In the stabilisation against hourglass modes.
    pub hourglass: f64,
}

impl ElementEnergy {
    /// Adds those of other elements.
    pub fn add(&mut self, other: &ElementEnergy) {
        self.stored += other.stored;
        self.absorbed += other.absorbed;
        self.hourglass += other.hourglass;
    }

    /// Subtracts those of other elements.
    pub fn subtract(&mut self, other: &ElementEnergy) {
        self.stored -= other.stored;
        self.absorbed -= other.absorbed;
        self.hourglass -= other.hourglass;
    }
}

/// Strains of one element, averaged over its integration points.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ElementStrain {
    /// Engineering strain along MD and TD, shear angle (rad).
    pub strain: [f64; 3],
    /// Largest MD and TD strain so far.
    pub peak: [f64; 2],
    /// Share of the layers whose MD and TD fibres are not broken; zero where it is deleted.
    pub left: [f64; 2],
    /// Volume of stress-free film, m³; zero once it is deleted.
    pub volume: f64,
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
    /// Equivalent plastic strain; zero of a law without.
    pub plastic_strain: f64,
    /// Share of its forces that the element lost by tearing.
    pub damage: f64,
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
    ) -> BlockEnergies<L> {
        block.energies(law, viscous, x)
    }
}

at_width! {
    up to AVX2
    /// Bound on the stiffness of the elements of a block whose nodes are at `x`, N/m. The laws are compiled into this
    /// one function for all who need it.
    fn block_stiffness[M: MembraneLaw, B: Block<M, NODES, L>, const NODES: usize, const L: usize](
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
        for ((corners, block), out) in blocks.zip(out.chunks_mut(LANES)) {
            gather(corners, position, &mut x);
            let BlockStrains { strain, peak, left } = block.strains(&x);
            let volume = block.volume();
            for (l, out) in out.iter_mut().enumerate() {
                // A deleted element keeps the history that it had; that it is gone shows in its volume alone.
                let left = if volume[l] == 0.0 { [0.0; 2] } else { [left[0][l], left[1][l]] };
                let strain = [strain[0][l], strain[1][l], strain[2][l]];
                *out = ElementStrain { strain, peak: [peak[0][l], peak[1][l]], left, volume: volume[l] };
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
    pub(super) fn warm_energies(&self, width: Width, block: usize, x: &[Lane3; NODES]) -> BlockEnergies<LANES> {
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
        let mut sums = BlockEnergies::NONE;
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

    /// Bound on the squared angular frequency of all elements, rad²/s² (theory.md, equation 17).
    #[cfg_attr(not(test), inline)]
    pub(super) fn frequency_bound(&self, width: Width, density: f64, position: &[&[f64]; 3]) -> f64 {
        let mut largest = splat::<LANES>(0.0);
        for (b, block) in self.blocks.iter().enumerate() {
            let bound = block_stiffness(width, block, &*self.law, self.viscous_block(b), &self.gather(b, position));
            let (volume, share) = (block.volume(), self.common.share(b));
            let factor = self.common.mass_factors.get(b).copied().unwrap_or(splat(1.0));
            // Lumped masses are equal, so the bound of the element is that of its stiffness over one of them.
            let squared = share * bound * NODES as f64 / (density * factor * volume);
            // Deleted elements and the padding of the last block have no volume; a NaN must propagate.
            let settled = volume.equals(0.0) | squared.at_most(largest) | largest.is_nan();
            largest = settled.select(largest, squared);
        }
        largest.iter().fold(0.0, |most, &squared| if squared <= most || most.is_nan() { most } else { squared })
    }

    /// Adds mass to every element whose squared angular frequency is above `most` (rad²/s²), so that it is `most`, and
    /// calls `add` with the nodes of each and the mass (kg) that each of these gets (theory.md, equation 17d).
    #[cfg_attr(not(test), inline)]
    pub(super) fn add_mass(
        &mut self,
        [density, most]: [f64; 2],
        position: &[&[f64]; 3],
        add: &mut dyn FnMut(&[u32], f64),
    ) {
        let mut factors = vec![splat(1.0); self.blocks.len()];
        for (b, block) in self.blocks.iter().enumerate() {
            let x = self.gather(b, position);
            let bound = block_stiffness(Width::best(), block, &*self.law, self.viscous_block(b), &x);
            let volume = block.volume();
            for l in (0..LANES).filter(|l| volume[*l] > 0.0) {
                let own = density * volume[l] / NODES as f64;
                let factor = bound[l] / (own * most);
                if factor > 1.0 {
                    // The factor is kept, not the bound: later bounds divide by it while the film's own stiffness changes.
                    factors[b][l] = factor;
                    add(self.common.corners.of(b * LANES + l), (factor - 1.0) * own);
                }
            }
        }
        self.common.mass_factors = factors;
    }

    /// Details of all elements, in order; for snapshots alone, and so compiled for the baseline width only.
    #[cfg_attr(not(test), inline)]
    pub(super) fn details(&self, position: &[&[f64]; 3]) -> Vec<ElementDetail> {
        let mut out = Vec::with_capacity(self.common.count.next_multiple_of(LANES));
        for (b, block) in self.blocks.iter().enumerate() {
            let details = block.details(&self.law, self.viscous_block(b), &self.gather(b, position));
            let BlockDetails { stress, thickness_ratio, plastic_strain, fibres } = details;
            let (share, left) = (self.common.share(b), self.common.tearing.as_ref().map(|tearing| tearing.share(b)));
            out.extend((0..LANES).map(|l| ElementDetail {
                stress: stress.map(|s| share[l] * s[l]),
                damage: left.map_or(0.0, |left| 1.0 - left[l]),
                warming: self.common.heating.as_ref().map_or(0.0, |heating| heating.warming(b, l)),
                thickness_ratio: thickness_ratio[l],
                plastic_strain: plastic_strain[l],
                fibres: fibres.map(|f| f.map(|axis| axis[l])),
            }));
        }
        out.truncate(self.common.count);
        out
    }
}
