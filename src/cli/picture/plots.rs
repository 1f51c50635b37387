//! A plot of a page as a picture.

use serde_json::{Map, json};

use super::args::PictureArgs;
use super::words::{find, name_of};
use super::{Format, Made, refused, style, unknown};
use crate::Failure;
use base::diagnostic::Diagnostic;
use picture::Drawing;
use plot::Plot;
use report::StoredPage;

pub(super) fn draw(page: &StoredPage, name: &str, args: &PictureArgs, format: Format) -> Result<Made, Failure> {
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
