//! Helpers of the tests of script functions.

use rhai::Engine;

use super::{register_output, register_reading};
use crate::script::{Limits, OutputCollector};

/// The interpreter with every function of this module.
pub(crate) fn engine() -> Engine {
    let mut engine = super::engine(Limits::POST);
    register_reading(&mut engine);
    register_output(&mut engine, &OutputCollector::new(vec!["steps".into()]));
    engine
}

/// Asserts that each script fails with a message that contains the words beside it.
pub(crate) fn assert_refused(engine: &Engine, cases: &[(&str, &str)]) {
    for (text, expected) in cases {
        let error = engine.run(text).unwrap_err().to_string();
        assert!(error.contains(expected), "{text} gave: {error}");
    }
}
