//! Why a run cannot continue.

use thiserror::Error;

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
