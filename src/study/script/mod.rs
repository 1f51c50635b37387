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
mod session;
mod values;
mod warning;

pub use crate::script::about::{About, Declared, Kind, argument_value, figure_sentence};
pub use crate::script::fault::{
    Fault, HostResult, at_key, cause, is_numerical, key_mistake, numerical_failure, refuse, refuse_hinted, refuse_key,
    refuse_within, refused_key, thrown,
};
pub use crate::script::host::{Limits, ReadError, STACK, Script, engine, stop_beyond};
pub use crate::script::module::{LONGEST_SCRIPT, SHIPPED, ShippedModule, SourceText};
pub use crate::script::output::{
    Compared, ConvergenceHistory, File, Files, Fit, Iterate, Message, OutputCollector, Over, Row, RunFindings,
    ScriptOutput, Target,
};
pub(crate) use crate::script::output::{MOST_BYTES, too_many_bytes};
pub use crate::script::session::{CallOptions, Fields, Session, Trial, silence_panics};
pub(crate) use crate::script::session::{catch as catch_panics, check_stop, run_all, run_list};
pub use crate::script::values::{
    Arguments, Options, findings_map, from_json, list, number, numbers, object, one_or_several, record, shown, texts,
    to_json, unknown, window, word,
};
pub use crate::script::warning::{CODES, Warning};
