//! The energy balance of a run, and its strain rates beside those at which its curves were measured.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::fault::Fault;
use lab::signal::{Channel, Recording};
use membrane::engine::{ElementStrain, Energies, EnergyTerm};

/// The sum of the terms as a channel.
const SUM: EnergyTerm = EnergyTerm {
    name: "sum_J",
    sentence: &["Sum of all terms, which is constant but for the error of the energy balance."],
};

/// The columns of a run's energies.
pub fn energy_columns() -> impl Iterator<Item = EnergyTerm> {
    Energies::TERMS.iter().copied().chain([SUM])
}

/// Balance error, over the energy exchanged, that stops a run.
const STOP: f64 = 0.1;

/// Share of the energy taken up that tears have taken from which on film moves with them.
const TORN: f64 = 0.01;

/// Least divisor of the balance error over the run's own scale of energy.
const FLOOR: f64 = 0.02;

/// Share of the largest term below which a gap is round-off: pre-strain alone may store far more than a run moves.
const ROUND_OFF: f64 = 1e-12;

/// The energy audit through a run.
#[derive(Serialize, Deserialize)]
pub(super) struct EnergyCheck {
    scale: f64,
    /// Time from which a lost balance stops the run, s.
    from: f64,
    start: Option<Energies>,
    time: Vec<f64>,
    rows: Vec<Energies>,
    /// Largest losses in contact, in friction and in the guide so far, J.
    lost: [f64; 3],
    largest_gap: f64,
    most_exchanged: f64,
    largest_term: f64,
}

impl EnergyCheck {
    /// `scale` is an energy (J) that the run exchanges at least, such as the impactor's. The run is not
    /// stopped before the time `from` (s): a slow loading has no such scale, and little energy to divide by until then.
    pub(super) fn new(scale: f64, from: f64) -> EnergyCheck {
        EnergyCheck {
            scale,
            from,
            start: None,
            time: vec![],
            rows: vec![],
            lost: [0.0; 3],
            largest_gap: 0.0,
            most_exchanged: 0.0,
            largest_term: 0.0,
        }
    }

    /// Adds the energies at `time` (s).
    ///
    /// # Errors
    /// The energy balance is lost.
    pub(super) fn sample(&mut self, time: f64, energies: Energies) -> Result<(), Fault> {
        let start = *self.start.get_or_insert(energies);
        self.time.push(time);
        self.rows.push(energies);
        let gap = energies.total() - start.total() + self.recovered(&energies);
        self.largest_gap = self.largest_gap.max(gap.abs());
        self.most_exchanged = self.most_exchanged.max(energies.exchanged(&start));
        self.largest_term = energies.terms().iter().fold(self.largest_term, |most, term| most.max(term.abs()));
        if time < self.from { Ok(()) } else { self.fault().map_or(Ok(()), Err) }
    }

    /// The fault of a run whose energy balance is lost.
    pub(super) fn fault(&self) -> Option<Fault> {
        let (time, error) = (*self.time.last()?, self.balance_error());
        (error > STOP).then_some(Fault::EnergyBalance { time, error })
    }

    /// Decrease of the losses in contact, friction and guide from their largest values, J: an error that the sum of all
    /// terms does not show.
    fn recovered(&mut self, energies: &Energies) -> f64 {
        let now = [energies.contact, energies.friction, energies.guide];
        (0..3)
            .map(|k| {
                self.lost[k] = self.lost[k].max(now[k]);
                self.lost[k] - now[k]
            })
            .sum()
    }

    /// Largest |ΣE − E₀|, plus the decrease of losses, over the largest energy exchanged.
    pub(super) fn balance_error(&self) -> f64 {
        let exchanged = self.most_exchanged.max(FLOOR * self.scale).max(ROUND_OFF * self.largest_term);
        if exchanged > 0.0 { self.largest_gap / exchanged } else { 0.0 }
    }

    /// Energy that the film has taken up since the start with the springs on which it hangs, J.
    fn taken_up(&self, energies: &Energies) -> f64 {
        let inner = |e: &Energies| e.stored + e.absorbed + e.rupture + e.springs;
        inner(energies) - self.start.as_ref().map_or(0.0, inner)
    }

    fn most_taken_up(&self) -> f64 {
        self.rows.iter().map(|e| self.taken_up(e)).fold(0.0, f64::max)
    }

    /// Time (s) and size of the largest ratio of kinetic energy to the energy that the film has taken up, where that is
    /// more than a tenth of its maximum; of film that `can_tear` until a tear has taken a share of it, since one that runs
    /// moves the film.
    pub(super) fn kinetic_share(&self, can_tear: bool) -> (f64, f64) {
        let least = 0.1 * self.most_taken_up();
        let rows =
            self.time.iter().zip(&self.rows).take_while(|(_, e)| !can_tear || e.rupture <= TORN * self.taken_up(e));
        let rows = rows.filter(|(_, e)| self.taken_up(e) > least);
        let shares = rows.map(|(time, e)| (*time, e.kinetic_film / self.taken_up(e)));
        shares.fold((0.0, 0.0), |most, now| if now.1 > most.1 { now } else { most })
    }

    /// Energy lost to damping over the largest energy that the film took up.
    pub(super) fn damping_share(&self) -> f64 {
        let most = self.most_taken_up();
        self.rows.last().map_or(0.0, |e| if most > 0.0 { e.damping / most } else { 0.0 })
    }

    /// One channel a term, and their sum.
    pub(super) fn recording(&self) -> Recording {
        let channel = |(place, term): (usize, &EnergyTerm)| Channel {
            name: term.name.to_owned(),
            values: self.rows.iter().map(|e| e.terms()[place]).collect(),
        };
        let mut channels: Vec<Channel> = Energies::TERMS.iter().enumerate().map(channel).collect();
        channels.push(Channel { name: SUM.name.to_owned(), values: self.rows.iter().map(Energies::total).collect() });
        Recording { time: self.time.clone(), channels }
    }
}

/// Bins a decade.
const PER_DECADE: usize = 4;
/// Decades covered, as powers of ten, 1/s.
const DECADES: (i32, i32) = (-5, 5);

/// Relative tolerance at the ends of the measured range.
const TOLERANCE: f64 = 0.01;

/// Shares of the strain increments of the film by strain rate. An increment is the growth of the largest strain of an
/// element and counts with the element's volume; only the loading phase is counted.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct RateHistogram {
    /// Edges of the bins, 1/s, logarithmic.
    #[serde(rename = "edges_1_s")]
    pub edges: Vec<f64>,
    /// Share in each bin; they sum to one unless no element was strained.
    pub shares: Vec<f64>,
    /// Range in which the curves were measured, 1/s.
    #[serde(rename = "measured_1_s")]
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

    #[test]
    fn round_off_of_a_large_prestrain_energy_is_no_error() {
        let mut check = EnergyCheck::new(0.0, 0.0);
        let stored = |stored: f64| Energies { stored, ..Energies::default() };
        assert_eq!(check.sample(0.0, stored(1.0)), Ok(()));
        assert_eq!(check.sample(1.0, stored(1.0 + f64::EPSILON)), Ok(()));
        assert!(check.sample(2.0, stored(1.0 + 1e-9)).is_err());
    }

    #[test]
    fn the_balance_of_a_slow_start_is_not_checked() {
        let mut check = EnergyCheck::new(0.0, 1.0);
        let moved = |given: f64| Energies { stored: given - 1e-3, external: -given, ..Energies::default() };
        assert_eq!(check.sample(0.0, Energies::default()), Ok(()));
        assert_eq!(check.sample(0.5, moved(2e-3)), Ok(()));
        assert!(check.fault().is_some(), "the balance of a run that ends here is lost");
        assert_eq!(check.sample(1.0, moved(1.0)), Ok(()));
        assert!(check.sample(2.0, Energies { stored: 2.0, ..Energies::default() }).is_err());
    }

    fn strained(peak: f64) -> Vec<Vec<ElementStrain>> {
        vec![vec![ElementStrain {
            strain: [peak, 0.0, 0.0],
            peak: [peak, 0.0],
            left: [1.0; 2],
            volume: 1.0,
            ..ElementStrain::default()
        }]]
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
