//! The meaning of the figures of `summary.json`: names and sentences of the structs that hold them.

use std::sync::LazyLock;

use schemars::generate::SchemaSettings;
use schemars::{JsonSchema, SchemaGenerator};
use serde_json::{Value, json};

use super::impact::BodyFigures;
use super::results::{HEADER, OUTPUT};
use super::{Audit, Impact, Indent, Inflation, RunFindings, Stretch};

/// The fields that a summary may have in a script: those of all kinds of loading, then those of every run. Of several
/// impactors, those of each begin with its name.
pub(super) static SUMMARY: LazyLock<Vec<&str>> = LazyLock::new(|| NAMES.iter().map(String::as_str).collect());

/// The strings of [`SUMMARY`].
static NAMES: LazyLock<Vec<String>> = LazyLock::new(|| {
    let of_loadings =
        [names::<BodyFigures>(), names::<Impact>(), names::<Stretch>(), names::<Indent>(), names::<Inflation>()];
    let of_every_run = names::<Audit>();
    let of_loadings = of_loadings.into_iter().flatten().filter(|name| !of_every_run.contains(name));
    let mut all: Vec<String> = HEADER.map(String::from).into();
    for name in of_loadings {
        if !all.contains(&name) {
            all.push(name);
        }
    }
    let findings = json!(RunFindings::default());
    let findings = findings.as_object().into_iter().flat_map(|fields| fields.keys().cloned());
    all.extend(of_every_run.iter().cloned().chain(findings).chain(OUTPUT.map(String::from)));
    all
});

/// Whether the figure of a run is one that its post script measured.
pub fn is_of_script(name: &str) -> bool {
    let is_of = |known: &&str| name == *known || name.strip_suffix(*known).is_some_and(|name| name.ends_with('_'));
    !SUMMARY.iter().any(is_of)
}

/// Whether a run without a post script may have this figure; of several impactors each has its own, behind its name.
pub fn is_known(name: &str, has_several: bool) -> bool {
    SUMMARY.contains(&name) || has_several && !is_of_script(name)
}

/// A figure of `summary.json`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FigureName {
    /// Its name there; of several impactors it begins with theirs.
    pub name: String,
    /// Its meaning.
    pub sentence: String,
    /// Tables of the loadings whose runs have it.
    pub loadings: Vec<&'static str>,
    /// Whether each impactor has one.
    pub is_of_each_impactor: bool,
}

/// All figures, those of impacts first.
pub fn figures() -> Vec<FigureName> {
    let mut found: Vec<FigureName> = Vec::new();
    let mut add = |(name, sentence): (String, String), loadings: &[&'static str], is_of_each_impactor| match found
        .iter_mut()
        .find(|known| known.name == name && known.sentence == sentence)
    {
        Some(known) => known.loadings.extend_from_slice(loadings),
        None => found.push(FigureName { name, sentence, loadings: loadings.to_vec(), is_of_each_impactor }),
    };
    fields::<BodyFigures>().into_iter().for_each(|field| add(field, &["impact"], true));
    fields::<Impact>().into_iter().for_each(|field| add(field, &["impact"], false));
    fields::<Stretch>().into_iter().for_each(|field| add(field, &["stretch"], false));
    fields::<Indent>().into_iter().for_each(|field| add(field, &["indent"], false));
    fields::<Inflation>().into_iter().for_each(|field| add(field, &["pressure", "volume"], false));
    found
}

/// The names of the fields of `T` as they are written.
fn names<T: JsonSchema>() -> Vec<String> {
    fields::<T>().into_iter().map(|(name, _)| name).collect()
}

/// The fields of `T` as they are written: names and sentences.
fn fields<T: JsonSchema>() -> Vec<(String, String)> {
    let settings = SchemaSettings::draft2020_12().with(|settings| settings.inline_subschemas = true).for_serialize();
    let schema = SchemaGenerator::new(settings).into_root_schema_for::<T>();
    let fields = schema.get("properties").and_then(Value::as_object).into_iter().flatten();
    let sentence = |field: &Value| {
        let lines = field.get("description").and_then(Value::as_str).unwrap_or_default();
        lines.split_whitespace().collect::<Vec<_>>().join(" ")
    };
    fields.map(|(name, field)| (name.clone(), sentence(field))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_figure_has_a_sentence() {
        let all = figures();
        assert!(all.iter().all(|figure| figure.sentence.ends_with('.')), "{all:?}");
        let of = |name: &str| all.iter().find(|figure| figure.name == name).unwrap_or_else(|| panic!("{name}"));
        assert!(of("peak_acceleration_m_s2").is_of_each_impactor);
        assert_eq!(of("elements").loadings, ["impact", "stretch", "indent", "pressure", "volume"]);
        assert_eq!(of("burst_pressure_Pa").loadings, ["pressure", "volume"]);
    }
}
