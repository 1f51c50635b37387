//! The head injury criterion, HIC: the worst interval of a deceleration, by its length and its mean.
//!
//! Versace, *A Review of the Severity Index* (1971), SAE 710881; windows of 15 and 36 ms after 49 CFR 571.208.

use super::{Series, gap};
use crate::error::{Error, refusal};
use base::number::significant;
use base::units::STANDARD_GRAVITY;

/// The interval with the largest (t₂ − t₁)·(mean of a in g)^2.5, equation 62.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hic {
    /// The criterion; its unit is s by convention, and never written.
    pub value: f64,
    /// When the interval starts, s.
    pub start: f64,
    /// When it ends, s.
    pub end: f64,
    /// Mean acceleration in it, m/s².
    pub mean: f64,
}

/// The longest interval of HIC36, s.
pub const LONG_WINDOW: f64 = 0.036;

/// HIC(d): what a dummy's head would have shown where a free-motion head form showed the criterion `hic36` over at most
/// 36 ms. 49 CFR 571.201, S7.
pub fn dummy_equivalent(hic36: f64) -> f64 {
    0.75446 * hic36 + 166.4
}

/// The head injury criterion of an acceleration (m/s², deceleration positive, or the resultant) over intervals of at
/// most `window` s.
///
/// The acceleration is taken as linear between samples. All pairs of samples, and of times between them where the window holds
/// few, are compared, and the ends of the best pair are then moved between them, so a window need not be a multiple of the step,
/// which need not be even.
pub fn head_injury_criterion(series: &Series, window: f64) -> Result<Hic, Error> {
    if window.is_nan() || window <= 0.0 {
        return Err(refusal!("a window of {} s is not positive", significant(window, 9)));
    }
    if series.len() < 2 {
        return Err(refusal!("the head injury criterion needs two samples, found {}", series.len()));
    }
    gap::check(series)?;
    let never_positive = || {
        refusal!(
            "the mean acceleration is positive between no two samples (deceleration must be, or give the resultant)"
        )
    };
    let peak = series.values().iter().copied().fold(0.0, f64::max);
    if peak == 0.0 {
        return Err(never_positive());
    }
    if !series.time().windows(2).any(|pair| pair[1] - pair[0] <= window * ROUNDING) {
        return Err(refusal!("no two samples lie within a window of {} s", significant(window, 9)));
    }
    let fine = subdivided(series, window);
    let pulse = Pulse::new(&fine, peak);
    let pair = Search::new(&pulse, window).best_pair().ok_or_else(never_positive)?;
    let [start, end] = pulse.refined(pair, window);
    let length = end - start;
    let mean = peak * (pulse.speed_at(end) - pulse.speed_at(start)) / length;
    // A single positive sample between very negative ones gives no pair a positive mean.
    if mean <= 0.0 {
        return Err(never_positive());
    }
    let [start, end] = [start, end].map(|time| series.time()[0] + time);
    Ok(Hic { value: length * (mean / STANDARD_GRAVITY).powf(2.5), start, end, mean })
}

/// A sample that rounding of its time puts just past the window still counts.
const ROUNDING: f64 = 1.0 + 1e-9;
/// Samples within the window from which on the best interval starts and ends near two of them, most of a step, and most of all.
const FINE: f64 = 1000.0;
const MOST_PIECES: f64 = 64.0;
const MOST_SAMPLES: f64 = 2e6;

/// The series, over times from its first sample on, with values between its samples where few lie within the window: of a rough
/// signal the best pair of samples may be far from the best interval. What is lost goes with the square of a piece.
fn subdivided(series: &Series, window: f64) -> Series {
    let (time, last) = (series.time(), series.len() - 1);
    let duration = time[last] - time[0];
    let step = duration / last as f64;
    let pieces = (FINE * step / window).min(MOST_PIECES).min(MOST_SAMPLES / last as f64).ceil();
    let divided = |ends: &[f64], zero: f64| {
        let (from, by) = (ends[0] - zero, ends[1] - ends[0]);
        (0..pieces as usize).map(move |piece| from + by * piece as f64 / pieces)
    };
    let mut times: Vec<f64> = time.windows(2).flat_map(|ends| divided(ends, time[0])).collect();
    let mut values: Vec<f64> = series.values().windows(2).flat_map(|ends| divided(ends, 0.0)).collect();
    times.push(duration);
    values.push(series.values()[last]);
    Series::new(times, values)
}

/// An acceleration over its peak, and its integral.
struct Pulse<'a> {
    pub time: &'a [f64],
    pub level: Vec<f64>,
    pub speed: Vec<f64>,
}

impl<'a> Pulse<'a> {
    pub fn new(series: &'a Series, peak: f64) -> Pulse<'a> {
        let time = series.time();
        let level: Vec<f64> = series.values().iter().map(|value| value / peak).collect();
        let mut speed = vec![0.0; level.len()];
        for i in 1..level.len() {
            speed[i] = speed[i - 1] + 0.5 * (level[i] + level[i - 1]) * (time[i] - time[i - 1]);
        }
        Pulse { time, level, speed }
    }

    pub fn last(&self) -> usize {
        self.time.len() - 1
    }

    /// The integral up to `time`, which lies among the samples.
    pub fn speed_at(&self, time: f64) -> f64 {
        let before = self.time.partition_point(|sample| *sample <= time).clamp(1, self.last()) - 1;
        let (dt, step) = (time - self.time[before], self.time[before + 1] - self.time[before]);
        let slope = (self.level[before + 1] - self.level[before]) / step;
        self.speed[before] + dt * (self.level[before] + 0.5 * slope * dt)
    }

    /// Square of the criterion, which needs no root, of the interval that starts at `start` and lasts `length`.
    pub fn severity(&self, [start, length]: [f64; 2]) -> f64 {
        severity(self.speed_at(start + length) - self.speed_at(start), length)
    }

    /// The best interval that starts and ends within a sample of `pair`.
    pub fn refined(&self, [from, to]: [usize; 2], window: f64) -> [f64; 2] {
        let (time, last) = (self.time, self.last());
        let [first, end] = [time[0], time[last]];
        let starts = [time[from.saturating_sub(1)], time[(from + 1).min(last)]];
        let ends = [time[to - 1], time[(to + 1).min(last)]];
        let shortest = 1e-6 * (time[to] - time[from]);
        let mut best = [time[from], (time[to] - time[from]).min(window)];
        loop {
            let before = self.severity(best);
            let [_, length] = best;
            let range = [starts[0].max(first), starts[1].min(end - length)];
            best[0] = summit(range, best[0], |start| self.severity([start, length]));
            let [start, _] = best;
            let [low, high] = [(ends[0] - start).max(shortest), (ends[1] - start).min(window).min(end - start)];
            // The start may have moved the end past its own range.
            let range = [low.min(length), high.max(length)];
            best[1] = summit(range, best[1], |length| self.severity([start, length]));
            if self.severity(best) <= before * (1.0 + 1e-14) {
                return [best[0], best[0] + best[1]];
            }
        }
    }
}

fn severity(rise: f64, length: f64) -> f64 {
    if rise > 0.0 { rise.powi(5) / length.powi(3) } else { 0.0 }
}

/// Where `f`, unimodal in a range, is largest; `known` where nothing higher is found.
fn summit([mut low, mut high]: [f64; 2], known: f64, f: impl Fn(f64) -> f64) -> f64 {
    for _ in 0..60 {
        let third = (high - low) / 3.0;
        if f(low + third) < f(high - third) { low += third } else { high -= third }
    }
    let found = 0.5 * (low + high);
    if f(found) > f(known) { found } else { known }
}

/// Samples of a block that is searched pair by pair.
const LEAF: usize = 16;

/// Bounds of consecutive samples.
#[derive(Clone, Copy)]
struct Block {
    lowest_speed: f64,
    highest_speed: f64,
    highest_level: f64,
}

impl Block {
    fn from_samples(speed: &[f64], level: &[f64]) -> Block {
        let lowest_speed = speed.iter().copied().fold(f64::INFINITY, f64::min);
        let highest_speed = speed.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        Block { lowest_speed, highest_speed, highest_level: level.iter().copied().fold(0.0, f64::max) }
    }

    fn with(self, other: Block) -> Block {
        Block {
            lowest_speed: self.lowest_speed.min(other.lowest_speed),
            highest_speed: self.highest_speed.max(other.highest_speed),
            highest_level: self.highest_level.max(other.highest_level),
        }
    }
}

/// Branch and bound over pairs of blocks, halved down to [`LEAF`] samples.
struct Search<'a> {
    pulse: &'a Pulse<'a>,
    window: f64,
    /// Blocks of `LEAF · 2^level` samples.
    levels: Vec<Vec<Block>>,
    best: f64,
    pair: Option<[usize; 2]>,
}

impl<'a> Search<'a> {
    fn new(pulse: &'a Pulse<'a>, window: f64) -> Search<'a> {
        let leaves = pulse.speed.chunks(LEAF).zip(pulse.level.chunks(LEAF));
        let mut levels = vec![leaves.map(|(speed, level)| Block::from_samples(speed, level)).collect::<Vec<_>>()];
        while let Some(below) = levels.last().filter(|blocks| blocks.len() > 1) {
            levels.push(below.chunks(2).map(|pair| pair[0].with(pair[pair.len() - 1])).collect());
        }
        Search { pulse, window: window * ROUNDING, levels, best: 0.0, pair: None }
    }

    /// The best pair of samples within the window; none where no two lie there.
    fn best_pair(mut self) -> Option<[usize; 2]> {
        self.seed();
        self.visit(self.levels.len() - 1, [0, 0]);
        self.pair
    }

    /// Coarse pairs of a few lengths, which exclude most blocks at once.
    fn seed(&mut self) {
        let (time, last) = (self.pulse.time, self.pulse.last());
        for halvings in 0..10 {
            let length = self.window / f64::from(1 << halvings);
            let mut to = 0;
            for from in (0..last).step_by(LEAF) {
                while to + LEAF <= last && time[to + LEAF] - time[from] <= length {
                    to += LEAF;
                }
                self.offer([from, to]);
            }
        }
    }

    fn offer(&mut self, [from, to]: [usize; 2]) {
        let Pulse { time, speed, .. } = self.pulse;
        if from >= to {
            return;
        }
        let found = severity(speed[to] - speed[from], time[to] - time[from]);
        if found > self.best || self.pair.is_none() {
            (self.best, self.pair) = (found, Some([from, to]));
        }
    }

    /// Looks for better pairs that start in block `a` and end in block `b` of a level.
    fn visit(&mut self, level: usize, [a, b]: [usize; 2]) {
        if self.bound(level, [a, b]) <= self.best {
            return;
        }
        let Some(below) = level.checked_sub(1) else {
            return self.leaf([a, b]);
        };
        let count = self.levels[below].len();
        for (a, b) in [(2 * a, 2 * b), (2 * a, 2 * b + 1), (2 * a + 1, 2 * b), (2 * a + 1, 2 * b + 1)] {
            if a <= b && b < count {
                self.visit(below, [a, b]);
            }
        }
    }

    /// Upper bound of all pairs of the two blocks: the largest rise at the largest mean, which neither the
    /// acceleration's peak nor the rise over the shortest time exceeds. Zero where they lie too far apart.
    fn bound(&self, level: usize, [a, b]: [usize; 2]) -> f64 {
        let (blocks, size) = (&self.levels[level], LEAF << level);
        let between = if a == b { 0.0 } else { self.pulse.time[b * size] - self.pulse.time[(a + 1) * size - 1] };
        let rise = blocks[b].highest_speed - blocks[a].lowest_speed;
        if between > self.window || rise <= 0.0 {
            return 0.0;
        }
        let peak = if b <= a + 1 { blocks[a].highest_level.max(blocks[b].highest_level) } else { 1.0 };
        let mean = if between > 0.0 { peak.min(rise / between) } else { peak };
        // Sums of rounded terms may rise a little faster than their largest term.
        rise * rise * mean.powi(3) * (1.0 + 1e-9)
    }

    fn leaf(&mut self, [a, b]: [usize; 2]) {
        let count = self.pulse.time.len();
        for from in a * LEAF..((a + 1) * LEAF).min(count) {
            for to in (b * LEAF).max(from + 1)..((b + 1) * LEAF).min(count) {
                if self.pulse.time[to] - self.pulse.time[from] > self.window {
                    break;
                }
                self.offer([from, to]);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_2, PI};

    use super::*;

    const G: f64 = STANDARD_GRAVITY;

    /// A pulse of `peak` g and `length` s in the middle of 100 ms, `shape` running from −1 to 1 over it.
    fn pulse(peak: f64, length: f64, step: f64, shape: impl Fn(f64) -> f64) -> Series {
        let time: Vec<f64> = (0..=(0.1 / step).round() as usize).map(|i| i as f64 * step).collect();
        let share = |t: f64| (t - 0.05) / (0.5 * length);
        let value = |t: &f64| if share(*t).abs() <= 1.0 + 1e-9 { peak * G * shape(share(*t)) } else { 0.0 };
        let values: Vec<f64> = time.iter().map(value).collect();
        Series::new(time, values)
    }

    fn hic(series: &Series, milliseconds: f64) -> Hic {
        head_injury_criterion(series, 1e-3 * milliseconds).unwrap()
    }

    /// Every pair of samples.
    fn by_force(series: &Series, window: f64) -> f64 {
        let (time, values) = (series.time(), series.values());
        let mut best: f64 = 0.0;
        for from in 0..time.len() {
            let mut rise = 0.0;
            for to in from + 1..time.len() {
                rise += 0.5 * (values[to] + values[to - 1]) * (time[to] - time[to - 1]);
                let length = time[to] - time[from];
                if length <= window * (1.0 + 1e-9) && rise > 0.0 {
                    best = best.max(length * (rise / length / G).powf(2.5));
                }
            }
        }
        best
    }

    /// Values that look like noise, the same in every run.
    fn noise(count: usize, seed: u64) -> Vec<f64> {
        std::iter::repeat_with(thorough::random(seed)).take(count).collect()
    }

    #[test]
    fn a_square_pulse_counts_for_its_length_or_the_windows() {
        let square = pulse(50.0, 0.02, 1e-4, |_| 1.0);
        let hic15 = hic(&square, 15.0);
        assert!((hic15.value - 265.165).abs() < 5e-4, "{hic15:?}");
        assert!((hic15.end - hic15.start - 0.015).abs() < 1e-12 && (hic15.mean - 50.0 * G).abs() < 1e-9);
        // Its flanks, a sample long each, contribute a little.
        let (hic36, exact) = (hic(&square, 36.0).value, 50f64.powf(2.5) * 0.02);
        assert!(hic36 >= exact && hic36 < 1.01 * exact, "{hic36} for {exact}");
    }

    #[test]
    fn a_half_sine_has_the_value_of_its_closed_form() {
        let length = 0.02;
        let sine = pulse(80.0, length, 1e-5, |x| (FRAC_PI_2 * x).cos());
        let of_angle = |angle: f64| length * 2.0 * angle / PI * (80.0 * angle.sin() / angle).powf(2.5);
        // The best interval ends where the pulse is 0.6 of its mean: tan φ = 5/3 φ.
        let mut angle: f64 = 1.0;
        for _ in 0..200 {
            angle = (5.0 / 3.0 * angle).atan();
        }
        let free = hic(&sine, 36.0);
        assert!((free.value / of_angle(angle) - 1.0).abs() < 1e-6, "{free:?} for {}", of_angle(angle));
        assert!((free.end - free.start - length * 2.0 * angle / PI).abs() < 1e-6);
        let short = hic(&sine, 8.0);
        assert!((short.value / of_angle(PI * 0.008 / (2.0 * length)) - 1.0).abs() < 1e-6);
        assert!((0.5 * (short.start + short.end) - 0.05).abs() < 1e-6);
    }

    #[test]
    fn a_triangle_has_the_value_of_its_closed_form() {
        let (length, peak) = (0.03, 60f64);
        let triangle = pulse(peak, length, 1e-4, |x| 1.0 - x.abs());
        let of_share = |share: f64| share * length * (peak * (1.0 - 0.5 * share)).powf(2.5);
        // It ends at 0.6 of its mean where 1 − x = 0.6 (1 − x/2).
        let free = hic(&triangle, 36.0);
        assert!((free.value / of_share(4.0 / 7.0) - 1.0).abs() < 1e-9, "{free:?}");
        let short = hic(&triangle, 15.0);
        assert!((short.value / of_share(0.5) - 1.0).abs() < 1e-9, "{short:?}");
    }

    #[test]
    fn the_search_finds_the_best_of_all_pairs() {
        for seed in 0..12 {
            let count = 150 + 97 * seed as usize;
            let steps = noise(count, seed + 100);
            let even = seed % 2 == 0;
            let time: Vec<f64> = steps
                .iter()
                .scan(0.0, |t, s| {
                    *t += if even { 1e-4 } else { 1e-4 * (0.2 + s) };
                    Some(*t)
                })
                .collect();
            let offset = [0.0, 0.5, 0.3][seed as usize % 3];
            let wave = |t: f64| 0.4 * (400.0 * t).sin();
            let noisy = noise(count, seed).into_iter().zip(&time).map(|(v, t)| 900.0 * (v - offset + wave(*t)));
            let series = Series::new(time.clone(), noisy.collect::<Vec<_>>());
            for window in [5e-4, 0.004, 0.015, 1.0] {
                let (found, least) = (head_injury_criterion(&series, window).unwrap().value, by_force(&series, window));
                assert!(found >= least * (1.0 - 1e-12), "seed {seed}, {window} s: {found} below {least}");
                assert!(found <= least * 1.5, "seed {seed}, {window} s: {found} far above {least}");
            }
        }
    }

    /// Of few samples that look like noise the best pair is up to 30 % too low.
    #[test]
    fn rough_signals_are_searched_between_their_samples() {
        for seed in 0..25 {
            let values: Vec<f64> = noise(17, seed).into_iter().map(|value| value - 0.3).collect();
            let series = Series::new((0..17).map(|i| 1e-3 * f64::from(i)).collect::<Vec<_>>(), values);
            let fine: Vec<f64> = (0..=128).map(|i| f64::from(i) / 8e3).collect();
            let between: Vec<f64> = fine.iter().map(|time| series.value_at(*time).unwrap()).collect();
            let (found, fine) = (hic(&series, 15.0).value, by_force(&Series::new(fine, between), 0.015));
            assert!(found >= fine * (1.0 - 1e-12), "seed {seed}: {found} below {fine}");
        }
    }

    #[test]
    fn series_without_a_criterion_are_refused() {
        let line = |values: Vec<f64>| Series::new((0..values.len()).map(|i| i as f64).collect::<Vec<_>>(), values);
        for (values, window, expected) in [
            (vec![1.0], 0.015, "the head injury criterion needs two samples, found 1"),
            (vec![1.0, f64::NAN], 0.015, "nothing was measured at 1 s"),
            (vec![-1.0, -2.0], 2.0, "the mean acceleration is positive between no two samples"),
            (vec![0.0, -1.0, 0.0], 2.0, "the mean acceleration is positive between no two samples"),
            (vec![-1e3, 1.0, -1e3], 2.0, "the mean acceleration is positive between no two samples"),
            (vec![1.0, 2.0], 0.015, "no two samples lie within a window of 0.015 s"),
            (vec![1.0, 2.0], 0.0, "a window of 0 s is not positive"),
        ] {
            let error = head_injury_criterion(&line(values), window).unwrap_err().to_string();
            assert!(error.starts_with(expected), "{error}");
        }
    }

    #[test]
    fn one_positive_sample_has_an_interval() {
        let series = Series::new(vec![7.0, 7.001, 7.002, 7.003], vec![G, -G, G, -G]);
        let found = hic(&series, 15.0);
        assert!(found.value > 0.0 && found.mean > 0.0 && found.start >= 7.0 && found.end <= 7.003, "{found:?}");
    }

    /// A cost quadratic in the samples would take hours.
    #[test]
    fn a_million_samples_are_searched() {
        let time: Vec<f64> = (0..1_000_000).map(|i| i as f64 * 1e-6).collect();
        let values: Vec<f64> = noise(time.len(), 7).into_iter().map(|v| 50.0 * G + v).collect();
        let found = hic(&Series::new(time, values), 15.0);
        assert!((found.value / 265.165 - 1.0).abs() < 0.01, "{found:?}");
    }
}
