//! Quadrilaterals in blocks of any number of lanes: what one kernel costs and gives at each.

use super::element::{self, Forces, OnePointElement, Quads, StressFree, UndefinedFibreDirection};
use super::nodes::Vectors;
use crate::lane::Width;
use crate::material::{Elastic, Fabric, Law, MembraneLaw, RateCurves, TensionField};
use crate::mesh::Mesh;
use crate::model::Face;

/// The one-point quadrilaterals of a mesh, `L` at once. `Patch<1>` is the plain scalar kernel, element by element.
pub struct Patch<const L: usize>(Cloth<L>);

/// Elements with their law.
struct Sheet<M: MembraneLaw, const L: usize>(M, Quads<L, M::History<L>>);

enum Cloth<const L: usize> {
    Fabric(Sheet<Fabric, L>),
    RateFabric(Sheet<Fabric<RateCurves>, L>),
    Elastic(Sheet<Elastic, L>),
    TensionField(Sheet<TensionField, L>),
}

impl<const L: usize> Patch<L> {
    /// The quadrilaterals of `mesh` as film of `face`.
    ///
    /// # Errors
    /// MD has no direction in an element.
    pub fn new(mesh: &Mesh, face: &Face) -> Result<Patch<L>, UndefinedFibreDirection> {
        let stress_free = StressFree::new(face.md_angle, face.prestrain);
        let elements = element::shaped(&mesh.quads, &mesh.nodes, &stress_free)?;
        let thickness = face.material.thickness * f64::from(face.layers);
        fn sheet<M: MembraneLaw + Clone, const L: usize>(
            law: &M,
            mesh: &Mesh,
            elements: &[OnePointElement],
            thickness: f64,
        ) -> Sheet<M, L> {
            Sheet(law.clone(), Quads::new(&mesh.quads, elements, thickness))
        }
        Ok(Patch(match &face.material.law {
            Law::Fabric(law) => Cloth::Fabric(sheet(law, mesh, &elements, thickness)),
            Law::RateFabric(law) => Cloth::RateFabric(sheet(law, mesh, &elements, thickness)),
            Law::Elastic(law) => Cloth::Elastic(sheet(law, mesh, &elements, thickness)),
            Law::TensionField(law) => Cloth::TensionField(sheet(law, mesh, &elements, thickness)),
        }))
    }

    /// Adds the forces on nodes that came to `position` in `dt` (s) to `force`, with the given vector instructions.
    pub fn add_forces(&mut self, width: Width, position: &Vectors, dt: f64, force: &mut Vectors) {
        let forces = Forces::new(force.axes_mut());
        // SAFETY: there is one thread.
        let own = unsafe { forces.own() };
        match &mut self.0 {
            Cloth::Fabric(Sheet(law, quads)) => element::add_forces(width, quads, law, &position.axes(), dt, own),
            Cloth::RateFabric(Sheet(law, quads)) => element::add_forces(width, quads, law, &position.axes(), dt, own),
            Cloth::Elastic(Sheet(law, quads)) => element::add_forces(width, quads, law, &position.axes(), dt, own),
            Cloth::TensionField(Sheet(law, quads)) => element::add_forces(width, quads, law, &position.axes(), dt, own),
        };
    }
}
