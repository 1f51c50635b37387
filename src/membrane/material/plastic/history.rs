//! History variables of plastic film.

use super::super::history::History;
use crate::lane::{Lane, splat};
use crate::material::elastic::Plane;

/// History variables of plastic film, one integration point a lane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlasticHistory<const L: usize> {
    /// Plastic strain E_p, logarithmic: components 11, 22 and 12.
    pub(super) strain: Plane<L>,
    /// Equivalent plastic strain p.
    pub(super) equivalent: Lane<L>,
    /// σ̄ over the slow flow stress at the end of the last step, Pa; zero where it is not above.
    pub(super) overstress: Lane<L>,
    /// Plastic work beyond that of slow flow, J/m³.
    pub(super) surplus: Lane<L>,
    /// Share of the layers that are not broken, MD and TD; all of them, since the law has no break strain.
    left: [Lane<L>; 2],
}

impl<const L: usize> History<L> for PlasticHistory<L> {
    fn virgin() -> Self {
        let nothing = splat(0.0);
        PlasticHistory {
            strain: [nothing; 3],
            equivalent: nothing,
            overstress: nothing,
            surplus: nothing,
            left: [splat(1.0); 2],
        }
    }

    /// Zero: the law depends on no largest strain.
    #[inline(always)]
    fn peak(&self, _fibre: usize) -> &Lane<L> {
        const { &splat(0.0) }
    }

    #[inline(always)]
    fn left(&self, fibre: usize) -> &Lane<L> {
        &self.left[fibre]
    }

    fn left_mut(&mut self, fibre: usize) -> &mut Lane<L> {
        &mut self.left[fibre]
    }

    fn variables(&mut self) -> impl Iterator<Item = &mut Lane<L>> {
        let scalars = [&mut self.equivalent, &mut self.overstress, &mut self.surplus];
        self.strain.iter_mut().chain(scalars).chain(&mut self.left)
    }
}
