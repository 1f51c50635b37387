//! Quadrilaterals in blocks of any number of lanes: what one kernel costs and gives at each.

use super::element::{self, Forces, Quads, StressFree, UprightElement};
use super::nodes::Vectors;
use crate::lane::Width;
use crate::material::Law;
use crate::mesh::Mesh;
use crate::model::Face;

/// The one-point quadrilaterals of a mesh, `L` at once. `Patch<1>` is the plain scalar kernel, element by element.
pub struct Patch<const L: usize> {
    law: Law,
    quads: Quads<L>,
}

impl<const L: usize> Patch<L> {
    /// The quadrilaterals of `mesh` as film of `face`.
    ///
    /// # Errors
    /// MD has no direction in an element.
    pub fn new(mesh: &Mesh, face: &Face) -> Result<Patch<L>, UprightElement> {
        let stress_free = StressFree::new(face.md_angle, face.prestrain);
        let elements = element::shaped(&mesh.quads, &mesh.nodes, &stress_free)?;
        let thickness = face.material.thickness * f64::from(face.layers);
        Ok(Patch { law: face.material.law.clone(), quads: Quads::new(&mesh.quads, &elements, thickness) })
    }

    /// Adds the forces on nodes at `position` to `force`, with the given vector instructions.
    pub fn add_forces(&mut self, width: Width, position: &Vectors, force: &mut Vectors) {
        let forces = Forces::new(force.axes_mut());
        // SAFETY: there is one thread.
        let own = unsafe { forces.own() };
        match &self.law {
            Law::Fabric(law) => element::add_forces(width, &mut self.quads, law, &position.axes(), own),
            Law::Elastic(law) => element::add_forces(width, &mut self.quads, law, &position.axes(), own),
            Law::TensionField(law) => element::add_forces(width, &mut self.quads, law, &position.axes(), own),
        };
    }
}
