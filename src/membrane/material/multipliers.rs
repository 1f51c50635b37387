//! The multipliers k₁, k_e, k_y, which scale a quasi-static curve to a dynamic one.

use super::curve::{Curve, CurveError};

/// Multipliers of a curve with two yield points (Polymers 2021, 13, 1537, equations 12 and 13,
/// in the form of the identification loop's first step; methods.md, section 5).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Multipliers {
    /// Divisor of strains up to the first yield point, besides `ke`.
    pub k1: f64,
    /// Divisor of strains up to the second yield point.
    pub ke: f64,
    /// Factor on the stress up to the second yield point.
    pub ky: f64,
}

impl Default for Multipliers {
    fn default() -> Self {
        Multipliers { k1: 1.0, ke: 1.0, ky: 1.0 }
    }
}

impl Multipliers {
    /// The scaled curve; `yields` are the strains of its two yield points.
    ///
    /// (a) ε ≤ ε_y1: ε := ε/(k₁k_e); (b) ε_y1 < ε ≤ ε_y2: ε := (ε − ε_y1)/k_e + ε_y1/(k₁k_e);
    /// (c) ε ≤ ε_y2: σ := k_y σ; (d) ε > ε_y2: shifted with the second yield point.
    pub fn apply(&self, curve: &Curve, yields: [f64; 2]) -> Result<Curve, CurveError> {
        let [first, second] = yields;
        let second_stress = curve.stress(second);
        let moved_second = self.strain(second, yields);
        let shift = [moved_second - second, (self.ky - 1.0) * second_stress];
        let corners = with_corners_at(curve, yields);
        let moved = corners.into_iter().map(|[strain, stress]| {
            if strain <= second {
                [self.strain(strain, [first, second]), self.ky * stress]
            } else {
                [strain + shift[0], stress + shift[1]]
            }
        });
        Curve::new(moved.collect())
    }

    /// The scaled value of a strain up to the second yield point.
    pub fn strain(&self, strain: f64, [first, _]: [f64; 2]) -> f64 {
        let rigid = self.k1 * self.ke;
        if strain <= first { strain / rigid } else { (strain - first) / self.ke + first / rigid }
    }
}

/// The corners of the curve and of the map: one at each yield strain.
fn with_corners_at(curve: &Curve, yields: [f64; 2]) -> Vec<[f64; 2]> {
    let mut corners = curve.points().to_vec();
    for strain in yields {
        let place = corners.partition_point(|p| p[0] < strain);
        if corners.get(place).is_none_or(|p| p[0] != strain) && strain < curve.end() {
            corners.insert(place, [strain, curve.stress(strain)]);
        }
    }
    corners
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Tables 4, 5 and 8 of the paper: MD and TD, scaled by the multipliers of test 1008 (k1 2.75, ke 3.41, ky 1.00)
    /// and 1510 (3.07, 2.29, 1.04). By hand, e.g. MD 1008: 0.26/(2.75·3.41) = 0.027726; (0.84 − 0.26)/3.41 + 0.027726 =
    /// 0.197814; 1.39 + 0.197814 − 0.84 = 0.747814.
    #[test]
    fn moves_the_papers_yield_points() {
        let md = vec![[0.26, 8.4e6], [0.84, 20e6], [1.39, 29.3e6]];
        let td = vec![[0.33, 8e6], [0.69, 10e6], [7.01, 16.2e6]];
        let k1008 = Multipliers { k1: 2.75, ke: 3.41, ky: 1.0 };
        let k1510 = Multipliers { k1: 3.07, ke: 2.29, ky: 1.04 };
        let cases = [
            (md.clone(), [0.26, 0.84], k1008, [[0.027726, 8.4e6], [0.197814, 20e6], [0.747814, 29.3e6]]),
            (td.clone(), [0.33, 0.69], k1008, [[0.035191, 8e6], [0.140763, 10e6], [6.460763, 16.2e6]]),
            (md, [0.26, 0.84], k1510, [[0.036983, 8.736e6], [0.290258, 20.8e6], [0.840258, 30.1e6]]),
            (td, [0.33, 0.69], k1510, [[0.046940, 8.32e6], [0.204145, 10.4e6], [6.524145, 16.6e6]]),
        ];
        for (points, yields, k, expected) in cases {
            let moved = k.apply(&Curve::new(points).unwrap(), yields).unwrap();
            for (got, want) in moved.points().iter().zip(expected) {
                assert!((got[0] - want[0]).abs() < 1e-6, "{got:?} for {want:?}");
                assert!((got[1] - want[1]).abs() < 1.0, "{got:?} for {want:?}");
            }
        }
    }

    #[test]
    fn ones_change_nothing() {
        let curve = Curve::new(vec![[0.2, 1.0], [0.5, 3.0], [2.0, 4.0]]).unwrap();
        assert_eq!(Multipliers::default().apply(&curve, [0.2, 0.5]).unwrap(), curve);
    }

    /// The yield strains become corners of the scaled curve although a fine curve has corners elsewhere.
    #[test]
    fn keeps_the_stress_at_yield_strains_between_points() {
        let curve = Curve::new(vec![[0.1, 1.0], [0.5, 3.0], [2.0, 4.0]]).unwrap();
        let k = Multipliers { k1: 2.0, ke: 4.0, ky: 1.5 };
        let moved = k.apply(&curve, [0.3, 0.8]).unwrap();
        let first = 0.3 / 8.0;
        let second = first + 0.5 / 4.0;
        assert!((moved.stress(first) - 1.5 * 2.0).abs() < 1e-12);
        assert!((moved.stress(second) - 1.5 * 3.2).abs() < 1e-12);
        assert!((moved.end() - (2.0 + second - 0.8)).abs() < 1e-12);
    }
}
