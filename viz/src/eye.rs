//! From where a scene is looked at.

use crate::scene::{BodyShape, FilmTrack, Scene};

/// Direction from the scene to the eye: from the side and a little above, so that film and body are both seen.
const DIRECTION: [f32; 3] = [0.55, -0.78, 0.30];

/// Distance of the eye over the size of what it looks at: the viewer's field of view is 55°.
const DISTANCE: f32 = 0.95;

/// Where the eye is and what it looks at, m.
pub(crate) struct Eye {
    pub(crate) position: [f32; 3],
    pub(crate) target: [f32; 3],
}

impl Eye {
    /// An eye that has all films and the body in view, at all times.
    pub(crate) fn on(scene: &Scene) -> Eye {
        let (low, high) = bounds(scene);
        let target = [0, 1, 2].map(|k| 0.5 * (low[k] + high[k]));
        let size = [0, 1, 2].map(|k| (high[k] - low[k]).powi(2)).iter().sum::<f32>().sqrt();
        Eye { position: [0, 1, 2].map(|k| target[k] + DISTANCE * size * DIRECTION[k]), target }
    }
}

/// The corners of a box around everything.
fn bounds(scene: &Scene) -> ([f32; 3], [f32; 3]) {
    let points = scene.films.iter().flat_map(film_ends).chain(body_ends(scene));
    let begin = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
    let (low, high) = points.fold(begin, |(low, high), point| {
        ([0, 1, 2].map(|k| low[k].min(point[k])), [0, 1, 2].map(|k| high[k].max(point[k])))
    });
    if low[0] <= high[0] { (low, high) } else { ([-0.5; 3], [0.5; 3]) }
}

/// All points of a film and their mirror images.
fn film_ends(film: &FilmTrack) -> impl Iterator<Item = [f32; 3]> + '_ {
    let points = film.frames.iter().flat_map(|frame| &frame.positions);
    let opposite = |p: &[f32; 3]| [0, 1, 2].map(|k| if film.mirrored.get(k) == Some(&true) { -p[k] } else { p[k] });
    points.flat_map(move |point| [*point, opposite(point)])
}

/// Top and bottom of the body at its poses that are not far from where it was first: a rebound may go anywhere.
fn body_ends(scene: &Scene) -> Vec<[f32; 3]> {
    let Some(body) = &scene.body else { return vec![] };
    let reach = match &body.shape {
        BodyShape::Sphere { radius } => *radius,
        BodyShape::Revolved { profile } => profile.iter().map(|[_, z]| z.abs()).fold(0.0, f32::max),
        BodyShape::Surface { points, .. } => points.iter().map(|p| p[2].abs()).fold(0.0, f32::max),
    };
    let first = body.poses.first().map(|pose| pose.position);
    first.into_iter().flat_map(|[x, y, z]| [[x, y, z - reach], [x, y, z + reach]]).collect()
}
