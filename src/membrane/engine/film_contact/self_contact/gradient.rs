//! Deformation gradients of the triangles of a face, and from which of them follows that film does not meet itself.
//!
//! Positions x(X) of film over a convex region of the plane in which it was mounted do not meet where a projection Qᵀx on
//! some plane is strictly monotone: for two points with Y = X + h, h·Qᵀ(x(Y) - x(X)) is the mean of h·QᵀF h along the line
//! between them, and positive where the symmetric part of QᵀF is positive definite everywhere (in the plane for
//! holomorphic functions: Noshiro 1934, Warschawski 1935). With its least eigenvalue λ there the points are at least
//! λ|h| apart (theory.md, section 6).

use nalgebra::Vector3;

use crate::engine::film_contact::surface::Surface;
use crate::engine::nodes::Vectors;

/// Least ratio of the altitude of a triangle to its longest side for which it has a gradient, and of the stretches of a
/// mean gradient for which it has a plane.
const NARROW: f64 = 1e-6;

/// Deformation gradient of a triangle, its two columns one after the other: the derivatives of the position by x and y as
/// mounted.
pub(super) type Gradient = [f64; 6];

/// Triangles of a face as mounted, seen along z, in any order that is kept.
pub(super) struct Mounted {
    shapes: Vec<Shape>,
    /// Least altitude of all, m.
    pub(super) least_altitude: f64,
}

/// A triangle as mounted, seen along z.
#[derive(Clone, Copy)]
struct Shape {
    /// Rows of the matrix that makes the gradient from the edges from the first corner to the second and to the third, 1/m.
    inverse: [[f64; 2]; 2],
    /// m².
    area: f64,
    /// Least altitude, m.
    altitude: f64,
}

/// The plane on which film is projected.
pub(super) struct Plane {
    /// Two orthogonal unit vectors in it.
    directions: [[f64; 3]; 2],
    /// Least stretch of the gradient that it belongs to.
    least_stretch: f64,
}

/// Least and largest components of gradients.
#[derive(Clone, Copy, Debug)]
pub(super) struct Gradients {
    low: Gradient,
    high: Gradient,
}

impl Mounted {
    /// Of `triangles` mounted at `position`; none where the film is not a single-valued surface over the plane across z.
    pub(super) fn new(surface: &Surface, position: &Vectors, triangles: &[u32]) -> Option<Mounted> {
        let shapes = triangles.iter().map(|triangle| Shape::new(surface.corners_at(position, *triangle)));
        let shapes: Vec<Shape> = shapes.collect::<Option<_>>()?;
        let least_altitude = shapes.iter().map(|shape| shape.altitude).fold(f64::INFINITY, f64::min);
        Some(Mounted { shapes, least_altitude })
    }

    /// Least altitude of the triangle at a place, m.
    pub(super) fn altitude(&self, at: usize) -> f64 {
        self.shapes[at].altitude
    }

    /// The gradient of the triangle at a place with these corners.
    #[inline(always)]
    pub(super) fn gradient(&self, at: usize, [a, b, c]: &[Vector3<f64>; 3]) -> Gradient {
        let [[p, q], [r, s]] = self.shapes[at].inverse;
        let mut gradient = [0.0; 6];
        for k in 0..3 {
            let (u, v) = (b[k] - a[k], c[k] - a[k]);
            gradient[k] = u * p + v * r;
            gradient[3 + k] = u * q + v * s;
        }
        gradient
    }

    /// Mean of the gradients of all triangles over the area as mounted.
    pub(super) fn mean(&self, gradients: &[Gradient]) -> Gradient {
        let mut sum = [0.0; 6];
        let mut area = 0.0;
        for (gradient, shape) in gradients.iter().zip(&self.shapes) {
            for k in 0..6 {
                sum[k] += shape.area * gradient[k];
            }
            area += shape.area;
        }
        sum.map(|sum| sum / area)
    }
}

impl Shape {
    fn new([a, b, c]: [Vector3<f64>; 3]) -> Option<Shape> {
        let ([ux, uy], [vx, vy]) = ([b.x - a.x, b.y - a.y], [c.x - a.x, c.y - a.y]);
        let twice = ux * vy - uy * vx;
        let longest = ux.hypot(uy).max(vx.hypot(vy)).max((vx - ux).hypot(vy - uy));
        let altitude = twice / longest;
        let inverse = [[vy / twice, -vx / twice], [-uy / twice, ux / twice]];
        (altitude > NARROW * longest).then_some(Shape { inverse, area: 0.5 * twice, altitude })
    }
}

impl Plane {
    /// That into which the polar decomposition of a gradient rotates the plane as mounted; none where the gradient has
    /// none.
    pub(super) fn of(gradient: &Gradient) -> Option<Plane> {
        let [a, b] = columns(gradient);
        let (aa, ab, bb) = (dot(&a, &a), dot(&a, &b), dot(&b, &b));
        // The right stretch tensor, the square root of that of Cauchy and Green (Hoger and Carlson 1984).
        let det = (aa * bb - ab * ab).sqrt();
        let trace = (aa + bb + 2.0 * det).sqrt();
        let stretch = [(aa + det) / trace, ab / trace, (bb + det) / trace];
        let [p, q, r] = stretch;
        let direction = |of: [f64; 2]| [0, 1, 2].map(|k| (of[0] * a[k] + of[1] * b[k]) / det);
        // Not where that is not a number.
        (det > NARROW * trace * trace).then(|| Plane {
            directions: [direction([r, -q]), direction([-q, p])],
            least_stretch: least_eigenvalue(stretch),
        })
    }

    /// Least eigenvalue of the symmetric part of a gradient projected on it.
    #[inline(always)]
    pub(super) fn monotonicity(&self, gradient: &Gradient) -> f64 {
        let ([p, q], [a, b]) = (&self.directions, columns(gradient));
        least_eigenvalue([dot(p, &a), 0.5 * (dot(p, &b) + dot(q, &a)), dot(q, &b)])
    }
}

impl Gradients {
    /// Of none.
    pub(super) const EMPTY: Gradients = Gradients { low: [f64::INFINITY; 6], high: [f64::NEG_INFINITY; 6] };

    #[inline(always)]
    pub(super) fn around(mut self, gradient: &Gradient) -> Gradients {
        for k in 0..6 {
            self.low[k] = self.low[k].min(gradient[k]);
            self.high[k] = self.high[k].max(gradient[k]);
        }
        self
    }

    #[inline(always)]
    pub(super) fn with(mut self, other: &Gradients) -> Gradients {
        for k in 0..6 {
            self.low[k] = self.low[k].min(other.low[k]);
            self.high[k] = self.high[k].max(other.high[k]);
        }
        self
    }

    /// Lower bound of the least eigenvalue of the symmetric parts of all of them, projected on the plane of the middle one;
    /// minus infinity where there is none.
    pub(super) fn monotonicity(&self) -> f64 {
        let (mut middle, mut half) = ([0.0; 6], [0.0; 6]);
        for k in 0..6 {
            middle[k] = 0.5 * (self.low[k] + self.high[k]);
            half[k] = 0.5 * (self.high[k] - self.low[k]);
        }
        let Some(Plane { directions, least_stretch }) = Plane::of(&middle) else {
            return f64::NEG_INFINITY;
        };
        let [p, q] = directions.map(|direction| direction.map(f64::abs));
        let [a, b] = columns(&half);
        // No component of the symmetric part differs from that of the middle one by more than these; the middle one itself
        // is projected to its stretch tensor.
        let [xx, xy, yy] = [dot(&p, &a), 0.5 * (dot(&p, &b) + dot(&q, &a)), dot(&q, &b)];
        least_stretch + least_eigenvalue([-xx, -xy, -yy])
    }
}

/// Least eigenvalue of the symmetric matrix with the components xx, xy and yy.
#[inline(always)]
fn least_eigenvalue([xx, xy, yy]: [f64; 3]) -> f64 {
    let half = 0.5 * (xx - yy);
    0.5 * (xx + yy) - (half * half + xy * xy).sqrt()
}

#[inline(always)]
fn columns([a, b, c, d, e, f]: &Gradient) -> [[f64; 3]; 2] {
    [[*a, *b, *c], [*d, *e, *f]]
}

#[inline(always)]
fn dot(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::film_contact::tests::numbers::Numbers;

    fn random(numbers: &mut Numbers) -> Gradient {
        [(); 6].map(|()| numbers.next())
    }

    /// The least of h·QᵀF h over unit vectors h.
    fn least(plane: &Plane, gradient: &Gradient) -> f64 {
        let ([p, q], [a, b]) = (&plane.directions, columns(gradient));
        let along = |k: i32| {
            let (y, x) = (std::f64::consts::PI * f64::from(k) / 2000.0).sin_cos();
            x * x * dot(p, &a) + x * y * (dot(p, &b) + dot(q, &a)) + y * y * dot(q, &b)
        };
        (0..2000).map(along).fold(f64::INFINITY, f64::min)
    }

    #[test]
    fn the_plane_of_a_gradient_is_that_of_its_polar_decomposition() {
        let mut numbers = Numbers::new(5);
        for _ in 0..1000 {
            let gradient = random(&mut numbers);
            let plane = Plane::of(&gradient).expect("two directions");
            let ([p, q], [a, b]) = (&plane.directions, columns(&gradient));
            for (product, expected) in [(dot(p, p), 1.0), (dot(q, q), 1.0), (dot(p, q), 0.0)] {
                assert!((product - expected).abs() < 1e-9, "{gradient:?}");
            }
            // QᵀF is the stretch tensor: symmetric, with the least singular value of F.
            assert!((dot(p, &b) - dot(q, &a)).abs() < 1e-9, "{gradient:?}");
            let square = least_eigenvalue([dot(&a, &a), dot(&a, &b), dot(&b, &b)]);
            assert!((plane.least_stretch.powi(2) - square).abs() < 1e-9, "{gradient:?}");
            assert!((plane.monotonicity(&gradient) - plane.least_stretch).abs() < 1e-9, "{gradient:?}");
            let other = random(&mut numbers);
            assert!((plane.monotonicity(&other) - least(&plane, &other)).abs() < 1e-5, "{gradient:?} {other:?}");
        }
        assert!(Plane::of(&[1.0, 2.0, 3.0, 2.0, 4.0, 6.0]).is_none() && Plane::of(&[f64::NAN; 6]).is_none());
    }

    /// No gradient in the range of others is less monotone than the bound, and some of an arc is as little.
    #[test]
    fn ranges_of_gradients_bound_what_is_in_them() {
        let mut numbers = Numbers::new(6);
        for _ in 0..1000 {
            let size = numbers.next();
            let middle = random(&mut numbers);
            let all: Vec<Gradient> = (0..20)
                .map(|_| {
                    let part = random(&mut numbers);
                    std::array::from_fn(|k| middle[k] + size * part[k])
                })
                .collect();
            let (one, other) = all.split_at(7);
            let of = |part: &[Gradient]| part.iter().fold(Gradients::EMPTY, |range, gradient| range.around(gradient));
            let range = of(one).with(&of(other));
            let centre = std::array::from_fn(|k| 0.5 * (range.low[k] + range.high[k]));
            let Some(plane) = Plane::of(&centre) else { continue };
            let exact = all.iter().map(|gradient| plane.monotonicity(gradient)).fold(f64::INFINITY, f64::min);
            assert!(range.monotonicity() <= exact + 1e-12);
        }
        for angle in [0.1_f64, 0.5, 1.0, 1.5] {
            let bent = |angle: f64| [angle.cos(), 0.0, angle.sin(), 0.0, 1.0, 0.0];
            let range =
                [-angle, 0.0, 0.3 * angle, angle].iter().fold(Gradients::EMPTY, |range, a| range.around(&bent(*a)));
            assert!((range.monotonicity() - angle.cos()).abs() < 1e-12, "{angle}");
        }
        assert_eq!(Gradients::EMPTY.monotonicity(), f64::NEG_INFINITY);
    }
}
