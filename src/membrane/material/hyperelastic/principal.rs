//! Principal stretches of a film and their directions.

use super::{Squares, StrainEnergy};
use crate::lane::{Lane, Mask, splat};
use crate::material::elastic::Plane;

/// Radius of Mohr's circle below which the stretch has no direction: far below round-off.
const POINT: f64 = 1e-100;

/// Eigenvalues of C and their directions.
pub(super) struct Principal<const L: usize> {
    /// c₁ ≥ c₂.
    pub(super) squares: Squares<L>,
    /// cos 2θ and sin 2θ of the first direction; zero where all directions are principal.
    direction: [Lane<L>; 2],
}

impl<const L: usize> Principal<L> {
    /// Principal stretches of C₁₁, C₂₂ and C₁₂.
    #[inline(always)]
    pub(super) fn from_cauchy_green(c: &Plane<L>) -> Principal<L> {
        let (mean, apart) = (0.5 * (c[0] + c[1]), 0.5 * (c[0] - c[1]));
        let radius = (apart * apart + c[2] * c[2]).sqrt();
        let first = mean + radius;
        // The difference mean − radius would lose what is small against c₁.
        let second = (c[0] * c[1] - c[2] * c[2]) / first;
        let inverse = 1.0 / radius.max(POINT);
        let direction = [apart * inverse, c[2] * inverse];
        Principal { squares: [first, second], direction }
    }

    /// The stretches of taut film with the same energy as film that wrinkles at these, c₁* and c₂*, and where it has no wrinkles.
    #[inline(always)]
    pub(super) fn relaxed(mut self, energy: &impl StrainEnergy) -> (Principal<L>, Mask<L>) {
        let [first, second] = &mut self.squares;
        // A NaN must propagate.
        *first = splat(1.0).max(*first);
        let natural = energy.natural_width(*first);
        let is_taut = second.above(natural);
        *second = is_taut.select(*second, natural);
        (self, is_taut)
    }

    /// Components 11, 22 and 12 of a tensor with the principal values `s` in these directions.
    #[inline(always)]
    pub(super) fn turned(&self, s: [Lane<L>; 2]) -> Plane<L> {
        let (mean, apart) = (0.5 * (s[0] + s[1]), 0.5 * (s[0] - s[1]));
        [mean + apart * self.direction[0], mean - apart * self.direction[0], apart * self.direction[1]]
    }
}
