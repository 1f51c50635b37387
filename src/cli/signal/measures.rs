//! `droptower signal hic`, `clip` and `rate`: measures of recordings.

use std::path::{Path, PathBuf};

use clap::Args;
use serde_json::{Value, json};

use crate::args::{Choice, choice, milliseconds, words_of};
use crate::failure::both;
use crate::signal::{self, Chosen, Input, TableArgs, remark_lines, remarks, with_notes};
use crate::{Failure, Shared, print_figures};
use base::diagnostic::{Diagnostic, shown_path};
use base::finding::Finding;
use base::number::{clean_time, significant};
use base::units::{Acceleration, STANDARD_GRAVITY};
use lab::signal::clip::{Counting, clip};
use lab::signal::filter::{self, Standard};
use lab::signal::hic::{LONG_WINDOW, dummy_equivalent, head_injury_criterion};
use lab::signal::rating::{self, Curve, Rating};
use lab::signal::{Annotations, MeasuredChannel, Series, Warning};

#[derive(Clone, Debug, Args)]
pub(crate) struct AccelerationArgs {
    #[command(flatten)]
    pub input: Input,
    /// Filter with this channel frequency class first (ISO 6487), e.g. 1000
    #[arg(long, value_name = "CFC", value_parser = signal::class)]
    pub class: Option<f64>,
    /// Use the record up to this time alone, ms of its own clock: UN R94 leaves out the rebound of the head
    #[arg(long, value_name = "MS", value_parser = milliseconds, allow_hyphen_values = true)]
    pub until: Option<f64>,
}

/// The acceleration, m/s².
pub(crate) struct Read {
    pub series: Series,
    /// Comments of its file, and what its reading reports.
    pub annotations: Annotations,
}

impl AccelerationArgs {
    /// The acceleration asked for.
    pub(crate) fn read(&self) -> Result<Read, Diagnostic> {
        let Chosen { channel, mut annotations } = self.input.read_as(Acceleration::DIMENSION)?;
        let Some(class) = self.class else {
            return Ok(Read { series: self.part(channel.series)?, annotations });
        };
        annotations.warnings.extend(signal::filtered_before(&channel));
        annotations.warnings.extend(signal::unusual_class(class));
        let series = filter::channel(&channel.series, class, Standard::Iso6487).map_err(|error| self.mistake(error))?;
        Ok(Read { series: self.part(series)?, annotations })
    }

    /// The samples up to `until`. The filter comes first, so that the cut does not affect it.
    fn part(&self, series: Series) -> Result<Series, Diagnostic> {
        let Some(until) = self.until else { return Ok(series) };
        let ([first, .., last] | [first @ last]) = series.time() else { return Ok(series) };
        if 1e-3 * until > *first {
            return Ok(series.window([f64::NEG_INFINITY, 1e-3 * until]));
        }
        let [until, first, last] = [until, 1e3 * first, 1e3 * last].map(|time| significant(time, 6));
        Err(self
            .mistake(format!("the record begins at {first} ms and ends at {last} ms, none of it before {until} ms")))
    }

    /// A diagnostic of an error in the channel.
    pub(crate) fn mistake(&self, error: impl std::fmt::Display) -> Diagnostic {
        Diagnostic::new(format!("{}: {error}", shown_path(&self.input.path)))
    }

    /// Prints the figures that there are, how the acceleration was filtered and cut, and what its file states.
    fn print(
        &self,
        shared: &Shared,
        mut figures: Value,
        annotations: &Annotations,
        text: impl FnOnce() -> String,
    ) -> Result<(), Failure> {
        figures["filter_class"] = json!(self.class);
        figures["until_ms"] = json!(self.until);
        if let Value::Object(figures) = &mut figures {
            figures.retain(|_, value| !value.is_null());
        }
        print_figures(shared, &with_notes(figures, annotations), || [text(), remarks(annotations)].concat())
    }

    /// How it was filtered and cut, for the terminal.
    fn treated(&self) -> String {
        let filter = self.class.map_or_else(|| "no filter".into(), |class| format!("CFC {class}"));
        self.until.map_or(filter.clone(), |until| format!("{filter}, up to {until} ms"))
    }
}

#[derive(Debug, Args)]
pub(crate) struct HicArgs {
    #[command(flatten)]
    pub acceleration: AccelerationArgs,
    /// Longest interval, ms; 15 and 36 are usual
    #[arg(long, value_name = "MS", default_value_t = 15.0, value_parser = milliseconds)]
    pub window: f64,
}

pub(crate) fn hic(args: &HicArgs, shared: &Shared) -> Result<(), Failure> {
    let Read { series, annotations } = args.acceleration.read()?;
    let found = head_injury_criterion(&series, 1e-3 * args.window);
    let found = found.map_err(|error| args.acceleration.mistake(error))?;
    let (hic, window, mean_g) = (found.value, args.window, found.mean / STANDARD_GRAVITY);
    let hic_d = (window == 1e3 * LONG_WINDOW).then(|| dummy_equivalent(hic));
    let [from, to] = [found.start, found.end].map(clean_time);
    let duration_ms = clean_time(1e3 * (found.end - found.start));
    let figures = json!({
        "hic": hic,
        "window_ms": window,
        "hic_d": hic_d,
        "t1_s": from,
        "t2_s": to,
        "duration_ms": duration_ms,
        "mean_g": mean_g,
    });
    args.acceleration.print(shared, figures, &annotations, || {
        let treated = args.acceleration.treated();
        let of_head_form = hic_d.map(|hic_d| format!("HIC(d) {hic_d:.3}, were it of a free-motion head form\n"));
        format!(
            "HIC{window}  {hic:.3}  {mean_g:.2} g over {duration_ms:.3} ms, from {from:.6} s to {to:.6} s, {treated}\n{}",
            of_head_form.unwrap_or_default()
        )
    })
}

#[derive(Debug, Args)]
pub(crate) struct ClipArgs {
    #[command(flatten)]
    pub acceleration: AccelerationArgs,
    /// How long the level is held, ms
    #[arg(long, value_name = "MS", default_value_t = 3.0, value_parser = milliseconds)]
    pub duration: f64,
    /// Whether intervals add up (49 CFR 571.208, UN R94) or one has to last
    #[arg(long, value_parser = choice(&COUNTINGS), default_value = "cumulative")]
    pub counting: Counting,
}

/// How intervals count, by word.
const COUNTINGS: [Choice<Counting>; 2] = [
    ("cumulative", "All intervals together", Counting::Cumulative),
    ("contiguous", "The longest unbroken interval", Counting::Contiguous),
];

pub(crate) fn clip_command(args: &ClipArgs, shared: &Shared) -> Result<(), Failure> {
    let Read { series, mut annotations } = args.acceleration.read()?;
    let [name, _] = words_of(&COUNTINGS, &args.counting);
    let found = clip(&series, 1e-3 * args.duration, args.counting).map_err(|error| args.acceleration.mistake(error))?;
    if found.level <= 0.0 {
        annotations.warnings.push(Warning::NoPositiveLevel);
    }
    let (clip_g, duration) = (found.level / STANDARD_GRAVITY, args.duration);
    let [from, to] = [found.start, found.end].map(clean_time);
    let figures = json!({
        "clip_g": clip_g,
        "clip_m_s2": found.level,
        "counting": name,
        "duration_ms": duration,
        "start_s": from,
        "end_s": to,
    });
    args.acceleration.print(shared, figures, &annotations, || {
        let treated = args.acceleration.treated();
        format!("{duration} ms clip  {clip_g:.3} g  {name}, between {from:.6} s and {to:.6} s, {treated}\n")
    })
}

#[derive(Debug, Args)]
pub(crate) struct RateArgs {
    /// The reference; `droptower explain formats` lists what is read
    pub reference: PathBuf,
    /// The rated recording
    pub comparison: PathBuf,
    /// The channel, where there are several
    #[arg(long, value_name = "NAME")]
    pub column: Option<String>,
    /// The channel of the comparison, where its name differs
    #[arg(long, value_name = "NAME")]
    pub comparison_column: Option<String>,
    #[command(flatten)]
    pub table: TableArgs,
    /// The channels' unit where a file states none; g is standard gravity
    #[arg(long, value_name = "UNIT")]
    pub unit: Option<String>,
}

pub(crate) fn rate(args: &RateArgs, shared: &Shared) -> Result<(), Failure> {
    let rated = rating(args)?;
    let rating = &rated.rating;
    let figures = json!({
        "corridor": rating.corridor,
        "phase": rating.phase,
        "magnitude": rating.magnitude,
        "slope": rating.slope,
        "overall": rating.overall,
        "grade": rating.grade.to_string(),
        "shift_s": rating.shift,
        "samples": rating.samples,
        "notes": rated.notes,
        "findings": rated.findings,
    });
    print_figures(shared, &figures, || rating_text(args, &rated))
}

/// A rating, and what it and the files of its curves state.
struct Rated {
    rating: Rating,
    notes: Vec<String>,
    /// Comments of the files that are no finding.
    comments: Vec<String>,
    findings: Vec<Finding>,
}

fn rating(args: &RateArgs) -> Result<Rated, Failure> {
    let column = args.comparison_column.as_ref().or(args.column.as_ref());
    let (reference, comparison) =
        both(args.read(&args.reference, args.column.as_ref()), args.read(&args.comparison, column))?;
    check_units(args, &reference.channel, &comparison.channel)?;
    let found = rating::rate(&reference.channel.series, &comparison.channel.series);
    let rating = found.map_err(|error| {
        let [reference, comparison] = [&args.reference, &args.comparison].map(|path| shown_path(path));
        Diagnostic::new(error.to_string()).hint(format!("the reference is {reference}, the comparison {comparison}"))
    })?;
    let (mut notes, mut comments, mut findings) = (vec![], vec![], vec![]);
    for (curve, file) in [(Curve::Reference, reference.annotations), (Curve::Comparison, comparison.annotations)] {
        let of_curve = |text: &String| format!("{curve}: {text}");
        notes.extend(file.notes().iter().map(of_curve));
        comments.extend(file.free_comments().map(of_curve));
        findings.extend(file.findings().into_iter().map(|own| Finding { message: of_curve(&own.message), ..own }));
    }
    notes.extend(rating.warnings.iter().map(Warning::to_string));
    findings.extend(rating.warnings.iter().map(Finding::new));
    Ok(Rated { rating, notes, comments, findings })
}

impl RateArgs {
    fn read(&self, path: &Path, column: Option<&String>) -> Result<Chosen, Diagnostic> {
        let (column, table, unit) = (column.cloned(), self.table.clone(), self.unit.clone());
        Input { path: path.into(), column, table, unit }.read()
    }
}

/// Curves are only rated in the same quantity; two without units count as the same.
fn check_units(args: &RateArgs, reference: &MeasuredChannel, comparison: &MeasuredChannel) -> Result<(), Diagnostic> {
    let unit = |measured: &MeasuredChannel| measured.value_unit().unwrap_or_else(|| "a unit that is not known".into());
    let (r, c) = (unit(reference), unit(comparison));
    if r == c {
        return Ok(());
    }
    let [reference, comparison] = [&args.reference, &args.comparison].map(|path| shown_path(path));
    let mistake = Diagnostic::new(format!("{reference} is in {r}, {comparison} in {c}"));
    Err(mistake.hint("choose channels of one quantity with --column and --comparison-column, or give --unit"))
}

fn rating_text(args: &RateArgs, rated: &Rated) -> String {
    let rating = &rated.rating;
    let Rating { corridor, phase, magnitude, slope, overall, grade, .. } = rating;
    let shift = match 1e3 * rating.shift {
        0.0 => "no shift".to_owned(),
        late if late > 0.0 => format!("comparison {late:.1} ms late"),
        early => format!("comparison {:.1} ms early", -early),
    };
    format!(
        "{} rated against {}, ISO/TS 18571, {} samples\n  \
         corridor   {corridor:.3}\n  phase      {phase:.3}  {shift}\n  magnitude  {magnitude:.3}\n  slope      {slope:.3}\n  \
         overall    {overall:.3}  {grade}\n{}",
        shown_path(&args.comparison),
        shown_path(&args.reference),
        rating.samples,
        remark_lines(&rated.comments, &rated.findings)
    )
}
