//! Membrane elements: deformation at their integration points and the nodal forces that follow.
//!
//! Elements of one kind are stored in blocks of [`crate::lane::LANES`]. A step runs over the blocks as gather → kernel
//! → scatter.

mod block;
mod energy;
mod gauss;
mod heating;
mod kernel;
mod mean_state;
mod one_point;
mod quad4;
mod reference;
mod softening;
mod tearing;
mod tri3;
mod viscous;
mod warming;

pub(crate) use block::{Block, Blocks};
pub use energy::ElementEnergy;
pub(crate) use gauss::Gauss;
pub(crate) use heating::Heating;
pub use kernel::{ElementDetail, ElementStrain};
pub(crate) use kernel::{Forces, OwnForces};
pub(super) use kernel::{add_forces, add_mass, count_mounting, details, energy, energy_at, frequency_bound, strains};
pub(super) use mean_state::{MeanState, corners, mean_state};
pub(crate) use one_point::OnePoint;
pub(super) use one_point::OnePointElement;
pub use reference::{StressFree, UndefinedFibreDirection};
pub(super) use softening::tear;
pub(crate) use tearing::Tearing;
pub use tearing::{TooWide, Torn};
pub(crate) use viscous::ViscousPoints;
pub(super) use warming::{restart_after_break, warm_up};

use nalgebra::Point3;

use crate::lane::{LANES, Lane};
use crate::material::{History, MembraneLaw, PeakStrains};
use gauss::GaussElement;

/// Quadrilaterals with one integration point and its history variables `P`.
pub(crate) type Quads<const L: usize = LANES, P = PeakStrains<L>> = Blocks<OnePoint<L, P>, 4, L>;
/// Quadrilaterals with 2×2 integration points.
pub(crate) type FullQuads<const L: usize = LANES, P = PeakStrains<L>> = Blocks<Gauss<4, 4, L, P>, 4, L>;
/// Triangles.
pub(crate) type Tris<const L: usize = LANES, P = PeakStrains<L>> = Blocks<Gauss<3, 1, L, P>, 3, L>;

/// Share of the layers whose MD and TD fibres are not broken at the point with `history` in a lane, at its present
/// largest strains.
fn layers_left<M: MembraneLaw<History<L> = P>, P: History<L>, const L: usize>(
    law: &M,
    history: &P,
    lane: usize,
) -> [f64; 2] {
    let first = law.break_strains::<L>(history);
    [0, 1].map(|fibre| {
        let (peak, limit) = (history.peak(fibre)[lane], first[fibre][lane]);
        let left = if peak > limit { law.share_left(peak / limit) } else { 1.0 };
        // The break strain may rise again with the rate; broken layers stay broken.
        left.min(history.left(fibre)[lane])
    })
}

/// Whether a fibre set with layers left is strained beyond the break of the first.
#[inline(always)]
fn is_beyond<M: MembraneLaw<History<L> = P>, P: History<L>, const L: usize>(
    law: &M,
    history: &P,
    volume: &Lane<L>,
) -> bool {
    let limits = law.break_strains::<L>(history);
    let (peaks, left) = ([history.peak(0), history.peak(1)], [history.left(0), history.left(1)]);
    let mut beyond = false;
    for l in 0..L {
        // `&`, not `&&`: this runs over all lanes in every step, and a branch would be taken once a run.
        let of = |fibre: usize| (peaks[fibre][l] > limits[fibre][l]) & (left[fibre][l] > 0.0);
        beyond |= (volume[l] > 0.0) & (of(0) | of(1));
    }
    beyond
}

/// A kind of element that is built from the stress-free coordinates (m, along MD and TD) of its nodes.
pub(super) trait Shaped<const NODES: usize>: Sized {
    /// The element with nodes at `x`.
    fn shaped(x: &[[f64; 2]; NODES]) -> Self;

    /// Area of stress-free film, m².
    fn area(&self) -> f64;
}

impl Shaped<4> for OnePointElement {
    fn shaped(x: &[[f64; 2]; 4]) -> Self {
        quad4::one_point(x)
    }

    fn area(&self) -> f64 {
        self.area
    }
}

impl Shaped<4> for GaussElement<4, 4> {
    fn shaped(x: &[[f64; 2]; 4]) -> Self {
        quad4::four_points(x)
    }

    fn area(&self) -> f64 {
        self.area.iter().sum()
    }
}

impl Shaped<3> for GaussElement<3, 1> {
    fn shaped(x: &[[f64; 2]; 3]) -> Self {
        tri3::constant_strain(x)
    }

    fn area(&self) -> f64 {
        self.area[0]
    }
}

/// Elements at the given nodes of a mesh with the stress-free coordinates of `film`.
pub(super) fn shaped<E: Shaped<NODES>, const NODES: usize>(
    elements: &[[u32; NODES]],
    nodes: &[Point3<f64>],
    film: &StressFree,
) -> Result<Vec<E>, UndefinedFibreDirection> {
    elements.iter().map(|&element| Ok(E::shaped(&film.reference(element, nodes)?))).collect()
}
