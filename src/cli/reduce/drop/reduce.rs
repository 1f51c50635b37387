//! One recording, read and reduced.

use std::fs;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use sha2::{Digest, Sha256};

use super::args::{DropArgs, Method};
use crate::faults;
use crate::signal::input;
use base::diagnostic::{Diagnostic, folder_of, shown_path};
use base::file as whole_file;
use base::finding::Finding;
use base::number::significant;
use lab::error::{Error, Kind};
use lab::experiment::Warning;
use lab::experiment::absorption::Body;
use lab::experiment::drop::{
    self, ChannelNames, Class, Correction, Drop, DropChannels, Landmarks, Reduction, Stated, Tower,
};
use lab::signal::file::{self, ChannelSelection, ReadOptions};
use report::DropTest;

/// How the arguments reduce a recording, checked before one is read.
pub(super) struct Reducer<'a> {
    args: &'a DropArgs,
    correction: Correction,
    options: ReadOptions,
}

/// What became of a recording.
pub(super) struct Reading {
    pub test: DropTest,
    /// Whether it is no text without a row of numbers.
    pub holds_numbers: bool,
}

impl Reducer<'_> {
    /// Checks what the arguments say about all recordings.
    pub(super) fn new(args: &DropArgs) -> Result<Reducer<'_>, Diagnostic> {
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
    pub(super) fn reduced(&self, path: &Path) -> Reading {
        let measurement = match file::read(path, &self.options) {
            Ok(measurement) => measurement,
            Err(error) => {
                let test = DropTest::unread(path, faults::recording(&error));
                return Reading { test, holds_numbers: *error.kind() != Kind::NoRows };
            }
        };
        let names = ChannelNames { acceleration: self.args.column.clone(), laser: self.args.laser.clone() };
        let test = match DropChannels::find(&measurement, &names) {
            Ok(sensed) => self.test(path, sensed),
            Err(error) => DropTest::unread(path, faults::content(path, &error)),
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
        let of_class = args.class.and_then(input::unusual_class).map(|warning| Finding::new(&warning));
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
        let stated = stated.map_err(|error| Diagnostic::new(format!("{}: {error}", shown_path(path))))?;
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
    Ok(args.table.over(ReadOptions { channels, units, unit, ..ReadOptions::default() }))
}

/// The folder of the channels beside the head of a test of ISO-MME.
const CHANNELS: &str = "Channel";

/// Bytes that are read at once: recordings are not held as a whole.
const BLOCK: usize = 1 << 16;

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
    let mut digest = Sha256::new();
    let mut block = vec![0; BLOCK];
    for file in files {
        let mut file = whole_file::open(&file).ok()?;
        loop {
            match file.read(&mut block).ok()? {
                0 => break,
                count => digest.update(&block[..count]),
            }
        }
    }
    Some(digest.finalize().iter().map(|byte| format!("{byte:02x}")).collect())
}

/// The files in a folder, in the order of their names.
fn files_in(folder: &Path) -> io::Result<Vec<PathBuf>> {
    let entries = fs::read_dir(folder)?.map(|entry| entry.map(|entry| entry.path()));
    let mut entries: Vec<PathBuf> = entries.collect::<io::Result<_>>()?;
    entries.retain(|entry| entry.is_file());
    entries.sort();
    Ok(entries)
}
