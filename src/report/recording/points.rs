//! The points of a displacement field in a recording, coloured by the error of the run.

use viz::{PointState, PointTrack};

use plot::viridis::viridis;
use study::field_comparison::FieldComparison;

/// Share of the points whose error lies within the range of colours.
const WITHIN: f64 = 0.99;
/// Radius of a point over the distance of points.
const RADIUS: f64 = 0.3;

/// The points on the film, moved as they were measured.
pub(super) fn tracks(field: Option<&FieldComparison>) -> Vec<PointTrack> {
    let Some(field) = field else { return vec![] };
    let largest = range(field);
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
pub(super) fn range(field: &FieldComparison) -> f64 {
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
