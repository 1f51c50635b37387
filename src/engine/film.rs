//! One face of film: its elements, its law, its share of the nodes.
//!
//! The elements stand in chunks, which threads take one by one. Chunks of one colour share no node, so they may add their
//! forces at the same time; colours follow each other. Neither depends on the number of threads, and so does no sum.

use std::ops::Range;

use super::element::{
    self, Block, Blocks, ElementDetail, ElementEnergy, ElementStrain, Forces, FullQuads, OwnForces, Quads, Shaped,
    StressFree, Tris, UndefinedFibreDirection,
};
use super::film_history::FilmHistory;
use super::footprint;
use super::nodes::{Nodes, Vectors};
use super::section::Section;
use super::thread_pool::{Disjoint, ThreadPool};
use crate::lane::{LANES, Width};
use crate::material::{Elastic, Fabric, History, Law, MembraneLaw, RateCurves, TensionField};
use crate::mesh::Mesh;

/// A face of film ready to be stepped.
#[derive(Clone, Debug)]
pub struct Film {
    cloth: Cloth,
    /// kg/m³, with mass scaling.
    density: f64,
    /// Thickness of all layers, m.
    pub thickness: f64,
    /// Which of all nodes are this face's; elements count theirs from the first of them.
    pub(crate) nodes: Range<usize>,
    /// Number of colours.
    colours: usize,
}

/// Elements with their law and its history variables.
#[derive(Clone, Debug)]
enum Cloth {
    Fabric(Sheet<Fabric>),
    RateFabric(Sheet<Fabric<RateCurves>>),
    Elastic(Sheet<Elastic>),
    TensionField(Sheet<TensionField>),
}

/// Elements of one law.
#[derive(Clone, Debug)]
struct Sheet<M: MembraneLaw> {
    law: M,
    chunks: Vec<Chunk<M::History<LANES>>>,
}

/// Elements that one thread works on.
#[derive(Clone, Debug)]
struct Chunk<P> {
    elements: Elements<P>,
    colour: usize,
    /// Number of the first element among those of the film.
    first: usize,
    /// Whether a fibre was past its break strain in the last pass over the forces.
    failed: bool,
}

/// Elements of one kind.
#[derive(Clone, Debug)]
enum Elements<P> {
    Quads(Quads<LANES, P>),
    FullQuads(FullQuads<LANES, P>),
    Tris(Tris<LANES, P>),
}

/// Number of chunks that a film is cut into where they do not become too large or too small: enough for threads to share.
const CHUNKS: usize = 12;

/// Bounds on the blocks of a chunk.
const BLOCKS: [usize; 2] = [4, 64];

/// Runs `$body` with `$sheet` bound to what `$cloth`, one of the laws in `$Of`, holds.
macro_rules! by_law {
    ($Of:ident, $cloth:expr, |$sheet:ident| $body:expr) => {
        match $cloth {
            $Of::Fabric($sheet) => $body,
            $Of::RateFabric($sheet) => $body,
            $Of::Elastic($sheet) => $body,
            $Of::TensionField($sheet) => $body,
        }
    };
}

/// Runs `$body` with `$blocks` bound to the elements of a chunk.
macro_rules! by_kind {
    ($elements:expr, |$blocks:ident| $body:expr) => {
        match $elements {
            Elements::Quads($blocks) => $body,
            Elements::FullQuads($blocks) => $body,
            Elements::Tris($blocks) => $body,
        }
    };
}

impl Film {
    /// The elements of `mesh` with the properties of `section`; appends the nodes of the mesh, lifted by `height` (m), to
    /// `nodes`.
    ///
    /// # Errors
    /// MD is perpendicular to an element.
    pub fn mount(
        mesh: &Mesh,
        section: &Section,
        height: f64,
        nodes: &mut Nodes,
    ) -> Result<Film, UndefinedFibreDirection> {
        let &Section { ref law, density, thickness, md_angle, prestrain, full_integration: full } = section;
        let stress_free = StressFree::new(md_angle, prestrain);
        let first = nodes.position.len();

        let mut mount = Mount { mesh, stress_free, full, thickness, density, masses: vec![0.0; mesh.nodes.len()] };
        let (cloth, colours) = match law {
            Law::Fabric(law) => mount.sheet(law).map(|(sheet, colours)| (Cloth::Fabric(sheet), colours)),
            Law::RateFabric(law) => mount.sheet(law).map(|(sheet, colours)| (Cloth::RateFabric(sheet), colours)),
            Law::Elastic(law) => mount.sheet(law).map(|(sheet, colours)| (Cloth::Elastic(sheet), colours)),
            Law::TensionField(law) => mount.sheet(law).map(|(sheet, colours)| (Cloth::TensionField(sheet), colours)),
        }?;
        nodes.extend(mesh.nodes.iter().map(|p| [p.x, p.y, p.z + height]), &mount.masses);
        Ok(Film { cloth, density, thickness, nodes: first..nodes.position.len(), colours })
    }

    /// Number of elements.
    pub fn elements(&self) -> usize {
        by_law!(Cloth, &self.cloth, |sheet| sheet.chunks.iter().map(Chunk::count).sum())
    }

    /// Number of colours of its chunks.
    pub(super) fn colours(&self) -> usize {
        self.colours
    }

    /// Number of integration points.
    pub(super) fn points(&self) -> usize {
        by_law!(Cloth, &self.cloth, |sheet| sheet.points())
    }

    /// Number of history variables of the law, at all integration points.
    pub(super) fn variables(&self) -> usize {
        by_law!(Cloth, &self.cloth, |sheet| sheet.variables())
    }

    /// Bytes of its elements.
    pub(super) fn bytes(&self) -> usize {
        by_law!(Cloth, &self.cloth, |sheet| sheet.bytes())
    }

    /// History variables of its elements.
    pub(super) fn save(&self) -> FilmHistory {
        by_law!(Cloth, &self.cloth, |sheet| sheet.save())
    }

    /// Restores the history variables of its elements; `history` has as many integration points.
    pub(super) fn restore(&mut self, history: &FilmHistory) {
        by_law!(Cloth, &mut self.cloth, |sheet| sheet.restore(history));
    }

    /// Calls `show` with the corners of every element that is not deleted, counted among all nodes.
    pub fn for_each_intact(&self, mut show: impl FnMut(&[u32])) {
        let first = self.nodes.start as u32;
        by_law!(Cloth, &self.cloth, |sheet| sheet.for_each_intact(first, &mut show))
    }

    /// Gets the film ready for its forces to be added by several threads.
    pub(super) fn pulling(&mut self) -> Pulling<'_> {
        let cloth = match &mut self.cloth {
            Cloth::Fabric(sheet) => PullingCloth::Fabric(sheet.pulling()),
            Cloth::RateFabric(sheet) => PullingCloth::RateFabric(sheet.pulling()),
            Cloth::Elastic(sheet) => PullingCloth::Elastic(sheet.pulling()),
            Cloth::TensionField(sheet) => PullingCloth::TensionField(sheet.pulling()),
        };
        Pulling { cloth, nodes: self.nodes.clone() }
    }

    /// Adds the film's forces to those of its nodes, which came where they are in `dt` (s), and remembers how far it was strained.
    pub fn add_forces(&mut self, nodes: &mut Nodes, dt: f64) {
        let colours: Vec<Vec<usize>> = (0..self.colours).map(|colour| self.chunks_of(colour).collect()).collect();
        let of = self.nodes.clone();
        let Nodes { position, force, .. } = nodes;
        let forces = Forces::new(force.axes_mut().map(|axis| &mut axis[of.clone()]));
        let pulling = self.pulling();
        for chunk in colours.concat() {
            // SAFETY: there is one thread.
            unsafe { pulling.add_forces(Width::best(), chunk, position.axes(), dt, forces.own()) };
        }
    }

    /// Strains of every element, quads first.
    pub fn strains(&self, position: &Vectors) -> Vec<ElementStrain> {
        let mut out = vec![];
        strains(std::slice::from_ref(self), &ThreadPool::new(1), position.axes(), &mut out);
        out.concat()
    }

    /// Stress, thickness and fibres of every element, quads first; `position` is that of all nodes.
    pub fn details(&self, position: &Vectors) -> Vec<ElementDetail> {
        let position = position.axes().map(|axis| &axis[self.nodes.clone()]);
        by_law!(Cloth, &self.cloth, |sheet| sheet.details(&position))
    }

    /// Energies of the film alone, J.
    pub fn energy(&self, position: &Vectors) -> ElementEnergy {
        energies(std::slice::from_ref(self), &ThreadPool::new(1), position.axes())[0]
    }

    /// Bound on the squared angular frequency of any of its elements, rad²/s² (theory.md, equation 17).
    pub fn frequency_bound(&self, position: &Vectors) -> f64 {
        frequency_bounds(std::slice::from_ref(self), &ThreadPool::new(1), position.axes())[0]
    }

    /// Numbers of the chunks of one colour.
    pub(super) fn chunks_of(&self, colour: usize) -> impl Iterator<Item = usize> + '_ {
        let colours: Vec<usize> = by_law!(Cloth, &self.cloth, |sheet| sheet.chunks.iter().map(|c| c.colour).collect());
        (0..colours.len()).filter(move |chunk| colours[*chunk] == colour)
    }

    /// Deletes every element in which the last pass over the forces found a fibre past its break strain; its mass stays in the
    /// nodes. `position` is that of all nodes. Returns the number of elements and their energies.
    pub fn delete_failed(&mut self, position: [&[f64]; 3]) -> (usize, ElementEnergy) {
        let position = position.map(|axis| &axis[self.nodes.clone()]);
        by_law!(Cloth, &mut self.cloth, |sheet| sheet.delete_failed(&position))
    }

    /// Number of chunks.
    fn chunks(&self) -> usize {
        by_law!(Cloth, &self.cloth, |sheet| sheet.chunks.len())
    }
}

impl<M: MembraneLaw> Sheet<M> {
    fn points(&self) -> usize {
        let of = |chunk: &Chunk<_>| by_kind!(&chunk.elements, |blocks| blocks.count * blocks.points());
        self.chunks.iter().map(of).sum()
    }

    fn variables(&self) -> usize {
        self.points() * M::History::<LANES>::virgin().variables().count()
    }

    fn bytes(&self) -> usize {
        let of = |chunk: &Chunk<_>| by_kind!(&chunk.elements, |blocks| footprint::blocks(blocks));
        self.chunks.iter().map(of).sum()
    }

    fn save(&self) -> FilmHistory {
        let mut history = FilmHistory::default();
        self.chunks.iter().for_each(|chunk| by_kind!(&chunk.elements, |blocks| history.save(blocks)));
        history
    }

    fn restore(&mut self, history: &FilmHistory) {
        let mut reader = history.reader();
        for chunk in &mut self.chunks {
            by_kind!(&mut chunk.elements, |blocks| reader.restore(blocks));
        }
    }

    fn for_each_intact(&self, first: u32, mut show: impl FnMut(&[u32])) {
        for chunk in &self.chunks {
            by_kind!(&chunk.elements, |blocks| {
                for (b, l) in blocks.places().filter(|(b, l)| !blocks.is_deleted(*b, *l)) {
                    show(&blocks.corners[b].of(l).map(|n| first + n));
                }
            });
        }
    }

    fn pulling(&mut self) -> PullingSheet<'_, M> {
        PullingSheet { law: &self.law, chunks: Disjoint::new(&mut self.chunks) }
    }

    fn delete_failed(&mut self, position: &[&[f64]; 3]) -> (usize, ElementEnergy) {
        let mut total = (0, ElementEnergy::default());
        for chunk in self.chunks.iter_mut().filter(|chunk| chunk.failed) {
            let failed =
                by_kind!(&mut chunk.elements, |blocks| { super::failure::delete_failed(blocks, &self.law, position) });
            total.0 += failed.0;
            total.1.add(&failed.1);
        }
        total
    }

    fn details(&self, position: &[&[f64]; 3]) -> Vec<ElementDetail> {
        let of = |chunk: &Chunk<_>| by_kind!(&chunk.elements, |blocks| element::details(blocks, &self.law, position));
        self.chunks.iter().flat_map(of).collect()
    }

    fn energy(&self, chunk: usize, width: Width, position: &[&[f64]; 3]) -> ElementEnergy {
        by_kind!(&self.chunks[chunk].elements, |blocks| element::energy(width, blocks, &self.law, position))
    }

    fn frequency_bound(&self, chunk: usize, width: Width, density: f64, position: &[&[f64]; 3]) -> f64 {
        by_kind!(&self.chunks[chunk].elements, |blocks| {
            element::frequency_bound(width, blocks, &self.law, density, position)
        })
    }
}

/// A film whose forces several threads add, each those of its own chunks.
pub(super) struct Pulling<'a> {
    cloth: PullingCloth<'a>,
    nodes: Range<usize>,
}

enum PullingCloth<'a> {
    Fabric(PullingSheet<'a, Fabric>),
    RateFabric(PullingSheet<'a, Fabric<RateCurves>>),
    Elastic(PullingSheet<'a, Elastic>),
    TensionField(PullingSheet<'a, TensionField>),
}

struct PullingSheet<'a, M: MembraneLaw> {
    law: &'a M,
    chunks: Disjoint<'a, Chunk<M::History<LANES>>>,
}

impl Pulling<'_> {
    /// Adds the forces of one chunk to `force`, that of the film's own nodes; `position`, where the nodes came in `dt` (s), is
    /// that of all nodes.
    ///
    /// # Safety
    /// No other thread may be at work on this chunk.
    pub(super) unsafe fn add_forces(
        &self,
        width: Width,
        chunk: usize,
        position: [&[f64]; 3],
        dt: f64,
        force: OwnForces<'_>,
    ) {
        let position = position.map(|axis| &axis[self.nodes.clone()]);
        by_law!(PullingCloth, &self.cloth, |sheet| {
            // SAFETY: the caller keeps other threads from this chunk.
            let chunk = unsafe { sheet.chunks.at(chunk) };
            chunk.failed = by_kind!(&mut chunk.elements, |blocks| {
                element::add_forces(width, blocks, sheet.law, &position, dt, force)
            });
        });
    }

    /// Which of all nodes are this film's.
    pub(super) fn nodes(&self) -> Range<usize> {
        self.nodes.clone()
    }
}

/// Energies of each film, J; `position` is that of all nodes.
pub(super) fn energies(films: &[Film], pool: &ThreadPool, position: [&[f64]; 3]) -> Vec<ElementEnergy> {
    let mut totals = vec![ElementEnergy::default(); films.len()];
    let parts = survey(films, pool, |film, chunk| {
        let film = &films[film];
        let position = position.map(|axis| &axis[film.nodes.clone()]);
        by_law!(Cloth, &film.cloth, |sheet| sheet.energy(chunk, pool.width(), &position))
    });
    parts.iter().for_each(|(film, energy)| totals[*film].add(energy));
    totals
}

/// Bound on the squared angular frequency of any element of each film, rad²/s².
pub(super) fn frequency_bounds(films: &[Film], pool: &ThreadPool, position: [&[f64]; 3]) -> Vec<f64> {
    let mut largest = vec![0.0_f64; films.len()];
    let parts = survey(films, pool, |film, chunk| {
        let film = &films[film];
        let position = position.map(|axis| &axis[film.nodes.clone()]);
        by_law!(Cloth, &film.cloth, |sheet| sheet.frequency_bound(chunk, pool.width(), film.density, &position))
    });
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
    survey(films, pool, |film, chunk| {
        let position = position.map(|axis| &axis[films[film].nodes.clone()]);
        by_law!(Cloth, &films[film].cloth, |sheet| {
            let chunk = &sheet.chunks[chunk];
            // SAFETY: every chunk writes its own elements alone.
            let own = unsafe { faces[film].range(chunk.first..chunk.first + chunk.count()) };
            by_kind!(&chunk.elements, |blocks| element::strains(pool.width(), blocks, &position, own))
        });
    });
}

/// What `work` says of every chunk, given by the number of its film and its own, with the number of its film, in order.
fn survey<T: Clone + Default + Send>(
    films: &[Film],
    pool: &ThreadPool,
    work: impl Fn(usize, usize) -> T + Sync,
) -> Vec<(usize, T)> {
    let chunks: Vec<(usize, usize)> =
        films.iter().enumerate().flat_map(|(f, film)| (0..film.chunks()).map(move |chunk| (f, chunk))).collect();
    let mut out: Vec<(usize, T)> = chunks.iter().map(|(f, _)| (*f, T::default())).collect();
    let answers = Disjoint::new(&mut out);
    pool.each(chunks.len(), |part| {
        let (film, chunk) = chunks[part];
        let answer = work(film, chunk);
        // SAFETY: every part comes up once.
        unsafe { answers.at(part).1 = answer };
    });
    out
}

impl<P: History<LANES>> Chunk<P> {
    fn count(&self) -> usize {
        by_kind!(&self.elements, |blocks| blocks.count)
    }

    fn for_each_node(&self, mut show: impl FnMut(usize)) {
        by_kind!(&self.elements, |blocks| {
            for (b, l) in blocks.places() {
                blocks.corners[b].of(l).iter().for_each(|n| show(*n as usize));
            }
        });
    }
}

/// A film while its elements are made.
struct Mount<'a> {
    mesh: &'a Mesh,
    stress_free: StressFree,
    /// Whether quads are integrated in full.
    full: bool,
    thickness: f64,
    density: f64,
    masses: Vec<f64>,
}

impl Mount<'_> {
    /// The elements with their law, and the number of colours of their chunks; adds their mass to their nodes.
    fn sheet<M: MembraneLaw + Clone>(&mut self, law: &M) -> Result<(Sheet<M>, usize), UndefinedFibreDirection> {
        let mut chunks = vec![];
        if self.full {
            self.add(&self.mesh.quads, Elements::FullQuads, &mut chunks)?;
        } else {
            self.add(&self.mesh.quads, Elements::Quads, &mut chunks)?;
        }
        self.add(&self.mesh.tris, Elements::Tris, &mut chunks)?;
        let colours = colour(&mut chunks, self.mesh.nodes.len());
        Ok((Sheet { law: law.clone(), chunks }, colours))
    }

    /// Adds elements of one kind, and their mass to their nodes.
    fn add<B, P: History<LANES>, const NODES: usize>(
        &mut self,
        nodes: &[[u32; NODES]],
        kind: impl Fn(Blocks<B, NODES>) -> Elements<P>,
        chunks: &mut Vec<Chunk<P>>,
    ) -> Result<(), UndefinedFibreDirection>
    where
        B: Block<NODES, LANES>,
        B::Element: Shaped<NODES>,
    {
        let blocks = nodes.len().div_ceil(LANES);
        let size = LANES * blocks.div_ceil(CHUNKS).clamp(BLOCKS[0], BLOCKS[1]);
        for nodes in nodes.chunks(size) {
            let elements: Vec<B::Element> = element::shaped(nodes, &self.mesh.nodes, &self.stress_free)?;
            for (nodes, element) in nodes.iter().zip(&elements) {
                let share = self.density * self.thickness * element.area() / NODES as f64;
                nodes.iter().for_each(|n| self.masses[*n as usize] += share);
            }
            let first = chunks.last().map_or(0, |chunk| chunk.first + chunk.count());
            let elements = kind(Blocks::new(nodes, &elements, self.thickness));
            chunks.push(Chunk { elements, colour: 0, first, failed: false });
        }
        Ok(())
    }
}

/// Gives every chunk the first colour that no earlier chunk with a node in common has; returns the number of colours.
fn colour<P: History<LANES>>(chunks: &mut [Chunk<P>], nodes: usize) -> usize {
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
