//! Pages read back: their plots, and of the page of a run its film.
//!
//! A page holds what its scripts draw as blocks of JSON. They are the same for runs, studies, sweeps and comparisons, so
//! that one reader serves them all.

use std::fmt::Display;
use std::path::{Path, PathBuf};

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde::Deserialize;
use serde_json::Value;
use thiserror::Error;

use crate::drawn::PLOT;
use crate::film::FAILED;
use crate::{Moment, RunScene, SceneBody, SceneFace, html};
use base::file::{self, FileError};
use plot::{Axis, Curve, Look, Mark, Plot, Scale, Window};
use scene::simulate::{FilmSpring, FilmState, Snapshot};
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
        film_scene(film).map_err(|error| StoredPageError::damaged(&self.path, "the film", &error))
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

#[derive(Deserialize)]
struct Data {
    #[serde(rename = "box")]
    ends: [[f32; 3]; 2],
    fibre: [f32; 2],
    shear: [f32; 2],
    faces: Vec<FaceData>,
    states: Vec<StateData>,
    moments: Vec<(String, f64)>,
    bodies: Vec<SceneBody>,
    #[serde(default)]
    coarsened: bool,
}

#[derive(Deserialize)]
struct FaceData {
    nodes: usize,
    patches: String,
    mirrored: [bool; 2],
    /// Ends of springs on the frame; their ends on the film are the last nodes.
    #[serde(default)]
    springs: Vec<[f32; 3]>,
}

#[derive(Deserialize)]
struct StateData {
    time: f64,
    places: String,
    strains: String,
    poses: Vec<[f64; 7]>,
}

/// Why the film of a page cannot be read: the page was changed, or written by another version.
type FilmFault = String;

/// Numbers of something that do not fit to those of another.
fn mismatch(what: &str) -> FilmFault {
    format!("{what} of the film do not fit together")
}

fn decoded(text: &str) -> Result<Vec<u8>, FilmFault> {
    STANDARD.decode(text).map_err(|error| error.to_string())
}

/// The scene in the data of a page's film.
///
/// # Errors
/// The data are not those that a page has.
pub(crate) fn film_scene(data: &Value) -> Result<RunScene, FilmFault> {
    let data = Data::deserialize(data).map_err(|error| error.to_string())?;
    let faces = data.faces.iter().map(face).collect::<Result<Vec<_>, _>>()?;
    for body in &data.bodies {
        check_corners(&body.patches, body.points.len())?;
    }
    let states = data.states.iter().map(|written| state(written, &data, &faces)).collect::<Result<Vec<_>, _>>()?;
    if states.is_empty() || !states.is_sorted_by(|a, b| a.time < b.time) {
        return Err(mismatch("times"));
    }
    let moments = data.moments.into_iter().map(|(words, time)| Moment { words, time: time * 1e-3 }).collect();
    Ok(RunScene { faces, bodies: data.bodies, states, moments, is_coarsened: data.coarsened })
}

fn face(FaceData { nodes, patches, mirrored, springs }: &FaceData) -> Result<SceneFace, FilmFault> {
    let bytes = decoded(patches)?;
    let (corners, []) = bytes.as_chunks::<4>() else { return Err(mismatch("patches")) };
    let corners: Vec<u32> = corners.iter().map(|corner| u32::from_le_bytes(*corner)).collect();
    let (patches, []) = corners.as_chunks::<4>() else { return Err(mismatch("patches")) };
    check_corners(patches, *nodes)?;
    let Some(first) = nodes.checked_sub(springs.len()) else { return Err(mismatch("springs")) };
    let spring = |(node, anchor): (usize, &[f32; 3])| {
        let node = u32::try_from(node).map_err(|_| mismatch("springs"))?;
        Ok(FilmSpring { anchor: *anchor, nodes: [node; 2], shares: [1.0, 0.0] })
    };
    let springs = (first..).zip(springs).map(spring).collect::<Result<_, FilmFault>>()?;
    Ok(SceneFace { nodes: *nodes, patches: patches.to_vec(), mirrored: *mirrored, springs })
}

fn check_corners(patches: &[[u32; 4]], nodes: usize) -> Result<(), FilmFault> {
    let are_nodes = patches.iter().flatten().all(|corner| (*corner as usize) < nodes);
    if are_nodes { Ok(()) } else { Err(mismatch("corners and nodes")) }
}

fn state(written: &StateData, data: &Data, faces: &[SceneFace]) -> Result<Snapshot, FilmFault> {
    let [places, strains] = [decoded(&written.places)?, decoded(&written.strains)?];
    let (places, []) = places.as_chunks::<6>() else { return Err(mismatch("positions")) };
    let (strains, []) = strains.as_chunks::<3>() else { return Err(mismatch("strains")) };
    let count = |of: fn(&SceneFace) -> usize| faces.iter().map(of).try_fold(0_usize, usize::checked_add);
    if count(|face| face.nodes) != Some(places.len()) {
        return Err(mismatch("positions and nodes"));
    }
    if count(|face| face.patches.len()) != Some(strains.len()) {
        return Err(mismatch("strains and patches"));
    }
    if written.poses.len() != data.bodies.len() {
        return Err(mismatch("positions and bodies"));
    }
    let (mut places, mut strains) = (places, strains);
    let mut film = |face: &SceneFace| {
        let (own, rest) = places.split_at(face.nodes);
        let (of_patches, rest_of_patches) = strains.split_at(face.patches.len());
        (places, strains) = (rest, rest_of_patches);
        film(own, of_patches, data)
    };
    let films = faces.iter().map(&mut film).collect();
    let pose = |&[x, y, z, i, j, k, w]: &[f64; 7]| ([x, y, z], [i, j, k, w]);
    Ok(Snapshot { time: written.time * 1e-3, films, impactors: written.poses.iter().map(pose).collect() })
}

/// One face from the steps of its positions and strains.
fn film(places: &[[u8; 6]], strains: &[[u8; 3]], data: &Data) -> FilmState {
    let [low, high] = data.ends;
    let position = |steps: &[u8; 6]| {
        [0, 1, 2].map(|axis| {
            let step = u16::from_le_bytes([steps[2 * axis], steps[2 * axis + 1]]);
            low[axis] + f32::from(step) / f32::from(u16::MAX) * (high[axis] - low[axis])
        })
    };
    let ranges = [data.fibre, data.fibre, data.shear];
    let strain = |steps: &[u8; 3]| {
        [0, 1, 2].map(|part| {
            let [low, high] = ranges[part];
            low + f32::from(steps[part]) / f32::from(FAILED - 1) * (high - low)
        })
    };
    FilmState {
        positions: places.iter().map(position).collect(),
        strains: strains.iter().map(strain).collect(),
        failed: strains.iter().map(|steps| steps[0] == FAILED).collect(),
        ..FilmState::default()
    }
}

#[cfg(test)]
mod tests {
    use crate::drawn;

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
