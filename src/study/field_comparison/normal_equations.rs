//! The residuals of a rigid motion and their normal equations.

use nalgebra::{Matrix3, Matrix3x6, Matrix6, SymmetricEigen, UnitQuaternion, Vector3, Vector6};

use super::surface::{FilmSurface, Nearest};
use lab::dic::RigidMotion;
use scene::simulate::FaceState;

/// Index of the place and displacement (m) of a measured point.
type Measured = (u32, [f64; 3]);

/// What a motion is fitted to.
pub struct Problem<'a> {
    pub surface: &'a FilmSurface<'a>,
    /// Undeformed places in the axes of the field, m.
    pub places: &'a [[f64; 3]],
    /// Displacements at some times beside the states of the run.
    pub states: Vec<(&'a FaceState, Vec<Measured>)>,
    /// Centre of rotation and radius of gyration of the places, m, by which rotations become lengths.
    pub centre: Vector3<f64>,
    pub radius: f64,
}

/// Residuals at a motion, m, each with its derivatives by translations and rotations times the radius.
pub struct Linearized(Vec<(f64, Vector6<f64>)>);

/// Normal equations of residuals under a loss.
pub struct NormalEquations {
    pub matrix: Matrix6<f64>,
    pub gradient: Vector6<f64>,
    /// Sum of the losses, m².
    pub cost: f64,
}

/// Bound of the loss of Huber (1964) over the standard deviation: 95 % efficient for normal residuals.
const HUBER: f64 = 1.345;
/// Standard deviation of normal residuals over the median of their absolute values.
const OF_MEDIAN: f64 = 1.4826;

impl Problem<'_> {
    /// The residuals at a motion (methods.md, section 27): of each point its distance from the film along the normal and past the edge,
    /// and of each point and time the displacement, R u − u_film.
    pub fn linearized(&self, motion: &RigidMotion) -> Linearized {
        let mut rows = Vec::new();
        let centre = Vector3::from(motion.apply(self.centre.into()));
        let mut slots: Vec<Option<(Nearest, Matrix3x6<f64>)>> = vec![None; self.places.len()];
        for place in self.used() {
            let point = Vector3::from(motion.apply(self.places[place as usize]));
            let nearest = self.surface.nearest(point);
            let moves = self.moves(point - centre);
            let above = nearest.normal.dot(&nearest.offset);
            rows.push((above, moves.transpose() * nearest.normal));
            let past = nearest.offset - above * nearest.normal;
            // Round-off has no direction.
            if let Some(direction) = past.try_normalize(1e-9 * self.radius) {
                rows.push((past.norm(), moves.transpose() * direction));
            }
            slots[place as usize] = Some((nearest, moves));
        }
        for (state, points) in &self.states {
            for (place, measured) in points {
                let Some((nearest, moves)) = &slots[*place as usize] else { continue };
                let turned = Vector3::from(motion.rotate(*measured));
                let residual = turned - nearest.displacement(state);
                let mut jacobian = -(nearest.displacement_gradient(state) * moves);
                let mut rotations = jacobian.fixed_view_mut::<3, 3>(0, 3);
                rotations -= turned.cross_matrix() / self.radius;
                rows.extend((0..3).map(|axis| (residual[axis], jacobian.row(axis).transpose())));
            }
        }
        Linearized(rows)
    }

    /// A point moves by τ + ω × (x − c): the derivatives, of rotations times the radius.
    fn moves(&self, arm: Vector3<f64>) -> Matrix3x6<f64> {
        let mut moves = Matrix3x6::zeros();
        moves.fixed_view_mut::<3, 3>(0, 0).copy_from(&Matrix3::identity());
        moves.fixed_view_mut::<3, 3>(0, 3).copy_from(&(-arm.cross_matrix() / self.radius));
        moves
    }

    /// Places that any of the states has, each once.
    fn used(&self) -> impl Iterator<Item = u32> + '_ {
        let mut is_used = vec![false; self.places.len()];
        self.states.iter().flat_map(|(_, points)| points).for_each(|(place, _)| is_used[*place as usize] = true);
        (0u32..).zip(is_used).filter(|(_, is_used)| *is_used).map(|(place, _)| place)
    }

    /// The motion after a step of translation and rotation times the radius.
    pub fn stepped(&self, motion: &RigidMotion, step: &Vector6<f64>) -> RigidMotion {
        let (by, turn) = (step.fixed_rows::<3>(0).into_owned(), step.fixed_rows::<3>(3) / self.radius);
        let turn = UnitQuaternion::from_scaled_axis(turn);
        let centre = Vector3::from(motion.apply(self.centre.into()));
        // x ↦ c + turn (x − c) + by.
        RigidMotion {
            rotation: turn * motion.rotation,
            translation: centre + by + turn * (motion.translation - centre),
        }
    }
}

impl Linearized {
    /// Standard deviation of the residuals by the median of their sizes, m.
    pub fn deviation(&self) -> f64 {
        let mut sizes: Vec<f64> = self.0.iter().map(|(residual, _)| residual.abs()).collect();
        if sizes.is_empty() {
            return 0.0;
        }
        let middle = sizes.len() / 2;
        OF_MEDIAN * *sizes.select_nth_unstable_by(middle, f64::total_cmp).1
    }

    /// Root of the mean loss of a residual times two, m: the standard deviation where the loss is that of least squares.
    pub fn root_mean_loss(&self) -> f64 {
        (2.0 * self.cost(self.deviation()) / self.0.len().max(1) as f64).sqrt()
    }

    /// Sum of their losses for residuals of this standard deviation (m), m².
    pub fn cost(&self, deviation: f64) -> f64 {
        let bound = bound(deviation);
        self.0.iter().map(|(residual, _)| loss(residual.abs(), bound)).sum()
    }

    /// Their normal equations under the loss of Huber, for residuals of this standard deviation (m).
    pub fn normal_equations(&self, deviation: f64) -> NormalEquations {
        let bound = bound(deviation);
        let (mut matrix, mut gradient, mut cost) = (Matrix6::zeros(), Vector6::zeros(), 0.0);
        for (residual, row) in &self.0 {
            let size = residual.abs();
            let weight = if size <= bound { 1.0 } else { bound / size };
            cost += loss(size, bound);
            matrix += weight * row * row.transpose();
            gradient += weight * *residual * row;
        }
        NormalEquations { matrix, gradient, cost }
    }
}

/// The bound of the loss for residuals of this standard deviation.
fn bound(deviation: f64) -> f64 {
    (HUBER * deviation).max(f64::MIN_POSITIVE)
}

/// The loss of Huber of a residual of this size.
fn loss(size: f64, bound: f64) -> f64 {
    if size <= bound { 0.5 * size * size } else { bound * (size - 0.5 * bound) }
}

impl NormalEquations {
    /// The step of Levenberg and Marquardt; none where nothing determines it.
    pub fn step(&self, damping: f64) -> Option<Vector6<f64>> {
        let least = 1e-12 * self.matrix.trace();
        let mut matrix = self.matrix;
        (0..6).for_each(|place| matrix[(place, place)] += damping * matrix[(place, place)] + least);
        matrix.cholesky().map(|factors| factors.solve(&-self.gradient))
    }

    /// Standard deviation of the combination of translations and rotations times the radius that is known least, m, for residuals of
    /// this standard deviation (m).
    pub fn least_known(&self, deviation: f64) -> f64 {
        let smallest = SymmetricEigen::new(self.matrix).eigenvalues.min();
        if smallest > 0.0 { deviation / smallest.sqrt() } else { f64::INFINITY }
    }
}
