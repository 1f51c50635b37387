//! `--live`: a run in a running viewer while it goes. Whatever goes wrong with the viewer is a warning: the run goes on.

use std::sync::atomic::{AtomicBool, Ordering};

use super::progress::Bar;
use super::scenarios::Checked;
use crate::diagnostic::Diagnostic;
use crate::report::RunPage;
use crate::report::recording::{Address, Live, LiveError};
use crate::simulate::SnapshotEvent;

/// The viewer that shows runs.
pub struct Viewer {
    address: Address,
    /// Whether it did not answer or got stuck: then the other runs do without it too.
    is_gone: AtomicBool,
}

/// A run on show, where there is anybody to show it to.
pub struct Show<'a> {
    live: Option<Live<'a>>,
    viewer: Option<&'a Viewer>,
    bar: &'a Bar,
}

/// The viewer at an address.
///
/// # Errors
/// The address is none.
pub fn viewer(address: &str) -> Result<Viewer, Diagnostic> {
    let viewer = |address| Viewer { address, is_gone: AtomicBool::new(false) };
    address.parse().map(viewer).map_err(|error| {
        let mistake = Diagnostic::new(format!("--live: `{address}` is no address of a viewer: {error}"));
        mistake.hint(format!("write it like {}", Address::DEFAULT))
    })
}

impl<'a> Show<'a> {
    /// Begins to show the run of `checked` from the text `scenario`, where there is a viewer and it answers.
    pub fn begin(viewer: Option<&'a Viewer>, checked: &'a Checked, scenario: &'a str, bar: &'a Bar) -> Show<'a> {
        let mut show = Show { live: None, viewer: viewer.filter(|viewer| !viewer.is_gone()), bar };
        if let Some(viewer) = show.viewer {
            match Live::connect(&viewer.address, &checked.model, checked.plan.comparison(), scenario) {
                Ok(live) => show.live = Some(live),
                Err(error) => show.warn(&error),
            }
        }
        show
    }

    /// Whether anybody looks on.
    pub fn is_on(&self) -> bool {
        self.live.is_some()
    }

    /// Shows a state.
    pub fn look(&mut self, event: &SnapshotEvent<'_>) {
        if self.viewer.is_some_and(Viewer::is_gone) {
            self.live = None;
        }
        if let Some(live) = &mut self.live {
            live.show(event);
        }
    }

    /// Shows what was measured in the end, if anything was.
    pub fn finish(mut self, run: Option<&RunPage>) {
        let live = self.live.take().filter(|_| !self.viewer.is_some_and(Viewer::is_gone));
        if let Some(Err(error)) = live.map(|live| live.finish(run)) {
            self.warn(&error);
        }
    }

    /// Warns of what goes wrong with a viewer, once of one that is gone.
    fn warn(&self, error: &LiveError) {
        let is_gone = matches!(error, LiveError::NoAnswer { .. } | LiveError::Stuck { .. });
        let was_gone = is_gone && self.viewer.is_some_and(|viewer| viewer.is_gone.swap(true, Ordering::Relaxed));
        if !was_gone {
            self.bar.warn(&format!("--live: {error}; the run and its recording do without"));
        }
    }
}

impl Viewer {
    fn is_gone(&self) -> bool {
        self.is_gone.load(Ordering::Relaxed)
    }
}
