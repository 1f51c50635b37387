//! Host for Rhai scripts: limits, values, faults, and what a script leaves behind.
//!
//! The host knows signals and plain values. Whoever offers more to scripts registers it into the
//! engine and describes it as [`Entry`] lines, whose examples are run by the tests.

mod arguments;
mod calls;
mod compared;
mod convergence;
mod coupon;
mod curve;
mod drop;
mod fault;
mod files;
mod output;
mod host;
mod options;
mod plots;
mod random;
mod recording;
mod reference;
mod session;
mod signal;
mod table;
mod value;

pub use arguments::Arguments;
pub use compared::{Compared, Over, Target};
pub use convergence::{ConvergenceHistory, FitHistory, Improvement, Iterate};
pub use coupon::Reduced;
pub use fault::{Fault, HostResult, is_numerical, refuse, thrown, went_wrong};
pub use files::{File, FileError, Files};
pub use host::{Limits, ReadError, STACK, Script, engine};
pub use options::Options;
pub use output::{NameError, OutputCollector, Row, ScriptOutput, TooManyPictures};
pub use plots::PlotError;
pub use recording::register as register_recordings;
pub use reference::{Chapter, Entry};
pub use session::{Session, Trial, content};
pub use signal::register as register_signals;
pub use value::{from_json, number, to_json, window};

/// The reference of what the host itself offers to scripts.
pub const REFERENCE: &[Chapter] = &[
    Chapter { title: "signals", entries: signal::ENTRIES },
    Chapter { title: "measures of signals", entries: signal::MEASURE_ENTRIES },
    Chapter { title: "results", entries: output::ENTRIES },
    Chapter { title: "plots", entries: plots::ENTRIES },
    Chapter { title: "files", entries: files::ENTRIES },
    Chapter { title: "curves", entries: curve::ENTRIES },
    Chapter { title: "coupon tests", entries: coupon::ENTRIES },
    Chapter { title: "drop tests", entries: drop::ENTRIES },
    Chapter { title: "random numbers", entries: random::ENTRIES },
    Chapter { title: "tables (droptower script)", entries: table::ENTRIES },
    Chapter { title: "recordings (droptower script)", entries: recording::ENTRIES },
];
