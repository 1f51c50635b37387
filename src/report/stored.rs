//! Pages read back: their plots, and of the page of a run its film.
//!
//! A page holds what its scripts draw as blocks of JSON. They are the same for runs, studies, sweeps and comparisons, so
//! that one reader serves them all.

use std::fmt::Display;
use std::path::{Path, PathBuf};

use serde::Deserialize;
use serde_json::Value;
use thiserror::Error;

use crate::drawn::{PLOT, PlotData};
use crate::film_data::FilmData;
use crate::{RunScene, html};
use base::file::{self, FileError};
use plot::Plot;
use study::store::run_files;

/// Longest page that is read, bytes.
const MOST_BYTES: u64 = 64 << 20;

/// The data of a page.
#[derive(Clone, Debug)]
pub struct StoredPage {
    /// Heading of the page.
    pub title: String,
    /// All plots, in the order of the page.
    pub plots: Vec<Plot>,
    path: PathBuf,
    film: Option<Value>,
}

/// Why a page or its film cannot be read back.
#[derive(Debug, Error)]
#[error("{message}")]
pub struct StoredPageError {
    message: String,
    /// What helps, where something does.
    pub hint: Option<&'static str>,
    /// Whether the page is whole, but not that of a run with snapshots.
    pub lacks_film: bool,
}

impl StoredPageError {
    fn new(message: String, hint: &'static str) -> StoredPageError {
        StoredPageError { message, hint: Some(hint), lacks_film: false }
    }

    /// A part of the page at `path` was changed, or written by another version.
    fn damaged(path: &Path, what: &str, error: &dyn Display) -> StoredPageError {
        let message = format!("{}: {what} is damaged: {error}", path.display());
        StoredPageError { message, hint: None, lacks_film: false }
    }
}

impl StoredPage {
    /// Reads the page of the results in a folder, or the page at a path.
    ///
    /// # Errors
    /// There is none, or it is damaged.
    pub fn read(place: &Path) -> Result<StoredPage, StoredPageError> {
        let path = if place.is_dir() { place.join(run_files::REPORT) } else { place.to_owned() };
        match file::read_text(&path, MOST_BYTES) {
            Ok(text) => StoredPage::parse(path, &text),
            Err(FileError::NotFound) if place.is_dir() => Err(StoredPageError::new(
                format!("{} holds no report.html", place.display()),
                "runs that cannot be measured have none",
            )),
            Err(FileError::NotFound) => Err(StoredPageError::new(
                format!("there is no {}", path.display()),
                "name the folder of a run, such as runs/drop/1008",
            )),
            Err(error) => {
                let message = format!("{}: {error}", path.display());
                Err(StoredPageError { message, hint: None, lacks_film: false })
            }
        }
    }

    fn parse(path: PathBuf, text: &str) -> Result<StoredPage, StoredPageError> {
        let Some((_, title)) = between(text, "<title>", "</title>").filter(|_| text.contains("<footer>droptower "))
        else {
            let message = format!("{} is not a page of droptower", path.display());
            return Err(StoredPageError::new(message, "name the folder of results, or its report.html"));
        };
        let figures = text.split("<figure class=\"").skip(1);
        let is_plot = |figure: &&str| figure.strip_prefix(PLOT).is_some_and(|rest| rest.starts_with("\">"));
        let plots = figures.filter(is_plot).filter_map(titled_block).map(|(title, block)| {
            let plot = |block: &str| Ok(PlotData::deserialize(&serde_json::from_str::<Value>(block)?)?.plot(&title));
            let damaged =
                |error: serde_json::Error| StoredPageError::damaged(&path, &format!("the plot \"{title}\""), &error);
            plot(block).map_err(damaged)
        });
        let plots = plots.collect::<Result<_, _>>()?;
        let film = text.split_once("<figure class=\"film\">").and_then(|(_, rest)| html::block(rest));
        let film = film.map(serde_json::from_str).transpose();
        let film = film.map_err(|error: serde_json::Error| StoredPageError::damaged(&path, "the film", &error))?;
        Ok(StoredPage { title: html::unescape(title), plots, path, film })
    }

    /// The film in 3-D: the states that the page holds, coarsened where the mesh is fine, with strains to a 254th of their
    /// range and positions to a 65 535th of the extent.
    ///
    /// # Errors
    /// There is none, or it is damaged.
    pub fn scene(&self) -> Result<RunScene, StoredPageError> {
        let film = self.film.as_ref().ok_or_else(|| StoredPageError {
            lacks_film: true,
            ..StoredPageError::new(
                format!("{} has no film in 3-D", self.path.display()),
                "draw one of its plots: --plot NAME; without -o they are listed",
            )
        })?;
        let scene = FilmData::deserialize(film).map_err(|error| error.to_string()).and_then(FilmData::scene);
        scene.map_err(|error| StoredPageError::damaged(&self.path, "the film", &error))
    }
}

/// Title and data of a plot.
fn titled_block(figure: &str) -> Option<(String, &str)> {
    let (rest, title) = between(figure, "<h3>", "</h3>")?;
    Some((html::unescape(title), html::block(rest)?))
}

/// The text after and the text between the first of two marks.
fn between<'a>(text: &'a str, start: &str, end: &str) -> Option<(&'a str, &'a str)> {
    let (inner, rest) = text.split_once(start)?.1.split_once(end)?;
    Some((rest, inner))
}

#[cfg(test)]
mod tests {
    use crate::drawn;
    use plot::{Curve, Look, Mark, Scale, Window};

    use super::*;

    fn stored(text: &str) -> Result<StoredPage, StoredPageError> {
        StoredPage::parse("report.html".into(), text)
    }

    #[test]
    fn plots_are_read_as_they_were_written() {
        let shared = [[0.0, 1.0], [1.0, f64::NAN], [2.0, 3.5]];
        let curves = vec![
            Curve::line("a < b", shared),
            Curve::line("measured", [[0.0, 2.0], [1.0, 2.0], [2.0, 2.0]]).dashed(),
            Curve { look: Look::Points, ..Curve::line("points", [[7.0, 1e3]]) },
        ];
        let mut written = Plot::new("A & \"B\" 'c'", ["time (ms)", "force (N)"], curves);
        written.y.scale = Scale::Logarithmic;
        written.window = Some(Window { label: "loading".into(), range: [0.0, 1.5] });
        written.marks = vec![Mark { label: "contact".into(), at: 0.25 }];
        let page = html::page("T & t", &format!("{}<footer>droptower 1</footer>", drawn::figure(&written)));
        let StoredPage { title, plots, .. } = stored(&page).expect("a page");
        assert_eq!(title, "T & t");
        let [found] = plots.as_slice() else { panic!("one plot") };
        // NaN differs from itself.
        assert_eq!(format!("{found:?}"), format!("{written:?}"));
    }

    #[test]
    fn what_is_not_a_page_is_refused() {
        let refusal = |text: &str| stored(text).expect_err("a refusal").to_string();
        assert_eq!(refusal("<title>other</title>"), "report.html is not a page of droptower");
        let page = |body: &str| html::page("t", &format!("{body}<footer>droptower 1</footer>"));
        assert!(stored(&page("")).expect("a page").scene().expect_err("no film").lacks_film);
        let block = |class: &str, data: &str| {
            let data = format!("<script type=\"application/json\">{data}</script>");
            page(&format!("<figure class=\"{class}\"><h3>p</h3>{data}</figure>"))
        };
        assert!(refusal(&block("plot", "{}")).starts_with("report.html: the plot \"p\" is damaged: "));
        assert!(refusal(&block("film", "{")).starts_with("report.html: the film is damaged: "));
        let empty = stored(&block("film", "{}")).expect("a page").scene().expect_err("no film");
        assert!(!empty.lacks_film && empty.to_string().starts_with("report.html: the film is damaged: "));
        let missing = StoredPage::read(Path::new("nowhere")).expect_err("nothing there");
        assert_eq!(missing.to_string(), "there is no nowhere");
    }
}
