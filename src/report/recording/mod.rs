//! Rerun recordings of runs: film, impactors, signals, events.

mod live;
mod signals;
mod text;

use std::path::Path;
use std::time::Duration;

use crate::film::is_finite;
use crate::run_scene::{Field, SceneBody};
use crate::{RunPage, figure};
use base::number::significant;
use membrane::engine::Surface;
use plot::Plot;
use plot::viridis::viridis;
use scene::model::Model;
use scene::simulate::{Film, FilmSpring, Image, Snapshot};
use study::field_comparison::FieldComparison;
use study::script::ScriptOutput;
use viz::{
    self, BodyTrack, Diagram, Document, Extent, FilmSnapshot, FilmTrack, PointState, PointTrack, Pose, Quantity, Scene,
    SpringTrack, Stage, VizError,
};

pub use crate::recording::live::{Live, LiveError};
pub use viz::Address;

/// Longest time that a file may take to be written.
const WRITE_TIMEOUT: Duration = Duration::from_secs(600);

/// Writes the recording of a run to `path`, snapshot by snapshot.
///
/// # Errors
/// The file cannot be written.
pub fn write(path: &Path, run: &RunPage) -> Result<(), VizError> {
    let outcome = run.outcome;
    let snapshots = drawn(&outcome.snapshots);
    let mut stage = Stage::file(path, scene(run, &snapshots))?;
    // One face after the other: consecutive snapshots of one entity compress better.
    for (face, film) in outcome.films.iter().enumerate() {
        for snapshot in &snapshots {
            stage.film(face, &film_state(film, snapshot, face))?;
        }
    }
    stage.finish(WRITE_TIMEOUT)
}

/// The scene without the snapshots of the films, which are logged one by one.
fn scene(run: &RunPage, snapshots: &[&Snapshot]) -> Scene {
    let RunPage { model, outcome, results, .. } = run;
    let signals = signals::charted(&results.signals, &outcome.energies, results.comparison.as_ref(), model.run_time());
    Scene {
        name: model.name.clone(),
        is_live: false,
        extent: film_extent(&outcome.films, &ends(snapshots, run.failure.is_some())),
        duration: model.run_time(),
        documents: documents(run),
        quantities: quantities(snapshots),
        films: film_tracks(&outcome.films),
        bodies: body_tracks(model, &outcome.impactors, snapshots),
        points: point_tracks(results.field.as_deref()),
        signals: signals.tracks,
        charts: signals.charts,
        more_charts: signals.more_charts,
        diagrams: diagrams(&results.script_output),
        events: text::listed(run),
    }
}

/// The snapshots that can be drawn: those of finite positions.
fn drawn(snapshots: &[Snapshot]) -> Vec<&Snapshot> {
    snapshots.iter().filter(|snapshot| is_finite(snapshot)).collect()
}

/// The snapshots that have to be in view: the first and, unless the run failed, the last.
fn ends<'a>(snapshots: &[&'a Snapshot], failed: bool) -> Vec<&'a Snapshot> {
    let last = snapshots.last().filter(|_| !failed);
    snapshots.first().into_iter().chain(last).copied().collect()
}

/// Title of the text that a run opens with.
const SUMMARY: &str = "Summary";

fn scenario(content: &str) -> Document {
    text::document("Scenario", text::verbatim(content))
}

/// Summary, tables and files of the post script, and the scenario.
fn documents(run: &RunPage) -> Vec<Document> {
    let RunPage { model, results, .. } = run;
    let findings = results.findings.iter();
    let warnings: String =
        findings.map(|found| format!("- {} \\[{}\\]\n", text::escaped(&found.message), found.code)).collect();
    let figures = figure::markdown(&results.summary(model));
    let field = results.field.as_deref().map_or(String::new(), |field| {
        let largest = significant(error_range(field) * 1e3, 3);
        format!(
            "Points are those of the field, moved as measured; their colours are errors from 0 to {largest} mm.\n\n"
        )
    });
    let summary = format!(
        "# {}\n\n{}\n\n{field}{warnings}\n{figures}",
        text::escaped(&model.title),
        text::escaped(&model.subject())
    );
    let output = &results.script_output;
    let written = text::tables(output).into_iter().chain(text::files(output));
    [text::document(SUMMARY, summary)].into_iter().chain(written).chain([scenario(run.scenario)]).collect()
}

/// The quantities, with a range from zero to the largest of an intact element in any of `snapshots`.
pub(crate) fn quantities(snapshots: &[&Snapshot]) -> Vec<Quantity> {
    let films = snapshots.first().map_or(&[][..], |snapshot| &snapshot.films);
    let quantity = |Field { key, title, symbol, unit, .. }: &Field, range| Quantity {
        key,
        title: (*title).to_owned(),
        words: format!("{symbol}, {unit}"),
        range,
    };
    let states = || snapshots.iter().flat_map(|snapshot| &snapshot.films);
    Field::all_in(films).map(|field| quantity(field, field.range(states()))).collect()
}

/// All faces.
pub(crate) fn film_tracks(films: &[Film]) -> Vec<FilmTrack> {
    films.iter().enumerate().map(|(face, film)| track(film, face)).collect()
}

/// Bounds of the faces in all of `snapshots`.
pub(crate) fn film_extent(films: &[Film], snapshots: &[&Snapshot]) -> Extent {
    let faces = films.iter().enumerate().map(|(face, film)| (face, film, track(film, face)));
    faces.fold(Extent::default(), |extent, (face, film, track)| {
        snapshots.iter().fold(extent, |extent, snapshot| extent.with(&track, &film_state(film, snapshot, face)))
    })
}

fn track(film: &Film, face: usize) -> FilmTrack {
    FilmTrack {
        name: format!("face-{}", face + 1),
        nodes: film.nodes,
        patches: film.outlines().collect(),
        held: film.held.clone(),
        springs: film.springs.iter().map(spring).collect(),
        images: film.images().skip(1).map(Image::signs).collect(),
    }
}

fn spring(FilmSpring { anchor, nodes, shares }: &FilmSpring) -> SpringTrack {
    SpringTrack { anchor: *anchor, nodes: *nodes, shares: *shares }
}

/// One face in a snapshot.
pub(crate) fn film_state(film: &Film, snapshot: &Snapshot, face: usize) -> FilmSnapshot {
    let state = &snapshot.films[face];
    FilmSnapshot {
        time: snapshot.time,
        positions: state.positions.clone(),
        values: Field::all_in(&snapshot.films)
            .map(|field| field.at_nodes(film.nodes, film.outlines(), state))
            .collect(),
        visible: state.failed.iter().map(|failed| !failed).collect(),
        in_contact: state.in_contact.clone(),
    }
}

/// Sides of a round impactor.
const SIDES: u32 = 64;

/// The impactors of `model` in the snapshots, and the bars of its frame.
pub(crate) fn body_tracks(model: &Model, impactors: &[Surface], snapshots: &[&Snapshot]) -> Vec<BodyTrack> {
    let track = |(index, (surface, name)): (usize, (&Surface, Option<&str>))| {
        let SceneBody { points, patches } = SceneBody::from_surface(surface, SIDES);
        let poses = snapshots.iter().filter_map(|snapshot| poses(snapshot).nth(index)).collect();
        let name = name.map_or_else(|| "impactor".to_owned(), |name| format!("impactors/{name}"));
        BodyTrack { name, points, patches, poses }
    };
    let bars = model.frame.bars.map(|_| Some("frame"));
    let mut tracks: Vec<BodyTrack> =
        impactors.iter().zip(model.names().into_iter().chain(bars)).enumerate().map(track).collect();
    if let Some(frame) = tracks.last_mut().filter(|_| bars.is_some()) {
        frame.name = "frame".to_owned();
    }
    tracks
}

/// The poses of the impactors in a snapshot.
pub(crate) fn poses(snapshot: &Snapshot) -> impl Iterator<Item = Pose> {
    snapshot.impactors.iter().map(|(position, rotation)| Pose {
        time: snapshot.time,
        position: position.map(|c| c as f32),
        rotation: rotation.map(|c| c as f32),
    })
}

/// Share of the points whose error lies within the range of colours.
const WITHIN: f64 = 0.99;
/// Radius of a point over the distance of points.
const RADIUS: f64 = 0.3;

/// The points on the film, moved as they were measured.
fn point_tracks(field: Option<&FieldComparison>) -> Vec<PointTrack> {
    let Some(field) = field else { return vec![] };
    let largest = error_range(field);
    let state = |state: &study::field_comparison::StateErrors| {
        let points = || state.points.iter().filter(|point| field.on_film[point.place as usize]);
        let position = |point: &study::field_comparison::PointError| {
            let place = field.places[point.place as usize];
            [0, 1, 2].map(|axis| (place[axis] + point.measured[axis]) as f32)
        };
        let colour = |point: &study::field_comparison::PointError| {
            viridis((point.size() / largest) as f32).map(|part| part.round() as u8)
        };
        PointState {
            time: state.time,
            positions: points().map(position).collect(),
            colours: points().map(colour).collect(),
        }
    };
    let states: Vec<PointState> = field.states.iter().map(state).collect();
    vec![PointTrack { name: "field".into(), radius: (RADIUS * apart(field)) as f32, states }]
}

/// The end of the range of colours, m.
fn error_range(field: &FieldComparison) -> f64 {
    let points = field.states.iter().flat_map(|state| &state.points);
    let mut sizes: Vec<f64> =
        points.filter(|point| field.on_film[point.place as usize]).map(|point| point.size()).collect();
    if sizes.is_empty() {
        return f64::MIN_POSITIVE;
    }
    let place = ((sizes.len() - 1) as f64 * WITHIN) as usize;
    (*sizes.select_nth_unstable_by(place, f64::total_cmp).1).max(f64::MIN_POSITIVE)
}

/// About the distance of points, m.
fn apart(field: &FieldComparison) -> f64 {
    let bound = |axis: usize, pick: fn(f64, f64) -> f64| field.places.iter().map(|place| place[axis]).reduce(pick);
    let side = |axis| bound(axis, f64::max).unwrap_or(0.0) - bound(axis, f64::min).unwrap_or(0.0);
    (side(0) * side(1) / field.places.len().max(1) as f64).sqrt()
}

/// A diagram for each plot of the post script.
pub(crate) fn diagrams(output: &ScriptOutput) -> Vec<Diagram> {
    let diagram = |(index, plot): (usize, &Plot)| Diagram { path: format!("plots/{index}"), plot: plot.clone() };
    output.plots.iter().enumerate().map(diagram).collect()
}

#[cfg(test)]
mod tests {
    use scene::simulate::FilmState;

    use super::*;

    #[test]
    fn snapshots_with_infinite_positions_are_not_drawn() {
        let snapshot = |place: f32| {
            let state = FilmState { positions: vec![[place; 3]], ..FilmState::default() };
            Snapshot { time: 0.0, films: vec![state], impactors: vec![] }
        };
        let snapshots = [0.0, 1.0, 1e9, f32::NAN].map(snapshot);
        let drawn = drawn(&snapshots);
        let at = |snapshots: Vec<&Snapshot>| {
            snapshots.iter().map(|snapshot| snapshot.films[0].positions[0][0]).collect::<Vec<_>>()
        };
        assert_eq!(at(drawn.clone()), [0.0, 1.0, 1e9]);
        assert_eq!((at(ends(&drawn, false)), at(ends(&drawn, true))), (vec![0.0, 1e9], vec![0.0]));
    }

    #[test]
    fn an_undeformed_film_has_the_lowest_colour() {
        for quantity in quantities(&[]) {
            let [low, high] = quantity.range;
            assert!(low == 0.0 && high > 0.0, "{}: {low} to {high}", quantity.title);
        }
    }
}
