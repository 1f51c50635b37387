//! The strain-rate audit: how fast the film was strained against how fast its curves were measured.

use super::RateHistogram;
use crate::engine::ElementStrain;

/// Bins a decade.
const PER_DECADE: usize = 4;
/// Decades covered, as powers of ten, 1/s.
const DECADES: (i32, i32) = (-5, 5);

/// By how much a rate may miss an end of the measured range and still count as inside.
const EDGE: f64 = 0.01;

/// Straining of virgin film by rate, weighted with volume and strain.
pub(super) struct RateAudit {
    measured: Option<[f64; 2]>,
    weights: Vec<f64>,
    outside: f64,
    last: Option<(f64, Vec<Vec<ElementStrain>>)>,
}

impl RateAudit {
    pub(super) fn new(measured: Option<[f64; 2]>) -> RateAudit {
        let bins = (DECADES.1 - DECADES.0) as usize * PER_DECADE;
        RateAudit { measured, weights: vec![0.0; bins], outside: 0.0, last: None }
    }

    /// Takes in the strains of all faces at `time` (s); only strain beyond the largest so far counts.
    pub(super) fn sample(&mut self, time: f64, faces: &[Vec<ElementStrain>]) {
        if let Some((before, last)) = &self.last {
            let dt = time - before;
            for (now, then) in faces.iter().flatten().zip(last.iter().flatten()) {
                for fibre in 0..2 {
                    let gained = now.peak[fibre] - then.peak[fibre];
                    if gained > 0.0 && now.volume > 0.0 {
                        count(&mut self.weights, &mut self.outside, self.measured, gained / dt, gained * now.volume);
                    }
                }
            }
        }
        self.last = Some((time, faces.to_vec()));
    }

    pub(super) fn finish(self) -> RateHistogram {
        let total: f64 = self.weights.iter().sum();
        let share = |w: f64| if total > 0.0 { w / total } else { 0.0 };
        let edge = |k: usize| 10.0_f64.powf(f64::from(DECADES.0) + k as f64 / PER_DECADE as f64);
        RateHistogram {
            edges: (0..=self.weights.len()).map(edge).collect(),
            shares: self.weights.iter().map(|w| share(*w)).collect(),
            measured: self.measured,
            outside: share(self.outside),
        }
    }
}

fn count(weights: &mut [f64], outside: &mut f64, measured: Option<[f64; 2]>, rate: f64, weight: f64) {
    let place = ((rate.log10() - f64::from(DECADES.0)) * PER_DECADE as f64).floor();
    let bin = (place.max(0.0) as usize).min(weights.len() - 1);
    weights[bin] += weight;
    if measured.is_some_and(|[low, high]| rate < (1.0 - EDGE) * low || rate > (1.0 + EDGE) * high) {
        *outside += weight;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn strained(peak: f64) -> Vec<Vec<ElementStrain>> {
        vec![vec![ElementStrain { strain: [peak, 0.0, 0.0], peak: [peak, 0.0], volume: 1.0 }]]
    }

    #[test]
    fn counts_virgin_strain_by_rate() {
        let mut audit = RateAudit::new(Some([1.0, 40.0]));
        for (time, peak) in [(0.0, 0.0), (0.1, 0.5), (0.2, 0.5), (0.201, 1.0)] {
            audit.sample(time, &strained(peak));
        }
        let histogram = audit.finish();
        let at = |rate: f64| histogram.edges.partition_point(|e| *e <= rate) - 1;
        assert!((histogram.shares[at(5.0)] - 0.5).abs() < 1e-12);
        assert!((histogram.shares[at(499.0)] - 0.5).abs() < 1e-12);
        assert!((histogram.outside - 0.5).abs() < 1e-12);
    }
}
