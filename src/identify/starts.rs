//! Several starts, and whether they agree.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardUniform};

use super::options::{Search, Starts};
use super::search::Ended;

/// Relative difference of values beyond which two starts found different minima, and of places beyond which they found
/// different points, where the tolerances are not wider.
const APART: f64 = 0.01;

/// The starts of `search`, its own first.
pub(super) fn all(search: &Search) -> Vec<Vec<f64>> {
    let others = match &search.starts {
        Starts::One => vec![],
        Starts::Given(starts) => starts.clone(),
        Starts::Spread(count) => spread(search, count.saturating_sub(1)),
    };
    std::iter::once(search.start.clone()).chain(others).collect()
}

/// A Latin hypercube: along every axis, each of `count` equal parts of the box holds one point (McKay, Beckman and
/// Conover, Technometrics 21, 1979).
fn spread(search: &Search, count: usize) -> Vec<Vec<f64>> {
    let mut stream = ChaCha8Rng::seed_from_u64(search.seed);
    let mut uniform = || -> f64 { StandardUniform.sample(&mut stream) };
    let mut points = vec![Vec::new(); count];
    for [lower, upper] in search.bounds.pairs() {
        let mut parts: Vec<usize> = (0..count).collect();
        for last in (1..count).rev() {
            parts.swap(last, ((last + 1) as f64 * uniform()) as usize);
        }
        for (point, part) in points.iter_mut().zip(parts) {
            point.push(lower + (upper - lower) * (part as f64 + uniform()) / count as f64);
        }
    }
    points
}

/// What it means where not all starts ended at the best point.
pub(super) fn disagreement(search: &Search, best: &Ended, ended: &[Ended]) -> Vec<String> {
    let worse = |other: &&Ended| other.f - best.f > (APART * best.f.abs()).max(10.0 * search.tol_f);
    let apart = |other: &&Ended| {
        let far = |(a, b): (&f64, &f64)| (a - b).abs() > (APART * b.abs()).max(100.0 * search.tol_x);
        !worse(other) && other.x.iter().zip(&best.x).any(far)
    };
    let mut warnings = Vec::new();
    let higher: Vec<String> = ended.iter().filter(worse).map(|other| format!("{:.6}", other.f)).collect();
    if !higher.is_empty() {
        let (count, all, values) = (higher.len(), ended.len(), higher.join(", "));
        warnings.push(format!(
            "{count} of {all} starts ended higher than {:.6}, at {values}: there are local minima",
            best.f
        ));
    }
    let elsewhere = ended.iter().filter(apart).count();
    if elsewhere > 0 {
        let all = ended.len();
        warnings.push(format!("{elsewhere} of {all} starts ended as low elsewhere: the minimum is not one point"));
    }
    warnings
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identify::{Bounds, Method};

    #[test]
    fn every_part_of_every_axis_holds_one_start() {
        let bounds = Bounds::new(2, Some(vec![-1.0, 10.0]), Some(vec![1.0, 20.0])).unwrap();
        let starts = Starts::Spread(9);
        let search = Search { bounds, starts, seed: 7, ..Search::new(Method::NelderMead, vec![0.0, 11.0]) };
        let points = all(&search);
        assert_eq!((points.len(), &points[0]), (9, &search.start));
        for (axis, [lower, upper]) in search.bounds.pairs().enumerate() {
            let mut parts: Vec<usize> =
                points[1..].iter().map(|x| (8.0 * (x[axis] - lower) / (upper - lower)) as usize).collect();
            parts.sort_unstable();
            assert_eq!(parts, [0, 1, 2, 3, 4, 5, 6, 7]);
        }
        assert_ne!(all(&Search { seed: 8, ..search.clone() }), points);
        assert_eq!(all(&search), points);
    }
}
