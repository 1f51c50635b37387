//! `--live` of a build without recordings, which refuses it.

use super::progress::Bar;
use super::scenarios::Checked;
use crate::diagnostic::Diagnostic;
use crate::report::RunPage;
use crate::simulate::SnapshotEvent;

/// A viewer; this build has none.
pub enum Viewer {}

/// A run without a viewer.
pub struct Show;

/// Refuses every address: this build has no recordings.
pub fn viewer(_: &str) -> Result<Viewer, Diagnostic> {
    let mistake = Diagnostic::new("--live: this build writes no recordings");
    Err(mistake.hint("build with the feature `rerun`, which is on unless --no-default-features is given"))
}

impl Show {
    pub fn begin(_: Option<&Viewer>, _: &Checked, _: &str, _: &Bar) -> Show {
        Show
    }

    pub fn is_on(&self) -> bool {
        false
    }

    pub fn look(&mut self, _: &SnapshotEvent<'_>) {}

    pub fn finish(self, _: Option<&RunPage>) {}
}
