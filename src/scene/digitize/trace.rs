//! The curve in pixels: in each column of the picture, the middle of what it covers.
//!
//! A column may show the colour in several places: a legend, letters, noise. Of all ways through the columns, that is
//! taken which covers most and jumps least, by dynamic programming.

use std::ops::Range;

use thiserror::Error;

use super::grid::Grid;
use super::{Ink, extremes};

/// Least coverage of a pixel that belongs to a run.
const LEAST: f64 = 0.2;

/// Least coverage of a whole run.
const LEAST_SUM: f64 = 0.5;

/// Coverage beyond which a run counts no more: letters are no better than a line.
const MOST_SUM: f64 = 2.0;

/// Cost of a jump, per pixel down or up between the ends of two runs.
const JUMP: f64 = 0.2;

/// Cost of a column without the curve.
const SKIP: f64 = 0.05;

/// Most runs of a column, in the mean, among which a curve is looked for: the way through them takes a time that grows with
/// the square of their number.
const MOST_RUNS: usize = 20;

/// Share of a column from which what covers it is a line of the figure, such as its frame or an axis: a curve that goes up and down
/// as far within a pixel has no middle there.
const FRAME: f64 = 0.9;

/// Most columns that a dash or another curve may interrupt it for, as a share of all.
const LONGEST_GAP: f64 = 0.08;

/// A curve in pixels: the middle of what it covers in each column that has it, at extremes by its outer edge.
#[derive(Clone, Debug, PartialEq)]
pub struct Trace {
    /// Middles of pixels across and down, in rising order across.
    pub points: Vec<[f64; 2]>,
    /// How much of each of their columns the curve covers, pixels.
    pub covered: Vec<f64>,
    /// By how much each middle is uncertain where the line turns within its width, pixels.
    pub doubts: Vec<f64>,
    /// Thickness of the line: the median of what it covers, pixels.
    pub thickness: f64,
    /// Numbers of columns between points where the curve is missing.
    pub gaps: Vec<[f64; 2]>,
    /// Share of what has its colour that is not on it.
    pub elsewhere: f64,
}

/// A curve that cannot be traced.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum TraceError {
    /// No pixel of the area has its colour.
    #[error("nothing in the area has the colour of the curve")]
    Nothing,
    /// The colour is scattered over the area.
    #[error("the colour of the curve is in {runs} places of a column, in the mean; at most {MOST_RUNS} are searched")]
    Scattered {
        /// Mean number of separate places of a column.
        runs: usize,
    },
}

/// A part of a column that the curve may cover.
#[derive(Clone, Copy, Debug)]
struct Run {
    column: usize,
    top: usize,
    bottom: usize,
    middle: f64,
    sum: f64,
    /// Largest coverage of a pixel.
    most: f64,
}

impl Run {
    /// Of lines as wide that one counts more that is covered wholly: another colour may be half of the curve's.
    fn score(&self) -> f64 {
        self.sum.min(MOST_SUM) * self.most * self.most
    }

    /// Pixels up or down to another run.
    fn distance(&self, other: &Run) -> f64 {
        let apart = |above: &Run, below: &Run| below.top.saturating_sub(above.bottom + 1);
        apart(self, other).max(apart(other, self)) as f64
    }
}

/// Traces the curve in `columns` and `rows`, of which `pixel(column, row)` is the colour and `has(column, row)` says whether
/// it is looked at.
pub(super) fn trace(
    [columns, rows]: [Range<usize>; 2],
    ink: &Ink,
    pixel: impl Fn(usize, usize) -> Option<[u8; 3]>,
) -> Result<Trace, TraceError> {
    let width = columns.len();
    let longest = ((LONGEST_GAP * width as f64) as usize).max(3);
    let coverage = |column: usize, row: usize| pixel(column, row).map_or(0.0, |colour| ink.coverage(colour));
    let grid = Grid::new([columns.clone(), rows.clone()], coverage);
    let runs: Vec<Run> = columns.flat_map(|column| column_runs(column, rows.clone(), &grid, &coverage)).collect();
    let all: f64 = runs.iter().map(|run| run.sum).sum();
    if runs.len() > MOST_RUNS * width {
        return Err(TraceError::Scattered { runs: runs.len() / width });
    }
    let path = without_jumps(best(&runs, longest).ok_or(TraceError::Nothing)?);
    let gaps = path.windows(2).filter(|pair| pair[1].column > pair[0].column + 1);
    let gaps = gaps.map(|pair| [pair[0].column as f64 + 0.5, pair[1].column as f64 + 0.5]).collect();
    let covered: Vec<f64> = path.iter().map(|run| run.sum).collect();
    let on_it: f64 = covered.iter().sum();
    let mut sorted = covered.clone();
    sorted.sort_unstable_by(f64::total_cmp);
    let middles: Vec<[f64; 2]> = path.iter().map(|run| [run.column as f64 + 0.5, run.middle]).collect();
    let (points, doubts) = extremes::at_extremes(&middles, &covered);
    Ok(Trace { points, covered, doubts, thickness: sorted[sorted.len() / 2], gaps, elsewhere: 1.0 - on_it / all })
}

/// The way without columns in which it covers far more, up and down, than in both columns beside, or far more faintly: a line
/// across it.
fn without_jumps(path: Vec<Run>) -> Vec<Run> {
    let crosses = |at: usize| {
        let (Some(before), Some(after)) = (at.checked_sub(1).and_then(|at| path.get(at)), path.get(at + 1)) else {
            return false;
        };
        let (run, height) = (&path[at], |run: &Run| run.bottom - run.top + 1);
        let most = height(before).max(height(after));
        let [top, bottom] = [before.top.min(after.top), before.bottom.max(after.bottom)];
        let is_faint = height(run) > 3 * most && run.sum < 0.75 * height(run) as f64;
        is_faint || (bottom - top < 2 * most && run.top + most < top && run.bottom > bottom + most)
    };
    let keep: Vec<bool> = (0..path.len()).map(|at| !crosses(at)).collect();
    path.into_iter().zip(keep).filter(|(_, keep)| *keep).map(|(run, _)| run).collect()
}

fn column_runs(column: usize, rows: Range<usize>, grid: &Grid, covered: &impl Fn(usize, usize) -> f64) -> Vec<Run> {
    let mut coverage: Vec<f64> = rows.clone().map(|row| covered(column, row)).collect();
    let mut runs = Vec::new();
    if coverage.iter().filter(|share| **share >= LEAST).count() as f64 >= FRAME * coverage.len() as f64 {
        return runs;
    }
    grid.remove(&mut coverage);
    let mut next = 0;
    while next < coverage.len() {
        if coverage[next] < LEAST {
            next += 1;
            continue;
        }
        let start = next;
        next = start + coverage[start..].iter().take_while(|share| **share >= LEAST).count();
        let end = next;
        // The faint edges of the line count too: without them its middle would jump by half pixels.
        let (from, to) = (start.saturating_sub(1), (end + 1).min(coverage.len()));
        let sum: f64 = coverage[from..to].iter().sum();
        let moment: f64 = (from..to).map(|row| coverage[row] * (row as f64 + 0.5)).sum();
        if sum >= LEAST_SUM {
            let most = coverage[start..end].iter().copied().fold(0.0, f64::max);
            let [top, bottom] = [start, end - 1].map(|row| row + rows.start);
            runs.push(Run { column, top, bottom, middle: moment / sum + rows.start as f64, sum, most });
        }
    }
    runs
}

/// The way through the runs, which are in the order of their columns, that covers most and jumps least.
fn best(runs: &[Run], longest: usize) -> Option<Vec<Run>> {
    let mut scores: Vec<f64> = Vec::with_capacity(runs.len());
    let mut before: Vec<Option<usize>> = Vec::with_capacity(runs.len());
    for (place, run) in runs.iter().enumerate() {
        let near = runs[..place].iter().enumerate().rev();
        let near = near.take_while(|(_, other)| run.column - other.column <= longest + 1);
        let ways = near.filter(|(_, other)| other.column < run.column).map(|(other, from)| {
            let skipped = (run.column - from.column - 1) as f64;
            // Over a gap, the curve may rise without a jump.
            let jump = (run.distance(from) - skipped).max(0.0);
            (scores[other] - JUMP * jump - SKIP * skipped, other)
        });
        let way = ways.max_by(|a, b| a.0.total_cmp(&b.0)).filter(|(score, _)| *score > 0.0);
        scores.push(run.score() + way.map_or(0.0, |(score, _)| score));
        before.push(way.map(|(_, other)| other));
    }
    let end = (0..runs.len()).max_by(|a, b| scores[*a].total_cmp(&scores[*b]))?;
    let mut path: Vec<Run> =
        std::iter::successors(Some(end), |place| before[*place]).map(|place| runs[place]).collect();
    path.reverse();
    Some(path)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::digitize::Fidelity;

    /// A black curve at row 80 that rises to 20, in a black frame of some pixels at the columns 0 and 99 and the rows 0 and 99.
    #[test]
    fn a_frame_of_the_colour_of_the_curve_is_not_the_curve() {
        let ink = Ink::new([0; 3], [255; 3], 0.25, Fidelity::EXACT).unwrap();
        for (width, faint) in [(1, 0.0), (2, 0.4), (3, 0.8)] {
            let curve = |column: usize| if column < 50 { 80 } else { 80 - (column - 50).min(30) * 2 };
            let pixel = |column: usize, row: usize| {
                let off = column.min(99 - column);
                let is_line = off < width || row.abs_diff(curve(column)) <= width;
                let share = if is_line {
                    1.0
                } else if off == width {
                    faint
                } else {
                    0.0
                };
                Some([(255.0 * (1.0 - share)) as u8; 3])
            };
            let found = trace([0..100, 0..100], &ink, pixel).unwrap();
            let at = |column: usize| found.points.iter().find(|point| point[0] == column as f64 + 0.5);
            assert!(at(width - 1).is_none() && at(100 - width).is_none(), "{width}: {:?}", found.points);
            assert!(found.points.len() >= 100 - 2 * width - 2);
            for [column, row] in &found.points {
                let off = row - 0.5 - curve(*column as usize) as f64;
                assert!(off.abs() < 2.0, "{width}: {off} at {column}");
            }
        }
    }
}
