//! Run time of signal functions on a million samples: `cargo bench --bench signal`.
//!
//! The signal is one second at 1 MHz, as of a shock recorder. Every figure is the median of several measurements in one
//! process.

use std::hint::black_box;
use std::time::Instant;

use droptower::signal::clip::{Counting, clip};
use droptower::signal::filter::{self, Standard};
use droptower::signal::hic::head_injury_criterion;
use droptower::signal::rating::rate;
use droptower::signal::{Series, integrate};

/// Number of measurements.
const REPEATS: usize = 9;

/// Number of samples.
const SAMPLES: u32 = 1_000_000;

fn main() {
    let (reference, comparison) = (shock(0.0), shock(0.003));
    let filtered = filter::channel(&comparison, 1000.0, Standard::Iso6487).expect("even steps");
    println!("| a million samples | ms |\n|---|---|");
    let filter = row("filtered, CFC 1000", || filter::channel(&comparison, 1000.0, Standard::Iso6487));
    let integral = row("integrated", || integrate::once(&filtered, 0.0));
    let rating = row("rated, ISO/TS 18571 (10 000 samples)", || rate(&reference, &filtered));
    println!("| **filtered, integrated and rated** | **{:.1}** |", filter + integral + rating);
    row("HIC15", || head_injury_criterion(&filtered, 0.015));
    row("HIC15 of a constant, the worst case", || head_injury_criterion(&constant(), 0.015));
    row("3 ms clip, cumulative", || clip(&filtered, 0.003, Counting::Cumulative));
    row("3 ms clip, contiguous", || clip(&filtered, 0.003, Counting::Contiguous));
}

/// A shock with ringing, delayed by `delay` (s).
fn shock(delay: f64) -> Series {
    sampled(|t| 500.0 * (-((t - 0.4 - delay) / 0.02).powi(2)).exp() * (1.0 + 0.1 * (6e4 * t).sin()))
}

/// A constant.
fn constant() -> Series {
    sampled(|_| 500.0)
}

/// `value` sampled at 1 MHz.
fn sampled(value: impl Fn(f64) -> f64) -> Series {
    let time: Vec<f64> = (0..SAMPLES).map(|i| 1e-6 * f64::from(i)).collect();
    let values: Vec<f64> = time.iter().map(|t| value(*t)).collect();
    Series::new(time, values)
}

/// Measures `work`, prints and returns its run time, ms.
fn row<T>(what: &str, work: impl Fn() -> T) -> f64 {
    let milliseconds = || {
        let begin = Instant::now();
        black_box(work());
        1e3 * begin.elapsed().as_secs_f64()
    };
    let mut figures: Vec<f64> = (0..REPEATS).map(|_| milliseconds()).collect();
    figures.sort_by(f64::total_cmp);
    let median = figures[REPEATS / 2];
    println!("| {what} | {median:.1} |");
    median
}
