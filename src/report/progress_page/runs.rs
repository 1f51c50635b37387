//! The runs that a study asks for: how many wait, run, are done or failed, and how long the rest takes.

use base::number::wall_time;
use study::evaluate::RunEvent;
use study::store::evaluations::Key;

use super::super::html;
use super::super::table::{self, Cell};

/// Most causes of failures that are told apart.
const MOST_CAUSES: usize = 50;

/// Most runs under way that are listed.
const MOST_RUNNING: usize = 32;

/// Counts of runs, and those under way.
#[derive(Clone, Debug, Default)]
pub(super) struct Runs {
    wanted: usize,
    taken: usize,
    ended: usize,
    causes: Causes,
    running: Vec<(Key, String, f64)>,
    /// When the first was begun, s.
    first: Option<f64>,
    /// Runs that nobody has computed, where an estimate tells.
    left: Option<usize>,
}

/// Why runs or trials failed, each cause with how often.
#[derive(Clone, Debug, Default)]
pub(super) struct Causes {
    counts: Vec<(String, usize)>,
    total: usize,
}

/// Numbers of runs or trials.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Counts {
    pub(super) waiting: usize,
    pub(super) running: usize,
    pub(super) done: usize,
    /// Those of the done that were known before.
    pub(super) known: usize,
    pub(super) failed: usize,
}

impl Causes {
    pub(super) fn add(&mut self, cause: &str) {
        self.total += 1;
        match self.counts.iter().position(|(known, _)| known == cause) {
            Some(place) => self.counts[place].1 += 1,
            None if self.counts.len() < MOST_CAUSES => self.counts.push((cause.to_owned(), 1)),
            None => {}
        }
    }

    pub(super) fn total(&self) -> usize {
        self.total
    }

    /// A table of causes, the most frequent first; empty without failures.
    pub(super) fn table(&self, what: &str) -> String {
        let mut counts: Vec<&(String, usize)> = self.counts.iter().collect();
        counts.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
        let row =
            |(cause, count): &&(String, usize)| vec![Cell::number(*count as f64, count.to_string()), Cell::text(cause)];
        table::table(&[what, "cause"].map(Cell::text), &counts.iter().map(row).collect::<Vec<_>>())
    }
}

impl Runs {
    /// Takes note of an event at this time after the beginning, s.
    pub(super) fn note(&mut self, event: &RunEvent<'_>, now: f64) {
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

    /// So many runs are left, by an estimate.
    pub(super) fn set_left(&mut self, left: usize) {
        self.left = Some(left);
    }

    pub(super) fn counts(&self) -> Counts {
        let failed = self.causes.total();
        let (running, done) = (self.running.len(), self.taken + self.ended);
        let waiting = self.wanted.saturating_sub(done + failed + running);
        Counts { waiting, running, done, known: self.taken, failed }
    }

    pub(super) fn wanted(&self) -> usize {
        self.wanted
    }

    /// Time to go, s, at the mean rate so far.
    pub(super) fn to_go(&self, now: f64) -> Option<f64> {
        let Counts { waiting, running, failed, .. } = self.counts();
        let computed = self.ended + failed;
        let since = now - self.first?;
        // Of those under way about a half is done.
        let left = self.left.unwrap_or(waiting).min(waiting) as f64 + 0.5 * running as f64;
        (computed > 0 && since > 0.0).then(|| left * since / computed as f64)
    }

    /// The runs under way, and why others failed.
    pub(super) fn sections(&self, now: f64) -> String {
        let row = |(_, name, since): &(Key, String, f64)| {
            vec![Cell::text(name), Cell::number(now - since, wall_time((now - since).max(0.0)))]
        };
        let running: Vec<Vec<Cell>> = self.running.iter().take(MOST_RUNNING).map(row).collect();
        let running = table::table(&["run", "for"].map(Cell::text), &running);
        [html::section("Under way", &running), html::section("Failed", &self.causes.table("runs"))].concat()
    }
}

#[cfg(test)]
mod tests {
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
        assert_eq!(runs.to_go(2.0), None, "nothing tells how long a run takes");
        runs.note(&RunEvent::Ended { run: key(1) }, 3.0);
        runs.note(&RunEvent::Failed { run: key(2), cause: "the film <tore>" }, 3.0);
        runs.note(&RunEvent::GivenUp { run: key(3) }, 3.0);
        runs.note(&RunEvent::Refused("no such key"), 3.0);
        assert_eq!(runs.counts(), Counts { waiting: 5, running: 1, done: 2, known: 1, failed: 2 });
        // Three were computed or refused in 2 s; five and a half are left.
        assert!((runs.to_go(3.0).unwrap() - 5.5 * 2.0 / 3.0).abs() < 1e-12);
        runs.set_left(2);
        assert!((runs.to_go(3.0).unwrap() - 2.5 * 2.0 / 3.0).abs() < 1e-12);
        let html = runs.sections(3.0);
        assert!(html.contains("the film &lt;tore&gt;") && html.contains("<h2>Under way</h2>"), "{html}");
    }
}
