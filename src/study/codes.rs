//! The codes of all findings, module by module.

use base::finding::Code;
use lab::{confidence, experiment, signal};
use scene::{model, simulate};

use crate::{calibrate, identify, post, script, sweep};

/// All codes of runs, searches, sweeps and reductions.
pub fn all() -> impl Iterator<Item = &'static Code> {
    let modules = [
        signal::CODES,
        confidence::CODES,
        experiment::CODES,
        experiment::law_fit::CODES,
        experiment::relaxation::CODES,
        model::CODES,
        simulate::CODES,
        sweep::CODES,
        script::CODES,
        post::CODES,
        identify::CODES,
        calibrate::CODES,
    ];
    modules.into_iter().flatten().copied()
}

/// The code of this name; none of a code that a script gave.
pub fn find(name: &str) -> Option<&'static Code> {
    all().find(|code| code.name == name)
}
