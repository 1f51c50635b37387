//! The work left of a sweep: runs that neither an earlier sweep, nor this process, nor another has computed.

use std::time::{Duration, Instant};

use super::{Case, Sweep};
use crate::evaluate::Evaluations;
use crate::store::evaluations::Share;

/// Most runs of a sample.
const MOST: usize = 200;

/// Most time for a sample.
const LIMIT: Duration = Duration::from_millis(300);

/// Time until the first sample, and the longest between two: each is twice the one before.
const FIRST: Duration = Duration::from_millis(500);
const LONGEST: Duration = Duration::from_secs(60);

/// Remaining work of a sweep.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RemainingWork {
    /// Runs that are still to be computed, by this process or others.
    pub left: usize,
    /// Runs that other processes have computed since this one began.
    pub elsewhere: usize,
}

/// How far a process is.
#[derive(Clone, Copy, Debug)]
pub(super) struct Position {
    /// Runs that nobody here has looked at.
    pub waiting: usize,
    /// Runs that are under way, here or elsewhere.
    pub begun: usize,
    /// Runs that were computed here.
    pub computed: usize,
}

/// Estimates what is left from samples of the runs that wait.
#[derive(Debug)]
pub(super) struct Estimator {
    /// Records of others when the process began.
    before: usize,
    /// The number of runs left at the last sample, and of those that were computed by then, here and elsewhere.
    sampled: Option<[usize; 2]>,
    next: Instant,
    pause: Duration,
}

impl Estimator {
    /// Of a process that begins now.
    pub(super) fn new(evaluations: &Evaluations) -> Estimator {
        let before = evaluations.store().others();
        Estimator { before, sampled: None, next: Instant::now() + FIRST, pause: FIRST }
    }

    /// The work left at `position`, where `sample` gives at most so many places of runs that wait, spread evenly; none
    /// before the first sample, and where all records are of this process, which knows it then.
    pub(super) fn remaining_work(
        &mut self,
        sweep: &Sweep,
        evaluations: &Evaluations,
        Position { waiting, begun, computed }: Position,
        sample: impl FnOnce(usize) -> Vec<usize>,
    ) -> Option<RemainingWork> {
        let others = evaluations.store().others();
        if others == 0 {
            return None;
        }
        let elsewhere = others - self.before;
        if Instant::now() >= self.next {
            let unknown = waiting as f64 * unknown_share(sweep, evaluations, &sample(MOST));
            self.sampled = Some([unknown.round() as usize + begun, computed + elsewhere]);
            // A sample takes time from the runs: in a long sweep it becomes rare.
            self.pause = (2 * self.pause).min(LONGEST);
            self.next = Instant::now() + self.pause;
        }
        let [left, by_then] = self.sampled?;
        let since = (computed + elsewhere).saturating_sub(by_then);
        // A sample may err; the runs that have begun are left for certain.
        Some(RemainingWork { left: left.saturating_sub(since).max(begun), elsewhere })
    }
}

/// The share of the runs at `places` that have no record, of as many as there is time for.
fn unknown_share(sweep: &Sweep, evaluations: &Evaluations, places: &[usize]) -> f64 {
    let begin = Instant::now();
    let is_unknown = |place: usize| match sweep.case(place) {
        Ok(Case { keys, .. }) => !evaluations.store().contains(keys.figures),
        Err(_) => false,
    };
    let (mut looked, mut unknown) = (0_usize, 0_usize);
    // In steps that cover the places evenly, however early it ends.
    for turn in Share::WHOLE.order(places.len()) {
        if looked > 0 && begin.elapsed() > LIMIT {
            break;
        }
        looked += 1;
        unknown += usize::from(is_unknown(places[turn]));
    }
    if looked == 0 { 0.0 } else { unknown as f64 / looked as f64 }
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::path::Path;

    use super::*;
    use base::cancellation::Cancellation;
    use scene::scenario::{Assignment, Document};

    /// A sweep of so many masses.
    fn sweep(folder: &Path, count: usize) -> Sweep {
        let path = folder.join("a.toml");
        let masses: Vec<String> = (0..count).map(|number| format!("{}", 10.0 + 0.01 * number as f64)).collect();
        let base = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/drop/1008.toml");
        fs::write(&path, format!("extends = {base:?}\nunset = [\"reference\", \"post\"]\n")).unwrap();
        let set = [
            "specimen.mesh.size=\"80 mm\"".to_owned(),
            "loading.impact.duration=\"3 ms\"".to_owned(),
            format!("variation={{ \"impactor.mass\" = [{}] }}", masses.join(", ")),
        ];
        let set: Vec<Assignment> = set.iter().map(|text| Assignment::from_argument(text).unwrap()).collect();
        Sweep::prepare(&Document::read(&path).unwrap().with(&set), None).unwrap()
    }

    fn compute(sweep: &Sweep, evaluations: &Evaluations, places: impl Iterator<Item = usize>) {
        for place in places {
            let Case { model, plan, keys } = sweep.case(place).unwrap();
            evaluations.evaluate(&model, &plan, keys, &Cancellation::default()).unwrap();
        }
    }

    #[test]
    fn runs_of_earlier_sweeps_and_of_other_processes_are_not_left() {
        let folder = tempfile::tempdir().unwrap();
        let store = folder.path().join("store");
        let sweep = sweep(folder.path(), 30);
        let now = |estimator: &mut Estimator| estimator.next = Instant::now();
        let later = |estimator: &mut Estimator| estimator.next = Instant::now() + Duration::from_secs(3600);
        let at = |computed| Position { waiting: 26, begun: 2, computed };
        let waiting = |_: usize| (4..30).collect();

        let alone = Evaluations::open(&store).unwrap();
        let mut estimator = Estimator::new(&alone);
        now(&mut estimator);
        assert_eq!(estimator.remaining_work(&sweep, &alone, at(2), waiting), None);
        compute(&sweep, &alone, (10..20).chain([0]));

        let [here, other] = [(); 2].map(|()| Evaluations::open(&store).unwrap());
        let mut estimator = Estimator::new(&here);
        later(&mut estimator);
        assert_eq!(estimator.remaining_work(&sweep, &here, at(2), waiting), None);
        now(&mut estimator);
        let left = 26 - 10 + 2;
        assert_eq!(estimator.remaining_work(&sweep, &here, at(2), waiting), Some(RemainingWork { left, elsewhere: 0 }));
        later(&mut estimator);
        compute(&sweep, &other, 25..28);
        here.store().refresh().unwrap();
        let expected = RemainingWork { left: left - 4, elsewhere: 3 };
        assert_eq!(estimator.remaining_work(&sweep, &here, at(3), waiting), Some(expected));
        now(&mut estimator);
        let expected = RemainingWork { left: left - 3, elsewhere: 3 };
        assert_eq!(estimator.remaining_work(&sweep, &here, at(3), waiting), Some(expected));
    }
}
