//! The middle of a line where it turns.
//!
//! A pen of the width w that follows a curve covers in each column what lies within w/2 of the curve. At a peak that is
//! narrower than the pen, both flanks meet below it, and the middle of what is covered lies below the curve. Its upper edge
//! is that of the pen at the peak: rolled along that edge, the pen finds every peak again, along the lower edge every valley
//! (erosion of a dilated set by the same disc).

/// Steps of the pen within a column.
const STEPS: i32 = 4;

/// Difference of both ways, pixels, up to which the middle is taken.
const SAME: f64 = 0.25;

/// Share of the difference of both ways by which a point is uncertain.
const DOUBT: f64 = 0.5;

/// The curve of a line, from the middles (across and down) and heights of what it covers in columns, and by how much each
/// point is uncertain.
pub(super) fn at_extremes(middles: &[[f64; 2]], covered: &[f64]) -> (Vec<[f64; 2]>, Vec<f64>) {
    let pen = Pen { middles, covered, radius: 0.5 * width(middles, covered) };
    let found = (0..middles.len()).map(|place| pen.point(place));
    found.unzip()
}

/// Width of the pen: the median of what it covers across its way.
fn width(middles: &[[f64; 2]], covered: &[f64]) -> f64 {
    let across = middles.windows(3).zip(&covered[1.min(covered.len())..]).map(|(three, covered)| {
        let slope = (three[2][1] - three[0][1]) / (three[2][0] - three[0][0]);
        covered / slope.hypot(1.0)
    });
    let mut across: Vec<f64> = across.collect();
    across.sort_unstable_by(f64::total_cmp);
    across.get(across.len() / 2).copied().unwrap_or(0.0)
}

struct Pen<'a> {
    middles: &'a [[f64; 2]],
    covered: &'a [f64],
    radius: f64,
}

impl Pen<'_> {
    fn point(&self, place: usize) -> ([f64; 2], f64) {
        let [column, middle] = self.middles[place];
        // Down is positive: the pen below the upper edge, and above the lower one.
        let [Some(peak), Some(valley)] = [-1.0, 1.0].map(|side| self.rolled(place, side)) else {
            return ([column, middle], 0.0);
        };
        let difference = valley - peak;
        if difference < SAME {
            return ([column, middle], 0.0);
        }
        let doubt = DOUBT * difference;
        let reach = (2.0 * self.radius).ceil() as usize + 1;
        let beside = [place.saturating_sub(reach), (place + reach).min(self.middles.len() - 1)];
        let [before, after] = beside.map(|place| self.middles[place][1]);
        let row = if before > middle && after > middle {
            peak
        } else if before < middle && after < middle {
            valley
        } else {
            middle
        };
        ([column, row], doubt)
    }

    /// Middle of the pen in a column where it touches the upper (`side` −1) or lower (1) edge from within; `None` beside a gap.
    fn rolled(&self, place: usize, side: f64) -> Option<f64> {
        let edge = |place: usize| self.middles[place][1] + side * 0.5 * self.covered[place];
        let steps = (self.radius * f64::from(STEPS)) as i32;
        let mut nearest = f64::NEG_INFINITY;
        for step in -steps..=steps {
            let off = f64::from(step) / f64::from(STEPS);
            let from = place.checked_add_signed(off.floor() as isize)?;
            let part = off - off.floor();
            let to = from + usize::from(part > 0.0);
            let column = self.middles[place][0] + off.floor();
            if to >= self.middles.len() || self.middles[from][0] != column || self.middles[to][0] > column + 1.0 {
                return None;
            }
            let height = (1.0 - part) * edge(from) + part * edge(to);
            // Measured inwards from the edge.
            nearest = nearest.max(-side * height + (self.radius * self.radius - off * off).max(0.0).sqrt());
        }
        Some(-side * nearest)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What a pen covers in columns at 0.5, 1.5, …: middles and heights.
    fn drawn(curve: impl Fn(f64) -> f64, columns: u32, width: f64) -> (Vec<[f64; 2]>, Vec<f64>) {
        let column = |column: u32| {
            let at = f64::from(column) + 0.5;
            let reach = (-200..=200).map(|k| 0.5 * width * f64::from(k) / 200.0);
            let ends = reach.map(|off| (curve(at + off), (0.25 * width * width - off * off).max(0.0).sqrt()));
            let (top, bottom) = ends.fold((f64::INFINITY, f64::NEG_INFINITY), |(top, bottom), (row, half)| {
                (top.min(row - half), bottom.max(row + half))
            });
            ([at, top.midpoint(bottom)], bottom - top)
        };
        (0..columns).map(column).unzip()
    }

    #[test]
    fn corners_narrower_than_the_pen_are_found() {
        for width in [1.0, 2.0, 4.0, 6.0] {
            for slope in [0.5, 2.0, 8.0] {
                for side in [-1.0, 1.0] {
                    let curve = |at: f64| 100.0 + side * slope * (10.0 - (at - 20.5).abs());
                    let (middles, covered) = drawn(curve, 41, width);
                    let (points, doubts) = at_extremes(&middles, &covered);
                    let off = points[20][1] - curve(20.5);
                    // The pen goes by quarters of a pixel, which on a flank are rows in proportion to its slope; one of a
                    // single pixel has four of them.
                    let [share, most] = if width > 1.0 { [0.125, 0.55] } else { [0.14, 1.1] };
                    let most = (share * slope).clamp(0.15, most);
                    assert!(off.abs() < most, "{width} {slope} {side}: {off}");
                    for ([at, row], doubt) in points.iter().zip(doubts).skip(8).take(25) {
                        let off = (row - curve(*at)).abs();
                        assert!(
                            off < 0.3 + 0.5 * width * slope,
                            "{width} {slope} {side} at {at}: {off}, doubt {doubt}"
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn straight_lines_and_the_columns_beside_gaps_stay() {
        let (mut middles, mut covered) = drawn(|at| 20.0 + 3.0 * at, 30, 3.0);
        let (points, doubts) = at_extremes(&middles, &covered);
        assert!(points == middles && doubts.iter().all(|doubt| *doubt < SAME), "{doubts:?}");
        middles.drain(10..13);
        covered.drain(10..13);
        assert_eq!(at_extremes(&middles, &covered).0, middles);
    }
}
