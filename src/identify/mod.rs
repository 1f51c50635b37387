//! Searches: parameters of a scenario, or of anything else that a script computes, from what was measured.
//!
//! A script says what is to be small, [`minimize`](register) finds where it is, and [`confidence`](Confidence) and
//! [`profiles`] say how well it is known. Trials are evaluated in parallel ahead of the
//! search and written down as they end; neither changes what the search finds, bit for bit.

mod bounds;
mod cma_es;
mod confidence;
mod convergence;
mod crew;
mod foresight;
mod history;
mod identifiability;
mod levenberg_marquardt;
mod nelder_mead;
mod noise;
mod objective;
mod options;
mod profile;
mod progress;
mod script;
mod search;
mod starts;
mod tangent;
mod trust;

use crate::script::Chapter;
pub use bounds::{Bounds, BoundsError};
pub use confidence::{Confidence, ConfidenceError, Question};
pub use crew::{Crew, CrewError, Desk, Task};
pub use history::{History, HistoryError, Identity, Logged, Sketch};
pub use identifiability::Direction;
pub use nelder_mead::{Limits, Simplex, Step, Values};
pub use noise::{Colour, Noise};
pub use objective::{Answer, Broken, Evaluation, Objective, Observed};
pub use options::{Method, OnFailure, OnRupture, OptionsError, Search, Starts};
pub use profile::{Point, Profile, ProfileError, profiles};
pub use progress::Progress;
pub use script::{SearchEvent, SearchHost, register};
pub use search::{Best, Ended, Iteration, SearchError, minimise};
pub use tangent::{Tangent, TangentError};

/// The reference of searches.
pub const REFERENCE: &[Chapter] = &[
    Chapter { title: "searches (droptower script)", entries: script::ENTRIES },
    Chapter { title: "trust in what a search found (droptower script)", entries: trust::ENTRIES },
];
