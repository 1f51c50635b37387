//! `droptower signal drop`: contact, speed, travel and energies of a drop test.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use serde::Serialize;

use super::input::{self, TableArgs};
use super::{output, remarks};
use crate::argument::quantity;
use crate::{Failure, Shared, faults, print_figures};
use base::diagnostic::{Diagnostic, shown_path};
use base::finding::Finding;
use base::number::significant;
use base::units::{Acceleration, Length, Mass, STANDARD_GRAVITY, Time, Velocity};
use lab::experiment::Warning;
use lab::experiment::absorption::Body;
use lab::experiment::contact::{ContactError, SpeedSource};
use lab::experiment::drop::{
    self, ChannelNames, Correction, Drop, DropChannels, DropChannelsError, DropError, Figures, Height, KnownContact,
    Reduction, Tower,
};
use lab::experiment::release::ReleaseError;
use lab::signal::file::{self, ChannelSelection, ReadOptions};
use lab::signal::{self, Annotations, QuantityError};
use membrane::engine::GuideFriction;

#[derive(Debug, Args)]
pub(crate) struct DropArgs {
    /// The recording; `droptower explain formats` lists what is read, from the rest before the release on
    pub path: PathBuf,
    /// Mass of the impactor, e.g. "10.72 kg"
    #[arg(long, value_parser = |text: &str| quantity(Mass::DIMENSION, text))]
    pub mass: f64,
    /// Height of fall, e.g. "1 m"
    #[arg(long, required_unless_present = "speed", value_parser = |text: &str| quantity(Length::DIMENSION, text))]
    pub height: Option<f64>,
    /// Impact speed that is known, e.g. "4.16 m/s", in place of height and laser
    #[arg(long, value_name = "SPEED", conflicts_with_all = ["height", "laser"],
          value_parser = |text: &str| quantity(Velocity::DIMENSION, text))]
    pub speed: Option<f64>,
    /// Time of first contact on the recording's clock where it is known too, e.g. "617.3 ms"
    #[arg(long, value_name = "TIME", requires = "speed", value_parser = |text: &str| quantity(Time::DIMENSION, text))]
    pub contact_time: Option<f64>,
    /// Bridge gaps of the acceleration that last no longer than this by straight lines, e.g. "5 ms"
    #[arg(long, value_name = "TIME", value_parser = |text: &str| quantity(Time::DIMENSION, text))]
    pub bridge: Option<f64>,
    /// Replace the acceleration between two times by a straight line, e.g. "212 ms..215 ms"; several times
    #[arg(long, value_name = "FROM..TO", value_parser = interval)]
    pub mask: Vec<[f64; 2]>,
    /// The channel of the accelerometer, where there are several
    #[arg(long, value_name = "NAME")]
    pub column: Option<String>,
    /// The channel of the laser, where there are several lengths: upward from the film's upper face
    #[arg(long, value_name = "NAME")]
    pub laser: Option<String>,
    /// Ignore the laser: speed and contact from the fall
    #[arg(long, conflicts_with = "laser")]
    pub without_laser: bool,
    #[command(flatten)]
    pub table: TableArgs,
    /// The accelerometer's unit where the file states none; g is standard gravity
    #[arg(long, value_name = "UNIT")]
    pub unit: Option<String>,
    /// Gravity
    #[arg(long, value_name = "ACCELERATION", default_value = "9.81 m/s2", value_parser = |text: &str| quantity(Acceleration::DIMENSION, text))]
    pub gravity: f64,
    /// Channel frequency class of the filtered acceleration (ISO 6487); 1000, unless the file states that it was
    /// filtered before
    #[arg(long, value_name = "CFC", value_parser = input::class)]
    pub class: Option<f64>,
    /// How the low frequencies that AC coupling removes are restored
    #[arg(long, value_enum, default_value_t = Method::Coupling)]
    pub correction: Method,
    /// Time constant of the accelerometer's coupling, in place of the one fitted to the fall, e.g. "150 ms"
    #[arg(long, value_name = "TIME", value_parser = |text: &str| quantity(Time::DIMENSION, text))]
    pub time_constant: Option<f64>,
    /// File for the reduced signals, from contact on
    #[arg(short, long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// Replace the file where it exists
    #[arg(long, requires = "out")]
    pub force: bool,
}

/// The corrections by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Method {
    /// The exact inverse of AC coupling
    Coupling,
    /// The release, mirrored and added after contact
    Ramp,
}

pub(super) fn run(args: &DropArgs, shared: &Shared) -> Result<(), Failure> {
    let reduced = reduced(args)?;
    let printed = Printed { figures: reduced.figures(), findings: reduced.findings() };
    let comments: Vec<String> = reduced.annotations.free_comments().cloned().collect();
    print_figures(shared, &printed, || {
        text(args, &reduced.drop, &printed.figures, &remarks::lines(&comments, &printed.findings))
    })
}

/// A reduced drop with what its file states.
struct Reduced {
    drop: Drop,
    annotations: Annotations,
    unusual_class: Option<signal::Warning>,
}

/// The object that `--json` prints.
#[derive(Serialize)]
struct Printed {
    #[serde(flatten)]
    figures: Figures,
    findings: Vec<Finding>,
}

impl Reduced {
    fn figures(&self) -> Figures {
        Figures { notes: self.notes(), ..self.drop.figures() }
    }

    fn notes(&self) -> Vec<String> {
        let of_drop = self.drop.warnings.iter().map(Warning::to_string);
        let of_class = self.unusual_class.iter().map(signal::Warning::to_string);
        self.annotations.notes().into_iter().chain(of_drop).chain(of_class).collect()
    }

    fn findings(&self) -> Vec<Finding> {
        let of_drop = self.drop.warnings.iter().map(Finding::new);
        let of_class = self.unusual_class.iter().map(Finding::new);
        self.annotations.findings().into_iter().chain(of_drop).chain(of_class).collect()
    }
}

/// The drop, its signals written where that was asked for.
fn reduced(args: &DropArgs) -> Result<Reduced, Failure> {
    let (tower, correction) = conditions(args)?;
    if let Some(out) = &args.out {
        output::check_table(out, &args.path, args.force)?;
    }
    let mut sensed = sensed(args)?;
    sensed.laser = sensed.laser.filter(|_| !args.without_laser && args.speed.is_none());
    let bridged = bridge(args, &mut sensed);
    let class = args.class.or_else(|| sensed.class_to_apply(Some(1000.0)));
    let contact = args.contact_time.zip(args.speed).map(|(time, speed)| KnownContact { time, speed });
    let drop = sensed.reduce(&tower, &Reduction { correction, class, contact });
    let mut drop = drop.map_err(|error| {
        let mistake = Diagnostic::new(format!("{}: {error}", shown_path(&args.path)));
        Diagnostic { hint: remedy(&error, &sensed), ..mistake }
    })?;
    drop.warnings.extend(bridged);
    let unusual_class = args.class.and_then(input::unusual_class);
    let reduced = Reduced { drop, annotations: sensed.annotations, unusual_class };
    if let Some(out) = &args.out {
        let origin =
            format!("reduced from {} by droptower signal drop; time from first contact", shown_path(&args.path));
        let comments: Vec<String> = std::iter::once(origin).chain(reduced.notes()).collect();
        output::write_csv(out, &comments, &reduced.drop.signals)?;
    }
    Ok(reduced)
}

fn conditions(args: &DropArgs) -> Result<(Tower, Correction), Diagnostic> {
    let correction = match (args.correction, args.time_constant) {
        (Method::Coupling, time_constant) => Correction::Coupling { time_constant },
        (Method::Ramp, None) => Correction::Ramp,
        (Method::Ramp, Some(_)) => {
            let message = "--time-constant belongs to the correction by coupling, not to the ramp";
            return Err(Diagnostic::new(message));
        }
    };
    let body = Body { mass: args.mass, gravity: args.gravity };
    let height = match (args.height, args.speed) {
        (Some(height), _) => Height::Known(height),
        (None, speed) => Height::of_speed(speed.unwrap_or(f64::NAN), args.gravity),
    };
    Ok((Tower { body, height }, correction))
}

/// Two times, s: `212 ms..215 ms`.
fn interval(text: &str) -> Result<[f64; 2], String> {
    let expected = || format!("expected two times such as \"212 ms..215 ms\", found \"{text}\"");
    let (from, to) = text.split_once("..").ok_or_else(expected)?;
    let [from, to] = [quantity(Time::DIMENSION, from)?, quantity(Time::DIMENSION, to)?];
    if from < to { Ok([from, to]) } else { Err(format!("{}; the second is the later one", expected())) }
}

/// Bridges the gaps of the acceleration that the user names or that are short enough.
fn bridge(args: &DropArgs, sensed: &mut DropChannels) -> Option<Warning> {
    if args.bridge.is_none() && args.mask.is_empty() {
        return None;
    }
    let bridged = drop::bridged(&sensed.acceleration, args.bridge.unwrap_or(0.0), &args.mask);
    sensed.acceleration = bridged.series;
    bridged.warning
}

/// A change by the user that helps with a recording that cannot be reduced.
fn remedy(error: &DropError, sensed: &DropChannels) -> Option<String> {
    const KNOWN: &str =
        "where speed and time of contact are known, give both: --speed \"4.16 m/s\" --contact-time \"0.617 s\"";
    match error {
        DropError::NotMeasured(_) => {
            let longest = significant(1e3 * drop::longest_gap(&sensed.acceleration)?, 6);
            Some(format!("straight lines replace its gaps up to {longest} ms with --bridge \"{longest} ms\""))
        }
        DropError::Release(ReleaseError::UpsideDown { .. }) => {
            Some("write the acceleration with the other sign into the table".into())
        }
        DropError::Release(
            ReleaseError::BeginsAfterContact { .. } | ReleaseError::NoRelease { .. } | ReleaseError::NoRest { .. },
        ) => Some("the recording must begin with the rest before the release".into()),
        DropError::Contact(ContactError::HeightNotCovered { .. } | ContactError::SpeedNotReached { .. }) => None,
        DropError::Contact(_) if sensed.laser.is_some() => {
            Some(format!("leave out the laser: --without-laser; {KNOWN}"))
        }
        DropError::Contact(_) => Some(KNOWN.into()),
        _ => None,
    }
}

fn sensed(args: &DropArgs) -> Result<DropChannels, Diagnostic> {
    let names = ChannelNames { acceleration: args.column.clone(), laser: args.laser.clone() };
    let unit = args.unit.as_deref().map(input::unit).transpose()?;
    let (units, unit) = match (&args.column, unit) {
        (Some(column), Some(unit)) => (vec![(column.clone(), unit)], None),
        (_, unit) => (Vec::new(), unit),
    };
    let channels = match (&args.column, &args.laser) {
        (Some(column), Some(laser)) => ChannelSelection::Named(vec![column.clone(), laser.clone()]),
        (Some(column), None) if args.without_laser => ChannelSelection::Named(vec![column.clone()]),
        _ => ChannelSelection::All,
    };
    let options = args.table.over(ReadOptions { channels, units, unit, ..ReadOptions::default() });
    let measurement = file::read(&args.path, &options).map_err(|error| faults::recording(&error))?;
    DropChannels::find(&measurement, &names).map_err(|error| mistake(args, &error))
}

fn mistake(args: &DropArgs, error: &DropChannelsError) -> Diagnostic {
    let mistake = Diagnostic::new(format!("{}: {error}", shown_path(&args.path)));
    match error {
        DropChannelsError::Quantity(error @ QuantityError::NoUnit { .. }) => faults::quantity(&args.path, error),
        DropChannelsError::Channel(error) => Diagnostic { hint: error.hint(), ..mistake },
        DropChannelsError::Several { dimension, .. } if *dimension == Length::DIMENSION => {
            mistake.hint("--laser NAME, or --without-laser")
        }
        DropChannelsError::Several { .. } => mistake.hint("--column NAME"),
        DropChannelsError::NoAcceleration { .. } => mistake.hint("--unit gives the unit of channels without one"),
        DropChannelsError::Quantity(_) => mistake,
    }
}

fn text(args: &DropArgs, drop: &Drop, figures: &Figures, remarks: &str) -> String {
    let bounds = drop.warnings.iter().find_map(|warning| match warning {
        Warning::Saturated { peak, deepest, .. } => Some([*peak, *deepest]),
        _ => None,
    });
    let withheld = "withheld (accelerometer at the end of its range)";
    let or_none = |value: Option<String>| value.unwrap_or_else(|| "none".into());
    let peak = figures.peak_acceleration_m_s2.zip(figures.time_of_peak_acceleration_s);
    let travel = figures.peak_displacement_m.zip(figures.time_of_peak_displacement_s);
    let from = match (figures.speed_from, figures.laser_residual_m) {
        (SpeedSource::Laser, Some(residual)) => format!("laser, residual {:.3} mm", 1e3 * residual),
        (SpeedSource::Laser, None) => "laser".into(),
        (SpeedSource::Fall, _) => "the known height".into(),
        (SpeedSource::Given | SpeedSource::Stated, _) => "the command line".into(),
    };
    let correction = match (figures.time_constant_s, figures.ramp_duration_s) {
        (Some(time_constant), _) => {
            let interval = interval_of(figures.time_constant_interval_s, 1e3, 1);
            format!("AC coupling, time constant {:.1} ms{interval}", 1e3 * time_constant)
        }
        (None, duration) => format!("gravity ramp of {}", or_none(duration.map(|d| format!("{:.1} ms", 1e3 * d)))),
    };
    let rows = [
        ("contact", format!("{:.5} s on the recording's clock", figures.contact_time_s)),
        (
            "impact speed",
            format!(
                "{:.3} m/s{} (ideal fall {:.3}), from {from}; {} iteration{}",
                figures.impact_velocity_m_s,
                interval_of(figures.impact_velocity_interval_m_s, 1.0, 3),
                figures.ideal_velocity_m_s,
                figures.iterations,
                if figures.iterations == 1 { "" } else { "s" },
            ),
        ),
        (
            "peak deceleration",
            match bounds {
                Some([at_least, _]) => {
                    format!("at least {:.2} g (accelerometer at the end of its range)", at_least / STANDARD_GRAVITY)
                }
                None => or_none(peak.map(|(a, t)| format!("{:.2} g at {:.1} ms", a / STANDARD_GRAVITY, 1e3 * t))),
            },
        ),
        (
            "displacement",
            match (travel, bounds) {
                (None, Some([_, deepest])) => {
                    format!("{:.1} mm at the lowest (accelerometer at the end of its range)", 1e3 * deepest)
                }
                (travel, _) => or_none(travel.map(|(d, t)| {
                    let interval = interval_of(figures.peak_displacement_interval_m, 1e3, 1);
                    format!("{:.1} mm{interval} at {:.1} ms", 1e3 * d, 1e3 * t)
                })),
            },
        ),
        ("energy", energy(figures, bounds.is_some())),
        (
            "energy absorbed",
            match (figures.energy_absorption, bounds) {
                (None, Some(_)) => withheld.into(),
                (absorbed, _) => or_none(absorbed.map(|d| {
                    let interval = interval_of(figures.energy_absorption_interval, 100.0, 1);
                    format!("{:.1} %{interval}", 100.0 * d)
                })),
            },
        ),
        ("guide friction", or_none(figures.guide_friction.as_ref().map(|friction| guide(friction, figures)))),
        ("filtering", format!("changes the total energy by {:.4} % at most", 100.0 * figures.total_energy_drift)),
        ("correction", correction),
    ];
    let rows = rows.map(|(name, value)| format!("  {name:<18} {value}\n"));
    let out = args.out.as_ref().map(|out| format!("  {}\n", shown_path(out))).unwrap_or_default();
    format!("{}\n{}{remarks}{out}", shown_path(&args.path), rows.concat()).trim_end().to_owned()
}

/// An interval after its figure, times `factor`: ` [149.9 .. 150.5]`; nothing where there is none.
fn interval_of(interval: Option<[f64; 2]>, factor: f64, decimals: usize) -> String {
    let shown = |[low, high]: [f64; 2]| format!(" [{:.decimals$} .. {:.decimals$}]", low * factor, high * factor);
    interval.map_or_else(String::new, shown)
}

/// Friction of the guide, what it does to the absorption, and its line of a scenario.
fn guide(friction: &GuideFriction, figures: &Figures) -> String {
    let speed = figures.impact_velocity_m_s;
    let force = match friction.per_speed == 0.0 {
        true => format!("{:.1} N in the fall", friction.constant),
        false => format!("{:.1} N at the release, {:.1} N at contact", friction.constant, friction.force_at(speed)),
    };
    let film = figures.film_energy_absorption.map(|d| format!("; going on, the film absorbs {:.1} %", 100.0 * d));
    let per_speed =
        (friction.per_speed != 0.0).then(|| format!(", per_speed = \"{} N s/m\"", significant(friction.per_speed, 3)));
    format!(
        "{force}{}\n  {:<18} impactor.guide_friction = {{ constant = \"{} N\"{} }}",
        film.unwrap_or_default(),
        "",
        significant(friction.constant, 3),
        per_speed.unwrap_or_default(),
    )
}

/// Energies of impactor and film.
fn energy(figures: &Figures, is_clipped: bool) -> String {
    let joule = |energy: Option<f64>| energy.map_or_else(|| "none".into(), |energy| format!("{energy:.2} J"));
    let at_contact = joule(figures.impact_energy);
    match (figures.peak_absorbed_energy, figures.final_absorbed_energy) {
        (None, None) if is_clipped => format!("{at_contact} at contact; absorbed by the film: withheld"),
        (most, last) => {
            format!("{at_contact} at contact; absorbed by the film {} at most, {} at the end", joule(most), joule(last))
        }
    }
}
