//! The arguments of `droptower tensile` but `fit`, and the recordings of coupons, reduced.

use std::path::PathBuf;

use clap::Args;

use crate::argument::{number, quantity};
use crate::signal::input::FileArgs;
use base::units::{Density, Length, Velocity};
use lab::experiment::coupon::{BREAK_SHARE, Coupon, CouponTest, Direction, Reduction, ShearMethod, WINDOW};

/// The recordings of coupons, and how they are read.
#[derive(Debug, Args)]
pub(crate) struct CouponArgs {
    /// Recordings of coupons, files or globs: channels `force` and `displacement`, or exports of tensile machines
    #[arg(required = true, value_name = "RECORDING")]
    pub recordings: Vec<String>,
    /// Length between the jaws, "5 mm" [default: as the head of a machine's export states it]
    #[arg(long, allow_hyphen_values = true, value_parser = |text: &str| quantity(Length::DIMENSION, text))]
    pub gauge: Option<f64>,
    /// Width of the coupons, "10 mm" [default: likewise]
    #[arg(long, allow_hyphen_values = true, value_parser = |text: &str| quantity(Length::DIMENSION, text))]
    pub width: Option<f64>,
    /// Thickness of the coupons, "12 um" [default: likewise]
    #[arg(long, allow_hyphen_values = true, value_parser = |text: &str| quantity(Length::DIMENSION, text))]
    pub thickness: Option<f64>,
    /// Direction of all coupons, in place of what the files state: MD, TD, D3, D4 or an angle such as 15deg
    #[arg(long)]
    pub direction: Option<Direction>,
    /// Strains between which the modulus is fitted, whose line --toe takes
    #[arg(long, num_args = 2, value_names = ["FROM", "TO"], default_values_t = WINDOW, value_parser = number)]
    pub window: Vec<f64>,
    /// Share of the largest force below which a coupon is broken
    #[arg(long, value_name = "SHARE", default_value_t = BREAK_SHARE, value_parser = number)]
    pub break_share: f64,
    /// Count strain from where the elastic line meets zero stress (ASTM D882), not from the recording's zero
    #[arg(long)]
    pub toe: bool,
    /// Name of the channel of force; of an export also what machines call it
    #[arg(long, value_name = "NAME", default_value = "force")]
    pub force: String,
    /// Name of the channel of displacement; of an export also what machines call it
    #[arg(long, value_name = "NAME", default_value = "displacement")]
    pub displacement: String,
    #[command(flatten)]
    pub file: FileArgs,
}

#[derive(Debug, Args)]
pub(crate) struct ReduceArgs {
    #[command(flatten)]
    pub coupons: CouponArgs,
    /// Speed of the jaws apart, in place of what the files state: "0.02 m/s"
    #[arg(long, value_parser = |text: &str| quantity(Velocity::DIMENSION, text))]
    pub velocity: Option<f64>,
    /// The material file to write, FILE.toml; its shear curve goes beside it, as FILE-shear.csv
    #[arg(long, short, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// A shear curve for the material file, in place of one from D3: CSV with strain (shear angle, rad) and stress
    #[arg(long, value_name = "FILE", requires = "out")]
    pub shear: Option<PathBuf>,
    /// Begin the curves of MD and TD with the mean Young's modulus, up to the end of its window; else they begin with the
    /// slope to the first yield point
    #[arg(long, requires = "out")]
    pub elastic_corner: bool,
    /// How the shear curve follows from D3: "free" and "held" let the fibres stretch, in a strip that is long or short
    /// for its width; "rhombus" are equations 4 to 8 of the paper, whose fibres do not
    #[arg(long, value_name = "METHOD", default_value_t)]
    pub shear_by: ShearMethod,
    /// Density of the film, for the material file: "915 kg/m3"
    #[arg(long, value_parser = |text: &str| quantity(Density::DIMENSION, text))]
    pub density: Option<f64>,
}

/// What a test that stretches film in both directions is compared with, and where its curve goes.
#[derive(Debug, Args)]
pub(crate) struct CouplingArgs {
    /// The film whose coupling of MD and TD the tests show: a fabric, as a material, a scenario or the folder of a run
    #[arg(long, value_name = "FILE")]
    pub film: Option<PathBuf>,
    /// The face of a scenario with several, counted from 1
    #[arg(long, value_name = "N", requires = "film")]
    pub face: Option<usize>,
    /// The curve to write, FILE.csv, as `tensile fit` reads it; of one recording
    #[arg(long, short, value_name = "FILE")]
    pub out: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub(crate) struct WideArgs {
    #[command(flatten)]
    pub coupons: CouponArgs,
    #[command(flatten)]
    pub coupling: CouplingArgs,
}

#[derive(Debug, Args)]
pub(crate) struct BulgeArgs {
    /// Recordings of bulges, files or globs: pressure, and height of the top
    #[arg(required = true, value_name = "RECORDING")]
    pub recordings: Vec<String>,
    /// Radius within the clamp, "50 mm"
    #[arg(long, allow_hyphen_values = true, value_parser = |text: &str| quantity(Length::DIMENSION, text))]
    pub radius: f64,
    /// Thickness of the film before the test, "12 um"
    #[arg(long, allow_hyphen_values = true, value_parser = |text: &str| quantity(Length::DIMENSION, text))]
    pub thickness: f64,
    /// Name of the channel of pressure
    #[arg(long, value_name = "NAME", default_value = "pressure")]
    pub pressure: String,
    /// Name of the channel of the height of the top [default: `height`, `apex` or `deflection`]
    #[arg(long, value_name = "NAME")]
    pub height: Option<String>,
    #[command(flatten)]
    pub coupling: CouplingArgs,
    #[command(flatten)]
    pub file: FileArgs,
}

/// The reduced recordings.
pub(super) struct Reduced {
    /// Of the mean dimensions.
    pub coupon: Coupon,
    /// In the order of the arguments.
    pub tests: Vec<CouponTest>,
    pub reduction: Reduction,
}
