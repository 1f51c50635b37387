//! The recording of a run: its scene, and its file.

use std::path::Path;
use std::time::Duration;

use crate::scene::{Body, Document, Extent, PointState, PointTrack, Scene};
use crate::stage::Stage;
use crate::{Quantity, VizError, signals, text};
use base::number::significant;
use membrane::engine::Surface;
use plot::viridis::viridis;
use report::geometry::{Field, SceneBody, SceneFace, is_finite};
use report::{RunPage, escaped, markdown};
use scene::model::Model;
use scene::simulate::Snapshot;
use study::field_comparison::{FieldComparison, PointError, StateErrors};

/// Longest time that a file may take to be written.
const WRITE_TIMEOUT: Duration = Duration::from_secs(600);

/// Writes the recording of a run to `path`, snapshot by snapshot.
///
/// # Errors
/// The file cannot be written.
pub fn write(path: &Path, run: &RunPage) -> Result<(), VizError> {
    let snapshots = drawn(&run.outcome.snapshots);
    let scene = scene(run, &snapshots);
    let faces = scene.faces.len();
    let mut stage = Stage::file(path, scene)?;
    snapshots.iter().try_for_each(|snapshot| stage.bodies(snapshot))?;
    // One face after the other: consecutive snapshots of one entity compress better.
    for face in 0..faces {
        snapshots.iter().try_for_each(|snapshot| stage.film(face, snapshot))?;
    }
    stage.finish(WRITE_TIMEOUT)
}

/// The scene without its snapshots, which are logged one by one.
fn scene(run: &RunPage, snapshots: &[&Snapshot]) -> Scene {
    let RunPage { model, outcome, results, .. } = run;
    let faces: Vec<SceneFace> = outcome.films.iter().map(SceneFace::from).collect();
    Scene {
        name: model.name.clone(),
        is_live: false,
        extent: extent(&faces, &ends(snapshots, run.failure.is_some())),
        duration: model.run_time(),
        documents: documents(run),
        quantities: quantities(snapshots),
        faces,
        bodies: bodies(model, &outcome.impactors, snapshots.first().copied()),
        points: point_tracks(results.field.as_deref()),
        charts: signals::charted(&results.signals, &outcome.energies, results.comparison.as_ref(), model.run_time()),
        diagrams: results.script_output.plots.clone(),
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
pub(crate) const SUMMARY: &str = "Summary";

pub(crate) fn scenario(content: &str) -> Document {
    text::document("Scenario", text::verbatim(content))
}

/// Summary, tables and files of the post script, and the scenario.
pub(crate) fn documents(run: &RunPage) -> Vec<Document> {
    let RunPage { model, results, .. } = run;
    let findings = results.findings.iter();
    let warnings: String =
        findings.map(|found| format!("- {} \\[{}\\]\n", escaped(&found.message), found.code)).collect();
    let figures = markdown(&results.summary(model));
    let field = results.field.as_deref().map_or(String::new(), |field| {
        let largest = significant(error_range(field) * 1e3, 3);
        format!(
            "Points are those of the field, moved as measured; their colours are errors from 0 to {largest} mm.\n\n"
        )
    });
    let summary =
        format!("# {}\n\n{}\n\n{field}{warnings}\n{figures}", escaped(&model.title), escaped(&model.subject()));
    let output = &results.script_output;
    let written = text::tables(output).into_iter().chain(text::files(output));
    [text::document(SUMMARY, summary)].into_iter().chain(written).chain([scenario(run.scenario)]).collect()
}

/// The quantities, with a range from zero to the largest of an intact element in any of `snapshots`.
pub(crate) fn quantities(snapshots: &[&Snapshot]) -> Vec<Quantity> {
    let films = snapshots.first().map_or(&[][..], |snapshot| &snapshot.films);
    let states = || snapshots.iter().flat_map(|snapshot| &snapshot.films);
    Field::all_in(films).map(|field| Quantity { field, range: field.range(states()) }).collect()
}

/// Bounds of the faces in all of `snapshots`.
pub(crate) fn extent(faces: &[SceneFace], snapshots: &[&Snapshot]) -> Extent {
    let states = snapshots.iter().flat_map(|snapshot| faces.iter().zip(&snapshot.films));
    states.fold(Extent::default(), |extent, (face, film)| extent.with(face, film))
}

/// The impactors of `model` and the bars of its frame, and where they are `first`.
pub(crate) fn bodies(model: &Model, impactors: &[Surface], first: Option<&Snapshot>) -> Vec<Body> {
    let of_impactor = |name: Option<&str>| name.map_or_else(|| "impactor".into(), |name| format!("impactors/{name}"));
    let names = model.names().into_iter().map(of_impactor).chain([String::from("frame")]);
    let body = |(index, (surface, name)): (usize, (SceneBody, String))| {
        let height =
            first.and_then(|snapshot| snapshot.impactors.get(index)).map_or(f64::NEG_INFINITY, |pose| pose.0[2]);
        let top = surface.points.iter().map(|point| point[2]).fold(0.0, f64::max);
        Body { name, surface, top: height as f32 + top as f32 }
    };
    SceneBody::all(impactors).into_iter().zip(names).enumerate().map(body).collect()
}

/// Share of the points whose error lies within the range of colours.
const WITHIN: f64 = 0.99;
/// Radius of a point over the distance of points.
const RADIUS: f64 = 0.3;

/// The points on the film, moved as they were measured.
fn point_tracks(field: Option<&FieldComparison>) -> Vec<PointTrack> {
    let Some(field) = field else { return vec![] };
    let largest = error_range(field);
    let state = |state: &StateErrors| {
        let points = || state.points.iter().filter(|point| field.on_film[point.place as usize]);
        let position = |point: &PointError| {
            let place = field.places[point.place as usize];
            [0, 1, 2].map(|axis| (place[axis] + point.measured[axis]) as f32)
        };
        let colour = |point: &PointError| viridis((point.size() / largest) as f32).map(|part| part.round() as u8);
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
            assert!(low == 0.0 && high > 0.0, "{}: {low} to {high}", quantity.field.title);
        }
    }
}
