//! The errors of a run against a field.

use nalgebra::{Matrix2, Matrix3, Vector2, Vector3};
use parry3d_f64::math::Vector;
use parry3d_f64::query::PointQueryWithLocation;
use parry3d_f64::shape::TriMesh;
use thiserror::Error;

use crate::field_comparison::alignment::{self, Alignment, Pair};
use base::number::{clean_time, rounded};
use base::table::Column;
use lab::dic::{Field, FieldState, RigidMotion};
use scene::model::Align;
use scene::scenario::Marker;
use scene::simulate::{FaceMotion, FaceState};

/// Significant digits of the table of errors: finer than any measurement.
const DIGITS: usize = 7;

/// A run beside a displacement field, in the axes of the run.
#[derive(Clone, Debug, PartialEq)]
pub struct FieldComparison {
    /// Index of the face.
    pub face: usize,
    /// How the field was brought into the axes of the run.
    pub alignment: Alignment,
    /// Undeformed places of all measured points, m.
    pub places: Vec<[f64; 3]>,
    /// Whether each lies on the film: no farther from it than the mean side of an element.
    pub on_film: Vec<bool>,
    /// The states that are compared.
    pub states: Vec<StateErrors>,
    /// States of the field outside of the window or of the time of the run.
    pub outside: usize,
    /// Times within the window that the run did not reach, s.
    pub not_reached: Vec<f64>,
}

/// The errors at one time.
#[derive(Clone, Debug, PartialEq)]
pub struct StateErrors {
    /// Time, s.
    pub time: f64,
    /// Every point that was matched.
    pub points: Vec<PointError>,
    /// Points that were not matched.
    pub missing: usize,
    /// Errors of the points on the film.
    pub norms: ErrorNorms,
}

/// Measured and simulated displacement of a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointError {
    /// Index of the place.
    pub place: u32,
    /// As measured, m.
    pub measured: [f64; 3],
    /// Of the nearest point of the film, m.
    pub simulated: [f64; 3],
}

/// Norms of the errors of some points.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ErrorNorms {
    /// Number of points.
    pub points: usize,
    /// Sum of the squares of the errors, m².
    squares: f64,
    /// Sum of the squares of the measured displacements, m².
    measured: f64,
    largest: f64,
}

/// Why a run cannot be compared with a field.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum NoComparison {
    /// The run ended before the first file, or no file lies within the window.
    #[error("the run has reached the time of none of its files within the window")]
    NoState,
    /// The film has no elements.
    #[error("the film has no surface")]
    NoSurface,
}

impl PointError {
    /// Simulated less measured displacement, m.
    pub fn error(&self) -> [f64; 3] {
        [0, 1, 2].map(|axis| self.simulated[axis] - self.measured[axis])
    }

    /// Size of the error, m.
    pub fn size(&self) -> f64 {
        Vector3::from(self.error()).norm()
    }
}

impl ErrorNorms {
    /// Root mean square of the sizes of the errors, m.
    pub fn rms(&self) -> Option<f64> {
        (self.points > 0).then(|| (self.squares / self.points as f64).sqrt())
    }

    /// Largest error, m.
    pub fn largest(&self) -> Option<f64> {
        (self.points > 0).then_some(self.largest)
    }

    /// ‖u − u_m‖/‖u_m‖ over all points and times, as of signals (paper, equation 15); none where nothing has moved.
    pub fn relative(&self) -> Option<f64> {
        (self.measured > 0.0).then(|| (self.squares / self.measured).sqrt())
    }

    fn add(&mut self, point: &PointError) {
        let size = point.size();
        self.points += 1;
        self.squares += size * size;
        self.measured += Vector3::from(point.measured).norm_squared();
        self.largest = self.largest.max(size);
    }

    fn join(self, other: &ErrorNorms) -> ErrorNorms {
        ErrorNorms {
            points: self.points + other.points,
            squares: self.squares + other.squares,
            measured: self.measured + other.measured,
            largest: self.largest.max(other.largest),
        }
    }
}

impl FieldComparison {
    /// Compares the `motion` of a face with `field` within a window of times, s.
    ///
    /// # Errors
    /// There is no state to compare.
    pub fn new(
        motion: &FaceMotion,
        field: &Field,
        align: &Align,
        [from, to]: [f64; 2],
    ) -> Result<FieldComparison, NoComparison> {
        let surface = FilmSurface::of_motion(motion).ok_or(NoComparison::NoSurface)?;
        let (mut pairs, mut not_reached, mut outside) = (Vec::new(), Vec::new(), 0);
        for state in &field.states {
            match motion.states.iter().find(|own| own.time == state.time) {
                _ if !(from..=to).contains(&state.time) => outside += 1,
                Some(film) => pairs.push(Pair { film, field: state }),
                None => not_reached.push(state.time),
            }
        }
        let alignment = match align {
            Align::None => Some(Alignment { motion: RigidMotion::identity(), found: None }),
            Align::Markers(markers) => {
                let pairs: Vec<_> = markers.iter().map(Marker::pair).collect();
                RigidMotion::of_pairs(&pairs).map(|motion| Alignment { motion, found: None })
            }
            Align::Rigid => alignment::find(&surface, field, &pairs),
        };
        let alignment = alignment.filter(|_| !pairs.is_empty()).ok_or(NoComparison::NoState)?;
        let places: Vec<[f64; 3]> = field.places.iter().map(|place| alignment.motion.apply(*place)).collect();
        let nearest: Vec<_> = places.iter().map(|place| surface.nearest(Vector3::from(*place))).collect();
        let on_film: Vec<bool> = nearest.iter().map(|nearest| nearest.offset.norm() <= surface.element_size).collect();
        let of_pair = |Pair { film, field }: &Pair<'_>| {
            let point = |(place, measured): &(u32, [f64; 3])| PointError {
                place: *place,
                measured: alignment.motion.rotate(*measured),
                simulated: nearest[*place as usize].displacement(film).into(),
            };
            StateErrors::new(film, field, field.points.iter().map(point).collect(), &on_film)
        };
        let states = pairs.iter().map(of_pair).collect();
        Ok(FieldComparison { face: motion.face, alignment, places, on_film, states, outside, not_reached })
    }

    /// The errors of all points on the film at all times.
    pub fn norms(&self) -> ErrorNorms {
        self.states.iter().fold(ErrorNorms::default(), |sum, state| sum.join(&state.norms))
    }

    /// Norm of the measured displacements of all points on the film at all times, m.
    pub fn measured_norm(&self) -> f64 {
        self.norms().measured.sqrt()
    }

    /// Points of all times: matched, and of these on the film.
    pub fn counts(&self) -> [usize; 2] {
        [self.states.iter().map(|state| state.points.len()).sum(), self.norms().points]
    }

    /// A row a point and time: where it was in the undeformed film, its measured and its simulated displacement, and the error, none of a
    /// point off the film; in the axes of the run.
    pub fn columns(&self) -> Vec<Column> {
        let rows = || self.states.iter().flat_map(|state| state.points.iter().map(move |point| (state, point)));
        let is_on = |point: &PointError| self.on_film[point.place as usize];
        let number = |value: f64| rounded(value, DIGITS);
        let mut columns = vec![Column::of_numbers("time_s", rows().map(|(state, _)| clean_time(state.time)))];
        let mut add = |names: [&str; 3], of: &dyn Fn(&PointError) -> [f64; 3]| {
            for (axis, name) in names.into_iter().enumerate() {
                columns.push(Column::of_numbers(name, rows().map(|(_, point)| number(of(point)[axis]))));
            }
        };
        add(["x_m", "y_m", "z_m"], &|point| self.places[point.place as usize]);
        add(["u_m", "v_m", "w_m"], &|point| point.measured);
        let simulated = |point: &PointError| if is_on(point) { point.simulated } else { [f64::NAN; 3] };
        add(["simulated_u_m", "simulated_v_m", "simulated_w_m"], &simulated);
        let error = |point: &PointError| if is_on(point) { number(point.size()) } else { f64::NAN };
        columns.push(Column::of_numbers("error_m", rows().map(|(_, point)| error(point))));
        columns
    }

    /// Simulated less measured displacements, m: x, y, z of every point that was matched, time by time; zero for points off the film. Their
    /// number does not depend on the run.
    pub fn residuals(&self) -> impl Iterator<Item = f64> + '_ {
        let points = self.states.iter().flat_map(|state| &state.points);
        points.flat_map(|point| if self.on_film[point.place as usize] { point.error() } else { [0.0; 3] })
    }
}

impl StateErrors {
    fn new(film: &FaceState, field: &FieldState, points: Vec<PointError>, on_film: &[bool]) -> StateErrors {
        let mut norms = ErrorNorms::default();
        points.iter().filter(|point| on_film[point.place as usize]).for_each(|point| norms.add(point));
        StateErrors { time: film.time, points, missing: field.missing, norms }
    }
}

/// A face in the reference configuration.
pub struct FilmSurface<'m> {
    motion: &'m FaceMotion,
    triangles: TriMesh,
    /// Of each triangle the element, and its corners in it.
    elements: Vec<(u32, [u8; 3])>,
    /// Mean length of the sides of its elements, m.
    pub element_size: f64,
}

/// The point of the film that is nearest to a measured one.
#[derive(Clone, Copy, Debug)]
pub struct Nearest {
    /// Corners of its element.
    corners: [u32; 4],
    /// Values of their shape functions there.
    shape: [f64; 4],
    /// Derivatives of the shape functions along the contravariant base vectors: rows of the gradient, 1/m.
    gradient: [Vector3<f64>; 4],
    /// Signs of x and y of the mirror image that the point lies on.
    signs: Vector3<f64>,
    /// Unit normal of the film there.
    pub normal: Vector3<f64>,
    /// From it to the measured point, m.
    pub offset: Vector3<f64>,
}

/// Corners of a quadrilateral in its natural coordinates.
const NATURAL: [[f64; 2]; 4] = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];

/// Steps of the search for natural coordinates. It converges within three, but for elements that are nearly triangles.
const STEPS: usize = 12;

impl<'m> FilmSurface<'m> {
    /// The surface of a face; none without elements.
    pub fn of_motion(motion: &'m FaceMotion) -> Option<FilmSurface<'m>> {
        let vertices = motion.reference.iter().map(|[x, y, z]| Vector::new(*x, *y, *z)).collect();
        let (mut indices, mut elements) = (Vec::new(), Vec::new());
        let (mut length, mut sides) = (0.0, 0);
        for (element, corners) in motion.corners.iter().enumerate() {
            let halves: &[[u8; 3]] = if corners[2] == corners[3] { &[[0, 1, 2]] } else { &[[0, 1, 2], [0, 2, 3]] };
            for half in halves {
                indices.push(half.map(|corner| corners[usize::from(corner)]));
                elements.push((element as u32, *half));
            }
            let place = |corner: usize| Vector3::from(motion.reference[corners[corner % 4] as usize]);
            for side in (0..4).map(|corner| (place(corner + 1) - place(corner)).norm()).filter(|side| *side > 0.0) {
                length += side;
                sides += 1;
            }
        }
        let triangles = TriMesh::new(vertices, indices).ok()?;
        Some(FilmSurface { motion, triangles, elements, element_size: length / f64::from(sides.max(1)) })
    }

    /// Whether x = 0 and y = 0 are mirror planes.
    pub fn mirrored(&self) -> [bool; 2] {
        self.motion.mirrored
    }

    /// Positions of its nodes and their mirror images, m.
    pub fn points(&self) -> impl Iterator<Item = (usize, Vector3<f64>)> + '_ {
        let signs = |mirrored: bool| if mirrored { &[1.0, -1.0][..] } else { &[1.0][..] };
        let [x, y] = self.motion.mirrored.map(signs);
        let images = x.iter().flat_map(move |x| y.iter().map(move |y| Vector3::new(*x, *y, 1.0)));
        images.flat_map(move |signs| {
            let place = move |(node, place): (usize, &[f64; 3])| (node, Vector3::from(*place).component_mul(&signs));
            self.motion.reference.iter().enumerate().map(place)
        })
    }

    /// The displacement (m) of the point of the film that is nearest to `point` (m), in a state.
    pub fn displacement(&self, point: [f64; 3], state: &FaceState) -> [f64; 3] {
        self.nearest(Vector3::from(point)).displacement(state).into()
    }

    /// The point of the film that is nearest to `point` (m). Of a film with mirror planes it is on the image on whose side the point
    /// lies.
    pub fn nearest(&self, point: Vector3<f64>) -> Nearest {
        let [x, y] = [0, 1].map(|axis| if self.motion.mirrored[axis] && point[axis] < 0.0 { -1.0 } else { 1.0 });
        let signs = Vector3::new(x, y, 1.0);
        let own = point.component_mul(&signs);
        let query = Vector::new(own.x, own.y, own.z);
        let (_, (triangle, location)) = self.triangles.project_local_point_and_get_location(query, true);
        let (element, half) = self.elements[triangle as usize];
        let corners = self.motion.corners[element as usize];
        let places = corners.map(|corner| Vector3::from(self.motion.reference[corner as usize]));
        let weights = location.barycentric_coordinates().unwrap_or([1.0 / 3.0; 3]);
        let is_triangle = corners[2] == corners[3];
        let (shape, [first, second], derivatives) = if is_triangle {
            let [a, b, c] = weights;
            let sides = [places[1] - places[0], places[2] - places[0]];
            ([a, b, c, 0.0], sides, [[-1.0, -1.0], [1.0, 0.0], [0.0, 1.0], [0.0, 0.0]])
        } else {
            let mut natural = Vector2::zeros();
            for (corner, weight) in half.iter().zip(weights) {
                natural += weight * Vector2::from(NATURAL[usize::from(*corner)]);
            }
            let natural = nearest_natural(&places, own, natural);
            let derivatives = derivatives(natural);
            (values(natural), base_vectors(&places, &derivatives), derivatives)
        };
        let [along_first, along_second] = contravariant(first, second);
        let gradient = derivatives.map(|[a, b]| (a * along_first + b * along_second).component_mul(&signs));
        let on_film: Vector3<f64> = (0..4).map(|corner| shape[corner] * places[corner]).sum();
        let normal = first.cross(&second).try_normalize(0.0).unwrap_or_else(Vector3::z);
        Nearest {
            corners,
            shape,
            gradient,
            signs,
            normal: normal.component_mul(&signs),
            offset: (own - on_film).component_mul(&signs),
        }
    }
}

impl Nearest {
    /// The displacement of the film there in a state, m.
    pub fn displacement(&self, state: &FaceState) -> Vector3<f64> {
        let own: Vector3<f64> = (0..4).map(|corner| self.shape[corner] * self.of_corner(state, corner)).sum();
        own.component_mul(&self.signs)
    }

    /// The gradient of the displacement along the film.
    pub fn displacement_gradient(&self, state: &FaceState) -> Matrix3<f64> {
        let of_corner = |corner: usize| {
            self.of_corner(state, corner).component_mul(&self.signs) * self.gradient[corner].transpose()
        };
        (0..4).map(of_corner).sum()
    }

    fn of_corner(&self, state: &FaceState, corner: usize) -> Vector3<f64> {
        Vector3::from(state.displacements[self.corners[corner] as usize].map(f64::from))
    }
}

fn values(natural: Vector2<f64>) -> [f64; 4] {
    NATURAL.map(|[a, b]| 0.25 * (1.0 + a * natural.x) * (1.0 + b * natural.y))
}

fn derivatives(natural: Vector2<f64>) -> [[f64; 2]; 4] {
    NATURAL.map(|[a, b]| [0.25 * a * (1.0 + b * natural.y), 0.25 * b * (1.0 + a * natural.x)])
}

fn base_vectors(places: &[Vector3<f64>; 4], derivatives: &[[f64; 2]; 4]) -> [Vector3<f64>; 2] {
    [0, 1].map(|axis| (0..4).map(|corner| derivatives[corner][axis] * places[corner]).sum())
}

/// Natural coordinates of the point of a bilinear element that is nearest to `point`, from a start: Gauss–Newton on the
/// squared distance, within the element.
fn nearest_natural(places: &[Vector3<f64>; 4], point: Vector3<f64>, mut natural: Vector2<f64>) -> Vector2<f64> {
    for _ in 0..STEPS {
        let (shape, base) = (values(natural), base_vectors(places, &derivatives(natural)));
        let apart: Vector3<f64> = point - (0..4).map(|corner| shape[corner] * places[corner]).sum::<Vector3<f64>>();
        let metric =
            Matrix2::new(base[0].dot(&base[0]), base[0].dot(&base[1]), base[1].dot(&base[0]), base[1].dot(&base[1]));
        let along = Vector2::new(base[0].dot(&apart), base[1].dot(&apart));
        let Some(step) = metric.try_inverse().map(|inverse| inverse * along) else { break };
        let next = clamped(natural, step, &metric, along);
        let moved = (next - natural).amax();
        natural = next;
        if moved < 1e-12 {
            break;
        }
    }
    natural
}

/// The natural coordinates after a step, within the element: on a side, along which the rest of the step goes.
fn clamped(natural: Vector2<f64>, step: Vector2<f64>, metric: &Matrix2<f64>, along: Vector2<f64>) -> Vector2<f64> {
    let free = natural + step;
    let mut next = free.map(|value| value.clamp(-1.0, 1.0));
    for axis in 0..2 {
        // On one side alone: the best place along it.
        let other = 1 - axis;
        if next[axis] != free[axis] && next[other] == free[other] && metric[(other, other)] > 0.0 {
            let moved = next[axis] - natural[axis];
            let best = natural[other] + (along[other] - metric[(other, axis)] * moved) / metric[(other, other)];
            next[other] = best.clamp(-1.0, 1.0);
            break;
        }
    }
    next
}

/// Contravariant base vectors of two base vectors of a surface.
fn contravariant(first: Vector3<f64>, second: Vector3<f64>) -> [Vector3<f64>; 2] {
    let normal = first.cross(&second);
    let area = normal.norm_squared();
    if area > 0.0 { [second.cross(&normal) / area, normal.cross(&first) / area] } else { [Vector3::zeros(); 2] }
}
