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
    /// The observer ended the run.
    #[error("the observer ended the run")]
    Stopped,
}
