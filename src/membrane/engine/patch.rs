//! Elements of one law without time integration: single elements, and the kernel at each number of lanes.

use super::element::{self, Forces, Quads, StressFree, UndefinedFibreDirection};
use super::mesh::Mesh;
use super::nodes::Vectors;
use crate::lane::Width;
use crate::material::{MembraneLaw, Viscosity, ViscousLaw};

/// The one-point quadrilaterals of a mesh with a law, `L` at once; `L` = 1 is the scalar kernel, element by element.
/// The law need not be one of [`crate::material::Law`].
pub struct Patch<M: MembraneLaw, const L: usize> {
    law: M,
    quads: Quads<L, M::History<L>>,
}

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
        Ok(Patch { law, quads: Quads::new(&mesh.quads, &elements, thickness) })
    }

    /// These elements, of viscous film.
    ///
    /// # Panics
    /// Where the law cannot have a Prony series ([`MembraneLaw::viscous`]).
    pub fn with_viscosity(self, viscosity: Viscosity) -> Patch<M, L> {
        let base = self.law.viscous().expect("a law that can have a Prony series");
        Patch { quads: self.quads.with_viscosity(ViscousLaw::new(viscosity, base)), law: self.law }
    }

    /// Adds the forces (N) at `position` (m), reached `dt` (s) after the position before, to `force`, with the vector
    /// instructions `width`.
    pub fn add_forces(&mut self, width: Width, position: &Vectors, dt: f64, force: &mut Vectors) {
        let forces = Forces::new(force.axes_mut());
        // SAFETY: there is one thread.
        let own = unsafe { forces.own() };
        element::add_forces(width, &mut self.quads, &self.law, &position.axes(), dt, own);
    }
}
