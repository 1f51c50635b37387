//! Films from meshes: nodes and elements of a face, the section that its elements are made of, and their mounting.

use std::sync::Arc;

use nalgebra::Point3;

use super::element::{
    self, Block, ElementGroup, Elements, Forces, FullQuads, Grouped, Quads, Shaped, StressFree, Tris,
    UndefinedFibreDirection,
};
use super::film::Film;
use super::nodes::{Nodes, Vectors};
use super::tips::MirrorPlane;
use crate::lane::{LANES, Width};
use crate::material::{Law, LawVisitor, MembraneLaw, Rupture, Thermal, Viscosity, ViscousLaw};

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
        let first = nodes.position.len() as u32;
        let mount = Mount { mesh, first, section, stress_free, masses: vec![0.0; mesh.nodes.len()], groups: vec![] };
        let Mount { masses, groups, .. } = section.law.visit(mount)?;
        nodes.extend(mesh.nodes.iter().map(|p| [p.x, p.y, p.z + height]), &masses);
        let (sin, cos) = section.md_angle.sin_cos();
        let plane = |axis: usize, normal| {
            // x and y along MD and TD.
            MirrorPlane { nodes: mesh.mirrors[axis].iter().map(|node| first + node).collect(), normal }
        };
        let mirrors = [plane(0, [cos, -sin]), plane(1, [sin, cos])];
        let (law, density) = (section.law.properties(), section.density_with_air());
        let mut film =
            Film::new(groups, law, [density, section.thickness], first as usize..nodes.position.len(), mirrors);
        film.weight_share = section.density / density;
        Ok(film)
    }
}

/// A film while its elements are built.
struct Mount<'a> {
    mesh: &'a Mesh,
    /// Number of its first node among all.
    first: u32,
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
            self.add(&law, &self.mesh.quads, |elements: FullQuads<M>| M::group(elements))?;
        } else {
            self.add(&law, &self.mesh.quads, |elements: Quads<M>| M::group(elements))?;
        }
        self.add(&law, &self.mesh.tris, |elements: Tris<M>| M::group(elements))?;
        Ok(self)
    }
}

impl Mount<'_> {
    /// Adds elements of one kind in groups, and their mass to their nodes.
    fn add<M: MembraneLaw, B, const NODES: usize>(
        &mut self,
        law: &Arc<M>,
        nodes: &[[u32; NODES]],
        group: impl Fn(Elements<M, B, NODES>) -> Box<dyn ElementGroup>,
    ) -> Result<(), UndefinedFibreDirection>
    where
        B: Block<M, NODES, LANES>,
        B::Element: Shaped<NODES>,
    {
        let Section { thickness, viscosity, rupture, thermal, .. } = self.section;
        let (density, thickness) = (self.section.density_with_air(), *thickness);
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
            let nodes: Vec<[u32; NODES]> = nodes.iter().map(|nodes| nodes.map(|node| self.first + node)).collect();
            let mut elements = Elements::new(Arc::clone(law), &nodes, &elements, thickness);
            if let Some(law) = &viscous {
                elements = elements.with_viscosity(law.clone());
            }
            if let Some(thermal) = thermal {
                elements = elements.with_heating(*thermal);
            }
            if let Some(rupture) = rupture {
                elements = elements.with_rupture(*rupture);
            }
            self.groups.push(group(elements));
        }
        Ok(())
    }
}

/// Properties of the elements of a face, which act as one membrane.
#[derive(Clone, Debug)]
pub struct Section {
    /// Constitutive law of one layer.
    pub law: Law,
    /// Prony series on the law, where film is viscous.
    pub viscosity: Option<Viscosity>,
    /// Rupture by a criterion of its own; without it fibres break at the end of their curves, and other film does not.
    pub rupture: Option<Rupture>,
    /// How film warms up by what it absorbs; without it film keeps its temperature.
    pub thermal: Option<Thermal>,
    /// kg/m³, with mass scaling.
    pub density: f64,
    /// Mass of air per area of stress-free film that moves with it and has no weight, kg/m².
    pub air: f64,
    /// Thickness of all layers, m.
    pub thickness: f64,
    /// Angle from the x axis to MD, rad.
    pub md_angle: f64,
    /// Engineering pre-strain along MD and TD: the stress-free length is the mounted one / (1 + pre-strain).
    pub prestrain: [f64; 2],
    /// Whether quadrilaterals have 2×2 integration points instead of one with hourglass control.
    pub full_integration: bool,
}

impl Section {
    /// Film without pre-strain, MD along x, of a law that does nothing besides it; one integration point an element.
    pub fn new(law: Law, density: f64, thickness: f64) -> Section {
        Section {
            law,
            viscosity: None,
            rupture: None,
            thermal: None,
            density,
            air: 0.0,
            thickness,
            md_angle: 0.0,
            prestrain: [0.0; 2],
            full_integration: false,
        }
    }

    /// Density with the air, kg/m³: spread over the thickness its inertia needs no term of its own.
    fn density_with_air(&self) -> f64 {
        self.density + self.air / self.thickness
    }
}

/// Nodes and elements of one face, flat or as imported, before any motion.
#[derive(Clone, Debug, Default)]
pub struct Mesh {
    /// Positions, m.
    pub nodes: Vec<Point3<f64>>,
    /// Four-node elements, counter-clockwise seen from +z.
    pub quads: Vec<[u32; 4]>,
    /// Three-node elements, counter-clockwise seen from +z.
    pub tris: Vec<[u32; 3]>,
    /// Nodes on the film's own outer edge (not on a mirror plane), each once, ascending.
    pub rim: Vec<u32>,
    /// Nodes on the edges x-, x+, y-, y+ of the film, each once, ascending in this order.
    pub sides: [Vec<u32>; 4],
    /// Nodes on the mirror planes x = 0 and y = 0; empty without that symmetry.
    pub mirrors: [Vec<u32>; 2],
}

/// The one-point quadrilaterals of a mesh with a law, `L` at once; `L` = 1 is the scalar kernel, element by element.
/// The law need not be one of [`crate::material::Law`].
pub struct Patch<M: MembraneLaw, const L: usize>(Quads<M, L>);

impl<M: MembraneLaw, const L: usize> Patch<M, L> {
    /// The quadrilaterals of `mesh`, `thickness` (m) thick in the configuration that `stress_free` relates to that of
    /// the mesh.
    ///
    /// # Errors
    /// The fibre direction is undefined in an element.
    pub fn new(
        law: M,
        mesh: &Mesh,
        stress_free: &StressFree,
        thickness: f64,
    ) -> Result<Patch<M, L>, UndefinedFibreDirection> {
        let elements = element::shaped(&mesh.quads, &mesh.nodes, stress_free)?;
        Ok(Patch(Quads::new(Arc::new(law), &mesh.quads, &elements, thickness)))
    }

    /// These elements, of viscous film.
    ///
    /// # Panics
    /// Where the law cannot have a Prony series ([`MembraneLaw::viscous`]).
    pub fn with_viscosity(self, viscosity: Viscosity) -> Patch<M, L> {
        let base = self.0.law().viscous().expect("a law that can have a Prony series");
        Patch(self.0.with_viscosity(ViscousLaw::new(viscosity, base)))
    }

    /// Adds the forces (N) at `position` (m), reached `dt` (s) after the position before, to `force`, with the vector
    /// instructions `width`.
    pub fn add_forces(&mut self, width: Width, position: &Vectors, dt: f64, force: &mut Vectors) {
        let forces = Forces::new(force.axes_mut());
        // SAFETY: there is one thread.
        let own = unsafe { forces.own() };
        element::add_forces(width, &mut self.0, &position.axes(), dt, own);
    }
}
