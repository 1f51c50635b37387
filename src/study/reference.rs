//! The reference of scripts: every function that they can call, with an example.

use crate::script::Chapter;
use crate::{calibrate, functions, identify, post, scenario_functions, sweep};

/// The chapters of the reference, in the order in which it is printed.
pub fn chapters() -> impl Iterator<Item = &'static Chapter> {
    let of_studies = scenario_functions::REFERENCE.iter().chain(identify::REFERENCE).chain(sweep::REFERENCE);
    let of_studies = of_studies.chain(calibrate::REFERENCE);
    post::REFERENCE.iter().chain(of_studies).chain(functions::REFERENCE)
}
