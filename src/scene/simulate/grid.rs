//! Values at uneven times, interpolated onto an even grid.

use serde::{Deserialize, Serialize};

use super::rows;

/// Linear interpolation of `K` values onto the times `start + k·step`, while they are added.
#[derive(Serialize, Deserialize)]
pub(super) struct Grid<const K: usize> {
    start: f64,
    step: f64,
    /// Rows that are kept at most.
    most: usize,
    last: Option<Sample<K>>,
    #[serde(with = "rows")]
    pub(super) rows: Vec<[f64; K]>,
}

/// Values at a time, as they were added.
#[derive(Clone, Copy, Serialize, Deserialize)]
struct Sample<const K: usize> {
    time: f64,
    #[serde(with = "rows::one")]
    values: [f64; K],
}

impl<const K: usize> Grid<K> {
    /// A grid of at most so many rows from `start` (s) in steps of `step` (s).
    pub(super) fn new(start: f64, step: f64, most: usize) -> Grid<K> {
        Grid { start, step, most, last: None, rows: vec![] }
    }

    /// Whether it has the same places as the other, whatever its rows.
    pub(super) fn is_like(&self, other: &Grid<K>) -> bool {
        [self.start, self.step] == [other.start, other.step] && self.most == other.most
    }

    /// Whether `time` (s) has reached that of the next row.
    pub(super) fn is_due(&self, time: f64) -> bool {
        self.start + self.rows.len() as f64 * self.step <= time
    }

    /// Adds the values at `time` (s), later than all before.
    pub(super) fn push(&mut self, time: f64, values: [f64; K]) {
        let now = Sample { time, values };
        let Sample { time: before, values: from } = self.last.unwrap_or(now);
        while self.rows.len() < self.most {
            let at = self.start + self.rows.len() as f64 * self.step;
            if at > time {
                break;
            }
            let share = if time > before { ((at - before) / (time - before)).max(0.0) } else { 1.0 };
            self.rows.push(std::array::from_fn(|k| from[k] + share * (values[k] - from[k])));
        }
        self.last = Some(now);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_straight_line_is_interpolated_exactly() {
        let mut grid = Grid::new(-0.5, 0.25, 7);
        for time in [-0.7, -0.1, 0.0, 0.9, 1.05] {
            grid.push(time, [2.0 * time + 1.0]);
        }
        grid.push(1e300, [0.0]);
        assert_eq!(grid.rows.len(), 7);
        for (k, row) in grid.rows.iter().enumerate() {
            assert!((row[0] - (2.0 * (-0.5 + 0.25 * k as f64) + 1.0)).abs() < 1e-12);
        }
    }
}
