//! The bending stiffness of a film as a matrix over its nodes, in blocks of rows for vector instructions.

use std::ops::Range;

use crate::engine::disjoint::Disjoint;
use crate::engine::footprint::bytes;
use crate::lane::{LANES, Lane, Lane3, Stored, Width, at_width, splat};

/// An entry of a row: the film's own node, the signs by which its position is multiplied, the stiffness (N/m).
pub(super) type Entry = (u32, [f64; 3], f64);

/// Successive rows, one a lane.
#[derive(Clone, Debug)]
struct Block {
    /// Its first row.
    first: u32,
    near: Range<usize>,
    listed: Range<usize>,
}

/// Entries of the rows of a block whose columns follow each other as the rows do, so that they are loaded as one vector.
#[derive(Clone, Debug)]
struct Near {
    stiffness: Stored<LANES>,
    first: u32,
}

/// Entries of the rows of a block at any columns.
#[derive(Clone, Debug)]
struct Listed {
    stiffness: Stored<LANES>,
    nodes: [u32; LANES],
    signs: [f64; 3],
}

/// Rows of a matrix that has the same entries for all three axes but for the signs at mirror planes.
#[derive(Clone, Debug)]
pub(super) struct Rows {
    count: usize,
    blocks: Vec<Block>,
    near: Vec<Near>,
    listed: Vec<Listed>,
}

impl Rows {
    /// The matrix of these rows, whose entries ascend by their columns and have each column and signs once.
    pub(super) fn new(rows: &[Vec<Entry>]) -> Rows {
        let mut out = Rows { count: rows.len(), blocks: vec![], near: vec![], listed: vec![] };
        for (number, of_block) in rows.chunks(LANES).enumerate() {
            out.add(number * LANES, of_block);
        }
        out
    }

    fn add(&mut self, first: usize, rows: &[Vec<Entry>]) {
        let (near_from, listed_from) = (self.near.len(), self.listed.len());
        // Columns from their rows. Rows of a structured mesh have the same, where some have no entry too.
        let mut offsets: Vec<i64> = vec![];
        for (lane, row) in rows.iter().enumerate() {
            let plain = row.iter().filter(|(_, signs, _)| *signs == [1.0; 3]);
            offsets.extend(plain.map(|(node, ..)| i64::from(*node) - (first + lane) as i64));
        }
        offsets.sort_unstable();
        offsets.dedup();
        let longest = rows.iter().map(Vec::len).max().unwrap_or(0);
        let count = self.count as i64;
        let within = |offset: &i64| (0..=count - LANES as i64).contains(&(first as i64 + offset));
        let is_near = 2 * offsets.len() <= 3 * longest && offsets.iter().all(within) && rows.len() == LANES;
        if is_near {
            let near = |offset: &i64| Near { stiffness: Stored(splat(0.0)), first: (first as i64 + offset) as u32 };
            self.near.extend(offsets.iter().map(near));
        }
        // Of each signs, the rows side by side, entry by entry.
        let mut kinds: Vec<[f64; 3]> = rows.iter().flatten().map(|(_, signs, _)| *signs).collect();
        kinds.sort_by_key(|signs| signs.map(|sign| sign < 0.0));
        kinds.dedup();
        for signs in kinds.into_iter().filter(|signs| !is_near || *signs != [1.0; 3]) {
            let of_kind: Vec<Vec<u32>> = (0..LANES)
                .map(|lane| {
                    let row = rows.get(lane).map_or(&[][..], Vec::as_slice);
                    row.iter().filter(|(_, s, _)| *s == signs).map(|(node, ..)| *node).collect()
                })
                .collect();
            for place in 0..of_kind.iter().map(Vec::len).max().unwrap_or(0) {
                // Lanes without an entry repeat the first node of the block, with no stiffness.
                let nodes = std::array::from_fn(|l| of_kind[l].get(place).copied().unwrap_or(first as u32));
                self.listed.push(Listed { stiffness: Stored(splat(0.0)), nodes, signs });
            }
        }
        let block = Block {
            first: first as u32,
            near: near_from..self.near.len(),
            listed: listed_from..self.listed.len(),
        };
        self.blocks.push(block);
        self.fill(self.blocks.len() - 1, rows);
    }

    /// Replaces the stiffness of all entries of the block of this number by those of its `rows`, which have no others than
    /// when it was made.
    pub(super) fn fill(&mut self, block: usize, rows: &[Vec<Entry>]) {
        let Block { first, near, listed } = self.blocks[block].clone();
        for Near { stiffness, first: column } in &mut self.near[near.clone()] {
            stiffness.0 = splat(0.0);
            for (lane, row) in rows.iter().enumerate() {
                let node = *column + lane as u32;
                let found = row.iter().find(|(n, signs, _)| *n == node && *signs == [1.0; 3]);
                stiffness.0[lane] = found.map_or(0.0, |(.., value)| *value);
            }
        }
        let is_near = !near.is_empty();
        let mut used = vec![vec![]; rows.len()];
        for Listed { stiffness, nodes, signs } in &mut self.listed[listed] {
            stiffness.0 = splat(0.0);
            for (lane, row) in rows.iter().enumerate() {
                let found = row.iter().position(|(n, s, _)| *n == nodes[lane] && s == signs);
                // Lanes without an entry repeat a node that may have one elsewhere.
                let Some(found) = found.filter(|found| !used[lane].contains(found)) else { continue };
                if is_near && *signs == [1.0; 3] {
                    continue;
                }
                used[lane].push(found);
                stiffness.0[lane] = row[found].2;
            }
        }
        debug_assert!(first as usize + rows.len() <= self.count);
    }

    /// Number of blocks.
    pub(super) fn blocks(&self) -> usize {
        self.blocks.len()
    }

    /// The rows of the block of this number.
    pub(super) fn rows_of(&self, block: usize) -> Range<usize> {
        let first = self.blocks[block].first as usize;
        first..self.count.min(first + LANES)
    }

    /// Adds `beside` less the products of the rows of some blocks with the vectors `x` to `out`.
    ///
    /// # Safety
    /// No other thread may access these rows of `out`.
    pub(super) unsafe fn subtract(
        &self,
        width: Width,
        blocks: Range<usize>,
        x: &[&[f64]; 3],
        beside: &[&[f64]; 3],
        out: &[Disjoint<'_, f64>; 3],
    ) {
        let first = self.blocks.get(blocks.start).map_or(0, |block| block.first as usize);
        let rows = first..self.count.min(first + blocks.len() * LANES);
        // SAFETY: by the contract no other thread accesses these rows.
        let out = out.each_ref().map(|axis| unsafe { axis.range(rows.clone()) });
        subtract(width, self, blocks, x, beside, out);
    }

    /// Bytes of its arrays.
    pub(super) fn bytes(&self) -> usize {
        bytes(&self.blocks) + bytes(&self.near) + bytes(&self.listed)
    }
}

at_width! {
    fn subtract[](
        rows: &Rows, blocks: Range<usize>, x: &[&[f64]; 3], beside: &[&[f64]; 3], out: [&mut [f64]; 3],
    ) = subtract_lanewise
}

#[inline(always)]
fn subtract_lanewise(rows: &Rows, blocks: Range<usize>, x: &[&[f64]; 3], beside: &[&[f64]; 3], out: [&mut [f64]; 3]) {
    let begin = rows.blocks.get(blocks.start).map_or(0, |block| block.first as usize);
    for block in &rows.blocks[blocks] {
        let product = product(rows, block, x);
        let first = block.first as usize;
        let count = LANES.min(rows.count - first);
        for axis in 0..3 {
            let (to, beside) = (&mut out[axis][first - begin..][..count], &beside[axis][first..][..count]);
            if count == LANES {
                for l in 0..LANES {
                    to[l] += beside[l] - product[axis][l];
                }
            } else {
                for l in 0..count {
                    to[l] += beside[l] - product[axis][l];
                }
            }
        }
    }
}

/// The products of the rows of a block with the vectors `x`.
#[inline(always)]
fn product(rows: &Rows, block: &Block, x: &[&[f64]; 3]) -> Lane3 {
    let mut sums: Lane3 = [splat(0.0); 3];
    for Near { stiffness, first } in &rows.near[block.near.clone()] {
        for axis in 0..3 {
            let x = &x[axis][*first as usize..][..LANES];
            for l in 0..LANES {
                sums[axis][l] += stiffness.0[l] * x[l];
            }
        }
    }
    for Listed { stiffness, nodes, signs } in &rows.listed[block.listed.clone()] {
        for axis in 0..3 {
            let mut gathered: Lane = splat(0.0);
            for l in 0..LANES {
                gathered[l] = x[axis][nodes[l] as usize];
            }
            for l in 0..LANES {
                sums[axis][l] += (signs[axis] * stiffness.0[l]) * gathered[l];
            }
        }
    }
    sums
}
