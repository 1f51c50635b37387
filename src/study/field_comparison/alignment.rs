//! The rigid motion from the axes of a field to those of a run, found from places and displacements together.

use std::f64::consts::{PI, TAU};

use nalgebra::{Matrix3, Matrix3x6, Matrix6, Rotation3, SymmetricEigen, UnitQuaternion, Vector3, Vector6};

use crate::field_comparison::comparison::{FilmSurface, Nearest};
use lab::dic::{Field, FieldState, RigidMotion};
use scene::simulate::FaceState;

/// How the field was brought into the axes of the run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Alignment {
    /// From the axes of the field to those of the run.
    pub motion: RigidMotion,
    /// Of a motion that was found, how well it is known.
    pub found: Option<FoundMotion>,
}

/// How well a motion that was found is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FoundMotion {
    /// Standard deviation of its residuals, m: of measurement and run together.
    pub deviation: f64,
    /// Standard deviation of the place to which it brings a point at the radius of gyration of the field, in the direction in which
    /// it is known least, m; for residuals that do not depend on each other.
    pub least_known: f64,
    /// Radius of gyration of the field, m.
    pub radius: f64,
    /// Number of other motions that fit as well, as of a square film that is loaded in its centre.
    pub others: usize,
    /// Smallest angle between one of them and this one, rad; zero where there are none.
    pub apart: f64,
}

impl FoundMotion {
    /// Whether some part of the motion is not determined.
    pub fn is_uncertain(&self) -> bool {
        self.least_known.is_nan() || self.least_known > UNCERTAIN * self.radius
    }
}

/// Standard deviation over the radius of the field above which a motion counts as not determined.
const UNCERTAIN: f64 = 0.01;
/// Points and states of the first search, from all starts, and of the last.
const COARSE: [usize; 2] = [120, 2];
const FINE: [usize; 2] = [1500, 10];
/// Steps of both.
const STEPS: [usize; 2] = [12, 40];
/// Step over the radius of the field, and share of the cost by which it falls, below which a search ends.
const SHORT: f64 = 1e-8;
const LITTLE: f64 = 1e-9;
/// Starts that are followed to their end.
const FOLLOWED: usize = 4;
/// Share of the deviation by which another motion may fit worse than the best and still as well.
const AS_WELL: f64 = 0.02;
/// 2³² over the golden ratio: multiples of it fill the range of a `u32` evenly (Knuth 1973, section 6.4).
const GOLDEN: u32 = 2_654_435_769;
/// Angle from which on motions are different, rad.
const DIFFERENT: f64 = 0.05;

/// Finds the motion of `field` onto the film, of whose states each is beside a state of the field; none without a state.
pub fn find(surface: &FilmSurface<'_>, field: &Field, states: &[Pair<'_>]) -> Option<Alignment> {
    let size = |pair: &Pair<'_>| pair.field.points.iter().map(|(_, u)| Vector3::from(*u).norm_squared()).sum::<f64>();
    let most = (0..states.len()).max_by(|a, b| size(&states[*a]).total_cmp(&size(&states[*b])))?;
    let [coarse, fine] = [COARSE, FINE].map(|sizes| problem(surface, field, states, sizes, most));
    let starts = starts(surface, &field.places, &states[most]);
    let mut found: Vec<(f64, RigidMotion)> = starts.iter().map(|start| fit(&coarse, *start, STEPS[0])).collect();
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    // Of equal motions only one is followed.
    let mut followed: Vec<(f64, RigidMotion)> = Vec::new();
    for (_, motion) in found {
        let is_new = followed.iter().all(|(_, known)| known.rotation.angle_to(&motion.rotation) > DIFFERENT);
        if is_new && followed.len() < FOLLOWED {
            followed.push(fit(&fine, motion, STEPS[1]));
        }
    }
    let least = followed.iter().map(|(deviation, _)| *deviation).reduce(f64::min)?;
    let as_well = followed.iter().filter(|(deviation, _)| *deviation <= (1.0 + AS_WELL) * least);
    let mut alike: Vec<RigidMotion> = as_well.map(|(_, motion)| *motion).collect();
    // Of motions that fit alike the smallest turn: the axes of a field are often about those of the run.
    alike.sort_by(|a, b| a.rotation.angle().total_cmp(&b.rotation.angle()));
    let (motion, others) = alike.split_first()?;
    let apart = |other: &RigidMotion| other.rotation.angle_to(&motion.rotation);
    // Both mirror planes of a film together are half a turn, which is as right.
    let half_turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), PI) * motion.rotation;
    let is_image =
        |other: &&RigidMotion| surface.mirrored() == [true, true] && other.rotation.angle_to(&half_turn) < DIFFERENT;
    let others = others.iter().filter(|other| !is_image(other)).map(apart);
    let others: Vec<f64> = others.filter(|angle| *angle > DIFFERENT).collect();
    let linearized = fine.linearized(motion);
    let deviation = linearized.deviation();
    let found = FoundMotion {
        deviation,
        least_known: linearized.normal_equations(deviation).least_known(deviation),
        radius: fine.radius,
        others: others.len(),
        apart: others.into_iter().reduce(f64::min).unwrap_or(0.0),
    };
    Some(Alignment { motion: *motion, found: Some(found) })
}

/// The root mean loss of the residuals and the motion at which Levenberg and Marquardt's method ends.
fn fit(problem: &Problem<'_>, start: RigidMotion, steps: usize) -> (f64, RigidMotion) {
    let (mut motion, mut damping) = (start, 1e-3);
    let mut linearized = problem.linearized(&motion);
    for _ in 0..steps {
        let deviation = linearized.deviation();
        let now = linearized.normal_equations(deviation);
        let Some(step) = now.step(damping) else { break };
        let trial = problem.stepped(&motion, &step);
        let next = problem.linearized(&trial);
        let cost = next.cost(deviation);
        if cost < now.cost {
            (motion, linearized) = (trial, next);
            damping *= 0.1;
            if step.norm() < SHORT * problem.radius || now.cost - cost < LITTLE * now.cost {
                break;
            }
        } else if damping > 1e4 || step.norm() < SHORT * problem.radius {
            break;
        } else {
            damping *= 10.0;
        }
    }
    (linearized.root_mean_loss(), motion)
}

/// At most so many points of at most so many states, `most` among them, spread evenly.
fn problem<'a>(
    surface: &'a FilmSurface<'a>,
    field: &'a Field,
    states: &[Pair<'a>],
    [points, count]: [usize; 2],
    most: usize,
) -> Problem<'a> {
    let stride = field.places.len().div_ceil(points).max(1);
    let spaced = states.len().div_ceil(count).max(1);
    // Every so many-th point of a grid would be a column of it.
    let is_taken = |place: u32| place.wrapping_mul(GOLDEN) <= u32::MAX / stride as u32;
    let chosen = (0..states.len()).filter(|place| *place == most || (place + 1) % spaced == 0);
    let of_state = |place: usize| {
        let Pair { film, field } = states[place];
        (film, field.points.iter().filter(|(place, _)| is_taken(*place)).copied().collect())
    };
    let places = || field.places.iter().map(|place| Vector3::from(*place));
    let count = field.places.len().max(1) as f64;
    let centre = places().sum::<Vector3<f64>>() / count;
    let square = places().map(|place| (place - centre).norm_squared()).sum::<f64>() / count;
    let radius = square.sqrt().max(f64::MIN_POSITIVE);
    Problem { surface, places: &field.places, states: chosen.map(of_state).collect(), centre, radius }
}

/// A state of the field and that of the film at its time.
#[derive(Clone, Copy)]
pub struct Pair<'a> {
    pub film: &'a FaceState,
    pub field: &'a FieldState,
}

/// Turns in the plane.
const TURNS: u32 = 12;

/// No motion, and the motions that bring the plane of the `places` onto that of the film, and the centre of the displacements
/// of one state onto that of the film's: both sides up, in steps of 30°.
pub fn starts(surface: &FilmSurface<'_>, places: &[[f64; 3]], pair: &Pair<'_>) -> Vec<RigidMotion> {
    let of_field = Cloud::new(pair.field.points.iter().map(|(place, displacement)| {
        (Vector3::from(places[*place as usize]), Vector3::from(*displacement).norm_squared())
    }));
    let of_film =
        Cloud::new(surface.points().map(|(node, place)| {
            (place, pair.film.displacements[node].iter().map(|part| f64::from(part * part)).sum())
        }));
    let mut starts = vec![RigidMotion::identity()];
    let (Some(of_field), Some(of_film)) = (of_field, of_film) else { return starts };
    for side in [Matrix3::identity(), Matrix3::from_diagonal(&Vector3::new(1.0, -1.0, -1.0))] {
        for turn in 0..TURNS {
            let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), TAU * f64::from(turn) / f64::from(TURNS));
            let matrix = of_film.axes * turn.matrix() * side * of_field.axes.transpose();
            let rotation = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(matrix));
            starts.push(RigidMotion { rotation, translation: of_film.centre - rotation * of_field.centre });
        }
    }
    starts
}

/// Points with weights.
struct Cloud {
    /// Their centre by weight.
    centre: Vector3<f64>,
    /// Principal axes of the points without weights, right-handed, the normal of their plane last.
    axes: Matrix3<f64>,
}

impl Cloud {
    fn new(points: impl Iterator<Item = (Vector3<f64>, f64)>) -> Option<Cloud> {
        let points: Vec<(Vector3<f64>, f64)> = points.collect();
        let total: f64 = points.iter().map(|(_, weight)| weight).sum();
        let mean = points.iter().map(|(place, _)| place).sum::<Vector3<f64>>() / points.len() as f64;
        let centre = if total > 0.0 {
            points.iter().map(|(place, weight)| *weight * place).sum::<Vector3<f64>>() / total
        } else {
            mean
        };
        let spread: Matrix3<f64> = points.iter().map(|(place, _)| (place - mean) * (place - mean).transpose()).sum();
        if !(spread.trace() > 0.0 && spread.trace().is_finite() && centre.iter().all(|part| part.is_finite())) {
            return None;
        }
        let eigen = SymmetricEigen::new(spread);
        let mut order = [0, 1, 2];
        order.sort_by(|a, b| eigen.eigenvalues[*b].total_cmp(&eigen.eigenvalues[*a]));
        let [first, second] = [order[0], order[1]].map(|place| eigen.eigenvectors.column(place).into_owned());
        Some(Cloud { centre, axes: Matrix3::from_columns(&[first, second, first.cross(&second)]) })
    }
}

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
