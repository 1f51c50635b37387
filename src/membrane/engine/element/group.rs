//! Elements of one law and kind behind one trait: where calls of the engine are dispatched to kernels.

use std::slice::Iter;

use super::block::Block;
use super::elements::{Common, Elements, place};
use super::kernel::{self, ElementDetail, ElementEnergy, ElementStrain, OwnForces};
use super::mean_state::MeanState;
use super::{heating, tearing};
use crate::engine::failure::Failures;
use crate::lane::{LANES, Width};
use crate::material::{History, MembraneLaw};

/// Elements of one kind with one law, as many as one thread takes at a time: one virtual call serves hundreds of
/// elements.
///
/// Positions and forces are those of the film's own nodes.
pub(crate) trait ElementGroup: Send + Sync {
    /// Copy of these elements with their history.
    fn boxed(&self) -> Box<dyn ElementGroup>;

    /// What they have whatever their law.
    fn common(&self) -> &Common;

    /// What they have whatever their law, mutable.
    fn common_mut(&mut self) -> &mut Common;

    /// Number of history variables.
    fn variables(&self) -> usize;

    /// Properties of the law.
    fn traits(&self) -> LawTraits;

    /// Adds the forces of the elements, whose nodes moved to `position` in `dt` (s), to `force`. Whether a fibre is
    /// past its break strain or a tear took energy.
    fn add_forces(&mut self, width: Width, position: &[&[f64]; 3], dt: f64, force: OwnForces<'_>) -> bool;

    /// Energies, J.
    fn energy(&self, width: Width, position: &[&[f64]; 3]) -> ElementEnergy;

    /// Bound on the squared angular frequency of any element of `density` (kg/m³), rad²/s² (theory.md, equation 17).
    fn frequency_bound(&self, width: Width, density: f64, position: &[&[f64]; 3]) -> f64;

    /// Adds mass to the elements of `density` (kg/m³) whose squared angular frequency is above `most` (rad²/s²), so that
    /// it is `most`; `add` is called with the nodes of each and the mass of each of them, kg (theory.md, equation 17d).
    fn add_mass(&mut self, density: f64, most: f64, position: &[&[f64]; 3], add: &mut dyn FnMut(&[u32], f64));

    /// Strains of the elements, in order, into `out`.
    fn strains(&self, width: Width, position: &[&[f64]; 3], out: &mut [ElementStrain]);

    /// Stress, thickness and fibres of the elements, in order.
    fn details(&self, position: &[&[f64]; 3]) -> Vec<ElementDetail>;

    /// Mean state of one element.
    fn mean_state(&self, element: usize, position: &[&[f64]; 3]) -> MeanState;

    /// Breaks the fibres that are past their break strain, and deletes what is torn.
    fn fail(&mut self, position: &[&[f64]; 3]) -> Failures;

    /// Whether one element is deleted.
    fn is_deleted(&self, element: usize) -> bool;

    /// Deletes one element.
    fn delete(&mut self, element: usize);

    /// Appends the history variables.
    fn save(&self, history: &mut Vec<f64>);

    /// Restores the history variables from the first of the `rest`.
    fn restore(&mut self, rest: &mut Iter<'_, f64>);

    /// Resets the history variables to those of virgin film; deleted elements stay deleted.
    fn reset(&mut self);
}

/// Properties of a law.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LawTraits {
    /// Whether it admits stretches up to a limit only.
    pub has_limit: bool,
    /// Whether it defines the thickness.
    pub has_thickness: bool,
    /// Whether it has a plastic strain.
    pub is_plastic: bool,
}

impl dyn ElementGroup + '_ {
    /// Whether one element is deleted or its tear is open.
    pub(crate) fn is_open(&self, element: usize) -> bool {
        let tearing = self.common().tearing.as_ref();
        self.is_deleted(element) || tearing.is_some_and(|tearing| tearing.is_open(place(element)))
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

    fn variables(&self) -> usize {
        self.common.count * Elements::variables(self)
    }

    #[cfg_attr(not(test), inline)]
    fn traits(&self) -> LawTraits {
        LawTraits {
            has_limit: self.law.has_limit(),
            has_thickness: self.law.has_thickness(),
            is_plastic: self.law.plastic_strain(&M::History::<LANES>::virgin()).is_some(),
        }
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
        Elements::frequency_bound(self, width, density, position)
    }

    #[cfg_attr(not(test), inline)]
    fn add_mass(&mut self, density: f64, most: f64, position: &[&[f64]; 3], add: &mut dyn FnMut(&[u32], f64)) {
        Elements::add_mass(self, [density, most], position, add);
    }

    fn strains(&self, width: Width, position: &[&[f64]; 3], out: &mut [ElementStrain]) {
        kernel::strains(width, self, position, out);
    }

    #[cfg_attr(not(test), inline)]
    fn details(&self, position: &[&[f64]; 3]) -> Vec<ElementDetail> {
        Elements::details(self, position)
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

    fn save(&self, history: &mut Vec<f64>) {
        Elements::save(self, history);
    }

    fn restore(&mut self, rest: &mut Iter<'_, f64>) {
        Elements::restore(self, rest);
    }

    fn reset(&mut self) {
        Elements::reset(self);
    }
}
