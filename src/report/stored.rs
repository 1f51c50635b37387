//! Pages read back: their plots, and of the page of a run its film.
//!
//! A page holds what its scripts draw as blocks of JSON. They are the same for runs, studies, sweeps and comparisons, so
//! that one reader serves them all.

use std::fmt::Display;
use std::path::{Path, PathBuf};

use serde::Deserialize;
use serde_json::Value;

use crate::drawn::{PLOT, PlotData};
use crate::film_data::FilmData;
use crate::geometry::RunScene;
use crate::html;
use base::diagnostic::Diagnostic;
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

/// A part of the page at `path` was changed, or written by another version.
fn damaged(path: &Path, what: &str, error: &dyn Display) -> Diagnostic {
    Diagnostic::new(format!("{}: {what} is damaged: {error}", path.display()))
}

impl StoredPage {
    /// Reads the page of the results in a folder, or the page at a path.
    ///
    /// # Errors
    /// There is none, or it is damaged.
    pub fn read(place: &Path) -> Result<StoredPage, Diagnostic> {
        let path = if place.is_dir() { place.join(run_files::REPORT) } else { place.to_owned() };
        match file::read_text(&path, MOST_BYTES) {
            Ok(text) => StoredPage::parse(path, &text),
            Err(FileError::NotFound) if place.is_dir() => {
                Err(Diagnostic::new(format!("{} holds no report.html", place.display()))
                    .hint("runs that cannot be measured have none"))
            }
            Err(FileError::NotFound) => Err(Diagnostic::new(format!("there is no {}", path.display()))
                .hint("name the folder of a run, such as runs/drop/1008")),
            Err(error) => Err(Diagnostic::new(format!("{}: {error}", path.display()))),
        }
    }

    fn parse(path: PathBuf, text: &str) -> Result<StoredPage, Diagnostic> {
        let Some((_, title)) = between(text, "<title>", "</title>").filter(|_| text.contains("<footer>droptower "))
        else {
            let mistake = Diagnostic::new(format!("{} is not a page of droptower", path.display()));
            return Err(mistake.hint("name the folder of results, or its report.html"));
        };
        let figures = text.split("<figure class=\"").skip(1);
        let is_plot = |figure: &&str| figure.strip_prefix(PLOT).is_some_and(|rest| rest.starts_with("\">"));
        let plots = figures.filter(is_plot).filter_map(titled_block).map(|(title, block)| {
            let data = serde_json::from_str::<Value>(block).and_then(PlotData::deserialize);
            let data = data.map_err(|error| damaged(&path, &format!("the plot \"{title}\""), &error))?;
            Ok(data.plot(&title))
        });
        let plots = plots.collect::<Result<_, _>>()?;
        let film = text.split_once("<figure class=\"film\">").and_then(|(_, rest)| html::block(rest));
        let film = film.map(serde_json::from_str).transpose();
        let film = film.map_err(|error| damaged(&path, "the film", &error))?;
        Ok(StoredPage { title: html::unescape(title), plots, path, film })
    }

    /// Whether it is that of a run with snapshots.
    pub fn has_film(&self) -> bool {
        self.film.is_some()
    }

    /// The film in 3-D: the states that the page holds, coarsened where the mesh is fine, with strains to a 254th of their
    /// range and positions to a 65 535th of the extent.
    ///
    /// # Errors
    /// There is none, or it is damaged.
    pub fn scene(&self) -> Result<RunScene, Diagnostic> {
        let film = self.film.as_ref().ok_or_else(|| {
            Diagnostic::new(format!("{} has no film in 3-D", self.path.display()))
                .hint("draw one of its plots: --plot NAME; without -o they are listed")
        })?;
        let scene = FilmData::deserialize(film).map_err(|error| error.to_string()).and_then(FilmData::scene);
        scene.map_err(|error| damaged(&self.path, "the film", &error))
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

    fn stored(text: &str) -> Result<StoredPage, Diagnostic> {
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
        let refusal = |text: &str| stored(text).expect_err("a refusal").message;
        assert_eq!(refusal("<title>other</title>"), "report.html is not a page of droptower");
        let page = |body: &str| html::page("t", &format!("{body}<footer>droptower 1</footer>"));
        assert!(!stored(&page("")).expect("a page").has_film());
        let block = |class: &str, data: &str| {
            let data = format!("<script type=\"application/json\">{data}</script>");
            page(&format!("<figure class=\"{class}\"><h3>p</h3>{data}</figure>"))
        };
        assert!(refusal(&block("plot", "{}")).starts_with("report.html: the plot \"p\" is damaged: "));
        assert!(refusal(&block("film", "{")).starts_with("report.html: the film is damaged: "));
        let empty = stored(&block("film", "{}")).expect("a page").scene().expect_err("no film");
        assert!(empty.message.starts_with("report.html: the film is damaged: "));
        let missing = StoredPage::read(Path::new("nowhere")).expect_err("nothing there");
        assert_eq!(missing.message, "there is no nowhere");
    }
}
