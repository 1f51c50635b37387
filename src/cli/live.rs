//! `--live`: a run in an open viewer while it computes. A failure of the viewer is a warning: the run continues.

use std::sync::atomic::{AtomicBool, Ordering};

use super::progress::Bar;
use super::scenarios::Checked;
use base::diagnostic::Diagnostic;
use report::RunPage;
use scene::simulate::SnapshotEvent;
use viz::{Address, Live, LiveError};

/// The viewer that shows runs.
pub(super) struct Viewer {
    address: Address,
    /// Whether it did not answer or stopped responding: then the other runs are not shown either.
    is_unavailable: AtomicBool,
}

/// A run that a viewer shows, if one answers.
pub(super) struct Show<'a> {
    live: Option<Live<'a>>,
    viewer: Option<&'a Viewer>,
    bar: &'a Bar,
}

/// The viewer at an address.
///
/// # Errors
/// The text is not an address.
pub(super) fn viewer(address: &str) -> Result<Viewer, Diagnostic> {
    let viewer = |address| Viewer { address, is_unavailable: AtomicBool::new(false) };
    address.parse().map(viewer).map_err(|error| {
        let mistake = Diagnostic::new(format!("--live: expected the address of a viewer, found `{address}`: {error}"));
        mistake.hint(format!("write it like {}", Address::DEFAULT))
    })
}

impl<'a> Show<'a> {
    /// Begins to show the run of `checked`, resolved as `scenario`, if there is a viewer and it answers.
    pub(super) fn begin(viewer: Option<&'a Viewer>, checked: &'a Checked, scenario: &'a str, bar: &'a Bar) -> Show<'a> {
        let mut show = Show { live: None, viewer: viewer.filter(|viewer| !viewer.is_unavailable()), bar };
        if let Some(viewer) = show.viewer {
            match Live::connect(&viewer.address, &checked.model, checked.plan.comparison(), scenario) {
                Ok(live) => show.live = Some(live),
                Err(error) => show.warn(&error),
            }
        }
        show
    }

    /// Whether a viewer shows the run.
    pub(super) fn is_on(&self) -> bool {
        self.live.is_some()
    }

    /// Shows a state.
    pub(super) fn update(&mut self, event: &SnapshotEvent<'_>) {
        // Another run of the batch may have found it so: this one does not wait for a failure of its own.
        if self.viewer.is_some_and(Viewer::is_unavailable) {
            self.live = None;
        }
        if let Some(live) = &mut self.live {
            live.show(event);
        }
    }

    /// Shows the results, if there are any.
    pub(super) fn finish(mut self, run: Option<&RunPage>) {
        let live = self.live.take().filter(|_| !self.viewer.is_some_and(Viewer::is_unavailable));
        if let Some(Err(error)) = live.map(|live| live.finish(run)) {
            self.warn(&error);
        }
    }

    /// Warns of a failure of the viewer; of one that is unavailable, once.
    fn warn(&self, error: &LiveError) {
        let is_unavailable = matches!(error, LiveError::NoAnswer { .. } | LiveError::NotResponding { .. });
        // Exchanged at once, so that of runs side by side only one warns.
        let was_unavailable =
            is_unavailable && self.viewer.is_some_and(|viewer| viewer.is_unavailable.swap(true, Ordering::Relaxed));
        if !was_unavailable {
            self.bar.warn(&format!("--live: {error}; the run continues without the viewer"));
        }
    }
}

impl Viewer {
    fn is_unavailable(&self) -> bool {
        self.is_unavailable.load(Ordering::Relaxed)
    }
}
