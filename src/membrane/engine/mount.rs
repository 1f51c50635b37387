//! Mounting: the elements of a film from a mesh.

use std::sync::Arc;

use super::element::{self, Block, Blocks, FullQuads, Quads, Shaped, StressFree, Tris, UndefinedFibreDirection};
use super::element_group::{ElementGroup, Grouped};
use super::film::Film;
use super::mesh::Mesh;
use super::nodes::Nodes;
use super::section::Section;
use super::tips::MirrorPlane;
use crate::lane::LANES;
use crate::material::{LawVisitor, MembraneLaw, ViscousLaw};

/// Number of chunks of a film, where these stay within [`BLOCKS`].
const CHUNKS: usize = 12;

/// Bounds on the blocks of a chunk.
const BLOCKS: [usize; 2] = [4, 64];

impl Film {
    /// The elements of `mesh` with the properties of `section`; appends the nodes of the mesh, lifted by `height` (m),
    /// to `nodes`.
    ///
    /// # Errors
    /// MD is perpendicular to an element.
    ///
    /// # Panics
    /// Where a Prony series is on a law that cannot have one ([`crate::material::Law::viscous`]).
    pub fn mount(
        mesh: &Mesh,
        section: &Section,
        height: f64,
        nodes: &mut Nodes,
    ) -> Result<Film, UndefinedFibreDirection> {
        let stress_free = StressFree::new(section.md_angle, section.prestrain);
        let mount = Mount { mesh, section, stress_free, masses: vec![0.0; mesh.nodes.len()], groups: vec![] };
        let Mount { masses, groups, .. } = section.law.visit(mount)?;
        let first = nodes.position.len();
        nodes.extend(mesh.nodes.iter().map(|p| [p.x, p.y, p.z + height]), &masses);
        let (sin, cos) = section.md_angle.sin_cos();
        let [x, y] = mesh.mirrors.clone();
        // x and y along MD and TD.
        let mirrors = [MirrorPlane { nodes: x, normal: [cos, -sin] }, MirrorPlane { nodes: y, normal: [sin, cos] }];
        Ok(Film::new(groups, [section.density, section.thickness], first..nodes.position.len(), mirrors))
    }
}

/// A film while its elements are built.
struct Mount<'a> {
    mesh: &'a Mesh,
    section: &'a Section,
    stress_free: StressFree,
    /// Of the nodes so far, kg.
    masses: Vec<f64>,
    /// The elements so far.
    groups: Vec<Box<dyn ElementGroup>>,
}

impl LawVisitor for Mount<'_> {
    type Output = Result<Self, UndefinedFibreDirection>;

    fn visit<M: MembraneLaw + Clone + Send + Sync + 'static>(mut self, law: &M) -> Self::Output {
        let law = Arc::new(law.clone());
        if self.section.full_integration {
            self.add(&self.mesh.quads, |blocks: FullQuads<LANES, _>| M::group(Arc::clone(&law), blocks))?;
        } else {
            self.add(&self.mesh.quads, |blocks: Quads<LANES, _>| M::group(Arc::clone(&law), blocks))?;
        }
        self.add(&self.mesh.tris, |blocks: Tris<LANES, _>| M::group(Arc::clone(&law), blocks))?;
        Ok(self)
    }
}

impl Mount<'_> {
    /// Adds elements of one kind in groups, and their mass to their nodes.
    fn add<B, const NODES: usize>(
        &mut self,
        nodes: &[[u32; NODES]],
        group: impl Fn(Blocks<B, NODES>) -> Box<dyn ElementGroup>,
    ) -> Result<(), UndefinedFibreDirection>
    where
        B: Block<NODES, LANES>,
        B::Element: Shaped<NODES>,
    {
        let Section { density, thickness, law, viscosity, rupture, thermal, .. } = self.section;
        let (density, thickness) = (*density, *thickness);
        let viscous = viscosity.as_ref().map(|viscosity| {
            let base = law.viscous().expect("laws of viscous film are checked");
            ViscousLaw::new(viscosity.clone(), base)
        });
        let blocks = nodes.len().div_ceil(LANES);
        // From the mesh alone, never from the number of threads: chunks decide the order of sums.
        let size = LANES * blocks.div_ceil(CHUNKS).clamp(BLOCKS[0], BLOCKS[1]);
        for nodes in nodes.chunks(size) {
            let elements: Vec<B::Element> = element::shaped(nodes, &self.mesh.nodes, &self.stress_free)?;
            for (nodes, element) in nodes.iter().zip(&elements) {
                // Equal shares by the area of stress-free film, also of distorted elements: equation 17 relies on equal
                // masses.
                let share = density * thickness * element.area() / NODES as f64;
                nodes.iter().for_each(|n| self.masses[*n as usize] += share);
            }
            let blocks = Blocks::new(nodes, &elements, thickness);
            let blocks = match &viscous {
                Some(law) => blocks.with_viscosity(law.clone()),
                None => blocks,
            };
            let blocks = match thermal {
                Some(thermal) => blocks.with_heating(*thermal),
                None => blocks,
            };
            self.groups.push(group(match *rupture {
                Some(rupture) => blocks.with_rupture(rupture),
                None => blocks,
            }));
        }
        Ok(())
    }
}
