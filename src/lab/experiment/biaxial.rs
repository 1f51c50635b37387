//! Film that is stretched in both directions: bulges, and coupons that are wide for their length; what they say of the
//! coupling of MD and TD (docs/methods.md, section 11).

use serde::Serialize;

use super::coupon::Curve;
use crate::error::{Error, Kind, refusal};
use base::number::significant;

/// Height over the largest one below which a cap is too flat for the curvature that follows from its height.
const FLAT: f64 = 0.1;

/// A disc that is clamped on a circle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bulge {
    radius: f64,
    thickness: f64,
}

impl Bulge {
    /// A disc of this radius within the clamp (m) and this thickness before the test (m).
    ///
    /// # Errors
    /// One of them is not positive.
    pub fn new(radius: f64, thickness: f64) -> Result<Bulge, Error> {
        for (name, value) in [("radius", radius), ("thickness", thickness)] {
            if !(value > 0.0 && value.is_finite()) {
                return Err(refusal!("the {name} of the bulge must be above zero, and is {value} m"));
            }
        }
        Ok(Bulge { radius, thickness })
    }

    /// Nominal stress (Pa) over engineering strain, alike in all directions, of a spherical cap that is strained evenly
    /// (docs/methods.md, equation 36b): `pressure` (Pa) and `height` of the top (m) sample by sample, from a tenth of the
    /// largest height up to there, also where the pressure falls before.
    ///
    /// # Errors
    /// The film does not rise, or its height goes back.
    pub fn curve(&self, pressure: &[f64], height: &[f64]) -> Result<Curve, Error> {
        let top = height.iter().copied().fold(0.0, f64::max);
        let end = height.iter().rposition(|own| *own == top).map_or(0, |place| place + 1);
        let is_cap = |(_, (pressure, height)): &(usize, (&f64, &f64))| **pressure > 0.0 && **height > FLAT * top;
        let samples = pressure.iter().zip(&height[..end]).enumerate().filter(is_cap);
        let (places, points): (Vec<usize>, Vec<(f64, f64)>) =
            samples.map(|(place, (pressure, height))| (place, self.point(*pressure, *height))).unzip();
        let (strain, stress): (Vec<f64>, Vec<f64>) = points.into_iter().unzip();
        if strain.len() < 2 {
            return Err(refusal!("the recording has no two samples in which film has risen under pressure").with_hint(
                "pressure and height count above zero where film rises: change the sign of a channel that is negative",
            ));
        }
        Curve::new(strain, stress).map_err(|error| match *error.kind() {
            // In the samples of the recording.
            Kind::GoesBack(sample) => {
                let place = places[sample - 1];
                let before = height[..place].iter().copied().fold(0.0, f64::max);
                let [height, before] = [1e3 * height[place], 1e3 * before];
                refusal!("the film sinks at sample {}: {height:.3} mm after {before:.3} mm", place + 1)
            }
            _ => error,
        })
    }

    /// Strain and nominal stress.
    fn point(&self, pressure: f64, height: f64) -> (f64, f64) {
        let radius = (self.radius * self.radius + height * height) / (2.0 * height);
        // The angle from the top to the clamp; above a half sphere it is more than a right one.
        let angle = 2.0 * height.atan2(self.radius);
        let stretch = radius * angle / self.radius;
        (stretch - 1.0, 0.5 * pressure * radius * stretch / self.thickness)
    }
}

/// The curves of MD and TD, to which the coupling comes: nominal stress (Pa) over engineering strain.
pub struct Uncoupled<'a> {
    /// Of MD and of TD.
    pub stresses: [&'a dyn Fn(f64) -> f64; 2],
    /// Strains at which they end.
    pub ends: [f64; 2],
}

/// The coupling that a test shows.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Coupling {
    /// k of equation 4b, by least squares of stresses over all strains.
    pub value: f64,
    /// Root mean square of what is left of the stresses, over theirs.
    pub relative_rms: f64,
    /// Strain and the coupling there.
    pub by_strain: Vec<[f64; 2]>,
    /// Strain up to which the curves of MD and TD reach; none where they reach as far as the test.
    #[serde(skip)]
    pub cut: Option<f64>,
}

/// Strains at which the coupling is given.
const STRAINS: usize = 6;

/// Share of its largest value that the stress of the curves must have where the coupling is given: slack curves have none.
const LEAST_STRESS: f64 = 0.05;

/// Share of its length by which the free edges of a wide coupon shorten its width at most: what two of them carry less
/// than film in the middle, which grows with the coupling (docs/methods.md, section 11).
const EDGES: f64 = 0.5;

/// The largest share of its stress beyond that of a long coupon which a wide one lacks by its free edges, `gauge` and `width` of one unit.
pub fn edge_share(gauge: f64, width: f64) -> f64 {
    EDGES * gauge / width
}

impl Coupling {
    /// Of a test in which both strains are equal and the stress is the mean of both, as in a bulge.
    ///
    /// # Errors
    /// The curves end before the test begins.
    pub fn of_equal_strains(curve: &Curve, film: &Uncoupled<'_>) -> Result<Coupling, Error> {
        let end = film.ends[0].min(film.ends[1]);
        Coupling::fit(curve, end, |strain| film.mean(strain), |strain| film.mean(strain))
    }

    /// Of a coupon along MD (`along` 0) or TD (1) whose width is held.
    ///
    /// # Errors
    /// The curves end before the test begins.
    pub fn of_held_width(curve: &Curve, film: &Uncoupled<'_>, along: usize) -> Result<Coupling, Error> {
        // The coupling is at the mean strain of both directions.
        let end = film.ends[along].min(2.0 * film.ends[1 - along]);
        Coupling::fit(curve, end, |strain| film.stresses[along](strain), |strain| film.mean(0.5 * strain))
    }

    /// The k of a stress `own` + k `coupled`.
    fn fit(curve: &Curve, end: f64, own: impl Fn(f64) -> f64, coupled: impl Fn(f64) -> f64) -> Result<Coupling, Error> {
        let [first, last] = curve.range();
        let samples: Vec<[f64; 2]> = curve.samples().filter(|[strain, _]| *strain > 0.0 && *strain <= end).collect();
        let (mut product, mut square, mut stresses) = (0.0, 0.0, 0.0);
        for [strain, stress] in &samples {
            product += coupled(*strain) * (stress - own(*strain));
            square += coupled(*strain).powi(2);
            stresses += stress * stress;
        }
        if !(square > 0.0 && stresses > 0.0) {
            let [end, first] = [end, first].map(|strain| significant(strain, 4));
            return Err(refusal!(
                "the curves of the film end at a strain of {end}, before the first sample of the test, at {first}"
            ));
        }
        let value = product / square;
        let left = samples.iter().map(|[strain, stress]| (stress - own(*strain) - value * coupled(*strain)).powi(2));
        let relative_rms = (left.sum::<f64>() / stresses).sqrt();
        let to = last.min(end);
        let least = LEAST_STRESS * coupled(to);
        let by_strain = (1..=STRAINS)
            .map(|place| to * place as f64 / STRAINS as f64)
            .filter(|strain| coupled(*strain) > least)
            .filter_map(|strain| Some([strain, (curve.stress_at(strain)? - own(strain)) / coupled(strain)]))
            .collect();
        Ok(Coupling { value, relative_rms, by_strain, cut: (last > end).then_some(end) })
    }
}

impl Uncoupled<'_> {
    /// The mean of both curves at a strain, Pa.
    fn mean(&self, strain: f64) -> f64 {
        0.5 * (self.stresses[0](strain) + self.stresses[1](strain))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A half sphere: π/2 times the radius along the meridian, and p a/2 per length of its edge.
    #[test]
    fn a_half_sphere_has_its_stretch_and_stress() {
        let bulge = Bulge::new(0.05, 1e-5).unwrap();
        let curve = bulge.curve(&[0.0, 100.0, 400.0, 300.0], &[0.0, 0.01, 0.05, 0.049]).unwrap();
        let [strain, stress] = curve.samples().last().unwrap();
        let stretch = 0.5 * std::f64::consts::PI;
        assert!((strain - (stretch - 1.0)).abs() < 1e-12);
        assert!((stress - 400.0 * 0.05 / 2.0 * stretch / 1e-5).abs() < 1e-3);
        assert_eq!(curve.strain().len(), 2);
    }

    /// A flat cap: the strain 2 h²/(3 a²) and the stress p a²/(4 h t).
    #[test]
    fn a_flat_cap_has_the_known_series() {
        let (a, h, p, t) = (0.05, 5e-4, 10.0, 1e-5);
        let curve = Bulge::new(a, t).unwrap().curve(&[5.0, p], &[4e-4, h]).unwrap();
        let [strain, stress] = curve.samples().last().unwrap();
        assert!((strain / (2.0 * h * h / (3.0 * a * a)) - 1.0).abs() < 1e-3, "{strain}");
        assert!((stress / (p * a * a / (4.0 * h * t)) - 1.0).abs() < 1e-3, "{stress}");
    }

    #[test]
    fn what_is_no_bulge_is_refused() {
        let flat = |pressure: &[f64], height: &[f64]| {
            let error = Bulge::new(0.05, 1e-5).unwrap().curve(pressure, height).unwrap_err();
            error.message() == "the recording has no two samples in which film has risen under pressure"
        };
        let thin = Bulge::new(0.05, 0.0).unwrap_err().to_string();
        assert_eq!(thin, "the thickness of the bulge must be above zero, and is 0 m");
        let bulge = Bulge::new(0.05, 1e-5).unwrap();
        assert!(flat(&[0.0, 1.0], &[0.0, 0.0]) && flat(&[], &[]));
        for negative in [[[-1.0, -2.0], [0.01, 0.02]], [[1.0, 2.0], [-0.01, -0.02]]] {
            let error = bulge.curve(&negative[0], &negative[1]).unwrap_err();
            assert!(error.hint().unwrap().contains("sign"), "{error}");
        }
        let back = bulge.curve(&[0.0, 1.0, 2.0, 3.0], &[0.0, 0.01, 0.004, 0.02]);
        assert_eq!(back.unwrap_err().to_string(), "the film sinks at sample 3: 4.000 mm after 10.000 mm");
        assert!(flat(&[f64::NAN, 1.0], &[0.01, f64::NAN]));
        // Past the largest pressure film rises on; when it sinks again, that is another curve.
        let on = bulge.curve(&[1e3, 2e3, 1.7e3, 100.0], &[0.01, 0.02, 0.05, 0.03]).unwrap();
        assert_eq!(on.strain().len(), 3);
    }

    /// Curves of other slopes; the stresses of equation 4b with equal strains, and with one of them.
    #[test]
    fn the_coupling_of_stresses_that_have_it_is_found() {
        let (md, td) = (|e: f64| 40e6 * e.min(0.2) + 10e6 * (e - 0.2).max(0.0), |e: f64| 25e6 * e);
        let film = Uncoupled { stresses: [&md, &td], ends: [0.5, 0.9] };
        let both = |e: f64| 0.5 * (md(e) + td(e));
        let curve = |stress: &dyn Fn(f64) -> f64, to: f64| {
            let strains: Vec<f64> = (1..=100).map(|place| to * f64::from(place) / 100.0).collect();
            let stresses = strains.iter().map(|strain| stress(*strain)).collect();
            Curve::new(strains, stresses).unwrap()
        };
        let found = Coupling::of_equal_strains(&curve(&|e| 1.4 * both(e), 0.8), &film).unwrap();
        assert!((found.value - 0.4).abs() < 1e-12 && found.relative_rms < 1e-12 && found.cut == Some(0.5), "{found:?}");
        assert_eq!(found.by_strain.len(), STRAINS);
        let held = curve(&|e| td(e) + 0.6 * both(0.5 * e), 0.8);
        let found = Coupling::of_held_width(&held, &film, 1).unwrap();
        assert!((found.value - 0.6).abs() < 1e-12 && found.cut.is_none(), "{found:?}");
        assert!(found.by_strain.iter().all(|[_, own]| (own - 0.6).abs() < 1e-9), "{found:?}");
        // A law that this one is not leaves a rest, and couplings that change.
        let other = Coupling::of_equal_strains(&curve(&|e| (1.0 + e) * both(e), 0.5), &film).unwrap();
        assert!(other.relative_rms > 0.02 && other.by_strain[5][1] > 2.0 * other.by_strain[0][1], "{other:?}");
        let late = Curve::new(vec![0.6, 0.7], vec![1e6, 2e6]).unwrap();
        let late = Coupling::of_equal_strains(&late, &film).unwrap_err().to_string();
        assert!(late.ends_with("end at a strain of 0.5, before the first sample of the test, at 0.6"), "{late}");
    }
}
