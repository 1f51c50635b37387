//! A bar over all runs with the time to go, on a terminal only.

use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};

use crate::simulate::Progress;

/// Steps of the bar that one run has.
const PER_RUN: f64 = 1000.0;

/// One bar for all runs.
pub struct Bar {
    bar: ProgressBar,
    done: Vec<AtomicU64>,
}

impl Bar {
    /// A bar for so many runs on standard error; invisible where that is no terminal or quiet is asked for.
    pub fn new(runs: usize, quiet: bool) -> Bar {
        let bar = if quiet { ProgressBar::hidden() } else { ProgressBar::new((runs as f64 * PER_RUN) as u64) };
        if let Ok(style) = ProgressStyle::with_template("{wide_bar} {percent:>3} %  {eta} to go  {msg}") {
            bar.set_style(style);
        }
        bar.enable_steady_tick(Duration::from_millis(200));
        Bar { bar, done: (0..runs).map(|_| AtomicU64::new(0)).collect() }
    }

    /// Shows how far the run at `index` is.
    pub fn show(&self, index: usize, progress: Progress) {
        let share = progress.done.clamp(0.0, 1.0);
        self.done[index].store((share * PER_RUN) as u64, Ordering::Relaxed);
        let total = self.done.iter().map(|done| done.load(Ordering::Relaxed)).sum();
        self.bar.set_position(total);
        if self.done.len() == 1 {
            self.bar.set_message(format!("{:.1} ms, {} steps", progress.time * 1e3, progress.steps));
        }
    }

    /// Takes the bar away.
    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }
}
