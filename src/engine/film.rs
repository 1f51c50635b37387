//! One face of film: its elements, its law, its share of the nodes.

use std::ops::Range;

use super::element::{self, Blocks, ElementEnergy, StressFree, UprightElement};
use super::footprint;
use super::memory::Memory;
use super::nodes::Nodes;
use crate::lane::{LANES, splat};
use crate::material::{Law, strains};
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
    pub nodes: Range<usize>,
    quads: Blocks<4, 1>,
    full_quads: Blocks<4, 4>,
    tris: Blocks<3, 1>,
}

/// Strains of one element, averaged over its integration points.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ElementStrain {
    /// Engineering strain along MD and TD, shear angle (rad).
    pub strain: [f64; 3],
    /// Largest MD and TD strain so far.
    pub peak: [f64; 2],
    /// Volume of stress-free film, m³; zero once broken.
    pub volume: f64,
}

/// Runs `$body` with `$blocks` bound to each kind of element and `$law` to the concrete law.
macro_rules! each_kind {
    ($film:expr, $law:ident, $blocks:ident, $body:expr) => {
        match &$film.law {
            Law::Fabric($law) => each_kind!(@kinds $film, $blocks, $body),
            Law::Elastic($law) => each_kind!(@kinds $film, $blocks, $body),
        }
    };
    (@kinds $film:expr, $blocks:ident, $body:expr) => {{
        { let $blocks = &$film.quads; $body }
        { let $blocks = &$film.full_quads; $body }
        { let $blocks = &$film.tris; $body }
    }};
}

impl Film {
    /// The elements of `mesh` as film of `face`; appends the face's nodes, lifted to its height, to `nodes`.
    /// `mass_scaling` multiplies the density.
    pub fn mount(mesh: &Mesh, face: &Face, mass_scaling: f64, nodes: &mut Nodes) -> Result<Film, UprightElement> {
        let stress_free = StressFree::new(face.md_angle, face.prestrain);
        let thickness = face.material.thickness * f64::from(face.layers);
        let density = face.material.density * mass_scaling;
        let first = nodes.position.len();
        let one_point = face.meshing.element != model::Element::Quad4Full;
        let (reduced, full): (&[_], &[_]) = if one_point { (&mesh.quads, &[]) } else { (&[], &mesh.quads) };

        let quads = element::quads(reduced, &mesh.nodes, &stress_free)?;
        let full_quads = element::full_quads(full, &mesh.nodes, &stress_free)?;
        let tris = element::tris(&mesh.tris, &mesh.nodes, &stress_free)?;

        let mut masses = vec![0.0; mesh.nodes.len()];
        let mut lump = |element_nodes: &[u32], area: f64| {
            let share = density * thickness * area / element_nodes.len() as f64;
            element_nodes.iter().for_each(|n| masses[*n as usize] += share);
        };
        reduced.iter().zip(&quads).for_each(|(n, e)| lump(n, e.area()));
        full.iter().zip(&full_quads).for_each(|(n, e)| lump(n, e.area()));
        mesh.tris.iter().zip(&tris).for_each(|(n, e)| lump(n, e.area()));

        nodes.extend(mesh.nodes.iter().map(|p| [p.x, p.y, p.z + face.height]), &masses);
        Ok(Film {
            law: face.material.law.clone(),
            density,
            thickness,
            nodes: first..nodes.position.len(),
            quads: Blocks::new(&quads, thickness),
            full_quads: Blocks::new(&full_quads, thickness),
            tris: Blocks::new(&tris, thickness),
        })
    }

    /// Number of elements.
    pub fn elements(&self) -> usize {
        self.quads.count + self.full_quads.count + self.tris.count
    }

    /// Number of integration points.
    pub fn points(&self) -> usize {
        self.quads.count + 4 * self.full_quads.count + self.tris.count
    }

    /// Bytes of its elements.
    pub fn bytes(&self) -> usize {
        footprint::blocks(&self.quads) + footprint::blocks(&self.full_quads) + footprint::blocks(&self.tris)
    }

    /// What its elements remember.
    pub fn memory(&self) -> Memory {
        let mut memory = Memory::default();
        memory.note(&self.quads);
        memory.note(&self.full_quads);
        memory.note(&self.tris);
        memory
    }

    /// Lets its elements remember what they did when `memory`, of as many integration points, was taken.
    pub fn recall(&mut self, memory: &Memory) {
        let mut next = 0;
        memory.recall(&mut next, &mut self.quads);
        memory.recall(&mut next, &mut self.full_quads);
        memory.recall(&mut next, &mut self.tris);
    }

    /// Shows the corners of every element that has not broken, counted among all nodes.
    pub fn for_each_intact(&self, mut show: impl FnMut(&[u32])) {
        let first = self.nodes.start as u32;
        each_kind!(self, _law, blocks, {
            for (b, l) in blocks.places().filter(|(b, l)| !blocks.is_broken(*b, *l)) {
                show(&blocks.nodes_at(b, l).map(|n| first + n));
            }
        });
    }

    /// Adds the film's forces to `force`, that of its own nodes; `position` is that of all nodes.
    /// True if a fibre somewhere is past its break strain.
    pub fn add_forces(&mut self, position: &[[f64; 3]], force: &mut [[f64; 3]]) -> bool {
        let position = &position[self.nodes.clone()];
        match &self.law {
            Law::Fabric(law) => {
                element::add_forces(&mut self.quads, law, position, force)
                    | element::add_forces(&mut self.full_quads, law, position, force)
                    | element::add_forces(&mut self.tris, law, position, force)
            }
            Law::Elastic(law) => {
                element::add_forces(&mut self.quads, law, position, force)
                    | element::add_forces(&mut self.full_quads, law, position, force)
                    | element::add_forces(&mut self.tris, law, position, force)
            }
        }
    }

    /// Takes the force from every element with a fibre past its break strain; its mass stays.
    /// Returns the number of elements broken and the energies they held.
    pub fn break_elements(&mut self, position: &[[f64; 3]]) -> (usize, ElementEnergy) {
        let position = &position[self.nodes.clone()];
        match &self.law {
            Law::Fabric(law) => super::failure::sum([
                super::failure::break_elements(&mut self.quads, law, position),
                super::failure::break_elements(&mut self.full_quads, law, position),
                super::failure::break_elements(&mut self.tris, law, position),
            ]),
            Law::Elastic(_) => (0, ElementEnergy::default()),
        }
    }

    /// Energies of all elements, J.
    pub fn energy(&self, position: &[[f64; 3]]) -> ElementEnergy {
        let position = &position[self.nodes.clone()];
        let mut total = ElementEnergy::default();
        each_kind!(self, law, blocks, {
            for block in 0..blocks.nodes.len() {
                for energy in element::energies(blocks, block, law, position) {
                    total.stored += energy.stored;
                    total.absorbed += energy.absorbed;
                    total.hourglass += energy.hourglass;
                }
            }
        });
        total
    }

    /// Bound on the squared angular frequency of any element, rad²/s².
    pub fn frequency_bound(&self, position: &[[f64; 3]]) -> f64 {
        let position = &position[self.nodes.clone()];
        let mut largest = 0.0_f64;
        each_kind!(self, law, blocks, {
            let squared = element::frequency_bound(blocks, law, self.density, position);
            largest = if squared <= largest || largest.is_nan() { largest } else { squared };
        });
        largest
    }

    /// Strains of every element, quads first.
    pub fn strains(&self, position: &[[f64; 3]]) -> Vec<ElementStrain> {
        let position = &position[self.nodes.clone()];
        let mut out = Vec::with_capacity(self.elements());
        each_kind!(self, _law, blocks, {
            for block in 0..blocks.nodes.len() {
                let used = (blocks.count - block * LANES).min(LANES);
                out.extend_from_slice(&block_strains(blocks, block, position)[..used]);
            }
        });
        out
    }
}

fn block_strains<const NODES: usize, const POINTS: usize>(
    blocks: &Blocks<NODES, POINTS>,
    block: usize,
    position: &[[f64; 3]],
) -> [ElementStrain; LANES] {
    let mut out = [ElementStrain::default(); LANES];
    let mut sum = [splat(0.0); 3];
    for (point, d) in blocks.points[block].iter().zip(element::deformations(blocks, block, position)) {
        let s = strains(&d);
        for l in 0..LANES {
            for (total, value) in sum.iter_mut().zip([s.md[l], s.td[l], s.shear[l]]) {
                total[l] += value / POINTS as f64;
            }
            for fibre in 0..2 {
                out[l].peak[fibre] = out[l].peak[fibre].max(point.peaks[fibre][l]);
            }
            out[l].volume += point.volume[l];
        }
    }
    for l in 0..LANES {
        out[l].strain = [sum[0][l], sum[1][l], sum[2][l]];
    }
    out
}
