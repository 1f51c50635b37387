//! Elements of one law and kind behind one trait: where calls of the engine are dispatched to kernels.

use std::sync::Arc;

use super::element::{
    self, Block, Blocks, ElementDetail, ElementEnergy, ElementStrain, Heating, MeanState, OwnForces, Tearing, Torn,
    ViscousPoints,
};
use super::failure::{self, Failures};
use super::film_history::{FilmHistory, Reader};
use super::footprint;
use crate::lane::{LANES, Width};
use crate::material::{History, MembraneLaw, Rupture, Tear};

/// Elements of one kind with one law, as many as one thread takes at a time: one virtual call serves hundreds of
/// elements.
///
/// Positions and forces are those of the film's own nodes.
pub(super) trait ElementGroup: Send + Sync {
    /// Number of elements.
    fn len(&self) -> usize;

    /// Number of integration points.
    fn points(&self) -> usize;

    /// Number of history variables, at all integration points.
    fn variables(&self) -> usize;

    /// Bytes of its arrays.
    fn bytes(&self) -> usize;

    /// Whether the law admits stretches up to a limit only.
    fn has_limit(&self) -> bool;

    /// Whether the law defines the thickness.
    fn has_thickness(&self) -> bool;

    /// Whether the law has a plastic strain.
    fn is_plastic(&self) -> bool;

    /// Copy of these elements with their history.
    fn boxed(&self) -> Box<dyn ElementGroup>;

    /// Adds the forces of the elements, whose nodes moved to `position` in `dt` (s), to `force`. Whether a fibre is
    /// past its break strain or a tear took energy.
    fn add_forces(&mut self, width: Width, position: &[&[f64]; 3], dt: f64, force: OwnForces<'_>) -> bool;

    /// Energies, J.
    fn energy(&self, width: Width, position: &[&[f64]; 3]) -> ElementEnergy;

    /// Bound on the squared angular frequency of any element of `density` (kg/m³), rad²/s².
    fn frequency_bound(&self, width: Width, density: f64, position: &[&[f64]; 3]) -> f64;

    /// Adds mass to the elements of `density` (kg/m³) whose squared angular frequency is above `most` (rad²/s²); `add`
    /// is called with the nodes of each and the mass of each of them, kg.
    fn add_mass(&mut self, density: f64, most: f64, position: &[&[f64]; 3], add: &mut dyn FnMut(&[u32], f64));

    /// Strains of the elements, in order, into `out`.
    fn strains(&self, width: Width, position: &[&[f64]; 3], out: &mut [ElementStrain]);

    /// Stress, thickness and fibres of the elements, in order.
    fn details(&self, position: &[&[f64]; 3]) -> Vec<ElementDetail>;

    /// Breaks the fibres that are past their break strain, and deletes what is torn.
    fn fail(&mut self, position: &[&[f64]; 3]) -> Failures;

    /// Appends the history variables.
    fn save(&self, history: &mut FilmHistory);

    /// Restores the history variables.
    fn restore(&mut self, reader: &mut Reader<'_>);

    /// Resets the history variables to those of virgin film; deleted elements stay deleted.
    fn reset(&mut self);

    /// Whether the elements have a rupture criterion of their own.
    fn has_rupture(&self) -> bool;

    /// Whether they warm up by what they absorb.
    fn warms_up(&self) -> bool;

    /// Whether their tears take a fracture energy.
    fn takes_fracture_energy(&self) -> bool;

    /// Tears so far, in film of this thickness (m, all layers).
    fn torn(&self, thickness: f64) -> Torn;

    /// Calls `show` with the nodes of every element that is deleted or whose tear is open.
    fn for_each_open(&self, show: &mut dyn FnMut(&[u32]));

    /// Finds the elements at the tip of a tear: those with a node for which `is_open`.
    fn find_tips(&mut self, is_open: &dyn Fn(u32) -> bool);

    /// Mean state of one element.
    fn mean_state(&self, element: usize, position: &[&[f64]; 3]) -> MeanState;

    /// Tear of one element, and the volume of its stress-free film, also of one that is deleted, m³.
    ///
    /// # Panics
    /// Without a rupture criterion of their own.
    fn tear(&self, element: usize) -> (Tear, f64);

    /// Whether one element is deleted or its tear is open.
    fn is_open(&self, element: usize) -> bool;

    /// Starts the tear of one element, `width` (m) across it and `offset` (m) from the line of the tear.
    ///
    /// # Panics
    /// Without a rupture criterion of their own.
    fn start_tear(&mut self, element: usize, width: f64, offset: f64);

    /// Lets an element that tears go on from what it stores now.
    fn go_on(&mut self, element: usize);

    /// Their rupture criterion.
    fn rupture(&self) -> Option<Rupture>;

    /// Deletes the elements for whose nodes `wanted`. Their number.
    fn delete(&mut self, wanted: &dyn Fn(&[u32]) -> bool) -> usize;

    /// Calls `show` with the nodes of every element, counted from `first`; of intact ones alone or of all.
    fn for_each(&self, first: u32, intact: bool, show: &mut dyn FnMut(&[u32]));
}

/// Elements of one kind with the law `M`.
struct Group<M, B, const NODES: usize> {
    law: Arc<M>,
    elements: Blocks<B, NODES>,
}

/// A law whose elements come in groups.
///
/// Implemented for every law and by no one else: the compiler places a method of a trait in the unit of its type, so that the
/// kernels of a law, which are `#[inline]`, are compiled together with it and with no other law.
pub(super) trait Grouped: MembraneLaw + Sized {
    /// `elements` with this law.
    fn group<B, const NODES: usize>(law: Arc<Self>, elements: Blocks<B, NODES>) -> Box<dyn ElementGroup>
    where
        B: Block<NODES, LANES, History = Self::History<LANES>> + Clone + Send + Sync + 'static;
}

impl<M: MembraneLaw + Send + Sync + 'static> Grouped for M {
    fn group<B, const NODES: usize>(law: Arc<Self>, elements: Blocks<B, NODES>) -> Box<dyn ElementGroup>
    where
        B: Block<NODES, LANES, History = Self::History<LANES>> + Clone + Send + Sync + 'static,
    {
        Box::new(Group { law, elements })
    }
}

impl<M, B, const NODES: usize> ElementGroup for Group<M, B, NODES>
where
    M: MembraneLaw + Send + Sync + 'static,
    B: Block<NODES, LANES, History = M::History<LANES>> + Clone + Send + Sync + 'static,
{
    fn len(&self) -> usize {
        self.elements.count
    }

    fn points(&self) -> usize {
        self.elements.count * self.elements.points()
    }

    fn variables(&self) -> usize {
        self.elements.count * self.elements.variables()
    }

    fn bytes(&self) -> usize {
        footprint::blocks(&self.elements)
    }

    #[cfg_attr(not(test), inline)]
    fn has_limit(&self) -> bool {
        self.law.has_limit()
    }

    #[cfg_attr(not(test), inline)]
    fn has_thickness(&self) -> bool {
        self.law.has_thickness()
    }

    #[cfg_attr(not(test), inline)]
    fn is_plastic(&self) -> bool {
        self.law.plastic_strain(&M::History::<LANES>::virgin()).is_some()
    }

    #[cfg_attr(not(test), inline)]
    fn boxed(&self) -> Box<dyn ElementGroup> {
        Box::new(Group { law: Arc::clone(&self.law), elements: self.elements.clone() })
    }

    #[cfg_attr(not(test), inline)]
    fn add_forces(&mut self, width: Width, position: &[&[f64]; 3], dt: f64, force: OwnForces<'_>) -> bool {
        let mounts = self.elements.viscous.as_ref().is_some_and(|viscous| viscous.mounts(dt));
        let failed = element::add_forces(width, &mut self.elements, &*self.law, position, dt, force);
        if mounts {
            element::count_mounting(width, &mut self.elements, &*self.law, position);
        }
        element::warm_up(width, &mut self.elements, &*self.law, position, dt);
        failed | element::tear(width, &mut self.elements, &*self.law, position, dt)
    }

    #[cfg_attr(not(test), inline)]
    fn energy(&self, width: Width, position: &[&[f64]; 3]) -> ElementEnergy {
        element::energy(width, &self.elements, &*self.law, position)
    }

    #[cfg_attr(not(test), inline)]
    fn frequency_bound(&self, width: Width, density: f64, position: &[&[f64]; 3]) -> f64 {
        element::frequency_bound(width, &self.elements, &*self.law, density, position)
    }

    #[cfg_attr(not(test), inline)]
    fn add_mass(&mut self, density: f64, most: f64, position: &[&[f64]; 3], add: &mut dyn FnMut(&[u32], f64)) {
        element::add_mass(&mut self.elements, &*self.law, [density, most], position, add);
    }

    fn strains(&self, width: Width, position: &[&[f64]; 3], out: &mut [ElementStrain]) {
        element::strains(width, &self.elements, position, out);
    }

    #[cfg_attr(not(test), inline)]
    fn details(&self, position: &[&[f64]; 3]) -> Vec<ElementDetail> {
        element::details(&self.elements, &*self.law, position)
    }

    #[cfg_attr(not(test), inline)]
    fn fail(&mut self, position: &[&[f64]; 3]) -> Failures {
        failure::fail(&mut self.elements, &*self.law, position)
    }

    fn save(&self, history: &mut FilmHistory) {
        history.save(&self.elements);
    }

    fn restore(&mut self, reader: &mut Reader<'_>) {
        reader.restore(&mut self.elements);
    }

    fn reset(&mut self) {
        for (history, _) in self.elements.blocks.iter_mut().flat_map(B::history_mut) {
            *history = M::History::virgin();
        }
        self.elements.viscous.iter_mut().for_each(ViscousPoints::reset);
        self.elements.heating.iter_mut().for_each(Heating::reset);
        self.elements.tearing.iter_mut().for_each(Tearing::reset);
    }

    fn has_rupture(&self) -> bool {
        self.elements.tearing.is_some()
    }

    fn warms_up(&self) -> bool {
        self.elements.heating.is_some()
    }

    fn takes_fracture_energy(&self) -> bool {
        self.elements.tearing.as_ref().is_some_and(|tearing| tearing.rupture.fracture_energy > 0.0)
    }

    fn torn(&self, thickness: f64) -> Torn {
        let mut total = Torn::default();
        let Some(tearing) = &self.elements.tearing else { return total };
        for (block, lane) in self.elements.indices() {
            total.add(&tearing.torn([block, lane], thickness));
        }
        total
    }

    fn for_each_open(&self, show: &mut dyn FnMut(&[u32])) {
        for i in (0..self.elements.count).filter(|i| self.is_open(*i)) {
            show(&self.elements.corners[i / LANES].in_lane(i % LANES));
        }
    }

    fn find_tips(&mut self, is_open: &dyn Fn(u32) -> bool) {
        let Blocks { count, corners, tearing: Some(tearing), .. } = &mut self.elements else { return };
        for i in 0..*count {
            let (b, l) = (i / LANES, i % LANES);
            tearing.set_beside_open([b, l], corners[b].in_lane(l).into_iter().any(is_open));
        }
    }

    #[cfg_attr(not(test), inline)]
    fn mean_state(&self, element: usize, position: &[&[f64]; 3]) -> MeanState {
        element::mean_state(&self.elements, [element / LANES, element % LANES], &*self.law, position)
    }

    fn tear(&self, element: usize) -> (Tear, f64) {
        self.elements.tearing.as_ref().expect("a tear").of_element([element / LANES, element % LANES])
    }

    fn is_open(&self, element: usize) -> bool {
        let (b, l) = (element / LANES, element % LANES);
        self.elements.is_deleted(b, l) || self.elements.tearing.as_ref().is_some_and(|tearing| tearing.is_open(b, l))
    }

    fn start_tear(&mut self, element: usize, width: f64, offset: f64) {
        let tearing = self.elements.tearing.as_mut().expect("a tear");
        tearing.start([element / LANES, element % LANES], width, offset);
    }

    fn go_on(&mut self, element: usize) {
        let tearing = self.elements.tearing.as_mut().expect("a tear");
        tearing.go_on([element / LANES, element % LANES]);
    }

    fn rupture(&self) -> Option<Rupture> {
        self.elements.tearing.as_ref().map(|tearing| tearing.rupture)
    }

    fn delete(&mut self, wanted: &dyn Fn(&[u32]) -> bool) -> usize {
        let mut deleted = 0;
        for (b, l) in self.elements.indices() {
            if !self.elements.is_deleted(b, l) && wanted(&self.elements.corners[b].in_lane(l)) {
                self.elements.blocks[b].delete(l);
                deleted += 1;
            }
        }
        deleted
    }

    fn for_each(&self, first: u32, intact: bool, show: &mut dyn FnMut(&[u32])) {
        let Blocks { corners, .. } = &self.elements;
        for (b, l) in self.elements.indices().filter(|(b, l)| !(intact && self.elements.is_deleted(*b, *l))) {
            show(&corners[b].in_lane(l).map(|n| first + n));
        }
    }
}
