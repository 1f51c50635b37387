//! The arguments of `droptower signal drop`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use crate::argument::{quantity, quantity_with_error};
use crate::signal::input::{self, TableArgs};
use base::units::{Acceleration, Force, Length, Mass, Time, Velocity};

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
