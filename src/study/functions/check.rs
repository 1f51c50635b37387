//! Helpers of the tests of script functions.

use std::collections::BTreeSet;

use rhai::Engine;

use super::{register_output, register_reading};
use crate::script::{Entry, Limits, OutputCollector, ShippedModule};

/// The interpreter with every function of this module.
pub(crate) fn engine() -> Engine {
    let mut engine = super::engine(Limits::POST);
    register_reading(&mut engine);
    register_output(&mut engine, &OutputCollector::new(vec!["steps".into()]));
    engine
}

/// Asserts that the entries describe every function of the modules, and no others.
pub(crate) fn assert_described(modules: &[ShippedModule], entries: &[Entry]) {
    let functions = modules.iter().flat_map(|module| {
        let alias = module.name.rsplit('/').next().unwrap_or(module.name);
        let names = module.text.lines().filter_map(|line| line.strip_prefix("fn ")?.split('(').next());
        names.map(move |name| format!("{alias}::{name}"))
    });
    let described = entries.iter().filter_map(|entry| entry.call.split('(').next()).map(str::to_owned);
    assert_eq!(functions.collect::<BTreeSet<String>>(), described.collect());
}
