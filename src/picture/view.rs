//! Directions from which a scene is seen.

use std::str::FromStr;

use nalgebra::Vector3;

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
    pub(super) fn axes(&self) -> [Vector3<f64>; 3] {
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
