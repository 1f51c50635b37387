//! The strain-rate audit: strain rates of the film beside those at which its curves were measured.

use serde::{Deserialize, Serialize};

use membrane::engine::ElementStrain;

/// Bins a decade.
const PER_DECADE: usize = 4;
/// Decades covered, as powers of ten, 1/s.
const DECADES: (i32, i32) = (-5, 5);

/// Relative tolerance at the ends of the measured range.
const TOLERANCE: f64 = 0.01;

/// Shares of the strain increments of the film by strain rate. An increment is the growth of the largest strain of an
/// element and counts with the element's volume; only the loading phase is counted.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct RateHistogram {
    /// Edges of the bins, 1/s, logarithmic.
    pub edges: Vec<f64>,
    /// Share in each bin; they sum to one unless no element was strained.
    pub shares: Vec<f64>,
    /// Range in which the curves were measured, 1/s.
    pub measured: Option<[f64; 2]>,
    /// Share outside that range.
    pub outside: f64,
}

/// Collects strain increments by strain rate, weighted with volume.
#[derive(Serialize, Deserialize)]
pub(super) struct RateAudit {
    /// Range in which the curves of each face were measured.
    measured: Vec<Option<[f64; 2]>>,
    /// Of the bins, 1/s.
    edges: Vec<f64>,
    loading: Weights,
    /// Increments since the last commit.
    pending: Weights,
    /// Time of the last sample and the largest strains of each face's elements until then.
    last: Option<(f64, Vec<Vec<[f64; 2]>>)>,
}

#[derive(Clone, Serialize, Deserialize)]
struct Weights {
    bins: Vec<f64>,
    outside: f64,
}

/// Edges of the bins, 1/s.
fn edges() -> Vec<f64> {
    let bins = (DECADES.1 - DECADES.0) as usize * PER_DECADE;
    (0..=bins).map(|k| 10.0_f64.powf(f64::from(DECADES.0) + k as f64 / PER_DECADE as f64)).collect()
}

/// The bin of `rate` (1/s). Rates of neighbouring elements are similar, so the bin of the last is tried first.
fn bin(edges: &[f64], rate: f64, last: usize) -> usize {
    match edges[last..] {
        [low, high, ..] if low <= rate && rate < high => last,
        _ => edges.partition_point(|edge| *edge <= rate).saturating_sub(1),
    }
}

impl RateAudit {
    pub(super) fn new(measured: Vec<Option<[f64; 2]>>) -> RateAudit {
        let edges = edges();
        let none = Weights { bins: vec![0.0; edges.len() - 1], outside: 0.0 };
        RateAudit { measured, edges, loading: none.clone(), pending: none, last: None }
    }

    /// Whether both are of faces with the same curves, in the same bins.
    pub(super) fn is_like(&self, other: &RateAudit) -> bool {
        let bins = |audit: &RateAudit| [&audit.loading, &audit.pending].map(|weights| weights.bins.len());
        self.measured == other.measured && self.edges == other.edges && bins(self) == bins(other)
    }

    /// Adds the increments up to the strains of all faces at `time` (s).
    pub(super) fn sample(&mut self, time: f64, faces: &[Vec<ElementStrain>]) {
        let now = |s: &ElementStrain| [s.strain[0].max(0.0), s.strain[1].max(0.0)];
        let Some((before, largest)) = &mut self.last else {
            self.last = Some((time, faces.iter().map(|face| face.iter().map(now).collect()).collect()));
            return;
        };
        let dt = time - *before;
        *before = time;
        let mut bin = 0;
        for ((face, largest), measured) in faces.iter().zip(largest).zip(&self.measured) {
            for (element, largest) in face.iter().zip(largest).filter(|(element, _)| element.volume > 0.0) {
                for ((strain, largest), left) in now(element).into_iter().zip(largest).zip(element.left) {
                    let gained = strain - *largest;
                    if gained > 0.0 && left > 0.0 {
                        let rate = gained / dt;
                        bin = self::bin(&self.edges, rate, bin);
                        self.pending.count(*measured, bin, rate, gained * element.volume);
                        *largest = strain;
                    }
                }
            }
        }
    }

    /// Counts the increments so far as part of the loading phase.
    pub(super) fn commit(&mut self) {
        for (bin, pending) in self.loading.bins.iter_mut().zip(&mut self.pending.bins) {
            *bin += std::mem::take(pending);
        }
        self.loading.outside += std::mem::take(&mut self.pending.outside);
    }

    /// The histogram of the loading phase; its measured range is the intersection of those of all faces, if there is
    /// one.
    pub(super) fn finish(self) -> RateHistogram {
        let total: f64 = self.loading.bins.iter().sum();
        let share = |w: f64| if total > 0.0 { w / total } else { 0.0 };
        let ranges = self.measured.iter().flatten().copied();
        let shared = ranges.reduce(|[a, b], [c, d]| [a.max(c), b.min(d)]);
        RateHistogram {
            edges: self.edges,
            shares: self.loading.bins.iter().map(|w| share(*w)).collect(),
            measured: shared.filter(|[low, high]| low <= high),
            outside: share(self.loading.outside),
        }
    }
}

impl Weights {
    fn count(&mut self, measured: Option<[f64; 2]>, bin: usize, rate: f64, weight: f64) {
        let last = self.bins.len() - 1;
        self.bins[bin.min(last)] += weight;
        if measured.is_some_and(|[low, high]| rate < (1.0 - TOLERANCE) * low || rate > (1.0 + TOLERANCE) * high) {
            self.outside += weight;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn strained(peak: f64) -> Vec<Vec<ElementStrain>> {
        vec![vec![ElementStrain { strain: [peak, 0.0, 0.0], peak: [peak, 0.0], left: [1.0; 2], volume: 1.0 }]]
    }

    #[test]
    fn increments_of_the_largest_strain_are_counted_by_rate() {
        let mut audit = RateAudit::new(vec![Some([1.0, 40.0])]);
        for (time, peak) in [(0.0, 0.0), (0.1, 0.5), (0.2, 0.5), (0.201, 1.0)] {
            audit.sample(time, &strained(peak));
        }
        audit.commit();
        let histogram = audit.finish();
        let at = |rate: f64| histogram.edges.partition_point(|e| *e <= rate) - 1;
        assert!((histogram.shares[at(5.0)] - 0.5).abs() < 1e-12);
        assert!((histogram.shares[at(499.0)] - 0.5).abs() < 1e-12);
        assert!((histogram.outside - 0.5).abs() < 1e-12);
    }

    #[test]
    fn an_audit_without_bins_is_like_none() {
        let [audit, mut other] = [(); 2].map(|()| RateAudit::new(vec![Some([1.0, 40.0])]));
        assert!(audit.is_like(&other));
        other.pending.bins.clear();
        assert!(!audit.is_like(&other));
        assert!(!audit.is_like(&RateAudit::new(vec![None])));
    }

    #[test]
    fn the_measured_range_is_the_intersection_of_those_of_the_faces() {
        let shared = |faces: [[f64; 2]; 2]| RateAudit::new(faces.map(Some).to_vec()).finish().measured;
        assert_eq!(shared([[0.04, 4.0], [1.0, 100.0]]), Some([1.0, 4.0]));
        assert_eq!(shared([[0.04, 4.0], [10.0, 100.0]]), None);
    }
}
