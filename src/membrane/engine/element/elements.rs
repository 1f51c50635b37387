//! Elements of one kind and law, in blocks of lanes.

use std::sync::Arc;

use super::block::Block;
use super::heating::Heating;
use super::tearing::{Tearing, Torn};
use super::viscous::{ViscousBlock, ViscousPoints};
use crate::engine::failure::Failures;
use crate::lane::{LANES, Lane, Width, lanes, splat};
use crate::material::{History, MembraneLaw, Rupture, Thermal, ViscousLaw};

/// Elements of one kind with the law `M`, in order.
pub(crate) struct Elements<M, B, const NODES: usize, const L: usize = LANES> {
    pub(super) law: Arc<M>,
    /// Geometry and history of each block's elements; the last block is padded with copies of the last element without
    /// volume.
    pub(super) blocks: Vec<B>,
    /// The Prony series of viscous film.
    pub(super) viscous: Option<ViscousPoints<L>>,
    pub(super) common: Common<L>,
}

impl<M, B: Clone, const NODES: usize, const L: usize> Clone for Elements<M, B, NODES, L> {
    fn clone(&self) -> Self {
        let Elements { law, blocks, viscous, common } = self;
        let (blocks, viscous, common) = (blocks.clone(), viscous.clone(), common.clone());
        Elements { law: Arc::clone(law), blocks, viscous, common }
    }
}

/// What elements have whatever their law and kind.
#[derive(Clone, Debug)]
pub(crate) struct Common<const L: usize = LANES> {
    /// Number of elements.
    pub count: usize,
    pub corners: Corners,
    /// Mass of each block's elements over that of their film; empty where no mass was added.
    pub(super) mass_factors: Vec<Lane<L>>,
    /// Heat of film that warms up by what it absorbs.
    pub heating: Option<Heating<L>>,
    /// Tears of film with a rupture criterion of its own.
    pub tearing: Option<Tearing<L>>,
}

/// Block and lane of an element.
pub(crate) fn place(element: usize) -> [usize; 2] {
    [element / LANES, element % LANES]
}

/// Nodes of elements, in blocks.
#[derive(Clone, Debug)]
pub(crate) struct Corners {
    /// Of each element and of the copies that pad the last block; a triangle repeats its last.
    of_element: Vec<[u32; 4]>,
    /// Nodes of an element.
    nodes: usize,
    /// Whether the nodes of successive elements of a block are consecutive, as those of structured meshes are.
    is_row: Vec<bool>,
}

impl Corners {
    /// Those of elements in blocks of `lanes`.
    fn new<const NODES: usize>(elements: &[[u32; NODES]], lanes: usize) -> Corners {
        let padded = elements.iter().chain(elements.last().into_iter().cycle());
        let filled = |nodes: &[u32; NODES]| std::array::from_fn(|a| nodes[a.min(NODES - 1)]);
        let of_element: Vec<[u32; 4]> = padded.take(elements.len().next_multiple_of(lanes)).map(filled).collect();
        let is_row = |block: &[[u32; 4]]| {
            let mut numbered = block.iter().enumerate();
            numbered.all(|(l, nodes)| nodes.iter().zip(block[0]).all(|(node, first)| *node == first + l as u32))
        };
        let is_row = of_element.chunks(lanes).map(is_row).collect();
        Corners { of_element, nodes: NODES, is_row }
    }

    /// Nodes of an element.
    pub(crate) fn of(&self, element: usize) -> &[u32] {
        &self.of_element[element][..self.nodes]
    }

    /// Those of each block.
    #[inline(always)]
    pub(super) fn blocks<const L: usize>(&self) -> impl Iterator<Item = BlockCorners<'_, L>> {
        let (nodes, _) = self.of_element.as_chunks();
        nodes.iter().zip(&self.is_row).map(|(nodes, is_row)| BlockCorners { nodes, is_row: *is_row })
    }

    /// Those of one block.
    pub(super) fn block<const L: usize>(&self, block: usize) -> BlockCorners<'_, L> {
        BlockCorners { nodes: &self.of_element.as_chunks().0[block], is_row: self.is_row[block] }
    }
}

/// Nodes of the elements of a block.
#[derive(Clone, Copy)]
pub(super) struct BlockCorners<'a, const L: usize> {
    pub(super) nodes: &'a [[u32; 4]; L],
    /// Whether those of successive elements are consecutive.
    pub(super) is_row: bool,
}

impl<const L: usize> Common<L> {
    /// Share of the law's forces that the elements of a block had at the last position: what heat and tears left.
    #[inline(always)]
    pub(super) fn share(&self, block: usize) -> Lane<L> {
        let of_heat = self.heating.as_ref().map_or(splat(1.0), |heating| *heating.share(block));
        let of_tears = self.tearing.as_ref().map_or(splat(1.0), |tearing| *tearing.share(block));
        lanes(|l| of_heat[l] * of_tears[l])
    }

    /// Tears so far, in film of this thickness (m, all layers).
    pub(crate) fn torn(&self, thickness: f64) -> Torn {
        let mut total = Torn::default();
        if let Some(tearing) = &self.tearing {
            (0..self.count).for_each(|element| total.add(&tearing.torn([element / L, element % L], thickness)));
        }
        total
    }
}

impl<M: MembraneLaw, B: Block<M, NODES, L>, const NODES: usize, const L: usize> Elements<M, B, NODES, L> {
    /// Elements and their nodes, of a film `thickness` (m, all layers) thick.
    pub(crate) fn new(law: Arc<M>, nodes: &[[u32; NODES]], elements: &[B::Element], thickness: f64) -> Self {
        let count = nodes.len();
        let corners = Corners::new(nodes, L);
        let common = Common { count, corners, mass_factors: vec![], heating: None, tearing: None };
        let block = |first: usize| {
            // Padding repeats the last element without volume: all it computes is finite and multiplied by zero.
            B::new(|l| (&elements[(first + l).min(count - 1)], if first + l < count { thickness } else { 0.0 }))
        };
        Elements { law, blocks: (0..count).step_by(L).map(block).collect(), viscous: None, common }
    }

    /// Their law.
    pub(crate) fn law(&self) -> &M {
        &self.law
    }

    /// These elements, of viscous film.
    pub(crate) fn with_viscosity(self, law: ViscousLaw) -> Self {
        let viscous = ViscousPoints::new(law, self.blocks.len(), B::POINTS);
        Elements { viscous: Some(viscous), ..self }
    }

    /// These elements, of film that warms up by what it absorbs.
    pub(crate) fn with_heating(mut self, thermal: Thermal) -> Self {
        self.common.heating = Some(Heating::new(thermal, self.blocks.len()));
        self
    }

    /// These elements with a rupture criterion of their own.
    pub(crate) fn with_rupture(mut self, rupture: Rupture) -> Self {
        self.common.tearing = Some(Tearing::new(rupture, self.blocks.iter().map(B::volume).collect()));
        self
    }

    /// Viscous points of a block, where film is viscous.
    #[inline(always)]
    pub(super) fn viscous_block(&self, block: usize) -> Option<ViscousBlock<'_, L>> {
        self.viscous.as_ref().map(|viscous| viscous.block(block))
    }

    /// Block and lane of each element, in order.
    pub(super) fn indices(&self) -> impl Iterator<Item = [usize; 2]> + use<M, B, NODES, L> {
        (0..self.common.count).map(|i| [i / L, i % L])
    }

    /// Share of the layers whose MD and TD fibres are not broken in the element at a block and lane; none where it is
    /// deleted.
    pub(super) fn left(&self, [block, lane]: [usize; 2]) -> [f64; 2] {
        let mut points = self.blocks[block].history();
        let alive = points.next().filter(|(_, volume)| volume[lane] > 0.0);
        alive.map_or([0.0; 2], |(history, _)| [0, 1].map(|fibre| history.left(fibre)[lane]))
    }

    /// Whether the element at a block and lane is deleted.
    pub(super) fn is_deleted(&self, [block, lane]: [usize; 2]) -> bool {
        self.blocks[block].volume()[lane] == 0.0
    }
}

impl<M: MembraneLaw, B: Block<M, NODES, LANES>, const NODES: usize> Elements<M, B, NODES> {
    /// Breaks the fibres of every layer that is strained past its break strain: the share of layers left is multiplied into
    /// the stress of the fibre set. An element without MD and TD fibres is deleted: its volume and its forces become zero.
    /// Mass stays at the nodes.
    #[cfg_attr(not(test), inline)]
    pub(super) fn break_fibres(&mut self, position: &[&[f64]; 3]) -> Failures {
        let mut total = Failures::default();
        for at in self.indices() {
            let [block, lane] = at;
            if self.is_deleted(at) {
                continue;
            }
            let (before, left) = (self.left(at), self.blocks[block].layers_left(&self.law, lane));
            if left == before {
                continue;
            }
            let energy = |elements: &Self| elements.energy_of(Width::best(), block..block + 1, position, |of| of[lane]);
            // Before and after, with the law itself: what the difference is not stored any more went into rupture.
            let mut lost = energy(self);
            if left == [0.0; 2] {
                self.blocks[block].delete(lane);
            } else {
                for (history, _) in self.blocks[block].history_mut() {
                    for fibre in 0..2 {
                        history.left_mut(fibre)[lane] = left[fibre];
                    }
                }
                if let Some(viscous) = &mut self.viscous {
                    viscous.break_fibres(at, before, left);
                }
                self.restart_heat(at, position);
                lost.subtract(&energy(self));
            }
            let failed = (0..2).any(|fibre| before[fibre] > 0.0 && left[fibre] == 0.0);
            total.add(&Failures { broken: 1, failed: usize::from(failed), energy: lost, ..Failures::default() });
        }
        total
    }

    /// Deletes the elements whose tears have taken all of their forces.
    pub(super) fn open_tears(&mut self) -> Failures {
        let mut total = self.common.tearing.as_mut().map(Tearing::take_lost).unwrap_or_default();
        for at in self.indices() {
            let [block, lane] = at;
            let share = self.common.tearing.as_ref().map_or(1.0, |tearing| tearing.share(block)[lane]);
            if share == 0.0 && !self.is_deleted(at) {
                self.blocks[block].delete(lane);
                total.broken += 1;
                total.failed += 1;
            }
        }
        total
    }
}
