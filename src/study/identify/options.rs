//! The options of a search: its method, its starts, and its bounds.
//!
//! Nelder–Mead keeps them by *projection*: a point outside is moved onto the box before it is evaluated. The other
//! methods, which build on derivatives or on a distribution, search without bounds in u, from which x follows by the
//! *transform* of MINUIT (James and Roos, Comput. Phys. Commun. 10, 1975):
//!
//! - both bounds: x = lo + (hi − lo)(1 + sin u)/2
//! - lower only: x = lo − 1 + √(u² + 1)
//! - upper only: x = hi + 1 − √(u² + 1)
//!
//! Of an unknown with a logarithm as its coordinate, ln x, ln lo and ln hi stand in these.

use std::f64::consts::FRAC_PI_2;
use std::fmt;

use serde::{Serialize, Serializer};

use super::objective::{SearchError, refused};
use base::number;

/// The method of a search.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// The simplex search of Nelder and Mead, as MATLAB's `fminsearch`.
    NelderMead,
    /// Damped least squares; needs residuals.
    LevenbergMarquardt,
    /// Evolution of a normal distribution, for rough objectives.
    CmaEs,
}

impl Method {
    /// The methods by their names in scripts.
    pub const NAMES: [(&'static str, Method); 3] = [
        ("nelder-mead", Method::NelderMead),
        ("levenberg-marquardt", Method::LevenbergMarquardt),
        ("cma-es", Method::CmaEs),
    ];
}

/// Starts beside [`Search::start`].
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Starts {
    /// None.
    #[default]
    One,
    /// This number in all, the others in a Latin hypercube over the bounds.
    Spread(usize),
    /// These.
    Given(Vec<Vec<f64>>),
    /// This number in all, the others those of these points whose values are lowest.
    Lowest(usize, Vec<Vec<f64>>),
}

/// A search: method, start, tolerances and limits.
#[derive(Clone, Debug, PartialEq)]
pub struct Search {
    /// The method.
    pub method: Method,
    /// The first start, one value for each unknown.
    pub start: Vec<f64>,
    /// Names of the unknowns; `x0`, `x1`, … where none are given.
    pub names: Vec<String>,
    /// Nelder–Mead: largest distance of a vertex from the best along an axis. Levenberg–Marquardt: relative change of
    /// x. CMA-ES: standard deviation in units of the first one.
    pub tol_x: f64,
    /// Nelder–Mead, CMA-ES: difference of objective values. Levenberg–Marquardt: relative reduction of the sum of
    /// squares.
    pub tol_f: f64,
    /// Limit of iterations of one start.
    pub max_iterations: usize,
    /// Limit of evaluations of one start.
    pub max_evaluations: usize,
    /// Bounds of the unknowns.
    pub bounds: Bounds,
    /// Seed of CMA-ES and of the Latin hypercube.
    pub seed: u64,
    /// Further starts.
    pub starts: Starts,
    /// Relative step of the differences of a Jacobian.
    pub difference: f64,
}

impl Starts {
    /// Number of starts, that of the search included.
    pub fn count(&self) -> usize {
        match self {
            Starts::One => 1,
            Starts::Spread(count) => *count,
            Starts::Given(others) => 1 + others.len(),
            Starts::Lowest(count, points) => 1 + points.len().min(count.saturating_sub(1)),
        }
    }
}

impl Search {
    /// Largest number of unknowns; more need gradients.
    pub const MAX_UNKNOWNS: usize = 50;
    /// Largest number of starts.
    pub const MAX_STARTS: usize = 1000;

    /// A search from `start` with the tolerances and limits of MATLAB's `fminsearch`.
    pub fn new(method: Method, start: Vec<f64>) -> Search {
        let unknowns = start.len();
        Search {
            method,
            tol_x: 1e-4,
            tol_f: 1e-4,
            max_iterations: 200 * unknowns,
            max_evaluations: 200 * unknowns,
            bounds: Bounds::none(unknowns),
            seed: 1,
            starts: Starts::One,
            difference: 1e-3,
            names: unnamed(unknowns),
            start,
        }
    }

    /// Step of the difference of an unknown that is `x`: within narrow bounds one of the usual size would leave them on the other
    /// side.
    pub(crate) fn step(&self, index: usize, x: f64) -> f64 {
        let [lower, upper] = self.bounds.pair(index);
        let size = if x == 0.0 { 1.0 } else { x.abs() };
        (self.difference * size).min(0.25 * (upper - lower))
    }

    /// Checks ranges, bounds and starts.
    ///
    /// # Errors
    /// The first option that is invalid.
    pub fn check(&self) -> Result<(), SearchError> {
        let (unknowns, most, none) = (self.start.len(), Search::MAX_UNKNOWNS, vec![]);
        if !(1..=most).contains(&unknowns) {
            return Err(refused!("a search needs 1 to {most} unknowns, the start has {unknowns}"));
        }
        if self.names.len() != unknowns {
            return Err(refused!("`names` has {} entries for {unknowns} unknowns", self.names.len()));
        }
        let (count, others) = match &self.starts {
            Starts::One => (1, &none),
            Starts::Spread(count) => (*count, &none),
            Starts::Given(others) | Starts::Lowest(_, others) => (1 + others.len(), others),
        };
        let is_tolerance = |found: f64| found.is_finite() && found >= 0.0;
        for (option, found, fits, range) in [
            ("tol_x", self.tol_x, is_tolerance(self.tol_x), "zero or more"),
            ("tol_f", self.tol_f, is_tolerance(self.tol_f), "zero or more"),
            ("difference", self.difference, self.difference > 0.0 && self.difference < 1.0, "between 0 and 1"),
            ("max_iterations", self.max_iterations as f64, self.max_iterations > 0, "at least 1"),
            ("max_evaluations", self.max_evaluations as f64, self.max_evaluations > 0, "at least 1"),
            ("starts", count as f64, (1..=Search::MAX_STARTS).contains(&count), "1 to 1000"),
        ] {
            if !fits {
                return Err(refused!("`{option}` is {found}, which must be {range}"));
            }
        }
        if matches!(self.starts, Starts::Spread(_)) && !self.bounds.are_all() {
            return Err(refused!("starts spread over the bounds need `lower` and `upper` for every unknown"));
        }
        for (start, number) in std::iter::once(&self.start).chain(others).zip(1..) {
            if start.len() != unknowns {
                return Err(refused!("start {number} has {} entries for {unknowns} unknowns", start.len()));
            }
            if let Some(index) = start.iter().position(|x| !x.is_finite()) {
                return Err(refused!("the start is not finite: {} = {}", self.names[index], start[index]));
            }
            self.bounds.check(start, &self.names)?;
        }
        Ok(())
    }
}

/// Share of the box, along its coordinate, or of the value, by which a start on a bound is moved inwards for the transform, whose
/// derivative vanishes on the bound.
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
    /// Unknowns whose coordinate is the logarithm: along it are the transform (levenberg-marquardt, cma-es) and distances
    /// from bounds, not the simplex of Nelder–Mead, spread starts or steps of differences.
    is_logarithmic: Vec<bool>,
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

impl Bounds {
    /// No bounds for `unknowns`.
    pub fn none(unknowns: usize) -> Bounds {
        let [lower, upper] = [f64::NEG_INFINITY, f64::INFINITY].map(|end| vec![end; unknowns]);
        Bounds { lower, upper, is_logarithmic: vec![false; unknowns] }
    }

    /// Bounds of the unknowns with these `names`; `None` leaves a side unbounded.
    ///
    /// # Errors
    /// A side has the wrong number of entries, or an interval is empty.
    pub fn new(names: &[String], lower: Option<Vec<f64>>, upper: Option<Vec<f64>>) -> Result<Bounds, SearchError> {
        let unknowns = names.len();
        let none = Bounds::none(unknowns);
        let bounds = Bounds { lower: lower.unwrap_or(none.lower), upper: upper.unwrap_or(none.upper), ..none };
        for (which, side) in [("lower", &bounds.lower), ("upper", &bounds.upper)] {
            if side.len() != unknowns {
                return Err(refused!("`{which}` has {} entries for {unknowns} unknowns", side.len()));
            }
        }
        let is_wide = |[lower, upper]: [f64; 2]| lower < upper;
        if let Some(([lower, upper], unknown)) = bounds.pairs().zip(names).find(|(pair, _)| !is_wide(*pair)) {
            return Err(refused!("the bounds of {unknown} are empty: {lower} to {upper}"));
        }
        Ok(bounds)
    }

    /// The same, where the coordinate of these unknowns, whose bounds are above zero, is the logarithm.
    pub fn along_logarithms(self, is_logarithmic: Vec<bool>) -> Bounds {
        Bounds { is_logarithmic, ..self }
    }

    /// Lower and upper bound of every unknown.
    pub fn pairs(&self) -> impl Iterator<Item = [f64; 2]> + '_ {
        self.lower.iter().zip(&self.upper).map(|(lower, upper)| [*lower, *upper])
    }

    /// Lower and upper bound of one unknown.
    pub(super) fn pair(&self, index: usize) -> [f64; 2] {
        [self.lower[index], self.upper[index]]
    }

    fn coordinate(&self, index: usize, x: f64) -> f64 {
        if self.is_logarithmic[index] { x.ln() } else { x }
    }

    fn value(&self, index: usize, coordinate: f64) -> f64 {
        if self.is_logarithmic[index] { coordinate.exp() } else { coordinate }
    }

    /// Lower and upper bound of one unknown, as coordinates.
    fn ends(&self, index: usize) -> [f64; 2] {
        self.pair(index).map(|end| self.coordinate(index, end))
    }

    /// Width of the interval of an unknown along its coordinate; its size at `x`, at least one, where that is infinite.
    pub(super) fn room(&self, index: usize, x: f64) -> f64 {
        let [lower, upper] = self.ends(index);
        if (upper - lower).is_finite() { upper - lower } else { x.abs().max(1.0) }
    }

    /// How far apart two values of an unknown are along its coordinate.
    pub(super) fn apart(&self, index: usize, a: f64, b: f64) -> f64 {
        (self.coordinate(index, a) - self.coordinate(index, b)).abs()
    }

    /// The bound on which an unknown that is `x` lies, or to which it is as close as the transform comes.
    fn side(&self, index: usize, x: f64) -> Option<Side> {
        let ([lower, upper], near) = (self.ends(index), CLOSE * self.room(index, x));
        let x = self.coordinate(index, x);
        if x - lower <= near { Some(Side::Lower) } else { (upper - x <= near).then_some(Side::Upper) }
    }

    /// Whether every unknown has both bounds.
    pub fn are_all(&self) -> bool {
        self.pairs().flatten().all(f64::is_finite)
    }

    /// Whether `x`, whose entries have these `names`, lies in the box.
    ///
    /// # Errors
    /// The first unknown that lies outside.
    pub fn check(&self, x: &[f64], names: &[String]) -> Result<(), SearchError> {
        let outside = x.iter().zip(self.pairs()).position(|(x, [lower, upper])| *x < lower || *x > upper);
        outside.map_or(Ok(()), |index| {
            let [lower, upper] = self.pair(index);
            let (unknown, value) = (&names[index], x[index]);
            Err(refused!("the start lies outside the bounds: {unknown} = {value}, which may be {lower} to {upper}"))
        })
    }

    /// The unknowns of `x` that lie on a bound, or as close to one as the transform comes, and which bound that is.
    pub fn active(&self, x: &[f64]) -> Vec<(usize, Side)> {
        x.iter().enumerate().filter_map(|(index, x)| Some((index, self.side(index, *x)?))).collect()
    }

    /// Projects `x` onto the box.
    pub fn project(&self, x: &mut [f64]) {
        for (x, [lower, upper]) in x.iter_mut().zip(self.pairs()) {
            *x = x.clamp(lower, upper);
        }
    }

    /// The unknowns of `x` beside a bound, as close to it as a start on it is moved inwards, and that bound.
    pub fn beside(&self, x: &[f64]) -> Vec<(usize, f64)> {
        let bound = |(index, x): (usize, &f64)| {
            let near = INWARDS * self.room(index, *x);
            let close = self.pair(index).into_iter().find(|bound| self.apart(index, *x, *bound) <= near)?;
            (close != *x).then_some((index, close))
        };
        x.iter().enumerate().filter_map(bound).collect()
    }

    /// Moves the unknowns of `x` that lie on a bound inwards.
    pub fn inwards(&self, x: &mut [f64]) {
        for (index, x) in x.iter_mut().enumerate() {
            let ([lower, upper], inwards) = (self.ends(index), INWARDS * self.room(index, *x));
            match self.side(index, *x) {
                Some(Side::Lower) => *x = self.value(index, lower + inwards),
                Some(Side::Upper) => *x = self.value(index, upper - inwards),
                None => {}
            }
        }
    }

    /// The transform: the point of the box at `u`.
    pub fn x_of(&self, u: &[f64]) -> Vec<f64> {
        let x = |(index, u): (usize, &f64)| {
            let [lower, upper] = self.ends(index);
            let coordinate = match [lower.is_finite(), upper.is_finite()] {
                [true, true] => lower + (upper - lower) * 0.5 * (1.0 + u.sin()),
                [true, false] => lower - 1.0 + (u * u + 1.0).sqrt(),
                [false, true] => upper + 1.0 - (u * u + 1.0).sqrt(),
                [false, false] => *u,
            };
            self.value(index, coordinate).clamp(self.lower[index], self.upper[index])
        };
        u.iter().enumerate().map(x).collect()
    }

    /// The inverse of the transform: a `u` with the point `x` of the box.
    pub fn u_of(&self, x: &[f64]) -> Vec<f64> {
        let u = |(index, x): (usize, &f64)| {
            let ([lower, upper], x) = (self.ends(index), self.coordinate(index, *x));
            match [lower.is_finite(), upper.is_finite()] {
                [true, true] => (2.0 * (x - lower) / (upper - lower) - 1.0).asin().clamp(-FRAC_PI_2, FRAC_PI_2),
                [true, false] => ((x - lower + 1.0).powi(2) - 1.0).sqrt(),
                [false, true] => ((upper - x + 1.0).powi(2) - 1.0).sqrt(),
                [false, false] => x,
            }
        };
        x.iter().enumerate().map(u).collect()
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

/// Significant digits of a value.
const DIGITS: usize = 5;

/// A point with the names of its unknowns.
#[derive(Clone, Debug, PartialEq)]
pub struct Point(Vec<(String, f64)>);

impl Point {
    /// The point `x` of unknowns with these `names`.
    pub(super) fn new(names: &[String], x: &[f64]) -> Point {
        Point(names.iter().cloned().zip(x.iter().copied()).collect())
    }
}

/// `k1 = 2.75, ke = 3.41`
impl fmt::Display for Point {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, (name, value)) in self.0.iter().enumerate() {
            let comma = if index == 0 { "" } else { ", " };
            write!(out, "{comma}{name} = {}", number::significant(*value, DIGITS))?;
        }
        Ok(())
    }
}

/// As a map from names to values.
impl Serialize for Point {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.iter().map(|(name, value)| (name, value)))
    }
}

/// The names of `count` unknowns where none are given: `x0`, `x1`, …
pub(super) fn unnamed(count: usize) -> Vec<String> {
    (0..count).map(|index| format!("x{index}")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

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
            assert!(bounds.check(&bounds.x_of(&[far; 4]), &unnamed(4)).is_ok());
        }
    }

    #[test]
    fn bounds_may_be_along_the_logarithm() {
        let bounds = Bounds::new(&unnamed(1), Some(vec![1e-3]), Some(vec![100.0])).unwrap();
        let bounds = bounds.along_logarithms(vec![true]);
        // The middle of the interval, and a point that is 2 % of it away from the lower end.
        assert!((bounds.x_of(&[0.0])[0] / 0.1_f64.sqrt() - 1.0).abs() < 1e-12);
        let x = [1.26e-3];
        assert!((bounds.x_of(&bounds.u_of(&x))[0] / x[0] - 1.0).abs() < 1e-12);
        assert_eq!((bounds.active(&x), bounds.beside(&x)), (vec![], vec![]));
        assert_eq!(bounds.active(&[1.001e-3]), [(0, Side::Lower)]);
        let mut on = [1e-3];
        bounds.inwards(&mut on);
        assert!((on[0] / 1e-3 - 1e5_f64.powf(INWARDS)).abs() < 1e-12, "{on:?}");
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
