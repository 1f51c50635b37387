//! The four-node membrane element (theory.md, section 3), with nodes counter-clockwise.

use super::gauss::GaussElement;
use super::one_point::OnePointElement;

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

/// One point at the centre (Flanagan and Belytschko 1981 for the shape of the hourglass mode; theory.md, equation 11).
pub(super) fn one_point(x: &[[f64; 2]; 4]) -> OnePointElement {
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

/// 2×2 Gauss points.
pub(super) fn four_points(x: &[[f64; 2]; 4]) -> GaussElement<4, 4> {
    let g = 1.0 / 3.0_f64.sqrt();
    let maps = CORNERS.map(|[a, b]| map(x, [a * g, b * g]));
    GaussElement {
        gradient: std::array::from_fn(|p| maps[p].gradient),
        area: std::array::from_fn(|p| maps[p].determinant),
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
            let centre = one_point(&x);
            let full = four_points(&x);
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
            let [first, second] = one_point(&x).skew;
            let shape = [0.25 - first, -0.25 - second, 0.25 + first, -0.25 + second];
            let along = |field: &dyn Fn(usize) -> f64| (0..4).map(|a| shape[a] * field(a)).sum::<f64>();
            assert!(along(&|_| 1.0).abs() < 1e-14);
            assert!(along(&|a| x[a][0]).abs() < 1e-14);
            assert!(along(&|a| x[a][1]).abs() < 1e-14);
            assert!((along(&|a| MODE[a]) - 1.0).abs() < 1e-14);
        }
    }
}
