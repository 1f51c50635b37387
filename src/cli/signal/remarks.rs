//! Comments of a file and the warnings of its reading, as text and as JSON.

use serde::Serialize;

use crate::findings;
use base::finding::Finding;
use lab::signal::Annotations;

/// Comments and findings of a file.
#[derive(Serialize)]
pub(crate) struct Remarks {
    /// Comments that are no finding.
    #[serde(skip)]
    comments: Vec<String>,
    /// Comments and messages of findings.
    notes: Vec<String>,
    findings: Vec<Finding>,
}

impl From<&Annotations> for Remarks {
    fn from(annotations: &Annotations) -> Remarks {
        Remarks {
            comments: annotations.free_comments().cloned().collect(),
            notes: annotations.notes(),
            findings: annotations.findings(),
        }
    }
}

impl Remarks {
    /// The lines of the terminal, each ending with a line break.
    pub(crate) fn lines(&self) -> String {
        lines(&self.comments, &self.findings)
    }
}

/// One line a finding, then one a comment, each ending with a line break.
pub(crate) fn lines<'f>(comments: &[String], findings: impl IntoIterator<Item = &'f Finding>) -> String {
    let comments: String = comments.iter().map(|comment| format!("  comment: {comment}\n")).collect();
    [findings::lines("  ", findings), comments].concat()
}
