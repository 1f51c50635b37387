//! Tears of elements: their variables, beside the blocks, and the pass that compares elements with the limit of their rupture
//! and softens what tears (theory.md, section 25).

use serde::{Deserialize, Serialize};

use super::block::Block;
use super::elements::Elements;
use super::mean_state::{gradients_of, largest, width_across};
use crate::engine::failure::Failures;
use crate::lane::{LANES, Lane, Lane3, Width, at_width, lanes, splat};
use crate::material::{Criterion, MembraneLaw, Rupture, Tear};

/// Rupture of elements and its variables, block by block.
#[derive(Clone, Debug)]
pub(crate) struct Tearing<const L: usize> {
    pub rupture: Rupture,
    /// The variables of [`Tear`]; of blocks far from a tear the energies are those of the last step near one.
    variables: Vec<[Lane<L>; Tear::VARIABLES]>,
    /// Which elements share a node with one that is open or deleted.
    beside_open: Vec<[bool; L]>,
    /// Losses of the last pass.
    lost: Failures,
    /// Volume of stress-free film of each element, also of deleted ones, m³.
    volumes: Vec<Lane<L>>,
}

/// Share of the fracture energy by which an element may store more by round-off.
const ROUND_OFF: f64 = 1e-9;

/// An element that stores more energy than its tear takes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct TooWide {
    /// Its width across the tear, m.
    pub width: f64,
    /// Energy that it stored for each of its tear's area, over the fracture energy.
    pub ratio: f64,
}

impl TooWide {
    /// The one that stores most.
    pub(crate) fn worse(one: Option<TooWide>, other: Option<TooWide>) -> Option<TooWide> {
        match (one, other) {
            (Some(a), Some(b)) => Some(if b.ratio > a.ratio { b } else { a }),
            (a, b) => a.or(b),
        }
    }
}

/// Tears of elements so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Torn {
    /// Length of the tears in stress-free film, m.
    pub length: f64,
    /// Length × thickness of all layers, m².
    pub area: f64,
    /// Energy spent in the elements since they started to tear, J.
    pub energy: f64,
}

impl Torn {
    /// Adds the tears of other elements.
    pub fn add(&mut self, other: &Torn) {
        self.length += other.length;
        self.area += other.area;
        self.energy += other.energy;
    }
}

impl<const L: usize> Tearing<L> {
    /// Tears of film that is whole, in blocks with elements of these volumes (m³).
    pub(crate) fn new(rupture: Rupture, volumes: Vec<Lane<L>>) -> Tearing<L> {
        let variables = vec![Tear::NONE.variables().map(splat); volumes.len()];
        let beside_open = vec![[false; L]; volumes.len()];
        Tearing { rupture, variables, beside_open, lost: Failures::default(), volumes }
    }

    /// Resets the variables to those of film that does not tear.
    pub(crate) fn reset(&mut self) {
        self.variables.fill(Tear::NONE.variables().map(splat));
        self.lost = Failures::default();
    }

    /// Tear of the element at a block and lane.
    pub(crate) fn element_tear(&self, [block, lane]: [usize; 2]) -> Tear {
        Tear::of_variables(self.variables[block].each_ref().map(|variable| variable[lane]))
    }

    /// Stores the tear of the element at a block and lane.
    fn set(&mut self, [block, lane]: [usize; 2], tear: &Tear) {
        for (variable, value) in self.variables[block].iter_mut().zip(tear.variables()) {
            variable[lane] = value;
        }
    }

    /// Tear of the element at a block and lane, and the volume of its stress-free film, also of one that is deleted, m³.
    pub(crate) fn tear_and_volume(&self, [block, lane]: [usize; 2]) -> (Tear, f64) {
        (self.element_tear([block, lane]), self.volumes[block][lane])
    }

    /// Starts the tear of the element at a block and lane, `width` (m) across it and `offset` (m) from the line of the tear.
    pub(crate) fn start(&mut self, [block, lane]: [usize; 2], width: f64, offset: f64) {
        let mut tear = self.element_tear([block, lane]);
        tear.start(width);
        tear.offset = offset;
        self.note_start(&tear);
        tear.soften(self.rupture.fracture_energy);
        self.set([block, lane], &tear);
    }

    /// Notes that a tear started.
    fn note_start(&mut self, &Tear { start, width, .. }: &Tear) {
        // Above one the element stores more than its tear takes: the surplus is lost at once and depends on the mesh, which
        // is reported.
        let ratio = start * width / self.rupture.fracture_energy;
        // A step aside is as wide as what the element stores allows, so that it stores just as much.
        let too_wide = (ratio > 1.0 + ROUND_OFF && ratio.is_finite()).then_some(TooWide { width, ratio });
        self.lost.too_wide = TooWide::worse(self.lost.too_wide, too_wide);
    }

    /// Lets the element at a block and lane tear on from what it stores now.
    pub(crate) fn go_on(&mut self, [block, lane]: [usize; 2]) {
        let mut tear = self.element_tear([block, lane]);
        tear.go_on(self.rupture.fracture_energy);
        self.set([block, lane], &tear);
    }

    /// Share of the film's forces that the elements of a block have at their next position.
    #[inline(always)]
    pub(crate) fn next(&self, block: usize) -> &Lane<L> {
        let [_, next, ..] = &self.variables[block];
        next
    }

    /// Share of the film's forces that the elements of a block had at the last position.
    #[inline(always)]
    pub(crate) fn share(&self, block: usize) -> &Lane<L> {
        let [share, ..] = &self.variables[block];
        share
    }

    /// Variables of one block.
    pub(crate) fn of_block(&mut self, block: usize) -> &mut [Lane<L>] {
        &mut self.variables[block]
    }

    /// Whether so much of the element at a block and lane is torn that the elements around it are at the tip.
    pub(crate) fn is_open(&self, [block, lane]: [usize; 2]) -> bool {
        self.element_tear([block, lane]).is_open(self.rupture.fracture_energy)
    }

    /// Notes whether an element shares a node with one that is open or deleted.
    pub(crate) fn set_beside_open(&mut self, [block, lane]: [usize; 2], beside_open: bool) {
        self.beside_open[block][lane] = beside_open;
    }

    /// Whether no element of a block tears, is beside an open one, or reaches the limit with its one of `values`.
    #[inline(always)]
    fn stays_whole(&self, block: usize, values: &Lane<L>) -> bool {
        let [share, next, _, _, width, ..] = &self.variables[block];
        let is_far = !values.at_least(self.rupture.limit) | self.volumes[block].equals(0.0);
        let is_whole = width.equals(0.0) & share.equals(1.0) & next.equals(1.0);
        (is_far & is_whole).all() && !self.beside_open[block].contains(&true)
    }

    /// Losses of the last pass.
    pub(crate) fn take_lost(&mut self) -> Failures {
        std::mem::take(&mut self.lost)
    }

    /// The tear of the element at a block and lane, in film of this thickness (m, all layers).
    pub(crate) fn torn(&self, [block, lane]: [usize; 2], thickness: f64) -> Torn {
        let (tear, volume) = (self.element_tear([block, lane]), self.volumes[block][lane]);
        if !tear.has_started() {
            return Torn::default();
        }
        let area = tear.open(self.rupture.fracture_energy) * volume / tear.width;
        Torn { length: area / thickness, area, energy: tear.spent * volume }
    }
}

at_width! {
    up to AVX2
    /// Advances the tears of elements that moved to `position` in `dt` (s), after their forces. Whether energy was
    /// lost.
    pub(super) fn tear[M: MembraneLaw, B: Block<M, NODES, LANES>, const NODES: usize](
        elements: &mut Elements<M, B, NODES>, position: &[&[f64]; 3], dt: f64,
    ) -> bool {
        // Taken out, since tears are written while blocks and their viscous points are read.
        let Some(mut tearing) = elements.common.tearing.take() else { return false };
        let mut changed = false;
        let fracture_energy = tearing.rupture.fracture_energy;
        for b in 0..elements.blocks.len() {
            let (block, volume) = (&elements.blocks[b], elements.blocks[b].volume());
            let x = elements.gather(b, position);
            let metric = block.deformation(&x).metric();
            let values = elements.rupture_values(&tearing.rupture, b, &metric, &x);
            // Most blocks are far from a tear, and energies cost more than forces.
            if values.is_some_and(|values| tearing.stays_whole(b, &values)) {
                continue;
            }
            let strains = strains(&metric);
            let energies = elements.warm_energies(Width::best(), b, &x);
            for l in (0..LANES).filter(|l| volume[*l] > 0.0) {
                let mut tear = tearing.element_tear([b, l]);
                let had_started = tear.has_started();
                let was_open = tear.is_open(fracture_energy);
                let lost = tear.advance(energies.densities(&volume, l));
                tearing.lost.energy.stored += volume[l] * lost.stored;
                tearing.lost.energy.absorbed += volume[l] * lost.absorbed;
                if dt > 0.0 && !tear.has_started() {
                    let value = values.map_or(tear.stored + tear.absorbed, |values| values[l]);
                    let reaches = value >= tearing.rupture.limit;
                    // Film beside a tear may be compressed, which does not open it.
                    let may_grow = tearing.beside_open[b][l] && fracture_energy > 0.0 && strains[l] > 0.0;
                    if reaches || may_grow {
                        // Kept from now on: across the largest stretch at this moment, whatever the element does later.
                        let width = width_across(&gradients_of::<M, B, NODES>(block, l), metric.map(|c| c[l]));
                        // Film that stores more than its tear takes tears whatever the film around it does.
                        if reaches || tear.stored * width >= fracture_energy {
                            tear.start(width);
                            tearing.note_start(&tear);
                        }
                    }
                }
                tear.soften(fracture_energy);
                tearing.lost.opened |= !was_open && tear.is_open(fracture_energy);
                // Also while a share falls: stiffness and time step change with it.
                changed |= tear.has_started() != had_started || tear.share == 0.0 || tear.share != tear.next;
                changed |= lost.stored != 0.0 || lost.absorbed != 0.0;
                tearing.set([b, l], &tear);
            }
        }
        elements.common.tearing = Some(tearing);
        changed
    }
}

impl<M: MembraneLaw, B: Block<M, NODES, LANES>, const NODES: usize> Elements<M, B, NODES> {
    /// The quantity that the criterion compares with its limit, in each element of a block whose nodes are at `x`; none where
    /// it is an energy.
    #[inline(always)]
    fn rupture_values(&self, rupture: &Rupture, block: usize, metric: &[Lane; 3], x: &[Lane3; NODES]) -> Option<Lane> {
        let [c11, c22, _] = metric;
        Some(match rupture.criterion {
            Criterion::Strain => strains(metric),
            Criterion::FibreStrain => c11.max(*c22).sqrt() - 1.0,
            Criterion::Break => lanes(|l| self.blocks[block].break_ratio(&self.law, l)),
            Criterion::Stress => {
                // Without what tears took.
                let share = self.common.heating.as_ref().map_or(splat(1.0), |heating| *heating.share(block));
                let [s11, s22, s12] = self.blocks[block].stress(&self.law, self.viscous_block(block), x);
                largest(&squared_stress(&[s11 * share, s22 * share, s12 * share], metric)).sqrt()
            }
            Criterion::Energy => return None,
        })
    }
}

/// Largest principal nominal strain in each element of a block.
#[inline(always)]
fn strains<const L: usize>(metric: &[Lane<L>; 3]) -> Lane<L> {
    largest(metric).sqrt() - 1.0
}

/// S C S: its eigenvalues are the squares of the principal nominal stresses.
#[inline(always)]
fn squared_stress<const L: usize>(&[s11, s22, s12]: &[Lane<L>; 3], &[c11, c22, c12]: &[Lane<L>; 3]) -> [Lane<L>; 3] {
    let (a11, a12) = (s11 * c11 + s12 * c12, s11 * c12 + s12 * c22);
    let (a21, a22) = (s12 * c11 + s22 * c12, s12 * c12 + s22 * c22);
    [a11 * s11 + a12 * s12, a21 * s12 + a22 * s22, a11 * s12 + a12 * s22]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lane::one;

    #[test]
    fn principal_stress_of_a_stretch() {
        // S of a stretch λ along MD, with the engineering stress λ S.
        let (lambda, s) = (1.5, 3e6);
        let squared = squared_stress(&[s, 0.0, 0.0].map(one), &[lambda * lambda, 1.0, 0.0].map(one));
        assert!((largest(&squared)[0].sqrt() / (lambda * s) - 1.0).abs() < 1e-12);
    }
}
