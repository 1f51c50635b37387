//! The host of Rhai scripts: limits, calls, faults, values, and the output of a script.
//!
//! It offers scripts nothing by itself. A module that does registers its functions into the engine: `functions`, `post` and
//! `identify`. `reference.toml` describes them, with examples that the tests run.

mod about;
mod checks;
mod fault;
mod host;
mod module;
mod output;
mod plots;
mod rules;
mod session;
mod values;
mod warning;

pub use about::{About, Declared, Kind, argument_value};
pub use fault::{
    Fault, HostResult, at_key, cause, is_numerical, key_mistake, numerical_failure, refuse, refuse_hinted, refuse_key,
    refused_key, thrown,
};
pub use host::{Limits, ReadError, STACK, Script, engine, stop_beyond};
pub use module::{LONGEST_SCRIPT, SHIPPED, ShippedModule, SourceText};
pub use output::{File, Files, Message, OutputCollector, Row, RunFindings, ScriptOutput};
pub(crate) use output::{MOST_BYTES, too_many_bytes};
pub use plots::{Compared, ConvergenceHistory, Fit, Iterate, Over, Target};
pub(crate) use session::catch as catch_panics;
pub(crate) use session::check_stop;
pub use session::{CallOptions, Fields, Session, Trial, silence_panics};
pub use values::{Arguments, Options, findings_map, from_json, number, record, shown, to_json, window};
pub use warning::{CODES, Warning};
