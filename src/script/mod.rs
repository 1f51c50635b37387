//! Host for Rhai scripts: limits, values, faults, and what a script leaves behind.
//!
//! The host knows signals and plain values. Whoever offers more to scripts registers it into the
//! engine and describes it as [`Entry`] lines, whose examples are run by the tests.

mod arguments;
mod calls;
mod coupon;
mod curve;
mod drop;
mod fault;
mod files;
mod findings;
mod host;
mod random;
mod recording;
mod reference;
mod session;
mod signal;
mod table;
mod value;

pub use arguments::Arguments;
pub use coupon::{ENTRIES as COUPON_ENTRIES, Reduced};
pub use curve::ENTRIES as CURVE_ENTRIES;
pub use drop::ENTRIES as DROP_ENTRIES;
pub use fault::{Fault, refuse};
pub use files::{ENTRIES as FILE_ENTRIES, File, FileError, Files};
pub use findings::{ENTRIES as LEDGER_ENTRIES, Findings, Ledger, NameError, Row};
pub use host::{Limits, ReadError, STACK, Script, engine};
pub use random::ENTRIES as RANDOM_ENTRIES;
pub use recording::{ENTRIES as RECORDING_ENTRIES, register as register_recordings};
pub use reference::Entry;
pub use session::{Session, Trial, content};
pub use signal::{ENTRIES as SIGNAL_ENTRIES, MEASURE_ENTRIES, register as register_signals};
pub use table::ENTRIES as TABLE_ENTRIES;
pub use value::{from_json, number, to_json, window};
