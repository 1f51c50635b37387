//! `--live` of a build without recordings, which refuses it.

use super::progress::Bar;
use super::scenarios::Checked;
use base::diagnostic::Diagnostic;
use report::RunPage;
use scene::simulate::SnapshotEvent;

/// A viewer; this build has none.
pub(super) enum Viewer {}

/// A run without a viewer.
pub(super) struct Show;

/// Refuses every address: this build has no recordings.
pub(super) fn viewer(_: &str) -> Result<Viewer, Diagnostic> {
    let mistake = Diagnostic::new("--live: this build writes no recordings");
    Err(mistake.hint("build with the feature `rerun`, which is on unless --no-default-features is given"))
}

impl Show {
    pub(super) fn begin(_: Option<&Viewer>, _: &Checked, _: &str, _: &Bar) -> Show {
        Show
    }

    pub(super) fn is_on(&self) -> bool {
        false
    }

    pub(super) fn update(&mut self, _: &SnapshotEvent<'_>) {}

    pub(super) fn finish(self, _: Option<&RunPage>) {}
}
