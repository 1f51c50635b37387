//! Elements of one law and kind behind one trait: where calls of the engine are dispatched to kernels.

use std::ops::Range;
use std::slice::Iter;

use super::block::{Block, BlockDetails};
use super::elements::{Common, Elements, place};
use super::heating::{self, Heating};
use super::kernel::{self, ElementDetail, ElementEnergy, ElementStrain, OwnForces, block_stiffness};
use super::mean_state::MeanState;
use super::tearing::{self, Tearing};
use super::viscous::ViscousPoints;
use crate::engine::failure::Failures;
use crate::lane::{LANES, Lane, Width, splat};
use crate::material::{History, MembraneLaw, Stiffness};

/// Elements of one kind with one law, as many as one thread takes at a time: one virtual call serves hundreds of
/// elements.
pub(crate) trait ElementGroup: Send + Sync {
    /// Copy of these elements with their history.
    fn boxed(&self) -> Box<dyn ElementGroup>;

    /// What they have whatever their law.
    fn common(&self) -> &Common;

    /// What they have whatever their law, mutable.
    fn common_mut(&mut self) -> &mut Common;

    /// Adds the forces of the elements, whose nodes moved to `position` in `dt` (s), to `force`. Whether a fibre is
    /// past its break strain or a tear took energy.
    fn add_forces(&mut self, width: Width, position: &[&[f64]; 3], dt: f64, force: OwnForces<'_>) -> bool;

    /// Energies, J.
    fn energy(&self, width: Width, position: &[&[f64]; 3]) -> ElementEnergy;

    /// Bound on the squared angular frequency of any element of `density` (kg/m³), rad²/s² (theory.md, equation 17).
    fn frequency_bound(&self, width: Width, density: f64, position: &[&[f64]; 3]) -> f64;

    /// Squared angular frequency (rad²/s²) of the smallest element of `density` (kg/m³) with the largest slope of its law at
    /// small strains in any direction.
    fn largest_frequency(&self, density: f64) -> f64;

    /// Adds mass to the elements of `density` (kg/m³) whose squared angular frequency is above `most` (rad²/s²), so that
    /// it is `most`; `add` is called with the nodes of each and the mass of each of them, kg (theory.md, equation 17d).
    fn add_mass(&mut self, density: f64, most: f64, position: &[&[f64]; 3], add: &mut dyn FnMut(&[u32], f64));

    /// Strains of the elements, in order, into `out`.
    fn strains(&self, width: Width, position: &[&[f64]; 3], out: &mut [ElementStrain]);

    /// Stress, thickness and fibres of the elements, in order; for snapshots alone, and so compiled for the baseline width only.
    fn details(&self, position: &[&[f64]; 3]) -> Vec<ElementDetail>;

    /// Mean state of one element.
    fn mean_state(&self, element: usize, position: &[&[f64]; 3]) -> MeanState;

    /// Breaks the fibres that are past their break strain, and deletes what is torn.
    fn fail(&mut self, position: &[&[f64]; 3]) -> Failures;

    /// Whether one element is deleted.
    fn is_deleted(&self, element: usize) -> bool;

    /// Deletes one element.
    fn delete(&mut self, element: usize);

    /// Calls `visit` with each history variable of each element and its lane there, as a range with those of the copies of
    /// the last element that pad its block: the volume at each point (m³; zero once the element is deleted) with the
    /// variables of the law there, those of the Prony series at all points, of heat and of the tear.
    fn for_each_variable(&mut self, visit: &mut dyn FnMut(&mut Lane, Range<usize>));

    /// Resets the history variables to those of virgin film; deleted elements stay deleted.
    fn reset(&mut self);
}

impl dyn ElementGroup + '_ {
    /// Whether one element is deleted or its tear is open.
    pub(crate) fn is_open(&self, element: usize) -> bool {
        let tearing = self.common().tearing.as_ref();
        self.is_deleted(element) || tearing.is_some_and(|tearing| tearing.is_open(place(element)))
    }

    /// Appends the history variables.
    pub(crate) fn save(&self, to: &mut Vec<f64>) {
        self.boxed().for_each_variable(&mut |variable, lanes| to.push(variable[lanes.start]));
    }

    /// Restores the history variables from the first of the `rest`.
    pub(crate) fn restore(&mut self, rest: &mut Iter<'_, f64>) {
        self.for_each_variable(&mut |variable, lanes| {
            rest.next().into_iter().for_each(|saved| variable[lanes.clone()].fill(*saved));
        });
    }

    /// The elements, or the intact ones alone.
    pub(crate) fn elements(&self, intact: bool) -> impl Iterator<Item = usize> {
        (0..self.common().count).filter(move |element| !(intact && self.is_deleted(*element)))
    }
}

/// A law whose elements come in groups.
///
/// Implemented for every law and by no one else: the compiler places a method of a trait in the unit of its type, so that the
/// kernels of a law, which are `#[inline]`, are compiled together with it and with no other law.
pub(crate) trait Grouped: MembraneLaw + Sized {
    /// `elements` with this law.
    fn group<B, const NODES: usize>(elements: Elements<Self, B, NODES>) -> Box<dyn ElementGroup>
    where
        B: Block<Self, NODES, LANES> + 'static;
}

impl<M: MembraneLaw + Send + Sync + 'static> Grouped for M {
    fn group<B, const NODES: usize>(elements: Elements<Self, B, NODES>) -> Box<dyn ElementGroup>
    where
        B: Block<Self, NODES, LANES> + 'static,
    {
        Box::new(elements)
    }
}

impl<M, B, const NODES: usize> ElementGroup for Elements<M, B, NODES>
where
    M: MembraneLaw + Send + Sync + 'static,
    B: Block<M, NODES, LANES> + 'static,
{
    #[cfg_attr(not(test), inline)]
    fn boxed(&self) -> Box<dyn ElementGroup> {
        Box::new(self.clone())
    }

    fn common(&self) -> &Common {
        &self.common
    }

    fn common_mut(&mut self) -> &mut Common {
        &mut self.common
    }

    #[cfg_attr(not(test), inline)]
    fn add_forces(&mut self, width: Width, position: &[&[f64]; 3], dt: f64, force: OwnForces<'_>) -> bool {
        let mounts = self.viscous.as_ref().is_some_and(|viscous| viscous.mounts(dt));
        let failed = kernel::add_forces(width, self, position, dt, force);
        if mounts {
            self.count_mounting(width, position);
        }
        heating::warm_up(width, self, position, dt);
        failed | tearing::tear(width, self, position, dt)
    }

    #[cfg_attr(not(test), inline)]
    fn energy(&self, width: Width, position: &[&[f64]; 3]) -> ElementEnergy {
        self.energy_of(width, 0..self.blocks.len(), position, |lanes| lanes.iter().sum())
    }

    #[cfg_attr(not(test), inline)]
    fn frequency_bound(&self, width: Width, density: f64, position: &[&[f64]; 3]) -> f64 {
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

    #[cfg_attr(not(test), inline)]
    fn largest_frequency(&self, density: f64) -> f64 {
        let stiffness = Stiffness::in_any_direction(splat(self.law.early_modulus()));
        let of_block = |(b, block): (usize, &B)| {
            let gradients = block.gradients();
            let entry = |i: usize, j: usize| gradients.iter().fold(splat(0.0), |sum, of| sum + of[i] * of[j]);
            let factor = self.common.mass_factors.get(b).copied().unwrap_or(splat(1.0));
            let squared = stiffness.eigenvalue_bound(&[0, 1].map(|i| [0, 1].map(|j| entry(i, j)))) * NODES as f64
                / (density * factor);
            squared.into_iter().fold(0.0, f64::max)
        };
        self.blocks.iter().enumerate().map(of_block).fold(0.0, f64::max)
    }

    #[cfg_attr(not(test), inline)]
    fn add_mass(&mut self, density: f64, most: f64, position: &[&[f64]; 3], add: &mut dyn FnMut(&[u32], f64)) {
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

    fn strains(&self, width: Width, position: &[&[f64]; 3], out: &mut [ElementStrain]) {
        kernel::strains(width, self, position, out);
    }

    #[cfg_attr(not(test), inline)]
    fn details(&self, position: &[&[f64]; 3]) -> Vec<ElementDetail> {
        let mut out = Vec::with_capacity(self.common.count.next_multiple_of(LANES));
        for (b, block) in self.blocks.iter().enumerate() {
            let details = block.details(&self.law, self.viscous_block(b), &self.gather(b, position));
            let BlockDetails { stress, thickness_ratio, fibres } = details;
            let share = self.common.share(b);
            out.extend((0..LANES).map(|l| ElementDetail {
                stress: stress.map(|s| share[l] * s[l]),
                warming: self.common.heating.as_ref().map_or(0.0, |heating| heating.warming(b, l)),
                thickness_ratio: thickness_ratio[l],
                fibres: fibres.map(|f| f.map(|axis| axis[l])),
            }));
        }
        out.truncate(self.common.count);
        out
    }

    #[cfg_attr(not(test), inline)]
    fn mean_state(&self, element: usize, position: &[&[f64]; 3]) -> MeanState {
        Elements::mean_state(self, place(element), position)
    }

    #[cfg_attr(not(test), inline)]
    fn fail(&mut self, position: &[&[f64]; 3]) -> Failures {
        // With a criterion of its own film softens and is deleted by that alone; break strains of fibres have no effect.
        if self.common.tearing.is_some() { self.open_tears() } else { self.break_fibres(position) }
    }

    fn is_deleted(&self, element: usize) -> bool {
        Elements::is_deleted(self, place(element))
    }

    fn delete(&mut self, element: usize) {
        self.blocks[element / LANES].delete(element % LANES);
    }

    #[cfg_attr(not(test), inline)]
    fn for_each_variable(&mut self, visit: &mut dyn FnMut(&mut Lane, Range<usize>)) {
        let Common { count, heating, tearing, .. } = &mut self.common;
        for element in 0..*count {
            let [block, lane] = place(element);
            let lanes = lane..if element + 1 == *count { LANES } else { lane + 1 };
            for (history, volume) in self.blocks[block].history_mut() {
                visit(volume, lane..lane + 1);
                history.variables().for_each(|variable| visit(variable, lanes.clone()));
            }
            let viscous = self.viscous.iter_mut().flat_map(|viscous| viscous.block_mut(block).1);
            let heating = heating.iter_mut().flat_map(|heating| heating.of_block(block));
            let tearing = tearing.iter_mut().flat_map(|tearing| tearing.of_block(block));
            let beside = viscous.chain(heating).chain(tearing);
            beside.for_each(|variable| visit(variable, lanes.clone()));
        }
    }

    fn reset(&mut self) {
        for (history, _) in self.blocks.iter_mut().flat_map(B::history_mut) {
            *history = M::History::virgin();
        }
        self.viscous.iter_mut().for_each(ViscousPoints::reset);
        self.common.heating.iter_mut().for_each(Heating::reset);
        self.common.tearing.iter_mut().for_each(Tearing::reset);
    }
}
