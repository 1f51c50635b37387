//! What puts recordings of coupons in doubt: slack at the start, the end of the load cell's range, a force that stays after
//! the break, figures that no film has.

use std::path::PathBuf;

use super::yield_points::{check_window, line};
use super::{CouponTest, Curve, CurveEnd, Modulus, Rupture};
use crate::error::{Error, refusal};
use crate::experiment::Warning;
use crate::signal::{flat_top, quantum};
use base::number::significant;

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
    ///
    /// # Errors
    /// No window of strain, or no stretch that has enough samples that rise by more than they scatter.
    pub fn steepest(&self, [from, to]: [f64; 2]) -> Result<Modulus, Error> {
        check_window([from, to])?;
        let width = (to - from).clamp(0.0, self.range()[1] - self.range()[0]);
        let found = SHARES.into_iter().find_map(|share| self.steepest_over(share * width));
        found.ok_or_else(|| {
            refusal!(
                "no toe is compensated: no {FEWEST_STEEP} samples of the first rise within a strain of {} lie along a rising line",
                significant(width, 3)
            )
            .with_hint("give other strains by --window, or leave out --toe")
        })
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
        let steepest = self.steepest(window).ok()?;
        let strain = -steepest.intercept / steepest.slope;
        let [start, _] = self.range();
        let width = SHARES[0] * (window[1] - window[0]);
        let first = self.line_between([start, start + width]).map_or(modulus.slope, |(line, _)| line.slope);
        if first >= SLACK * steepest.slope {
            return None;
        }
        let whole = self.toe_compensated(steepest.slope, steepest.intercept).modulus(window).ok()?;
        let is_slack = whole.slope > (1.0 + CHANGES) * modulus.slope;
        is_slack.then_some(Slack { strain, modulus: whole.slope })
    }

    /// The largest stress (Pa), where samples in a row are exactly that which a curve that bends would not have so often.
    pub(super) fn saturated(&self) -> Option<f64> {
        let stress = self.stress();
        let [first, last] = flat_top(stress)?;
        let rise = stress[first] - stress[first.saturating_sub(last - first + 1)];
        (rise > RISES_BY_STEPS * quantum(stress)).then_some(stress[first])
    }

    /// Stress (Pa) that is left after the break and stays.
    pub(super) fn after_break(&self, rupture: &Rupture) -> Option<f64> {
        let broken = self.strain().partition_point(|strain| *strain <= rupture.strain);
        let after = &self.stress()[broken..];
        // The first half may belong to the fall.
        let left = &after[after.len() / 2..];
        if rupture.ending != CurveEnd::Broke || left.len() < FEWEST_LEFT {
            return None;
        }
        let mean = left.iter().sum::<f64>() / left.len() as f64;
        let apart = left.iter().map(|stress| (stress - mean).abs()).fold(0.0, f64::max);
        (mean.abs() > LEFT * rupture.strength && apart < 0.5 * mean.abs()).then_some(mean)
    }
}

/// Fewest samples after a break that count.
const FEWEST_LEFT: usize = 5;
/// Steps of the recorder by which stress rises over as many samples before a saturated run at least: the top of a smooth curve
/// stays within one step for so long that it rose by four over as long before.
const RISES_BY_STEPS: f64 = 8.0;
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

/// Thickness that films have, m.
pub const LIKELY_THICKNESS: [f64; 2] = [1e-6, 2e-3];

/// A figure of a coupon, SI.
type Figure = fn(&CouponTest) -> f64;

/// What films have of some figures of coupons, in SI units, with the unit that is shown and the factor to it.
const LIKELY: [(&str, Figure, [f64; 2], &str, f64); 3] = [
    ("thickness", |test| test.coupon.thickness(), LIKELY_THICKNESS, "mm", 1e3),
    ("Young's modulus", |test| test.sample.modulus.slope, [1e6, 1e11], "MPa", 1e-6),
    ("strength", |test| test.sample.rupture.strength, [1e5, 1e10], "MPa", 1e-6),
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
    let implausible = LIKELY.into_iter().filter_map(|(what, figure, [least, most], unit, factor)| {
        let is_likely = |value: &f64| (least..=most).contains(value);
        let (paths, found) = of(&|test| Some(figure(test)).filter(|value| !is_likely(value)))?;
        let found = found.iter().map(|value| factor * value).collect();
        Some(Warning::ImplausibleCoupon { paths, what, unit, found, likely: [factor * least, factor * most] })
    });
    [slack, saturated, left].into_iter().flatten().chain(implausible).collect()
}

#[cfg(test)]
mod tests {
    use super::super::{Coupon, Direction, Rules, Sample};
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

    #[test]
    fn every_doubt_names_its_recordings_and_a_figure_of_each() {
        let test = |path: &str, thickness: f64, sample: Sample| {
            let coupon = Coupon::new(GAUGE, 10e-3, thickness).unwrap();
            CouponTest { path: path.into(), sample, merged: 0, coupon, measured: None, specimen: None }
        };
        let sound = sample(&recorded(0.0, bilinear, 0.0, 0.0), false);
        let slack = Some(Slack { strain: 0.01, modulus: 160e6 });
        let doubtful = Sample { slack, saturated: Some(20e6), after_break: Some(2e6), ..sound.clone() };
        let thick = Sample { saturated: Some(0.2e6), ..sound };
        let found = doubts(&[test("a.csv", 50e-6, doubtful), test("b.csv", 5e-3, thick)]);
        let found: Vec<String> = found.iter().map(Warning::to_string).collect();
        for (found, [begins, ends]) in found.iter().zip([
            ["a.csv has slack at the start: the modulus is 150.0 MPa", "with --toe 160.0 MPa"],
            ["the force stays at its largest value, 10, 10 N", ": a.csv; b.csv"],
            ["1 N stay after the break", ": a.csv"],
            ["the thickness of b.csv is 5 mm", "films have 0.001 to 2 mm"],
        ]) {
            assert!(found.starts_with(begins) && found.ends_with(ends), "{found}");
        }
        assert_eq!(found.len(), 4, "{found:?}");
    }

    #[test]
    fn a_toe_without_a_rise_to_compensate_it_is_refused() {
        let few = Curve::new(vec![0.0, 0.02, 0.04, 0.06], vec![0.0, 1e6, 3e6, 4e6]).unwrap();
        let reduced =
            |toe_compensation| Sample::new(Direction::Md, 0.01, &few, &Rules { toe_compensation, ..Rules::default() });
        assert!(reduced(false).is_ok());
        assert!(reduced(true).unwrap_err().to_string().starts_with("no toe is compensated"));
    }
}
