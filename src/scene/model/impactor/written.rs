//! Impactors as written, with the paths of their tables.

use crate::model::ModelDiagnostics;
use crate::scenario::{self, Scenario};

/// An impactor as written.
pub(in crate::model) struct Written<'s> {
    body: &'s scenario::Impactor,
    /// Path of its table.
    pub(in crate::model) path: String,
}

impl Written<'_> {
    /// Path of its `key`.
    pub(in crate::model) fn key(&self, key: &str) -> String {
        format!("{}.{key}", self.path)
    }
}

impl std::ops::Deref for Written<'_> {
    type Target = scenario::Impactor;

    fn deref(&self) -> &scenario::Impactor {
        self.body
    }
}

/// All impactors as written: one table, or a list of them.
pub(in crate::model) fn impactors<'s>(scenario: &'s Scenario, mistakes: &ModelDiagnostics<'_>) -> Vec<Written<'s>> {
    let is_list = mistakes.is_written("impactor.0");
    let path = |place: usize| if is_list { format!("impactor.{place}") } else { "impactor".to_owned() };
    scenario.impactor.iter().enumerate().map(|(place, body)| Written { body, path: path(place) }).collect()
}
