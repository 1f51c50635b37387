//! A progress bar over all runs with the remaining time, and a sign of work for commands without runs, on a terminal only.

use std::collections::VecDeque;
use std::io::{self, Write};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::sync::{Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use base::diagnostic::{self, Diagnostic};
use base::finding::{Finding, Report};
use base::number::{duration, figure, wall_time};
use membrane::engine::Settling;
use scene::simulate::Progress;

/// Steps of the bar for one run.
const PER_RUN: f64 = 1000.0;

/// Time between two updates of the bar.
const REFRESH: Duration = Duration::from_millis(100);

/// Time after which a command without a bar shows that it works.
const SOON: Duration = Duration::from_secs(1);

/// The end of the sign of work that is shown; it is closed to end it.
static WORK: Mutex<Option<Work>> = Mutex::new(None);

/// A thread that shows that a command works.
struct Work {
    end: Sender<()>,
    thread: thread::JoinHandle<()>,
}

/// Shows on a terminal that a command without a bar works, from its first second until [`end_of_work`].
pub(super) fn begin_work(quiet: bool) {
    let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::stderr_with_hz(10));
    if quiet || bar.is_hidden() {
        return;
    }
    if let Ok(style) = ProgressStyle::with_template("{spinner} {elapsed}") {
        bar.set_style(style);
    }
    let (end, ended) = channel();
    let show = move || {
        let mut wait = SOON;
        while ended.recv_timeout(wait) == Err(RecvTimeoutError::Timeout) {
            bar.tick();
            wait = REFRESH;
        }
        bar.finish_and_clear();
    };
    // Without a thread nothing is shown.
    if let Ok(thread) = thread::Builder::new().name("progress".into()).spawn(show) {
        *WORK.lock().unwrap_or_else(PoisonError::into_inner) = Some(Work { end, thread });
    }
}

/// Removes what [`begin_work`] shows: the command prints now.
pub(super) fn end_of_work() {
    if let Some(Work { end, thread }) = WORK.lock().unwrap_or_else(PoisonError::into_inner).take() {
        drop(end);
        let _ = thread.join();
    }
}

/// One bar for all runs.
pub(super) struct Bar {
    bar: ProgressBar,
    done: Vec<AtomicU64>,
    /// Progress of resumed runs when they resumed.
    before: Vec<AtomicU64>,
    quiet: bool,
    start: Instant,
    drawn: Mutex<Drawn>,
}

/// The last update of the bar, and what it knows of the pace.
struct Drawn {
    at: Instant,
    pace: Pace,
}

impl Bar {
    /// A bar for so many runs on standard error; hidden where that is not a terminal or `quiet`.
    pub(super) fn new(runs: usize, quiet: bool) -> Bar {
        let target = if quiet { ProgressDrawTarget::hidden() } else { ProgressDrawTarget::stderr_with_hz(10) };
        let bar = ProgressBar::with_draw_target(Some((runs as f64 * PER_RUN) as u64), target);
        if let Ok(style) = ProgressStyle::with_template("{wide_bar} {percent:>3} %  {msg}") {
            bar.set_style(style);
        }
        let start = Instant::now();
        let none = || (0..runs).map(|_| AtomicU64::new(0)).collect();
        Bar {
            bar,
            done: none(),
            before: none(),
            quiet,
            start,
            drawn: Mutex::new(Drawn { at: start, pace: Pace::default() }),
        }
    }

    /// Sets the share of the run at `index` that was done before it resumed.
    pub(super) fn start_at(&self, index: usize, share: f64) {
        let share = (share.clamp(0.0, 1.0) * PER_RUN) as u64;
        self.before[index].store(share, Ordering::Relaxed);
        self.done[index].store(share, Ordering::Relaxed);
    }

    /// Shows the progress of the run at `index`; the bar is redrawn ten times a second at most.
    pub(super) fn show(&self, index: usize, progress: Progress) {
        let share = (progress.time / progress.duration).clamp(0.0, 1.0);
        self.done[index].store((share * PER_RUN) as u64, Ordering::Relaxed);
        // Another run that is drawing the bar includes the progress of this one.
        let Ok(mut drawn) = self.drawn.try_lock() else {
            return;
        };
        if drawn.at.elapsed() < REFRESH {
            return;
        }
        drawn.at = Instant::now();
        let sum = |shares: &[AtomicU64]| shares.iter().map(|share| share.load(Ordering::Relaxed)).sum::<u64>();
        let (total, before) = (sum(&self.done), sum(&self.before));
        let state = if self.done.len() == 1 { state(&progress) } else { String::new() };
        let whole = self.done.len() as f64 * PER_RUN;
        let to_go = drawn.pace.remaining(self.start.elapsed(), before as f64 / whole, total as f64 / whole);
        let to_go = to_go.map(|left| format!("{} to go  ", wall_time(left))).unwrap_or_default();
        self.bar.set_message(format!("{to_go}{state}"));
        self.bar.set_position(total);
    }

    /// Wall time since the bar was made.
    pub(super) fn elapsed(&self) -> Duration {
        self.start.elapsed()
    }

    /// Prints a finding with its severity above the bar, unless `quiet`.
    pub(super) fn report(&self, report: &impl Report) {
        if !self.quiet {
            self.print(&format!("{}: {report}", report.code().severity));
        }
    }

    /// Prints a finding of the scenario of a run, with its name where there are several, unless `quiet`.
    pub(super) fn finding(&self, run: &str, finding: &Finding) {
        let several = self.done.len() > 1;
        if !self.quiet {
            self.print(&if several { format!("{run}: {finding}") } else { finding.to_string() });
        }
    }

    /// Prints how the run proceeds above the bar, as a note, unless `quiet`.
    pub(super) fn note(&self, text: &str) {
        if !self.quiet {
            self.print(&format!("note: {text}"));
        }
    }

    /// Prints a warning above the bar.
    #[cfg(feature = "rerun")]
    pub(super) fn warn(&self, text: &str) {
        self.print(&format!("warning: {text}"));
    }

    /// Prints an error above the bar; the runs continue.
    pub(super) fn error(&self, mistake: &Diagnostic) {
        self.print(&diagnostic::render(std::slice::from_ref(mistake), false));
    }

    fn print(&self, text: &str) {
        // With standard error closed, there is nowhere to print.
        self.bar.suspend(|| drop(writeln!(io::stderr(), "{}", diagnostic::printable(text))));
    }

    /// Removes the bar.
    pub(super) fn finish(&self) {
        self.bar.finish_and_clear();
    }
}

/// The present state of a run: its time, or how far its film is from equilibrium before its first step.
fn state(progress: &Progress) -> String {
    match progress.settling {
        Some(Settling { residual, tolerance, steps }) => {
            let [residual, tolerance] = [residual, tolerance].map(|value| figure(value, 2));
            format!("settling: residual {residual}, ends at {tolerance}, {steps} steps")
        }
        None => format!("{}, {} steps", duration(progress.time), progress.steps),
    }
}

/// The pace of the last part of the runs: a step in contact may cost many times one of the flight before it.
#[derive(Default)]
struct Pace {
    /// Wall times and the shares done then, the oldest first.
    marks: VecDeque<(Duration, f64)>,
}

/// Shortest time over which the pace is taken, and its share of the time so far.
const PACE_OVER: (Duration, f64) = (Duration::from_secs(3), 0.25);

impl Pace {
    /// The remaining wall time (s) at `elapsed`, once enough is done for an estimate; the share done went from `before` to
    /// `share`.
    fn remaining(&mut self, elapsed: Duration, before: f64, share: f64) -> Option<f64> {
        let since = elapsed.saturating_sub(PACE_OVER.0.max(elapsed.mul_f64(PACE_OVER.1)));
        while self.marks.get(1).is_some_and(|(time, _)| *time <= since) {
            self.marks.pop_front();
        }
        let own = share - before;
        let enough = own >= 0.02 || (own > 0.0 && elapsed >= Duration::from_millis(500));
        let (from, done) =
            self.marks.front().copied().filter(|_| since > Duration::ZERO).unwrap_or((Duration::ZERO, before));
        self.marks.push_back((elapsed, share));
        (enough && share > done).then(|| (elapsed - from).as_secs_f64() * (1.0 - share) / (share - done))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_remaining_time_waits_for_enough_progress() {
        let after = |millis, share| Pace::default().remaining(Duration::from_millis(millis), 0.0, share).map(wall_time);
        assert_eq!(after(100, 0.0), None);
        assert_eq!(after(100, 0.01), None);
        assert_eq!(after(900, 0.0), None);
        assert_eq!(after(1000, 0.1).as_deref(), Some("9 s"));
        assert_eq!(after(60_000, 0.2).as_deref(), Some("4 min"));
    }

    #[test]
    fn film_that_settles_shows_its_residual() {
        let settling = Some(Settling { residual: 3.21e-4, tolerance: 1e-6, steps: 1200 });
        let progress = Progress { time: 0.0, duration: 0.1, steps: 0, time_step: 1e-6, elements: 100, settling };
        assert_eq!(state(&progress), "settling: residual 3.2e-4, ends at 1.0e-6, 1200 steps");
        let stepping = Progress { time: 2e-3, steps: 5, settling: None, ..progress };
        assert_eq!(state(&stepping), "2.0 ms, 5 steps");
    }

    #[test]
    fn the_remaining_time_of_a_resumed_run_counts_from_there() {
        let after = |millis, share| Pace::default().remaining(Duration::from_millis(millis), 0.5, share).map(wall_time);
        assert_eq!(after(100, 0.501), None);
        assert_eq!(after(10_000, 0.75).as_deref(), Some("10 s"));
    }

    /// Half of a run in 10 s, then a tenth of that pace: 100 s to go, where the mean would give 10 s, then more and more.
    #[test]
    fn the_remaining_time_follows_a_pace_that_falls() {
        let mut pace = Pace::default();
        let mut shown = Vec::new();
        for tenths in 1..1090_u32 {
            let time = 0.1 * f64::from(tenths);
            let share = if time < 10.0 { 0.05 * time } else { 0.5 + 0.005 * (time - 10.0) };
            shown.push(pace.remaining(Duration::from_millis(u64::from(tenths) * 100), 0.0, share));
        }
        for (tenths, expected) in [(50, 15.0), (200, 90.0), (800, 30.0), (1000, 10.0)] {
            let found: f64 = shown[tenths - 1].expect("a time");
            assert!((found - expected).abs() < 1e-6, "{found} s to go after {tenths} tenths of a second");
        }
        assert!(pace.marks.len() < 300, "the bar holds the last quarter alone");
    }
}
