//! What a user can change in a scenario about a warning or a failure of its run, in the scenario's keys.

use crate::model::{Loading, Model};
use crate::number::significant;
use crate::simulate::{Failure, Fault, Warning};

/// The warning of a run of `model` with its remedy, if there is one; `mass_scaling` is the factor that the run used.
pub(super) fn with_remedy(warning: &Warning, model: &Model, mass_scaling: Option<f64>) -> String {
    let remedy = match warning {
        Warning::CoarseContact { .. } | Warning::Penetration { .. } => "use a smaller specimen.mesh.size".to_owned(),
        Warning::Unfinished => "use a longer loading.impact.duration".to_owned(),
        Warning::FewerSnapshots { .. } => "use a lower output.frames".to_owned(),
        Warning::NotQuasiStatic { .. } | Warning::BarelyQuasiStatic { .. } => slower(model, mass_scaling),
        Warning::MisshapenElements { .. }
        | Warning::FrameHit { .. }
        | Warning::StrainLocalisation { .. }
        | Warning::EnergyBalance { .. }
        | Warning::StrainRateOutside { .. } => return warning.to_string(),
    };
    format!("{warning}; {remedy}")
}

/// The cause of a failed run of `model` with its remedy, if there is one.
pub fn failure(failure: &Failure, model: &Model) -> String {
    match &failure.cause {
        cause @ (Fault::NotQuasiStatic { .. } | Fault::NotAtRest { .. }) => {
            format!("{cause}; {}", slower(model, failure.so_far.mass_scaling))
        }
        cause @ (Fault::Engine(_) | Fault::EnergyBalance { .. }) => cause.to_string(),
    }
}

/// The remedy of a test that is too fast and used the factor `used` on the film's mass. A slower loading would only get
/// a larger factor where it is chosen.
fn slower(model: &Model, used: Option<f64>) -> String {
    let slower = "load it more slowly";
    let (key, written) = match model.loading {
        Loading::Impact { .. } => return slower.into(),
        Loading::Stretch { mass_scaling, .. } => ("loading.stretch.mass_scaling", mass_scaling),
        Loading::Indent { mass_scaling, .. } => ("loading.indent.mass_scaling", mass_scaling),
        Loading::Pressure { mass_scaling, .. } => ("loading.pressure.mass_scaling", mass_scaling),
    };
    match used.filter(|used| *used > 1.0).map(|used| significant(used, 4)) {
        None => slower.into(),
        Some(used) if written.is_some() => format!("set `{key}` lower than {used}, or {slower}"),
        Some(used) => format!("set `{key}` lower than {used}, which was chosen"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::post::tests::model;
    use crate::scenario::grammar;

    /// The paths of keys in `text`: words of a key's letters joined by points.
    fn paths(text: &str) -> impl Iterator<Item = &str> {
        let words = text.split(|c: char| !(c.is_ascii_lowercase() || c == '_' || c == '.'));
        words.map(|word| word.trim_matches('.')).filter(|word| word.contains('.'))
    }

    fn is_key(path: &str) -> bool {
        path.split('.').try_fold(grammar::scenario(), |rule, key| rule.under(key)).is_some()
    }

    #[test]
    fn every_key_that_a_remedy_names_is_one_of_a_scenario() {
        let (source, _) = include_str!("remedies.rs").split_once("#[cfg(test)]").unwrap();
        // Every second part between quotes is a text.
        let named: Vec<&str> = source.split('"').skip(1).step_by(2).flat_map(paths).collect();
        assert!(named.len() > 5, "{named:?}");
        let codes = [crate::simulate::CODES, crate::post::CODES].concat();
        let remedies = codes.iter().flat_map(|code| paths(code.remedy)).filter(|path| !path.ends_with(".csv"));
        for path in named.into_iter().chain(remedies) {
            assert!(is_key(path), "a scenario has no `{path}`");
        }
        assert!(!is_key("specimen.mesh.length"));
    }

    #[test]
    fn the_remedy_of_a_fast_test_names_the_key_of_its_mass() {
        let remedy = |mass_scaling: Option<f64>, used: Option<f64>| {
            let loading = Loading::Indent { depth: 0.01, velocity: 1.0, mass_scaling };
            with_remedy(&Warning::NotQuasiStatic { share: 0.02 }, &Model { loading, ..model() }, used)
        };
        let fact = "not quasi-static: kinetic energy is up to 2.0 % of the energy that the film took up; ";
        let key = "set `loading.indent.mass_scaling` lower than";
        for (written, used, expected) in [
            (None, Some(1.0), "load it more slowly".to_owned()),
            (Some(7.0), Some(7.0), format!("{key} 7, or load it more slowly")),
            (None, Some(250.0), format!("{key} 250, which was chosen")),
        ] {
            assert_eq!(remedy(written, used), format!("{fact}{expected}"));
        }
    }
}
