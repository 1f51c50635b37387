//! What the elements of a face remember of their past.

use serde::{Deserialize, Serialize};

use super::element::{Block, Blocks};

/// Memory of the elements of one face, an entry an integration point: element by element, quads first, whatever the
/// blocks in which they are worked on.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Memory {
    /// Largest strains so far of the MD fibres, the TD fibres and in shear.
    peaks: Vec<[f64; 3]>,
    /// Volume of stress-free film, m³; zero once broken.
    volume: Vec<f64>,
}

impl Memory {
    /// Number of integration points.
    pub(super) fn len(&self) -> usize {
        self.peaks.len().min(self.volume.len())
    }

    /// Largest strains and volume of every point, in order.
    pub(super) fn points(&self) -> impl Iterator<Item = ([f64; 3], f64)> + '_ {
        self.peaks.iter().copied().zip(self.volume.iter().copied())
    }

    /// Appends the memory of some elements.
    pub(super) fn note<B, const NODES: usize, const L: usize>(&mut self, elements: &Blocks<B, NODES, L>)
    where
        B: Block<NODES, L>,
    {
        for (block, lane) in elements.places() {
            for (peaks, volume) in elements.blocks[block].memory() {
                self.peaks.push(peaks.map(|peak| peak[lane]));
                self.volume.push(volume[lane]);
            }
        }
    }
}

/// Puts the memory of the next `points` back into elements. The copies of the last element that fill up its block go through
/// what it goes through.
pub(super) fn recall<B, const NODES: usize, const L: usize>(
    points: &mut impl Iterator<Item = ([f64; 3], f64)>,
    elements: &mut Blocks<B, NODES, L>,
) where
    B: Block<NODES, L>,
{
    let last = elements.count - 1;
    for (number, (block, lane)) in elements.places().enumerate() {
        let copies = lane + 1..if number == last { L } else { lane + 1 };
        for ((peaks, volume), (largest, held)) in elements.blocks[block].memory_mut().zip(&mut *points) {
            volume[lane] = held;
            for (peak, largest) in peaks.iter_mut().zip(largest) {
                peak[lane] = largest;
                peak[copies.clone()].fill(largest);
            }
        }
    }
}
