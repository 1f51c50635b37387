//! The figures of reduced coupons, as text and as JSON.

use std::path::PathBuf;

use serde::Serialize;

use super::coupon::Reduced;
use crate::findings;
use base::diagnostic::shown_path;
use base::finding::Finding;
use base::number::significant;
use lab::experiment::Warning;
use lab::experiment::coupon::average::SampleStatistics;
use lab::experiment::coupon::{Coupon, CouponTest, CurveEnd, Direction, DirectionMeans, SpeedMeans};

/// Width over length of a coupon beyond which its jaws hold it back: a tenth of the stress of film as strongly coupled as
/// isotropic film (docs/methods.md, section 11).
const MOST_WIDTH: f64 = 0.5;

/// All figures; SI.
#[derive(Serialize)]
pub(super) struct Figures {
    recordings: usize,
    virtual_recordings: usize,
    /// Mean of MD and TD.
    #[serde(rename = "young_modulus_Pa")]
    young_modulus_pa: Option<f64>,
    directions: Vec<DirectionFigures>,
    /// Specimens of machines' exports.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    specimens: Vec<SpecimenFigures>,
    notes: Vec<String>,
    findings: Vec<Finding>,
    /// Files that were written.
    written: Vec<String>,
}

/// One specimen of a machine's export.
#[derive(Serialize)]
struct SpecimenFigures {
    file: String,
    specimen: String,
    direction: String,
    velocity_m_s: f64,
    gauge_m: f64,
    width_m: f64,
    thickness_m: f64,
    #[serde(rename = "young_modulus_Pa")]
    young_modulus_pa: f64,
    #[serde(rename = "strength_Pa")]
    strength_pa: f64,
    break_elongation: f64,
    /// The columns of force and displacement, as the file names them.
    columns: [String; 2],
    /// What the head states of it, as it is written there.
    stated: Vec<String>,
}

#[derive(Serialize)]
struct DirectionFigures {
    direction: String,
    #[serde(rename = "young_modulus_Pa")]
    young_modulus_pa: Statistics,
    #[serde(rename = "strength_Pa")]
    strength_pa: Statistics,
    break_elongation: Statistics,
    #[serde(rename = "break_stress_Pa")]
    break_stress_pa: Statistics,
    /// Strain and stress (Pa) of both; none where the mean curve has no two.
    yield_points: Option<[[f64; 2]; 2]>,
    speeds: Vec<SpeedFigures>,
}

#[derive(Serialize)]
struct SpeedFigures {
    velocity_m_s: f64,
    #[serde(rename = "young_moduli_Pa")]
    young_moduli_pa: Vec<f64>,
    #[serde(rename = "young_modulus_Pa")]
    young_modulus_pa: Statistics,
    #[serde(rename = "strength_Pa")]
    strength_pa: Statistics,
    break_elongation: Statistics,
}

/// Mean and spread of several figures.
#[derive(Clone, Copy, Serialize)]
pub(super) struct Statistics {
    pub(super) mean: f64,
    pub(super) deviation: f64,
    pub(super) count: usize,
}

impl From<SampleStatistics> for Statistics {
    fn from(SampleStatistics { mean, deviation, count }: SampleStatistics) -> Statistics {
        Statistics { mean, deviation, count }
    }
}

impl Figures {
    /// The figures of the `reduced` recordings, with their findings.
    pub(super) fn new(reduced: &Reduced, is_density_assumed: bool, written: &[PathBuf]) -> Figures {
        let mut warnings = warnings(reduced);
        warnings.extend((is_density_assumed && !written.is_empty()).then_some(Warning::DensityAssumed));
        warnings.extend((!written.is_empty()).then_some(Warning::NoAbsorption));
        // D4 is the other diagonal of D3, measured to compare them.
        let is_unused = |direction: &Direction| !direction.has_curve() && *direction != Direction::D4;
        let unused = reduced.reduction.directions.iter().map(|along| along.direction).filter(is_unused);
        let directions: Vec<Direction> = unused.collect();
        warnings.extend(
            (!written.is_empty() && !directions.is_empty()).then_some(Warning::DirectionsNotUsed { directions }),
        );
        Figures {
            recordings: reduced.reduction.recordings(),
            virtual_recordings: reduced.reduction.virtual_recordings(),
            young_modulus_pa: reduced.reduction.modulus,
            directions: reduced.reduction.directions.iter().map(along).collect(),
            specimens: reduced.tests.iter().filter_map(specimen).collect(),
            notes: warnings.iter().map(Warning::to_string).collect(),
            findings: warnings.iter().map(Finding::new).collect(),
            written: written.iter().map(|path| shown_path(path)).collect(),
        }
    }

    /// The figures as tables, in MPa and per cent.
    pub(super) fn text(&self) -> String {
        let virtual_ones = match self.virtual_recordings {
            0 => String::new(),
            count => format!(", {count} of them VIRTUAL"),
        };
        let mut text = format!("{} recordings{virtual_ones}\n", self.recordings);
        text.extend(self.specimens.iter().map(SpecimenFigures::text));
        text.extend(self.directions.iter().map(DirectionFigures::text));
        if let Some(modulus) = self.young_modulus_pa {
            text += &format!("MD and TD  E {:.1} MPa\n", modulus * 1e-6);
        }
        text += &findings::lines("", &self.findings);
        text.extend(self.written.iter().map(|file| format!("wrote {file}\n")));
        text
    }
}

impl SpecimenFigures {
    fn text(&self) -> String {
        let mm = |length: f64| significant(1e3 * length, 4);
        let [force, displacement] = &self.columns;
        let stated = match &self.stated[..] {
            [] => String::new(),
            stated => format!("    the file states {}\n", stated.join("; ")),
        };
        format!(
            "{}, {}: {} at {} m/s, {} x {} x {} mm, E {:.1} MPa, strength {:.1} MPa, break {:.1} %\n    `{force}` over `{displacement}`\n{stated}",
            self.file,
            self.specimen,
            self.direction,
            significant(self.velocity_m_s, 4),
            mm(self.gauge_m),
            mm(self.width_m),
            mm(self.thickness_m),
            self.young_modulus_pa * 1e-6,
            self.strength_pa * 1e-6,
            100.0 * self.break_elongation,
        )
    }
}

/// The figures of a specimen of an export.
fn specimen(test: &CouponTest) -> Option<SpecimenFigures> {
    let note = test.specimen.as_ref()?;
    let (sample, coupon) = (&test.sample, &test.coupon);
    Some(SpecimenFigures {
        file: shown_path(&test.path),
        specimen: note.name.clone(),
        direction: sample.direction.to_string(),
        velocity_m_s: sample.velocity,
        gauge_m: coupon.gauge(),
        width_m: coupon.width(),
        thickness_m: coupon.thickness(),
        young_modulus_pa: sample.modulus.slope,
        strength_pa: sample.rupture.strength,
        break_elongation: sample.rupture.strain,
        columns: note.columns.clone(),
        stated: note.stated.clone(),
    })
}

impl DirectionFigures {
    fn text(&self) -> String {
        let moduli = self.speeds.iter().map(|speed| {
            let single = speed.young_moduli_pa.iter().map(|modulus| format!("{:6.1}", modulus * 1e-6));
            let mean = speed.young_modulus_pa.text(1e-6, "MPa");
            format!("  {:>8} m/s  E{}  mean {mean}\n", significant(speed.velocity_m_s, 4), single.collect::<String>())
        });
        let points = match self.yield_points {
            Some(points) => points.map(|[strain, stress]| format!("{strain:.3}, {:.2} MPa", stress * 1e-6)).join("; "),
            None => "none".into(),
        };
        format!(
            "{}\n{}  E {}\n  yield points at {points}\n  strength {}, break elongation {}\n",
            self.direction,
            moduli.collect::<String>(),
            self.young_modulus_pa.text(1e-6, "MPa"),
            self.strength_pa.text(1e-6, "MPa"),
            self.break_elongation.text(100.0, "%"),
        )
    }
}

impl Statistics {
    fn text(&self, factor: f64, unit: &str) -> String {
        let (mean, deviation) = (self.mean * factor, self.deviation * factor);
        match self.count {
            1 => format!("{mean:.1} {unit} (1)"),
            count => format!("{mean:.1} +- {deviation:.1} {unit} ({count})"),
        }
    }
}

fn along(along: &DirectionMeans) -> DirectionFigures {
    DirectionFigures {
        direction: along.direction.to_string(),
        young_modulus_pa: along.modulus.into(),
        strength_pa: along.strength.into(),
        break_elongation: along.elongation.into(),
        break_stress_pa: along.break_stress.into(),
        yield_points: along.yields.as_ref().ok().map(|found| [found.first, found.second]),
        speeds: along.speeds.iter().map(speed).collect(),
    }
}

fn speed(speed: &SpeedMeans) -> SpeedFigures {
    SpeedFigures {
        velocity_m_s: speed.velocity,
        young_moduli_pa: speed.moduli.clone(),
        young_modulus_pa: speed.modulus.into(),
        strength_pa: speed.strength.into(),
        break_elongation: speed.elongation.into(),
    }
}

/// Warnings of assumptions, and of all that puts the figures in doubt.
fn warnings(reduced: &Reduced) -> Vec<Warning> {
    let tests = &reduced.tests;
    let under_load = tests.iter().filter(|test| test.sample.rupture.ending == CurveEnd::RecordEnded);
    let under_load = under_load.map(|test| Warning::RecordEndsUnderLoad { path: test.place() });
    let merged = tests.iter().filter(|test| test.merged > 0);
    let merged = merged.map(|test| Warning::MergedSamples { path: test.place(), samples: test.merged });
    let no_yield = reduced.reduction.directions.iter().filter_map(|along| {
        let reason = along.yields.as_ref().err()?.clone();
        Some(Warning::NoYieldPoints { direction: along.direction, reason })
    });
    let replaced = tests.iter().flat_map(|test| {
        let replaced = test.specimen.iter().flat_map(|specimen| &specimen.replaced);
        replaced.map(|what| Warning::HeadReplaced { path: test.place(), what: what.clone() })
    });
    let differ =
        [("gauge", Coupon::gauge as fn(&Coupon) -> f64), ("width", Coupon::width), ("thickness", Coupon::thickness)];
    let differ = differ.into_iter().filter_map(|(dimension, of)| {
        let all = || tests.iter().map(|test| of(&test.coupon));
        let (least, most) = (all().fold(f64::INFINITY, f64::min), all().fold(0.0, f64::max));
        (least < most).then_some(Warning::SpecimensDiffer { dimension, least, most })
    });
    let is_along = |test: &&CouponTest| matches!(test.sample.direction, Direction::Md | Direction::Td);
    let ratios = tests.iter().filter(is_along).map(|test| test.coupon.width() / test.coupon.gauge());
    let ratio = ratios.fold(0.0, f64::max);
    let held = (ratio > MOST_WIDTH).then_some(Warning::CouponHeldInWidth { ratio });
    let doubts = under_load.chain(merged).chain(replaced).chain(differ).chain(held).chain(no_yield);
    doubts.chain(speeds_not_measured(reduced)).collect()
}

/// Speeds at which some directions were measured and others not.
fn speeds_not_measured(reduced: &Reduced) -> Vec<Warning> {
    let directions = &reduced.reduction.directions;
    let mut speeds: Vec<f64> = directions.iter().flat_map(|along| &along.speeds).map(|speed| speed.velocity).collect();
    speeds.sort_by(f64::total_cmp);
    speeds.dedup();
    let is_missing =
        |along: &DirectionMeans, velocity: f64| !along.speeds.iter().any(|speed| speed.velocity == velocity);
    let missing = directions.iter().flat_map(|along| {
        let missing = speeds.iter().filter(move |velocity| is_missing(along, **velocity));
        missing.map(|velocity| Warning::SpeedNotMeasured { direction: along.direction, velocity: *velocity })
    });
    missing.collect()
}
