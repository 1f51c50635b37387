//! From where a scene is looked at.

use crate::scene::{FilmTrack, Scene};

/// Direction from the scene to the eye: from the side and a little above, so that film and body are both seen.
const DIRECTION: [f32; 3] = [0.56, -0.79, 0.24];

/// The same of films alone, which are flat.
const ABOVE: [f32; 3] = [0.45, -0.63, 0.63];

/// Size below which a scene is shown enlarged to it, m: the viewer cuts away what is within a centimetre of the eye.
const LEAST_SIZE: f32 = 0.5;

/// Distance of the eye over the size of what it looks at; the viewer's field of view is 55°.
const DISTANCE: f32 = 0.8;

/// The same of films alone.
const ABOVE_DISTANCE: f32 = 1.1;

/// Depth over the width of a film to which it is looked at: before a run nobody knows how deep it will go.
const DEPTH: f32 = 0.4;

/// Where the eye is and what it looks at, m, in the enlarged scene.
pub(crate) struct Eye {
    pub(crate) position: [f32; 3],
    pub(crate) target: [f32; 3],
    /// How much larger the scene is shown than it is.
    pub(crate) enlargement: f32,
}

impl Eye {
    /// An eye that has the films and the body in view as they are at first and at last, and what is below them.
    pub(crate) fn on(scene: &Scene) -> Eye {
        let points = scene.films.iter().flat_map(film_ends);
        let (mut low, mut high) = bounds(points);
        if scene.body.is_some() {
            low[2] -= DEPTH * (high[0] - low[0]).max(high[1] - low[1]);
        }
        high[2] = high[2].max(body_top(scene));
        let target = [0, 1, 2].map(|k| 0.5 * (low[k] + high[k]));
        let size = [0, 1, 2].map(|k| (high[k] - low[k]).powi(2)).iter().sum::<f32>().sqrt();
        let enlargement = if size > 0.0 { (LEAST_SIZE / size).max(1.0) } else { 1.0 };
        let (direction, distance) = if scene.body.is_some() { (DIRECTION, DISTANCE) } else { (ABOVE, ABOVE_DISTANCE) };
        Eye {
            position: [0, 1, 2].map(|k| enlargement * (target[k] + distance * size * direction[k])),
            target: target.map(|coordinate| enlargement * coordinate),
            enlargement,
        }
    }
}

/// The corners of a box around points; that of a metre where there are none.
fn bounds(points: impl Iterator<Item = [f32; 3]>) -> ([f32; 3], [f32; 3]) {
    let begin = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
    let (low, high) = points.fold(begin, |(low, high), point| {
        ([0, 1, 2].map(|k| low[k].min(point[k])), [0, 1, 2].map(|k| high[k].max(point[k])))
    });
    if low[0] <= high[0] { (low, high) } else { ([-0.5; 3], [0.5; 3]) }
}

/// All points of a film at first and at last, and their mirror images.
fn film_ends(film: &FilmTrack) -> impl Iterator<Item = [f32; 3]> + '_ {
    let points = film.frames.first().into_iter().chain(film.frames.last()).flat_map(|frame| &frame.positions);
    let opposite = |p: &[f32; 3]| [0, 1, 2].map(|k| if film.mirrored.get(k) == Some(&true) { -p[k] } else { p[k] });
    points.flat_map(move |point| [*point, opposite(point)])
}

/// Height of the body's top at first.
fn body_top(scene: &Scene) -> f32 {
    let place = scene.body.as_ref().and_then(|body| Some((body, body.poses.first()?)));
    let Some((body, pose)) = place else { return f32::NEG_INFINITY };
    pose.position[2] + body.points.iter().map(|point| point[2]).fold(0.0, f32::max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::FilmFrame;

    #[test]
    fn the_eye_looks_at_the_whole_of_a_quarter_from_outside() {
        let frame = FilmFrame { positions: vec![[0.0; 3], [0.2, 0.2, 0.0]], ..FilmFrame::default() };
        let film = FilmTrack { mirrored: [true; 2], frames: vec![frame], ..FilmTrack::default() };
        let eye = Eye::on(&Scene { films: vec![film], ..Scene::default() });
        assert!(eye.target[..2] == [0.0; 2] && eye.target[2] == 0.0 && eye.enlargement == 1.0, "{:?}", eye.target);
        let away = [0, 1, 2].map(|k| (eye.position[k] - eye.target[k]).powi(2)).iter().sum::<f32>().sqrt();
        assert!(away > 0.4 && eye.position[2] > 0.0, "{:?}", eye.position);
    }

    #[test]
    fn a_coupon_is_enlarged() {
        let frame = FilmFrame { positions: vec![[-0.003, 0.0, 0.0], [0.003, 0.004, 0.0]], ..FilmFrame::default() };
        let film = FilmTrack { frames: vec![frame], ..FilmTrack::default() };
        let eye = Eye::on(&Scene { films: vec![film], ..Scene::default() });
        assert!(eye.enlargement > 50.0 && eye.position[2] > 0.1, "{} {:?}", eye.enlargement, eye.position);
    }
}
