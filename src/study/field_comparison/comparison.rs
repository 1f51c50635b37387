//! The errors of a run against a field.

use nalgebra::Vector3;
use thiserror::Error;

use super::alignment::{self, Alignment, Pair};
use super::surface::FilmSurface;
use base::number::{clean_time, rounded};
use base::table::Column;
use lab::dic::{Field, FieldState, RigidMotion};
use scene::model::Align;
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
            Align::Markers(pairs) => RigidMotion::of_pairs(pairs).map(|motion| Alignment { motion, found: None }),
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
        let place = |point: &PointError| self.places[point.place as usize];
        let is_on = |point: &PointError| self.on_film[point.place as usize];
        let number = |value: f64| rounded(value, DIGITS);
        let mut columns = vec![Column::of_numbers("time_s", rows().map(|(state, _)| clean_time(state.time)))];
        for (axis, name) in ["x_m", "y_m", "z_m"].into_iter().enumerate() {
            columns.push(Column::of_numbers(name, rows().map(|(_, point)| number(place(point)[axis]))));
        }
        for (axis, name) in ["u_m", "v_m", "w_m"].into_iter().enumerate() {
            columns.push(Column::of_numbers(name, rows().map(|(_, point)| number(point.measured[axis]))));
        }
        for (axis, name) in ["simulated_u_m", "simulated_v_m", "simulated_w_m"].into_iter().enumerate() {
            let simulated = |point: &PointError| if is_on(point) { number(point.simulated[axis]) } else { f64::NAN };
            columns.push(Column::of_numbers(name, rows().map(|(_, point)| simulated(point))));
        }
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
