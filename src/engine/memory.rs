//! What the elements of a face remember of their past.

use serde::{Deserialize, Serialize};

use super::element::{Block, Blocks};
use crate::material::Past;

/// Memory of the elements of one face, an entry an integration point: element by element, quads first, whatever the
/// blocks in which they are worked on.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Memory {
    /// What the law remembers, as many numbers a point as it needs.
    past: Vec<f64>,
    /// Volume of stress-free film, m³; zero once it is deleted.
    volume: Vec<f64>,
}

impl Memory {
    /// Number of integration points.
    pub(super) fn len(&self) -> usize {
        self.volume.len()
    }

    /// Numbers that the law remembers of all points.
    pub(super) fn numbers(&self) -> usize {
        self.past.len()
    }

    /// All that is remembered, to be read in order.
    pub(super) fn reading(&self) -> Reading<'_> {
        Reading { past: self.past.iter(), volume: self.volume.iter() }
    }

    /// Appends the memory of some elements.
    pub(super) fn note<B, const NODES: usize, const L: usize>(&mut self, elements: &Blocks<B, NODES, L>)
    where
        B: Block<NODES, L>,
    {
        for (block, lane) in elements.places() {
            for (past, volume) in elements.blocks[block].memory() {
                self.past.extend(past.numbers().map(|numbers| numbers[lane]));
                self.volume.push(volume[lane]);
            }
        }
    }
}

/// A memory while it is put back.
pub(super) struct Reading<'a> {
    past: std::slice::Iter<'a, f64>,
    volume: std::slice::Iter<'a, f64>,
}

/// Puts the memory of the next points back into elements. The copies of the last element that fill up its block go through
/// what it goes through.
pub(super) fn recall<B, const NODES: usize, const L: usize>(
    reading: &mut Reading<'_>,
    elements: &mut Blocks<B, NODES, L>,
) where
    B: Block<NODES, L>,
{
    let last = elements.count - 1;
    for (number, (block, lane)) in elements.places().enumerate() {
        let copies = lane + 1..if number == last { L } else { lane + 1 };
        for ((past, volume), held) in elements.blocks[block].memory_mut().zip(&mut reading.volume) {
            volume[lane] = *held;
            for (numbers, remembered) in past.numbers_mut().zip(&mut reading.past) {
                numbers[lane] = *remembered;
                numbers[copies.clone()].fill(*remembered);
            }
        }
    }
}
