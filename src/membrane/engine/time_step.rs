//! The stable time step.

use serde::{Deserialize, Serialize};

use super::film::{self, AddedMass, Film};
use super::nodes::Nodes;
use super::pressure::Enclosed;
use super::thread_pool::ThreadPool;
use super::{Fault, Loads, Progress};

/// Share of the stability limit that is used.
const SAFETY: f64 = 0.9;

/// Adds mass to the elements of a film whose own stable time step, as mounted and without damping, is below `step` (s),
/// so that it is `step` (theory.md, equation 17d).
pub fn add_mass(film: &mut Film, nodes: &mut Nodes, step: f64) -> AddedMass {
    let frequency = SAFETY * 2.0 / step;
    film.add_mass(nodes, frequency * frequency)
}

/// Share of the limit after elements have failed: torn film snaps back and flutters between slack and taut, and a
/// step near the limit of the linear theory gains energy at such kinks (theory.md, section 4).
const TORN_SAFETY: f64 = 0.5;

/// Steps, and time (s), between two updates of the frequency bound: the laws bound the stiffness for strains within
/// 0.5 % of the present ones, which covers rates of 70 1/s.
const INTERVAL: (u32, f64) = (14, 0.005 / 70.0);

/// Largest growth from one step to the next.
const GROWTH: f64 = 1.02;

/// Largest step over the first one, and of that over the step where the law is steepest at small strains: film may have no
/// stiffness while it is slack or at rest, but get it at any time.
const CEILING: f64 = 4.0;

/// Share of the first step below which a run fails.
const COLLAPSE: f64 = 1e-3;

/// The stable step of central differences, Δt = s·2/ω (√(1 + ξ²) − ξ), with ω bounded element by element from the
/// present tangent stiffness and shape (theory.md, equations 16 and 17). Kinematic contact adds nothing to ω.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(super) struct TimeStep {
    // These follow from the model.
    #[serde(skip)]
    damping: f64,
    #[serde(skip)]
    factor: f64,
    /// Squared angular frequency of the film against enclosed air and on the frame's springs where it was mounted or has
    /// settled, rad²/s².
    on_supports: f64,
    safety: f64,
    first: f64,
    now: f64,
    target: f64,
    until_update: u32,
}

impl TimeStep {
    /// The step of film at rest, with the damping and the step factor of `loads`; `on_springs` bounds the squared angular
    /// frequency of its edge on the frame's springs, rad²/s².
    pub(super) fn new(films: &[Film], nodes: &Nodes, pool: &ThreadPool, loads: &Loads, on_springs: f64) -> TimeStep {
        let (damping, factor) = (loads.damping, loads.step_factor);
        let air = loads.cushion.map_or(0.0, |cushion| {
            let enclosed = Enclosed::between(films, nodes);
            let inverse: Vec<f64> = nodes.mass.iter().map(|mass| 1.0 / mass).collect();
            cushion.squared_frequency(cushion.volume, &enclosed.gradient, &inverse)
        });
        let on_supports = air + on_springs;
        let mut step = TimeStep { damping, factor, on_supports, safety: SAFETY, ..TimeStep::default() };
        let largest = films.iter().map(Film::largest_frequency).fold(0.0, f64::max);
        step.first = step.stable(films, nodes, pool).0.min(CEILING * step.of_squared(largest));
        // Not by way of `next`: the first step has no last one to grow from.
        (step.now, step.target) = (step.first, step.first);
        step
    }

    /// The step as `saved`, of the same model.
    pub(super) fn restored(&self, saved: TimeStep) -> TimeStep {
        TimeStep { damping: self.damping, factor: self.factor, ..saved }
    }

    /// Whether a run of the same model may have come so far: it goes on from there, and bounds its steps again soon.
    pub(super) fn precedes(&self, Progress { time_step: saved, time, .. }: &Progress) -> bool {
        let possible = COLLAPSE * saved.first..=CEILING * saved.first;
        // That of settled film is another than that of mounted film, but no other magnitude.
        let is_bounded = (COLLAPSE * self.first..=self.first / COLLAPSE).contains(&saved.first)
            && [saved.now, saved.target].iter().all(|step| possible.contains(step))
            && (saved.safety == SAFETY || saved.safety == TORN_SAFETY)
            && saved.on_supports >= 0.0
            && saved.on_supports.is_finite()
            && saved.until_update <= INTERVAL.0;
        is_bounded && *time >= 0.0 && time + saved.now.min(saved.target) > *time
    }

    /// The present step, s.
    pub(super) fn now(&self) -> f64 {
        self.now
    }

    /// The last and the next step, s; updates the frequency bound where that is due.
    pub(super) fn next(
        &mut self,
        films: &[Film],
        nodes: &Nodes,
        pool: &ThreadPool,
        time: f64,
    ) -> Result<(f64, f64), Fault> {
        let last = self.now;
        if self.until_update == 0 {
            let (stable, face) = self.stable(films, nodes, pool);
            // A NaN would pass every comparison below and run on.
            let collapsed = stable.is_nan() || stable < COLLAPSE * self.first;
            if collapsed && films.get(face).is_some_and(Film::has_limit) {
                return Err(Fault::StretchLimit { time, face: face + 1 });
            }
            if stable.is_nan() {
                return Err(Fault::FilmLost { time, face: face + 1 });
            }
            if collapsed {
                return Err(Fault::TimeStepCollapsed { time, first: self.first, now: stable, face: face + 1 });
            }
            // Such a run would step for ever.
            if stable <= f64::EPSILON * time {
                return Err(Fault::StepTooShort { time, now: stable, face: face + 1 });
            }
            self.target = stable.min(CEILING * self.first);
            // Counted in steps of the target: a step that is still growing towards it is shorter, and the bound is on
            // the safe side.
            let within = (INTERVAL.1 / self.target).min(f64::from(INTERVAL.0)).max(1.0);
            self.until_update = within as u32;
        }
        self.until_update -= 1;
        // A step shrinks at once, which stability asks for, but grows slowly.
        self.now = self.target.min(GROWTH * last);
        Ok((last, self.now))
    }

    /// Reduces the safety factor and updates the step at once, after elements have failed.
    pub(super) fn tear(&mut self) {
        self.safety = TORN_SAFETY;
        self.until_update = 0;
    }

    /// Whether elements have failed.
    pub(super) fn is_torn(&self) -> bool {
        self.safety == TORN_SAFETY
    }

    /// The stable step and the face that limits it.
    fn stable(&self, films: &[Film], nodes: &Nodes, pool: &ThreadPool) -> (f64, usize) {
        let bounds = film::frequency_bounds(films, pool, nodes.position.axes());
        let (face, squared) = bounds
            .into_iter()
            .enumerate()
            // Not `max`, which would drop a NaN.
            .fold((0, 0.0), |most, (face, w)| if w <= most.1 || most.1.is_nan() { most } else { (face, w) });
        (self.of_squared(squared), face)
    }

    /// The stable step of film with this squared angular frequency, rad²/s².
    fn of_squared(&self, squared: f64) -> f64 {
        // Stiffnesses in parallel: the sum bounds the highest frequency of all together.
        let squared = squared + self.on_supports;
        // Slack film without any stiffness: the slopes that its law has elsewhere and `CEILING` keep its step finite.
        if squared == 0.0 {
            return f64::INFINITY;
        }
        let frequency = squared.sqrt();
        let damping = if self.damping > 0.0 { self.damping / (2.0 * frequency) } else { 0.0 };
        self.factor * self.safety * 2.0 / frequency * ((1.0 + damping * damping).sqrt() - damping)
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Point3;

    use super::*;
    use crate::engine::{Engine, Mesh, Section};
    use crate::material::{Curve, Fabric, Law};

    /// The first step (s) of an element of fabric without stress below a strain, and that of its tangent alone.
    fn first_steps(slack: f64) -> [f64; 2] {
        let [fibres, shear] =
            [40e6, 1e6].map(|stress| Curve::new(vec![[slack, 0.0], [slack + 0.5, stress]]).expect("a curve"));
        let law = Law::Fabric(Fabric::new(fibres.clone(), fibres, shear, 0.0));
        let corners = [[0.0, 0.0], [0.01, 0.0], [0.01, 0.01], [0.0, 0.01]];
        let places = corners.into_iter().map(|[x, y]| Point3::new(x, y, 0.0)).collect();
        let mesh = Mesh { nodes: places, quads: vec![[0, 1, 2, 3]], ..Mesh::default() };
        let mut nodes = Nodes::default();
        let film = Film::mount(&mesh, &Section::new(law, 1000.0, 5e-5), 0.0, &mut nodes).expect("a film");
        let of_tangent = SAFETY * 2.0 / film.frequency_bound(&nodes.position).sqrt();
        [Engine::new(vec![film], nodes, [], Loads::default()).time_step(), of_tangent]
    }

    /// That of film without a tangent at rest follows from its steepest slope at small strains: c = √(E/ρ) passes an element.
    #[test]
    fn the_first_step_is_bounded_by_the_steepest_slope() {
        let expected = CEILING * SAFETY * 0.01 / (80e6_f64 / 1000.0).sqrt();
        for slack in [0.05, 0.3] {
            let [step, of_tangent] = first_steps(slack);
            assert!(of_tangent.is_infinite() && (step / expected - 1.0).abs() < 1e-12, "{step} for {expected}");
        }
        let [step, of_tangent] = first_steps(0.001);
        assert_eq!(step, of_tangent, "film that is taut within the reach of the bound");
    }

    #[test]
    fn only_steps_that_advance_are_restored() {
        let step =
            TimeStep { safety: SAFETY, first: 1e-6, now: 1e-6, target: 2e-6, until_update: 3, ..TimeStep::default() };
        let at =
            |time_step: &TimeStep, time: f64| Progress { time_step: time_step.clone(), time, ..Progress::default() };
        assert!(step.precedes(&at(&step, 0.0)) && step.precedes(&at(&step, 0.25)));
        for time in [-1e-3, 1e300, f64::INFINITY, f64::NAN] {
            assert!(!step.precedes(&at(&step, time)), "{time}");
        }
        for forged in [
            TimeStep { now: 0.0, ..step.clone() },
            TimeStep { first: 1e-192, now: 1e-192, target: 1e-192, ..step.clone() },
            TimeStep { target: f64::NAN, ..step.clone() },
            TimeStep { target: 1e-300, ..step.clone() },
            TimeStep { first: f64::INFINITY, ..step.clone() },
            TimeStep { safety: -1.0, ..step.clone() },
            TimeStep { until_update: u32::MAX, ..step.clone() },
        ] {
            assert!(!step.precedes(&at(&forged, 0.25)), "{forged:?}");
        }
    }
}
