//! Membrane elements: deformation at their integration points and the nodal forces that follow.
//!
//! Elements of one kind are stored in blocks of [`crate::lane::LANES`]. A step runs over the blocks as gather → kernel
//! → scatter.

mod block;
mod elements;
mod gauss;
mod group;
mod heating;
mod kernel;
mod mean_state;
mod one_point;
mod shape;
mod tearing;
mod viscous;

pub(crate) use block::Block;
pub(crate) use elements::{Common, Elements, place};
pub(crate) use group::{ElementGroup, Grouped};
pub use kernel::{ElementDetail, ElementEnergy, ElementStrain};
pub(crate) use kernel::{Forces, OwnForces, add_forces};
pub(super) use mean_state::{MeanState, corners};
pub(crate) use shape::{Shaped, shaped};
pub use shape::{StressFree, UndefinedFibreDirection};
pub(crate) use tearing::Tearing;
pub use tearing::{TooWide, Torn};

use crate::lane::LANES;
use crate::material::MembraneLaw;
use gauss::Gauss;
use one_point::OnePoint;

/// Quadrilaterals with one integration point.
pub(crate) type Quads<M, const L: usize = LANES> = Elements<M, OnePoint<L, <M as MembraneLaw>::History<L>>, 4, L>;
/// Quadrilaterals with 2×2 integration points.
pub(crate) type FullQuads<M> = Elements<M, Gauss<4, 4, LANES, <M as MembraneLaw>::History<LANES>>, 4>;
/// Triangles.
pub(crate) type Tris<M> = Elements<M, Gauss<3, 1, LANES, <M as MembraneLaw>::History<LANES>>, 3>;
