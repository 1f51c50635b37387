//! Likelihood of outcomes by level: P(failure) = Φ(z), z = a + b x.

use super::Counts;
use crate::normal;

/// ln Φ(z), beyond where Φ itself is zero.
fn log_cumulative(z: f64) -> f64 {
    if z > -37.0 {
        return libm::log(normal::cumulative(z));
    }
    // Two terms of the asymptotic series φ(z)/|z| (1 − 1/z² + 3/z⁴ − …).
    -0.5 * z * z - libm::log(-z) + libm::log1p(-1.0 / (z * z)) - 0.5 * libm::log(2.0 * std::f64::consts::PI)
}

/// Derivative of ln Φ: the inverse of Mills's ratio.
fn hazard(z: f64) -> f64 {
    // Both underflow farther out, where the asymptotic series leaves out less than 1e-8 of it.
    if z > -37.0 { normal::density(z) / normal::cumulative(z) } else { -z - 1.0 / z + 2.0 / (z * z * z) }
}

/// Weighted outcomes at standardized levels.
pub(super) struct Likelihood {
    /// Level, failures and survivors.
    groups: Vec<(f64, f64, f64)>,
}

impl Likelihood {
    /// Levels are taken from `centre`, in units of `scale`.
    pub fn new(counts: &[Counts], centre: f64, scale: f64) -> Self {
        let group = |c: &Counts| ((c.level - centre) / scale, c.failures as f64, (c.trials - c.failures) as f64);
        Self { groups: counts.iter().map(group).collect() }
    }

    /// Logarithm of the likelihood.
    pub fn log(&self, a: f64, b: f64) -> f64 {
        let of_group = |&(x, failed, survived): &(f64, f64, f64)| {
            let z = a + b * x;
            // 0 · −∞ would be a NaN.
            let part = |count: f64, z: f64| if count > 0.0 { count * log_cumulative(z) } else { 0.0 };
            part(failed, z) + part(survived, -z)
        };
        self.groups.iter().map(of_group).sum()
    }

    /// Derivatives by a and b.
    pub fn gradient(&self, a: f64, b: f64) -> [f64; 2] {
        self.groups.iter().fold([0.0; 2], |[by_a, by_b], &(x, failed, survived)| {
            let z = a + b * x;
            let slope = failed * hazard(z) - survived * hazard(-z);
            [by_a + slope, by_b + slope * x]
        })
    }

    /// Second derivatives by aa, ab and bb, negated: positive definite, since the logarithm of Φ is concave.
    fn curvature(&self, a: f64, b: f64) -> [f64; 3] {
        self.groups.iter().fold([0.0; 3], |[aa, ab, bb], &(x, failed, survived)| {
            let z = a + b * x;
            let part = |z: f64| hazard(z) * (hazard(z) + z);
            let weight = failed * part(z) + survived * part(-z);
            [aa + weight, ab + weight * x, bb + weight * x * x]
        })
    }

    /// Maximum by Newton's method with step halving.
    pub fn maximum(&self) -> (f64, f64) {
        let (mut a, mut b) = (0.0, 0.0);
        for _ in 0..MOST_ITERATIONS {
            let [by_a, by_b] = self.gradient(a, b);
            let [aa, ab, bb] = self.curvature(a, b);
            let determinant = aa * bb - ab * ab;
            let (da, db) = ((bb * by_a - ab * by_b) / determinant, (aa * by_b - ab * by_a) / determinant);
            let here = self.log(a, b);
            let mut t = 1.0;
            // The logarithm is concave, so the direction always rises; a full step may still overshoot where the tails
            // are flat.
            while self.log(a + t * da, b + t * db) < here && t > 1e-9 {
                t *= 0.5;
            }
            (a, b) = (a + t * da, b + t * db);
            if da.abs() <= 1e-12 * (1.0 + a.abs()) && db.abs() <= 1e-12 * (1.0 + b.abs()) {
                break;
            }
        }
        (a, b)
    }
}

const MOST_ITERATIONS: usize = 200;

/// Expected information about mean and deviation of the strength from `trials` at `level`, summed: by mean and mean,
/// mean and deviation, deviation and deviation, where z = (level − mean)/deviation.
pub(super) fn information(counts: &[Counts], mean: f64, deviation: f64) -> [f64; 3] {
    counts.iter().fold([0.0; 3], |[mm, md, dd], c| {
        let z = (c.level - mean) / deviation;
        // φ²/(Φ(z) Φ(−z)) as a product of hazards, which does not underflow in the tails.
        let weight = c.trials as f64 * hazard(z) * hazard(-z) / (deviation * deviation);
        [mm + weight, md + weight * z, dd + weight * z * z]
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_far_tail_continues_the_near_one() {
        assert!((log_cumulative(-36.999_999) / log_cumulative(-37.000_001) - 1.0).abs() < 1e-6);
        assert!((hazard(-36.999_999) / hazard(-37.000_001) - 1.0).abs() < 1e-6);
    }

    #[test]
    fn gradient_and_curvature_are_derivatives() {
        let counts =
            [(1.0, 5, 1), (2.0, 8, 5), (3.5, 4, 3)].map(|(level, trials, failures)| Counts { level, trials, failures });
        let likelihood = Likelihood::new(&counts, 2.0, 1.5);
        let (a, b, h) = (0.3, 0.8, 1e-5);
        let by_a = (likelihood.log(a + h, b) - likelihood.log(a - h, b)) / (2.0 * h);
        let by_b = (likelihood.log(a, b + h) - likelihood.log(a, b - h)) / (2.0 * h);
        let gradient = likelihood.gradient(a, b);
        assert!((gradient[0] - by_a).abs() < 1e-8 && (gradient[1] - by_b).abs() < 1e-8);
        let change = |index: usize, da: f64, db: f64| {
            (likelihood.gradient(a - da, b - db)[index] - likelihood.gradient(a + da, b + db)[index]) / (2.0 * h)
        };
        let curvature = likelihood.curvature(a, b);
        for (found, expected) in curvature.iter().zip([change(0, h, 0.0), change(0, 0.0, h), change(1, 0.0, h)]) {
            assert!((found - expected).abs() < 1e-8, "{found} {expected}");
        }
    }
}
