//! Searches in scripts: `minimize`, `minimize_all` and `confidence`.

mod confidence;
mod host;
mod minimize;
mod objective;
mod options;
mod result;

use rhai::Engine;

use crate::script::Chapter;
pub(crate) use host::{HostSearch, failure};
pub use host::{SearchEvent, SearchHost, SearchStart};

/// Registers `minimize`, `minimize_all` and `confidence`, whose searches `host` runs.
pub fn register(engine: &mut Engine, host: &SearchHost) {
    minimize::register(engine, host);
    confidence::register(engine, host);
}

/// The reference of the script functions.
pub const REFERENCE: &[Chapter] = &[
    Chapter { title: "searches (droptower script)", entries: minimize::ENTRIES },
    Chapter { title: "confidence of estimated parameters (droptower script)", entries: confidence::ENTRIES },
];

/// An engine with these functions and a host that shows nothing.
#[cfg(test)]
fn test_engine(limits: crate::script::Limits) -> Engine {
    let mut engine = crate::functions::engine(limits);
    register(&mut engine, &SearchHost::new(|_| {}));
    engine
}
