//! The JSON Schema of the language, generated from its structs, for each kind of file that users write.

use schemars::generate::SchemaSettings;
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde_json::{Map, Value as Json, json};

use super::{Expectations, Material, Scenario};

/// The schema with every table inlined, from which the grammar is compiled.
pub(super) fn whole<T: JsonSchema>() -> Json {
    let mut settings = SchemaSettings::draft2020_12();
    settings.inline_subschemas = true;
    let schema = settings.into_generator().into_root_schema_for::<T>();
    without_null(schema.to_value())
}

/// A path of a file that holds the table, or the table itself.
pub(super) fn path_or_table<T: JsonSchema>(generator: &mut SchemaGenerator) -> Schema {
    let table = generator.subschema_for::<T>();
    json_schema!({ "anyOf": [{ "type": "string", "x-path": true, "x-included": true }, table] })
}

/// A path of a file that holds the list, or the list itself.
pub(super) fn path_or_list<T: JsonSchema>(generator: &mut SchemaGenerator) -> Schema {
    let item = generator.subschema_for::<T>();
    let list = json!({ "type": "array", "items": item, "minItems": 1 });
    json_schema!({ "anyOf": [{ "type": "string", "x-path": true, "x-included": true }, list] })
}

/// One, the value of factors and numbers that are left out.
pub(super) fn one<T: From<u8>>() -> T {
    T::from(1)
}

/// Every item of the list is above zero.
pub(super) fn positive_items(schema: &mut Schema) {
    let list = match schema.get_mut("anyOf").and_then(|any| any.get_mut(0)) {
        Some(list) => list.as_object_mut(),
        None => schema.as_object_mut(),
    };
    if let Some(items) = list.and_then(|l| l.get_mut("items")).and_then(Json::as_object_mut) {
        items.insert("exclusiveMinimum".into(), json!(0));
    }
}

/// TOML has no null: an optional key is left out.
fn without_null(schema: Json) -> Json {
    match schema {
        Json::Array(items) => Json::Array(items.into_iter().map(without_null).collect()),
        Json::Object(map) => {
            let map = map.into_iter().map(|(k, v)| (k, without_null(v)));
            Json::Object(without_null_branch(map.collect()))
        }
        other => other,
    }
}

fn without_null_branch(mut map: Map<String, Json>) -> Map<String, Json> {
    if map.get("default") == Some(&Json::Null) {
        map.shift_remove("default");
    }
    if let Some(Json::Array(types)) = map.get_mut("type") {
        types.retain(|t| t != "null");
        if let [only] = types.as_slice() {
            let only = only.clone();
            map.insert("type".into(), only);
        }
    }
    if let Some(Json::Array(choices)) = map.get_mut("enum") {
        choices.retain(|c| !c.is_null());
    }
    let Some(Json::Array(branches)) = map.get_mut("anyOf") else {
        return map;
    };
    branches.retain(|b| b != &json!({ "type": "null" }));
    if branches.len() != 1 {
        return map;
    }
    let Some(Json::Array(mut branches)) = map.shift_remove("anyOf") else {
        return map;
    };
    if let Some(Json::Object(mut only)) = branches.pop() {
        only.extend(map);
        return only;
    }
    map
}

/// The schema without what only a whole file must satisfy, and with unknown keys forbidden in every table.
pub fn open(schema: Json) -> Json {
    match schema {
        Json::Array(items) => Json::Array(items.into_iter().map(open).collect()),
        Json::Object(mut map) => {
            map.shift_remove("required");
            if map.get("oneOf").is_some_and(asks_for_keys) {
                map.shift_remove("oneOf");
            }
            map.shift_remove("not");
            if map.contains_key("properties") && map.get("x-varied").is_none() {
                map.insert("additionalProperties".into(), json!(false));
            }
            Json::Object(map.into_iter().map(|(k, v)| (k, open(v))).collect())
        }
        other => other,
    }
}

/// Whether the branches of a `oneOf` only name required keys.
fn asks_for_keys(branches: &Json) -> bool {
    branches.as_array().is_some_and(|b| b.iter().all(|b| b.get("properties").is_none() && b.get("required").is_some()))
}

/// A kind of file that users write.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FileKind {
    /// A scenario.
    Scenario,
    /// A material of one layer of film.
    Material,
    /// The expectations of a run: `expect.toml`.
    Expectations,
}

impl FileKind {
    /// Title of its schema, name of the file that holds this, and the schema of a whole file.
    fn row(self) -> (&'static str, &'static str, fn() -> Json) {
        match self {
            FileKind::Scenario => ("droptower scenario", "droptower.schema.json", whole::<Scenario>),
            FileKind::Material => ("droptower material", "droptower-material.schema.json", whole::<Material>),
            FileKind::Expectations => ("droptower expectations", "droptower-expect.schema.json", whole::<Expectations>),
        }
    }

    /// Name of the file that holds its schema beside files of this kind.
    pub fn schema_file(self) -> &'static str {
        let (_, file, _) = self.row();
        file
    }

    /// The schema for editors. Files extend one another, so no single file must be complete: only `droptower check` can say
    /// that a key is missing.
    pub fn schema(self) -> Json {
        let (title, _, whole) = self.row();
        let mut schema = open(whole());
        if let Json::Object(top) = &mut schema {
            top.insert("title".into(), json!(title));
            top.insert("type".into(), json!("object"));
        }
        schema
    }
}
