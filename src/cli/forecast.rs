//! Forecast of the wall time of a long run.

use std::time::Duration;

use super::digest::DIGITS;
use base::number::{self, grouped, rounded, wall_time};
use base::units::Time;
use scene::mesh::Outline;
use scene::model::{Model, Symmetry};
use scene::simulate::{self, Progress, SpringStep};

/// Wall time from which a forecast is printed, s.
const LONG: f64 = 60.0;

/// Wall time from which it says what is cheaper, s.
const COSTLY: f64 = 3600.0;

/// Wall time that is measured before the forecast: the first steps fill caches and curves.
const MEASURED: Duration = Duration::from_secs(1);

/// Wall time between two checkpoints that the forecast proposes, s.
const BETWEEN_CHECKPOINTS: f64 = 600.0;

/// Factor on a forecast from which a later one is printed too: film that unloads or tears may shorten the step by orders
/// of magnitude.
const LONGER: f64 = 10.0;

/// Measures a run second by second.
#[derive(Default)]
pub(super) struct Forecast {
    /// Wall time and steps at the start of the present measurement.
    first: Option<(Duration, u64)>,
    /// Wall time from which the next forecast is printed, s; none before the first measurement.
    from: Option<f64>,
}

/// The rest of a run.
#[derive(Clone, Copy, Debug)]
pub(super) struct Left {
    /// s.
    wall: f64,
    /// ns.
    per_element_step: f64,
    steps: f64,
    progress: Progress,
}

impl Forecast {
    /// The rest of a run that has taken `wall` so far, if it is long; given after the first second of stepping, and again
    /// where a later second shows that the run takes [`LONGER`] times as long. The time step is taken as constant;
    /// yielding film makes it longer.
    pub(super) fn update(&mut self, progress: &Progress, wall: Duration) -> Option<Left> {
        // Equilibrium before the first step has another pace, and its end is not known.
        if progress.settling.is_some() {
            return None;
        }
        let (before, steps) = *self.first.get_or_insert((wall, progress.steps));
        if wall - before < MEASURED || progress.steps == steps {
            return None;
        }
        self.first = Some((wall, progress.steps));
        let per_step = (wall - before).as_secs_f64() / (progress.steps - steps) as f64;
        let steps = (progress.duration - progress.time).max(0.0) / progress.time_step;
        let per_element_step = 1e9 * per_step / progress.elements.max(1) as f64;
        let left = Left { wall: steps * per_step, per_element_step, steps, progress: *progress };
        // Strictly, or a run without an end would be told of every second.
        let is_longer = self.from.map_or(left.wall >= LONG, |from| left.wall > from);
        if is_longer || self.from.is_none() {
            // A run of less than a minute that is disturbed for a second is not long yet.
            self.from = Some(LONGER * left.wall.max(LONG));
        }
        is_longer.then_some(left)
    }
}

impl Left {
    /// The message of the terminal; `has_checkpoints` is whether the run writes checkpoints.
    pub(super) fn message(&self, model: &Model, has_checkpoints: bool) -> String {
        let Left { wall, per_element_step, steps, progress } = self;
        let hints = if *wall < COSTLY { vec![] } else { self.cheaper(model, has_checkpoints) };
        let hints: String = hints.iter().map(|way| format!("\n  {way}")).collect();
        format!(
            "{} will take about {}: {} elements, {} steps of {} us to go, {per_element_step:.0} ns per element step{hints}",
            model.name,
            wall_time(*wall),
            grouped(progress.elements as u64),
            grouped(rounded(*steps, 2) as u64),
            number::figure(1e6 * progress.time_step, DIGITS),
        )
    }

    /// Ways to a shorter run, or to one that may be interrupted.
    fn cheaper(&self, model: &Model, has_checkpoints: bool) -> Vec<String> {
        let mut cheaper = vec![];
        // Mounted once more, which a run that takes so long does not notice.
        let engine = model.frame.springs.as_ref().and_then(|_| simulate::engine(model).ok());
        let springs = engine.as_ref().and_then(SpringStep::of_engine).filter(SpringStep::is_much_shorter);
        if let Some(springs) = springs {
            let free = number::figure(1e6 * springs.free, DIGITS);
            cheaper.push(format!("{} makes the step so short: without springs it is {free} us", SpringStep::KEY));
        } else if model.faces.iter().any(|face| face.meshing.grading.is_some()) {
            cheaper.push("a larger specimen.mesh.fine takes fewer elements and longer steps".to_owned());
        } else if !matches!(model.specimen.shape, Outline::Mesh { .. }) {
            cheaper.push("twice the specimen.mesh.size takes an eighth of the time".to_owned());
        }
        if model.specimen.symmetry == Symmetry::None {
            cheaper.push("specimen.symmetry, where the scene is symmetric, takes a half or a quarter".to_owned());
        }
        if !has_checkpoints {
            let every = rounded(self.progress.duration * BETWEEN_CHECKPOINTS / self.wall, 1);
            cheaper.push(format!("--checkpoint-every \"{}\" allows it to resume after an interruption", Time(every)));
        }
        cheaper
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use scene::model;
    use scene::scenario::{Assignment, Document};

    /// A run of 0.1 s in steps of 1 us over 100 000 elements after so many steps.
    fn after(steps: u64) -> Progress {
        let time = 1e-6 * steps as f64;
        Progress { time, duration: 0.1, steps, time_step: 1e-6, elements: 100_000, settling: None }
    }

    #[test]
    fn a_long_run_is_forecast_once_after_a_second() {
        let mut forecast = Forecast::default();
        let mut update = |millis, steps| forecast.update(&after(steps), Duration::from_millis(millis));
        assert!(update(300, 10).is_none());
        assert!(update(1200, 15).is_none(), "not a second of stepping yet");
        let left = update(2300, 20).expect("100 000 steps of 0.2 s are long");
        assert!((left.wall - 0.2 * (100_000.0 - 20.0)).abs() < 1e-6 * left.wall, "{left:?}");
        assert!((left.per_element_step - 2000.0).abs() < 1e-9);
        assert!(update(9000, 30).is_none(), "there is one forecast");
    }

    #[test]
    fn a_run_whose_step_shrinks_is_forecast_again() {
        let mut forecast = Forecast::default();
        let mut update = |millis, progress: Progress| forecast.update(&progress, Duration::from_millis(millis));
        assert!(update(0, after(1)).is_none());
        assert!(update(1000, after(10_001)).is_none(), "nine seconds");
        let shrunk = |steps| Progress { time_step: 1e-11, ..after(steps) };
        let left = update(2000, shrunk(20_001)).expect("10 000 000 000 steps are long");
        assert!(left.wall > 1e5, "{left:?}");
        assert!(update(3000, shrunk(30_001)).is_none(), "there is one forecast for it");
    }

    #[test]
    fn springs_that_shorten_the_step_are_named_in_place_of_a_larger_mesh() {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/trampoline/bed.toml");
        let bed = Document::read(&path).expect("a scenario");
        let message = |change: &str| {
            let changes = ["specimen.mesh.size=200mm", change];
            let changes = changes.map(|change| Assignment::from_argument(change).expect("a change"));
            let model = model::check(&bed.with(&changes)).expect("a model");
            Left { wall: 2.0 * COSTLY, per_element_step: 1.0, steps: 1.0, progress: after(1) }.message(&model, true)
        };
        let (springs, larger) = ("makes the step so short: without springs it is", "twice the specimen.mesh.size");
        for (change, shortens) in
            [("frame.springs.stiffness=1000 MN/m", true), ("frame.springs.stiffness=3 kN/m", false)]
        {
            let message = message(change);
            assert_eq!(message.contains(larger), !shortens, "{message}");
            assert_eq!(message.contains(&format!("frame.springs.stiffness {springs}")), shortens, "{message}");
        }
    }

    #[test]
    fn a_run_of_less_than_a_minute_has_no_forecast() {
        // 100 000 steps.
        for (steps_a_second, long) in [(1700, false), (1600, true)] {
            let mut forecast = Forecast::default();
            forecast.update(&after(1), Duration::from_millis(200));
            let left = forecast.update(&after(1 + steps_a_second), Duration::from_millis(1200));
            assert_eq!(left.is_some(), long, "{steps_a_second} steps a second: {left:?}");
        }
    }
}
