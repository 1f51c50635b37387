//! Pages read back: their plots, and of the page of a run its film.
//!
//! A page holds what its scripts draw as blocks of JSON. They are the same for runs, studies, sweeps and comparisons, so
//! that one reader serves them all.

use std::path::{Path, PathBuf};

use serde::Deserialize;
use serde_json::Value;
use thiserror::Error;

use super::drawn::PLOT;
use super::film::{self, FilmError};
use super::html;
use super::run_scene::RunScene;
use base::file::{self, FileError};
use plot::{Axis, Curve, Look, Mark, Plot, Scale, Window};
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

/// Why a page cannot be read back.
#[derive(Debug, Error)]
pub enum StoredPageError {
    /// The path names nothing.
    #[error("there is no {}", path.display())]
    Missing {
        /// Path, as it is given.
        path: PathBuf,
    },
    /// The folder has no page.
    #[error("{} holds no report.html", path.display())]
    NoPage {
        /// The folder.
        path: PathBuf,
    },
    /// The file cannot be read.
    #[error("{}: {source}", path.display())]
    Unreadable {
        /// The page.
        path: PathBuf,
        /// Why it cannot be read.
        source: FileError,
    },
    /// It is another file, or a page of another version.
    #[error("{} is not a page of droptower", path.display())]
    NotAPage {
        /// The file.
        path: PathBuf,
    },
    /// A plot was changed.
    #[error("{}: the plot \"{title}\" is damaged: {source}", path.display())]
    Plot {
        /// The page.
        path: PathBuf,
        /// Heading of the plot.
        title: String,
        /// The first error in its data.
        source: serde_json::Error,
    },
    /// The page is not that of a run, or its run took no snapshot.
    #[error("{} has no film in 3-D", path.display())]
    NoFilm {
        /// The page.
        path: PathBuf,
    },
    /// The film was changed.
    #[error("{}: the film is damaged: {source}", path.display())]
    Film {
        /// The page.
        path: PathBuf,
        /// The fault in it.
        source: FilmError,
    },
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
            Err(FileError::NotFound) if place.is_dir() => Err(StoredPageError::NoPage { path: place.into() }),
            Err(FileError::NotFound) => Err(StoredPageError::Missing { path }),
            Err(source) => Err(StoredPageError::Unreadable { path, source }),
        }
    }

    fn parse(path: PathBuf, text: &str) -> Result<StoredPage, StoredPageError> {
        let Some((_, title)) = between(text, "<title>", "</title>").filter(|_| text.contains("<footer>droptower "))
        else {
            return Err(StoredPageError::NotAPage { path });
        };
        let figures = text.split("<figure class=\"").skip(1);
        let is_plot = |figure: &&str| figure.strip_prefix(PLOT).is_some_and(|rest| rest.starts_with("\">"));
        let plots = figures.filter(is_plot).filter_map(titled_block).map(|(title, block)| {
            let plot = |block: &str| Ok(PlotData::deserialize(&serde_json::from_str::<Value>(block)?)?.plot(&title));
            plot(block).map_err(|source| StoredPageError::Plot { path: path.clone(), title: title.clone(), source })
        });
        let plots = plots.collect::<Result<_, _>>()?;
        let film = text.split_once("<figure class=\"film\">").and_then(|(_, rest)| html::block(rest));
        let film = film.map(serde_json::from_str).transpose();
        let film = film.map_err(|error| StoredPageError::Film { path: path.clone(), source: error.into() })?;
        Ok(StoredPage { title: html::unescape(title), plots, path, film })
    }

    /// The film in 3-D: the states that the page holds, coarsened where the mesh is fine, with strains to a 254th of their
    /// range and positions to a 65 535th of the extent.
    ///
    /// # Errors
    /// There is none, or it is damaged.
    pub fn scene(&self) -> Result<RunScene, StoredPageError> {
        let film = self.film.as_ref().ok_or_else(|| StoredPageError::NoFilm { path: self.path.clone() })?;
        film::scene(film).map_err(|source| StoredPageError::Film { path: self.path.clone(), source })
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

#[derive(Deserialize)]
struct PlotData {
    x: AxisData,
    y: AxisData,
    window: Option<WindowData>,
    #[serde(default)]
    marks: Vec<MarkData>,
    curves: Vec<CurveData>,
}

#[derive(Deserialize)]
struct AxisData {
    words: String,
    log: bool,
}

#[derive(Deserialize)]
struct WindowData {
    words: String,
    range: [f64; 2],
}

#[derive(Deserialize)]
struct MarkData {
    words: String,
    at: f64,
}

#[derive(Deserialize)]
struct CurveData {
    name: String,
    look: LookData,
    x: Abscissae,
    y: Vec<Option<f64>>,
}

#[derive(Deserialize)]
#[serde(rename_all = "kebab-case")]
enum LookData {
    Line,
    Dashed,
    Points,
}

/// Abscissae of the curve, or the index of an earlier one that has the same.
#[derive(Deserialize)]
#[serde(untagged)]
enum Abscissae {
    Own(Vec<Option<f64>>),
    Of(usize),
}

impl PlotData {
    fn plot(self, title: &str) -> Plot {
        let axis = |AxisData { words, log }: AxisData| Axis {
            label: words,
            scale: if log { Scale::Logarithmic } else { Scale::Linear },
        };
        let abscissae: Vec<&[Option<f64>]> = self.curves.iter().fold(vec![], |mut known, curve| {
            let own = match &curve.x {
                Abscissae::Own(own) => own.as_slice(),
                Abscissae::Of(earlier) => known.get(*earlier).copied().unwrap_or_default(),
            };
            known.push(own);
            known
        });
        let value = |value: &Option<f64>| value.unwrap_or(f64::NAN);
        let curve = |(CurveData { name, look, y, .. }, x): (&CurveData, &[Option<f64>])| Curve {
            name: name.clone(),
            points: x.iter().zip(y).map(|(x, y)| [value(x), value(y)]).collect(),
            look: match look {
                LookData::Line => Look::Line,
                LookData::Dashed => Look::Dashed,
                LookData::Points => Look::Points,
            },
        };
        let curves = self.curves.iter().zip(abscissae).map(curve).collect();
        let window = self.window.map(|WindowData { words, range }| Window { label: words, range });
        let marks = self.marks.into_iter().map(|MarkData { words, at }| Mark { label: words, at }).collect();
        Plot { title: title.to_owned(), x: axis(self.x), y: axis(self.y), curves, window, marks }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drawn;

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
        assert!(matches!(stored("<title>other</title>"), Err(StoredPageError::NotAPage { .. })));
        let page = |body: &str| html::page("t", &format!("{body}<footer>droptower 1</footer>"));
        assert!(matches!(stored(&page("")).expect("a page").scene(), Err(StoredPageError::NoFilm { .. })));
        let block = |class: &str, data: &str| {
            let data = format!("<script type=\"application/json\">{data}</script>");
            page(&format!("<figure class=\"{class}\"><h3>p</h3>{data}</figure>"))
        };
        assert!(matches!(stored(&block("plot", "{}")), Err(StoredPageError::Plot { .. })));
        assert!(matches!(stored(&block("film", "{")), Err(StoredPageError::Film { .. })));
        assert!(matches!(stored(&block("film", "{}")).expect("a page").scene(), Err(StoredPageError::Film { .. })));
        let missing = StoredPage::read(Path::new("nowhere")).expect_err("nothing there");
        assert_eq!(missing.to_string(), "there is no nowhere");
    }
}
