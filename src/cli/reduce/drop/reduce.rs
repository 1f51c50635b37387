//! One recording of a drop: read, reduced, its figures in words.

use std::io;
use std::path::{Path, PathBuf};

use crate::reduce::drop::{DropArgs, Method};
use crate::{failure, signal};
use base::diagnostic::{Diagnostic, folder_of, shown_path};
use base::file::{entries, sha256};
use base::finding::Finding;
use base::number::significant;
use base::units::STANDARD_GRAVITY;
use lab::error::{Error, Kind};
use lab::experiment::Warning;
use lab::experiment::absorption::Body;
use lab::experiment::drop::{
    self, ChannelNames, Class, Correction, Drop, DropChannels, Figures, Input, Landmarks, Reduction, SpeedSource,
    Stated, Tower,
};
use lab::signal::file::{self, ChannelSelection, ReadOptions};
use membrane::engine::GuideFriction;
use report::DropTest;

/// How the arguments reduce a recording, checked before one is read.
pub(crate) struct Reducer<'a> {
    args: &'a DropArgs,
    correction: Correction,
    options: ReadOptions,
}

/// What became of a recording.
pub(crate) struct Reading {
    pub test: DropTest,
    /// Whether it is no text without a row of numbers.
    pub holds_numbers: bool,
}

impl Reducer<'_> {
    /// Checks what the arguments say about all recordings.
    pub(crate) fn new(args: &DropArgs) -> Result<Reducer<'_>, Diagnostic> {
        let correction = match (args.correction, args.time_constant) {
            (Method::Coupling, time_constant) => Correction::Coupling { time_constant },
            (Method::Ramp, None) => Correction::Ramp,
            (Method::Ramp, Some(_)) => {
                let message = "--time-constant belongs to the correction by coupling, not to the ramp";
                return Err(Diagnostic::new(message));
            }
        };
        Ok(Reducer { args, correction, options: read_options(args)? })
    }

    /// Reads and reduces the recording at `path`.
    pub(crate) fn reduced(&self, path: &Path) -> Reading {
        let measurement = match file::read(path, &self.options) {
            Ok(measurement) => measurement,
            Err(error) => {
                let test = DropTest::unread(path, failure::recording(&error));
                return Reading { test, holds_numbers: *error.kind() != Kind::NoRows };
            }
        };
        let DropArgs { column, laser, invert, .. } = self.args;
        let names = ChannelNames { acceleration: column.clone(), laser: laser.clone(), is_inverted: *invert };
        let test = match DropChannels::find(&measurement, &names) {
            Ok(sensed) => self.test(path, sensed),
            Err(error) => DropTest::unread(path, failure::content(path, &error)),
        };
        Reading { test, holds_numbers: true }
    }

    fn test(&self, path: &Path, mut sensed: DropChannels) -> DropTest {
        let args = self.args;
        sensed.laser = sensed.laser.filter(|_| !args.without_laser);
        let bridged = bridge(args, &mut sensed);
        let reduction = Reduction {
            correction: self.correction,
            class: args.class.map_or_else(|| sensed.class_to_apply(Class::OfRate), Class::Given),
            speed: args.speed,
            contact_time: args.contact_time,
            height_error: args.height.and_then(|(_, error)| error),
            guide_friction: args.guide_friction.map(|(force, error)| [force, error.unwrap_or(0.1 * force)]),
            ..Reduction::default()
        };
        let (tower, replaced) = match self.tower(path, &sensed) {
            Ok((tower, replaced)) => (Ok(tower), replaced),
            Err(mistake) => (Err(mistake), vec![]),
        };
        let mut landmarks = Landmarks::default();
        let outcome = tower.clone().and_then(|tower| {
            sensed.reduce(&tower, &reduction).map_err(|error| {
                landmarks = Landmarks::of_failed(&sensed.acceleration, tower.body.gravity, &error);
                let mistake = Diagnostic::new(format!("{}: {error}", shown_path(path)));
                Diagnostic { hint: remedy(&error, &sensed), ..mistake }
            })
        });
        let outcome = outcome.map(|drop: Drop| {
            landmarks = Landmarks::of_drop(&drop);
            let warnings = [drop.warnings.as_slice(), bridged.as_slice(), replaced.as_slice()].concat();
            Drop { warnings, ..drop }
        });
        let of_drop = outcome.iter().flat_map(|drop| &drop.warnings).map(Finding::new);
        let of_class = args.class.and_then(signal::unusual_class).map(|warning| Finding::new(&warning));
        let figures = outcome.as_ref().ok().map(Drop::figures);
        let findings = sensed.annotations.findings().into_iter().chain(of_drop).chain(of_class).collect();
        DropTest {
            path: path.to_owned(),
            fingerprint: fingerprint(path),
            tower: tower.ok(),
            channels: Some(sensed),
            landmarks,
            outcome,
            figures,
            findings,
        }
    }

    /// Mass and height, from the arguments or the header of the recording, and what replaces what the header states.
    fn tower(&self, path: &Path, sensed: &DropChannels) -> Result<(Tower, Vec<Warning>), Diagnostic> {
        let args = self.args;
        let given = Stated { mass: args.mass, height: args.height.map(|(height, _)| height) };
        let stated = Stated::of_header(sensed.annotations.comments(), given);
        let stated = stated.map_err(|error| failure::content(path, &error))?;
        let missing = |what: &str, hint: &str| {
            Diagnostic::new(format!("{}: {what} is not known", shown_path(path))).hint(hint.to_owned())
        };
        let mass = given.mass.or(stated.mass).ok_or_else(|| {
            missing("the mass of the impactor", "give --mass \"10.72 kg\", or write `# mass: 10.72 kg` into its header")
        })?;
        let height = given.height.or(stated.height);
        if height.is_none() && args.speed.is_none() && args.contact_time.is_none() {
            let hint = "give --height \"1 m\" or, where they are known, --speed \"4.16 m/s\" or --contact-time \"617 ms\"; or \
                        write `# height: 1 m` into its header";
            return Err(missing("the height of fall", hint));
        }
        let replaced =
            [replaced("mass", "kg", given.mass, stated.mass), replaced("height", "m", given.height, stated.height)];
        let replaced = replaced.into_iter().flatten();
        let replaced = replaced.map(|what| Warning::HeadReplaced { path: path.to_owned(), what }).collect();
        Ok((Tower { body: Body { mass, gravity: args.gravity }, height }, replaced))
    }
}

/// What an option gives in place of the header of a recording, where the two differ.
fn replaced(what: &str, unit: &str, given: Option<f64>, stated: Option<f64>) -> Option<String> {
    let (given, stated) = given.zip(stated).filter(|(given, stated)| (given - stated).abs() > 1e-9 * stated.abs())?;
    Some(format!("{what}: {} {unit} for {} {unit}", significant(given, 6), significant(stated, 6)))
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
fn remedy(error: &Error, sensed: &DropChannels) -> Option<String> {
    if *error.kind() != Kind::Gap {
        return error.hint().map(str::to_owned);
    }
    let longest = significant(1e3 * drop::longest_gap(&sensed.acceleration)?, 6);
    Some(format!("straight lines replace its gaps up to {longest} ms with --bridge \"{longest} ms\""))
}

fn read_options(args: &DropArgs) -> Result<ReadOptions, Diagnostic> {
    let unit = args.unit.as_deref().map(signal::unit).transpose()?;
    let (units, unit) = match (&args.column, unit) {
        (Some(column), Some(unit)) => (vec![(column.clone(), unit)], None),
        (_, unit) => (Vec::new(), unit),
    };
    let channels = match (&args.column, &args.laser) {
        (Some(column), Some(laser)) => ChannelSelection::Named(vec![column.clone(), laser.clone()]),
        (Some(column), None) if args.without_laser => ChannelSelection::Named(vec![column.clone()]),
        _ => ChannelSelection::All,
    };
    Ok(args.table.over(ReadOptions { channels, units, unit, ..ReadOptions::default() }))
}

/// The folder of the channels beside the head of a test of ISO-MME.
const CHANNELS: &str = "Channel";

/// SHA-256 of a recording; of a test of ISO-MME that is no archive, of its head and its channels, one after the other. None
/// where it cannot be read.
fn fingerprint(path: &Path) -> Option<String> {
    let is_head = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("mme"));
    let files = match path.is_dir() {
        true => [files_in(path).ok()?, files_in(&path.join(CHANNELS)).unwrap_or_default()].concat(),
        false if is_head => {
            [vec![path.to_owned()], files_in(&folder_of(path).join(CHANNELS)).unwrap_or_default()].concat()
        }
        false => vec![path.to_owned()],
    };
    sha256(&files).ok()
}

/// The files in a folder, in the order of their names.
fn files_in(folder: &Path) -> io::Result<Vec<PathBuf>> {
    Ok(entries(folder)?.into_iter().filter(|entry| entry.is_file()).collect())
}

/// Words and value of each figure: one list, which reads in the order in which it is printed.
pub(crate) fn figure_rows(tower: &Tower, drop: &Drop, figures: &Figures) -> Vec<(&'static str, String)> {
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
        (SpeedSource::Fall, _) => "fall and onset of the force".into(),
        (SpeedSource::Given, _) => "what was given".into(),
    };
    let correction = match (drop.time_constant, figures.ramp_duration_s) {
        (Some(time_constant), _) => coupling(time_constant, figures.time_constant_interval_s),
        (None, duration) => format!("gravity ramp of {}", or_none(duration.map(|d| format!("{:.1} ms", 1e3 * d)))),
    };
    let rebound = figures.rebound_velocity_m_s.zip(figures.time_of_rebound_s).map(|(speed, time)| {
        let interval = interval_of(figures.rebound_velocity_interval_m_s, 1.0, 3);
        format!("{speed:.3} m/s{interval} at {:.1} ms", 1e3 * time)
    });
    let mut rows = vec![
        ("tower", conditions(tower)),
        ("release", format!("{:.5} s on the recording's clock", figures.release_time_s)),
        (
            "contact",
            format!(
                "{:.5} s{} on the recording's clock",
                figures.contact_time_s,
                interval_of(figures.contact_time_interval_s, 1.0, 5)
            ),
        ),
        (
            "impact speed",
            format!(
                "{:.3} m/s{} (ideal fall {:.3}), from {from}",
                figures.impact_velocity_m_s,
                interval_of(figures.impact_velocity_interval_m_s, 1.0, 3),
                figures.ideal_velocity_m_s,
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
                (None, Some([_, deepest])) if deepest.is_finite() => {
                    format!("at most {:.1} mm down (accelerometer at the end of its range)", -1e3 * deepest)
                }
                (None, Some(_)) => withheld.into(),
                (travel, _) => or_none(travel.map(|(d, t)| {
                    let interval = interval_of(figures.peak_displacement_interval_m, 1e3, 1);
                    format!("{:.1} mm{interval} at {:.1} ms", 1e3 * d, 1e3 * t)
                })),
            },
        ),
        ("largest upward speed", or_none(rebound)),
        ("energy", energy(figures, bounds.is_some())),
        (
            "loading energy absorbed",
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
    if let Some((input, share)) = figures.widest_input.zip(figures.widest_share) {
        rows.push(("intervals", "95 % by noise, zero, coupling, friction, height, release and onset".into()));
        rows.push(("widest by", widest(input, share)));
    }
    rows
}

/// Mass and height.
fn conditions(tower: &Tower) -> String {
    let mass = significant(tower.body.mass, 6);
    match tower.height {
        Some(height) => format!("{mass} kg from {} m", significant(height, 6)),
        None => format!("{mass} kg, height unknown"),
    }
}

/// The coupling of the sensor.
fn coupling(time_constant: f64, interval: Option<[Option<f64>; 2]>) -> String {
    match (time_constant.is_finite(), interval) {
        (true, Some([Some(low), Some(high)])) => {
            let interval = interval_of(Some([low, high]), 1e3, 1);
            format!("AC coupling, time constant {:.1} ms{interval}", 1e3 * time_constant)
        }
        (true, _) => format!("AC coupling, time constant {:.1} ms", 1e3 * time_constant),
        (false, Some([Some(low), _])) => format!("DC-coupled, or a time constant above {} s", significant(low, 2)),
        (false, _) => "DC-coupled".into(),
    }
}

/// The input that widens the interval of the travel most, and what narrows it.
fn widest(input: Input, share: f64) -> String {
    let (what, narrower) = match input {
        Input::Offset => ("zero of the sensor", "a longer rest before the release, or a laser"),
        Input::Coupling => ("coupling of the sensor", "--time-constant from its data sheet, or a laser"),
        Input::Friction => ("friction of the guide", "--guide-friction, or a laser"),
        Input::Height => ("height of fall", "--height with a smaller error, or a laser"),
        Input::Release => ("time of the release", "a faster release, or a laser"),
        Input::Onset => ("onset of the force", "a laser, or less noise"),
        Input::Laser => ("zero of the laser", "a laser that is zeroed on the film"),
    };
    format!("{what}, {:.0} % of the travel's; narrower with {narrower}", 100.0 * share)
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
        "{force}{}\n  {:<23} impactor.guide_friction = {{ constant = \"{} N\"{} }}",
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
