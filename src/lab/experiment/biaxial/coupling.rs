//! The biaxial coupling of a fabric (docs/theory.md, equation 4b) from film that is stretched in both directions.

use thiserror::Error;

use crate::experiment::coupon::Curve;
use base::number::significant;

/// The curves of MD and TD, to which the coupling comes: nominal stress (Pa) over engineering strain.
pub struct Uncoupled<'a> {
    /// Of MD and of TD.
    pub stresses: [&'a dyn Fn(f64) -> f64; 2],
    /// Strains at which they end.
    pub ends: [f64; 2],
}

/// The coupling that a test shows.
#[derive(Clone, Debug, PartialEq)]
pub struct Coupling {
    /// k of equation 4b, by least squares of stresses over all strains.
    pub value: f64,
    /// Root mean square of what is left of the stresses, over theirs.
    pub relative_rms: f64,
    /// Strain and the coupling there.
    pub by_strain: Vec<[f64; 2]>,
    /// Strain up to which the curves of MD and TD reach; none where they reach as far as the test.
    pub cut: Option<f64>,
}

/// Why a test shows no coupling.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum CouplingError {
    /// The curves end before the test begins.
    #[error(
        "the curves of the film end at a strain of {}, before the first sample of the test, at {}",
        significant(*end, 4),
        significant(*from, 4)
    )]
    NoOverlap {
        /// End of the curves.
        end: f64,
        /// First strain of the test.
        from: f64,
    },
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
    pub fn of_equal_strains(curve: &Curve, film: &Uncoupled<'_>) -> Result<Coupling, CouplingError> {
        let end = film.ends[0].min(film.ends[1]);
        Coupling::fit(curve, end, |strain| film.mean(strain), |strain| film.mean(strain))
    }

    /// Of a coupon along MD (`along` 0) or TD (1) whose width is held.
    ///
    /// # Errors
    /// The curves end before the test begins.
    pub fn of_held_width(curve: &Curve, film: &Uncoupled<'_>, along: usize) -> Result<Coupling, CouplingError> {
        // The coupling is at the mean strain of both directions.
        let end = film.ends[along].min(2.0 * film.ends[1 - along]);
        Coupling::fit(curve, end, |strain| film.stresses[along](strain), |strain| film.mean(0.5 * strain))
    }

    /// The k of a stress `own` + k `coupled`.
    fn fit(
        curve: &Curve,
        end: f64,
        own: impl Fn(f64) -> f64,
        coupled: impl Fn(f64) -> f64,
    ) -> Result<Coupling, CouplingError> {
        let [first, last] = curve.range();
        let samples: Vec<[f64; 2]> = curve.samples().filter(|[strain, _]| *strain > 0.0 && *strain <= end).collect();
        let (mut product, mut square, mut stresses) = (0.0, 0.0, 0.0);
        for [strain, stress] in &samples {
            product += coupled(*strain) * (stress - own(*strain));
            square += coupled(*strain).powi(2);
            stresses += stress * stress;
        }
        if !(square > 0.0 && stresses > 0.0) {
            return Err(CouplingError::NoOverlap { end, from: first });
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
        assert_eq!(Coupling::of_equal_strains(&late, &film), Err(CouplingError::NoOverlap { end: 0.5, from: 0.6 }));
    }
}
