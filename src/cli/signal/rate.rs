//! `droptower signal rate`: how well one recording follows another, by ISO/TS 18571.

use std::path::{Path, PathBuf};

use clap::Args;
use serde::Serialize;

use super::input::{Chosen, Input, TableArgs};
use super::remarks;
use crate::{Failure, Shared, print_figures};
use base::diagnostic::{Diagnostic, shown_path};
use base::finding::Finding;
use lab::signal::rating::{self, Curve, Rating};
use lab::signal::{Annotations, MeasuredChannel, Warning};

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

#[derive(Serialize)]
struct Figures {
    corridor: f64,
    phase: f64,
    magnitude: f64,
    slope: f64,
    overall: f64,
    grade: String,
    shift_s: f64,
    samples: usize,
    notes: Vec<String>,
    findings: Vec<Finding>,
}

pub(super) fn run(args: &RateArgs, shared: &Shared) -> Result<(), Failure> {
    let rated = rating(args)?;
    print_figures(shared, &figures(&rated), || text(args, &rated))
}

/// A rating and what the files of its curves state.
struct Rated {
    rating: Rating,
    files: [(Curve, Annotations); 2],
}

impl Rated {
    fn notes(&self) -> Vec<String> {
        let of_file = |(curve, file): &(Curve, Annotations)| {
            let curve = *curve;
            file.notes().into_iter().map(move |note| format!("{curve}: {note}"))
        };
        let of_rating = self.rating.warnings.iter().map(Warning::to_string);
        self.files.iter().flat_map(of_file).chain(of_rating).collect()
    }

    /// Comments of the files that are no finding.
    fn comments(&self) -> Vec<String> {
        let of_file = |(curve, file): &(Curve, Annotations)| {
            let prefixed = |comment| format!("{curve}: {comment}");
            file.free_comments().map(prefixed).collect::<Vec<_>>()
        };
        self.files.iter().flat_map(of_file).collect()
    }

    fn findings(&self) -> Vec<Finding> {
        let of_file = |(curve, file): &(Curve, Annotations)| {
            let curve = *curve;
            let of_curve =
                move |finding: Finding| Finding { message: format!("{curve}: {}", finding.message), ..finding };
            file.findings().into_iter().map(of_curve)
        };
        self.files.iter().flat_map(of_file).chain(self.rating.warnings.iter().map(Finding::new)).collect()
    }
}

fn rating(args: &RateArgs) -> Result<Rated, Vec<Diagnostic>> {
    let column = args.comparison_column.as_ref().or(args.column.as_ref());
    let (reference, comparison) =
        match (args.read(&args.reference, args.column.as_ref()), args.read(&args.comparison, column)) {
            (Ok(reference), Ok(comparison)) => (reference, comparison),
            (reference, comparison) => return Err([reference.err(), comparison.err()].into_iter().flatten().collect()),
        };
    check_units(args, &reference.channel, &comparison.channel).map_err(|mistake| vec![mistake])?;
    let found = rating::rate(&reference.channel.series, &comparison.channel.series);
    let found = found.map_err(|error| {
        let [reference, comparison] = [&args.reference, &args.comparison].map(|path| shown_path(path));
        vec![
            Diagnostic::new(error.to_string())
                .hint(format!("the reference is {reference}, the comparison {comparison}")),
        ]
    })?;
    let files = [(Curve::Reference, reference.annotations), (Curve::Comparison, comparison.annotations)];
    Ok(Rated { rating: found, files })
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

fn figures(rated: &Rated) -> Figures {
    let rating = &rated.rating;
    Figures {
        corridor: rating.corridor,
        phase: rating.phase,
        magnitude: rating.magnitude,
        slope: rating.slope,
        overall: rating.overall,
        grade: rating.grade.to_string(),
        shift_s: rating.shift,
        samples: rating.samples,
        notes: rated.notes(),
        findings: rated.findings(),
    }
}

fn text(args: &RateArgs, rated: &Rated) -> String {
    let rating = &rated.rating;
    let Rating { corridor, phase, magnitude, slope, overall, grade, .. } = rating;
    let shift = match 1e3 * rating.shift {
        0.0 => "no shift".to_owned(),
        late if late > 0.0 => format!("comparison {late:.1} ms late"),
        early => format!("comparison {:.1} ms early", -early),
    };
    let text = format!(
        "{} rated against {}, ISO/TS 18571, {} samples\n  \
         corridor   {corridor:.3}\n  phase      {phase:.3}  {shift}\n  magnitude  {magnitude:.3}\n  slope      {slope:.3}\n  \
         overall    {overall:.3}  {grade}\n{}",
        shown_path(&args.comparison),
        shown_path(&args.reference),
        rating.samples,
        remarks::lines(&rated.comments(), &rated.findings())
    );
    text.trim_end().to_owned()
}
