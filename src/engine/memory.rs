//! What the elements of a face remember of their past.

use serde::{Deserialize, Serialize};

use super::element::Blocks;
use crate::lane::LANES;

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
    /// Integration points.
    pub(super) fn points(&self) -> usize {
        self.peaks.len().min(self.volume.len())
    }

    /// Appends the memory of `blocks`.
    pub(super) fn note<const NODES: usize, const POINTS: usize>(&mut self, blocks: &Blocks<NODES, POINTS>) {
        for (block, lane) in blocks.places() {
            for point in &blocks.points[block] {
                self.peaks.push(point.peaks.map(|peak| peak[lane]));
                self.volume.push(point.volume[lane]);
            }
        }
    }

    /// Puts the memory from entry `next` on back into `blocks` and moves `next` past it. The copies of the last element
    /// that fill up its block go through what it goes through.
    pub(super) fn recall<const NODES: usize, const POINTS: usize>(
        &self,
        next: &mut usize,
        blocks: &mut Blocks<NODES, POINTS>,
    ) {
        let count = blocks.count;
        for (block, lane) in blocks.places() {
            let last = block * LANES + lane + 1 == count;
            let same = if last { lane..LANES } else { lane..lane + 1 };
            for point in &mut blocks.points[block] {
                point.volume[lane] = self.volume[*next];
                for (peak, value) in point.peaks.iter_mut().zip(self.peaks[*next]) {
                    peak[same.clone()].fill(value);
                }
                *next += 1;
            }
        }
    }
}
