//! The pair of samples with the largest criterion, by branch and bound.

use super::pulse::{Pulse, severity};

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
pub(super) struct Search<'a> {
    pulse: &'a Pulse<'a>,
    window: f64,
    /// Blocks of `LEAF · 2^level` samples.
    levels: Vec<Vec<Block>>,
    best: f64,
    pair: Option<[usize; 2]>,
}

impl<'a> Search<'a> {
    pub(super) fn new(pulse: &'a Pulse<'a>, window: f64) -> Search<'a> {
        let leaves = pulse.speed.chunks(LEAF).zip(pulse.level.chunks(LEAF));
        let mut levels = vec![leaves.map(|(speed, level)| Block::from_samples(speed, level)).collect::<Vec<_>>()];
        while let Some(below) = levels.last().filter(|blocks| blocks.len() > 1) {
            levels.push(below.chunks(2).map(|pair| pair[0].with(pair[pair.len() - 1])).collect());
        }
        // A sample that rounding of its time puts just past the window still counts.
        Search { pulse, window: window * (1.0 + 1e-9), levels, best: 0.0, pair: None }
    }

    /// The best pair of samples within the window; none where no two lie there.
    pub(super) fn best_pair(mut self) -> Option<[usize; 2]> {
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
