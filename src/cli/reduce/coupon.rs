//! `droptower reduce coupon`: from force over displacement to a material file.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use clap::Args;

use super::coupon_figures::Figures;
use crate::argument::{number, quantity};
use crate::scenarios::expanded;
use crate::signal::input::FileArgs;
use crate::{Failure, Shared, faults, output, print_figures};
use base::diagnostic::{Diagnostic, shown_path};
use base::file::{self, FileError};
use base::units::{Density, Length, Velocity};
use lab::Error;
use lab::experiment::coupon::{
    BREAK_SHARE, Coupon, CouponReader, CouponTest, Dimensions, Direction, Label, Reduction, Rules, ShearMethod, WINDOW,
};
use lab::experiment::material_file::coupon::{CouponMaterial, GivenShear};
use lab::signal::file::ChannelSelection;
use scene::model;
use scene::scenario::Document;

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
pub(crate) struct ReduceCouponArgs {
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

/// The reduced recordings.
pub(super) struct Reduced {
    /// Of the mean dimensions.
    pub coupon: Coupon,
    /// In the order of the arguments.
    pub tests: Vec<CouponTest>,
    pub reduction: Reduction,
}

pub(super) fn run(args: &ReduceCouponArgs, shared: &Shared) -> Result<(), Failure> {
    let reduced = reduced(&args.coupons, args.velocity)?;
    let texts = texts(args, &reduced)?;
    output::write_sealed(&texts)?;
    let written: Vec<PathBuf> = texts.into_iter().map(|(path, _)| path).collect();
    let figures = Figures::new(&reduced, args.density.is_none(), &written);
    print_figures(shared, &figures, || figures.text())
}

/// The recordings that arguments name, reduced, with this speed in place of what they state.
pub(super) fn reduced(args: &CouponArgs, velocity: Option<f64>) -> Result<Reduced, Vec<Diagnostic>> {
    let one = |error: String| vec![Diagnostic::new(error)];
    check_dimensions(args).map_err(one)?;
    let reader = reader(args, velocity).map_err(|mistake| vec![mistake])?;
    let paths = paths(&args.recordings)?;
    let tests =
        all(paths.iter().map(|path| reader.read_all(path).map_err(|error| faults::recording(&error))))?.concat();
    let coupon = mean(&tests).map_err(|error| one(error.to_string()))?;
    let samples: Vec<_> = tests.iter().map(|test| test.sample.clone()).collect();
    let reduction = Reduction::from_samples(&samples, &reader.rules).map_err(|error| one(error.to_string()))?;
    Ok(Reduced { coupon, tests, reduction })
}

/// Refuses dimensions that no coupon has, before any file is read.
fn check_dimensions(args: &CouponArgs) -> Result<(), String> {
    // In place of those that a file states, any will do.
    let [gauge, width, thickness] = [args.gauge, args.width, args.thickness].map(|given| given.unwrap_or(1.0));
    Coupon::new(gauge, width, thickness).map(drop).map_err(|error| error.to_string())
}

/// The coupon of the mean dimensions.
fn mean(tests: &[CouponTest]) -> Result<Coupon, Error> {
    let mean = |dimension: fn(&Coupon) -> f64| {
        let first = tests.first().map_or(f64::NAN, |test| dimension(&test.coupon));
        // Equal dimensions are their own mean, to the last digit.
        let apart: f64 = tests.iter().map(|test| dimension(&test.coupon) - first).sum();
        first + apart / tests.len().max(1) as f64
    };
    Coupon::new(mean(Coupon::gauge), mean(Coupon::width), mean(Coupon::thickness))
}

fn reader(args: &CouponArgs, velocity: Option<f64>) -> Result<CouponReader, Diagnostic> {
    let window = [args.window[0], args.window[1]];
    let rules = Rules { window, break_share: args.break_share, toe_compensation: args.toe };
    Ok(CouponReader {
        given: Label { direction: args.direction, velocity },
        force: args.force.clone(),
        displacement: args.displacement.clone(),
        table: args.file.options(ChannelSelection::All)?,
        ..CouponReader::new(Dimensions { gauge: args.gauge, width: args.width, thickness: args.thickness }, rules)
    })
}

/// The files that paths and globs name, each once, in the order of the arguments.
pub(crate) fn paths(patterns: &[String]) -> Result<Vec<PathBuf>, Vec<Diagnostic>> {
    let mut paths = all(patterns.iter().map(|pattern| expanded(pattern)))?.concat();
    let mut seen = std::collections::HashSet::new();
    paths.retain(|path| seen.insert(path.clone()));
    Ok(paths)
}

/// All values, or all mistakes.
pub(crate) fn all<T>(results: impl Iterator<Item = Result<T, Diagnostic>>) -> Result<Vec<T>, Vec<Diagnostic>> {
    let (values, mistakes): (Vec<_>, Vec<_>) = results.partition(Result::is_ok);
    let mistakes: Vec<Diagnostic> = mistakes.into_iter().filter_map(Result::err).collect();
    if mistakes.is_empty() { Ok(values.into_iter().filter_map(Result::ok).collect()) } else { Err(mistakes) }
}

/// Largest shear curve that is read, bytes.
const MOST_BYTES: u64 = 1 << 20;

/// The files to write and their texts; none where no file is asked for.
fn texts(args: &ReduceCouponArgs, reduced: &Reduced) -> Result<Vec<(PathBuf, String)>, Failure> {
    let Some(path) = &args.out else {
        return Ok(Vec::new());
    };
    check_folder(path)?;
    let places = places(path)?;
    let given = args.shear.as_deref().map(|file| given(file, &places)).transpose()?;
    let [material, shear] = places;
    let source = args.shear.as_deref().map(shown_path).unwrap_or_default();
    let shear_file = shear.file_name().unwrap_or_default().to_string_lossy();
    let written = CouponMaterial {
        reduction: &reduced.reduction,
        coupon: reduced.coupon,
        density: args.density,
        shear_file: &shear_file,
        elastic_corner: args.elastic_corner.then(|| args.coupons.window[1]),
        shear_by: args.shear_by,
        shear: given.as_deref().map(|text| GivenShear { source: &source, text }),
    };
    let texts = written.texts().map_err(|error| fault(&error))?;
    check(&written, args.shear.as_deref())?;
    Ok(vec![(shear, texts.shear), (material, texts.material)])
}

fn fault(error: &Error) -> Diagnostic {
    let mistake = Diagnostic::new(format!("no material: {error}"));
    Diagnostic { hint: error.hint().map(str::to_owned), ..mistake }
}

fn check_folder(material: &Path) -> Result<(), Diagnostic> {
    match material.parent().filter(|folder| !folder.as_os_str().is_empty()) {
        Some(folder) if !folder.is_dir() => {
            let message =
                format!("{} cannot be written: there is no folder {}", shown_path(material), shown_path(folder));
            Err(Diagnostic::new(message).hint("create it first"))
        }
        _ => Ok(()),
    }
}

/// The text of a shear curve, which must not be one of the files to be written.
fn given(shear: &Path, places: &[PathBuf]) -> Result<String, Diagnostic> {
    let canonical = |path: &Path| fs::canonicalize(path).ok();
    let is_written = places.iter().any(|place| canonical(place).is_some_and(|place| canonical(shear) == Some(place)));
    if is_written {
        let message = format!("{} is the shear curve and would be replaced", shown_path(shear));
        return Err(Diagnostic::new(message).hint("give the material another name"));
    }
    file::read_text(shear, MOST_BYTES).map_err(|error| {
        let why = match error {
            FileError::TooLarge { .. } => {
                format!("it is larger than {} MB, the most of a shear curve", MOST_BYTES >> 20)
            }
            other => other.to_string(),
        };
        Diagnostic::new(format!("cannot read {}: {why}", shown_path(shear)))
    })
}

/// Refuses a material that `droptower check` would refuse, with the place of a mistake in the `given` shear curve.
fn check(written: &CouponMaterial<'_>, given: Option<&Path>) -> Result<(), Vec<Diagnostic>> {
    let scratch = scratch(written, given).map_err(|error| vec![Diagnostic::new(format!("no material: {error}"))])?;
    let document = Document::read_material(&scratch.path().join(DRAFT))?;
    model::check_material(&document).map(|_| ())
}

const DRAFT: &str = "material.toml";

/// A folder of its own with the material, which reads the `given` shear curve where that lies.
fn scratch(written: &CouponMaterial<'_>, given: Option<&Path>) -> io::Result<tempfile::TempDir> {
    let scratch = tempfile::tempdir()?;
    let shear = match given {
        Some(file) => fs::canonicalize(file)?,
        None => scratch.path().join("shear.csv"),
    };
    let shear_file = shear.to_string_lossy();
    let draft = CouponMaterial { shear_file: &shear_file, ..written.clone() }.texts().map_err(io::Error::other)?;
    if given.is_none() {
        fs::write(&shear, draft.shear)?;
    }
    fs::write(scratch.path().join(DRAFT), draft.material)?;
    Ok(scratch)
}

/// The paths of the material and its shear curve: `film.toml` and `film-shear.csv`.
fn places(material: &Path) -> Result<[PathBuf; 2], Failure> {
    if !output::ends_in(material, "toml") {
        return Err(
            Diagnostic::new(format!("a material file ends in .toml, and {} does not", shown_path(material))).into()
        );
    }
    let stem = material.file_stem().unwrap_or_default().to_string_lossy();
    let shear = material.with_file_name(format!("{stem}-shear.csv"));
    let check = |place: &Path, ending| output::check(place, ending, None, None);
    let checked = [check(material, "toml"), check(&shear, "csv")];
    if let Some(failure) = Failure::all(checked.into_iter().filter_map(Result::err)) {
        return Err(failure);
    }
    Ok([material.to_path_buf(), shear])
}
