//! How a picture is set: presets, and what the arguments change of them.

use clap::ValueEnum;

use super::Format;
use super::args::PictureArgs;
use base::diagnostic::Diagnostic;
use picture::FAMILIES;
use plot::Style;

/// Letters where no other are asked for: Arimo has the widths of Arial.
const FAMILY: &str = "Arial, Helvetica, Arimo, sans-serif";

/// The style that the arguments ask for, and its dpi.
///
/// # Errors
/// A PNG in a font that it does not have.
pub(super) fn from_args(args: &PictureArgs, format: Format) -> Result<(Style, f64), Diagnostic> {
    let Values { width, font_size, line, dpi, plot, scene } = args.style.values();
    let dpi = args.dpi.map_or(dpi, f64::from);
    let proportion = if args.plot.is_some() { plot } else { scene };
    let [width, height] = match args.size {
        Some(pixels) => pixels.map(|side| Style::of_pixels(side, dpi)),
        None => {
            let width = args.width.unwrap_or(width);
            [width, args.height.unwrap_or(proportion * width)].map(Style::points)
        }
    };
    let has_title = match args.title.as_deref() {
        Some(title) => !title.is_empty(),
        None => args.style == Preset::Slide,
    };
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

/// Size, font, lines and resolution for a purpose.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum Preset {
    /// 1600 x 1000 pixels, a font of 12 pt, with a heading
    #[default]
    Slide,
    /// One column of a journal: 90 mm wide, a font of 8 pt, 600 dpi, no heading
    SingleColumn,
    /// Both columns of a journal: 190 mm wide, a font of 8 pt, 600 dpi, no heading
    DoubleColumn,
}

/// The values of a preset.
pub(super) struct Values {
    /// m.
    pub(super) width: f64,
    /// Size of the font, pt.
    pub(super) font_size: f64,
    /// Width of curves, pt.
    pub(super) line: f64,
    /// Pixels per inch.
    pub(super) dpi: f64,
    /// Height over width of a plot.
    pub(super) plot: f64,
    /// Height over width of a scene.
    pub(super) scene: f64,
}

impl Preset {
    pub(super) fn values(self) -> Values {
        match self {
            Preset::Slide => {
                Values { width: 0.2032, font_size: 12.0, line: 1.8, dpi: 200.0, plot: 0.625, scene: 0.625 }
            }
            Preset::SingleColumn => {
                Values { width: 0.09, font_size: 8.0, line: 1.0, dpi: 600.0, plot: 0.66, scene: 0.75 }
            }
            Preset::DoubleColumn => {
                Values { width: 0.19, font_size: 8.0, line: 1.0, dpi: 600.0, plot: 0.4, scene: 0.5 }
            }
        }
    }
}
