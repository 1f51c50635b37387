//! The trend of a figure over an input: a parabola, or a line where there are few values.

/// Least number of different inputs of a parabola.
const LEAST_PARABOLA: usize = 6;

/// The polynomial of second degree, or of first, that fits points with the least squares.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trend {
    /// Where the polynomial is centred, and by what its argument is divided.
    centre: f64,
    scale: f64,
    /// Constant, linear and quadratic part.
    coefficients: [f64; 3],
}

impl Trend {
    /// The trend of `points`; none of less than three, or of points at one place.
    pub fn of_points(points: &[[f64; 2]]) -> Option<Trend> {
        let points: Vec<[f64; 2]> =
            points.iter().copied().filter(|point| point.iter().all(|v| v.is_finite())).collect();
        let mut places: Vec<f64> = points.iter().map(|point| point[0]).collect();
        places.sort_by(f64::total_cmp);
        places.dedup();
        let (first, last) = (*places.first()?, *places.last()?);
        if points.len() < 3 || last <= first {
            return None;
        }
        let (centre, scale) = (0.5 * (first + last), 0.5 * (last - first));
        let terms = if places.len() < LEAST_PARABOLA { 2 } else { 3 };
        let mut system = [[0.0; 4]; 3];
        for [x, y] in points {
            let u = (x - centre) / scale;
            let powers = [1.0, u, u * u];
            for row in 0..terms {
                (0..terms).for_each(|column| system[row][column] += powers[row] * powers[column]);
                system[row][3] += powers[row] * y;
            }
        }
        Some(Trend { centre, scale, coefficients: solved(system, terms)? })
    }

    /// Its value at a place.
    pub fn at(&self, x: f64) -> f64 {
        let u = (x - self.centre) / self.scale;
        let [constant, linear, quadratic] = self.coefficients;
        constant + u * (linear + u * quadratic)
    }
}

/// The solution of the first `count` equations of a symmetric positive system, each with its right side at the end.
fn solved(mut system: [[f64; 4]; 3], count: usize) -> Option<[f64; 3]> {
    for pivot in 0..count {
        let diagonal = system[pivot][pivot];
        if diagonal.is_nan() || diagonal.abs() <= f64::MIN_POSITIVE {
            return None;
        }
        for row in (0..count).filter(|row| *row != pivot) {
            let factor = system[row][pivot] / diagonal;
            let equation = system[pivot];
            system[row].iter_mut().zip(equation).for_each(|(value, other)| *value -= factor * other);
        }
    }
    let mut solution = [0.0; 3];
    (0..count).for_each(|row| solution[row] = system[row][3] / system[row][row]);
    Some(solution)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_parabola_is_its_own_trend() {
        let points: Vec<[f64; 2]> =
            (0..9).map(|i| f64::from(i) * 1e-6).map(|x| [x, 2.0 - 3e5 * x + 4e11 * x * x]).collect();
        let trend = Trend::of_points(&points).unwrap();
        assert!(points.iter().all(|[x, y]| (trend.at(*x) - y).abs() < 1e-9), "{trend:?}");
    }

    #[test]
    fn few_places_have_a_line_and_one_has_none() {
        let trend = Trend::of_points(&[[1.0, 1.0], [1.0, 3.0], [3.0, 4.0], [3.0, 6.0]]).unwrap();
        assert!((trend.at(2.0) - 3.5).abs() < 1e-12 && (trend.at(3.0) - 5.0).abs() < 1e-12);
        assert_eq!(Trend::of_points(&[[1.0, 1.0], [1.0, 2.0], [1.0, 3.0]]), None);
        assert_eq!(Trend::of_points(&[[1.0, 1.0], [2.0, f64::NAN]]), None);
    }
}
