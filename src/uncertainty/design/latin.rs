//! Latin hypercube sampling.

use crate::random::Stream;

pub(super) fn points(factors: usize, samples: usize, seed: u64) -> Vec<Vec<f64>> {
    let mut stream = Stream::new(seed);
    let mut points = vec![Vec::with_capacity(factors); samples];
    for _ in 0..factors {
        // Each factor by an order of its own: each of its strata has one point, whatever the others do.
        let strata = stream.permutation(samples);
        for (point, stratum) in points.iter_mut().zip(strata) {
            point.push(within(stratum, samples, stream.uniform()));
        }
    }
    points
}

/// Point at the part `u` of a stratum, which rounding must not move into the next one.
fn within(stratum: usize, samples: usize, u: f64) -> f64 {
    let end = ((stratum + 1) as f64 / samples as f64).next_down();
    ((stratum as f64 + u) / samples as f64).min(end)
}
