//! Bending stiffness of a film: moments of curvatures that are fitted to the nodes around each node (theory.md, section 30).

mod curvature;
mod fit;
mod outline;
mod plate;
mod rows;

use thiserror::Error;

use super::disjoint::Disjoint;
use super::footprint::bytes;
use super::mesh::Mesh;
use super::nodes::{Nodes, Vectors};
use super::section::Section;
use crate::lane::Width;
use curvature::{Curvature, Mounted};
use outline::{Outline, Reach};
use plate::Plate;
use rows::{Entry, Rows};

/// Height over the extent of a film below which it is flat.
const FLAT: f64 = 1e-9;

/// Blocks of rows that one thread takes at a time.
const BLOCKS: usize = 32;

/// Film that is to bend has no plane.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[error("film bends from a plane, and its nodes lie up to {} mm beside one", 1e3 * height)]
pub struct NotFlat {
    /// Difference of the heights of its nodes, m.
    pub height: f64,
}

/// The bending stiffness of one face of film. Its energy is ½ (x − X)·K (x − X) with the mounted positions X: quadratic
/// in the positions, zero in every linear map of the flat film, and without change under rotations.
#[derive(Clone)]
pub(super) struct Bending {
    rows: Rows,
    /// X, m.
    mounted: Vectors,
    /// K X, N.
    beside: Vectors,
    /// Bound on the squared angular frequency, rad²/s².
    squared_frequency: f64,
    curvatures: Vec<Curvature>,
    /// Whether each of them still is in film that is whole.
    is_whole: Vec<bool>,
    /// Curvatures with each node, by number and place in it.
    at_nodes: Vec<Vec<(u32, u32)>>,
    /// The film's own node of each node of the curvatures, and the signs of its position.
    source: Vec<(u32, [f64; 3])>,
    /// Share of each node in the computed part: less than one on a mirror plane.
    shares: Vec<f64>,
    /// Elements of whole film.
    elements: Vec<Vec<u32>>,
}

impl Bending {
    /// That of film whose `elements` were mounted from `mesh` with `section`, on `nodes` from the `first` on, of so many
    /// `layers` that slide on each other without friction; built in at the edges `built_in`, each two nodes of the mesh.
    ///
    /// # Errors
    /// [`NotFlat`] where the film was not mounted in a plane of constant height.
    pub(super) fn new(
        elements: Vec<Vec<u32>>,
        (nodes, first): (&Nodes, usize),
        (mesh, section): (&Mesh, &Section),
        layers: u32,
        built_in: &[[u32; 2]],
    ) -> Result<Bending, NotFlat> {
        let places: Vec<[f64; 2]> = mesh.nodes.iter().map(|point| [point.x, point.y]).collect();
        check_flat(mesh)?;
        let plane = |axis: usize| Some(mesh.mirrors[axis].as_slice()).filter(|plane| !plane.is_empty());
        let mirrored = [plane(0), plane(1)];
        let outline = Outline::new(&places, &elements, built_in, mirrored);
        let (sin, cos) = section.md_angle.sin_cos();
        let mounted = Mounted { md: [cos, sin], stretch: section.prestrain.map(|strain| 1.0 + strain) };
        let plate = Plate::new(section, layers);
        let own = places.len();
        let mut curvatures = vec![];
        let mut at_nodes = vec![vec![]; own];
        for node in 0..outline.places.len() as u32 {
            // An image bends no node that it does not reach.
            let is_near = || outline.neighbours(node, Reach::Second).iter().any(|other| (*other as usize) < own);
            if node as usize >= own && !is_near() {
                continue;
            }
            let Some(curvature) = Curvature::at_node(&outline, node, &mounted, &plate, elements.len()) else {
                continue;
            };
            for (place, other) in curvature.nodes.iter().enumerate().filter(|(_, other)| (**other as usize) < own) {
                at_nodes[*other as usize].push((curvatures.len() as u32, place as u32));
            }
            curvatures.push(curvature);
        }
        let on_planes = |node: u32| {
            let is_on = |plane: &&[u32]| plane.binary_search(&node).is_ok();
            mirrored.iter().flatten().filter(|plane| is_on(plane)).count() as i32
        };
        let mut bending = Bending {
            rows: Rows::new(&[]),
            mounted: Vectors::default(),
            beside: Vectors::default(),
            squared_frequency: 0.0,
            is_whole: vec![true; curvatures.len()],
            curvatures,
            at_nodes,
            source: outline.source,
            shares: (0..own as u32).map(|node| 0.5_f64.powi(on_planes(node))).collect(),
            elements,
        };
        let rows: Vec<Vec<Entry>> = (0..own).map(|node| bending.row(node)).collect();
        // Stiffness of any vector over the mass, row by row, bounds the largest eigenvalue (Gershgorin).
        let of_row = |(node, row): (usize, &Vec<Entry>)| {
            let along = |axis: usize| row.iter().map(|(_, stiffness)| stiffness[axis].abs()).sum::<f64>();
            along(0).max(along(1)).max(along(2)) / nodes.mass[first + node]
        };
        bending.squared_frequency = rows.iter().enumerate().map(of_row).fold(0.0, f64::max);
        bending.rows = Rows::new(&rows);
        bending.mounted.extend((first..first + own).map(|node| nodes.position.value_at(node)));
        bending.balance();
        Ok(bending)
    }

    /// Entries of a row, those of curvatures in whole film.
    fn row(&self, node: usize) -> Vec<Entry> {
        let mut entries: Vec<(u32, f64)> = vec![];
        for (number, place) in &self.at_nodes[node] {
            let number = *number as usize;
            if self.is_whole[number] {
                let curvature = &self.curvatures[number];
                let between = |(other, node): (usize, &u32)| (*node, curvature.between(*place as usize, other));
                entries.extend(curvature.nodes.iter().enumerate().map(between));
            }
        }
        // Stable: those of one column are summed in the order of the curvatures.
        entries.sort_by_key(|(node, _)| *node);
        let mut row: Vec<Entry> = vec![];
        for group in entries.chunk_by(|a, b| a.0 == b.0) {
            let (own, signs) = self.source[group[0].0 as usize];
            let stiffness = self.shares[node] * group.iter().map(|(_, stiffness)| stiffness).sum::<f64>();
            row.push((own, signs.map(|sign| sign * stiffness)));
        }
        // A node moves together with its images.
        row.sort_by_key(|(own, _)| *own);
        let sum = |group: &[Entry]| {
            let along = |axis: usize| group.iter().map(|(_, stiffness)| stiffness[axis]).sum::<f64>();
            (group[0].0, [along(0), along(1), along(2)])
        };
        row.chunk_by(|a, b| a.0 == b.0).map(sum).collect()
    }

    /// Makes the mounted positions those without forces.
    fn balance(&mut self) {
        // By the pass that the forces take, so that both cancel to the last bit.
        self.beside = self.product(&self.mounted.axes());
    }

    /// K x.
    pub(super) fn product(&self, x: &[&[f64]; 3]) -> Vectors {
        let zero = Vectors::zero(self.shares.len());
        let mut out = Vectors::zero(self.shares.len());
        let shared = out.axes_mut().map(Disjoint::new);
        // SAFETY: there is one thread.
        unsafe { self.rows.subtract(Width::best(), 0..self.rows.blocks(), x, &zero.axes(), &shared) };
        out.axes_mut().into_iter().flatten().for_each(|value| *value = -*value);
        out
    }

    /// Number of tasks of a pass over the forces.
    pub(super) fn tasks(&self) -> usize {
        self.rows.blocks().div_ceil(BLOCKS)
    }

    /// Adds the forces of one task to `force`; `position` and `force` are those of the film's own nodes.
    ///
    /// # Safety
    /// No other thread may be at work on the same task or on other forces of these nodes.
    pub(super) unsafe fn add_forces(
        &self,
        width: Width,
        task: usize,
        position: &[&[f64]; 3],
        force: &[Disjoint<'_, f64>; 3],
    ) {
        let blocks = task * BLOCKS..self.rows.blocks().min((task + 1) * BLOCKS);
        // SAFETY: by the contract.
        unsafe { self.rows.subtract(width, blocks, position, &self.beside.axes(), force) };
    }

    /// Energy stored at a `position` of the film's own nodes, J.
    pub(super) fn energy(&self, position: &[&[f64]; 3]) -> f64 {
        let mounted = self.mounted.axes();
        let moved = |axis: usize| position[axis].iter().zip(mounted[axis]).map(|(x, at)| x - at).collect::<Vec<f64>>();
        let moved = [moved(0), moved(1), moved(2)];
        let forces = self.product(&moved.each_ref().map(Vec::as_slice));
        let work = |(moved, force): (&[f64], &[f64])| moved.iter().zip(force).map(|(u, f)| 0.5 * u * f).sum::<f64>();
        moved.iter().map(Vec::as_slice).zip(forces.axes()).map(work).sum()
    }

    /// Bound on the squared angular frequency, rad²/s².
    pub(super) fn squared_frequency(&self) -> f64 {
        self.squared_frequency
    }

    /// Leaves out what rests on elements that are not `intact` any more, or takes it in again. Whether anything changed.
    pub(super) fn update(&mut self, intact: &[Vec<u32>]) -> bool {
        // Both are in the same order.
        let mut rest = intact.iter().peekable();
        let is_intact: Vec<bool> = self.elements.iter().map(|e| rest.next_if(|i| *i == e).is_some()).collect();
        let is_whole = |curvature: &Curvature| curvature.elements.iter().all(|element| is_intact[*element as usize]);
        let whole: Vec<bool> = self.curvatures.iter().map(is_whole).collect();
        if whole == self.is_whole {
            return false;
        }
        let changed = |number: &(u32, u32)| whole[number.0 as usize] != self.is_whole[number.0 as usize];
        let rows: Vec<bool> = self.at_nodes.iter().map(|numbers| numbers.iter().any(changed)).collect();
        self.is_whole = whole;
        for block in 0..self.rows.blocks() {
            let of_block = self.rows.rows_of(block);
            if rows[of_block.clone()].contains(&true) {
                let new: Vec<Vec<Entry>> = of_block.map(|node| self.row(node)).collect();
                self.rows.fill(block, &new);
            }
        }
        self.balance();
        true
    }

    /// Bytes of its arrays.
    pub(super) fn bytes(&self) -> usize {
        let of_curvature = |curvature: &Curvature| {
            bytes(&curvature.nodes) + bytes(&curvature.weights) + bytes(&curvature.elements) + size_of::<Curvature>()
        };
        let lists = self.at_nodes.iter().map(|list| bytes(list)).sum::<usize>();
        let elements = self.elements.iter().map(|element| bytes(element)).sum::<usize>();
        let curvatures = self.curvatures.iter().map(of_curvature).sum::<usize>();
        let beside = bytes(&self.is_whole) + bytes(&self.source) + bytes(&self.shares);
        self.rows.bytes() + self.mounted.bytes() + self.beside.bytes() + lists + elements + curvatures + beside
    }
}

fn check_flat(mesh: &Mesh) -> Result<(), NotFlat> {
    let range = |axis: usize| {
        let (least, most) = mesh.nodes.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), point| {
            (least.min(point[axis]), most.max(point[axis]))
        });
        most - least
    };
    let height = range(2);
    if height <= FLAT * range(0).max(range(1)) { Ok(()) } else { Err(NotFlat { height }) }
}
