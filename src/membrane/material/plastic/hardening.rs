//! Isotropic hardening: the flow stress over the equivalent plastic strain.

use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::lane::{Lane, one};
use crate::material::{Curve, CurveError};

/// Flow stress of slow flow over the equivalent plastic strain p.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Hardening {
    /// A piecewise linear table.
    Table(FlowCurve),
    /// Voce's law.
    Voce(Voce),
}

/// A piecewise linear flow stress, constant beyond the last point.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FlowCurve {
    /// Flow stress at p = 0, Pa.
    initial: f64,
    /// Flow stress above that.
    rise: Curve,
    /// p of the last point.
    end: f64,
}

/// Voce's hardening, σ_s − (σ_s − σ_0) exp(−b p) (theory.md, equation 259; Voce, J. Inst. Metals 74, 1948).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Voce {
    /// σ_0, flow stress at p = 0, Pa.
    pub initial: f64,
    /// σ_s, flow stress that is approached, at least σ_0, Pa.
    pub saturation: f64,
    /// b.
    pub rate: f64,
}

/// Why points are not a flow curve.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum FlowCurveError {
    /// There is no point.
    #[error("there is no point")]
    Empty,
    /// The first point is not at zero plastic strain.
    #[error("the first plastic strain is {strain}, not zero")]
    StartsLate {
        /// Strain of the first point.
        strain: f64,
    },
    /// The first flow stress is not above zero.
    #[error("the first flow stress is not above zero")]
    NoStress,
    /// The other points do not ascend.
    #[error(transparent)]
    Curve(CurveError),
}

/// Flow stress and its slope.
pub(super) struct Flow<const L: usize> {
    /// Pa.
    pub(super) stress: Lane<L>,
    /// Its derivative by p, Pa.
    pub(super) slope: Lane<L>,
}

impl FlowCurve {
    /// The curve through points of the equivalent plastic strain and the flow stress (Pa): from zero strain on, with
    /// stresses that do not fall.
    ///
    /// # Errors
    /// [`FlowCurveError`]; indices are those in `points`.
    pub fn new(points: &[[f64; 2]]) -> Result<FlowCurve, FlowCurveError> {
        let (&[start, initial], rest) = points.split_first().ok_or(FlowCurveError::Empty)?;
        if start != 0.0 {
            return Err(FlowCurveError::StartsLate { strain: start });
        }
        if !(initial > 0.0 && initial.is_finite()) {
            return Err(FlowCurveError::NoStress);
        }
        let end = rest.last().map_or(0.0, |point| point[0]);
        let above = rest.iter().map(|[strain, stress]| [*strain, stress - initial]);
        let last = rest.last().map_or(0.0, |point| point[1] - initial);
        // A curve goes on with its last slope: a flat piece behind the last point keeps the flow stress constant.
        let flat = [2.0 * end.max(0.5), last];
        let rise = Curve::new(above.chain([flat]).collect()).map_err(|error| {
            FlowCurveError::Curve(match error {
                CurveError::TooShort => CurveError::TooShort,
                CurveError::StrainNotIncreasing { index, strain, previous } => {
                    CurveError::StrainNotIncreasing { index: index + 1, strain, previous }
                }
                CurveError::StressFalls { index, stress, previous } => {
                    let [stress, previous] = [stress, previous].map(|above| above + initial);
                    CurveError::StressFalls { index: index + 1, stress, previous }
                }
                CurveError::NotFinite { index } => CurveError::NotFinite { index: index + 1 },
            })
        })?;
        Ok(FlowCurve { initial, rise, end })
    }

    /// Flow stress at p = 0, Pa.
    pub fn initial(&self) -> f64 {
        self.initial
    }

    /// Flow stress at the equivalent plastic strain `p`, Pa.
    pub fn stress(&self, p: f64) -> f64 {
        self.initial + self.rise.stress(p)
    }

    /// Equivalent plastic strain and flow stress (Pa) of its points.
    pub fn points(&self) -> impl Iterator<Item = [f64; 2]> {
        let rest = self.rise.points().iter().filter(|point| point[0] <= self.end);
        std::iter::once([0.0, self.initial]).chain(rest.map(|[p, rise]| [*p, self.initial + rise]))
    }

    /// p at the corners.
    pub(super) fn corners(&self) -> impl Iterator<Item = f64> {
        self.rise.points().iter().map(|point| point[0])
    }

    #[inline(always)]
    pub(super) fn flow<const L: usize>(&self, p: Lane<L>) -> Flow<L> {
        let [rise, slope] = self.rise.tangent(p);
        Flow { stress: self.initial + rise, slope }
    }
}

impl Hardening {
    /// Flow stress at p = 0, Pa.
    pub fn initial(&self) -> f64 {
        match self {
            Hardening::Table(curve) => curve.initial,
            Hardening::Voce(voce) => voce.initial,
        }
    }

    /// Largest p for which it is given; infinite for Voce's.
    pub fn end(&self) -> f64 {
        match self {
            Hardening::Table(curve) => curve.end,
            Hardening::Voce(_) => f64::INFINITY,
        }
    }

    /// Flow stress at the equivalent plastic strain `p`, Pa.
    pub fn stress(&self, p: f64) -> f64 {
        self.flow(one(p)).stress[0]
    }

    /// Flow stress and slope.
    #[inline(always)]
    pub(super) fn flow<const L: usize>(&self, p: Lane<L>) -> Flow<L> {
        match self {
            Hardening::Table(curve) => curve.flow(p),
            &Hardening::Voce(Voce { initial, saturation, rate }) => {
                let left = (saturation - initial) * (-rate * p).exp();
                Flow { stress: saturation - left, slope: rate * left }
            }
        }
    }

    /// Work of slow flow from the virgin state to `p`, ∫ σ_y dp, J/m³.
    #[inline(always)]
    pub(super) fn work<const L: usize>(&self, p: Lane<L>) -> Lane<L> {
        match self {
            Hardening::Table(FlowCurve { initial, rise, .. }) => *initial * p + rise.read(p).energy,
            &Hardening::Voce(Voce { initial, saturation, rate }) => {
                saturation * p - (saturation - initial) * (1.0 - (-rate * p).exp()) / rate
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn laws() -> [Hardening; 3] {
        let points = [[0.0, 8e6], [0.05, 12e6], [0.2, 14e6], [0.5, 20e6]];
        [
            Hardening::Table(FlowCurve::new(&points).unwrap()),
            Hardening::Table(FlowCurve::new(&points[..1]).unwrap()),
            Hardening::Voce(Voce { initial: 8e6, saturation: 20e6, rate: 7.0 }),
        ]
    }

    /// Slope and work are derivative and integral of the stress, by differences and by Simpson's rule.
    #[test]
    fn slope_and_work_are_those_of_the_stress() {
        for law in laws() {
            for p in [0.01, 0.1, 0.33, 0.49, 0.7, 3.0] {
                let difference = (law.stress(p + 1e-6) - law.stress(p - 1e-6)) / 2e-6;
                assert!((law.flow(one(p)).slope[0] - difference).abs() < 1e-7 * 1e8, "{law:?} {p}");
                let (steps, mut area) = (20_000, 0.0);
                for k in 0..steps {
                    let at = |share: f64| law.stress(p * (f64::from(k) + share) / f64::from(steps));
                    area += p / f64::from(steps) * (at(0.0) + 4.0 * at(0.5) + at(1.0)) / 6.0;
                }
                assert!((law.work(one(p))[0] / area - 1.0).abs() < 1e-8, "{law:?} {p}");
            }
        }
    }

    #[test]
    fn tables_pass_through_their_points_and_stay_at_the_last() {
        let [table, perfect, voce] = laws();
        for (p, stress) in [(0.0, 8e6), (0.05, 12e6), (0.125, 13e6), (0.5, 20e6), (0.8, 20e6), (1e3, 20e6)] {
            assert!((table.stress(p) / stress - 1.0).abs() < 1e-14, "{p}: {}", table.stress(p));
            assert_eq!(perfect.stress(p), 8e6);
        }
        assert_eq!([table.end(), perfect.end(), voce.end()], [0.5, 0.0, f64::INFINITY]);
        assert_eq!([voce.stress(0.0), voce.stress(1e3)], [8e6, 20e6]);
    }

    #[test]
    fn refuses_what_is_no_flow_curve() {
        use CurveError::{StrainNotIncreasing, StressFalls};
        assert_eq!(FlowCurve::new(&[]), Err(FlowCurveError::Empty));
        assert_eq!(FlowCurve::new(&[[0.1, 1.0]]), Err(FlowCurveError::StartsLate { strain: 0.1 }));
        assert_eq!(FlowCurve::new(&[[0.0, 0.0], [0.1, 1.0]]), Err(FlowCurveError::NoStress));
        let again = StrainNotIncreasing { index: 2, strain: 0.1, previous: 0.1 };
        assert_eq!(FlowCurve::new(&[[0.0, 1.0], [0.1, 2.0], [0.1, 3.0]]), Err(FlowCurveError::Curve(again)));
        let falls = StressFalls { index: 1, stress: 0.5, previous: 1.0 };
        assert_eq!(FlowCurve::new(&[[0.0, 1.0], [0.1, 0.5]]), Err(FlowCurveError::Curve(falls)));
    }
}
