//! The projection of a scene on a picture, and the directions from which it is seen.

use std::str::FromStr;

use nalgebra::Vector3;

/// Distance of the eye from the centre of a scene in perspective, over the largest extent of the scene.
const DISTANCE: f64 = 2.5;

/// A projection: from metres to units of the picture, right, down and towards the eye.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Camera {
    axes: [Vector3<f64>; 3],
    centre: Vector3<f64>,
    /// Of the eye from the centre in perspective, m.
    distance: Option<f64>,
    /// Units per metre.
    scale: f64,
    /// Place of the centre in the picture.
    origin: [f64; 2],
}

impl Camera {
    /// The projection in which `points` fill a picture of this size; none without points.
    pub(crate) fn fitting(
        view: View,
        in_perspective: bool,
        points: &[Vector3<f64>],
        [width, height]: [f64; 2],
    ) -> Option<Camera> {
        let first = points.first()?;
        let ends = points.iter().fold([*first; 2], |[low, high], point| [low.inf(point), high.sup(point)]);
        let extent = (ends[1] - ends[0]).norm().max(f64::MIN_POSITIVE);
        let mut camera = Camera {
            axes: view.axes(),
            centre: 0.5 * (ends[0] + ends[1]),
            distance: in_perspective.then_some(DISTANCE * extent),
            scale: 1.0,
            origin: [0.0; 2],
        };
        let places = points.iter().map(|point| camera.project(point));
        let none = [f64::INFINITY, f64::INFINITY, f64::NEG_INFINITY, f64::NEG_INFINITY];
        let [left, top, right, bottom] =
            places.fold(none, |[l, t, r, b], [x, y, _]| [l.min(x), t.min(y), r.max(x), b.max(y)]);
        let share = |room: f64, length: f64| room / length.max(1e-9 * extent);
        camera.scale = share(width, right - left).min(share(height, bottom - top));
        camera.origin = [0.5 * (width - camera.scale * (left + right)), 0.5 * (height - camera.scale * (top + bottom))];
        Some(camera)
    }

    /// The projection on a picture `factor` times as large.
    pub(crate) fn scaled(&self, factor: f64) -> Camera {
        Camera { scale: factor * self.scale, origin: self.origin.map(|place| factor * place), ..*self }
    }

    /// Right, down, and a depth that grows towards the eye and is linear along straight lines of the picture.
    pub(crate) fn project(&self, point: &Vector3<f64>) -> [f64; 3] {
        let [right, up, near] = self.axes.map(|axis| axis.dot(&(point - self.centre)));
        let (factor, depth) = match self.distance {
            Some(distance) => (distance / (distance - near), distance * distance / (distance - near)),
            None => (1.0, near),
        };
        let scale = self.scale * factor;
        [self.origin[0] + scale * right, self.origin[1] - scale * up, depth]
    }

    /// The length in m of one in the picture, at the centre.
    pub(crate) fn metres(&self, length: f64) -> f64 {
        length / self.scale
    }

    /// Components of a direction to the right, upwards and towards the eye.
    pub(crate) fn turned(&self, direction: &Vector3<f64>) -> Vector3<f64> {
        let [right, up, near] = self.axes.map(|axis| axis.dot(direction));
        Vector3::new(right, up, near)
    }

    /// Towards the eye.
    pub(crate) fn near(&self) -> Vector3<f64> {
        self.axes[2]
    }
}

/// A direction from which a scene is seen; z points up in the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Angle of the eye about z from the front, the side of negative y, towards positive x, rad.
    pub azimuth: f64,
    /// Angle of the eye above the horizon, rad.
    pub elevation: f64,
}

/// Views with names: azimuth and elevation, degrees.
const NAMED: [(&str, [f64; 2]); 6] = [
    ("iso", [35.0, 25.0]),
    ("front", [0.0, 0.0]),
    ("side", [90.0, 0.0]),
    ("top", [0.0, 90.0]),
    ("bottom", [0.0, -90.0]),
    ("below", [35.0, -25.0]),
];

impl View {
    fn degrees([azimuth, elevation]: [f64; 2]) -> View {
        View { azimuth: azimuth.to_radians(), elevation: elevation.to_radians() }
    }

    /// Unit vectors to the right and upwards in the picture, and towards the eye.
    pub(crate) fn axes(&self) -> [Vector3<f64>; 3] {
        let [(sin_a, cos_a), (sin_e, cos_e)] = [self.azimuth.sin_cos(), self.elevation.sin_cos()];
        [
            Vector3::new(cos_a, sin_a, 0.0),
            Vector3::new(-sin_e * sin_a, sin_e * cos_a, cos_e),
            Vector3::new(cos_e * sin_a, -cos_e * cos_a, sin_e),
        ]
    }
}

impl Default for View {
    fn default() -> View {
        View::degrees(NAMED[0].1)
    }
}

impl FromStr for View {
    type Err = String;

    /// A name, or azimuth and elevation in degrees, `35/25`.
    fn from_str(text: &str) -> Result<View, String> {
        if let Some((_, angles)) = NAMED.iter().find(|(name, _)| *name == text) {
            return Ok(View::degrees(*angles));
        }
        let angle =
            |text: &str| text.trim().trim_end_matches('°').parse::<f64>().ok().filter(|angle| angle.is_finite());
        let angles = text.split_once('/').and_then(|(azimuth, elevation)| Some([angle(azimuth)?, angle(elevation)?]));
        match angles {
            Some(angles) if angles[1].abs() <= 90.0 => Ok(View::degrees(angles)),
            Some(_) => Err("the elevation is outside of -90° to 90°".into()),
            None => {
                let names = NAMED.map(|(name, _)| name).join(", ");
                Err(format!("expected {names}, or azimuth and elevation in degrees, such as 35/25"))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_fill_the_picture_and_depth_is_linear() {
        let points: Vec<Vector3<f64>> = (0..8)
            .map(|at| Vector3::new(f64::from(at & 1), f64::from(at >> 1 & 1), f64::from(at >> 2)) * 0.4)
            .collect();
        for in_perspective in [false, true] {
            let camera = Camera::fitting(View::default(), in_perspective, &points, [300.0, 200.0]).expect("points");
            let places: Vec<[f64; 3]> = points.iter().map(|point| camera.project(point)).collect();
            let ends = |axis: usize| {
                let along = || places.iter().map(|place| place[axis]);
                [along().fold(f64::INFINITY, f64::min), along().fold(f64::NEG_INFINITY, f64::max)]
            };
            let [[left, right], [top, bottom]] = [ends(0), ends(1)];
            assert!((left + right - 300.0).abs() < 1e-9 && (top + bottom - 200.0).abs() < 1e-9, "in the middle");
            assert!((right - left - 300.0).abs() < 1e-9 || (bottom - top - 200.0).abs() < 1e-9, "as large as possible");
            // Of three points on a line of the picture, the one between has the depth between.
            let [a, b] = [points[0], points[7]];
            let [from, to, middle] = [a, b, 0.7 * a + 0.3 * b].map(|point| camera.project(&point));
            let share = (middle[0] - from[0]) / (to[0] - from[0]);
            assert!((from[2] + share * (to[2] - from[2]) - middle[2]).abs() < 1e-9, "{in_perspective}");
            assert!((camera.scaled(3.0).project(&a)[0] - 3.0 * from[0]).abs() < 1e-9);
        }
        assert!(Camera::fitting(View::default(), false, &[], [1.0; 2]).is_none());
    }

    #[test]
    fn views_look_from_where_their_names_say() {
        for (text, [right, up, near]) in [
            ("front", [Vector3::x(), Vector3::z(), -Vector3::y()]),
            ("side", [Vector3::y(), Vector3::z(), Vector3::x()]),
            ("top", [Vector3::x(), Vector3::y(), Vector3::z()]),
            ("-90/0", [-Vector3::y(), Vector3::z(), -Vector3::x()]),
        ] {
            let found = text.parse::<View>().expect("a view").axes();
            let apart = found.iter().zip([right, up, near]).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max);
            assert!(apart < 1e-12, "{text}: {found:?}");
        }
        for (text, expected) in [("behind", "expected iso, front"), ("10/95", "outside"), ("10/x", "expected iso")] {
            assert!(text.parse::<View>().expect_err("a mistake").contains(expected), "{text}");
        }
    }
}
