//! Changes of a scenario that help with a warning or a failure of its run, in the scenario's keys. A remedy that is the
//! same for every scenario is that of the warning's code.

use base::finding::Report;
use base::number::significant;
use scene::mesh::Outline;
use scene::model::Model;
use scene::model::loading::MassScaling;
use scene::simulate::{Failure, Fault, Warning};

/// The warning of a run of `model` with its remedy, if there is one; `mass_scaling` is the factor that the run used.
pub(super) fn with_remedy(warning: &Warning, model: &Model, mass_scaling: Option<f64>) -> String {
    let remedy = match warning {
        Warning::AddedMass { .. }
        | Warning::NotInEquilibrium(_)
        | Warning::NoContact(_)
        | Warning::TornBeforeContact { .. }
        | Warning::TooFast { .. }
        | Warning::ClampLeft { .. }
        | Warning::ClampSlip { .. }
        | Warning::Unfinished(_)
        | Warning::FewerSnapshots { .. } => warning.code().remedy.to_owned(),
        Warning::CoarseContact { .. } | Warning::Penetration { .. } => finer(warning, model),
        Warning::NotQuasiStatic { .. } | Warning::BarelyQuasiStatic { .. } => slower(model, mass_scaling),
        // The others need none, or one that is the same for every scenario.
        _ => return warning.to_string(),
    };
    format!("{warning}; {remedy}")
}

/// The remedy of elements that are too large.
fn finer(warning: &Warning, model: &Model) -> String {
    let first = model.faces.first().map(|face| face.meshing.size);
    match &model.specimen.shape {
        Outline::Mesh { .. } => "give a finer mesh in `specimen.shape.mesh`".into(),
        _ if model.faces.iter().any(|face| face.meshing.grading.is_some()) => {
            "use a smaller `specimen.mesh.fine`, or a larger `specimen.mesh.within`".into()
        }
        _ if model.faces.iter().any(|face| Some(face.meshing.size) != first) => {
            format!("{} or `mesh.size` of the `[[layer]]`", warning.code().remedy)
        }
        _ => warning.code().remedy.to_owned(),
    }
}

/// The cause of a failed run of `model` with its remedy, if there is one.
pub fn failure(failure: &Failure, model: &Model) -> String {
    match &failure.cause {
        cause @ (Fault::NotQuasiStatic { .. } | Fault::NotAtRest { .. }) => {
            format!("{cause}; {}", slower(model, failure.so_far.mass_scaling))
        }
        cause @ (Fault::Engine(_) | Fault::ReleasedInside { .. } | Fault::EnergyBalance { .. }) => cause.to_string(),
    }
}

/// The remedy of a test that is too fast and used the factor `used` on the film's mass. A slower loading would only get
/// a larger factor where it is chosen.
fn slower(model: &Model, used: Option<f64>) -> String {
    let slower = "load it more slowly";
    let Some(used) = used.filter(|used| *used > 1.0).map(|used| significant(used, 4)) else { return slower.into() };
    let key = model.loading.key("mass_scaling");
    match model.loading.mass_scaling() {
        MassScaling::Unscaled => slower.into(),
        MassScaling::Given(_) => format!("set `{key}` lower than {used}, or {slower}"),
        MassScaling::Chosen => format!("set `{key}` lower than {used}, which was chosen"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::post::tests::model;
    use scene::mesh::{Grading, Zone};
    use scene::model::Loading;
    use scene::model::loading::Indent;
    use scene::scenario::grammar;
    use scene::simulate::{BodySize, ImpactorName};

    /// The paths of keys in `text`: words of a key's letters joined by points.
    fn paths(text: &str) -> impl Iterator<Item = &str> {
        let words = text.split(|c: char| !(c.is_ascii_lowercase() || c == '_' || c == '.'));
        words.map(|word| word.trim_matches('.')).filter(|word| word.contains('.'))
    }

    fn is_key(path: &str) -> bool {
        grammar::scenario().at(path).is_some()
    }

    /// Every second part of `text` between `quotes`.
    fn enclosed(text: &str, quotes: char) -> impl Iterator<Item = &str> {
        text.split(quotes).skip(1).step_by(2)
    }

    #[test]
    fn every_key_that_a_remedy_names_is_one_of_a_scenario() {
        let (source, _) = include_str!("remedies.rs").split_once("#[cfg(test)]").unwrap();
        let named: Vec<&str> = enclosed(source, '"').flat_map(paths).collect();
        assert_eq!(named.len(), 4, "{named:?}");
        let remedies = || [scene::simulate::CODES, crate::post::CODES].concat().into_iter().map(|code| code.remedy);
        let of_codes: Vec<&str> = remedies().flat_map(paths).filter(|path| !path.ends_with(".csv")).collect();
        assert!(of_codes.len() > 5, "{of_codes:?}");
        let of_layers = |path: &str| path == "mesh.size";
        for path in named.iter().chain(&of_codes).filter(|path| !of_layers(path)) {
            assert!(is_key(path), "a scenario has no `{path}`");
        }
        assert!(!is_key("specimen.mesh.length"));
        for kind in ["stretch", "indent", "pressure", "volume"] {
            assert!(is_key(&format!("loading.{kind}.mass_scaling")), "{kind}");
        }
        for remedy in remedies() {
            let quoted: Vec<&str> = enclosed(remedy, '`').flat_map(paths).collect();
            assert_eq!(paths(remedy).collect::<Vec<_>>(), quoted, "{remedy}");
        }
    }

    #[test]
    fn the_remedy_of_coarse_elements_names_what_gives_their_size() {
        let warning =
            Warning::CoarseContact { impactor: ImpactorName::Only, time: 0.01, edge: 0.4, size: BodySize::Radius };
        let mut model = model();
        let mut finer = model.faces[0].clone();
        finer.meshing.size *= 0.5;
        let two = Model { faces: vec![model.faces[0].clone(), finer], ..model.clone() };
        assert!(with_remedy(&warning, &two, None).ends_with("`specimen.mesh.size` or `mesh.size` of the `[[layer]]`"));
        let zones = vec![Zone { at: [0.0; 2], within: 0.01 }];
        model.faces[0].meshing.grading = Some(Grading { fine: 1e-3, growth: 0.25, zones });
        assert!(with_remedy(&warning, &model, None).contains("`specimen.mesh.fine`"));
        model.specimen.shape = Outline::Mesh { path: "film.stl".into(), scale: 1.0 };
        let remedy = with_remedy(&warning, &model, None);
        assert!(remedy.ends_with("give a finer mesh in `specimen.shape.mesh`"), "{remedy}");
    }

    #[test]
    fn the_remedy_of_a_fast_test_names_the_key_of_its_mass() {
        let remedy = |mass_scaling: Option<f64>, used: Option<f64>| {
            let loading = Loading::Indent(Indent { depth: 0.01, velocity: 1.0, mass_scaling });
            with_remedy(&Warning::NotQuasiStatic { share: 0.02 }, &Model { loading, ..model() }, used)
        };
        let fact = "not quasi-static: kinetic energy is up to 2 % of the energy that the film took up; ";
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
