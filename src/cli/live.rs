//! `--live`: a run in a running viewer while it goes. Whatever goes wrong with the viewer is a warning: the run goes on.

use super::progress::Bar;
use super::scenarios::Checked;
use crate::diagnostic::Diagnostic;
use crate::report::RunPage;
use crate::report::recording::{Address, Live, LiveError};
use crate::simulate::Glimpse;

/// The viewer that shows runs.
pub struct Viewer(Address);

/// A run on show, where there is anybody to show it to.
pub struct Show<'a> {
    live: Option<Live<'a>>,
    bar: &'a Bar,
}

/// The viewer at an address.
///
/// # Errors
/// The address is none.
pub fn viewer(address: &str) -> Result<Viewer, Diagnostic> {
    address.parse().map(Viewer).map_err(|error| {
        let mistake = Diagnostic::new(format!("--live: `{address}` is no address of a viewer: {error}"));
        mistake.hint(format!("write it like {}", Address::DEFAULT))
    })
}

impl<'a> Show<'a> {
    /// Begins to show the run of `checked` from the text `scenario`, where there is a viewer and it answers.
    pub fn begin(viewer: Option<&Viewer>, checked: &'a Checked, scenario: &'a str, bar: &'a Bar) -> Show<'a> {
        let connect = |Viewer(address): &Viewer| {
            Live::connect(address, &checked.model, checked.plan.comparison(), scenario)
                .map_err(|error| warn(bar, &error))
                .ok()
        };
        Show { live: viewer.and_then(connect), bar }
    }

    /// Whether anybody looks on.
    pub fn is_on(&self) -> bool {
        self.live.is_some()
    }

    /// Shows a state.
    pub fn look(&mut self, glimpse: &Glimpse<'_>) {
        if let Some(Err(error)) = self.live.as_mut().map(|live| live.show(glimpse)) {
            warn(self.bar, &error);
            self.live = None;
        }
    }

    /// Shows what was measured in the end, if anything was.
    pub fn finish(self, run: Option<&RunPage>) {
        if let Some(Err(error)) = self.live.map(|live| live.finish(run)) {
            warn(self.bar, &error);
        }
    }
}

fn warn(bar: &Bar, error: &LiveError) {
    bar.warn(&format!("--live: {error}; the run and its recording do without"));
}
