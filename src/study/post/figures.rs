//! What the figures of `summary.json` are: names and sentences of the structs that hold them.

use schemars::generate::SchemaSettings;
use schemars::{JsonSchema, SchemaGenerator};
use serde_json::Value;

use super::impact::BodyFigures;
use super::{Impact, Indent, Inflation, Stretch};

/// A figure of `summary.json`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FigureName {
    /// Its name there; of several impactors it begins with theirs.
    pub name: String,
    /// What it is.
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
