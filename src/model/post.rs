//! What happens to the results.

use std::path::PathBuf;

use super::Findings;
use crate::scenario::Scenario;

/// The script that adds to the summary.
pub fn check(scenario: &Scenario, findings: &mut Findings<'_>) -> Option<PathBuf> {
    scenario.post.as_ref()?;
    findings.file("post.script")
}
