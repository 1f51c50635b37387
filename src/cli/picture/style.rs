//! How a picture is set: presets, and what the arguments change of them.

use super::Format;
use super::args::{PictureArgs, Preset, Values};
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
