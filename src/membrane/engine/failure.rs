//! Failure of fibre sets and elements of a film, and faults that end a run.

use thiserror::Error;

use super::element::{ElementEnergy, TooWide};

/// Failures in a film.
#[derive(Clone, Copy, Debug, Default)]
pub struct Failures {
    /// Elements in which fibres of a layer broke.
    pub broken: usize,
    /// Elements that failed: they lost the MD or the TD fibres of their last layer.
    pub failed: usize,
    /// The energies that they lost.
    pub energy: ElementEnergy,
    /// Of the elements that started to tear the one that stores most of what its tear takes, where it stores more.
    pub too_wide: Option<TooWide>,
    /// Whether a tear opened.
    pub opened: bool,
    /// Least share of the work done on film around the tip of a tear that it would return, where all work would suffice for
    /// the tear and that share does not.
    pub returned: Option<f64>,
}

impl Failures {
    /// Adds those of other elements.
    pub fn add(&mut self, other: &Failures) {
        self.broken += other.broken;
        self.failed += other.failed;
        self.energy.add(&other.energy);
        self.too_wide = TooWide::worse(self.too_wide, other.too_wide);
        self.opened |= other.opened;
        self.returned = smaller(self.returned, other.returned);
    }
}

/// The smaller of two figures.
pub(super) fn smaller(one: Option<f64>, other: Option<f64>) -> Option<f64> {
    match (one, other) {
        (Some(a), Some(b)) => Some(a.min(b)),
        (a, b) => a.or(b),
    }
}

/// Why a run cannot continue.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum Fault {
    /// The motion of the impactor is not finite.
    #[error("the motion of the impactor is not finite at {time:.6} s")]
    ImpactorLost {
        /// Time, s.
        time: f64,
    },
    /// An impactor is released where there is film.
    #[error("impactor {impactor} is released at {time:.6} s {:.3} mm inside the film", 1e3 * depth)]
    ReleasedInFilm {
        /// Time, s.
        time: f64,
        /// Number of the impactor, from 1.
        impactor: usize,
        /// How deep, m.
        depth: f64,
    },
    /// An impactor is released where there is another.
    #[error("impactor {impactor} is released at {time:.6} s {:.3} mm inside impactor {other}", 1e3 * depth)]
    ReleasedInImpactor {
        /// Time, s.
        time: f64,
        /// Number of the impactor, from 1.
        impactor: usize,
        /// Number of the other one.
        other: usize,
        /// How deep, m.
        depth: f64,
    },
    /// A strain is not finite.
    #[error("the strain of element {element} of face {face} is not finite at {time:.6} s")]
    NotFinite {
        /// Time, s.
        time: f64,
        /// Number of the face, from 1.
        face: usize,
        /// Number of the element in the face, from 1, quads first.
        element: usize,
    },
    /// No stable time step, or no force, of a face is a number.
    #[error(
        "the strains of face {face} are not finite at {time:.6} s, or too large for its law to have a stiffness there"
    )]
    FilmLost {
        /// Time, s.
        time: f64,
        /// Number of the face, from 1.
        face: usize,
    },
    /// The stable time step is a small part of the first one.
    #[error("the time step fell from {first:.3e} s to {now:.3e} s at {time:.6} s, limited by face {face}")]
    TimeStepCollapsed {
        /// Time, s.
        time: f64,
        /// The first time step, s.
        first: f64,
        /// The present stable time step, s.
        now: f64,
        /// Number of the face that limits it, from 1.
        face: usize,
    },
    /// A step is so short that it does not change the time.
    #[error(
        "the time step {now:.3e} s, limited by face {face}, is too short to advance the time {time:.6} s: the film is too \
         stiff or too light"
    )]
    StepTooShort {
        /// Time, s.
        time: f64,
        /// The stable time step, s.
        now: f64,
        /// Number of the face that limits it, from 1.
        face: usize,
    },
    /// Film is stretched as far as its law admits.
    #[error("film of face {face} is stretched to the limit of its law at {time:.6} s")]
    StretchLimit {
        /// Time, s.
        time: f64,
        /// Number of the face, from 1.
        face: usize,
    },
    /// The observer ended the run.
    #[error("the observer ended the run")]
    Stopped,
}
