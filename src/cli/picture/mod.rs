//! `droptower picture`: the scene of a stored run, or a plot of its page, as a file for slides and papers.

mod args;
mod scene;
mod style;
mod words;

use std::path::Path;

use serde_json::{Map, Value, json};

use self::args::Preset;
use self::words::{find, name_of};
use super::{Failure, Shared, output, print_figures};
use base::diagnostic::{Diagnostic, shown_path};
use picture::{Drawing, PictureError};
use plot::Plot;
use report::{StoredPage, StoredPageError};

pub(super) use self::args::PictureArgs;

/// A picture, and what is told of it.
struct Made {
    /// The bytes of the file.
    content: Vec<u8>,
    /// A description of the picture, on one line.
    words: String,
    figures: Map<String, Value>,
}

/// The format that the ending of a file names.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Format {
    Png,
    Svg,
    /// Binary glTF: the scene in 3-D.
    Glb,
}

pub(super) fn run(args: &PictureArgs, shared: &Shared) -> Result<(), Failure> {
    let page = StoredPage::read(&args.run).map_err(|error| unreadable(&error));
    let Some(out) = args.out.as_deref() else {
        return words::list(&page?, shared);
    };
    let format = format(out)?;
    if format == Format::Glb {
        check_options_of_surfaces(args)?;
    }
    output::check(out, format.ending(), None, Some(args.force))?;
    let Made { content, words, mut figures } = match &args.plot {
        Some(name) => draw_plots(&page?, name, args, format)?,
        None => scene::draw(page, args, format, shared)?,
    };
    output::write(out, |file| file.write_all(&content))?;
    figures.insert("out".into(), json!(shown_path(out)));
    print_figures(shared, &figures, || format!("{words}\n  {}", shown_path(out)))
}

impl Made {
    /// A flat picture.
    fn drawn(
        drawing: &Drawing,
        format: Format,
        words: String,
        mut figures: Map<String, Value>,
    ) -> Result<Made, PictureError> {
        let content = match format {
            Format::Png => drawing.png()?,
            Format::Svg | Format::Glb => drawing.svg()?.into_bytes(),
        };
        let [width, height] = drawing.pixels();
        figures.insert("pixels".into(), json!([width, height]));
        Ok(Made { content, words, figures })
    }
}

impl Format {
    fn ending(self) -> &'static str {
        match self {
            Format::Png => "png",
            Format::Svg => "svg",
            Format::Glb => "glb",
        }
    }
}

fn format(out: &Path) -> Result<Format, Diagnostic> {
    let named =
        [Format::Png, Format::Svg, Format::Glb].into_iter().find(|format| output::ends_in(out, format.ending()));
    named.ok_or_else(|| {
        let mistake = Diagnostic::new(format!("{} does not end in .png, .svg or .glb", shown_path(out)));
        mistake.hint("the ending names the format")
    })
}

/// Refuses what only a flat picture has.
fn check_options_of_surfaces(args: &PictureArgs) -> Result<(), Diagnostic> {
    let given = [
        ("--plot", args.plot.is_some()),
        ("--view", args.view.is_some()),
        ("--perspective", args.perspective),
        ("--style", args.style != Preset::default()),
        ("--size", args.size.is_some()),
        ("--width", args.width.is_some()),
        ("--height", args.height.is_some()),
        ("--font", args.font.is_some()),
        ("--font-size", args.font_size.is_some()),
        ("--line-width", args.line_width.is_some()),
        ("--dpi", args.dpi.is_some()),
    ];
    match given.iter().find(|(_, is_given)| *is_given) {
        Some((option, _)) => {
            let mistake = Diagnostic::new(format!("a .glb is a scene in 3-D, which has no {option}"));
            Err(mistake.hint("leave it out, or write a .png or .svg"))
        }
        None => Ok(()),
    }
}

fn unreadable(error: &StoredPageError) -> Diagnostic {
    let mistake = Diagnostic::new(error.to_string());
    match error {
        StoredPageError::Missing { .. } => mistake.hint("name the folder of a run, such as runs/drop/1008"),
        StoredPageError::NoPage { .. } => mistake.hint("runs that cannot be measured have none"),
        StoredPageError::NotAPage { .. } => mistake.hint("name the folder of results, or its report.html"),
        StoredPageError::NoFilm { .. } => {
            mistake.hint("draw one of its plots: --plot NAME; without -o they are listed")
        }
        StoredPageError::Unreadable { .. } | StoredPageError::Plot { .. } | StoredPageError::Film { .. } => mistake,
    }
}

fn refused(error: &PictureError) -> Diagnostic {
    let mistake = Diagnostic::new(error.to_string());
    match error {
        PictureError::Size { .. } => mistake.hint("change --size, --width, --height or --dpi"),
        _ => mistake,
    }
}

/// A word among those that are known is missing.
fn unknown<'a>(what: &str, written: &str, known: impl IntoIterator<Item = &'a str> + Clone) -> Diagnostic {
    let mistake = Diagnostic::new(format!("there is no {what} `{}`", base::diagnostic::printable(written)));
    let all = known.clone().into_iter().collect::<Vec<_>>().join(", ");
    match base::diagnostic::closest(written, known) {
        Some(close) => mistake.hint(format!("did you mean `{close}`? There are {all}")),
        None => mistake.hint(format!("there are {all}")),
    }
}

/// A plot of the page.
fn draw_plots(page: &StoredPage, name: &str, args: &PictureArgs, format: Format) -> Result<Made, Failure> {
    if page.plots.is_empty() {
        return Err(Diagnostic::new("the page has no plots").into());
    }
    let Some(at) = find(name, page.plots.iter().map(|plot| plot.title.as_str())) else {
        let names: Vec<String> = page.plots.iter().map(|plot| name_of(&plot.title)).collect();
        return Err(unknown("plot", name, names.iter().map(String::as_str)).into());
    };
    let (style, dpi) = style::from_args(args, format)?;
    let title = args.title.clone().unwrap_or_else(|| page.plots[at].title.clone());
    let plot = Plot { title, ..page.plots[at].clone() };
    let figures = Map::from_iter([("plot".to_owned(), json!(page.plots[at].title))]);
    let words = format!("{}: {}", page.title, page.plots[at].title);
    let made = Made::drawn(&Drawing::of_plot(&plot, &style, dpi), format, words, figures);
    Ok(made.map_err(|error| refused(&error))?)
}
