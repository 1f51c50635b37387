//! The position and target of the eye.

use crate::scene::{Extent, Scene};

/// Direction from the scene to the eye: from the side and a little above, so that film and body are both seen.
const DIRECTION: [f32; 3] = [0.56, -0.79, 0.24];

/// Direction of view on films alone, which are flat.
const ABOVE: [f32; 3] = [0.45, -0.63, 0.63];

/// Least size of a scene, m; a smaller one is scaled up: the viewer clips what is within a centimetre of the eye.
const LEAST_SIZE: f32 = 0.5;

/// Distance of the eye over the size of what it looks at; the viewer's field of view is 55°.
const DISTANCE: f32 = 0.8;

/// Distance of the eye from films alone.
const ABOVE_DISTANCE: f32 = 1.1;

/// Depth in view over the width of a film: the depth that a run reaches is not known before it.
const DEPTH: f32 = 0.4;

/// Position and target of the eye, m, in the enlarged scene.
pub(crate) struct Eye {
    pub(crate) position: [f32; 3],
    pub(crate) target: [f32; 3],
    /// Factor by which the scene is enlarged.
    pub(crate) enlargement: f32,
}

impl Eye {
    /// An eye that has the films and the bodies in view, and what is below them.
    pub(crate) fn on(scene: &Scene) -> Eye {
        let Extent { mut low, mut high } = scene.extent.or_a_metre();
        if !scene.bodies.is_empty() {
            low[2] -= DEPTH * (high[0] - low[0]).max(high[1] - low[1]);
        }
        high[2] = scene.bodies.iter().map(|body| body.top).fold(high[2], f32::max);
        let target = [0, 1, 2].map(|k| 0.5 * (low[k] + high[k]));
        let size = [0, 1, 2].map(|k| (high[k] - low[k]).powi(2)).iter().sum::<f32>().sqrt();
        let enlargement = if size > 0.0 { (LEAST_SIZE / size).max(1.0) } else { 1.0 };
        let (direction, distance) =
            if scene.bodies.is_empty() { (ABOVE, ABOVE_DISTANCE) } else { (DIRECTION, DISTANCE) };
        Eye {
            position: [0, 1, 2].map(|k| enlargement * (target[k] + distance * size * direction[k])),
            target: target.map(|coordinate| enlargement * coordinate),
            enlargement,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use report::geometry::SceneFace;
    use scene::simulate::FilmState;

    /// One triangle from the origin to a corner, and a failed one far away.
    fn scene(corner: [f32; 3], mirrored: [bool; 2]) -> Scene {
        let patches = vec![[0, 1, 1, 1], [0, 2, 2, 2]];
        let face = SceneFace { nodes: 3, patches, mirrored, ..SceneFace::default() };
        let positions = vec![[0.0; 3], corner, [1e6; 3]];
        let film = FilmState { positions, failed: vec![false, true], ..FilmState::default() };
        Scene { extent: Extent::default().with(&face, &film), faces: vec![face], ..Scene::default() }
    }

    #[test]
    fn the_eye_looks_at_the_whole_of_a_quarter_from_outside() {
        let eye = Eye::on(&scene([0.2, 0.2, 0.0], [true; 2]));
        assert!(eye.target[..2] == [0.0; 2] && eye.target[2] == 0.0 && eye.enlargement == 1.0, "{:?}", eye.target);
        let away = [0, 1, 2].map(|k| (eye.position[k] - eye.target[k]).powi(2)).iter().sum::<f32>().sqrt();
        assert!((0.4..1.0).contains(&away) && eye.position[2] > 0.0, "{:?}", eye.position);
    }

    #[test]
    fn a_coupon_is_enlarged() {
        let eye = Eye::on(&scene([0.006, 0.004, 0.0], [false; 2]));
        assert!(eye.enlargement > 50.0 && eye.position[2] > 0.1, "{} {:?}", eye.enlargement, eye.position);
    }
}
