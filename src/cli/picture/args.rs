//! The arguments of `droptower picture`, and how they set a picture.

use std::path::PathBuf;

use clap::{Args, ValueHint};

use crate::args::{Choice, choice, quantity};
use crate::picture::Format;
use base::diagnostic::Diagnostic;
use base::units::Length;
use picture::{FAMILIES, Part, View};
use plot::Style;

#[derive(Debug, Args)]
pub(crate) struct PictureArgs {
    /// Folder of a run; with --plot also of a sweep, a study or a comparison
    #[arg(value_name = "RUN", value_hint = ValueHint::DirPath)]
    pub run: PathBuf,
    /// The picture to write (.png or .svg), or the scene in 3-D for slides (.glb); without it, what can be drawn is listed
    #[arg(long, short, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub out: Option<PathBuf>,
    /// A plot of the page by the beginning of its title, such as acceleration, instead of the scene
    #[arg(long, value_name = "NAME", conflicts_with_all = ["at", "field", "range", "view", "perspective", "part", "again"])]
    pub plot: Option<String>,
    /// Time with its unit, first, last, first-contact, or a moment such as lowest-point; the nearest kept state is drawn
    /// [default: lowest-point or largest-force, before rupture]
    #[arg(long, value_name = "TIME", allow_hyphen_values = true)]
    pub at: Option<String>,
    /// What colours the film: largest, md, td, shear; with --again also thickness, plastic, damage
    #[arg(long, value_name = "FIELD", default_value = "largest")]
    pub field: String,
    /// Colour range, in the unit of the field: 0..40 [default: of all kept states]
    #[arg(long, value_name = "FROM..TO", value_parser = ends, allow_hyphen_values = true)]
    pub range: Option<[f32; 2]>,
    /// iso, front, side, top, bottom, below, or azimuth/elevation in degrees [default: iso]
    #[arg(long, value_name = "VIEW", value_parser = |text: &str| text.parse::<View>(), allow_hyphen_values = true)]
    pub view: Option<View>,
    /// Use perspective
    #[arg(long)]
    pub perspective: bool,
    /// What is drawn of a film with planes of symmetry
    #[arg(long, value_parser = choice(&PARTS), default_value = "whole")]
    pub part: Part,
    /// Simulate the stored scenario again, for every snapshot, element and field instead of those on the page
    #[arg(long)]
    pub again: bool,
    /// Size, font, lines and resolution
    #[arg(long, value_parser = choice(&PRESETS), default_value = "slide")]
    pub style: Preset,
    /// Size in pixels: 1600x1000
    #[arg(long, value_name = "WxH", value_parser = size, conflicts_with_all = ["width", "height"])]
    pub size: Option<[u32; 2]>,
    /// Width on paper, such as 90mm
    #[arg(long, value_name = "LENGTH", value_parser = length)]
    pub width: Option<f64>,
    /// Height on paper, such as 60mm
    #[arg(long, value_name = "LENGTH", value_parser = length)]
    pub height: Option<f64>,
    /// Font family, such as "Times New Roman"; of a PNG Arial
    #[arg(long, value_name = "FAMILY", value_parser = family)]
    pub font: Option<String>,
    /// Font size, such as 8pt
    #[arg(long, value_name = "SIZE", value_parser = points)]
    pub font_size: Option<f64>,
    /// Width of curves, such as 0.75pt
    #[arg(long, value_name = "WIDTH", value_parser = points)]
    pub line_width: Option<f64>,
    /// Pixels per inch of a PNG, and of the scene in an SVG
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(20..=2400))]
    pub dpi: Option<u16>,
    /// Heading; "" for none [default: that of the page; in columns of a journal none]
    #[arg(long, value_name = "TEXT")]
    pub title: Option<String>,
    /// Replace a file that exists
    #[arg(long)]
    pub force: bool,
}

/// The parts of a film with planes of symmetry that may be drawn, by word.
const PARTS: [Choice<Part>; 3] = [
    ("whole", "The whole film", Part::Whole),
    ("half", "The half behind a plane of symmetry", Part::Half),
    ("computed", "What was computed", Part::Computed),
];

fn ends(text: &str) -> Result<[f32; 2], String> {
    let number = |text: &str| text.trim().parse::<f32>().ok().filter(|number| number.is_finite());
    let ends = text.split_once("..").and_then(|(from, to)| Some([number(from)?, number(to)?]));
    match ends {
        Some([from, to]) if from < to => Ok([from, to]),
        _ => Err(format!("expected two ascending numbers in the unit of the field, such as 0..40, found \"{text}\"")),
    }
}

fn size(text: &str) -> Result<[u32; 2], String> {
    let pixels = |text: &str| text.trim().parse::<u32>().ok().filter(|pixels| (16..=32_000).contains(pixels));
    let size = text.split_once(['x', '×']).and_then(|(width, height)| Some([pixels(width)?, pixels(height)?]));
    size.ok_or_else(|| format!("expected width and height in pixels, such as 1600x1000, found \"{text}\""))
}

fn length(text: &str) -> Result<f64, String> {
    let length = quantity(Length::DIMENSION, text)?;
    let is_paper = (0.01..=5.0).contains(&length);
    if is_paper { Ok(length) } else { Err("a picture is 10 mm to 5 m wide and high".into()) }
}

fn points(text: &str) -> Result<f64, String> {
    let number = text.trim().trim_end_matches("pt").trim().parse::<f64>().ok();
    let points = number.filter(|points| (0.05..=200.0).contains(points));
    points.ok_or_else(|| format!("expected points, such as 8pt, found \"{text}\""))
}

fn family(text: &str) -> Result<String, String> {
    let is_plain = |letter: char| letter.is_alphanumeric() || " -,_".contains(letter);
    let is_family = !text.trim().is_empty() && text.len() <= 200 && text.chars().all(is_plain);
    if is_family { Ok(text.to_owned()) } else { Err(format!("expected font families, found \"{text}\"")) }
}

/// Size, font, lines and resolution for a purpose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Preset {
    /// m.
    width: f64,
    /// Size of the font, pt.
    font_size: f64,
    /// Width of curves, pt.
    line: f64,
    /// Pixels per inch.
    dpi: f64,
    /// Height over width of a plot.
    plot: f64,
    /// Height over width of a scene.
    scene: f64,
    /// Whether the picture has a heading.
    has_title: bool,
}

const SLIDE: Preset =
    Preset { width: 0.2032, font_size: 12.0, line: 1.8, dpi: 200.0, plot: 0.625, scene: 0.625, has_title: true };
const SINGLE_COLUMN: Preset =
    Preset { width: 0.09, font_size: 8.0, line: 1.0, dpi: 600.0, plot: 0.66, scene: 0.75, has_title: false };
const DOUBLE_COLUMN: Preset = Preset { width: 0.19, plot: 0.4, scene: 0.5, ..SINGLE_COLUMN };

/// The presets by word.
const PRESETS: [Choice<Preset>; 3] = [
    ("slide", "1600 x 1000 pixels, a font of 12 pt, with a heading", SLIDE),
    ("single-column", "One column of a journal: 90 mm wide, a font of 8 pt, 600 dpi, no heading", SINGLE_COLUMN),
    ("double-column", "Both columns of a journal: 190 mm wide, a font of 8 pt, 600 dpi, no heading", DOUBLE_COLUMN),
];

impl PictureArgs {
    /// Whether a preset is asked for.
    pub(crate) fn has_preset(&self) -> bool {
        self.style != SLIDE
    }
}

/// Letters where no other are asked for: Arimo has the widths of Arial.
const FAMILY: &str = "Arial, Helvetica, Arimo, sans-serif";

/// The style that the arguments ask for, and its dpi.
///
/// # Errors
/// A PNG in a font that it does not have.
pub(crate) fn from_args(args: &PictureArgs, format: Format) -> Result<(Style, f64), Diagnostic> {
    let Preset { width, font_size, line, dpi, plot, scene, has_title } = args.style;
    let dpi = args.dpi.map_or(dpi, f64::from);
    let proportion = if args.plot.is_some() { plot } else { scene };
    let [width, height] = match args.size {
        Some(pixels) => pixels.map(|side| Style::of_pixels(side, dpi)),
        None => {
            let width = args.width.unwrap_or(width);
            [width, args.height.unwrap_or(proportion * width)].map(Style::points)
        }
    };
    let has_title = args.title.as_deref().map_or(has_title, |title| !title.is_empty());
    let family = args.font.clone().unwrap_or_else(|| FAMILY.to_owned());
    if format == Format::Png && !is_in_png(&family) {
        let mistake = Diagnostic::new(format!("a PNG has no font of the family {family}"));
        return Err(mistake.hint(format!("a PNG has {}; an SVG names any family", FAMILIES.join(", "))));
    }
    let font_size = args.font_size.unwrap_or(font_size);
    let style = Style { width, height, letters: font_size, family, line: args.line_width.unwrap_or(line), has_title };
    let [across, down] = [width / font_size, height / font_size];
    if across < 14.0 || down < 9.0 {
        let mistake = Diagnostic::new(format!("a font of {font_size} pt leaves no room for the picture"));
        return Err(mistake.hint("make the picture larger, or its font smaller: --font-size"));
    }
    Ok((style, dpi))
}

fn is_in_png(family: &str) -> bool {
    family.split(',').any(|name| FAMILIES.iter().any(|known| known.eq_ignore_ascii_case(name.trim())))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_ranges_and_letters_are_read_and_mistakes_named() {
        assert_eq!(ends("-2..40.5"), Ok([-2.0, 40.5]));
        assert_eq!(size("1600x1000"), Ok([1600, 1000]));
        assert_eq!((length("90mm"), points("8 pt"), points("0.75")), (Ok(0.09), Ok(8.0), Ok(0.75)));
        assert!(family("Times New Roman, serif").is_ok());
        for mistake in [ends("40..0").err(), ends("1..inf").err(), ends("5").err()] {
            assert!(mistake.is_some_and(|text| text.starts_with("expected two ascending numbers")));
        }
        for mistake in [size("1600").err(), size("0x10").err(), size("9e9x9").err()] {
            assert!(mistake.is_some_and(|text| text.starts_with("expected width and height in pixels")));
        }
        assert!(length("9").is_err() && length("1 um").is_err() && points("0pt").is_err());
        assert!(family("\"><script>").is_err() && family(" ").is_err());
    }
}
