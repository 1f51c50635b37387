//! Level at which half of the specimens fail, from tests that each only fail or do not: the staircase and its
//! reduction, and the fit of a normal distribution to counts at any levels.

mod dixon_mood;
mod likelihood;
mod probit;

use thiserror::Error;

pub use dixon_mood::{Reduction, ReductionError};
pub use probit::{ProbitError, ProbitFit, probit};

/// Outcome of the test of a specimen.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Outcome {
    /// It failed.
    Failed,
    /// It did not.
    Survived,
}

/// Specimens that were tested at one level.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Counts {
    /// Level, in its unit.
    pub level: f64,
    /// Number of specimens.
    pub trials: u64,
    /// Of these, how many failed.
    pub failures: u64,
}

/// Why there is no such staircase.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum StaircaseError {
    /// The first level is no number.
    #[error("the first level is {start}, but must be finite")]
    Start {
        /// First level.
        start: f64,
    },
    /// The step is not positive.
    #[error("the step is {step}, but must be positive and finite")]
    Step {
        /// Step.
        step: f64,
    },
}

/// Up-and-down method (Dixon, Mood 1948), as ISO 7765-1 and ASTM D1709 test films with falling darts: after a specimen
/// that failed the level of the next is one step lower, after one that did not, one step higher.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Staircase {
    start: f64,
    step: f64,
}

/// Times that the less frequent outcome must occur before a test after ISO 7765-1 or ASTM D1709 is complete.
pub const STANDARD_COUNT: usize = 10;

impl Staircase {
    /// A staircase from a first level, by equal steps, both in the unit of the level (a mass, a height).
    ///
    /// The reduction is best with a step of 0.5 to 2 standard deviations (Dixon, Mood 1948).
    ///
    /// # Errors
    /// The step is not positive, or one of them not finite.
    pub fn new(start: f64, step: f64) -> Result<Self, StaircaseError> {
        if !start.is_finite() {
            return Err(StaircaseError::Start { start });
        }
        if !(step > 0.0 && step.is_finite()) {
            return Err(StaircaseError::Step { step });
        }
        Ok(Self { start, step })
    }

    /// Level of the next specimen after these outcomes, in the order of the tests. It may fall to zero or below;
    /// whether that is a level is for the caller to say.
    pub fn next_level(&self, outcomes: &[Outcome]) -> f64 {
        self.level_at(outcomes.iter().map(|outcome| Self::move_after(*outcome)).sum())
    }

    /// Levels of all specimens that were tested.
    pub fn levels(&self, outcomes: &[Outcome]) -> Vec<f64> {
        self.places(outcomes).into_iter().map(|place| self.level_at(place)).collect()
    }

    /// Number of steps from the first level, for every specimen.
    fn places(&self, outcomes: &[Outcome]) -> Vec<i32> {
        let moved = |place: &mut i32, outcome: &Outcome| {
            // Places as integers: summed steps of a level would drift apart, and equal levels must be equal.
            let here = *place;
            *place += Self::move_after(*outcome);
            Some(here)
        };
        outcomes.iter().scan(0, moved).collect()
    }

    fn level_at(&self, place: i32) -> f64 {
        self.start + self.step * f64::from(place)
    }

    fn move_after(outcome: Outcome) -> i32 {
        match outcome {
            Outcome::Failed => -1,
            Outcome::Survived => 1,
        }
    }

    /// Whether either outcome has occurred `count` times. With [`STANDARD_COUNT`] these are the twenty specimens of ISO
    /// 7765-1 and ASTM D1709, and as many more as it takes until ten failed and ten did not.
    pub fn is_complete(outcomes: &[Outcome], count: usize) -> bool {
        let failed = outcomes.iter().filter(|outcome| **outcome == Outcome::Failed).count();
        failed.min(outcomes.len() - failed) >= count
    }

    /// Failures and trials at every level that was tested, the lowest first.
    pub fn counts(&self, outcomes: &[Outcome]) -> Vec<Counts> {
        let places = self.places(outcomes);
        let mut levels = places.clone();
        levels.sort_unstable();
        levels.dedup();
        let here = |level: i32| places.iter().zip(outcomes).filter(move |(place, _)| **place == level);
        let counts = |level: i32| Counts {
            level: self.level_at(level),
            trials: here(level).count() as u64,
            failures: here(level).filter(|(_, outcome)| **outcome == Outcome::Failed).count() as u64,
        };
        levels.into_iter().map(counts).collect()
    }
}

#[cfg(test)]
mod tests;
