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

/// What the data of a film leave open in every test of it, by the code of the finding that says so.
const LEFT_OPEN: [(&str, &str); 3] = [
    ("uncoupled-biaxial", "coupling of MD and TD"),
    ("strain-rate-outside", "strain rates"),
    ("break-strain-of-coupons", "break strain"),
];

/// What a finding says of the film's data, whatever the run: terminal and page collect these in one line.
pub fn left_open(code: &str) -> Option<&'static str> {
    LEFT_OPEN.iter().find(|(name, _)| *name == code).map(|(_, what)| *what)
}

/// The code of this name; none of a code that a script gave.
pub fn find(name: &str) -> Option<&'static Code> {
    all().find(|code| code.name == name)
}
