//! What the reduction of drops and coupons reports, by code.

use std::path::PathBuf;

use serde_json::{Map, Value};
use thiserror::Error;

use super::absorption::AbsorptionError;
use super::contact::FallCondition;
use super::coupon::{Direction, YieldError};
use crate::signal::FILTERED_BEFORE;
use base::codes;
use base::diagnostic::shown_path;
use base::finding::{Code, Report};
use base::number::significant;

codes! {
    NO_LASER = "no-laser", Note,
        "contact and impact speed come from the fall and the onset of the force, since there is no laser",
        "nothing, if the height of fall, or the impact speed, is well known";
    LASER_OUT_OF_RANGE = "laser-out-of-range", Note,
        "the laser repeats one value over a moving impactor; these samples count as not measured",
        "nothing, if the laser holds its last value out of range; or else check its wiring";
    LASER_MISMATCH = "laser-mismatch", Warning,
        "the motion integrated from the acceleration does not follow the laser",
        "check the unit of the laser, its zero, and what it writes out of range";
    NO_ENERGY_ABSORPTION = "no-energy-absorption", Note,
        "the energy absorption cannot be computed from this recording",
        "record until the impactor has left the film";
    IMPOSSIBLE_ABSORPTION = "impossible-energy-absorption", Warning,
        "the energy absorption lies outside 0 to 100 %, so speed or acceleration is wrong",
        "check the laser, the time constant and the zero of the accelerometer";
    FASTER_THAN_FREE_FALL = "faster-than-free-fall", Warning,
        "the impact speed exceeds that of a free fall over the drop height, which friction cannot explain",
        "check the drop height and the sensitivity of the sensors";
    SLOW_IMPACT = "slow-impact", Warning,
        "the impact speed is less than half of that of a free fall over the drop height",
        "check the guide, the drop height and the laser";
    DROP_HEIGHT_DIFFERS = "drop-height-differs", Warning,
        "the acceleration integrated from rest to contact covers another height than the stated one",
        "check the drop height; with a time constant that was given, check that";
    LASER_SPEED_DIFFERS = "laser-speed-differs", Warning,
        "the fall covers the stated height, but reaches another speed than the laser measured; the time constant of the \
         accelerometer is that of the fall alone",
        "check the scale of the laser, its unit and its place";
    GUIDE_FRICTION_CHANGES = "guide-friction-changes", Note,
        "the guide's friction changes during the fall, so that the fall alone gives another time constant of the \
         accelerometer than laser and height",
        "nothing, as long as there is a laser; without one give the time constant";
    ZERO_OFFSET_DOUBTFUL = "zero-offset-doubtful", Warning,
        "a fall over the stated height, or to the stated speed, needs a zero offset that the rest before it does not show",
        "check the height or the speed";
    ZERO_DRIFT = "zero-drift", Warning,
        "the reading of the accelerometer drifts while the impactor is at rest",
        "let the sensor warm up; integrated speed and displacement drift with it";
    LATE_PEAK = "late-peak", Warning,
        "the largest acceleration comes well after the lowest point, so it is not that of the impact",
        "shorten the recording to the impact";
    SATURATED = "saturated-accelerometer", Warning,
        "the accelerometer stays at its largest reading, which may be the end of its range; figures that rest on these \
         samples are withheld, peak and displacement are bounds",
        "use a larger range; contact and impact speed hold, since they precede the samples";
    GAP_BRIDGED = "gap-bridged", Warning,
        "gaps of the acceleration are bridged by straight lines, as was asked for",
        "record again where a gap lies in the impact, since the peak and all integrals after it depend on it";
    CONTACT_STATED = "contact-stated", Note,
        "contact and impact speed are those that were given; the recording does not determine them",
        "nothing, if both are well known";
    IMPACT_SPEED_DIFFERS = "impact-speed-differs", Warning,
        "the acceleration integrated from rest to the given contact reaches another speed than the given one",
        "check contact time and speed, or give the time constant of the accelerometer";
    NOT_FILTERED_AGAIN = "not-filtered-again", Note,
        "the acceleration passed a channel filter before it was recorded, as its file states, and the reduction does \
         not filter it again; where it does, that is `filtered-before`",
        "none is needed; its cut-off frequency is that of the stated class";
    RECORD_ENDS_UNDER_LOAD = "record-ends-under-load", Warning,
        "a coupon was still under load at the end of its recording, which counts as its break",
        "record until the coupon breaks; strength and elongation may be too small";
    MERGED_SAMPLES = "merged-samples", Note,
        "samples between which the displacement of the jaws did not increase were merged",
        "nothing, if they are few";
    NO_YIELD_POINTS = "no-yield-points", Note,
        "the mean curve of a direction has no double yield point, so the material takes the curve itself",
        "nothing, or choose another window for the modulus";
    SPEED_NOT_MEASURED = "speed-not-measured", Note,
        "a direction was not measured at a speed at which others were, so their means are over other speeds",
        "measure it, or leave out the speed for all directions";
    NO_ABSORPTION = "no-absorption", Note,
        "the material file states no energy absorption, since coupons pulled to their break do not show it; film of this \
         material returns all energy on unloading",
        "set `absorption` in the file from a drop test (`droptower signal drop` prints it)";
    DENSITY_ASSUMED = "density-assumed", Warning,
        "no density was given, so the material file states that of LLDPE",
        "give --density";
    POISSON_ASSUMED = "poisson-assumed", Warning,
        "no Poisson's ratio was given, so the material file states one that is assumed",
        "give --poisson";
    MATERIAL_INCOMPLETE = "material-incomplete", Warning,
        "the material file lacks keys that a material needs, since they were not given: a scenario cannot use it before they \
         are written",
        "give --density and --thickness, or write them into the file or into the scenario that names it";
}

/// What a reduction reports although it continues.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum Warning {
    /// No laser; the drop height is known.
    #[error("no laser: contact and speed from the fall over the known height and the onset of the force")]
    NoLaser,
    /// Neither laser nor drop height; the impact speed is known.
    #[error("no laser and no height: contact from the fall to the known speed and the onset of the force")]
    NoLaserNoHeight,
    /// Constant laser samples.
    #[error("laser: {samples} constant samples, {run} or more in a row, count as out of its range")]
    LaserOutOfRange {
        /// Number of constant samples.
        samples: usize,
        /// Fewest equal samples in a row that count.
        run: usize,
    },
    /// Laser and integrated acceleration disagree.
    #[error("laser and integrated acceleration are {:.2} mm apart", 1e3 * residual)]
    LaserMismatch {
        /// Root mean square distance, m.
        residual: f64,
    },
    /// The recording has no energy absorption.
    #[error("no energy absorption: {}", without_absorption(*reason))]
    NoEnergyAbsorption {
        /// Why.
        reason: AbsorptionError,
    },
    /// An energy absorption outside 0 to 1.
    #[error(
        "an energy absorption of {:.1} % is impossible: laser, time constant and zero of the sensor do not agree",
        100.0 * absorption
    )]
    ImpossibleAbsorption {
        /// As a share.
        absorption: f64,
    },
    /// A speed above that of a free fall.
    #[error(
        "the impact speed is {:.2} % above that of a free fall over {} m",
        100.0 * excess, significant(*height, 6)
    )]
    FasterThanFreeFall {
        /// Share of the free fall's speed.
        excess: f64,
        /// Drop height, m.
        height: f64,
    },
    /// A speed far below that of a free fall.
    #[error("the impact speed is {:.0} % of that of a free fall", 100.0 * share)]
    SlowImpact {
        /// Share of the free fall's speed.
        share: f64,
    },
    /// An integrated fall over another height.
    #[error(
        "integrated from rest the fall covers {covered:.2} m up to contact, not {} m",
        significant(*height, 6)
    )]
    DropHeightDiffers {
        /// Distance from rest to contact by integration, m.
        covered: f64,
        /// As stated, m.
        height: f64,
    },
    /// A laser that contradicts fall and height.
    #[error("integrated from rest the impactor reaches {reached:.3} m/s at contact, by the laser {laser:.3} m/s")]
    LaserSpeedDiffers {
        /// By integration, m/s.
        reached: f64,
        /// By the laser, m/s.
        laser: f64,
    },
    /// A fall whose friction is not constant.
    #[error(
        "the guide's friction changes from {:.1} N at the release to {:.1} N at contact; as a constant it would give a time constant of {:.1} ms in place of {:.1} ms",
        friction[0], friction[1], 1e3 * constant, 1e3 * time_constant
    )]
    GuideFrictionChanges {
        /// Of the accelerometer, by laser and height, s.
        time_constant: f64,
        /// The same by the fall with constant friction, s.
        constant: f64,
        /// At the release and at contact, N.
        friction: [f64; 2],
    },
    /// An offset that the rest does not show.
    #[error(
        "closing the fall moves the sensor's zero by {offset:.3} m/s², known from the rest to {error:.4} m/s²; check the {}",
        known.name()
    )]
    ZeroOffsetDoubtful {
        /// Change of the sensor's zero that closes the fall, m/s².
        offset: f64,
        /// Standard error of the mean at rest, m/s².
        error: f64,
        /// What the fall was closed with.
        known: FallCondition,
    },
    /// A drift at rest.
    #[error("the reading at rest drifts by {rate:.2} m/s² per second, {over_record:.2} m/s² over the record")]
    ZeroDrift {
        /// Slope of the reading at rest, m/s³.
        rate: f64,
        /// Drift from the first to the last sample at that slope, m/s².
        over_record: f64,
    },
    /// A peak after the rebound.
    #[error(
        "the largest acceleration, at {:.1} ms, is not that of the impact, whose lowest point is at {:.1} ms",
        1e3 * peak, 1e3 * lowest_point
    )]
    LatePeak {
        /// Time of the largest acceleration, s from contact.
        peak: f64,
        /// Time of the lowest point, s from contact.
        lowest_point: f64,
    },
    /// A constant largest reading.
    #[error(
        "the accelerometer reads {reading:.1} m/s² for {:.1} ms from {start:.4} s on, which may be the end of its range: figures that rest on it are withheld",
        1e3 * duration
    )]
    Saturated {
        /// The largest reading, m/s².
        reading: f64,
        /// First time of this reading on the recording's clock, s.
        start: f64,
        /// Time for which it stays, s.
        duration: f64,
        /// Largest filtered acceleration of the clipped signal, m/s²: the true one is not smaller.
        peak: f64,
        /// Smallest displacement of the clipped signal, m: the true one is not deeper.
        deepest: f64,
    },
    /// Gaps that were bridged.
    #[error(
        "acceleration: {}, {} ms after {} s",
        bridged(*count), significant(1e3 * duration, 6), significant(*after, 6)
    )]
    GapBridged {
        /// Number of gaps.
        count: usize,
        /// Time of the last sample before the longest, s.
        after: f64,
        /// Duration of the longest, s.
        duration: f64,
    },
    /// A contact that is known from elsewhere.
    #[error("contact and impact speed are as given, not determined from the recording")]
    ContactStated,
    /// A given speed that the integrated fall does not reach.
    #[error("integrated from rest the impactor reaches {reached:.3} m/s at contact, not {speed:.3} m/s")]
    ImpactSpeedDiffers {
        /// By integration, m/s.
        reached: f64,
        /// As given, m/s.
        speed: f64,
    },
    /// An acceleration that was filtered before.
    #[error(
        "the acceleration went through CFC {class} before, as its file states, and {}",
        again.map_or_else(|| "is not filtered again".into(), |class| format!("is filtered again with CFC {class}"))
    )]
    FilteredAlready {
        /// Channel frequency class that the file states.
        class: f64,
        /// Channel frequency class of the reduction, where it filters.
        again: Option<f64>,
    },
    /// A coupon that did not break.
    #[error("{}: the record ends under load; its end counts as the break", shown_path(path))]
    RecordEndsUnderLoad {
        /// The recording.
        path: PathBuf,
    },
    /// Samples without an increase of displacement.
    #[error("{}: {samples} samples are merged with others, since the displacement did not increase", shown_path(path))]
    MergedSamples {
        /// The recording.
        path: PathBuf,
        /// Number of samples.
        samples: usize,
    },
    /// A direction without a double yield point.
    #[error("{direction}: {reason}")]
    NoYieldPoints {
        /// Of the film.
        direction: Direction,
        /// Why.
        reason: YieldError,
    },
    /// A speed without coupons of a direction.
    #[error("{direction} was not measured at {} m/s", significant(*velocity, 6))]
    SpeedNotMeasured {
        /// Of the film.
        direction: Direction,
        /// Speed of the jaws, m/s.
        velocity: f64,
    },
    /// A material file without energy absorption.
    #[error(
        "the material file has no `absorption`: coupons pulled to their break do not show the energy absorbed on unloading, so a run returns all of it"
    )]
    NoAbsorption,
    /// A material file with an assumed density.
    #[error("the density in the material file is assumed (LLDPE)")]
    DensityAssumed,
    /// Poisson's ratio is assumed.
    #[error("Poisson's ratio in the material file is assumed: {}", significant(*poisson, 3))]
    PoissonAssumed {
        /// As assumed.
        poisson: f64,
    },
    /// Keys of the material file were not given.
    #[error("the material file lacks {keys}: not given")]
    MaterialIncomplete {
        /// The keys in words.
        keys: String,
    },
}

fn bridged(count: usize) -> String {
    match count {
        1 => "a gap is bridged by a straight line".into(),
        several => format!("{several} gaps are bridged by straight lines, the longest"),
    }
}

fn without_absorption(reason: AbsorptionError) -> String {
    match reason {
        AbsorptionError::NoUnloading => "the recording ends before the rebound".into(),
        AbsorptionError::NoLoading => reason.to_string(),
    }
}

impl Report for Warning {
    fn code(&self) -> &'static Code {
        match self {
            Warning::NoLaser | Warning::NoLaserNoHeight => &NO_LASER,
            Warning::LaserOutOfRange { .. } => &LASER_OUT_OF_RANGE,
            Warning::LaserMismatch { .. } => &LASER_MISMATCH,
            Warning::NoEnergyAbsorption { .. } => &NO_ENERGY_ABSORPTION,
            Warning::ImpossibleAbsorption { .. } => &IMPOSSIBLE_ABSORPTION,
            Warning::FasterThanFreeFall { .. } => &FASTER_THAN_FREE_FALL,
            Warning::SlowImpact { .. } => &SLOW_IMPACT,
            Warning::DropHeightDiffers { .. } => &DROP_HEIGHT_DIFFERS,
            Warning::LaserSpeedDiffers { .. } => &LASER_SPEED_DIFFERS,
            Warning::GuideFrictionChanges { .. } => &GUIDE_FRICTION_CHANGES,
            Warning::ZeroOffsetDoubtful { .. } => &ZERO_OFFSET_DOUBTFUL,
            Warning::ZeroDrift { .. } => &ZERO_DRIFT,
            Warning::LatePeak { .. } => &LATE_PEAK,
            Warning::Saturated { .. } => &SATURATED,
            Warning::GapBridged { .. } => &GAP_BRIDGED,
            Warning::ContactStated => &CONTACT_STATED,
            Warning::ImpactSpeedDiffers { .. } => &IMPACT_SPEED_DIFFERS,
            Warning::FilteredAlready { again: Some(_), .. } => &FILTERED_BEFORE,
            Warning::FilteredAlready { again: None, .. } => &NOT_FILTERED_AGAIN,
            Warning::RecordEndsUnderLoad { .. } => &RECORD_ENDS_UNDER_LOAD,
            Warning::MergedSamples { .. } => &MERGED_SAMPLES,
            Warning::NoYieldPoints { .. } => &NO_YIELD_POINTS,
            Warning::SpeedNotMeasured { .. } => &SPEED_NOT_MEASURED,
            Warning::NoAbsorption => &NO_ABSORPTION,
            Warning::DensityAssumed => &DENSITY_ASSUMED,
            Warning::PoissonAssumed { .. } => &POISSON_ASSUMED,
            Warning::MaterialIncomplete { .. } => &MATERIAL_INCOMPLETE,
        }
    }

    fn figures(&self) -> Map<String, Value> {
        let named =
            |figures: &[(&str, Value)]| figures.iter().map(|(name, v)| ((*name).to_owned(), v.clone())).collect();
        match self {
            Warning::LaserOutOfRange { samples, .. } => named(&[("samples", (*samples).into())]),
            Warning::LaserMismatch { residual } => named(&[("residual_m", (*residual).into())]),
            Warning::ImpossibleAbsorption { absorption } => named(&[("energy_absorption", (*absorption).into())]),
            Warning::FasterThanFreeFall { excess, height } => {
                named(&[("excess", (*excess).into()), ("height_m", (*height).into())])
            }
            Warning::SlowImpact { share } => named(&[("share", (*share).into())]),
            Warning::DropHeightDiffers { covered, height } => {
                named(&[("covered_m", (*covered).into()), ("height_m", (*height).into())])
            }
            Warning::LaserSpeedDiffers { reached, laser } => {
                named(&[("reached_m_s", (*reached).into()), ("laser_m_s", (*laser).into())])
            }
            Warning::GuideFrictionChanges { time_constant, constant, friction } => named(&[
                ("time_constant_s", (*time_constant).into()),
                ("time_constant_of_constant_friction_s", (*constant).into()),
                ("friction_at_release_N", friction[0].into()),
                ("friction_at_contact_N", friction[1].into()),
            ]),
            Warning::ZeroOffsetDoubtful { offset, error, .. } => {
                named(&[("offset_m_s2", (*offset).into()), ("standard_error_m_s2", (*error).into())])
            }
            Warning::ZeroDrift { rate, over_record } => {
                named(&[("rate_m_s3", (*rate).into()), ("over_record_m_s2", (*over_record).into())])
            }
            Warning::LatePeak { peak, lowest_point } => {
                named(&[("peak_s", (*peak).into()), ("lowest_point_s", (*lowest_point).into())])
            }
            Warning::Saturated { reading, start, duration, peak, deepest } => named(&[
                ("reading_m_s2", (*reading).into()),
                ("start_s", (*start).into()),
                ("duration_s", (*duration).into()),
                ("peak_acceleration_at_least_m_s2", (*peak).into()),
                ("peak_displacement_at_least_m", (*deepest).into()),
            ]),
            Warning::GapBridged { count, after, duration } => {
                named(&[("gaps", (*count).into()), ("after_s", (*after).into()), ("duration_s", (*duration).into())])
            }
            Warning::ImpactSpeedDiffers { reached, speed } => {
                named(&[("reached_m_s", (*reached).into()), ("speed_m_s", (*speed).into())])
            }
            Warning::FilteredAlready { class, .. } => named(&[("class", (*class).into())]),
            Warning::RecordEndsUnderLoad { path } => named(&[("file", shown_path(path).into())]),
            Warning::MergedSamples { path, samples } => {
                named(&[("file", shown_path(path).into()), ("samples", (*samples).into())])
            }
            Warning::NoYieldPoints { direction, .. } => named(&[("direction", direction.name().into())]),
            Warning::SpeedNotMeasured { direction, velocity } => {
                named(&[("direction", direction.name().into()), ("velocity_m_s", (*velocity).into())])
            }
            Warning::PoissonAssumed { poisson } => named(&[("poisson", (*poisson).into())]),
            Warning::MaterialIncomplete { keys } => named(&[("keys", keys.as_str().into())]),
            Warning::NoLaser
            | Warning::NoLaserNoHeight
            | Warning::NoEnergyAbsorption { .. }
            | Warning::ContactStated
            | Warning::NoAbsorption
            | Warning::DensityAssumed => Map::new(),
        }
    }
}
