//! `droptower picture`: the scene of a stored run, or a plot of its page, as a file for slides and papers.

mod args;
mod scene;

use std::path::Path;

use serde_json::{Map, Value, json};

use crate::{Failure, Shared, output, print_figures};
use base::diagnostic::{Diagnostic, shown_path};
use base::number::duration;
use picture::{Drawing, PictureError};
use plot::Plot;
use report::StoredPage;
use report::geometry::{Field, RunScene};

pub(super) use crate::picture::args::PictureArgs;

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

pub(crate) fn run(args: &PictureArgs, shared: &Shared) -> Result<(), Failure> {
    let page = StoredPage::read(&args.run);
    let Some(out) = args.out.as_deref() else {
        return list(&page?, shared);
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
        ("--style", args.has_preset()),
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
    let (style, dpi) = args::from_args(args, format)?;
    let title = args.title.clone().unwrap_or_else(|| page.plots[at].title.clone());
    let plot = Plot { title, ..page.plots[at].clone() };
    let figures = Map::from_iter([("plot".to_owned(), json!(page.plots[at].title))]);
    let words = format!("{}: {}", page.title, page.plots[at].title);
    let made = Made::drawn(&Drawing::of_plot(&plot, &style, dpi), format, words, figures);
    Ok(made.map_err(|error| refused(&error))?)
}

/// The title in small letters, its words joined by hyphens.
pub(crate) fn name_of(title: &str) -> String {
    let letters = title.chars().map(|letter| if letter.is_alphanumeric() { letter } else { ' ' });
    let words = letters.flat_map(char::to_lowercase).collect::<String>();
    words.split_whitespace().collect::<Vec<_>>().join("-")
}

/// The index of the title that is named: itself, else the first that begins with it, else the only one that holds it.
pub(crate) fn find<'a>(written: &str, titles: impl Iterator<Item = &'a str>) -> Option<usize> {
    let written = name_of(written);
    let names: Vec<String> = titles.map(name_of).collect();
    if written.is_empty() {
        return None;
    }
    let place = |is: &dyn Fn(&str) -> bool| names.iter().position(|name| is(name));
    let holds = |name: &&String| name.contains(&written);
    place(&|name| name == written).or_else(|| place(&|name| name.starts_with(&written))).or_else(|| {
        let is_only = names.iter().filter(holds).count() == 1;
        names.iter().position(|name| is_only && holds(&name))
    })
}

/// Prints what of a page can be drawn.
pub(crate) fn list(page: &StoredPage, shared: &Shared) -> Result<(), Failure> {
    let scene = if page.has_film() { Some(page.scene()?) } else { None };
    let plots: Vec<String> = page.plots.iter().map(|plot| name_of(&plot.title)).collect();
    let scene = scene.as_ref();
    let moments = || scene.into_iter().flat_map(|scene| &scene.moments);
    let figures = json!({
        "title": page.title,
        "plots": plots,
        "states_s": scene.map(|scene| scene.states.iter().map(|state| state.time).collect::<Vec<_>>()),
        "moments_s": moments().map(|moment| (name_of(&moment.words), moment.time)).collect::<Vec<_>>(),
        "fields": scene.map(|scene| fields(scene).collect::<Vec<_>>()),
    });
    print_figures(shared, &figures, || {
        let mut lines = vec![page.title.clone()];
        if let Some(scene) = scene {
            let [first, last] = [&scene.states[0], &scene.states[scene.states.len() - 1]];
            let (from, to) = (duration(first.time), duration(last.time));
            lines.push(format!("  --at     {} states from {from} to {to}", scene.states.len()));
            lines.extend(
                moments().map(|moment| format!("           {} ({})", name_of(&moment.words), duration(moment.time))),
            );
            lines.push(format!("  --field  {}", fields(scene).collect::<Vec<_>>().join(", ")));
        }
        let heads = std::iter::once("--plot").chain(std::iter::repeat("      "));
        lines.extend(heads.zip(&plots).map(|(head, plot)| format!("  {head}   {plot}")));
        lines.join("\n")
    })
}

fn fields(scene: &RunScene) -> impl Iterator<Item = &'static str> {
    Field::all_in(&scene.states[0].films).map(|field| field.key)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn titles_are_found_by_their_beginning() {
        let titles = [
            "Displacement of the impactor",
            "Acceleration of the impactor",
            "Acceleration before the filter",
            "E/σ: run 1",
        ];
        for (written, expected) in [
            ("acceleration", Some(1)),
            ("Acceleration before the filter", Some(2)),
            ("acceleration-before", Some(2)),
            ("displ", Some(0)),
            ("filter", Some(2)),
            ("e-σ-run-1", Some(3)),
            ("impactor", None),
            ("force", None),
            ("--", None),
        ] {
            assert_eq!(find(written, titles.iter().copied()), expected, "{written}");
        }
    }
}
