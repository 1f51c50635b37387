//! A deceleration with its integral, and the refinement of an interval between its samples.

use crate::signal::Series;

/// An acceleration over its peak, and its integral.
pub(super) struct Pulse<'a> {
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

pub(super) fn severity(rise: f64, length: f64) -> f64 {
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
