//! Functions that every script can call: signals, curves, coupon and drop tests, tables, plots, files.
//!
//! Scenarios and runs come with `post`, searches with `identify`.

#[cfg(test)]
pub(crate) mod check;
mod coupon;
mod curve;
mod drop;
mod files;
mod law_fit;
mod measures;
mod modules;
mod plots;
mod random;
mod recording;
mod results;
mod signal;
mod table;
mod threshold;

use rhai::Engine;

use crate::script::{self, Chapter, Limits, OutputCollector, Session};

pub use coupon::Reduced;

/// The reference of these functions.
pub const REFERENCE: &[Chapter] = &[
    Chapter { title: "signals", entries: signal::ENTRIES },
    Chapter { title: "measures of signals", entries: measures::ENTRIES },
    Chapter { title: "results", entries: results::ENTRIES },
    Chapter { title: "plots", entries: plots::ENTRIES },
    Chapter { title: "files", entries: files::ENTRIES },
    Chapter { title: "curves", entries: curve::ENTRIES },
    Chapter { title: "coupon tests", entries: coupon::ENTRIES },
    Chapter { title: "fits of laws", entries: law_fit::ENTRIES },
    Chapter { title: "drop tests", entries: drop::ENTRIES },
    Chapter { title: "random numbers", entries: random::ENTRIES },
    Chapter { title: "thresholds", entries: threshold::ENTRIES },
    Chapter { title: "the module droptower/tables", entries: modules::ENTRIES },
    Chapter { title: "tables (droptower script)", entries: table::ENTRIES },
    Chapter { title: "recordings (droptower script)", entries: recording::ENTRIES },
];

/// An interpreter within `limits` with the functions that neither read nor write files.
pub fn engine(limits: Limits) -> Engine {
    let mut engine = script::engine(limits);
    Session::of_engine(&engine).ship(modules::MODULES);
    signal::register(&mut engine);
    measures::register(&mut engine);
    random::register(&mut engine);
    threshold::register(&mut engine);
    drop::register(&mut engine);
    curve::register(&mut engine);
    coupon::register(&mut engine);
    law_fit::register(&mut engine);
    engine
}

/// Offers the functions that read files: recordings, tables, coupon tests; and lets scripts import modules in files.
pub fn register_reading(engine: &mut Engine) {
    Session::of_engine(engine).read_modules();
    recording::register(engine);
    table::register(engine);
    coupon::register_reading(engine);
    law_fit::register_reading(engine);
}

/// Offers the functions whose output `collector` takes: figures, tables, plots, files, the log.
pub fn register_output(engine: &mut Engine, collector: &OutputCollector) {
    results::register(collector, engine);
    plots::register(collector, engine);
    files::register(collector, engine);
}
