//! The stress-free shape of elements with nodes counter-clockwise: the four-node element with one and with four integration
//! points, and the three-node one of constant strain.

use nalgebra::{Point3, Vector3};
use thiserror::Error;

use super::gauss::GaussElement;
use super::one_point::OnePointElement;

/// MD and pre-strain, which relate the mounted film to the stress-free one.
#[derive(Clone, Copy, Debug)]
pub struct StressFree {
    md: Vector3<f64>,
    prestrain: [f64; 2],
}

/// MD is perpendicular to the plane of an element, so the fibre directions in it are undefined.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[error("the fibre directions are undefined in the element at nodes {nodes:?}: MD is perpendicular to its plane")]
pub struct UndefinedFibreDirection {
    /// The first three nodes of the element.
    pub nodes: [u32; 3],
}

impl StressFree {
    /// MD at `md_angle` (rad) from the x axis; engineering pre-strain along MD and TD.
    pub fn new(md_angle: f64, prestrain: [f64; 2]) -> StressFree {
        StressFree { md: Vector3::new(md_angle.cos(), md_angle.sin(), 0.0), prestrain }
    }

    /// Stress-free coordinates (m, along MD and TD) of an element's nodes: the mounted ones, projected onto the
    /// element's plane and divided by 1 + pre-strain (theory.md, equation 3).
    fn reference<const NODES: usize>(
        &self,
        nodes: [u32; NODES],
        positions: &[Point3<f64>],
    ) -> Result<[[f64; 2]; NODES], UndefinedFibreDirection> {
        let x: [Point3<f64>; NODES] = nodes.map(|n| positions[n as usize]);
        let undefined = UndefinedFibreDirection { nodes: [nodes[0], nodes[1], nodes[2]] };
        let last = x[NODES - 1];
        let normal = (x[2] - x[0]).cross(&(last - x[1])).try_normalize(0.0).unwrap_or_else(Vector3::z);
        let normal = if NODES == 3 { (x[1] - x[0]).cross(&(x[2] - x[0])).normalize() } else { normal };
        let md = self.md - normal * self.md.dot(&normal);
        let md = md.try_normalize(1e-3).ok_or(undefined)?;
        let td = normal.cross(&md);
        Ok(x.map(|p| {
            let arm = p - x[0];
            [arm.dot(&md) / (1.0 + self.prestrain[0]), arm.dot(&td) / (1.0 + self.prestrain[1])]
        }))
    }
}

/// A kind of element that is built from the stress-free coordinates (m, along MD and TD) of its nodes.
pub(crate) trait Shaped<const NODES: usize>: Sized {
    /// The element with nodes at `x`.
    fn shaped(x: &[[f64; 2]; NODES]) -> Self;

    /// Area of stress-free film, m².
    fn area(&self) -> f64;
}

/// Elements at the given nodes of a mesh with the stress-free coordinates of `film`.
pub(crate) fn shaped<E: Shaped<NODES>, const NODES: usize>(
    elements: &[[u32; NODES]],
    nodes: &[Point3<f64>],
    film: &StressFree,
) -> Result<Vec<E>, UndefinedFibreDirection> {
    elements.iter().map(|&element| Ok(E::shaped(&film.reference(element, nodes)?))).collect()
}

/// Natural coordinates of the nodes.
const CORNERS: [[f64; 2]; 4] = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];

/// Signs of the hourglass mode ξη at the nodes.
const MODE: [f64; 4] = [1.0, -1.0, 1.0, -1.0];

/// Skew below which an element counts as a parallelogram.
const ROUNDING: f64 = 1e-12;

/// Bilinear map at one natural point.
struct Map {
    /// ∂N_a/∂X_I.
    gradient: [[f64; 2]; 4],
    /// Area of reference film per area of natural square.
    determinant: f64,
}

/// The map at the natural coordinates `xi`, `eta`.
fn map(x: &[[f64; 2]; 4], [xi, eta]: [f64; 2]) -> Map {
    let natural = CORNERS.map(|[a, b]| [0.25 * a * (1.0 + b * eta), 0.25 * b * (1.0 + a * xi)]);
    let mut j = [[0.0; 2]; 2];
    for (n, x) in natural.iter().zip(x) {
        for i in 0..2 {
            j[i][0] += x[i] * n[0];
            j[i][1] += x[i] * n[1];
        }
    }
    let determinant = j[0][0] * j[1][1] - j[0][1] * j[1][0];
    let inverse = [[j[1][1] / determinant, -j[0][1] / determinant], [-j[1][0] / determinant, j[0][0] / determinant]];
    let gradient = natural.map(|n| [0, 1].map(|i| n[0] * inverse[0][i] + n[1] * inverse[1][i]));
    Map { gradient, determinant }
}

impl Shaped<4> for OnePointElement {
    /// One point at the centre (Flanagan and Belytschko 1981 for the shape of the hourglass mode; theory.md, equation 11).
    fn shaped(x: &[[f64; 2]; 4]) -> Self {
        let centre = map(x, [0.0, 0.0]);
        let mut lever = [0.0; 2];
        for a in 0..4 {
            for i in 0..2 {
                lever[i] += MODE[a] * x[a][i];
            }
        }
        let [first, second, ..] = centre.gradient;
        // Second part of γ_a in equation 11, for two nodes: gradients of opposite nodes are opposite.
        let skew = [first, second].map(|b| 0.25 * (lever[0] * b[0] + lever[1] * b[1]));
        // A parallelogram to within the rounding of its coordinates has no skew.
        let skew = skew.map(|s| if s.abs() < ROUNDING { 0.0 } else { s });
        // Exact, though only the centre is read: the determinant of a bilinear map is linear.
        OnePointElement { gradient: [first, second], skew, area: 4.0 * centre.determinant }
    }

    fn area(&self) -> f64 {
        self.area
    }
}

impl Shaped<4> for GaussElement<4, 4> {
    /// 2×2 Gauss points.
    fn shaped(x: &[[f64; 2]; 4]) -> Self {
        let g = 1.0 / 3.0_f64.sqrt();
        let maps = CORNERS.map(|[a, b]| map(x, [a * g, b * g]));
        GaussElement {
            gradient: std::array::from_fn(|p| maps[p].gradient),
            area: std::array::from_fn(|p| maps[p].determinant),
        }
    }

    fn area(&self) -> f64 {
        self.area.iter().sum()
    }
}

impl Shaped<3> for GaussElement<3, 1> {
    /// Gradients of the linear shape functions and the area of the stress-free triangle.
    fn shaped(x: &[[f64; 2]; 3]) -> Self {
        let edge = |a: usize, b: usize| [x[b][0] - x[a][0], x[b][1] - x[a][1]];
        let (u, v) = (edge(0, 1), edge(0, 2));
        let twice = u[0] * v[1] - u[1] * v[0];
        let gradient = [(1, 2), (2, 0), (0, 1)].map(|(a, b)| {
            let e = edge(a, b);
            [-e[1] / twice, e[0] / twice]
        });
        GaussElement { gradient: [gradient], area: [0.5 * twice] }
    }

    fn area(&self) -> f64 {
        self.area[0]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SHAPES: [[[f64; 2]; 4]; 3] = [
        [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]],
        [[0.0, 0.0], [2.0, 0.3], [2.4, 1.5], [0.2, 1.0]],
        [[1.0, 1.0], [0.5, 2.0], [-0.7, 1.4], [0.0, 0.2]],
    ];

    #[test]
    fn gradients_reproduce_linear_fields_and_the_area() {
        for x in SHAPES {
            let shoelace: f64 =
                (0..4).map(|a| x[a][0] * x[(a + 1) % 4][1] - x[(a + 1) % 4][0] * x[a][1]).sum::<f64>() / 2.0;
            let centre = OnePointElement::shaped(&x);
            let full = GaussElement::<4, 4>::shaped(&x);
            assert!((centre.area - shoelace).abs() < 1e-14);
            assert!((full.area.iter().sum::<f64>() - shoelace).abs() < 1e-14);
            let [first, second] = centre.gradient;
            let opposite = [first, second, first.map(|b| -b), second.map(|b| -b)];
            for point in full.gradient.into_iter().chain([opposite]) {
                for i in 0..2 {
                    for j in 0..2 {
                        let sum: f64 = (0..4).map(|a| point[a][i] * x[a][j]).sum();
                        assert!((sum - f64::from(u8::from(i == j))).abs() < 1e-13);
                    }
                }
            }
        }
    }

    #[test]
    fn the_hourglass_shape_is_orthogonal_to_linear_fields() {
        for x in SHAPES {
            let [first, second] = OnePointElement::shaped(&x).skew;
            let shape = [0.25 - first, -0.25 - second, 0.25 + first, -0.25 + second];
            let along = |field: &dyn Fn(usize) -> f64| (0..4).map(|a| shape[a] * field(a)).sum::<f64>();
            assert!(along(&|_| 1.0).abs() < 1e-14);
            assert!(along(&|a| x[a][0]).abs() < 1e-14);
            assert!(along(&|a| x[a][1]).abs() < 1e-14);
            assert!((along(&|a| MODE[a]) - 1.0).abs() < 1e-14);
        }
    }

    #[test]
    fn gradients_of_a_triangle_reproduce_linear_fields() {
        let x = [[0.2, 0.1], [1.4, 0.3], [0.5, 1.1]];
        let element = GaussElement::<3, 1>::shaped(&x);
        for i in 0..2 {
            for j in 0..2 {
                let sum: f64 = (0..3).map(|a| element.gradient[0][a][i] * x[a][j]).sum();
                assert!((sum - f64::from(u8::from(i == j))).abs() < 1e-14);
            }
        }
        assert!((element.area[0] - 0.5 * (1.2 * 1.0 - 0.2 * 0.3)).abs() < 1e-14);
    }
}
