//! Passes over the blocks of a film, for the vector instructions that the processor has: gather → kernel → scatter.

use std::ops::Range;

use super::block::{Block, BlockDetails, BlockEnergies, BlockStrains, Blocks, Corners};
use super::energy::ElementEnergy;
use super::viscous::{ViscousBlock, ViscousPass};
use crate::engine::disjoint::Disjoint;
use crate::lane::{LANES, Lane, Lane3, Width, at_width, lanes, splat};
use crate::material::MembraneLaw;

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
    corners: &Corners<NODES, L>,
    position: &[&[f64]; 3],
    x: &mut [Lane3<L>; NODES],
) {
    // Structured meshes have their nodes in rows: one load of a vector instead of a gather.
    match corners {
        Corners::Row(first) => {
            for a in 0..NODES {
                for axis in 0..3 {
                    let from = &position[axis][first[a] as usize..][..L];
                    x[a][axis] = lanes(|l| from[l]);
                }
            }
        }
        Corners::Listed(rows) => {
            for a in 0..NODES {
                for l in 0..L {
                    let n = rows[a][l] as usize;
                    for axis in 0..3 {
                        x[a][axis][l] = position[axis][n];
                    }
                }
            }
        }
    }
}

/// Adds the forces on a block's nodes to those of the film.
#[inline(always)]
fn scatter<const NODES: usize, const L: usize>(
    corners: &Corners<NODES, L>,
    out: &[Lane3<L>; NODES],
    OwnForces(force): OwnForces<'_>,
) {
    match corners {
        Corners::Row(first) => {
            for a in 0..NODES {
                let first = first[a] as usize;
                for axis in 0..3 {
                    // SAFETY: no other thread accesses these nodes.
                    let to = unsafe { force[axis].range(first..first + L) };
                    for l in 0..L {
                        to[l] += out[a][axis][l];
                    }
                }
            }
        }
        Corners::Listed(rows) => {
            for a in 0..NODES {
                for l in 0..L {
                    for axis in 0..3 {
                        // SAFETY: as above.
                        unsafe { *force[axis].entry(rows[a][l] as usize) += out[a][axis][l] };
                    }
                }
            }
        }
    }
}

at_width! {
    /// Adds the forces of all elements, whose nodes moved to `position` in `dt` (s), to `force`, and updates their
    /// history variables. Whether a fibre is past its break strain, where film has no rupture criterion of its own.
    pub(crate) fn add_forces[B: Block<NODES, L>, M: MembraneLaw<History<L> = B::History>, const NODES: usize, const L: usize](
        elements: &mut Blocks<B, NODES, L>, law: &M, position: &[&[f64]; 3], dt: f64, force: OwnForces<'_>,
    ) -> bool = add_forces_lanewise
}

#[inline(always)]
fn add_forces_lanewise<
    B: Block<NODES, L>,
    M: MembraneLaw<History<L> = B::History>,
    const NODES: usize,
    const L: usize,
>(
    elements: &mut Blocks<B, NODES, L>,
    law: &M,
    position: &[&[f64]; 3],
    dt: f64,
    force: OwnForces<'_>,
) -> bool {
    let mut failed = false;
    let mut x = [[splat(0.0); 3]; NODES];
    let mut out = [[splat(0.0); 3]; NODES];
    // Known to the compiler, which leaves the viscous path out of laws that cannot have one.
    let mut viscous = match M::MEASURE {
        Some(_) => elements.viscous.as_mut().map(|viscous| viscous.pass(dt)),
        None => {
            assert!(elements.viscous.is_none(), "a Prony series on a law that cannot have one");
            None
        }
    };
    let (heating, tearing) = (elements.heating.as_ref(), elements.tearing.as_ref());
    for (b, (corners, block)) in elements.corners.iter().zip(&mut elements.blocks).enumerate() {
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

/// Multiplies the forces on a block's nodes by the `share` of each element.
#[inline(always)]
fn take_share<const NODES: usize, const L: usize>(out: &mut [Lane3<L>; NODES], share: &Lane<L>) {
    for force in out.iter_mut().flatten() {
        for l in 0..L {
            force[l] *= share[l];
        }
    }
}

at_width! {
    /// Energies of the elements of a block whose nodes are at `x`, J, without what heat and tears took. The laws are
    /// compiled into this one function for all who need it.
    pub(super) fn block_energies[B: Block<NODES, L>, M: MembraneLaw<History<L> = B::History>, const NODES: usize, const L: usize](
        block: &B, law: &M, viscous: Option<ViscousBlock<'_, L>>, x: &[Lane3<L>; NODES],
    ) -> BlockEnergies<L> = block_energies_lanewise, up to AVX2
}

#[inline(always)]
fn block_energies_lanewise<
    B: Block<NODES, L>,
    M: MembraneLaw<History<L> = B::History>,
    const NODES: usize,
    const L: usize,
>(
    block: &B,
    law: &M,
    viscous: Option<ViscousBlock<'_, L>>,
    x: &[Lane3<L>; NODES],
) -> BlockEnergies<L> {
    block.energies(law, viscous, x)
}

/// Energies of the elements of a block whose nodes are at `x`, J, with its heat and without what their tears took.
#[cfg_attr(not(test), inline)]
pub(super) fn warm_energies<
    B: Block<NODES, L>,
    M: MembraneLaw<History<L> = B::History>,
    const NODES: usize,
    const L: usize,
>(
    width: Width,
    elements: &Blocks<B, NODES, L>,
    block: usize,
    law: &M,
    x: &[Lane3<L>; NODES],
) -> BlockEnergies<L> {
    let of = &elements.blocks[block];
    let mut energies = block_energies(width, of, law, elements.viscous_block(block), x);
    if let Some(heating) = &elements.heating {
        let (share, absorbed, volume) = (heating.share(block), heating.absorbed(block), of.volume());
        for l in 0..L {
            energies.stored[l] *= share[l];
            energies.hourglass[l] *= share[l];
            energies.absorbed[l] = volume[l] * absorbed[l];
        }
    }
    energies
}

/// Energies of the elements of `blocks`, J, a lane each: those of the same lane are summed.
#[cfg_attr(not(test), inline)]
fn lane_energies<B: Block<NODES, L>, M: MembraneLaw<History<L> = B::History>, const NODES: usize, const L: usize>(
    width: Width,
    elements: &Blocks<B, NODES, L>,
    blocks: Range<usize>,
    law: &M,
    position: &[&[f64]; 3],
) -> BlockEnergies<L> {
    let mut x = [[splat(0.0); 3]; NODES];
    let mut sums = BlockEnergies::NONE;
    for b in blocks {
        gather(&elements.corners[b], position, &mut x);
        // Summed lane by lane and over the lanes at the end: one order for any number of threads and any width.
        let energies = warm_energies(width, elements, b, law, &x);
        let share = elements.tearing.as_ref().map_or(splat(1.0), |tearing| *tearing.share(b));
        for l in 0..L {
            sums.stored[l] += share[l] * energies.stored[l];
            sums.absorbed[l] += share[l] * energies.absorbed[l];
            sums.hourglass[l] += share[l] * energies.hourglass[l];
        }
    }
    sums
}

/// Counts the energy of viscous film that was just mounted as work done on it: it is mounted at once and rests then.
#[cfg_attr(not(test), inline)]
pub(crate) fn count_mounting<
    B: Block<NODES, L>,
    M: MembraneLaw<History<L> = B::History>,
    const NODES: usize,
    const L: usize,
>(
    width: Width,
    elements: &mut Blocks<B, NODES, L>,
    law: &M,
    position: &[&[f64]; 3],
) {
    let Blocks { corners, blocks, viscous: Some(viscous), .. } = elements else { return };
    let mut x = [[splat(0.0); 3]; NODES];
    for (b, (corners, block)) in corners.iter().zip(blocks).enumerate() {
        gather(corners, position, &mut x);
        let (energies, volume) = (block_energies(width, block, law, None, &x), block.volume());
        viscous.count_mounting(
            b,
            std::array::from_fn(|l| match volume[l] {
                // Padding and deleted elements: 0/0 would be a NaN in history variables that are saved.
                0.0 => 0.0,
                volume => (energies.stored[l] + energies.absorbed[l]) / volume,
            }),
        );
    }
}

/// Energies of all elements.
#[cfg_attr(not(test), inline)]
pub(crate) fn energy<
    B: Block<NODES, L>,
    M: MembraneLaw<History<L> = B::History>,
    const NODES: usize,
    const L: usize,
>(
    width: Width,
    elements: &Blocks<B, NODES, L>,
    law: &M,
    position: &[&[f64]; 3],
) -> ElementEnergy {
    let lanes = lane_energies(width, elements, 0..elements.blocks.len(), law, position);
    ElementEnergy {
        stored: lanes.stored.iter().sum(),
        absorbed: lanes.absorbed.iter().sum(),
        hourglass: lanes.hourglass.iter().sum(),
    }
}

/// Energies of the element at `block`, `lane`.
#[cfg_attr(not(test), inline)]
pub(crate) fn energy_at<
    B: Block<NODES, L>,
    M: MembraneLaw<History<L> = B::History>,
    const NODES: usize,
    const L: usize,
>(
    elements: &Blocks<B, NODES, L>,
    [block, lane]: [usize; 2],
    law: &M,
    position: &[&[f64]; 3],
) -> ElementEnergy {
    let lanes = lane_energies(Width::best(), elements, block..block + 1, law, position);
    ElementEnergy { stored: lanes.stored[lane], absorbed: lanes.absorbed[lane], hourglass: lanes.hourglass[lane] }
}

at_width! {
    /// Bound on the stiffness of the elements of a block whose nodes are at `x`, N/m. The laws are compiled into this
    /// one function for all who need it.
    fn block_stiffness[B: Block<NODES, L>, M: MembraneLaw<History<L> = B::History>, const NODES: usize, const L: usize](
        block: &B, law: &M, viscous: Option<ViscousBlock<'_, L>>, x: &[Lane3<L>; NODES],
    ) -> Lane<L> = block_stiffness_lanewise, up to AVX2
}

#[inline(always)]
fn block_stiffness_lanewise<
    B: Block<NODES, L>,
    M: MembraneLaw<History<L> = B::History>,
    const NODES: usize,
    const L: usize,
>(
    block: &B,
    law: &M,
    viscous: Option<ViscousBlock<'_, L>>,
    x: &[Lane3<L>; NODES],
) -> Lane<L> {
    block.stiffness(law, viscous, x)
}

/// Bound on the squared angular frequency of all elements, rad²/s² (theory.md, equation 17).
#[cfg_attr(not(test), inline)]
pub(crate) fn frequency_bound<
    B: Block<NODES, L>,
    M: MembraneLaw<History<L> = B::History>,
    const NODES: usize,
    const L: usize,
>(
    width: Width,
    elements: &Blocks<B, NODES, L>,
    law: &M,
    density: f64,
    position: &[&[f64]; 3],
) -> f64 {
    let mut x = [[splat(0.0); 3]; NODES];
    let mut largest = splat::<L>(0.0);
    for (b, (corners, block)) in elements.corners.iter().zip(&elements.blocks).enumerate() {
        gather(corners, position, &mut x);
        let bound = block_stiffness(width, block, law, elements.viscous_block(b), &x);
        let volume = block.volume();
        let factor = elements.mass_factors.get(b).copied().unwrap_or(splat(1.0));
        let share = elements.share(b);
        for l in 0..L {
            // theory.md, equation 17: lumped masses are equal, so the bound of the element is that of its stiffness
            // over one of them.
            let squared = share[l] * bound[l] * NODES as f64 / (density * factor[l] * volume[l]);
            // Deleted elements and the padding of the last block have no volume; a NaN must propagate.
            let settled = (volume[l] == 0.0) | (squared <= largest[l]) | largest[l].is_nan();
            largest[l] = if settled { largest[l] } else { squared };
        }
    }
    largest.into_iter().fold(0.0, |most, squared| if squared <= most || most.is_nan() { most } else { squared })
}

/// Adds mass to every element whose squared angular frequency is above `most` (rad²/s²), so that it is `most`, and
/// calls `add` with the nodes of each and the mass (kg) that each of these gets (theory.md, equation 17d).
#[cfg_attr(not(test), inline)]
pub(crate) fn add_mass<
    B: Block<NODES, L>,
    M: MembraneLaw<History<L> = B::History>,
    const NODES: usize,
    const L: usize,
>(
    elements: &mut Blocks<B, NODES, L>,
    law: &M,
    [density, most]: [f64; 2],
    position: &[&[f64]; 3],
    add: &mut dyn FnMut(&[u32], f64),
) {
    let mut x = [[splat(0.0); 3]; NODES];
    let mut factors = vec![splat(1.0); elements.blocks.len()];
    for (b, (corners, block)) in elements.corners.iter().zip(&elements.blocks).enumerate() {
        gather(corners, position, &mut x);
        let factors = &mut factors[b];
        let bound = block_stiffness(Width::best(), block, law, elements.viscous_block(b), &x);
        let volume = block.volume();
        for l in (0..L).filter(|l| volume[*l] > 0.0) {
            let own = density * volume[l] / NODES as f64;
            let factor = bound[l] / (own * most);
            if factor > 1.0 {
                // The factor is kept, not the bound: later bounds divide by it while the film's own stiffness changes.
                factors[l] = factor;
                add(&corners.in_lane(l), (factor - 1.0) * own);
            }
        }
    }
    elements.mass_factors = factors;
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

at_width! {
    /// Strains of all elements, in order.
    pub(crate) fn strains[B: Block<NODES, LANES>, const NODES: usize](
        elements: &Blocks<B, NODES>, position: &[&[f64]; 3], out: &mut [ElementStrain],
    ) = strains_lanewise, up to AVX2
}

#[inline(always)]
fn strains_lanewise<B: Block<NODES, LANES>, const NODES: usize>(
    elements: &Blocks<B, NODES>,
    position: &[&[f64]; 3],
    out: &mut [ElementStrain],
) {
    let mut x = [[splat(0.0); 3]; NODES];
    for ((corners, block), out) in elements.corners.iter().zip(&elements.blocks).zip(out.chunks_mut(LANES)) {
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

/// Details of all elements, in order; for snapshots alone, and so compiled for the baseline width only.
#[cfg_attr(not(test), inline)]
pub(crate) fn details<B: Block<NODES, LANES>, M: MembraneLaw<History<LANES> = B::History>, const NODES: usize>(
    elements: &Blocks<B, NODES>,
    law: &M,
    position: &[&[f64]; 3],
) -> Vec<ElementDetail> {
    let mut x = [[splat(0.0); 3]; NODES];
    let mut out = Vec::with_capacity(elements.count.next_multiple_of(LANES));
    for (b, (corners, block)) in elements.corners.iter().zip(&elements.blocks).enumerate() {
        gather(corners, position, &mut x);
        let details = block.details(law, elements.viscous_block(b), &x);
        let BlockDetails { stress, thickness_ratio, plastic_strain, fibres } = details;
        let (share, left) = (elements.share(b), elements.tearing.as_ref().map(|tearing| tearing.share(b)));
        out.extend((0..LANES).map(|l| ElementDetail {
            stress: stress.map(|s| share[l] * s[l]),
            damage: left.map_or(0.0, |left| 1.0 - left[l]),
            warming: elements.heating.as_ref().map_or(0.0, |heating| heating.warming(b, l)),
            thickness_ratio: thickness_ratio[l],
            plastic_strain: plastic_strain[l],
            fibres: fibres.map(|f| f.map(|axis| axis[l])),
        }));
    }
    out.truncate(elements.count);
    out
}
