//! The kinds of files that users write, and their schemas.

use serde_json::Value as Json;

use super::{Expectations, Material, Scenario, schema};

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
    /// Title of its schema.
    pub fn title(self) -> &'static str {
        match self {
            FileKind::Scenario => "droptower scenario",
            FileKind::Material => "droptower material",
            FileKind::Expectations => "droptower expectations",
        }
    }

    /// Name of the file that holds its schema beside files of this kind.
    pub fn schema_file(self) -> &'static str {
        match self {
            FileKind::Scenario => "droptower.schema.json",
            FileKind::Material => "droptower-material.schema.json",
            FileKind::Expectations => "droptower-expect.schema.json",
        }
    }

    /// The schema for editors.
    pub fn schema(self) -> Json {
        let title = self.title();
        match self {
            FileKind::Scenario => schema::published::<Scenario>(title),
            FileKind::Material => schema::published::<Material>(title),
            FileKind::Expectations => schema::published::<Expectations>(title),
        }
    }
}
