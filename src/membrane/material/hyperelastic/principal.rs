//! Principal stretches of a film and their directions.

use super::{Squares, StrainEnergy};
use crate::lane::{Lane, larger, splat};
use crate::material::elastic::Plane;

/// Radius of Mohr's circle below which the stretch has no direction: far below round-off.
const POINT: f64 = 1e-100;

/// Eigenvalues of C and their directions.
pub(super) struct Principal<const L: usize> {
    /// c₁ ≥ c₂.
    pub(super) squares: Squares<L>,
    /// cos 2θ and sin 2θ of the first direction; zero where all directions are principal.
    direction: [Lane<L>; 2],
    /// Whether film at these stretches has no wrinkles.
    pub(super) taut: [bool; L],
}

impl<const L: usize> Principal<L> {
    /// Principal stretches of C₁₁, C₂₂ and C₁₂.
    #[inline(always)]
    pub(super) fn from_cauchy_green(c: &Plane<L>) -> Principal<L> {
        let mut out = Principal { squares: [splat(0.0); 2], direction: [splat(0.0); 2], taut: [true; L] };
        for l in 0..L {
            let (mean, apart) = (0.5 * (c[0][l] + c[1][l]), 0.5 * (c[0][l] - c[1][l]));
            let radius = (apart * apart + c[2][l] * c[2][l]).sqrt();
            let first = mean + radius;
            out.squares[0][l] = first;
            // The difference would lose what is small against c₁.
            out.squares[1][l] = (c[0][l] * c[1][l] - c[2][l] * c[2][l]) / first;
            let inverse = 1.0 / larger(radius, POINT);
            out.direction[0][l] = apart * inverse;
            out.direction[1][l] = c[2][l] * inverse;
        }
        out
    }

    /// The stretches of taut film with the same energy as film that wrinkles at these, c₁* and c₂*.
    #[inline(always)]
    pub(super) fn relaxed(mut self, energy: &impl StrainEnergy) -> Principal<L> {
        for l in 0..L {
            // A NaN must propagate.
            let first = self.squares[0][l];
            self.squares[0][l] = if first < 1.0 { 1.0 } else { first };
        }
        let natural = energy.natural_width(&self.squares[0]);
        for l in 0..L {
            self.taut[l] = self.squares[1][l] > natural[l];
            self.squares[1][l] = if self.taut[l] { self.squares[1][l] } else { natural[l] };
        }
        self
    }

    /// Components 11, 22 and 12 of a tensor with the principal values `s` in these directions.
    #[inline(always)]
    pub(super) fn turned(&self, s: [Lane<L>; 2]) -> Plane<L> {
        let mut out = [splat(0.0); 3];
        for l in 0..L {
            let (mean, apart) = (0.5 * (s[0][l] + s[1][l]), 0.5 * (s[0][l] - s[1][l]));
            out[0][l] = mean + apart * self.direction[0][l];
            out[1][l] = mean - apart * self.direction[0][l];
            out[2][l] = apart * self.direction[1][l];
        }
        out
    }
}
