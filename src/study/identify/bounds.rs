//! Bounds of the parameters.
//!
//! Nelder–Mead keeps them by *projection*: a point outside is moved onto the box before it is evaluated. The other
//! methods, which build on derivatives or on a distribution, search without bounds in u, from which x follows by the
//! *transform* of MINUIT (James and Roos, Comput. Phys. Commun. 10, 1975):
//!
//! - both bounds: x = lo + (hi − lo)(1 + sin u)/2
//! - lower only: x = lo − 1 + √(u² + 1)
//! - upper only: x = hi + 1 − √(u² + 1)

use std::f64::consts::FRAC_PI_2;

use serde::Serialize;
use thiserror::Error;

/// Share of the box, or of the value, by which a start on a bound is moved inwards for the transform, whose derivative
/// vanishes on the bound.
const INWARDS: f64 = 0.01;

/// Distance from a bound, as a share of the box, or of the value where only one side is bounded, at which a point
/// counts as on it. Towards a bound the transform gains as the square of u, so that a search meets its tolerances
/// before it.
const CLOSE: f64 = 1e-4;

/// Least size of u, of the π/2 at a bound, of which a difference is a share.
const CENTRAL: f64 = 0.3;

/// A box: lower and upper bounds of the unknowns, infinite where there is none.
#[derive(Clone, Debug, PartialEq)]
pub struct Bounds {
    lower: Vec<f64>,
    upper: Vec<f64>,
}

/// A side of an interval.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Side {
    /// The lower end.
    Lower,
    /// The upper end.
    Upper,
}

impl std::fmt::Display for Side {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Side::Lower => "lower",
            Side::Upper => "upper",
        })
    }
}

/// Why bounds are invalid.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum BoundsError {
    /// One side has the wrong number of entries.
    #[error("`{which}` has {found} entries for {unknowns} unknowns")]
    Count {
        /// `lower` or `upper`.
        which: &'static str,
        /// Number of its entries.
        found: usize,
        /// Number of unknowns.
        unknowns: usize,
    },
    /// The interval of an unknown is empty.
    #[error("the bounds of {unknown} are empty: {lower} to {upper}")]
    Empty {
        /// The unknown.
        unknown: String,
        /// Its lower bound.
        lower: f64,
        /// Its upper bound.
        upper: f64,
    },
    /// A point lies outside.
    #[error("the start lies outside the bounds: {unknown} = {value}, which may be {lower} to {upper}")]
    Outside {
        /// The unknown.
        unknown: String,
        /// Its value.
        value: f64,
        /// Its lower bound.
        lower: f64,
        /// Its upper bound.
        upper: f64,
    },
}

impl Bounds {
    /// No bounds for `unknowns`.
    pub fn none(unknowns: usize) -> Bounds {
        Bounds { lower: vec![f64::NEG_INFINITY; unknowns], upper: vec![f64::INFINITY; unknowns] }
    }

    /// Bounds of the unknowns with these `names`; `None` leaves a side unbounded.
    ///
    /// # Errors
    /// A side has the wrong number of entries, or an interval is empty.
    pub fn new(names: &[String], lower: Option<Vec<f64>>, upper: Option<Vec<f64>>) -> Result<Bounds, BoundsError> {
        let unknowns = names.len();
        let none = Bounds::none(unknowns);
        let bounds = Bounds { lower: lower.unwrap_or(none.lower), upper: upper.unwrap_or(none.upper) };
        for (which, side) in [("lower", &bounds.lower), ("upper", &bounds.upper)] {
            if side.len() != unknowns {
                return Err(BoundsError::Count { which, found: side.len(), unknowns });
            }
        }
        let is_wide = |[lower, upper]: [f64; 2]| lower < upper;
        let tight = bounds.pairs().position(|pair| !is_wide(pair));
        match tight {
            Some(index) => {
                let (unknown, [lower, upper]) = (names[index].clone(), [bounds.lower[index], bounds.upper[index]]);
                Err(BoundsError::Empty { unknown, lower, upper })
            }
            None => Ok(bounds),
        }
    }

    /// Lower and upper bound of every unknown.
    pub fn pairs(&self) -> impl Iterator<Item = [f64; 2]> + '_ {
        self.lower.iter().zip(&self.upper).map(|(lower, upper)| [*lower, *upper])
    }

    /// Whether every unknown has both bounds.
    pub fn are_all(&self) -> bool {
        self.pairs().flatten().all(f64::is_finite)
    }

    /// Whether `x`, whose entries have these `names`, lies in the box.
    ///
    /// # Errors
    /// The first unknown that lies outside.
    pub fn check(&self, x: &[f64], names: &[String]) -> Result<(), BoundsError> {
        let outside = x.iter().zip(self.pairs()).position(|(x, [lower, upper])| *x < lower || *x > upper);
        outside.map_or(Ok(()), |index| {
            let [lower, upper] = [self.lower[index], self.upper[index]];
            Err(BoundsError::Outside { unknown: names[index].clone(), value: x[index], lower, upper })
        })
    }

    /// The unknowns of `x` that lie on a bound, or as close to one as the transform comes, and which bound that is.
    pub fn active(&self, x: &[f64]) -> Vec<(usize, Side)> {
        let side = |(index, (x, pair)): (usize, (&f64, [f64; 2]))| Some((index, side(*x, pair)?));
        x.iter().zip(self.pairs()).enumerate().filter_map(side).collect()
    }

    /// Projects `x` onto the box.
    pub fn project(&self, x: &mut [f64]) {
        for (x, [lower, upper]) in x.iter_mut().zip(self.pairs()) {
            *x = x.clamp(lower, upper);
        }
    }

    /// The unknowns of `x` beside a bound, as close to it as a start on it is moved inwards, and that bound.
    pub fn beside(&self, x: &[f64]) -> Vec<(usize, f64)> {
        let bound = |(index, (x, [lower, upper])): (usize, (&f64, [f64; 2]))| {
            let near = INWARDS * room(*x, [lower, upper]);
            let close = [lower, upper].into_iter().find(|bound| (x - bound).abs() <= near)?;
            (close != *x).then_some((index, close))
        };
        x.iter().zip(self.pairs()).enumerate().filter_map(bound).collect()
    }

    /// Moves the unknowns of `x` that lie on a bound inwards.
    pub fn inwards(&self, x: &mut [f64]) {
        for (x, [lower, upper]) in x.iter_mut().zip(self.pairs()) {
            let room = room(*x, [lower, upper]);
            match side(*x, [lower, upper]) {
                Some(Side::Lower) => *x = lower + INWARDS * room,
                Some(Side::Upper) => *x = upper - INWARDS * room,
                None => {}
            }
        }
    }

    /// The transform: the point of the box at `u`.
    pub fn x_of(&self, u: &[f64]) -> Vec<f64> {
        let x = |(u, [lower, upper]): (&f64, [f64; 2])| match [lower.is_finite(), upper.is_finite()] {
            [true, true] => (lower + (upper - lower) * 0.5 * (1.0 + u.sin())).clamp(lower, upper),
            [true, false] => lower - 1.0 + (u * u + 1.0).sqrt(),
            [false, true] => upper + 1.0 - (u * u + 1.0).sqrt(),
            [false, false] => *u,
        };
        u.iter().zip(self.pairs()).map(x).collect()
    }

    /// The inverse of the transform: a `u` with the point `x` of the box.
    pub fn u_of(&self, x: &[f64]) -> Vec<f64> {
        let u = |(x, [lower, upper]): (&f64, [f64; 2])| match [lower.is_finite(), upper.is_finite()] {
            [true, true] => (2.0 * (x - lower) / (upper - lower) - 1.0).asin().clamp(-FRAC_PI_2, FRAC_PI_2),
            [true, false] => ((x - lower + 1.0).powi(2) - 1.0).sqrt(),
            [false, true] => ((upper - x + 1.0).powi(2) - 1.0).sqrt(),
            [false, false] => *x,
        };
        x.iter().zip(self.pairs()).map(u).collect()
    }

    /// Of how much each entry of `u` a difference is a share: its own size, as of a value without bounds. Between two bounds at
    /// least [`CENTRAL`], since there u is zero at the centre of the interval, which is a place like any other.
    pub(super) fn scales(&self, u: &[f64]) -> Vec<f64> {
        let scale = |(u, [lower, upper]): (&f64, [f64; 2])| match (upper - lower).is_finite() {
            true => u.abs().max(CENTRAL),
            false if *u == 0.0 => 1.0,
            false => u.abs(),
        };
        u.iter().zip(self.pairs()).map(scale).collect()
    }
}

/// Width of the interval of an unknown; its size at `x`, at least one, where that is infinite.
fn room(x: f64, [lower, upper]: [f64; 2]) -> f64 {
    if (upper - lower).is_finite() { upper - lower } else { x.abs().max(1.0) }
}

/// The bound on which `x` lies, or to which it is as close as the transform comes.
fn side(x: f64, [lower, upper]: [f64; 2]) -> Option<Side> {
    let near = CLOSE * room(x, [lower, upper]);
    if x - lower <= near { Some(Side::Lower) } else { (upper - x <= near).then_some(Side::Upper) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identify::point::unnamed;

    const NONE: f64 = f64::INFINITY;

    #[test]
    fn the_inverse_of_the_transform_is_exact() {
        let bounds =
            Bounds::new(&unnamed(4), Some(vec![0.5, -2.0, -NONE, -NONE]), Some(vec![4.0, NONE, 7.0, NONE])).unwrap();
        let x = [1.25, 3.0, -5.0, 11.0];
        for (found, expected) in bounds.x_of(&bounds.u_of(&x)).iter().zip(x) {
            assert!((found - expected).abs() < 1e-12);
        }
        for far in [-1e3, -2.0, 0.0, 1.3, 77.0] {
            assert_eq!(bounds.check(&bounds.x_of(&[far; 4]), &unnamed(4)), Ok(()));
        }
    }

    #[test]
    fn points_outside_are_projected_onto_the_box() {
        let bounds = Bounds::new(&unnamed(2), Some(vec![0.0, 1.0]), None).unwrap();
        let mut x = [-3.0, 5.0];
        bounds.project(&mut x);
        assert_eq!((x, bounds.active(&x)), ([0.0, 5.0], vec![(0, Side::Lower)]));
        bounds.inwards(&mut x);
        assert_eq!(x, [0.01, 5.0]);
        assert_eq!((bounds.beside(&[0.005, 1.001]), bounds.beside(&[0.0, 5.0])), (vec![(0, 0.0), (1, 1.0)], vec![]));
    }

    /// On a bound is what lies within 10⁻⁴ of the box, wherever the box lies; of the value where one side is bounded.
    #[test]
    fn nearness_to_a_bound_is_relative_to_the_box() {
        let narrow = Bounds::new(&unnamed(1), Some(vec![1000.0]), Some(vec![1000.1])).unwrap();
        let around_zero = Bounds::new(&unnamed(1), Some(vec![0.0]), Some(vec![10.0])).unwrap();
        let [above, below] = [(Some(vec![0.0]), None), (None, Some(vec![500.0]))];
        let above = Bounds::new(&unnamed(1), above.0, above.1).unwrap();
        let below = Bounds::new(&unnamed(1), below.0, below.1).unwrap();
        for (bounds, x, expected) in [
            (&narrow, 1000.05, None),
            (&narrow, 1000.0 + 5e-6, Some(Side::Lower)),
            (&narrow, 1000.1 - 5e-6, Some(Side::Upper)),
            (&around_zero, 5e-4, Some(Side::Lower)),
            (&around_zero, 2e-3, None),
            (&above, 5e-5, Some(Side::Lower)),
            (&above, 2e-4, None),
            (&below, 499.96, Some(Side::Upper)),
            (&below, 499.9, None),
        ] {
            let found = bounds.active(&[x]).first().map(|(_, side)| *side);
            assert_eq!(found, expected, "{x} in {bounds:?}");
        }
    }
}
