//! The progress of a sweep: a bar on a terminal, or events that a program can follow.

use std::io::{self, Write};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde_json::json;

use crate::Shared;
use base::diagnostic::{printable, printable_json};
use base::number::{figure, wall_time};
use study::sweep::{Event, RemainingWork};

/// Time between two events.
const EVERY: Duration = Duration::from_millis(500);

/// Progress of a sweep.
pub(super) struct Progress {
    bar: ProgressBar,
    events: bool,
    quiet: bool,
    total: usize,
    started: Instant,
    state: Mutex<State>,
}

/// The work that was done so far.
struct State {
    cache_hits: usize,
    computed: usize,
    failed: usize,
    refused: usize,
    /// Runs that other processes have computed meanwhile.
    elsewhere: usize,
    /// Runs that were left, and how many were computed here by then; none where all that are not done are left.
    left: Option<[usize; 2]>,
    /// When the first run that is not taken from a record was begun.
    began: Instant,
    reported: Instant,
}

impl State {
    fn done(&self) -> usize {
        self.cache_hits + self.computed + self.refused
    }

    /// Runs per second, here and elsewhere, and seconds to go.
    fn pace(&self, total: usize) -> Option<[f64; 2]> {
        let elapsed = self.began.elapsed().as_secs_f64();
        let rate = (self.computed + self.elsewhere) as f64 / elapsed;
        let open = total - self.done();
        let left = match self.left {
            Some([left, by_then]) => open.min(left.saturating_sub(self.computed - by_then)),
            None => open,
        };
        (self.computed > 0 && elapsed > 0.0).then(|| [rate, left as f64 / rate])
    }
}

impl Progress {
    /// Of a sweep of `total` runs.
    pub(super) fn new(total: usize, shared: &Shared) -> Progress {
        let hidden = shared.quiet || shared.json;
        let target = if hidden { ProgressDrawTarget::hidden() } else { ProgressDrawTarget::stderr_with_hz(10) };
        let bar = ProgressBar::with_draw_target(Some(total as u64), target);
        if let Ok(style) = ProgressStyle::with_template("{wide_bar} {pos}/{len}  {msg}") {
            bar.set_style(style);
        }
        let now = Instant::now();
        let state = State {
            cache_hits: 0,
            computed: 0,
            failed: 0,
            refused: 0,
            elsewhere: 0,
            left: None,
            began: now,
            reported: now,
        };
        Progress { bar, events: shared.json, quiet: shared.quiet, total, started: now, state: Mutex::new(state) }
    }

    /// Shows what became of a run.
    pub(super) fn show(&self, event: &Event<'_>) {
        let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        match event {
            Event::Taken(..) => {
                state.cache_hits += 1;
                if state.computed == 0 {
                    state.began = Instant::now();
                }
            }
            Event::Computed(_, evaluation) => {
                state.computed += 1;
                state.failed += usize::from(evaluation.failure.is_some());
            }
            Event::Left(RemainingWork { left, elsewhere }) => {
                state.left = Some([*left, state.computed]);
                state.elsewhere = *elsewhere;
            }
            Event::Refused(_, cause) => {
                state.refused += 1;
                if state.refused == 1 && !self.quiet && !self.events {
                    let text = format!("warning: a run has no result: {cause}");
                    self.bar.suspend(|| drop(writeln!(io::stderr(), "{}", printable(&text))));
                }
            }
        }
        let is_last = state.done() == self.total;
        if state.reported.elapsed() >= EVERY || is_last {
            state.reported = Instant::now();
            self.report(&state);
        }
    }

    fn report(&self, state: &State) {
        let pace = state.pace(self.total);
        if self.events && !self.quiet {
            let event = json!({
                "event": "progress",
                "done": state.done(),
                "of": self.total,
                "reused": state.cache_hits,
                "failed": state.failed + state.refused,
                "elapsed_s": self.started.elapsed().as_secs_f64(),
                "runs_per_s": pace.map(|[rate, _]| rate),
                "to_go_s": pace.map(|[_, to_go]| to_go),
            });
            // Whoever follows may have gone.
            let _ = writeln!(io::stderr(), "{}", printable_json(&event.to_string()));
        }
        self.bar.set_position(state.done() as u64);
        let failed = match state.failed + state.refused {
            0 => String::new(),
            failed => format!("  {failed} failed"),
        };
        self.bar.set_message(match pace {
            Some([rate, to_go]) => format!("{} runs/s  {} to go{failed}", figure(rate, 2), wall_time(to_go)),
            None => failed,
        });
    }

    /// Removes the bar.
    pub(super) fn finish(&self) {
        self.bar.finish_and_clear();
    }
}
