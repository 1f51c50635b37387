//! Curves read out of pictures of our own plots, whose values are known.

use std::fs;
use std::io::Cursor;
use std::path::Path;

use droptower::digitize::{Digitized, Figure, Warning, digitize};
use droptower::plot::{Axis, Curve, Plot, Scale, svg};
use droptower::scenario::Document;
use image::codecs::jpeg::JpegEncoder;
use image::{DynamicImage, ImageFormat, RgbImage};
use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::{Options, Tree};
use tempfile::TempDir;

use crate::workbench::{droptower, error, figures, printed};

/// The first colour of our plots.
const BLUE: &str = "#1f77b4";

/// A deceleration: a pulse with a ripple, m/s².
fn pulse(time: f64) -> f64 {
    let about = (time - 0.06) / 0.022;
    140.0 * (-about * about).exp() * (1.0 + 0.08 * (500.0 * time).sin()) + 2.0
}

/// A name and the value at each time, s.
type Known<'a> = (&'a str, fn(f64) -> f64);

fn plot(curves: &[Known], y: Scale) -> Plot {
    let times = || (0..=1200).map(|step| 1e-4 * f64::from(step));
    let curve = |(name, of): &Known| Curve::line(*name, times().map(|time| [time, of(time)]));
    let mut plot = Plot::new("a test", ["time (s)", "deceleration (m/s²)"], curves.iter().map(curve).collect());
    plot.y = Axis { scale: y, ..plot.y };
    plot
}

/// How a picture is stored.
#[derive(Clone, Copy)]
enum Format {
    Png,
    Jpeg(u8),
}

/// A folder with the plot as a picture, drawn `scale` times as large as on our pages, and its `figure.toml`.
fn figure(plot: &Plot, scale: f32, format: Format, more: &str) -> TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    let drawing = svg(plot);
    let tree = Tree::from_str(&drawing, &Options::default()).expect("our picture");
    let size = tree.size().to_int_size().scale_by(scale).expect("a size");
    let mut drawn = Pixmap::new(size.width(), size.height()).expect("a size");
    resvg::render(&tree, Transform::from_scale(scale, scale), &mut drawn.as_mut());
    let pixels = drawn.data().chunks(4).flat_map(|pixel| [pixel[0], pixel[1], pixel[2]]).collect();
    let drawn = RgbImage::from_raw(size.width(), size.height(), pixels).expect("as many pixels");
    let mut content = Cursor::new(Vec::new());
    let (name, written) = match format {
        Format::Png => ("figure.png", DynamicImage::from(drawn).write_to(&mut content, ImageFormat::Png)),
        Format::Jpeg(quality) => {
            ("figure.jpg", JpegEncoder::new_with_quality(&mut content, quality).encode_image(&drawn))
        }
    };
    written.expect("a picture");
    fs::write(folder.path().join(name), content.into_inner()).expect("a file");
    let axes = ["x", "y"].map(|axis| points(&drawing, axis, f64::from(scale)));
    let text = format!(
        "picture = \"{name}\"\n[x]\ncolumn = \"time_s\"\npoints = {}\n[y]\ncolumn = \"acceleration_m_s2\"\npoints = {}\n{}\n\
         [curve]\ncolour = \"{BLUE}\"\n{more}\n",
        axes[0],
        axes[1],
        if plot.y.scale == Scale::Logarithmic { "scale = \"log\"" } else { "" }
    );
    fs::write(folder.path().join("figure.toml"), text).expect("a file");
    folder
}

/// The first and the last number at an axis of our picture, as a user would read them off.
fn points(svg: &str, axis: &str, scale: f64) -> String {
    // Beside the y axis, labels end at the axis; below the x axis, they are centred under their ticks.
    let (marks, place) = if axis == "x" { ("text-anchor=\"middle\"", "x=\"") } else { ("text-anchor=\"end\"", "y=\"") };
    let number = |text: &str, from: &str| text.split(from).nth(1)?.split('"').next()?.parse::<f64>().ok();
    let labels = svg.split("<text").skip(1).filter(|text| text.contains(marks)).filter_map(|text| {
        let value: f64 = text.split('>').nth(1)?.split('<').next()?.trim().parse().ok()?;
        Some((scale * number(text, place)? / 10.0, value))
    });
    let labels: Vec<(f64, f64)> = labels.collect();
    let point = |(at, value): (f64, f64)| {
        let (unit, pixel) = if axis == "x" { ("s", [at, 10.0]) } else { ("m/s2", [10.0, at]) };
        format!("{{ pixel = {pixel:?}, value = \"{value} {unit}\" }}")
    };
    format!("[{}, {}]", point(labels[0]), point(labels[labels.len() - 1]))
}

fn read(folder: &Path) -> Digitized {
    let figure = Figure::check(&Document::read_figure(&folder.join("figure.toml")).expect("a file")).expect("a figure");
    digitize(&figure).expect("a curve")
}

/// Share of the points whose interval holds the known value; values at the ends of the plot, which the axes cut, left out.
fn share_within(found: &Digitized, of: fn(f64) -> f64) -> f64 {
    let points = found.points.iter().zip(&found.errors).filter(|([time, _], _)| (1e-3..0.119).contains(time));
    let (within, all) = points.fold((0_u32, 0_u32), |(within, all), ([time, value], error)| {
        (within + u32::from((of(*time) - value).abs() <= *error), all + 1)
    });
    f64::from(within) / f64::from(all)
}

/// The area without the title and the legend: what the axes enclose.
fn area(scale: f64) -> String {
    let [left, top, right, bottom] = [63.0, 35.0, 536.0, 293.0].map(|at| scale * at);
    format!("area = [{left}, {top}, {right}, {bottom}]")
}

#[test]
fn a_curve_is_read_at_any_resolution_within_its_error() {
    for (scale, format, median) in [
        (0.7, Format::Png, 4.0),
        (1.0, Format::Png, 2.5),
        (2.0, Format::Png, 1.5),
        (4.0, Format::Png, 1.0),
        (1.0, Format::Jpeg(75), 4.0),
        (2.0, Format::Jpeg(50), 2.5),
        (4.0, Format::Jpeg(30), 2.0),
    ] {
        let plot = plot(&[("a", pulse), ("b", |time| 900.0 * time)], Scale::Linear);
        let folder = figure(&plot, scale, format, &area(f64::from(scale)));
        let found = read(folder.path());
        let mut errors = found.errors.clone();
        errors.sort_unstable_by(f64::total_cmp);
        let middle = errors[errors.len() / 2];
        let share = share_within(&found, pulse);
        println!("{scale} {}: {share:.3} within {middle:.3} m/s²", matches!(format, Format::Png));
        assert!(found.warnings.is_empty(), "{:?}", found.warnings);
        assert!(share >= 0.95, "at {scale}: {share} of the points are within their error of {middle}");
        assert!(middle <= median, "at {scale}: error {middle} m/s²");
        assert!(found.points.len() as f32 > 440.0 * scale);
    }
}

#[test]
fn logarithmic_axes_turned_pictures_and_legends() {
    let decay = |time: f64| 1000.0 * (-60.0 * time).exp();
    let found = read(figure(&plot(&[("a", decay)], Scale::Logarithmic), 2.0, Format::Png, &area(2.0)).path());
    assert!(share_within(&found, decay) >= 0.95);
    let [time, value] = found.points[found.points.len() / 2];
    assert!((value / decay(time) - 1.0).abs() < 0.02, "{value} {}", decay(time));

    // A legend in the area has the colour of the curve and is not it; left out, nothing is elsewhere.
    let both = plot(&[("a", pulse), ("b", |time| 900.0 * time)], Scale::Linear);
    let with_legend = "area = [63, 35, 560, 400]";
    let found = read(figure(&both, 1.0, Format::Png, with_legend).path());
    assert!(share_within(&found, pulse) >= 0.95);
}

#[test]
fn doubts_are_findings() {
    let gap = |time: f64| if (0.03..0.037).contains(&time) { f64::NAN } else { 100.0 * time };
    let found = read(figure(&plot(&[("a", gap)], Scale::Linear), 1.0, Format::Png, &area(1.0)).path());
    let [Warning::Interrupted { share, from, to }] = found.warnings[..] else { panic!("{:?}", found.warnings) };
    assert!((share - 0.007 / 0.12).abs() < 0.01 && (from - 0.03).abs() < 1e-3 && (to - 0.037).abs() < 1e-3);
    // What is further away counts as another curve.
    let halves = |time: f64| if (0.03..0.05).contains(&time) { f64::NAN } else { 100.0 * time };
    let found = read(figure(&plot(&[("a", halves)], Scale::Linear), 1.0, Format::Png, &area(1.0)).path());
    assert!(matches!(found.warnings[..], [Warning::Elsewhere { share }] if share > 0.25), "{:?}", found.warnings);
    let start = |time: f64| if time < 0.03 { 100.0 } else { f64::NAN };
    let far = plot(&[("a", start), ("b", |time| 900.0 * time)], Scale::Linear);
    let found = read(figure(&far, 1.0, Format::Png, &area(1.0)).path());
    assert!(matches!(found.warnings[..], [Warning::Short { share }] if share < 0.4), "{:?}", found.warnings);
}

/// The command writes a table that a scenario takes as its reference.
#[test]
fn a_table_is_a_reference() {
    let plot = plot(&[("a", pulse)], Scale::Linear);
    let folder = figure(&plot, 2.0, Format::Png, &area(2.0));
    let at = folder.path();
    let arguments = ["digitize", "figure.toml", "-o", "curve.csv", "--overlay", "look.png", "--json"];
    let summary = figures(&droptower(at, &arguments));
    assert_eq!(summary["columns"], serde_json::json!(["time_s", "acceleration_m_s2"]));
    assert!(summary["error"].as_f64().expect("a number") < 2.0);
    let first = fs::read(at.join("curve.csv")).expect("a table");
    assert!(String::from_utf8_lossy(&first).contains("error_of_acceleration_m_s2"));
    let overlay = image::open(at.join("look.png")).expect("a picture").into_rgb8();
    assert!(overlay.pixels().filter(|pixel| pixel.0 == [220, 0, 0]).count() > 800);
    let again = droptower(at, &["digitize", "figure.toml", "-o", "curve.csv"]);
    assert_eq!(again.status.code(), Some(2), "what is there is not replaced");
    printed(&droptower(at, &["digitize", "figure.toml", "-o", "curve.csv", "--force"]));
    assert!(fs::read(at.join("curve.csv")).expect("a table") == first, "the same picture gives the same table");
    let base = crate::workbench::root().join("scenarios/drop/1008.toml");
    let scenario = format!(
        "extends = {base:?}\nunset = [\"reference\", \"post\"]\nspecimen.mesh.size = \"80 mm\"\n\
         reference = {{ signals = \"curve.csv\" }}\noutput.filter = \"CFC180\"\n"
    );
    fs::write(at.join("drop.toml"), scenario).expect("a scenario");
    let summary = figures(&droptower(at, &["run", "drop.toml", "--json"]));
    assert!(summary.as_object().expect("figures").keys().any(|name| name.contains("error")), "{summary}");
}

#[test]
fn mistakes_in_a_figure_are_told() {
    let plot = plot(&[("a", pulse)], Scale::Linear);
    let folder = figure(&plot, 1.0, Format::Png, &area(1.0));
    let good = fs::read_to_string(folder.path().join("figure.toml")).expect("a file");
    for (from, to, told) in [
        (BLUE, "blue", "expected a colour, found \"blue\""),
        (BLUE, "#fffffe", "nearly the same colour"),
        (BLUE, "#00ff00", "nothing in the area has the colour"),
        ("m/s2\"", "mm\"", "expected an acceleration"),
        ("figure.png", "none.png", "cannot read"),
        ("figure.png", "figure.toml", "figure.toml"),
        ("area = [63", "area = [5000", "the area is not in the picture"),
        ("column = \"time_s\"", "colum = \"time_s\"", "unknown key `colum`"),
    ] {
        assert!(good.contains(from), "{from}");
        fs::write(folder.path().join("wrong.toml"), good.replace(from, to)).expect("a file");
        let output = droptower(folder.path(), &["digitize", "wrong.toml", "-o", "out.csv"]);
        assert_eq!(output.status.code(), Some(2), "{to}");
        assert!(error(&output).contains(told), "{to}: {}", error(&output));
        assert!(!folder.path().join("out.csv").exists());
    }
}

#[test]
fn a_picture_without_a_line_is_refused_at_once() {
    let plot = plot(&[("a", pulse)], Scale::Linear);
    let folder = figure(&plot, 1.0, Format::Png, &area(1.0));
    // Every second pixel of every second column.
    let blue = [31, 119, 180];
    let dotted = RgbImage::from_fn(600, 400, |x, y| image::Rgb(if (x + y) % 2 == 0 { blue } else { [255; 3] }));
    dotted.save(folder.path().join("figure.png")).expect("a picture");
    let output = droptower(folder.path(), &["digitize", "figure.toml", "-o", "out.csv"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(error(&output).contains("places of a column"), "{}", error(&output));
}

#[test]
fn a_new_figure_needs_its_picture_and_pixels_only() {
    let folder = tempfile::tempdir().expect("a folder");
    printed(&droptower(folder.path(), &["new", "figure", "mine.toml"]));
    let output = droptower(folder.path(), &["digitize", "mine.toml", "-o", "out.csv"]);
    let told = error(&output);
    assert!(told.contains("cannot read figure.png: there is no such file"), "{told}");
    assert_eq!(told.matches("error: ").count(), 1, "{told}");
    let plot = plot(&[("a", pulse)], Scale::Linear);
    let drawn = figure(&plot, 1.0, Format::Png, "");
    fs::copy(drawn.path().join("figure.png"), folder.path().join("figure.png")).expect("a picture");
    assert!(printed(&droptower(folder.path(), &["digitize", "mine.toml", "-o", "out.csv"])).contains("points of"));
}
