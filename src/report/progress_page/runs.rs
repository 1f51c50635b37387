//! The runs that a study asks for: how many wait, run, are done or failed, how long the rest takes; the worst run of a sweep so far.

use crate::html::{self, Cell};
use base::number::wall_time;
use study::evaluate::{Evaluation, RunEvent};
use study::post::{self, badness};
use study::store::evaluations::Key;
use study::sweep::{self, RemainingWork};

/// Most causes of failures that are told apart.
const MOST_CAUSES: usize = 50;

/// Most runs under way that are listed.
const MOST_RUNNING: usize = 32;

/// Counts of runs, and those under way.
#[derive(Clone, Debug, Default)]
pub(crate) struct Runs {
    wanted: usize,
    taken: usize,
    ended: usize,
    causes: Causes,
    running: Vec<(Key, String, f64)>,
    /// When the first was begun, s.
    first: Option<f64>,
    /// What other processes and earlier sweeps leave of a sweep, where an estimate tells.
    left: Option<RemainingWork>,
}

/// Why runs or trials failed, each cause with how often.
#[derive(Clone, Debug, Default)]
pub(crate) struct Causes {
    counts: Vec<(String, usize)>,
    total: usize,
}

/// Numbers of runs or trials.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Asked for, and not begun.
    pub waiting: usize,
    /// Under way.
    pub running: usize,
    /// Ended well.
    pub done: usize,
    /// Those of the done that were known before.
    pub known: usize,
    /// Ended without a result.
    pub failed: usize,
}

/// How fast the runs of a sweep are computed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pace {
    /// Runs per second, here and by other processes.
    pub rate: f64,
    /// s.
    pub to_go: f64,
}

impl Causes {
    pub(crate) fn add(&mut self, cause: &str) {
        self.total += 1;
        match self.counts.iter().position(|(known, _)| known == cause) {
            Some(place) => self.counts[place].1 += 1,
            None if self.counts.len() < MOST_CAUSES => self.counts.push((cause.to_owned(), 1)),
            None => {}
        }
    }

    pub(crate) fn total(&self) -> usize {
        self.total
    }

    /// A table of causes, the most frequent first; empty without failures.
    pub(crate) fn table(&self, what: &str) -> String {
        let mut counts: Vec<&(String, usize)> = self.counts.iter().collect();
        counts.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
        let row =
            |(cause, count): &&(String, usize)| vec![Cell::number(*count as f64, count.to_string()), Cell::text(cause)];
        html::sorted_table(&[what, "cause"].map(Cell::text), &counts.iter().map(row).collect::<Vec<_>>())
    }
}

impl Runs {
    /// Takes note of an event at this time after the beginning, s.
    pub(crate) fn note(&mut self, event: &RunEvent<'_>, now: f64) {
        match event {
            RunEvent::Wanted(count) => self.wanted += count,
            RunEvent::Taken => self.taken += 1,
            RunEvent::Begun { run, name } => {
                self.first.get_or_insert(now);
                self.running.push((*run, (*name).to_owned(), now));
            }
            RunEvent::Ended { run } => {
                self.leave(*run);
                self.ended += 1;
            }
            RunEvent::Failed { run, cause } => {
                self.leave(*run);
                self.causes.add(cause);
            }
            RunEvent::GivenUp { run } => self.leave(*run),
            RunEvent::Refused(cause) => self.causes.add(cause),
        }
    }

    fn leave(&mut self, run: Key) {
        self.running.retain(|(other, ..)| *other != run);
    }

    /// So much is left, by an estimate.
    pub(crate) fn set_left(&mut self, left: RemainingWork) {
        self.left = Some(left);
    }

    pub(crate) fn counts(&self) -> Counts {
        let failed = self.causes.total();
        let (running, done) = (self.running.len(), self.taken + self.ended);
        let waiting = self.wanted.saturating_sub(done + failed + running);
        Counts { waiting, running, done, known: self.taken, failed }
    }

    pub(crate) fn wanted(&self) -> usize {
        self.wanted
    }

    /// The mean pace of a sweep so far, once it tells how long a run takes.
    pub(crate) fn pace(&self, now: f64) -> Option<Pace> {
        let Counts { waiting, running, failed, .. } = self.counts();
        let (left, elsewhere) = self.left.map_or((waiting, 0), |work| (work.left.min(waiting), work.elsewhere));
        let (computed, seconds) = (self.ended + failed + elsewhere, now - self.first?);
        // Of those under way about a half is done.
        let to_go = sweep::seconds_to_go(computed, seconds, left as f64 + 0.5 * running as f64)?;
        Some(Pace { rate: computed as f64 / seconds, to_go })
    }

    /// The runs under way, and why others failed.
    pub(crate) fn sections(&self, now: f64) -> String {
        let row = |(_, name, since): &(Key, String, f64)| {
            vec![Cell::text(name), Cell::number(now - since, wall_time((now - since).max(0.0)))]
        };
        let running: Vec<Vec<Cell>> = self.running.iter().take(MOST_RUNNING).map(row).collect();
        let running = html::sorted_table(&["run", "for"].map(Cell::text), &running);
        [html::section("Under way", &running), html::section("Failed", &self.causes.table("runs"))].concat()
    }
}

/// The figure by which the runs of a sweep are ranked, and the run that is worst by it.
#[derive(Clone, Debug)]
pub(crate) struct SweepRuns {
    ranked: String,
    /// Place and value.
    worst: Option<(usize, f64)>,
}

impl SweepRuns {
    pub(crate) fn new(ranked: &str) -> SweepRuns {
        SweepRuns { ranked: ranked.to_owned(), worst: None }
    }

    /// Takes note of a run; a failed one has no figures.
    pub(crate) fn add(&mut self, place: usize, evaluation: &Evaluation) {
        if evaluation.failure.is_some() {
            return;
        }
        let ranked = evaluation.figures.iter().find(|(name, _)| *name == self.ranked);
        if let Some(value) = ranked.and_then(|(_, figure)| figure.number())
            && self.worst.is_none_or(|(_, worst)| badness(&self.ranked, value) > badness(&self.ranked, worst))
        {
            self.worst = Some((place, value));
        }
    }

    /// The run that is worst by the figure by which runs are ranked: number, words, and the value as it is read.
    pub(crate) fn worst(&self) -> Option<(usize, String, String)> {
        let (place, value) = self.worst?;
        let (words, reading) = post::reading(&self.ranked, value);
        Some((place + 1, words, reading.text(value)))
    }
}

#[cfg(test)]
mod tests {
    use study::evaluate::Figure;

    use super::*;

    #[test]
    fn runs_wait_run_and_end() {
        let mut runs = Runs::default();
        let key = |byte| Key([byte; 16]);
        let begun = |byte| RunEvent::Begun { run: key(byte), name: "drop" };
        runs.note(&RunEvent::Wanted(10), 0.0);
        runs.note(&RunEvent::Taken, 0.0);
        [1, 2, 3, 4].iter().for_each(|byte| runs.note(&begun(*byte), 1.0));
        assert_eq!(runs.counts(), Counts { waiting: 5, running: 4, done: 1, known: 1, failed: 0 });
        assert_eq!(runs.pace(2.0), None, "nothing tells how long a run takes");
        runs.note(&RunEvent::Ended { run: key(1) }, 3.0);
        runs.note(&RunEvent::Failed { run: key(2), cause: "the film <tore>" }, 3.0);
        runs.note(&RunEvent::GivenUp { run: key(3) }, 3.0);
        runs.note(&RunEvent::Refused("no such key"), 3.0);
        assert_eq!(runs.counts(), Counts { waiting: 5, running: 1, done: 2, known: 1, failed: 2 });
        let html = runs.sections(3.0);
        assert!(html.contains("the film &lt;tore&gt;") && html.contains("<h2>Under way</h2>"), "{html}");
    }

    /// Sixty runs one after another, some seven times as long as others: an estimate is right within a third and one run, and
    /// the first one is made in the first minute.
    #[test]
    fn the_time_to_go_is_given_once_it_is_right_within_a_third() {
        let lasts = |run: u8| [2.0, 9.0, 4.0, 14.0, 3.0, 6.0, 2.5][usize::from(run) % 7];
        let whole: f64 = (0..60).map(lasts).sum();
        let (mut runs, mut now, mut first) = (Runs::default(), 0.0, None);
        runs.note(&RunEvent::Wanted(60), 0.0);
        for run in 0..60 {
            let key = Key([run; 16]);
            runs.note(&RunEvent::Begun { run: key, name: "drop" }, now);
            now += lasts(run);
            runs.note(&RunEvent::Ended { run: key }, now);
            if let Some(Pace { to_go, .. }) = runs.pace(now) {
                let left = whole - now;
                assert!((to_go - left).abs() <= left / 3.0 + 14.0, "{to_go} s for {left} s after {run} runs");
                first.get_or_insert(now);
            }
        }
        assert!(first.is_some_and(|first| first <= 60.0), "{first:?}");
        runs.set_left(RemainingWork { left: 0, elsewhere: 60 });
        assert_eq!(runs.pace(now), Some(Pace { rate: 120.0 / now, to_go: 0.0 }));
    }

    #[test]
    fn the_worst_run_is_named_in_the_unit_in_which_it_is_read() {
        let mut runs = SweepRuns::new("peak_force_N");
        assert_eq!(runs.worst(), None);
        let evaluation = |force: f64, failure: Option<&str>| Evaluation {
            figures: vec![
                ("peak_displacement_m".into(), Figure::Number(-0.1 * force)),
                ("peak_force_N".into(), Figure::Number(force)),
            ],
            failure: failure.map(str::to_owned),
            ..Evaluation::failed(String::new())
        };
        runs.add(7, &evaluation(1.0, None));
        runs.add(3, &evaluation(2.0, None));
        runs.add(5, &evaluation(9.0, Some("the film tore")));
        assert_eq!(runs.worst(), Some((4, "peak force".into(), "2 N".into())));
        // The deepest run, although its displacement is the smallest number.
        let mut deep = SweepRuns::new("peak_displacement_m");
        deep.add(7, &evaluation(1.0, None));
        deep.add(3, &evaluation(2.0, None));
        assert_eq!(deep.worst(), Some((4, "lowest point".into(), "\u{2212}200 mm".into())));
    }
}
