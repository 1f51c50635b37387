//! `droptower tensile reduce`: from force over displacement to a material file.

use std::path::PathBuf;

use clap::Args;

use super::figures::Figures;
use super::{material, output};
use crate::cli::faults;
use crate::cli::scenarios::expanded;
use crate::cli::signal::input::{FileArgs, quantity};
use crate::cli::{Failure, Shared, print_figures};
use crate::diagnostic::Diagnostic;
use crate::experiment::coupon::{
    BREAK_SHARE, Coupon, CouponReader, CouponTest, Direction, Label, RecordingError, Reduction, Rules, WINDOW,
};
use crate::signal::file::ChannelSelection;
use crate::units::{Density, Length, Velocity};

#[derive(Debug, Args)]
pub struct ReduceArgs {
    /// Recordings of coupons, files or globs: channels `force` and `displacement`
    #[arg(required = true, value_name = "RECORDING")]
    pub recordings: Vec<String>,
    /// Length between the jaws: "5 mm"
    #[arg(long, value_parser = |text: &str| quantity(Length::DIMENSION, text))]
    pub gauge: f64,
    /// Width of the coupons: "10 mm"
    #[arg(long, value_parser = |text: &str| quantity(Length::DIMENSION, text))]
    pub width: f64,
    /// Thickness of the coupons: "12 um"
    #[arg(long, value_parser = |text: &str| quantity(Length::DIMENSION, text))]
    pub thickness: f64,
    /// The material file to write; the shear curve goes beside it
    #[arg(long, short, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// A shear curve for the material file, in place of one from D3: CSV with strain (shear angle, rad) and stress
    #[arg(long, value_name = "FILE", requires = "out")]
    pub shear: Option<PathBuf>,
    /// Density of the film, for the material file: "915 kg/m3"
    #[arg(long, value_parser = |text: &str| quantity(Density::DIMENSION, text))]
    pub density: Option<f64>,
    /// Direction of all coupons, before what files say: MD, TD, D3 or D4
    #[arg(long)]
    pub direction: Option<Direction>,
    /// Speed of the jaws apart, before what files say: "0.02 m/s"
    #[arg(long, value_parser = |text: &str| quantity(Velocity::DIMENSION, text))]
    pub velocity: Option<f64>,
    /// Strains between which the modulus is fitted
    #[arg(long, num_args = 2, value_names = ["FROM", "TO"], default_values_t = WINDOW)]
    pub window: Vec<f64>,
    /// Share of the largest force below which a coupon is broken
    #[arg(long, value_name = "SHARE", default_value_t = BREAK_SHARE)]
    pub break_share: f64,
    /// Count strain from where the elastic line meets zero stress (ASTM D882), not from the recording's zero
    #[arg(long)]
    pub toe: bool,
    /// Name of the channel of force
    #[arg(long, value_name = "NAME", default_value = "force")]
    pub force: String,
    /// Name of the channel of displacement
    #[arg(long, value_name = "NAME", default_value = "displacement")]
    pub displacement: String,
    #[command(flatten)]
    pub file: FileArgs,
}

/// What the recordings gave.
pub struct Reduced {
    pub coupon: Coupon,
    pub recorded: Vec<CouponTest>,
    pub reduction: Reduction,
}

pub fn run(args: &ReduceArgs, shared: &Shared) -> Result<(), Failure> {
    let reduced = reduced(args)?;
    let texts = material::texts(args, &reduced)?;
    output::write(&texts)?;
    let written: Vec<PathBuf> = texts.into_iter().map(|(path, _)| path).collect();
    let figures = Figures::of(&reduced, args.density.is_none(), &written);
    print_figures(shared, &figures, || figures.text())
}

fn reduced(args: &ReduceArgs) -> Result<Reduced, Vec<Diagnostic>> {
    let one = |error: String| vec![Diagnostic::new(error)];
    let coupon = Coupon::new(args.gauge, args.width, args.thickness).map_err(|error| one(error.to_string()))?;
    let reading = reading(args, coupon).map_err(|mistake| vec![mistake])?;
    let recorded = all(paths(&args.recordings)?.iter().map(|path| reading.read(path).map_err(|error| fault(&error))))?;
    let samples: Vec<_> = recorded.iter().map(|recorded| recorded.sample.clone()).collect();
    let reduction = Reduction::of(&samples, &reading.rules).map_err(|error| one(error.to_string()))?;
    Ok(Reduced { coupon, recorded, reduction })
}

fn reading(args: &ReduceArgs, coupon: Coupon) -> Result<CouponReader, Diagnostic> {
    let window = [args.window[0], args.window[1]];
    let rules = Rules { window, break_share: args.break_share, toe_compensation: args.toe };
    Ok(CouponReader {
        given: Label { direction: args.direction, velocity: args.velocity },
        force: args.force.clone(),
        displacement: args.displacement.clone(),
        table: args.file.options(ChannelSelection::All)?,
        ..CouponReader::new(coupon, rules)
    })
}

/// The files that paths and globs name, each once, in the order of the arguments.
fn paths(patterns: &[String]) -> Result<Vec<PathBuf>, Vec<Diagnostic>> {
    let mut paths = all(patterns.iter().map(|pattern| expanded(pattern)))?.concat();
    let mut seen = std::collections::HashSet::new();
    paths.retain(|path| seen.insert(path.clone()));
    Ok(paths)
}

/// All values, or all mistakes.
fn all<T>(results: impl Iterator<Item = Result<T, Diagnostic>>) -> Result<Vec<T>, Vec<Diagnostic>> {
    let (values, mistakes): (Vec<_>, Vec<_>) = results.partition(Result::is_ok);
    let mistakes: Vec<Diagnostic> = mistakes.into_iter().filter_map(Result::err).collect();
    if mistakes.is_empty() { Ok(values.into_iter().filter_map(Result::ok).collect()) } else { Err(mistakes) }
}

fn fault(error: &RecordingError) -> Diagnostic {
    match error {
        RecordingError::Read(error) => faults::recording(error),
        other => Diagnostic { hint: other.hint(), ..Diagnostic::new(other.to_string()) },
    }
}
