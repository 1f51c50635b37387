//! One face of film: its elements in chunks and its nodes.
//!
//! Threads take the chunks one by one. Chunks of one colour share no node, so their forces may be added at the same
//! time; the colours follow each other. Neither depends on the number of threads, and so the order of no sum does.

use std::ops::Range;

use nalgebra::{Point2, Vector2};
use serde::{Deserialize, Serialize};

use super::colouring::first_fit;
use super::disjoint::Disjoint;
use super::element::{
    Common, ElementDetail, ElementEnergy, ElementGroup, ElementStrain, Forces, OwnForces, Tearing, Torn, place,
};
use super::failure::Failures;
use super::nodes::{Nodes, Vectors};
use super::thread_pool::ThreadPool;
use super::tips::{Events, MirrorPlane, Start, TearingFilm, Tips};
use crate::lane::{LANES, Width};
use crate::material::{LawProperties, Rupture};

/// A face of film ready to be stepped.
#[derive(Clone)]
pub struct Film {
    chunks: Vec<Chunk>,
    law: LawProperties,
    /// kg/m³, with mass scaling.
    density: f64,
    /// Share of its mass that has weight: the rest is air that moves with it.
    pub(super) weight_share: f64,
    /// Thickness of all layers, m.
    pub thickness: f64,
    /// Which of all nodes are this face's.
    pub nodes: Range<usize>,
    /// Its mirror planes, across x and y.
    mirrors: [MirrorPlane; 2],
    /// Where it tears: the tips of its tears.
    tips: Option<Box<Tips>>,
}

/// Elements that one thread takes at a time.
pub(super) struct Chunk {
    group: Box<dyn ElementGroup>,
    colour: usize,
    /// Number of the first element among those of the film.
    first: usize,
    /// Whether a fibre was past its break strain or a tear took energy in the last pass over the forces.
    failed: bool,
}

impl Chunk {
    /// Number of its elements.
    fn len(&self) -> usize {
        self.group.common().count
    }

    /// Adds its forces, of nodes that moved to `position` in `dt` (s), to `force`.
    pub(super) fn add_forces(&mut self, width: Width, position: &[&[f64]; 3], dt: f64, force: OwnForces<'_>) {
        self.failed = self.group.add_forces(width, position, dt, force);
    }

    /// Its tears, where film has a rupture criterion of its own.
    fn tearing(&mut self) -> Option<&mut Tearing<LANES>> {
        self.group.common_mut().tearing.as_mut()
    }
}

impl Clone for Chunk {
    fn clone(&self) -> Chunk {
        Chunk { group: self.group.boxed(), ..*self }
    }
}

/// Mass added to small elements for a longer time step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct AddedMass {
    /// kg.
    pub mass: f64,
    /// Mass of the film without it, kg.
    pub own: f64,
    /// Number of the elements.
    pub elements: usize,
}

impl Film {
    /// A film of `groups` of elements of a `law`, each a chunk, on its `nodes` among all; `density` in kg/m³, `thickness`
    /// in m.
    pub(super) fn new(
        groups: Vec<Box<dyn ElementGroup>>,
        law: LawProperties,
        [density, thickness]: [f64; 2],
        nodes: Range<usize>,
        mirrors: [MirrorPlane; 2],
    ) -> Film {
        let of_group: Vec<Vec<u32>> = groups.iter().map(|group| nodes_of(&**group)).collect();
        let mut first = 0;
        let chunk = |(group, colour): (Box<dyn ElementGroup>, usize)| {
            let chunk = Chunk { colour, first, failed: false, group };
            first += chunk.len();
            chunk
        };
        let chunks = groups.into_iter().zip(first_fit(&of_group)).map(chunk).collect();
        Film { chunks, law, density, weight_share: 1.0, thickness, nodes, mirrors, tips: None }
    }

    /// Density with mass scaling, kg/m³.
    pub(super) fn density(&self) -> f64 {
        self.density
    }

    /// Number of elements.
    pub fn elements(&self) -> usize {
        self.chunks.iter().map(Chunk::len).sum()
    }

    /// Whether its law admits stretches up to a limit only.
    pub fn has_limit(&self) -> bool {
        self.law.has_limit
    }

    /// Whether its law has a plastic strain.
    pub fn is_plastic(&self) -> bool {
        self.law.is_plastic
    }

    /// Whether its law defines its thickness.
    pub fn has_thickness(&self) -> bool {
        self.law.has_thickness
    }

    /// History variables of its elements: element by element, quads first, whatever the chunks and blocks that hold them.
    pub(super) fn save(&self) -> Vec<f64> {
        let mut history = vec![];
        self.chunks.iter().for_each(|chunk| chunk.group.save(&mut history));
        history
    }

    /// Restores the history variables of its elements, as many as it has.
    pub(super) fn restore(&mut self, history: &[f64]) {
        let mut rest = history.iter();
        self.chunks.iter_mut().for_each(|chunk| chunk.group.restore(&mut rest));
        self.find_tips();
    }

    /// Resets the history variables of its elements to those of virgin film; deleted elements stay deleted.
    pub(super) fn reset(&mut self) {
        self.chunks.iter_mut().for_each(|chunk| chunk.group.reset());
        self.find_tips();
    }

    /// Calls `show` with the nodes of every element that is not deleted.
    pub fn for_each_intact(&self, mut show: impl FnMut(&[u32])) {
        for Chunk { group, .. } in &self.chunks {
            group.elements(true).for_each(|element| show(group.common().corners.of(element)));
        }
    }

    /// Colour and nodes of each chunk.
    pub(super) fn chunks(&self) -> impl Iterator<Item = (usize, Vec<u32>)> {
        self.chunks.iter().map(|chunk| (chunk.colour, nodes_of(&*chunk.group)))
    }

    /// Shares its chunks among threads, which add their forces.
    pub(super) fn share(&mut self) -> Disjoint<'_, Chunk> {
        Disjoint::new(&mut self.chunks)
    }

    /// Adds the film's forces to those of its nodes, which moved to their positions in `dt` (s), and updates the
    /// history variables.
    pub fn add_forces(&mut self, nodes: &mut Nodes, dt: f64) {
        let mut order: Vec<usize> = (0..self.chunks.len()).collect();
        // The order of the pool, so that forces have the same bits with it and without.
        order.sort_by_key(|chunk| self.chunks[*chunk].colour);
        let Nodes { position, force, .. } = nodes;
        let forces = Forces::new(force.axes_mut());
        for chunk in order {
            // SAFETY: there is one thread.
            self.chunks[chunk].add_forces(Width::best(), &position.axes(), dt, unsafe { forces.own() });
        }
    }

    /// Adds mass to the elements whose squared angular frequency is above `most` (rad²/s²), so that it is `most`.
    pub(super) fn add_mass(&mut self, nodes: &mut Nodes, most: f64) -> AddedMass {
        // The stiffness depends on history variables, which pre-strain changes.
        self.add_forces(nodes, 0.0);
        nodes.clear_forces();
        let own: f64 = nodes.mass[self.nodes.clone()].iter().sum();
        let mut added = AddedMass { own, ..AddedMass::default() };
        let position = nodes.position.clone();
        let mut add = |corners: &[u32], mass: f64| {
            added.elements += 1;
            added.mass += mass * corners.len() as f64;
            corners.iter().for_each(|node| nodes.add_mass(*node as usize, mass));
        };
        self.chunks.iter_mut().for_each(|chunk| chunk.group.add_mass(self.density, most, &position.axes(), &mut add));
        added
    }

    /// Strains of every element, quads first.
    pub fn strains(&self, position: &Vectors) -> Vec<ElementStrain> {
        let mut out = vec![];
        strains(std::slice::from_ref(self), &ThreadPool::new(1), position.axes(), &mut out);
        out.concat()
    }

    /// Stress, thickness and fibres of every element, quads first; `position` is that of all nodes.
    pub fn details(&self, position: &Vectors) -> Vec<ElementDetail> {
        self.chunks.iter().flat_map(|chunk| chunk.group.details(&position.axes())).collect()
    }

    /// Energies of the film alone, J.
    pub fn energy(&self, position: &Vectors) -> ElementEnergy {
        energies(std::slice::from_ref(self), &ThreadPool::new(1), position.axes())[0]
    }

    /// Bound on the squared angular frequency of any of its elements, rad²/s² (theory.md, equation 17).
    pub fn frequency_bound(&self, position: &Vectors) -> f64 {
        frequency_bounds(std::slice::from_ref(self), &ThreadPool::new(1), position.axes())[0]
    }

    /// Squared angular frequency of its smallest element with the largest slope of its law at small strains, rad²/s².
    pub(super) fn largest_frequency(&self) -> f64 {
        self.chunks.iter().map(|chunk| chunk.group.largest_frequency(self.density)).fold(0.0, f64::max)
    }

    /// Breaks the fibres that the last pass over the forces found past their break strain, and deletes elements without
    /// fibres; mass stays at the nodes. `position`, to which the nodes moved in `dt` (s), is that of all nodes. Whether it
    /// `looks` at tips of tears where film stores little of the work done on it.
    pub fn fail(&mut self, position: [&[f64]; 3], dt: f64, looks: bool) -> Failures {
        let mut total = Failures::default();
        // The pass over forces has flagged them: nearly always there is none, and no element is looked at.
        for chunk in self.chunks.iter_mut().filter(|chunk| chunk.failed) {
            total.add(&chunk.group.fail(&position));
        }
        if total.opened || total.broken > 0 {
            self.find_tips();
        }
        if dt > 0.0 {
            total.returned = self.start_tears(&position, looks);
        }
        total
    }

    /// Whether its elements have a rupture criterion of their own.
    pub fn has_rupture(&self) -> bool {
        self.rupture().is_some()
    }

    /// Their rupture criterion.
    fn rupture(&self) -> Option<Rupture> {
        self.chunks.first()?.group.common().tearing.as_ref().map(|tearing| tearing.rupture)
    }

    /// Whether it warms up by what it absorbs.
    pub fn warms_up(&self) -> bool {
        self.chunks.iter().any(|chunk| chunk.group.common().heating.is_some())
    }

    /// Whether its tears take a fracture energy.
    pub fn takes_fracture_energy(&self) -> bool {
        self.rupture().is_some_and(|rupture| rupture.fracture_energy > 0.0)
    }

    /// Its tears so far.
    pub fn torn(&self) -> Torn {
        let mut total = Torn::default();
        self.chunks.iter().for_each(|chunk| total.add(&chunk.group.common().torn(self.thickness)));
        total
    }

    /// Cuts the film: deletes the elements through which the lines between successive `corners` (m, in the plane of the
    /// frame) pass and whose middle lies beside them, and those at its bends. Mass stays at the nodes. The number of
    /// the elements.
    pub fn cut(&mut self, nodes: &Nodes, corners: &[[f64; 2]]) -> usize {
        let at = |node: &u32| nodes.position_of(*node as usize).xy();
        let crossed = |element: &[u32]| {
            let of_element: Vec<Point2<f64>> = element.iter().map(at).collect();
            let (least, most) = bounds(&of_element);
            // A cut may have as many points as a drawing: nearly all are far from an element. Its middle is beside a line
            // that crosses it, so that the line comes as near as the element is large.
            let reach = 2.0 * (most - least).norm();
            let is_near = |line: &[[f64; 2]]| {
                (0..2).all(|axis| {
                    line.iter().any(|end| end[axis] >= least[axis] - reach)
                        && line.iter().any(|end| end[axis] <= most[axis] + reach)
                })
            };
            let mut lines = corners.windows(2).enumerate().filter(|(_, ends)| is_near(ends));
            lines.any(|(place, ends)| {
                let [from, to] = [ends[0].into(), ends[1].into()];
                crosses([from, to], &of_element) || (place > 0 && contains(&of_element, from))
            })
        };
        let mut deleted = 0;
        for group in self.chunks.iter_mut().map(|chunk| &mut chunk.group) {
            let is_cut = |element: &usize| crossed(group.common().corners.of(*element));
            let cut: Vec<usize> = group.elements(true).filter(is_cut).collect();
            deleted += cut.len();
            cut.into_iter().for_each(|element| group.delete(element));
        }
        self.find_tips();
        deleted
    }

    /// Finds the elements at the tips of tears.
    fn find_tips(&mut self) {
        if !self.has_rupture() {
            return;
        }
        let mut open = vec![false; self.nodes.end];
        for group in self.groups() {
            for element in group.elements(false).filter(|element| group.is_open(*element)) {
                group.common().corners.of(element).iter().for_each(|node| open[*node as usize] = true);
            }
        }
        for common in self.chunks.iter_mut().map(|chunk| chunk.group.common_mut()) {
            let Common { count, corners, tearing: Some(tearing), .. } = common else { continue };
            for element in 0..*count {
                tearing.set_beside_open(place(element), corners.of(element).iter().any(|node| open[*node as usize]));
            }
        }
        if !open.contains(&true) || !self.takes_fracture_energy() {
            self.tips = None;
            return;
        }
        let tips = self.tips.take();
        let groups = self.groups();
        let mut tips = tips.unwrap_or_else(|| Box::new(Tips::new(&groups, self.nodes.end, &self.mirrors)));
        tips.find(&groups);
        self.tips = Some(tips);
    }

    /// Starts the tears of elements at tips where film releases what they take (theory.md, equation 304).
    /// Returns the least share of work that film returned at a tip where that decided.
    fn start_tears(&mut self, position: &[&[f64]; 3], looks: bool) -> Option<f64> {
        let tips = self.tips.as_ref()?;
        let (groups, rupture) = (self.groups(), self.rupture()?);
        let film =
            TearingFilm { groups: &groups, position, energy: rupture.fracture_energy, thickness: self.thickness };
        let Events { starts, waiting, returned } = tips.events(&film, looks);
        for [c, e] in waiting {
            self.chunks[c as usize].tearing()?.go_on(place(e as usize));
        }
        let mut opened = false;
        for Start { element: [c, e], width, offset } in starts {
            let tearing = self.chunks[c as usize].tearing()?;
            tearing.start(place(e as usize), width, offset);
            opened |= tearing.is_open(place(e as usize));
        }
        if opened {
            self.find_tips();
        }
        returned
    }

    /// Its elements, chunk by chunk.
    fn groups(&self) -> Vec<&dyn ElementGroup> {
        self.chunks.iter().map(|chunk| &*chunk.group).collect()
    }
}

/// Whether the line between two points passes through an element with these corners, whose middle lies beside it. Where
/// it runs along edges, the elements to its right.
fn crosses([from, to]: [Point2<f64>; 2], corners: &[Point2<f64>]) -> bool {
    let (line, length) = ((to - from).normalize(), (to - from).norm());
    let middle = corners.iter().map(|corner| corner.coords).sum::<Vector2<f64>>() / corners.len() as f64;
    let along = line.dot(&(middle - from.coords));
    let sides = corners.iter().map(|corner| line.perp(&(corner - from)));
    let (least, most) = sides.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), d| (a.min(d), b.max(d)));
    // Round-off beside an edge counts as on it: a line along edges takes the elements on one side of them, not on both.
    let on_edge = 1e-6 * (most - least);
    (0.0..length).contains(&along) && least < -on_edge && most > -on_edge
}

/// The least and the largest coordinates of an element with these corners.
fn bounds(corners: &[Point2<f64>]) -> (Point2<f64>, Point2<f64>) {
    let all = corners.iter().copied();
    all.fold((corners[0], corners[0]), |(least, most), corner| (least.inf(&corner), most.sup(&corner)))
}

/// Whether an element with these corners, counter-clockwise, contains a point.
fn contains(corners: &[Point2<f64>], point: Point2<f64>) -> bool {
    let next = corners.iter().cycle().skip(1);
    corners.iter().zip(next).all(|(from, to)| (to - from).perp(&(point - from)) >= 0.0)
}

/// Nodes of all elements of a group.
fn nodes_of(group: &dyn ElementGroup) -> Vec<u32> {
    let corners = &group.common().corners;
    group.elements(false).flat_map(|element| corners.of(element)).copied().collect()
}

/// Energies of each film, J; `position` is that of all nodes.
pub(super) fn energies(films: &[Film], pool: &ThreadPool, position: [&[f64]; 3]) -> Vec<ElementEnergy> {
    let mut totals = vec![ElementEnergy::default(); films.len()];
    let parts = for_each_chunk(films, pool, |_, chunk| chunk.group.energy(pool.width(), &position));
    // In the order of the chunks, not in that in which threads were done.
    parts.iter().for_each(|(film, energy)| totals[*film].add(energy));
    totals
}

/// Bound on the squared angular frequency of each film, rad²/s².
pub(super) fn frequency_bounds(films: &[Film], pool: &ThreadPool, position: [&[f64]; 3]) -> Vec<f64> {
    let mut largest = vec![0.0_f64; films.len()];
    let parts =
        for_each_chunk(films, pool, |f, chunk| chunk.group.frequency_bound(pool.width(), films[f].density, &position));
    for (film, squared) in parts {
        let most = &mut largest[film];
        *most = if squared <= *most || most.is_nan() { *most } else { squared };
    }
    largest
}

/// Strains of every element of each film, quads first, into `out`.
pub(super) fn strains(films: &[Film], pool: &ThreadPool, position: [&[f64]; 3], out: &mut Vec<Vec<ElementStrain>>) {
    out.resize_with(films.len(), Vec::new);
    for (face, film) in out.iter_mut().zip(films) {
        face.resize(film.elements(), ElementStrain::default());
    }
    let faces: Vec<Disjoint<'_, ElementStrain>> = out.iter_mut().map(|face| Disjoint::new(face)).collect();
    for_each_chunk(films, pool, |f, chunk| {
        // SAFETY: every chunk comes up once and writes to its own elements alone.
        let own = unsafe { faces[f].range(chunk.first..chunk.first + chunk.len()) };
        chunk.group.strains(pool.width(), &position, own);
    });
}

/// The result of `work` for every chunk, called with the number of its film, each with that number, in order.
fn for_each_chunk<T: Clone + Default + Send>(
    films: &[Film],
    pool: &ThreadPool,
    work: impl Fn(usize, &Chunk) -> T + Sync,
) -> Vec<(usize, T)> {
    let chunks: Vec<(usize, &Chunk)> =
        films.iter().enumerate().flat_map(|(f, film)| film.chunks.iter().map(move |chunk| (f, chunk))).collect();
    let mut out: Vec<(usize, T)> = chunks.iter().map(|(f, _)| (*f, T::default())).collect();
    let results = Disjoint::new(&mut out);
    pool.each(chunks.len(), |part| {
        let (film, chunk) = chunks[part];
        let result = work(film, chunk);
        // SAFETY: every part comes up once.
        unsafe { results.entry(part).1 = result };
    });
    out
}
