//! What puts recordings of coupons in doubt: slack at the start, the end of the load cell's range, a force that stays after
//! the break, figures that no film has.

use std::path::PathBuf;

use super::yield_points::line;
use super::{CouponTest, Curve, CurveEnd, Modulus, Rupture};
use crate::experiment::Warning;
use crate::experiment::drop::quantum;

/// Length of the line of the steepest part, over that of the modulus' window; the whole where that has too few samples.
const SHARES: [f64; 2] = [0.5, 1.0];
/// Fewest samples of that line, and its places over its length.
const FEWEST_STEEP: usize = 5;
const PLACES: f64 = 8.0;
/// Most places that are tried.
const MOST_PLACES: f64 = 1e5;
/// Largest strain that is taken for slack: rubber that stiffens does so later.
const MOST_SLACK: f64 = 0.25;
/// Scatter of the samples about that line by which it rises at least: noise of slack rises by less.
const RISES: f64 = 5.0;
/// Share of the steepest slope below which the rise has ended, and from which on a slope is as steep.
const ENDED: f64 = 0.5;
const NEARLY: f64 = 0.95;
/// Share of the steepest slope below which a start is slack, if it changes the modulus by the other share.
const SLACK: f64 = 0.8;
const CHANGES: f64 = 0.05;

impl Curve {
    /// The line of the steepest part of the first rise, by which ISO 527-1 and ASTM D882 compensate a toe: the first stretch,
    /// half as long as the `window` of the modulus, that is as steep as any up to where half of the slope is lost.
    pub fn steepest(&self, [from, to]: [f64; 2]) -> Option<Modulus> {
        let width = (to - from).clamp(0.0, self.range()[1] - self.range()[0]);
        SHARES.into_iter().find_map(|share| self.steepest_over(share * width))
    }

    fn steepest_over(&self, width: f64) -> Option<Modulus> {
        let [start, end] = self.range();
        let step = (width / PLACES).max((end - start) / MOST_PLACES);
        let places = ((end - start - width).clamp(0.0, MOST_SLACK) / step).floor() as usize;
        let (mut lines, mut most): (Vec<Modulus>, f64) = (Vec::new(), 0.0);
        for place in 0..=places {
            let from = start + step * place as f64;
            let Some((line, scatter)) = self.line_between([from, from + width]) else { continue };
            // Noise of slack falls as often as it rises.
            if most > 0.0 && line.slope < ENDED * most {
                break;
            }
            if line.slope * width > RISES * scatter {
                most = most.max(line.slope);
                lines.push(line);
            }
        }
        lines.into_iter().find(|line| line.slope > 0.0 && line.slope >= NEARLY * most)
    }

    /// The line through the samples between two strains, and how far they scatter about it (Pa).
    fn line_between(&self, [from, to]: [f64; 2]) -> Option<(Modulus, f64)> {
        let first = self.strain().partition_point(|strain| *strain < from);
        let last = self.strain().partition_point(|strain| *strain <= to);
        let inside = first..last.max(first);
        let pairs = self.strain()[inside.clone()].iter().zip(&self.stress()[inside]);
        let points: Vec<[f64; 2]> = pairs.map(|(strain, stress)| [*strain, *stress]).collect();
        let line = if points.len() < FEWEST_STEEP { None } else { line(&points) }?;
        let squares: f64 = points.iter().map(|[strain, stress]| (stress - line.stress(*strain)).powi(2)).sum();
        Some((line, (squares / points.len() as f64).sqrt()))
    }

    /// The slack before the rise, where it changes the modulus between the strains of `window`, which is `modulus` with it.
    pub(super) fn slack(&self, window: [f64; 2], modulus: &Modulus) -> Option<Slack> {
        let steepest = self.steepest(window)?;
        let strain = -steepest.intercept / steepest.slope;
        let [start, _] = self.range();
        let width = SHARES[0] * (window[1] - window[0]);
        let first = self.line_between([start, start + width]).map_or(modulus.slope, |(line, _)| line.slope);
        let whole = self.toe_compensated(steepest.slope, steepest.intercept).modulus(window).ok()?;
        let is_slack = first < SLACK * steepest.slope && whole.slope > (1.0 + CHANGES) * modulus.slope;
        is_slack.then_some(Slack { strain, modulus: whole.slope })
    }

    /// The largest stress (Pa), where samples in a row are exactly that which a curve that bends would not have so often.
    pub(super) fn saturated(&self) -> Option<f64> {
        let stress = self.stress();
        let most = stress.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let runs = stress.chunk_by(|a, b| a == b).scan(0, |first, run| {
            *first += run.len();
            Some([*first - run.len(), run.len()])
        });
        let [first, count] = runs.filter(|[first, _]| stress[*first] == most).max_by_key(|[_, count]| *count)?;
        let rise = most - stress[first.saturating_sub(count)];
        (count >= FEWEST_EQUAL && rise > BEYOND_STEPS * quantum(stress)).then_some(most)
    }

    /// Stress (Pa) that is left after the break and stays.
    pub(super) fn after_break(&self, rupture: &Rupture) -> Option<f64> {
        let broken = self.strain().partition_point(|strain| *strain <= rupture.strain);
        let after = &self.stress()[broken..];
        // The first half may belong to the fall.
        let left = &after[after.len() / 2..];
        if rupture.ending != CurveEnd::Broke || left.len() < FEWEST_EQUAL {
            return None;
        }
        let mean = left.iter().sum::<f64>() / left.len() as f64;
        let apart = left.iter().map(|stress| (stress - mean).abs()).fold(0.0, f64::max);
        (mean.abs() > LEFT * rupture.strength && apart < 0.5 * mean.abs()).then_some(mean)
    }
}

/// Fewest equal samples in a row that count.
const FEWEST_EQUAL: usize = 5;
/// Steps of the recorder by which stress rises over as many samples before a saturated run at least: the top of a smooth curve
/// stays within one step for so long that it rose by four over as long before.
const BEYOND_STEPS: f64 = 8.0;
/// Share of the strength that is left after a break at least.
const LEFT: f64 = 0.02;

/// Slack at the start of a curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slack {
    /// Engineering strain of the recording at which the line of the steepest part begins.
    pub strain: f64,
    /// Young's modulus counted from there, Pa.
    pub modulus: f64,
}

/// Thickness (m), Young's modulus and strength (Pa) that films have; the first as scenarios take it.
const LIKELY: [(&str, &str, f64, [f64; 2]); 3] = [
    ("thickness", "mm", 1e3, [1e-6, 2e-3]),
    ("Young's modulus", "MPa", 1e-6, [1e6, 1e11]),
    ("strength", "MPa", 1e-6, [1e5, 1e10]),
];

/// The doubts about `tests`, each once with all recordings that it is about.
pub fn doubts(tests: &[CouponTest]) -> Vec<Warning> {
    let of = |value: &dyn Fn(&CouponTest) -> Option<f64>| -> Option<(Vec<PathBuf>, Vec<f64>)> {
        let (paths, values): (Vec<PathBuf>, Vec<f64>) =
            tests.iter().filter_map(|test| Some((test.place(), value(test)?))).unzip();
        (!paths.is_empty()).then_some((paths, values))
    };
    let slack: Vec<&CouponTest> = tests.iter().filter(|test| test.sample.slack.is_some()).collect();
    let slack = (!slack.is_empty()).then(|| Warning::SlackAtStart {
        paths: slack.iter().map(|test| test.place()).collect(),
        slack: slack.iter().filter_map(|test| test.sample.slack).collect(),
        moduli: slack.iter().map(|test| test.sample.modulus.slope).collect(),
    });
    let saturated = of(&|test| Some(test.sample.saturated? * test.coupon.area()));
    let saturated = saturated.map(|(paths, forces)| Warning::SaturatedLoadCell { paths, forces });
    let left = of(&|test| Some(test.sample.after_break? * test.coupon.area()));
    let left = left.map(|(paths, forces)| Warning::ForceAfterBreak { paths, forces });
    let implausible = LIKELY.into_iter().enumerate().filter_map(|(place, (what, unit, factor, [least, most]))| {
        let figure = |test: &CouponTest| {
            [test.coupon.thickness(), test.sample.modulus.slope, test.sample.rupture.strength][place]
        };
        let is_likely = |value: &f64| (least..=most).contains(value);
        let (paths, found) = of(&|test| Some(figure(test)).filter(|value| !is_likely(value)))?;
        let found = found.iter().map(|value| factor * value).collect();
        Some(Warning::ImplausibleCoupon { paths, what, unit, found, likely: [factor * least, factor * most] })
    });
    [slack, saturated, left].into_iter().flatten().chain(implausible).collect()
}

#[cfg(test)]
mod tests {
    use super::super::{Direction, Rules, Sample};
    use super::*;

    const GAUGE: f64 = 0.05;

    /// Slack (m), then `stress` (Pa) over strain up to 4, then nothing: 20 ms apart at 500 mm/min.
    fn recorded(slack: f64, stress: impl Fn(f64) -> f64, offset: f64, noise: f64) -> Curve {
        let step = 500e-3 / 60.0 * 0.02 / GAUGE;
        let strain: Vec<f64> = (0..1250).map(|row| step * f64::from(row)).collect();
        let value = |(row, strain): (usize, &f64)| {
            let pulled = strain - slack / GAUGE;
            let film = if (0.0..=4.0).contains(&pulled) { stress(pulled) } else { 0.0 };
            // A sequence that scatters evenly (Weyl).
            film + offset + noise * (2.0 * (0.618_034 * row as f64).fract() - 1.0)
        };
        let stress = strain.iter().enumerate().map(value).collect();
        Curve::new(strain, stress).unwrap()
    }

    /// 150 MPa up to a strain of 0.06, then 11 MPa.
    fn bilinear(strain: f64) -> f64 {
        150e6 * strain.min(0.06) + 11e6 * (strain - 0.06).max(0.0)
    }

    fn sample(curve: &Curve, toe_compensation: bool) -> Sample {
        let rules = Rules { toe_compensation, ..Rules::default() };
        Sample::new(Direction::Md, 0.01, curve, &rules).unwrap()
    }

    #[test]
    fn the_modulus_does_not_depend_on_slack_that_is_compensated() {
        for slack in [0.0, 0.4e-3, 0.8e-3, 1.2e-3] {
            for (offset, noise) in [(0.0, 0.0), (0.13e6, 0.04e6)] {
                let curve = recorded(slack, bilinear, offset, noise);
                let (plain, compensated) = (sample(&curve, false), sample(&curve, true));
                let off = compensated.modulus.slope / 150e6 - 1.0;
                assert!(off.abs() < 0.03, "{slack} m: off by {off}");
                assert!((compensated.rupture.strain - 4.0).abs() < 0.02, "{slack}: {}", compensated.rupture.strain);
                assert_eq!(compensated.slack, None);
                assert_eq!(plain.slack.is_some(), slack > 0.0, "{slack}: {:?}", plain.modulus);
                let found = plain.slack.map_or(slack / GAUGE, |found| found.strain);
                assert!((found - slack / GAUGE).abs() < 3e-3, "{slack}: {found}");
            }
        }
    }

    #[test]
    fn film_that_softens_or_hardens_has_no_slack() {
        let softens = |strain: f64| 10e6 * (1.0 - (-strain / 0.05).exp());
        let hardens = |strain: f64| 5e6 * strain + 2e6 * strain.powi(3);
        for curve in [recorded(0.0, softens, 0.0, 0.02e6), recorded(0.0, hardens, 0.0, 0.0)] {
            assert_eq!(sample(&curve, false).slack, None);
        }
        // The mean slope over a strain of 0.04, with slack of 0.016.
        let mean = sample(&recorded(0.0, softens, 0.0, 0.0), false).modulus.slope;
        let found = sample(&recorded(0.8e-3, softens, 0.0, 0.0), true).modulus.slope;
        assert!((found / mean - 1.0).abs() < 0.05, "{found} for {mean}");
        // More slack than the window of the modulus is long.
        let whole = sample(&recorded(5e-3, bilinear, 0.0, 0.01e6), true).modulus.slope;
        assert!((whole / 150e6 - 1.0).abs() < 0.03, "{whole}");
    }

    #[test]
    fn a_flat_end_of_the_range_is_told_from_the_top_of_a_curve() {
        let step = 26.7e3;
        let rounded = |stress: f64| (stress / step).round() * step;
        let limited = |strain: f64| rounded(bilinear(strain)).min(rounded(26.7e6));
        assert_eq!(sample(&recorded(0.0, limited, 0.0, 0.0), false).saturated, Some(rounded(26.7e6)));
        assert_eq!(sample(&recorded(0.0, |strain| rounded(bilinear(strain)), 0.0, 0.0), false).saturated, None);
        // A smooth maximum in the middle, resolved coarsely, of which many samples are equal.
        let top = |strain: f64| rounded(20e6 - 4e6 * (strain - 2.0).powi(2));
        let top = recorded(0.0, top, 0.0, 0.0);
        let equal = top.stress().iter().filter(|stress| **stress == rounded(20e6)).count();
        assert!(equal > 30, "{equal}");
        assert_eq!(top.saturated(), None);
    }

    #[test]
    fn a_force_that_stays_after_the_break_is_seen() {
        let left = |offset: f64, noise: f64| sample(&recorded(0.0, bilinear, offset, noise), false).after_break;
        let found = left(2.7e6, 0.05e6).unwrap();
        assert!((found / 2.7e6 - 1.0).abs() < 0.02, "{found}");
        assert!(left(-2.7e6, 0.0).is_some());
        assert_eq!([left(0.13e6, 0.04e6), left(0.0, 0.04e6)], [None; 2]);
    }
}
