//! Bounds of the parameters.
//!
//! Nelder–Mead keeps to them by *projection*: a point beyond is moved onto the box before it is tried. The others, which
//! build on derivatives or on a distribution, search without bounds in u, from which x follows by MINUIT's *transform*
//! (James and Roos, Comput. Phys. Commun. 10, 1975):
//!
//! - both bounds: x = lo + (hi − lo)(1 + sin u)/2
//! - lower only: x = lo − 1 + √(u² + 1)
//! - upper only: x = hi + 1 − √(u² + 1)

use std::f64::consts::FRAC_PI_2;

use thiserror::Error;

/// Share of the box, or of the value, by which a start on a bound is moved inwards where bounds are kept by transform: on
/// the bound itself the transform has no slope.
const INWARDS: f64 = 0.01;

/// A box, one pair of bounds an unknown; infinite where there is none.
#[derive(Clone, Debug, PartialEq)]
pub struct Bounds {
    lower: Vec<f64>,
    upper: Vec<f64>,
}

/// Why there is no box, or no search in it.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum BoundsError {
    #[error("`{which}` has {found} entries for {unknowns} unknowns")]
    Count { which: &'static str, found: usize, unknowns: usize },
    #[error("the bounds of x[{place}] leave no room: {lower} to {upper}")]
    Empty { place: usize, lower: f64, upper: f64 },
    #[error("the start lies outside the bounds: x[{place}] = {value}, which may be {lower} to {upper}")]
    Outside { place: usize, value: f64, lower: f64, upper: f64 },
}

impl Bounds {
    /// No bounds for `unknowns`.
    pub fn none(unknowns: usize) -> Bounds {
        Bounds { lower: vec![f64::NEG_INFINITY; unknowns], upper: vec![f64::INFINITY; unknowns] }
    }

    /// Bounds of `unknowns`; left out, there are none on that side.
    pub fn new(unknowns: usize, lower: Option<Vec<f64>>, upper: Option<Vec<f64>>) -> Result<Bounds, BoundsError> {
        let none = Bounds::none(unknowns);
        let bounds = Bounds { lower: lower.unwrap_or(none.lower), upper: upper.unwrap_or(none.upper) };
        for (which, side) in [("lower", &bounds.lower), ("upper", &bounds.upper)] {
            if side.len() != unknowns {
                return Err(BoundsError::Count { which, found: side.len(), unknowns });
            }
        }
        let room = |[lower, upper]: [f64; 2]| lower < upper;
        let tight = bounds.pairs().position(|pair| !room(pair));
        match tight {
            Some(place) => Err(BoundsError::Empty { place, lower: bounds.lower[place], upper: bounds.upper[place] }),
            None => Ok(bounds),
        }
    }

    /// Lower and upper bound of every unknown.
    pub fn pairs(&self) -> impl Iterator<Item = [f64; 2]> + '_ {
        self.lower.iter().zip(&self.upper).map(|(lower, upper)| [*lower, *upper])
    }

    /// Whether any unknown has a bound.
    pub fn are_any(&self) -> bool {
        self.pairs().flatten().any(f64::is_finite)
    }

    /// Whether every unknown has both.
    pub fn are_all(&self) -> bool {
        self.pairs().flatten().all(f64::is_finite)
    }

    /// Whether `x` may be tried.
    pub fn check(&self, x: &[f64]) -> Result<(), BoundsError> {
        let outside = x.iter().zip(self.pairs()).position(|(x, [lower, upper])| *x < lower || *x > upper);
        outside.map_or(Ok(()), |place| {
            let [lower, upper] = [self.lower[place], self.upper[place]];
            Err(BoundsError::Outside { place, value: x[place], lower, upper })
        })
    }

    /// The unknowns of `x` that lie on a bound, or so close to one that a search by transform, which never reaches it, means it.
    pub fn touched(&self, x: &[f64]) -> Vec<usize> {
        /// Over the size of the bound.
        const CLOSE: f64 = 1e-6;
        let close = |x: f64, bound: f64| bound.is_finite() && (x - bound).abs() <= CLOSE * bound.abs();
        let on =
            |(x, [lower, upper]): (&f64, [f64; 2])| *x <= lower || *x >= upper || close(*x, lower) || close(*x, upper);
        x.iter().zip(self.pairs()).enumerate().filter(|(_, pair)| on(*pair)).map(|(place, _)| place).collect()
    }

    /// Moves `x` onto the box where it lies beyond.
    pub fn project(&self, x: &mut [f64]) {
        for (x, [lower, upper]) in x.iter_mut().zip(self.pairs()) {
            *x = x.clamp(lower, upper);
        }
    }

    /// Moves what lies on a bound a little inwards.
    pub fn inwards(&self, x: &mut [f64]) {
        for (x, [lower, upper]) in x.iter_mut().zip(self.pairs()) {
            let room = if (upper - lower).is_finite() { upper - lower } else { x.abs().max(1.0) };
            if *x <= lower {
                *x = lower + INWARDS * room;
            } else if *x >= upper {
                *x = upper - INWARDS * room;
            }
        }
    }

    /// The point of the box that `u` stands for.
    pub fn x_of(&self, u: &[f64]) -> Vec<f64> {
        let x = |(u, [lower, upper]): (&f64, [f64; 2])| match [lower.is_finite(), upper.is_finite()] {
            [true, true] => (lower + (upper - lower) * 0.5 * (1.0 + u.sin())).clamp(lower, upper),
            [true, false] => lower - 1.0 + (u * u + 1.0).sqrt(),
            [false, true] => upper + 1.0 - (u * u + 1.0).sqrt(),
            [false, false] => *u,
        };
        u.iter().zip(self.pairs()).map(x).collect()
    }

    /// A u that stands for the point `x` of the box.
    pub fn u_of(&self, x: &[f64]) -> Vec<f64> {
        let u = |(x, [lower, upper]): (&f64, [f64; 2])| match [lower.is_finite(), upper.is_finite()] {
            [true, true] => (2.0 * (x - lower) / (upper - lower) - 1.0).asin().clamp(-FRAC_PI_2, FRAC_PI_2),
            [true, false] => ((x - lower + 1.0).powi(2) - 1.0).sqrt(),
            [false, true] => ((upper - x + 1.0).powi(2) - 1.0).sqrt(),
            [false, false] => *x,
        };
        x.iter().zip(self.pairs()).map(u).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const NONE: f64 = f64::INFINITY;

    #[test]
    fn the_transform_goes_there_and_back() {
        let bounds = Bounds::new(4, Some(vec![0.5, -2.0, -NONE, -NONE]), Some(vec![4.0, NONE, 7.0, NONE])).unwrap();
        let x = [1.25, 3.0, -5.0, 11.0];
        for (found, expected) in bounds.x_of(&bounds.u_of(&x)).iter().zip(x) {
            assert!((found - expected).abs() < 1e-12);
        }
        for far in [-1e3, -2.0, 0.0, 1.3, 77.0] {
            assert_eq!(bounds.check(&bounds.x_of(&[far; 4])), Ok(()));
        }
    }

    #[test]
    fn what_lies_beyond_is_moved_onto_the_box_and_then_inwards() {
        let bounds = Bounds::new(2, Some(vec![0.0, 1.0]), None).unwrap();
        let mut x = [-3.0, 5.0];
        bounds.project(&mut x);
        assert_eq!((x, bounds.touched(&x)), ([0.0, 5.0], vec![0]));
        bounds.inwards(&mut x);
        assert_eq!(x, [0.01, 5.0]);
    }

    #[test]
    fn boxes_that_cannot_be_are_refused() {
        let error = |lower, upper| Bounds::new(2, lower, upper).unwrap_err().to_string();
        assert_eq!(error(Some(vec![1.0]), None), "`lower` has 1 entries for 2 unknowns");
        assert_eq!(error(Some(vec![0.0; 2]), Some(vec![1.0, 0.0])), "the bounds of x[1] leave no room: 0 to 0");
        let outside = Bounds::new(1, Some(vec![0.5]), Some(vec![4.0])).unwrap().check(&[0.2]).unwrap_err();
        assert_eq!(outside.to_string(), "the start lies outside the bounds: x[0] = 0.2, which may be 0.5 to 4");
    }
}
