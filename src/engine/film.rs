//! One face of film: its elements, its law, its share of the nodes.
//!
//! The elements stand in chunks, which threads take one by one. Chunks of one colour share no node, so they may add their
//! forces at the same time; colours follow each other. Neither depends on the number of threads, and so does no sum.

use std::ops::Range;

use super::element::{
    self, Block, Blocks, ElementEnergy, ElementStrain, Forces, FullQuads, OwnForces, Quads, Shaped, StressFree, Tris,
    UprightElement,
};
use super::footprint;
use super::memory::{self, Memory};
use super::nodes::{Nodes, Vectors};
use super::team::{Disjoint, Team};
use crate::lane::{LANES, Width};
use crate::material::Law;
use crate::mesh::Mesh;
use crate::model::{self, Face};

/// A face of film ready to be stepped.
#[derive(Clone, Debug)]
pub struct Film {
    law: Law,
    /// kg/m³, with mass scaling.
    density: f64,
    /// Thickness of all layers, m.
    pub thickness: f64,
    /// Which of all nodes are this face's; elements count theirs from the first of them.
    pub(crate) nodes: Range<usize>,
    chunks: Vec<Chunk>,
    /// Number of colours.
    colours: usize,
}

/// Elements that one thread works on.
#[derive(Clone, Debug)]
pub(super) struct Chunk {
    elements: Elements,
    colour: usize,
    /// Number of the first element among those of the film.
    first: usize,
    /// Whether a fibre was past its break strain in the last pass over the forces.
    past: bool,
}

/// Elements of one kind.
#[derive(Clone, Debug)]
enum Elements {
    Quads(Quads),
    FullQuads(FullQuads),
    Tris(Tris),
}

/// Number of chunks that a film is cut into where they do not become too large or too small: enough for threads to share.
const CHUNKS: usize = 12;

/// Bounds on the blocks of a chunk.
const BLOCKS: [usize; 2] = [4, 64];

/// Runs `$body` with `$blocks` bound to the elements of a chunk and `$law` to the concrete law.
macro_rules! concretely {
    ($elements:expr, $of:expr, |$blocks:ident, $law:ident| $body:expr) => {
        match $of {
            Law::Fabric($law) => concretely!($elements, |$blocks| $body),
            Law::Elastic($law) => concretely!($elements, |$blocks| $body),
            Law::TensionField($law) => concretely!($elements, |$blocks| $body),
        }
    };
    ($elements:expr, |$blocks:ident| $body:expr) => {
        match $elements {
            Elements::Quads($blocks) => $body,
            Elements::FullQuads($blocks) => $body,
            Elements::Tris($blocks) => $body,
        }
    };
}

impl Film {
    /// The elements of `mesh` as film of `face`; appends the face's nodes, lifted to its height, to `nodes`.
    /// `mass_scaling` multiplies the density.
    pub fn mount(mesh: &Mesh, face: &Face, mass_scaling: f64, nodes: &mut Nodes) -> Result<Film, UprightElement> {
        let stress_free = StressFree::new(face.md_angle, face.prestrain);
        let thickness = face.material.thickness * f64::from(face.layers);
        let density = face.material.density * mass_scaling;
        let first = nodes.position.len();

        let mut mount = Mount { mesh, thickness, density, masses: vec![0.0; mesh.nodes.len()], chunks: vec![] };
        if face.meshing.element == model::Element::Quad4Full {
            mount.add(&mesh.quads, &stress_free, Elements::FullQuads)?;
        } else {
            mount.add(&mesh.quads, &stress_free, Elements::Quads)?;
        }
        mount.add(&mesh.tris, &stress_free, Elements::Tris)?;
        let Mount { mut chunks, masses, .. } = mount;
        let colours = colour(&mut chunks, mesh.nodes.len());

        nodes.extend(mesh.nodes.iter().map(|p| [p.x, p.y, p.z + face.height]), &masses);
        let (law, nodes) = (face.material.law.clone(), first..nodes.position.len());
        Ok(Film { law, density, thickness, nodes, chunks, colours })
    }

    /// Number of elements.
    pub fn elements(&self) -> usize {
        self.chunks.iter().map(Chunk::count).sum()
    }

    /// Number of colours of its chunks.
    pub(super) fn colours(&self) -> usize {
        self.colours
    }

    /// Number of integration points.
    pub(super) fn points(&self) -> usize {
        let of = |chunk: &Chunk| concretely!(&chunk.elements, |blocks| blocks.count * blocks.points());
        self.chunks.iter().map(of).sum()
    }

    /// Bytes of its elements.
    pub(super) fn bytes(&self) -> usize {
        let of = |chunk: &Chunk| concretely!(&chunk.elements, |blocks| footprint::blocks(blocks));
        self.chunks.iter().map(of).sum()
    }

    /// What its elements remember.
    pub(super) fn memory(&self) -> Memory {
        let mut memory = Memory::default();
        self.chunks.iter().for_each(|chunk| concretely!(&chunk.elements, |blocks| memory.note(blocks)));
        memory
    }

    /// Lets its elements remember what they did when `memory`, of as many integration points, was taken.
    pub(super) fn recall(&mut self, memory: &Memory) {
        let mut points = memory.points();
        for chunk in &mut self.chunks {
            concretely!(&mut chunk.elements, |blocks| memory::recall(&mut points, blocks));
        }
    }

    /// Shows the corners of every element that has not broken, counted among all nodes.
    pub fn for_each_intact(&self, mut show: impl FnMut(&[u32])) {
        let first = self.nodes.start as u32;
        for chunk in &self.chunks {
            concretely!(&chunk.elements, |blocks| {
                for (b, l) in blocks.places().filter(|(b, l)| !blocks.is_broken(*b, *l)) {
                    show(&blocks.corners[b].of(l).map(|n| first + n));
                }
            });
        }
    }

    /// Gets the film ready for its forces to be added by several threads.
    pub(super) fn pulling(&mut self) -> Pulling<'_> {
        Pulling { law: &self.law, chunks: Disjoint::new(&mut self.chunks), nodes: self.nodes.clone() }
    }

    /// Adds the film's forces to those of its nodes, and raises the largest strains.
    pub fn add_forces(&mut self, nodes: &mut Nodes) {
        let colours: Vec<Vec<usize>> = (0..self.colours).map(|colour| self.chunks_of(colour).collect()).collect();
        let of = self.nodes.clone();
        let Nodes { position, force, .. } = nodes;
        let forces = Forces::new(force.axes_mut().map(|axis| &mut axis[of.clone()]));
        let pulling = self.pulling();
        for chunk in colours.concat() {
            // SAFETY: there is one thread.
            unsafe { pulling.add_forces(Width::best(), chunk, position.axes(), forces.own()) };
        }
    }

    /// Strains of every element, quads first.
    pub fn strains(&self, position: &Vectors) -> Vec<ElementStrain> {
        let mut out = vec![];
        strains(std::slice::from_ref(self), &Team::new(1), position.axes(), &mut out);
        out.concat()
    }

    /// Energies of the film alone, J.
    pub fn energy(&self, position: &Vectors) -> ElementEnergy {
        energies(std::slice::from_ref(self), &Team::new(1), position.axes())[0]
    }

    /// Bound on the squared angular frequency of any of its elements, rad²/s² (theory.md, equation 17).
    pub fn frequency_bound(&self, position: &Vectors) -> f64 {
        frequency_bounds(std::slice::from_ref(self), &Team::new(1), position.axes())[0]
    }

    /// Numbers of the chunks of one colour.
    pub(super) fn chunks_of(&self, colour: usize) -> impl Iterator<Item = usize> + '_ {
        (0..self.chunks.len()).filter(move |chunk| self.chunks[*chunk].colour == colour)
    }

    /// Takes the force from every element that the last forces found past its break strain; its mass stays. `position` is that
    /// of all nodes. Returns the number of elements broken and the energies they held.
    pub fn break_elements(&mut self, position: [&[f64]; 3]) -> (usize, ElementEnergy) {
        let position = position.map(|axis| &axis[self.nodes.clone()]);
        let mut total = (0, ElementEnergy::default());
        for chunk in self.chunks.iter_mut().filter(|chunk| chunk.past) {
            let (count, held) = concretely!(&mut chunk.elements, &self.law, |blocks, law| {
                super::failure::break_elements(blocks, law, &position)
            });
            total.0 += count;
            total.1.add(&held);
        }
        total
    }
}

/// A film whose forces several threads add, each those of its own chunks.
pub(super) struct Pulling<'a> {
    law: &'a Law,
    chunks: Disjoint<'a, Chunk>,
    nodes: Range<usize>,
}

impl Pulling<'_> {
    /// Adds the forces of one chunk to `force`, that of the film's own nodes; `position` is that of all nodes.
    ///
    /// # Safety
    /// No other thread may be at work on this chunk.
    pub(super) unsafe fn add_forces(&self, width: Width, chunk: usize, position: [&[f64]; 3], force: OwnForces<'_>) {
        let position = position.map(|axis| &axis[self.nodes.clone()]);
        // SAFETY: the caller keeps other threads from this chunk.
        let chunk = unsafe { self.chunks.at(chunk) };
        chunk.past = concretely!(&mut chunk.elements, self.law, |blocks, law| {
            element::add_forces(width, blocks, law, &position, force)
        });
    }

    /// Which of all nodes are this film's.
    pub(super) fn nodes(&self) -> Range<usize> {
        self.nodes.clone()
    }
}

/// Energies of each film, J; `position` is that of all nodes.
pub(super) fn energies(films: &[Film], team: &Team, position: [&[f64]; 3]) -> Vec<ElementEnergy> {
    let mut totals = vec![ElementEnergy::default(); films.len()];
    let parts = survey(films, team, |film, chunk| {
        let film = &films[film];
        let position = position.map(|axis| &axis[film.nodes.clone()]);
        concretely!(&chunk.elements, &film.law, |blocks, law| element::energy(team.width(), blocks, law, &position))
    });
    parts.iter().for_each(|(film, energy)| totals[*film].add(energy));
    totals
}

/// Bound on the squared angular frequency of any element of each film, rad²/s².
pub(super) fn frequency_bounds(films: &[Film], team: &Team, position: [&[f64]; 3]) -> Vec<f64> {
    let mut largest = vec![0.0_f64; films.len()];
    let parts = survey(films, team, |film, chunk| {
        let film = &films[film];
        let position = position.map(|axis| &axis[film.nodes.clone()]);
        concretely!(&chunk.elements, &film.law, |blocks, law| {
            element::frequency_bound(team.width(), blocks, law, film.density, &position)
        })
    });
    for (film, squared) in parts {
        let most = &mut largest[film];
        *most = if squared <= *most || most.is_nan() { *most } else { squared };
    }
    largest
}

/// Strains of every element of each film, quads first, into `out`.
pub(super) fn strains(films: &[Film], team: &Team, position: [&[f64]; 3], out: &mut Vec<Vec<ElementStrain>>) {
    out.resize_with(films.len(), Vec::new);
    for (face, film) in out.iter_mut().zip(films) {
        face.resize(film.elements(), ElementStrain::default());
    }
    let faces: Vec<Disjoint<'_, ElementStrain>> = out.iter_mut().map(|face| Disjoint::new(face)).collect();
    survey(films, team, |film, chunk| {
        let position = position.map(|axis| &axis[films[film].nodes.clone()]);
        // SAFETY: every chunk writes its own elements alone.
        let own = unsafe { faces[film].range(chunk.first..chunk.first + chunk.count()) };
        concretely!(&chunk.elements, |blocks| element::strains(team.width(), blocks, &position, own))
    });
}

/// What `work` says of every chunk, with the number of its film, in order.
fn survey<T: Clone + Default + Send>(
    films: &[Film],
    team: &Team,
    work: impl Fn(usize, &Chunk) -> T + Sync,
) -> Vec<(usize, T)> {
    let chunks: Vec<(usize, &Chunk)> =
        films.iter().enumerate().flat_map(|(f, film)| film.chunks.iter().map(move |chunk| (f, chunk))).collect();
    let mut out: Vec<(usize, T)> = chunks.iter().map(|(f, _)| (*f, T::default())).collect();
    let answers = Disjoint::new(&mut out);
    team.each(chunks.len(), |part| {
        let (film, chunk) = chunks[part];
        let answer = work(film, chunk);
        // SAFETY: every part comes up once.
        unsafe { answers.at(part).1 = answer };
    });
    out
}

impl Chunk {
    fn count(&self) -> usize {
        concretely!(&self.elements, |blocks| blocks.count)
    }

    fn for_each_node(&self, mut show: impl FnMut(usize)) {
        concretely!(&self.elements, |blocks| {
            for (b, l) in blocks.places() {
                blocks.corners[b].of(l).iter().for_each(|n| show(*n as usize));
            }
        });
    }
}

/// A film while its elements are made.
struct Mount<'a> {
    mesh: &'a Mesh,
    thickness: f64,
    density: f64,
    masses: Vec<f64>,
    chunks: Vec<Chunk>,
}

impl Mount<'_> {
    /// Adds elements of one kind, and their mass to their nodes.
    fn add<B, const NODES: usize>(
        &mut self,
        nodes: &[[u32; NODES]],
        stress_free: &StressFree,
        kind: impl Fn(Blocks<B, NODES>) -> Elements,
    ) -> Result<(), UprightElement>
    where
        B: Block<NODES, LANES>,
        B::Element: Shaped<NODES>,
    {
        let blocks = nodes.len().div_ceil(LANES);
        let size = LANES * blocks.div_ceil(CHUNKS).clamp(BLOCKS[0], BLOCKS[1]);
        for nodes in nodes.chunks(size) {
            let elements: Vec<B::Element> = element::shaped(nodes, &self.mesh.nodes, stress_free)?;
            for (nodes, element) in nodes.iter().zip(&elements) {
                let share = self.density * self.thickness * element.area() / NODES as f64;
                nodes.iter().for_each(|n| self.masses[*n as usize] += share);
            }
            let first = self.chunks.last().map_or(0, |chunk| chunk.first + chunk.count());
            let elements = kind(Blocks::new(nodes, &elements, self.thickness));
            self.chunks.push(Chunk { elements, colour: 0, first, past: false });
        }
        Ok(())
    }
}

/// Gives every chunk the first colour that no earlier chunk with a node in common has; returns the number of colours.
fn colour(chunks: &mut [Chunk], nodes: usize) -> usize {
    // A bit a colour: those that stand at a node already.
    let mut taken = vec![0_u64; nodes];
    let mut colours = 0;
    for chunk in chunks {
        let mut around = 0;
        chunk.for_each_node(|n| around |= taken[n]);
        let free = around.trailing_ones() as usize;
        // A mesh whose elements come in any order can need more than the mask holds: then a chunk gets a colour to itself.
        chunk.colour = if free < MASK { free } else { colours.max(MASK) };
        chunk.for_each_node(|n| taken[n] |= 1_u64.checked_shl(chunk.colour as u32).unwrap_or(0));
        colours = colours.max(chunk.colour + 1);
    }
    colours
}

/// Colours that a mask can tell apart.
const MASK: usize = u64::BITS as usize;
