//! The lines of a grid, whose colour is half of the curve's: what columns and rows have in common.

use std::ops::Range;

/// Coverage from which a line is no grid's, but may be the curve.
const SURE: f64 = 0.7;

/// Coverage below which there is no line.
const LEAST: f64 = 0.08;

/// Part of a row that lies below what its grid line covers: a curve that is level over a part of the plot is no grid.
const LOW: f64 = 0.05;

/// Bins of coverages.
const BINS: usize = 50;

/// Coverages that horizontal lines of the grid add, by rows from the first.
pub(super) struct Grid {
    rows: Vec<f64>,
}

impl Grid {
    /// The grid in `columns` and `rows`, of which `coverage(column, row)` is the share of a pixel that seems covered. One
    /// horizontal line alone is none: a level curve would be.
    pub(super) fn new([columns, rows]: [Range<usize>; 2], coverage: impl Fn(usize, usize) -> f64) -> Grid {
        let level = |row: usize| {
            let mut bins = [0_usize; BINS + 1];
            columns.clone().for_each(|column| bins[(coverage(column, row) * BINS as f64) as usize] += 1);
            let below = LOW * columns.len() as f64;
            let mut counted = 0;
            let place = bins.iter().position(|count| {
                counted += count;
                counted as f64 > below
            });
            in_line(place.unwrap_or(0) as f64 / BINS as f64)
        };
        let rows: Vec<f64> = rows.map(level).collect();
        let lines = (0..rows.len()).filter(|at| rows[*at] > 0.0 && (*at == 0 || rows[at - 1] == 0.0)).count();
        if lines > 1 { Grid { rows } } else { Grid { rows: vec![0.0; rows.len()] } }
    }

    /// Takes the grid off a column: the horizontal lines, and a vertical one where most of the column is covered alike.
    pub(super) fn remove(&self, column: &mut [f64]) {
        let mut sorted = column.to_vec();
        sorted.sort_unstable_by(f64::total_cmp);
        let along = in_line(sorted[sorted.len() / 2]);
        for (share, row) in column.iter_mut().zip(&self.rows) {
            let grid = along.max(*row);
            *share = ((*share - grid) / (1.0 - grid)).max(0.0);
        }
    }
}

/// The coverage, where it may be that of a grid line.
fn in_line(coverage: f64) -> f64 {
    if (LEAST..SURE).contains(&coverage) { coverage } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Coverages of a plot of 40 × 30 pixels with lines of a grid at rows 10 and 20 and in column 7, and a curve.
    fn coverage(column: usize, row: usize, lines: &[usize], curve: f64) -> f64 {
        let is_curve = row == if column < 20 { 10 } else { 15 };
        let grid = if lines.contains(&row) || column == 7 { 0.4 } else { 0.0 };
        if is_curve { grid + (1.0 - grid) * curve } else { grid }
    }

    fn left(column: usize, lines: &[usize], curve: f64) -> Vec<f64> {
        let at = |column, row| coverage(column, row, lines, curve);
        let mut all: Vec<f64> = (0..30).map(|row| at(column, row)).collect();
        Grid::new([0..40, 0..30], at).remove(&mut all);
        all
    }

    #[test]
    fn lines_are_taken_off_and_the_curve_stays() {
        for column in [3, 7, 30] {
            for (row, share) in left(column, &[10, 20], 0.9).into_iter().enumerate() {
                let expected = if row == if column < 20 { 10 } else { 15 } { 0.9 } else { 0.0 };
                assert!((share - expected).abs() < 0.02, "column {column}, row {row}: {share}");
            }
        }
    }

    #[test]
    fn a_level_curve_is_no_grid() {
        assert!((left(3, &[], 0.5)[10] - 0.5).abs() < 1e-12, "over half of the plot");
        let level = Grid::new([0..40, 0..30], |_, row| if row == 10 || row == 11 { 0.5 } else { 0.0 });
        assert!(level.rows.iter().all(|row| *row == 0.0), "a single line");
    }
}
