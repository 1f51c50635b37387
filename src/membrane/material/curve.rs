//! Piecewise linear stress–strain curves.

use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::lane::{Lane, one, splat};

/// A piecewise linear stress–strain curve that starts at the origin.
///
/// Below zero strain the stress is zero. Beyond the last point the last slope continues; the law decides whether the
/// material fails there ([`Curve::end`]).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Curve {
    points: Vec<[f64; 2]>,
    segments: Vec<Segment>,
}

/// One straight piece from the strain `start` of the strain `length`, infinite for the last one.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Segment {
    start: f64,
    length: f64,
    slope: f64,
    stress: f64,
}

impl Segment {
    /// How much of the segment lies below `strain`.
    #[inline(always)]
    fn part<const L: usize>(&self, strain: Lane<L>) -> Lane<L> {
        (strain - self.start).max(0.0).min(self.length)
    }
}

/// Why points are not a stress–strain curve.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum CurveError {
    /// There is no point besides the origin.
    #[error("a curve needs at least one point besides the origin")]
    TooShort,
    /// Strains must increase.
    #[error("strain does not increase at point {index}: {strain} after {previous}")]
    StrainNotIncreasing {
        /// Index of the point.
        index: usize,
        /// Its strain.
        strain: f64,
        /// Strain of the point before.
        previous: f64,
    },
    /// Stresses must not decrease; Pa.
    #[error("stress falls at point {index}: {stress} Pa after {previous} Pa")]
    StressFalls {
        /// Index of the point.
        index: usize,
        /// Its stress, Pa.
        stress: f64,
        /// Stress of the point before, Pa.
        previous: f64,
    },
    /// A strain or stress is not finite.
    #[error("point {index} is not a finite number")]
    NotFinite {
        /// Index of the point.
        index: usize,
    },
}

/// Stress and energy density of a curve in each lane.
#[derive(Clone, Copy, Debug)]
pub struct Reading<const L: usize> {
    /// Pa.
    pub stress: Lane<L>,
    /// Area under the curve up to the strain, J/m³.
    pub energy: Lane<L>,
}

impl Curve {
    /// Curve through the origin and `points` (strain, stress in Pa), whose strain must increase and whose stress
    /// must not fall: on a falling branch strain would localise in one row of elements.
    ///
    /// A leading (0, 0) may be left out.
    ///
    /// # Errors
    /// [`CurveError`] with the index of a point in `points`.
    pub fn new(points: Vec<[f64; 2]>) -> Result<Curve, CurveError> {
        let skipped = if points.first() == Some(&[0.0, 0.0]) { 1 } else { 0 };
        let points = points[skipped..].to_vec();
        if points.is_empty() {
            return Err(CurveError::TooShort);
        }
        let mut from = [0.0, 0.0];
        for (i, &to) in points.iter().enumerate() {
            let index = i + skipped;
            if !(to[0].is_finite() && to[1].is_finite()) {
                return Err(CurveError::NotFinite { index });
            }
            if to[0] <= from[0] {
                return Err(CurveError::StrainNotIncreasing { index, strain: to[0], previous: from[0] });
            }
            if to[1] < from[1] {
                return Err(CurveError::StressFalls { index, stress: to[1], previous: from[1] });
            }
            from = to;
        }
        Ok(Curve::through(points))
    }

    /// The curve through points that ascend.
    fn through(points: Vec<[f64; 2]>) -> Curve {
        let mut segments = Vec::with_capacity(points.len());
        let mut from = [0.0, 0.0];
        for &to in &points {
            let length = to[0] - from[0];
            segments.push(Segment { start: from[0], length, slope: (to[1] - from[1]) / length, stress: from[1] });
            from = to;
        }
        if let Some(last) = segments.last_mut() {
            last.length = f64::INFINITY;
        }
        Curve { points, segments }
    }

    /// The corner points after the origin: strain, stress (Pa).
    pub fn points(&self) -> &[[f64; 2]] {
        &self.points
    }

    /// Strain of the last point.
    #[inline]
    pub fn end(&self) -> f64 {
        self.points[self.points.len() - 1][0]
    }

    /// This curve with its last point at `strain` > 0: cut there, or continued up to it with its last slope.
    pub fn ending_at(&self, strain: f64) -> Curve {
        let corners = &self.points[..self.points.len() - 1];
        let mut points: Vec<_> = corners.iter().copied().filter(|point| point[0] < strain).collect();
        points.push([strain, self.stress(strain)]);
        let mut segments: Vec<_> = self.segments.iter().copied().filter(|segment| segment.start < strain).collect();
        if let Some(last) = segments.last_mut() {
            last.length = f64::INFINITY;
        }
        Curve { points, segments }
    }

    /// The curve whose stress is the sum of those of `first` and `second` times their `weights`, which are not
    /// negative. It ends where the longer one does.
    pub fn weighted(first: &Curve, second: &Curve, weights: [f64; 2]) -> Curve {
        let mut strains: Vec<f64> = first.points.iter().chain(&second.points).map(|point| point[0]).collect();
        strains.sort_by(f64::total_cmp);
        strains.dedup();
        let [a, b] = weights;
        let stress = |strain: f64| a * first.stress(strain) + b * second.stress(strain);
        Curve::through(strains.into_iter().map(|strain| [strain, stress(strain)]).collect())
    }

    /// Slope at the origin, Pa.
    pub fn initial_slope(&self) -> f64 {
        self.segments[0].slope
    }

    /// Largest slope that begins at a strain film reaches within few steps, Pa, or of all where that is zero.
    pub fn early_slope(&self) -> f64 {
        /// That strain.
        const EARLY: f64 = 0.1;
        let largest = |end| self.segments.iter().filter(|of| of.start <= end).map(|of| of.slope).fold(0.0, f64::max);
        let early = largest(EARLY);
        if early > 0.0 { early } else { largest(f64::INFINITY) }
    }

    /// Stress at one strain, Pa.
    pub fn stress(&self, strain: f64) -> f64 {
        self.stress_lanes(one(strain))[0]
    }

    /// Least strain with `stress` (Pa), on the last slope beyond the last point; infinite where the curve does not
    /// reach it.
    pub fn strain_at(&self, stress: f64) -> f64 {
        let ends = self.points.iter().map(|point| point[1]);
        let within = self.segments.iter().zip(ends).find(|(_, end)| *end >= stress).map(|(segment, _)| segment);
        let segment = within.unwrap_or(&self.segments[self.segments.len() - 1]);
        let beyond = (stress - segment.stress).max(0.0);
        if beyond == 0.0 { segment.start } else { segment.start + beyond / segment.slope }
    }

    /// Area under the curve up to one strain, J/m³.
    pub fn energy(&self, strain: f64) -> f64 {
        self.read(one(strain)).energy[0]
    }

    /// Stress in each lane: a sum of clamped segments, so without a branch on the strain.
    #[inline(always)]
    pub fn stress_lanes<const L: usize>(&self, strain: Lane<L>) -> Lane<L> {
        let mut stress = splat(0.0);
        for s in &self.segments {
            // Every segment adds what lies within it: lanes with different strains need neither a search nor a branch,
            // and curves have few segments.
            stress += s.slope * s.part(strain);
        }
        stress
    }

    /// Stress in each lane, as [`Curve::stress_lanes`], and slope, at a corner that of the segment behind it, Pa.
    #[inline(always)]
    pub(super) fn tangent<const L: usize>(&self, strain: Lane<L>) -> [Lane<L>; 2] {
        let [mut stress, mut slope] = [splat(0.0); 2];
        for s in &self.segments {
            let from = strain - s.start;
            stress += s.slope * s.part(strain);
            slope += (from.at_least(0.0) & from.below(s.length)).select(s.slope, 0.0);
        }
        [stress, slope]
    }

    /// Stress and energy in each lane.
    #[inline(always)]
    pub fn read<const L: usize>(&self, strain: Lane<L>) -> Reading<L> {
        let mut energy = splat(0.0);
        for s in &self.segments {
            let d = s.part(strain);
            energy += (s.stress + 0.5 * s.slope * d) * d;
        }
        Reading { stress: self.stress_lanes(strain), energy }
    }

    /// Largest slope between two strains in each lane, Pa.
    #[inline(always)]
    pub fn largest_slope<const L: usize>(&self, from: Lane<L>, to: Lane<L>) -> Lane<L> {
        let (mut most, to) = (splat(0.0), to.max(0.0));
        for s in &self.segments {
            // Ends included: a strain at a corner may go on along either slope.
            let overlaps = to.at_least(s.start) & from.at_most(s.start + s.length);
            most = overlaps.select(most.max(s.slope), most);
        }
        most
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bilinear() -> Curve {
        Curve::new(vec![[0.1, 2.0], [0.5, 4.0]]).unwrap()
    }

    #[test]
    fn passes_through_its_points() {
        for (strain, stress) in [(-1.0, 0.0), (0.0, 0.0), (0.05, 1.0), (0.1, 2.0), (0.3, 3.0), (0.5, 4.0), (0.7, 5.0)] {
            assert!((bilinear().stress(strain) - stress).abs() < 1e-12, "at {strain}");
        }
    }

    #[test]
    fn energy_is_the_area_under_the_curve() {
        for (strain, area) in [(-1.0, 0.0), (0.05, 0.025), (0.1, 0.1), (0.3, 0.6), (0.5, 1.3)] {
            assert!((bilinear().energy(strain) - area).abs() < 1e-12, "at {strain}");
        }
    }

    #[test]
    fn the_largest_slope_is_over_all_overlapping_segments() {
        for (from, to, slope) in
            [(0.0, 0.05, 20.0), (0.05, 0.2, 20.0), (0.2, 0.3, 5.0), (0.6, 0.9, 5.0), (-0.2, -0.1, 20.0)]
        {
            assert!((bilinear().largest_slope(one(from), one(to))[0] - slope).abs() < 1e-9, "{from}..{to}");
        }
    }

    #[test]
    fn the_strain_of_a_stress_is_the_least() {
        for (stress, strain) in [(0.0, 0.0), (1.0, 0.05), (2.0, 0.1), (3.0, 0.3), (4.0, 0.5), (5.0, 0.7)] {
            assert!((bilinear().strain_at(stress) - strain).abs() < 1e-12, "at {stress}");
        }
        let flat = Curve::new(vec![[0.1, 2.0], [0.5, 2.0]]).unwrap();
        assert_eq!((flat.strain_at(2.0), flat.strain_at(2.1)), (0.1, f64::INFINITY));
    }

    #[test]
    fn another_end_leaves_the_stress() {
        for (end, corners) in [(0.05, 1), (0.3, 2), (0.5, 2), (0.9, 2)] {
            let moved = bilinear().ending_at(end);
            assert_eq!((moved.end(), moved.points().len()), (end, corners));
            for strain in [0.02, 0.05, 0.2, 0.3, 0.6, 0.9].into_iter().filter(|strain| *strain <= end) {
                assert_eq!(moved.read(one(strain)).stress, bilinear().read(one(strain)).stress, "{strain} of {end}");
                assert_eq!(moved.energy(strain), bilinear().energy(strain), "{strain} of {end}");
            }
            assert_eq!(moved.points()[corners - 1][1], bilinear().stress(end));
        }
    }

    #[test]
    fn refuses_what_is_no_curve() {
        let cases: [(Vec<[f64; 2]>, CurveError); 5] = [
            (vec![], CurveError::TooShort),
            (vec![[0.0, 0.0]], CurveError::TooShort),
            (
                vec![[0.0, 0.0], [0.2, 1.0], [0.2, 2.0]],
                CurveError::StrainNotIncreasing { index: 2, strain: 0.2, previous: 0.2 },
            ),
            (vec![[0.2, 1.0], [0.3, 0.5]], CurveError::StressFalls { index: 1, stress: 0.5, previous: 1.0 }),
            (vec![[0.2, f64::NAN]], CurveError::NotFinite { index: 0 }),
        ];
        for (points, error) in cases {
            assert_eq!(Curve::new(points), Err(error));
        }
    }
}
