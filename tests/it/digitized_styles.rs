//! Curves read out of pictures of many styles: grids, widths of lines, colours, other curves, formats and lines of known values.

use std::fmt::Write as _;
use std::fs;
use std::io::Cursor;
use std::path::Path;

use droptower::digitize::{Digitized, Figure, digitize};
use droptower::scenario::Document;
use image::codecs::jpeg::JpegEncoder;
use image::{DynamicImage, ImageFormat, RgbImage};
use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::{Options, Tree};

/// Left, top, right and bottom of the axes, pixels.
const FRAME: [f64; 4] = [60.0, 20.0, 460.0, 270.0];
/// Ends of the axes: s, m/s².
const ENDS: [f64; 2] = [0.12, 160.0];

/// A value over a time from 0 to 0.12 s.
type Known = fn(f64) -> f64;

/// A pulse with a ripple, a pulse with corners, a decaying oscillation, and a plateau between two ramps.
const CURVES: [Known; 4] = [
    |time| {
        let about = (time - 0.06) / 0.022;
        140.0 * (-about * about).exp() * (1.0 + 0.08 * (500.0 * time).sin()) + 4.0
    },
    |time| 5.0 + 149.0 * (1.0 - (time - 0.05).abs() / 0.012).max(0.0),
    |time| 80.0 + 70.0 * (-25.0 * time).exp() * (400.0 * time).cos(),
    |time| 10.0 + 110.0 * ((time - 0.03) / 0.02).clamp(0.0, 1.0) - 90.0 * ((time - 0.08) / 0.01).clamp(0.0, 1.0),
];

const COLOURS: [&str; 7] = ["#1f77b4", "#d62728", "#2ca02c", "#ff7f0e", "#9467bd", "#000000", "#404040"];
const WIDTHS: [f64; 5] = [1.0, 1.5, 2.0, 3.0, 4.0];

/// Colour, width and dashes of the lines of a grid, which lie on pixels or between.
const GRIDS: [Option<(&str, f64, &str, f64)>; 7] = [
    None,
    Some(("#b0b0b0", 1.0, "none", 0.5)),
    Some(("#d3d3d3", 1.0, "none", 0.5)),
    Some(("#808080", 1.0, "none", 0.5)),
    Some(("#b0b0b0", 0.8, "none", 0.0)),
    Some(("#a0a0a0", 1.0, "4 2", 0.5)),
    Some(("#c0c0c0", 2.0, "none", 0.0)),
];

/// Colour and dashes of another curve.
const OTHERS: [Option<(&str, &str)>; 3] = [None, Some(("#8c564b", "none")), Some(("#17becf", "6 3"))];

/// Quality of JPEG; none of PNG.
const QUALITIES: [Option<u8>; 4] = [None, None, Some(75), Some(40)];

/// Style of a plot.
#[derive(Clone, Copy, Debug)]
struct Style {
    curve: usize,
    colour: &'static str,
    width: f64,
    grid: Option<(&'static str, f64, &'static str, f64)>,
    other: Option<(&'static str, &'static str)>,
    quality: Option<u8>,
    /// How far off the four points of the axes were picked, pixels: within the half that is stated.
    picked: [f64; 4],
}

impl Style {
    /// The style of this number: numbers without a common factor pair every choice with every other.
    fn of_number(number: usize) -> Style {
        Style {
            curve: number % CURVES.len(),
            colour: COLOURS[number % COLOURS.len()],
            width: WIDTHS[number % WIDTHS.len()],
            grid: GRIDS[(number / 7) % GRIDS.len()],
            other: OTHERS[number % OTHERS.len()],
            quality: QUALITIES[(number / 4) % QUALITIES.len()],
            picked: [0.0; 4],
        }
    }

    /// The same whose axes are picked within half a pixel, as a mouse does.
    fn picked(self, number: usize) -> Style {
        Style { picked: [31, 47, 59, 73].map(|prime| (number * prime % 97) as f64 / 97.0 - 0.5), ..self }
    }

    fn drawing(&self) -> String {
        let [left, top, right, bottom] = FRAME;
        let mut out = String::from(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"480\" height=\"300\">\
             <rect width=\"480\" height=\"300\" fill=\"white\"/>",
        );
        let mut line = |points: &str, colour: &str, width: f64, dashes: &str| {
            write!(
                out,
                "<polyline points=\"{points}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"{width}\" \
                 stroke-linejoin=\"round\" stroke-dasharray=\"{dashes}\"/>"
            )
            .expect("a string");
        };
        if let Some((colour, width, dashes, off)) = self.grid {
            for step in 1..6 {
                let share = f64::from(step) / 6.0;
                let [x, y] =
                    [(left + share * (right - left)).round() + off, (top + share * (bottom - top)).round() + off];
                line(&format!("{x},{top} {x},{bottom}"), colour, width, dashes);
                line(&format!("{left},{y} {right},{y}"), colour, width, dashes);
            }
        }
        if let Some((colour, dashes)) = self.other {
            line(&points(|time| 900.0 * time + 20.0), colour, self.width, dashes);
        }
        line(&points(CURVES[self.curve]), self.colour, self.width, "none");
        out + "</svg>"
    }

    /// The curve read out of its picture.
    fn read(&self, folder: &Path) -> Digitized {
        let tree = Tree::from_str(&self.drawing(), &Options::default()).expect("our picture");
        let mut drawn = Pixmap::new(480, 300).expect("a size");
        resvg::render(&tree, Transform::identity(), &mut drawn.as_mut());
        let pixels = drawn.data().chunks(4).flat_map(|pixel| [pixel[0], pixel[1], pixel[2]]).collect();
        let drawn = RgbImage::from_raw(480, 300, pixels).expect("as many pixels");
        let mut content = Cursor::new(Vec::new());
        match self.quality {
            None => DynamicImage::from(drawn).write_to(&mut content, ImageFormat::Png),
            Some(quality) => JpegEncoder::new_with_quality(&mut content, quality).encode_image(&drawn),
        }
        .expect("a picture");
        fs::write(folder.join("figure.png"), content.into_inner()).expect("a file");
        let [left, top, right, bottom] = FRAME;
        let [time, value] = ENDS;
        let [from, to, below, above] = self.picked;
        let (from, to, below, above) = (left + from, right + to, bottom + below, top + above);
        let text = format!(
            "picture = \"figure.png\"
             x = {{ column = \"time_s\", points = [{{ pixel = [{from}, {bottom}], value = 0 }}, {{ pixel = [{to}, {bottom}], value = {time} }}] }}
             y = {{ column = \"acceleration_m_s2\", points = [{{ pixel = [{left}, {below}], value = 0 }}, {{ pixel = [{left}, {above}], value = {value} }}] }}
             curve = {{ colour = \"{}\" }}",
            self.colour
        );
        fs::write(folder.join("figure.toml"), text).expect("a file");
        let document = Document::read_figure(&folder.join("figure.toml")).expect("a file");
        digitize(&Figure::check(&document).expect("a figure")).unwrap_or_else(|error| panic!("{self:?}: {error}"))
    }
}

/// The points of a line in the frame.
fn points(of: impl Fn(f64) -> f64) -> String {
    let [left, top, right, bottom] = FRAME;
    let point = |step: u32| {
        let share = f64::from(step) / 1600.0;
        let height = of(ENDS[0] * share) / ENDS[1];
        format!("{},{}", left + share * (right - left), bottom - height * (bottom - top))
    };
    (0..=1600).map(point).collect::<Vec<_>>().join(" ")
}

/// How a curve was read: the share of its points within their error, the largest distance (of the axis), and how much the
/// largest value is off (of the axis).
#[derive(Debug)]
struct Reading {
    within: f64,
    worst: f64,
    peak: f64,
    /// Share of the axis along which the curve was found.
    found: f64,
    /// Half of the points state an error below this, of the axis.
    error: f64,
}

fn reading(found: &Digitized, of: Known) -> Reading {
    let inner = || found.points.iter().zip(&found.errors).filter(|([time, _], _)| (2e-3..0.118).contains(time));
    let off = |time: f64, value: f64| (of(time) - value).abs();
    let within = inner().filter(|([time, value], error)| off(*time, *value) <= **error).count();
    // A point counts at the nearest time within a pixel: on a steep flank the value changes by much in it.
    let step = ENDS[0] / (FRAME[2] - FRAME[0]);
    let nearest = |time: f64, value: f64| {
        (-10..=10).map(|k| off(time + 0.1 * f64::from(k) * step, value)).fold(f64::INFINITY, f64::min)
    };
    let worst = inner().map(|([time, value], _)| nearest(*time, *value)).fold(0.0, f64::max);
    let largest = inner().map(|([_, value], _)| *value).fold(0.0, f64::max);
    let known = (0..=4000).map(|k| of(2e-3 + 0.116 * f64::from(k) / 4000.0)).fold(0.0, f64::max);
    let count = inner().count();
    let mut errors: Vec<f64> = inner().map(|(_, error)| *error).collect();
    errors.sort_unstable_by(f64::total_cmp);
    Reading {
        within: within as f64 / count as f64,
        worst: worst / ENDS[1],
        peak: (largest - known).abs() / ENDS[1],
        found: count as f64 / (0.116 / step),
        error: errors[errors.len() / 2] / ENDS[1],
    }
}

#[test]
fn curves_of_two_hundred_styles_are_read_within_their_errors() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut missed = vec![];
    let (mut worst, mut peak, mut stated) = (0.0_f64, 0.0_f64, 0.0_f64);
    for number in 0..240 {
        let style = Style::of_number(number);
        let reading = reading(&style.read(folder.path()), CURVES[style.curve]);
        (worst, peak, stated) = (worst.max(reading.worst), peak.max(reading.peak), stated.max(reading.error));
        // A line of one pixel loses its colour in a coarse JPEG here and there, and a sharp peak its tip.
        let [worst_of, peak_of, found_of] =
            if style.quality.is_some() { [0.025, 0.02, 0.85] } else { [0.02, 0.01, 0.95] };
        // A stated error that held every point would be no reading: the middle one is at most half the line, a pixel, and half
        // of one for the points of the axes.
        let error_of = (0.5 * style.width + 1.5) / (FRAME[3] - FRAME[1]);
        let is_off = reading.worst > worst_of || reading.peak > peak_of || reading.error > error_of;
        if reading.within < 0.95 || is_off || reading.found < found_of {
            missed.push(format!("{number}: {style:?}: {reading:?}"));
        }
    }
    println!("worst point {worst:.4}, worst peak {peak:.4}, largest median error {stated:.4} of the axis");
    assert!(missed.is_empty(), "{} of 240:\n{}", missed.len(), missed.join("\n"));
}

/// Intervals of 95 %: of plots whose axes are off by up to what is stated, 95 of 100 have 95 % of their points within.
#[test]
fn axes_that_are_off_by_half_a_pixel_are_within_the_errors() {
    let folder = tempfile::tempdir().expect("a folder");
    let within = |number: usize| {
        let style = Style::of_number(number).picked(number);
        reading(&style.read(folder.path()), CURVES[style.curve]).within
    };
    let shares: Vec<f64> = (0..240).step_by(2).map(within).collect();
    let covered = shares.iter().filter(|share| **share >= 0.95).count();
    println!(
        "{covered} of {} plots, {:.3} of all points",
        shares.len(),
        shares.iter().sum::<f64>() / shares.len() as f64
    );
    assert!(covered >= 114, "{covered} of {}: {shares:.3?}", shares.len());
}
