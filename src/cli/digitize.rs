//! `droptower digitize`: a curve out of a picture of a published figure.

use std::io::Write;
use std::path::{Path, PathBuf};

use clap::Args;
use image::{ImageFormat, Rgb, RgbImage};
use serde::Serialize;

use super::{Failure, Shared, output, print_figures};
use base::diagnostic::{Diagnostic, shown_path};
use base::finding::Finding;
use base::number;
use scene::digitize::{Digitized, Figure, TraceError, digitize};
use scene::scenario::Document;

/// Digits of a printed figure.
const DIGITS: usize = 4;

#[derive(Debug, Args)]
pub(super) struct DigitizeArgs {
    /// The figure: picture, axes and curve (`droptower explain figure`)
    pub figure: PathBuf,
    /// The table to write (.csv): a column for each axis, and the error
    #[arg(long, short, value_name = "FILE")]
    pub out: PathBuf,
    /// Also write the picture with the points on it (.png), to look at
    #[arg(long, value_name = "FILE")]
    pub overlay: Option<PathBuf>,
    /// Replace files that exist
    #[arg(long)]
    pub force: bool,
}

/// A summary of the curve that was read.
#[derive(Serialize)]
struct Summary {
    out: String,
    points: usize,
    columns: [String; 2],
    from: [f64; 2],
    to: [f64; 2],
    /// Median half width of the 95 % intervals, in the unit of the y axis.
    error: f64,
    /// Largest one.
    largest_error: f64,
    scatter_pixels: f64,
    thickness_pixels: f64,
    findings: Vec<Finding>,
}

pub(super) fn run(args: &DigitizeArgs, shared: &Shared) -> Result<(), Failure> {
    let document = Document::read_figure(&args.figure)?;
    let figure = Figure::check(&document)?;
    output::check(&args.out, "csv", Some(&args.figure), Some(args.force))?;
    if let Some(overlay) = &args.overlay {
        output::check(overlay, "png", Some(&figure.path), Some(args.force))?;
    }
    let found = digitize(&figure).map_err(|error| untraced(error).at(&document.span_of(&["curve", "colour"])))?;
    let text = table(&figure, &found).map_err(|error| output::failed(&args.out, &error))?;
    output::write(&args.out, |file| file.write_all(&text))?;
    if let Some(path) = &args.overlay {
        write_overlay(path, &figure, &found)?;
    }
    let summary = summary(&args.out, &figure, &found);
    print_figures(shared, &summary, || digest(&summary, args))
}

fn untraced(error: TraceError) -> Diagnostic {
    let hint = match error {
        TraceError::Nothing => "read the colour off the picture, or raise `curve.tolerance`",
        TraceError::Scattered { .. } => "lower `curve.tolerance`, or narrow `curve.area`",
    };
    Diagnostic::new(error.to_string()).hint(hint)
}

fn summary(out: &Path, figure: &Figure, found: &Digitized) -> Summary {
    let [Some(from), Some(to)] = [found.points.first(), found.points.last()] else {
        unreachable!("a trace has points")
    };
    let mut errors = found.errors.clone();
    errors.sort_unstable_by(f64::total_cmp);
    Summary {
        out: shown_path(out),
        points: found.points.len(),
        columns: figure.axes.axes.each_ref().map(|axis| axis.column.clone()),
        from: *from,
        to: *to,
        error: errors[errors.len() / 2],
        largest_error: errors[errors.len() - 1],
        scatter_pixels: found.scatter,
        thickness_pixels: found.trace.thickness,
        findings: found.warnings.iter().map(Finding::new).collect(),
    }
}

fn digest(summary: &Summary, args: &DigitizeArgs) -> String {
    let shown = |value: f64| number::figure(value, DIGITS);
    let Summary { columns: [x, y], from, to, .. } = summary;
    let mut lines = vec![
        format!("{} points of {y} over {x} from {} to {}", summary.points, shown(from[0]), shown(to[0])),
        format!("  error (95 %): {} in the median, {} at most", shown(summary.error), shown(summary.largest_error)),
    ];
    lines.extend(summary.findings.iter().map(|finding| format!("  {finding}")));
    let overlay = args.overlay.iter().map(|path| shown_path(path));
    let files: Vec<String> = std::iter::once(summary.out.clone()).chain(overlay).collect();
    lines.push(format!("  {}", files.join("  ")));
    lines.join("\n")
}

/// The table: what it was read from in comments, the values of both axes, and half the width of the 95 % interval.
fn table(figure: &Figure, found: &Digitized) -> std::io::Result<Vec<u8>> {
    let [x, y] = &figure.axes.axes;
    let mut text = Vec::new();
    let picture = figure.picture();
    let name = figure.path.file_name().unwrap_or_default().to_string_lossy();
    writeln!(
        text,
        "# read out of the picture {} of {} x {} pixels by droptower {}",
        base::diagnostic::printable(&name).replace('\n', " "),
        picture.width(),
        picture.height(),
        env!("CARGO_PKG_VERSION")
    )?;
    writeln!(text, "# the last column is half the width of the interval in which {} lies with 95 %", y.column)?;
    let mut out = csv::Writer::from_writer(text);
    out.write_record([&x.column, &y.column, &format!("error_of_{}", y.column)])?;
    for ([across, up], error) in found.points.iter().zip(&found.errors) {
        out.serialize((across, up, error))?;
    }
    out.into_inner().map_err(|error| std::io::Error::other(error.to_string()))
}

/// The picture, paler, with the points in red.
fn write_overlay(path: &Path, figure: &Figure, found: &Digitized) -> Result<(), Failure> {
    const RED: Rgb<u8> = Rgb([220, 0, 0]);
    let mut picture: RgbImage = figure.picture().clone();
    for pixel in picture.pixels_mut() {
        pixel.0 = pixel.0.map(|part| 128 + part / 2);
    }
    for [across, down] in &found.trace.points {
        let (column, row) = (*across as u32, *down as u32);
        if column < picture.width() && row < picture.height() {
            picture.put_pixel(column, row, RED);
        }
    }
    output::write(path, |file| {
        let mut content = std::io::Cursor::new(Vec::new());
        picture.write_to(&mut content, ImageFormat::Png).map_err(std::io::Error::other)?;
        file.write_all(content.get_ref())
    })
}
