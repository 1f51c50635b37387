//! Searches: parameters of a scenario, or of anything else that a script computes, from what was measured.
//!
//! A script says what is to be small, [`minimize`](register) finds where it is. Trials are evaluated in parallel ahead of the
//! search and written down as they end; neither changes what the search finds, bit for bit.

mod bounds;
mod cma_es;
mod crew;
mod foresight;
mod history;
mod levenberg_marquardt;
mod nelder_mead;
mod objective;
mod options;
mod progress;
mod script;
mod search;
mod starts;

use crate::script::Chapter;
pub use bounds::{Bounds, BoundsError};
pub use crew::{Crew, CrewError, Desk, Task};
pub use history::{History, HistoryError, Identity, Logged};
pub use nelder_mead::{Limits, Simplex, Step, Values};
pub use objective::{Answer, Evaluation, Objective};
pub use options::{Method, OnFailure, OnRupture, OptionsError, Search, Starts};
pub use progress::Progress;
pub use script::{Heard, Laboratory, register};
pub use search::{Best, Ended, Iteration, SearchError, minimise};

/// The reference of searches.
pub const REFERENCE: &[Chapter] = &[Chapter { title: "searches (droptower script)", entries: script::ENTRIES }];
