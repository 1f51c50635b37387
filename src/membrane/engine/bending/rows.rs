//! The bending stiffness of a film as a matrix over its nodes, in blocks of rows for vector instructions.

use std::ops::Range;

use crate::engine::disjoint::Disjoint;
use crate::engine::footprint::bytes;
use crate::lane::{LANES, Lane, Stored, Width, at_width, splat};

/// An entry of a row: its column and the stiffness (N/m) against motion along each axis, which differs where motion of an
/// image behind a mirror plane is in it.
pub(super) type Entry = (u32, [f64; 3]);

/// Columns that rows of one block may have together, over the most that any of them has.
const COMMON: f64 = 1.5;

/// Successive rows, one a lane.
#[derive(Clone, Debug)]
struct Block {
    /// Its first row.
    first: u32,
    /// Entries whose columns follow each other as the rows do, so that they are loaded as one vector: their place among
    /// all columns, and for each axis where the stiffness of the first of them is; axes that are alike share it.
    near: Range<usize>,
    stiffness: [usize; 3],
    /// Where the single entries of each of its rows begin, and where those of the last one end.
    single: [u32; LANES + 1],
    /// Whether its vectors reach over an end of the arrays.
    is_at_end: bool,
}

/// A matrix over the nodes of a film for each axis, by rows.
#[derive(Clone, Debug)]
pub(super) struct Rows {
    count: usize,
    blocks: Vec<Block>,
    /// First column of each vector, which may lie before all.
    near: Vec<i32>,
    stiffness: Vec<Stored<LANES>>,
    single: Vec<Entry>,
}

impl Rows {
    /// The matrix of these rows, whose entries ascend by their columns.
    pub(super) fn new(rows: &[Vec<Entry>]) -> Rows {
        let mut out = Rows { count: rows.len(), blocks: vec![], near: vec![], stiffness: vec![], single: vec![] };
        for (number, of_block) in rows.chunks(LANES).enumerate() {
            out.add(number * LANES, of_block);
        }
        out
    }

    fn add(&mut self, first: usize, rows: &[Vec<Entry>]) {
        // Columns from their rows. Rows of a structured mesh have the same, where some have no entry too.
        let mut offsets: Vec<i32> = vec![];
        for (lane, row) in rows.iter().enumerate() {
            offsets.extend(row.iter().map(|(node, _)| *node as i32 - (first + lane) as i32));
        }
        offsets.sort_unstable();
        offsets.dedup();
        let longest = rows.iter().map(Vec::len).max().unwrap_or(0);
        let is_near = offsets.len() as f64 <= COMMON * longest as f64 && rows.len() == LANES;
        let from = self.near.len();
        if is_near {
            self.near.extend(offsets.iter().map(|offset| first as i32 + offset));
        }
        let near = from..self.near.len();
        let is_beyond = |column: &i32| *column < 0 || *column as usize + LANES > self.count;
        let is_at_end = self.near[near.clone()].iter().any(is_beyond);
        let is_alike = |a: usize, b: usize| rows.iter().flatten().all(|(_, stiffness)| stiffness[a] == stiffness[b]);
        let mut stiffness = [self.stiffness.len(); 3];
        for axis in 0..3 {
            stiffness[axis] = (0..axis).find(|other| is_alike(*other, axis)).map_or_else(
                || {
                    let begin = self.stiffness.len();
                    self.stiffness.extend(near.clone().map(|_| Stored(splat(0.0))));
                    begin
                },
                |other| stiffness[other],
            );
        }
        let mut single = [self.single.len() as u32; LANES + 1];
        for lane in 0..LANES {
            let row = rows.get(lane).filter(|_| !is_near).map_or(&[][..], Vec::as_slice);
            self.single.extend_from_slice(row);
            single[lane + 1] = self.single.len() as u32;
        }
        self.blocks.push(Block { first: first as u32, near, stiffness, single, is_at_end });
        self.fill(self.blocks.len() - 1, rows);
    }

    /// Replaces the stiffness of all entries of the block of this number by those of its `rows`, which have no others than
    /// when it was made.
    pub(super) fn fill(&mut self, block: usize, rows: &[Vec<Entry>]) {
        let Block { near, stiffness, single, .. } = self.blocks[block].clone();
        let value = |lane: usize, node: i64| {
            let row = &rows[lane];
            row.binary_search_by_key(&node, |(n, _)| i64::from(*n)).map_or([0.0; 3], |place| row[place].1)
        };
        for (place, first) in self.near[near].iter().enumerate() {
            for lane in 0..LANES {
                let value = value(lane, i64::from(*first) + lane as i64);
                // Axes that share their entries are alike in film that tore, too: it has no other mirror planes.
                (0..3).for_each(|axis| self.stiffness[stiffness[axis] + place].0[lane] = value[axis]);
            }
        }
        for lane in 0..rows.len() {
            for (node, stiffness) in &mut self.single[single[lane] as usize..single[lane + 1] as usize] {
                *stiffness = value(lane, i64::from(*node));
            }
        }
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
        let Some(first) = self.blocks.get(blocks.start).map(|block| block.first as usize) else { return };
        let rows = first..self.count.min(first + blocks.len() * LANES);
        // SAFETY: by the contract no other thread accesses these rows.
        let mut out = out.each_ref().map(|axis| unsafe { axis.range(rows.clone()) });
        let mut from = blocks.start;
        for group in self.blocks[blocks].chunk_by(|a, b| a.is_at_end == b.is_at_end) {
            let of_group = from..from + group.len();
            from += group.len();
            if group[0].is_at_end {
                let (copies, begin) = self.copied(group, x);
                let near = copies.each_ref().map(Vec::as_slice);
                subtract(width, self, of_group, (&near, begin), (x, beside), (&mut out, first));
            } else {
                subtract(width, self, of_group, (x, 0), (x, beside), (&mut out, first));
            }
        }
    }

    /// A copy of the part of `x` that vectors of the blocks of a group reach, zero behind the ends, and its first column.
    fn copied(&self, group: &[Block], x: &[&[f64]; 3]) -> ([Vec<f64>; 3], i32) {
        let columns = group.iter().flat_map(|block| &self.near[block.near.clone()]);
        let (begin, end) = columns.fold((i32::MAX, i32::MIN), |(least, most), c| (least.min(*c), most.max(*c)));
        let end = end + LANES as i32;
        let known = begin.max(0) as usize..(end as usize).min(self.count);
        let copy = |axis: &[f64]| {
            let mut copy = vec![0.0; (end - begin) as usize];
            copy[(known.start as i32 - begin) as usize..][..known.len()].copy_from_slice(&axis[known.clone()]);
            copy
        };
        ([copy(x[0]), copy(x[1]), copy(x[2])], begin)
    }

    /// Bytes of its arrays.
    pub(super) fn bytes(&self) -> usize {
        bytes(&self.blocks) + bytes(&self.near) + bytes(&self.stiffness) + bytes(&self.single)
    }
}

at_width! {
    fn subtract[](
        rows: &Rows,
        blocks: Range<usize>,
        near: (&[&[f64]; 3], i32),
        arrays: (&[&[f64]; 3], &[&[f64]; 3]),
        out: (&mut [&mut [f64]; 3], usize),
    ) = subtract_lanewise
}

/// `arrays` has the vectors and what is beside them, `near` the vectors from a column on, `out` the rows from one on.
#[inline(always)]
fn subtract_lanewise(
    rows: &Rows,
    blocks: Range<usize>,
    (near, begin): (&[&[f64]; 3], i32),
    (x, beside): (&[&[f64]; 3], &[&[f64]; 3]),
    (out, row): (&mut [&mut [f64]; 3], usize),
) {
    for block in &rows.blocks[blocks] {
        let first = block.first as usize;
        let count = LANES.min(rows.count - first);
        if block.single[0] < block.single[LANES] {
            for lane in 0..count {
                let of_row = &rows.single[block.single[lane] as usize..block.single[lane + 1] as usize];
                let sum = row_product(of_row, x);
                for axis in 0..3 {
                    out[axis][first + lane - row] += beside[axis][first + lane] - sum[axis];
                }
            }
            continue;
        }
        if count < LANES {
            // The last rows, which have no entries.
            continue;
        }
        let columns = &rows.near[block.near.clone()];
        let (fours, rest) = columns.as_chunks::<4>();
        for axis in 0..3 {
            let x = |first: &i32| lane_of(near[axis], (first - begin) as usize);
            let (by_fours, by_rest) = rows.stiffness[block.stiffness[axis]..][..columns.len()].as_chunks::<4>();
            // Four sums that do not wait for each other.
            let mut sums: [Lane; 4] = [splat(0.0); 4];
            for (stiffness, first) in by_fours.iter().zip(fours) {
                for k in 0..4 {
                    let x = x(&first[k]);
                    for l in 0..LANES {
                        sums[k][l] += stiffness[k].0[l] * x[l];
                    }
                }
            }
            for (stiffness, first) in by_rest.iter().zip(rest) {
                let x = x(first);
                for l in 0..LANES {
                    sums[0][l] += stiffness.0[l] * x[l];
                }
            }
            let beside = lane_of(beside[axis], first);
            let to: &mut Lane = out[axis][first - row..].first_chunk_mut().expect("a whole lane");
            for l in 0..LANES {
                to[l] += beside[l] - ((sums[0][l] + sums[1][l]) + (sums[2][l] + sums[3][l]));
            }
        }
    }
}

/// Successive values from a place on.
#[inline(always)]
fn lane_of(values: &[f64], from: usize) -> &Lane {
    values[from..].first_chunk().expect("a whole lane")
}

/// The product of one row with the vectors `x`, in two sums that do not wait for each other.
#[inline(always)]
fn row_product(row: &[Entry], x: &[&[f64]; 3]) -> [f64; 3] {
    let mut sums = [[0.0; 3]; 2];
    let (pairs, last) = row.as_chunks::<2>();
    for pair in pairs {
        for (sums, (node, stiffness)) in sums.iter_mut().zip(pair) {
            for axis in 0..3 {
                sums[axis] += stiffness[axis] * x[axis][*node as usize];
            }
        }
    }
    for (node, stiffness) in last {
        for axis in 0..3 {
            sums[0][axis] += stiffness[axis] * x[axis][*node as usize];
        }
    }
    [0, 1, 2].map(|axis| sums[0][axis] + sums[1][axis])
}
