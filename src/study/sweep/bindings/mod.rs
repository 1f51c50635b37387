//! Many runs in scripts: sweeps, sensitivity, reliability.

mod common;
mod reliability;
mod surrogate;
mod sweeping;

use std::sync::Arc;

use rhai::{Array, Dynamic, Engine, Map, NativeCallContext};

use crate::evaluate::Evaluations;
use crate::scenario_functions::Study;
use crate::script::{Chapter, HostResult, Options, Session};
use common::Host;

/// A function of a study and options.
type Function = fn(&Study, &Options<'_>, &Host<'_>) -> HostResult<Dynamic>;

/// Their names in scripts.
const FUNCTIONS: [(&str, Function); 4] = [
    ("sweep", sweeping::sweep),
    ("surrogate", surrogate::surrogate),
    ("failure_probability", reliability::failure_probability),
    ("staircase", reliability::staircase),
];

/// Offers sweeps to scripts; their runs are taken from `evaluations` and added to them.
pub fn register(engine: &mut Engine, evaluations: &Arc<Evaluations>) {
    for (name, function) in FUNCTIONS {
        let evaluations = Arc::clone(evaluations);
        engine.register_fn(name, move |context: NativeCallContext, study: &mut Study, options: Map| {
            let host = Host { evaluations: &evaluations, session: Session::from_context(&context) };
            function(study, &Options { of: name, map: &options }, &host)
        });
    }
    engine.register_fn("probit", |context: NativeCallContext, levels: Array, failed: Array| {
        reliability::probit_of(&levels, &failed, &Session::from_context(&context))
    });
}

/// The reference of sweeps in scripts.
pub const REFERENCE: &[Chapter] = &[
    Chapter { title: "many runs (droptower script)", entries: sweeping::ENTRIES },
    Chapter { title: "sensitivity (droptower script)", entries: surrogate::ENTRIES },
    Chapter { title: "reliability (droptower script)", entries: reliability::ENTRIES },
];
