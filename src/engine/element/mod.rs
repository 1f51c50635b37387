//! Membrane elements: deformation at their integration points and the nodal forces that follow.
//!
//! Elements of one kind stand in blocks of [`crate::lane::LANES`]. A step runs over the blocks as gather → kernel → scatter.

mod block;
mod bounds;
mod hourglass;
mod kernel;
mod quad4;
mod reference;
mod tri3;

pub use block::{Blocks, Point};
pub use kernel::ElementEnergy;
pub use reference::{StressFree, UprightElement};

pub(super) use bounds::frequency_bound;
pub(super) use kernel::{add_forces, deformations, energies};

use nalgebra::Point3;

use block::Element;

/// Elements of a mesh's quads with one integration point.
pub(crate) fn quads(
    quads: &[[u32; 4]],
    nodes: &[Point3<f64>],
    film: &StressFree,
) -> Result<Vec<Element<4, 1>>, UprightElement> {
    quads.iter().map(|&q| Ok(quad4::one_point(q, film.reference(q, nodes)?))).collect()
}

/// Elements of a mesh's quads with 2×2 integration points.
pub(crate) fn full_quads(
    quads: &[[u32; 4]],
    nodes: &[Point3<f64>],
    film: &StressFree,
) -> Result<Vec<Element<4, 4>>, UprightElement> {
    quads.iter().map(|&q| Ok(quad4::four_points(q, film.reference(q, nodes)?))).collect()
}

/// Elements of a mesh's triangles.
pub(crate) fn tris(
    tris: &[[u32; 3]],
    nodes: &[Point3<f64>],
    film: &StressFree,
) -> Result<Vec<Element<3, 1>>, UprightElement> {
    tris.iter().map(|&t| Ok(tri3::constant_strain(t, film.reference(t, nodes)?))).collect()
}
