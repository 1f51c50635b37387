//! The host of Rhai scripts: limits, calls, faults, values, and the output of a script.
//!
//! It offers scripts nothing by itself. A module that does registers its functions into the engine and describes them
//! as [`Entry`] lines, whose examples the tests run: `functions`, `post` and `identify`.

mod about;
mod arguments;
mod call_options;
mod calls;
mod compared;
mod convergence;
mod fault;
mod fields;
mod files;
mod host;
mod module;
mod options;
mod output;
mod panic;
mod plots;
mod reference;
mod run_findings;
mod session;
mod sort;
mod value;
mod warning;

pub use about::{About, Declared, Kind, argument_value};
pub use arguments::Arguments;
pub use compared::{Compared, Over, Target};
pub use convergence::{ConvergenceHistory, Fit, Iterate};
pub use fault::{
    Fault, HostResult, at_key, cause, is_numerical, key_mistake, numerical_failure, refuse, refuse_key, refused_key,
    thrown,
};
pub(crate) use files::MOST_BYTES;
pub use files::{File, FileError, Files};
pub use host::{Limits, ReadError, STACK, Script, engine, stop_beyond};
pub use module::{LONGEST_SCRIPT, SHIPPED, ShippedModule, SourceText};
pub use options::Options;
pub use output::{Message, OutputCollector, OutputError, Row, ScriptOutput};
pub(crate) use panic::catch as catch_panics;
pub(crate) use panic::check_stop;
pub use panic::silence_panics;
pub use plots::PlotError;
pub use reference::{Chapter, Entry};
pub use run_findings::RunFindings;
pub use session::{CallOptions, Fields, Session, Trial};
pub use value::{from_json, number, to_json, window};
pub use warning::{CODES, Warning};
