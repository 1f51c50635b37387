//! The impactor as pictures show it: triangles about its centre of mass, m.

use crate::engine::Surface;

/// A closed surface, its triangles counter-clockwise seen from outside.
pub struct Body {
    pub points: Vec<[f32; 3]>,
    pub triangles: Vec<[u32; 3]>,
}

impl Body {
    /// As the run moves it; what is round has so many `sides`.
    pub fn of(surface: &Surface, sides: u32) -> Body {
        let (points, triangles) = surface.triangles(sides);
        let single = |point: &nalgebra::Point3<f64>| <[f64; 3]>::from(point.coords).map(|c| c as f32);
        Body { points: points.iter().map(single).collect(), triangles }
    }
}
