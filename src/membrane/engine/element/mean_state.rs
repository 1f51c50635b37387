//! Mean state of single elements, from which the energy that a tear releases follows (theory.md, section 25).

use super::block::Block;
use super::elements::Elements;
use crate::lane::{LANES, Lane, Width, one};
use crate::material::{Densities, MembraneLaw};

/// Gradients ∂N_a/∂X_I (1/m) of the shape functions of an element along MD and TD of the stress-free film; that of a
/// triangle's missing corner is zero.
pub(crate) type Gradients = [[f64; 2]; 4];

/// Mean state of one element.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MeanState {
    /// Means over the element.
    pub gradients: Gradients,
    /// f₁ and f₂.
    pub f: [[f64; 3]; 2],
    /// Second Piola–Kirchhoff stresses S₁₁, S₂₂ and S₁₂ with the share of the forces that heat and its tear left, Pa of one layer.
    pub stress: [f64; 3],
    /// Energy stored, in the stabilisation included, with that share, J/m³.
    pub stored: f64,
    /// Energy absorbed, with that share, J/m³.
    pub absorbed: f64,
    /// Volume of stress-free film, m³; zero once it is deleted.
    pub volume: f64,
}

impl MeanState {
    /// Its mirror image across a plane with this normal along MD and TD, which is the axis `axis` in space.
    pub(crate) fn mirrored(self, normal: [f64; 2], axis: usize) -> MeanState {
        let [a, b] = normal;
        // I − 2 n nᵀ.
        let turn = [[1.0 - 2.0 * a * a, -2.0 * a * b], [-2.0 * a * b, 1.0 - 2.0 * b * b]];
        let reflected = |v: [f64; 2]| [turn[0][0] * v[0] + turn[0][1] * v[1], turn[1][0] * v[0] + turn[1][1] * v[1]];
        let [s11, s22, s12] = self.stress;
        let rows = [[s11, s12], [s12, s22]].map(reflected);
        let columns = [[rows[0][0], rows[1][0]], [rows[0][1], rows[1][1]]].map(reflected);
        let mut f = [0, 1].map(|i| std::array::from_fn(|k| turn[i][0] * self.f[0][k] + turn[i][1] * self.f[1][k]));
        f.iter_mut().for_each(|f: &mut [f64; 3]| f[axis] = -f[axis]);
        let stress = [columns[0][0], columns[1][1], columns[0][1]];
        MeanState { gradients: self.gradients.map(reflected), f, stress, ..self }
    }

    /// Share of the work done on it that it would return.
    pub(crate) fn returned(&self) -> f64 {
        let work = self.stored + self.absorbed;
        if work > 0.0 { self.stored / work } else { 1.0 }
    }

    /// Part of the element in the material force (N, along MD and TD) on nodes whose shape functions have the sum of
    /// gradients `gradient` (1/m) in it, for film around it that is deformed by `mean`, if it returned all work (theory.md,
    /// equation 304).
    pub(crate) fn material_force(&self, gradient: [f64; 2], mean: &[[f64; 3]; 2]) -> [f64; 2] {
        let work = self.stored + self.absorbed;
        if self.volume == 0.0 || work <= 0.0 {
            return [0.0; 2];
        }
        let dot = |a: &[f64; 3], b: &[f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let ([s11, s22, s12], [q1, q2]) = (self.stress, gradient);
        let flux = [s11 * q1 + s12 * q2, s12 * q1 + s22 * q2];
        std::array::from_fn(|i| {
            let relative: [f64; 3] = std::array::from_fn(|k| self.f[i][k] - mean[i][k]);
            self.volume
                * (flux[0] * dot(&relative, &self.f[0]) + flux[1] * dot(&relative, &self.f[1]) - work * gradient[i])
        })
    }
}

impl<M: MembraneLaw, B: Block<M, NODES, LANES>, const NODES: usize> Elements<M, B, NODES> {
    /// Mean state of the element at a block and lane.
    #[cfg_attr(not(test), inline)]
    pub(super) fn mean_state(&self, [b, l]: [usize; 2], position: &[&[f64]; 3]) -> MeanState {
        let (block, x) = (&self.blocks[b], self.gather(b, position));
        let left = self.common.tearing.as_ref().map_or(1.0, |tearing| tearing.share(b)[l]);
        let volume = block.volume();
        let Densities { stored, absorbed } = self.warm_energies(Width::best(), b, &x).densities(&volume, l);
        let share = self.common.share(b)[l];
        MeanState {
            gradients: gradients_of::<M, B, NODES>(block, l),
            f: block.deformation(&x).f.map(|f| f.map(|axis| axis[l])),
            stress: block.stress(&self.law, self.viscous_block(b), &x).map(|s| share * s[l]),
            stored: left * stored,
            absorbed: left * absorbed,
            volume: volume[l],
        }
    }
}

/// Gradients of the element in a lane.
#[inline(always)]
pub(super) fn gradients_of<M: MembraneLaw, B: Block<M, NODES, LANES>, const NODES: usize>(
    block: &B,
    lane: usize,
) -> Gradients {
    let mut gradients = [[0.0; 2]; 4];
    for (of, own) in gradients.iter_mut().zip(block.gradients()) {
        *of = own.map(|b| b[lane]);
    }
    gradients
}

/// Corners (m, along MD and TD) of an element with these gradients, from its middle; of a quadrilateral those of the
/// parallelogram with its diagonals.
pub(crate) fn corners(gradients: &Gradients) -> [[f64; 2]; 4] {
    let [g0, g1, g2, g3] = *gradients;
    let is_triangle = g3 == [0.0; 2];
    // Of the two diagonals, or of two sides of a triangle, these are the rows of the inverse.
    let half = |a: [f64; 2], b: [f64; 2]| [0.5 * (a[0] - b[0]), 0.5 * (a[1] - b[1])];
    let [a, b] = if is_triangle { [g0, g1] } else { [half(g0, g2), half(g1, g3)] };
    let determinant = a[0] * b[1] - a[1] * b[0];
    let [p, q] = [[b[1] / determinant, -b[0] / determinant], [-a[1] / determinant, a[0] / determinant]];
    let sum = |by_p: f64, by_q: f64| [by_p * p[0] + by_q * q[0], by_p * p[1] + by_q * q[1]];
    if is_triangle {
        let third = 1.0 / 3.0;
        let last = sum(-third, -third);
        return [sum(1.0 - third, -third), sum(-third, 1.0 - third), last, last];
    }
    [sum(0.5, 0.0), sum(0.0, 0.5), sum(-0.5, 0.0), sum(0.0, -0.5)]
}

/// Extent (m) of an element with these gradients along the largest stretch in stress-free film; of a triangle that through its
/// middle corner (theory.md, equation 300).
pub(super) fn width_across(gradients: &Gradients, metric: [f64; 3]) -> f64 {
    let [c11, c22, c12] = metric;
    let eigenvalue = largest(&metric.map(one))[0];
    // Of the two columns of C − λ₂ the longer.
    let smaller = c11 + c22 - eigenvalue;
    let candidates = [[c11 - smaller, c12], [c12, c22 - smaller]];
    let squared = candidates.map(|[a, b]| a * a + b * b);
    // Either is an eigenvector, but one of them vanishes where the largest stretch is along MD or TD.
    let [a, b] = if squared[0] >= squared[1] { candidates[0] } else { candidates[1] };
    let length = (a * a + b * b).sqrt();
    let n = if length > 0.0 { [a / length, b / length] } else { [1.0, 0.0] };
    if gradients[3] == [0.0; 2] {
        return 2.0 / gradients.iter().map(|g| (n[0] * g[0] + n[1] * g[1]).abs()).sum::<f64>();
    }
    let along = corners(gradients).map(|x| n[0] * x[0] + n[1] * x[1]);
    let (least, most) = along.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (x.min(a), x.max(b)));
    most - least
}

/// Larger eigenvalues of symmetric matrices with these components 11, 22 and 12.
#[inline(always)]
pub(super) fn largest<const L: usize>(&[first, second, between]: &[Lane<L>; 3]) -> Lane<L> {
    let (mean, half) = (0.5 * (first + second), 0.5 * (first - second));
    mean + (half * half + between * between).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parallelogram(along: [f64; 2], across: [f64; 2]) -> Gradients {
        // Diagonals from the first and the second corner to the opposite ones.
        let [d0, d1] = [[-along[0] - across[0], -along[1] - across[1]], [along[0] - across[0], along[1] - across[1]]];
        let determinant = d0[0] * d1[1] - d0[1] * d1[0];
        let [a, b] = [[d1[1] / determinant, -d1[0] / determinant], [-d0[1] / determinant, d0[0] / determinant]];
        [a, b, a.map(|x| -x), b.map(|x| -x)]
    }

    #[test]
    fn the_width_of_a_square_that_is_turned() {
        let size = 0.01;
        for degrees in [0.0_f64, 22.5, 45.0, 70.0] {
            let (sin, cos) = degrees.to_radians().sin_cos();
            let square = parallelogram([size * cos, size * sin], [-size * sin, size * cos]);
            // The largest stretch is along the second axis.
            let width = width_across(&square, [1.0, 1.44, 0.0]);
            assert!((width / (size * (sin + cos)) - 1.0).abs() < 1e-12, "{degrees}: {width}");
        }
        let square = parallelogram([size, 0.0], [0.0, size]);
        assert!((width_across(&square, [1.2, 1.2, 0.2]) / (2.0_f64.sqrt() * size) - 1.0).abs() < 1e-12);
        assert!((width_across(&square, [1.44, 1.44, 0.0]) / size - 1.0).abs() < 1e-12);
    }

    /// Elements that a straight tear crosses one after another, each as long as its area over its width, are together as
    /// long as the tear: of parallelograms in any direction.
    #[test]
    fn the_lengths_of_the_elements_of_a_tear_add_up() {
        let (a, b) = ([0.01, 0.002], [-0.004, 0.006]);
        let shape = parallelogram(a, b);
        let area = a[0] * b[1] - a[1] * b[0];
        for (rows, columns) in [(1.0, 0.0), (3.0, 2.0), (1.0, 5.0)] {
            let tear = [rows * a[0] + columns * b[0], rows * a[1] + columns * b[1]];
            let length = (tear[0] * tear[0] + tear[1] * tear[1]).sqrt();
            let n = [-tear[1] / length, tear[0] / length];
            // C = I + n nᵀ.
            let width = width_across(&shape, [1.0 + n[0] * n[0], 1.0 + n[1] * n[1], n[0] * n[1]]);
            assert!(((rows + columns) * area / width / length - 1.0).abs() < 1e-12, "{rows}, {columns}");
        }
    }

    #[test]
    fn the_corners_of_a_triangle() {
        let x = [[0.01, 0.0], [0.03, 0.01], [0.0, 0.02]];
        let area = (x[1][0] - x[0][0]) * (x[2][1] - x[0][1]) - (x[1][1] - x[0][1]) * (x[2][0] - x[0][0]);
        let gradient = |a: usize| {
            let (next, last) = (x[(a + 1) % 3], x[(a + 2) % 3]);
            [(next[1] - last[1]) / area, (last[0] - next[0]) / area]
        };
        let found = corners(&[gradient(0), gradient(1), gradient(2), [0.0; 2]]);
        let middle = [0, 1].map(|i| (x[0][i] + x[1][i] + x[2][i]) / 3.0);
        for (found, expected) in found.iter().zip(x) {
            assert!((0..2).all(|i| (found[i] - (expected[i] - middle[i])).abs() < 1e-15), "{found:?}");
        }
    }
}
