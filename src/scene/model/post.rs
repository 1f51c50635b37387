//! The post script.

use std::path::PathBuf;

use super::ModelDiagnostics;
use crate::scenario::Scenario;

/// The script that adds to the summary.
pub fn check(scenario: &Scenario, mistakes: &mut ModelDiagnostics<'_>) -> Option<PathBuf> {
    scenario.post.as_ref()?;
    mistakes.file("post.script")
}
