//! The impactor as it is drawn: triangles about its centre of mass, m.

use membrane::engine::Surface;

/// A closed surface, its triangles counter-clockwise seen from outside.
pub(super) struct Body {
    /// Vertices, m.
    pub(super) points: Vec<[f32; 3]>,
    /// Indices of the vertices.
    pub(super) triangles: Vec<[u32; 3]>,
}

impl Body {
    /// The triangulated `surface` of an impactor; round shapes have `sides` sides.
    pub(super) fn from_surface(surface: &Surface, sides: u32) -> Body {
        let (points, triangles) = surface.triangles(sides);
        let single = |point: &nalgebra::Point3<f64>| <[f64; 3]>::from(point.coords).map(|c| c as f32);
        Body { points: points.iter().map(single).collect(), triangles }
    }
}
