//! Functions that every script can call: signals, curves, coupon and drop tests, tables, plots, files.
//!
//! Scenarios and runs come with `post`, searches with `identify`.

mod coupon;
mod drop;
mod law_fit;
mod output;
mod reading;
mod signal;

use rhai::Engine;

use crate::script::{self, Limits, Session, ShippedModule};

pub use crate::functions::coupon::Reduced;
pub use crate::functions::output::register as register_output;

/// The module of numbers and tables that is part of droptower, which every script can import.
pub(crate) const TABLES: ShippedModule =
    ShippedModule { name: "droptower/tables", text: include_str!("../../../scripts/droptower/tables.rhai") };

/// An interpreter within `limits` with the functions that neither read nor write files.
pub fn engine(limits: Limits) -> Engine {
    let mut engine = script::engine(limits);
    Session::of_engine(&engine).ship(&[TABLES]);
    signal::register(&mut engine);
    drop::register(&mut engine);
    coupon::register(&mut engine);
    law_fit::register(&mut engine);
    engine
}

/// Offers the functions that read files: recordings, tables, coupon tests; and lets scripts import modules in files.
pub fn register_reading(engine: &mut Engine) {
    Session::of_engine(engine).read_modules();
    reading::register(engine);
    coupon::register_reading(engine);
    law_fit::register_reading(engine);
}

/// Helpers of the tests of script functions.
#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::script::OutputCollector;

    /// The interpreter with every function of this module.
    pub(crate) fn engine() -> Engine {
        let mut engine = super::engine(Limits::POST);
        register_reading(&mut engine);
        register_output(&mut engine, &OutputCollector::new(vec!["steps".into()]));
        engine
    }
}
