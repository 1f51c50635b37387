//! History variables of a film, saved and restored.

use serde::{Deserialize, Serialize};

use super::element::{Block, Blocks};
use crate::material::History;

/// History variables of the elements of one face, an entry an integration point: element by element, quads first,
/// whatever the chunks and blocks that hold the elements.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct FilmHistory {
    /// Of each element those of the law, as many a point as it has, then those of its Prony series, of its heat and of its
    /// tear.
    variables: Vec<f64>,
    /// Volume of stress-free film, m³; zero once the element is deleted.
    volume: Vec<f64>,
}

impl FilmHistory {
    /// Number of integration points.
    pub(super) fn points(&self) -> usize {
        self.volume.len()
    }

    /// Number of history variables, at all points.
    pub(super) fn variables(&self) -> usize {
        self.variables.len()
    }

    /// Appends the history variables of some elements.
    pub(super) fn save<B, const NODES: usize, const L: usize>(&mut self, elements: &Blocks<B, NODES, L>)
    where
        B: Block<NODES, L>,
    {
        for (block, lane) in elements.indices() {
            for (history, volume) in elements.blocks[block].history() {
                self.variables.extend(history.variables().map(|variable| variable[lane]));
                self.volume.push(volume[lane]);
            }
            let viscous =
                elements.viscous.iter().flat_map(|viscous| viscous.of_block(block).iter().map(|stored| &stored.0));
            let heating = elements.heating.iter().flat_map(|heating| heating.of_block(block));
            let tearing = elements.tearing.iter().flat_map(|tearing| tearing.of_block(block));
            self.variables.extend(viscous.chain(heating).chain(tearing).map(|variable| variable[lane]));
        }
    }

    /// Reads the variables from the first on.
    pub(super) fn reader(&self) -> Reader<'_> {
        Reader { variables: self.variables.iter(), volume: self.volume.iter() }
    }
}

/// A history while it is restored.
pub(super) struct Reader<'a> {
    variables: std::slice::Iter<'a, f64>,
    volume: std::slice::Iter<'a, f64>,
}

impl Reader<'_> {
    /// Restores the history variables of the next elements. The copies of the last element that pad its block have its
    /// variables.
    pub(super) fn restore<B, const NODES: usize, const L: usize>(&mut self, elements: &mut Blocks<B, NODES, L>)
    where
        B: Block<NODES, L>,
    {
        let last = elements.count - 1;
        for (number, (block, lane)) in elements.indices().enumerate() {
            let copies = lane + 1..if number == last { L } else { lane + 1 };
            for ((history, volume), saved) in elements.blocks[block].history_mut().zip(&mut self.volume) {
                volume[lane] = *saved;
                for (variable, saved) in history.variables_mut().zip(&mut self.variables) {
                    variable[lane] = *saved;
                    variable[copies.clone()].fill(*saved);
                }
            }
            let viscous = elements
                .viscous
                .iter_mut()
                .flat_map(|viscous| viscous.block_mut(block).1.iter_mut().map(|stored| &mut stored.0));
            let heating = elements.heating.iter_mut().flat_map(|heating| heating.of_block_mut(block));
            let tearing = elements.tearing.iter_mut().flat_map(|tearing| tearing.of_block_mut(block));
            for (variable, saved) in viscous.chain(heating).chain(tearing).zip(&mut self.variables) {
                variable[lane] = *saved;
                variable[copies.clone()].fill(*saved);
            }
        }
    }
}
