//! `droptower reduce coupon`: from force over displacement to figures and a material file.

use std::fs;
use std::path::{Path, PathBuf};

use clap::Args;
use serde_json::{Value as Json, json};

use crate::args::{number, quantity};
use crate::failure::{all, hinted};
use crate::scenarios::paths;
use crate::signal::FileArgs;
use crate::{Failure, Shared, check, failure, output, print_results};
use base::diagnostic::{Diagnostic, file_name, shown_path};
use base::file::{self, FileError};
use base::finding::Finding;
use base::number::significant;
use base::units::{Density, Length, Velocity};
use lab::Error;
use lab::error::Kind;
use lab::experiment::Warning;
use lab::experiment::coupon;
use lab::experiment::coupon::average::SampleStatistics;
use lab::experiment::coupon::{
    BREAK_SHARE, Coupon, CouponReader, CouponTest, CurveEnd, Dimensions, Direction, DirectionMeans, Label, Reduction,
    Rules, ShearMethod, SpeedMeans, WINDOW, join_speeds,
};
use lab::experiment::material_file::coupon::{CouponMaterial, GivenShear};
use lab::signal::file::ChannelSelection;

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
    /// Strains between which the modulus is fitted
    #[arg(long, num_args = 2, value_names = ["FROM", "TO"], default_values_t = WINDOW, value_parser = number)]
    pub window: Vec<f64>,
    /// Share of the largest force below which a coupon is broken
    #[arg(long, value_name = "SHARE", default_value_t = BREAK_SHARE, value_parser = number)]
    pub break_share: f64,
    /// Count strain from where the line of the steepest part meets zero stress (ISO 527-1, ASTM D882), not from the recording's
    /// zero: removes slack
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
pub(crate) struct Reduced {
    /// Of the mean dimensions.
    pub coupon: Coupon,
    /// In the order of the arguments.
    pub tests: Vec<CouponTest>,
    pub reduction: Reduction,
}

pub(crate) fn run(args: &ReduceCouponArgs, shared: &Shared) -> Result<(), Failure> {
    let reduced = reduced(&args.coupons, args.velocity)?;
    let target = args.out.as_deref().map(|path| Target::new(path, args.shear.as_deref())).transpose()?;
    // The figures stand without the material, too.
    let outcome = target.map_or_else(|| Ok(Default::default()), |target| written(args, &reduced, &target));
    let (paths, doubt) = outcome.as_ref().map_or_else(|_| Default::default(), Clone::clone);
    let mut warnings = findings(&reduced, args.density.is_none(), !paths.is_empty());
    warnings.extend(doubt);
    let findings: Vec<Finding> = warnings.iter().map(Finding::new).collect();
    print_results(shared, figures(&reduced, &warnings), &findings, &paths, || text(&reduced))?;
    outcome.map(drop)
}

/// Writes the material: the names of its files, and the doubt about it.
fn written(
    args: &ReduceCouponArgs,
    reduced: &Reduced,
    target: &Target,
) -> Result<(Vec<String>, Option<Warning>), Failure> {
    let (texts, doubt) = texts(args, reduced, target)?;
    output::write_sealed(&texts)?;
    Ok((texts.iter().map(|(path, _)| shown_path(path)).collect(), doubt))
}

/// The recordings that arguments name, reduced, with this speed in place of what they state.
pub(crate) fn reduced(args: &CouponArgs, velocity: Option<f64>) -> Result<Reduced, Failure> {
    check_dimensions(args).map_err(Diagnostic::new)?;
    let reader = reader(args, velocity)?;
    let paths = paths(&args.recordings)?;
    let (mut tests, mut refused, mut unlabelled) = (Vec::new(), Vec::new(), Vec::new());
    for path in &paths {
        match reader.read_all(path) {
            Ok(read) => tests.extend(read),
            Err(error) if *error.kind() == Kind::NoLabel => unlabelled.push((path, error)),
            Err(error) => refused.push(failure::recording(&error)),
        }
    }
    // What none of many files states is asked for once.
    let mut asked = unlabelled.iter().map(|(_, error)| error.message()).collect::<Vec<_>>();
    asked.sort_unstable();
    asked.dedup();
    refused.extend(asked.into_iter().map(|message| {
        let those = unlabelled.iter().filter(|(_, error)| error.message() == message);
        let files: Vec<String> = those.clone().map(|(path, _)| shown_path(path)).collect();
        failure::hinted(
            &format!("{}: {message}", files.join(", ")),
            those.map(|(_, error)| error.hint()).next().flatten(),
        )
    }));
    failure::refuse(refused)?;
    join_speeds(&mut tests);
    let coupon = mean(&tests).map_err(|error| failure::recording(&error))?;
    let samples: Vec<_> = tests.iter().map(|test| test.sample.clone()).collect();
    let reduction = Reduction::from_samples(&samples, &reader.rules).map_err(|error| failure::recording(&error))?;
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

/// Largest shear curve that is read, bytes.
const MOST_BYTES: u64 = 1 << 20;

/// Where a material goes, and the text of the shear curve that is given for it.
struct Target {
    /// The material and its shear curve.
    places: [PathBuf; 2],
    given: Option<String>,
}

impl Target {
    /// Refuses files that cannot be written or read.
    fn new(path: &Path, shear: Option<&Path>) -> Result<Target, Failure> {
        check_folder(path)?;
        let places = places(path)?;
        let given = shear.map(|file| given(file, &places)).transpose()?;
        Ok(Target { places, given })
    }
}

/// Files to write and their texts, with the doubt about them.
type Written = (Vec<(PathBuf, String)>, Option<Warning>);

/// The files of a material.
fn texts(args: &ReduceCouponArgs, reduced: &Reduced, Target { places, given }: &Target) -> Result<Written, Failure> {
    let [material, shear] = places.clone();
    let source = args.shear.as_deref().map(shown_path).unwrap_or_default();
    let shear_file = file_name(&shear);
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
    Ok((vec![(shear, texts.shear), (material, texts.material)], texts.doubt))
}

fn fault(error: &Error) -> Diagnostic {
    hinted(&format!("no material: {error}"), error.hint())
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
fn check(written: &CouponMaterial<'_>, given: Option<&Path>) -> Result<(), Failure> {
    // A given curve is read where it lies.
    let shear = given.map_or_else(|| Ok(PathBuf::from("shear.csv")), fs::canonicalize);
    let shear = shear.map_err(|error| Diagnostic::new(format!("no material: {error}")))?;
    let draft = CouponMaterial { shear_file: &shear.to_string_lossy(), ..written.clone() }.texts();
    let draft = draft.map_err(|error| fault(&error))?;
    check::material_texts(&[("material.toml", draft.material.as_str()), ("shear.csv", draft.shear.as_str())])
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
    all([check(material, "toml"), check(&shear, "csv")])?;
    Ok([material.to_path_buf(), shear])
}

/// Width over length of a coupon beyond which its jaws hold it back: a tenth of the stress of film as strongly coupled as
/// isotropic film (docs/methods.md, section 11).
const MOST_WIDTH: f64 = 0.5;

/// All findings, of what was written too.
fn findings(reduced: &Reduced, is_density_assumed: bool, is_written: bool) -> Vec<Warning> {
    // D4 is the other diagonal of D3, measured to compare them.
    let is_unused = |direction: &Direction| !direction.has_curve() && *direction != Direction::D4;
    let unused = reduced.reduction.directions.iter().map(|along| along.direction).filter(is_unused);
    let directions: Vec<Direction> = unused.collect();
    let of_material = [
        is_density_assumed.then_some(Warning::DensityAssumed),
        Some(Warning::NoAbsorption),
        (!directions.is_empty()).then_some(Warning::DirectionsNotUsed { directions }),
    ];
    warnings(reduced).into_iter().chain(of_material.into_iter().flatten().filter(|_| is_written)).collect()
}

/// All figures; SI.
fn figures(reduced: &Reduced, warnings: &[Warning]) -> Json {
    let Reduced { tests, reduction, .. } = reduced;
    let along = |along: &DirectionMeans| {
        json!({
            "direction": along.direction.to_string(),
            "young_modulus_Pa": along.modulus,
            "strength_Pa": along.strength,
            "break_elongation": along.elongation,
            "break_stress_Pa": along.break_stress,
            // None where the mean curve has no two.
            "yield_points": along.yields.as_ref().ok().map(|found| [found.first, found.second]),
            "speeds": along.speeds.iter().map(speed_figures).collect::<Vec<_>>(),
        })
    };
    let mut figures = json!({
        "recordings": reduction.recordings(),
        "virtual_recordings": reduction.virtual_recordings(),
        "young_modulus_Pa": reduction.modulus,
        "directions": reduction.directions.iter().map(along).collect::<Vec<_>>(),
    });
    let specimens: Vec<Json> = tests.iter().filter_map(specimen_figures).collect();
    if !specimens.is_empty() {
        figures["specimens"] = specimens.into();
    }
    figures["notes"] = warnings.iter().map(Warning::to_string).collect();
    figures
}

fn speed_figures(speed: &SpeedMeans) -> Json {
    json!({
        "velocity_m_s": speed.velocity,
        "young_moduli_Pa": speed.moduli,
        "young_modulus_Pa": speed.modulus,
        "strength_Pa": speed.strength,
        "break_elongation": speed.elongation,
    })
}

/// The figures of a specimen of a machine's export.
fn specimen_figures(test: &CouponTest) -> Option<Json> {
    let CouponTest { sample, coupon, .. } = test;
    test.specimen.as_ref().map(|note| {
        json!({
            "file": shown_path(&test.path),
            "specimen": note.name,
            "direction": sample.direction.to_string(),
            "velocity_m_s": sample.velocity,
            "gauge_m": coupon.gauge(),
            "width_m": coupon.width(),
            "thickness_m": coupon.thickness(),
            "young_modulus_Pa": sample.modulus.slope,
            "strength_Pa": sample.rupture.strength,
            "break_elongation": sample.rupture.strain,
            // The columns of force and displacement, as the file names them, and what its head states.
            "columns": note.columns,
            "stated": note.stated,
        })
    })
}

/// The figures as tables, in MPa and per cent.
fn text(reduced: &Reduced) -> String {
    let Reduced { tests, reduction, .. } = reduced;
    let virtual_ones = match reduction.virtual_recordings() {
        0 => String::new(),
        count => format!(", {count} of them VIRTUAL"),
    };
    let mut text = match reduction.recordings() {
        1 => format!("1 recording{virtual_ones}\n"),
        count => format!("{count} recordings{virtual_ones}\n"),
    };
    text.extend(tests.iter().filter_map(specimen_text));
    text.extend(reduction.directions.iter().map(direction_text));
    if let Some(modulus) = reduction.modulus {
        text += &format!("MD and TD  E {:.1} MPa\n", modulus * 1e-6);
    }
    text
}

fn specimen_text(test: &CouponTest) -> Option<String> {
    let CouponTest { sample, coupon, .. } = test;
    let note = test.specimen.as_ref()?;
    let [gauge, width, thickness] =
        [coupon.gauge(), coupon.width(), coupon.thickness()].map(|length| significant(1e3 * length, 4));
    let [force, displacement] = &note.columns;
    let stated = match &note.stated[..] {
        [] => String::new(),
        stated => format!("    the file states {}\n", stated.join("; ")),
    };
    Some(format!(
        "{}, {}: {} at {} m/s, {gauge} x {width} x {thickness} mm, E {:.1} MPa, strength {:.1} MPa, break {:.1} %\n    `{force}` over `{displacement}`\n{stated}",
        shown_path(&test.path),
        note.name,
        sample.direction,
        significant(sample.velocity, 4),
        sample.modulus.slope * 1e-6,
        sample.rupture.strength * 1e-6,
        100.0 * sample.rupture.strain,
    ))
}

fn direction_text(along: &DirectionMeans) -> String {
    let moduli = along.speeds.iter().map(|speed| {
        let single: String = speed.moduli.iter().map(|modulus| format!("{:6.1}", modulus * 1e-6)).collect();
        let mean = with_deviation(speed.modulus, 1e-6, "MPa");
        format!("  {:>8} m/s  E{single}  mean {mean}\n", significant(speed.velocity, 4))
    });
    let points = match &along.yields {
        Ok(found) => {
            let shown = |[strain, stress]: [f64; 2]| format!("{strain:.3}, {:.2} MPa", stress * 1e-6);
            [found.first, found.second].map(shown).join("; ")
        }
        Err(_) => "none".into(),
    };
    format!(
        "{}\n{}  E {}\n  yield points at {points}\n  strength {}, break elongation {}\n",
        along.direction,
        moduli.collect::<String>(),
        with_deviation(along.modulus, 1e-6, "MPa"),
        with_deviation(along.strength, 1e-6, "MPa"),
        with_deviation(along.elongation, 100.0, "%"),
    )
}

fn with_deviation(of: SampleStatistics, factor: f64, unit: &str) -> String {
    let (mean, deviation) = (of.mean * factor, of.deviation * factor);
    match of.count {
        1 => format!("{mean:.1} {unit} (1)"),
        count => format!("{mean:.1} +- {deviation:.1} {unit} ({count})"),
    }
}

/// Warnings of assumptions, and of all that puts the figures in doubt.
fn warnings(reduced: &Reduced) -> Vec<Warning> {
    let tests = &reduced.tests;
    let under_load = tests.iter().filter(|test| test.sample.rupture.ending == CurveEnd::RecordEnded);
    let under_load: Vec<PathBuf> = under_load.map(CouponTest::place).collect();
    let under_load = (!under_load.is_empty()).then_some(Warning::RecordEndsUnderLoad { paths: under_load });
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
    let speeds = stated_otherwise(tests);
    let doubts =
        speeds.into_iter().chain(under_load).chain(merged).chain(replaced).chain(differ).chain(held).chain(no_yield);
    doubts.chain(coupon::doubts(tests)).chain(speeds_not_measured(reduced)).collect()
}

/// Speeds of names or headers that time and travel contradict.
fn stated_otherwise(tests: &[CouponTest]) -> Option<Warning> {
    let stated = |test: &CouponTest| Some((test.place(), test.measured??, test.sample.velocity));
    let all: Vec<(PathBuf, f64, f64)> = tests.iter().filter_map(stated).collect();
    let (paths, stated) = all.iter().map(|(path, stated, _)| (path.clone(), *stated)).unzip();
    let measured = all.iter().map(|(_, _, measured)| *measured).collect();
    (!all.is_empty()).then_some(Warning::SpeedStatedOtherwise { paths, stated, measured })
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
