//! The three-node membrane element of constant strain, with nodes counter-clockwise.

use super::gauss::GaussElement;

/// Gradients of the linear shape functions and the area of the stress-free triangle.
pub(super) fn constant_strain(x: &[[f64; 2]; 3]) -> GaussElement<3, 1> {
    let edge = |a: usize, b: usize| [x[b][0] - x[a][0], x[b][1] - x[a][1]];
    let (u, v) = (edge(0, 1), edge(0, 2));
    let twice = u[0] * v[1] - u[1] * v[0];
    let gradient = [(1, 2), (2, 0), (0, 1)].map(|(a, b)| {
        let e = edge(a, b);
        [-e[1] / twice, e[0] / twice]
    });
    GaussElement { gradient: [gradient], area: [0.5 * twice] }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gradients_reproduce_linear_fields() {
        let x = [[0.2, 0.1], [1.4, 0.3], [0.5, 1.1]];
        let element = constant_strain(&x);
        for i in 0..2 {
            for j in 0..2 {
                let sum: f64 = (0..3).map(|a| element.gradient[0][a][i] * x[a][j]).sum();
                assert!((sum - f64::from(u8::from(i == j))).abs() < 1e-14);
            }
        }
        assert!((element.area[0] - 0.5 * (1.2 * 1.0 - 0.2 * 0.3)).abs() < 1e-14);
    }
}
