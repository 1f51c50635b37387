//! The arguments of `droptower reduce drop`, and the recordings that they name.

use std::collections::HashSet;
use std::fs;
use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};

use crate::argument::{quantity, quantity_with_error};
use crate::scenarios::expanded;
use crate::signal::input::{self, TableArgs};
use base::diagnostic::{Diagnostic, shown_path};
use base::units::{Acceleration, Force, Length, Mass, Time, Velocity};
use lab::signal::folder::{self, FolderContents};

#[derive(Debug, Args)]
pub(crate) struct DropArgs {
    /// Recordings, globs or folders of them, each from the rest before the release on; `droptower explain formats` lists
    /// what is read. Several, and folders, give a table
    #[arg(required = true, value_name = "RECORDING")]
    pub recordings: Vec<PathBuf>,
    /// Mass of the impactor, e.g. "10.72 kg" [default: as a line `mass: …` of the file's header states it]
    #[arg(long, value_parser = |text: &str| quantity(Mass::DIMENSION, text))]
    pub mass: Option<f64>,
    /// Height of fall, with its standard deviation where it is known, e.g. "1 m" or "1 m +- 2 mm" [default: likewise,
    /// `height: …`; half a per cent of it]
    #[arg(long, value_parser = |text: &str| quantity_with_error(Length::DIMENSION, text))]
    pub height: Option<(f64, Option<f64>)>,
    /// Impact speed where it is known, e.g. "4.16 m/s", in place of the height or beside it
    #[arg(long, value_name = "SPEED", value_parser = |text: &str| quantity(Velocity::DIMENSION, text))]
    pub speed: Option<f64>,
    /// Time of first contact on the recording's clock where it is known, e.g. "617.3 ms"
    #[arg(long, value_name = "TIME", value_parser = |text: &str| quantity(Time::DIMENSION, text))]
    pub contact_time: Option<f64>,
    /// Friction of the guide where it was measured, with its standard deviation, e.g. "2 N +- 0.3 N"; without that, a
    /// tenth of it
    #[arg(long, value_name = "FORCE", value_parser = |text: &str| quantity_with_error(Force::DIMENSION, text))]
    pub guide_friction: Option<(f64, Option<f64>)>,
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
    /// Ignore the laser
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
    /// Channel frequency class of the filtered acceleration (ISO 6487); 1000 or the highest that the rate of the samples
    /// allows, unless the file states that it was filtered before
    #[arg(long, value_name = "CFC", value_parser = input::class)]
    pub class: Option<f64>,
    /// How the low frequencies that AC coupling removes are restored
    #[arg(long, value_enum, default_value_t = Method::Coupling)]
    pub correction: Method,
    /// Time constant of the accelerometer's coupling where it is known, e.g. "150 ms"
    #[arg(long, value_name = "TIME", value_parser = |text: &str| quantity(Time::DIMENSION, text))]
    pub time_constant: Option<f64>,
    /// Table to write, FILE.csv: of one recording its reduced signals from contact on, of several a row each
    #[arg(short, long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// Page to write, FILE.html, with plots, figures and findings; of a recording that cannot be reduced with what was
    /// found in it
    #[arg(long, value_name = "FILE")]
    pub page: Option<PathBuf>,
    /// Replace the table where it exists
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

/// Two times, s: `212 ms..215 ms`.
fn interval(text: &str) -> Result<[f64; 2], String> {
    let expected = || format!("expected two times such as \"212 ms..215 ms\", found \"{text}\"");
    let (from, to) = text.split_once("..").ok_or_else(expected)?;
    let [from, to] = [quantity(Time::DIMENSION, from)?, quantity(Time::DIMENSION, to)?];
    if from < to { Ok([from, to]) } else { Err(format!("{}; the second is the later one", expected())) }
}

/// The recordings of a call.
pub(super) struct Recordings {
    /// Each once, in the order of the arguments; whether a folder was searched for it.
    pub paths: Vec<(PathBuf, bool)>,
    /// Whether they are a list: several arguments, a glob or a folder of recordings.
    pub is_list: bool,
    /// What else is in the folders.
    pub left_out: Vec<String>,
}

impl Recordings {
    /// The recordings that files, globs and folders name, without the table that is written.
    pub(super) fn from_args(args: &DropArgs) -> Result<Recordings, Vec<Diagnostic>> {
        let mut found = Recordings { paths: vec![], is_list: args.recordings.len() > 1, left_out: vec![] };
        let mistakes: Vec<Diagnostic> =
            args.recordings.iter().filter_map(|argument| found.add(argument, args.out.as_deref()).err()).collect();
        let mut seen = HashSet::new();
        found.paths.retain(|(path, _)| seen.insert(fs::canonicalize(path).unwrap_or_else(|_| path.clone())));
        if mistakes.is_empty() { Ok(found) } else { Err(mistakes) }
    }

    fn add(&mut self, argument: &Path, out: Option<&Path>) -> Result<(), Diagnostic> {
        if argument.is_dir() {
            return self.add_folder(argument, out);
        }
        let paths = match argument.to_str() {
            Some(pattern) => expanded(pattern)?,
            None => vec![argument.to_owned()],
        };
        self.is_list |= paths != [argument.to_owned()];
        self.paths.extend(paths.into_iter().map(|path| (path, false)));
        Ok(())
    }

    fn add_folder(&mut self, place: &Path, out: Option<&Path>) -> Result<(), Diagnostic> {
        let contents = folder::contents(place);
        let FolderContents { recordings, others } =
            contents.map_err(|error| Diagnostic::new(format!("cannot list {}: {error}", shown_path(place))))?;
        if recordings == [place.to_owned()] {
            self.paths.push((place.to_owned(), false));
            return Ok(());
        }
        let out = out.and_then(|out| fs::canonicalize(out).ok());
        let is_own = |path: &PathBuf| out.is_some() && fs::canonicalize(path).ok() == out;
        let (own, recordings): (Vec<PathBuf>, Vec<PathBuf>) = recordings.into_iter().partition(is_own);
        if recordings.is_empty() {
            let message = format!("{} holds no recordings", shown_path(place));
            return Err(Diagnostic::new(message).hint("they are known by their endings: `droptower explain formats`"));
        }
        self.is_list = true;
        self.left_out.extend(others.iter().chain(&own).map(|path| shown_path(path)));
        self.paths.extend(recordings.into_iter().map(|path| (path, true)));
        Ok(())
    }
}
