//! `droptower watch`: runs a scenario again on every save of it or of a file that it names. The last good result stays
//! until the next one is complete.

mod inputs;

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;

use clap::Args;
use serde::Serialize;
use serde_json::{Value, json};

use self::inputs::{Inputs, TICK};
use super::changes::Changes;
use super::faults::storing;
use super::live::{self, Viewer};
use super::run::{self, Done};
use super::scenarios::{self, both};
use super::{DiagnosticFormat, Failure, Shared, complete, print, print_diagnostics, print_line, print_records};
use base::cancellation::Cancellation;
use base::diagnostic::{Diagnostic, shown_path};
use scene::scenario::{Assignment, Document};
use study::store::{self, Origin};

#[derive(Debug, Args)]
pub(super) struct WatchArgs {
    /// Scenario file
    #[arg(value_name = "SCENARIO", add = complete::scenarios())]
    scenario: PathBuf,
    #[command(flatten)]
    changes: Changes,
    /// Folder for the results, in place of runs/<name of the scenario>
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Replace results of another scenario in the same folder
    #[arg(long)]
    force: bool,
    /// Before each run, run with elements of this size ("40 mm"), whose result is there sooner
    #[arg(long, value_name = "SIZE")]
    coarse: Option<String>,
    /// Show the runs in an open Rerun viewer while they compute [usual address: rerun+http://127.0.0.1:9876/proxy]
    #[arg(
        long,
        value_name = "URL",
        num_args = 0..=1,
        require_equals = true,
        default_missing_value = "rerun+http://127.0.0.1:9876/proxy"
    )]
    live: Option<String>,
}

/// The result of a look at the scenario, as a line of JSON.
#[derive(Serialize)]
#[serde(tag = "event", rename_all = "kebab-case")]
enum Event<'a> {
    /// The command has begun.
    Watching,
    /// A run is complete, with its summary.
    Run { coarse: bool, folder: &'a Path, summary: &'a Value },
    /// There is no new result.
    Mistakes { diagnostics: Value },
}

/// The command.
struct Watch<'a> {
    args: &'a WatchArgs,
    shared: &'a Shared,
    /// Changes of the arguments; with those of the coarse run before each run, if there is one.
    changes: Vec<(bool, Vec<Assignment>)>,
    viewer: Option<Viewer>,
}

/// Runs until the process is ended.
pub(super) fn run(args: &WatchArgs, shared: &Shared) -> Result<(), Failure> {
    let viewer = args.live.as_deref().map(live::viewer).transpose().map_err(|mistake| vec![mistake]);
    let (changes, viewer) = both(changes(args), viewer)?;
    if !args.scenario.is_file() {
        return Err(Diagnostic::new(format!("there is no scenario {}", shown_path(&args.scenario))).into());
    }
    let watch = Watch { args, shared, changes, viewer };
    watch.begin()?;
    let mut inputs = Inputs::new(&args.scenario);
    loop {
        watch.turn(&mut inputs)?;
        inputs.wait();
    }
}

fn changes(args: &WatchArgs) -> Result<Vec<(bool, Vec<Assignment>)>, Vec<Diagnostic>> {
    let own = args.changes.assignments()?;
    let Some(size) = &args.coarse else {
        return Ok(vec![(false, own)]);
    };
    let coarse = args.changes.and(format!("specimen.mesh.size={size}"));
    Ok(vec![(true, coarse.assignments()?), (false, own)])
}

impl Watch<'_> {
    fn begin(&self) -> Result<(), Failure> {
        if self.shared.json {
            return print_line(&Event::Watching);
        }
        if self.shared.quiet {
            return Ok(());
        }
        print(&format!("watching {} and the files that it names; Ctrl-C ends", shown_path(&self.args.scenario)))
    }

    /// Runs the scenario as it is now, until a file changes.
    fn turn(&self, inputs: &mut Inputs) -> Result<(), Failure> {
        inputs.look();
        for (is_coarse, changes) in &self.changes {
            // Known before they are read, so that a save in between is seen.
            inputs.extend(names(&self.args.scenario, changes));
            let verdict = scenarios::check(&self.args.scenario, changes);
            let done = match verdict.map_err(Failure::from).and_then(|checked| self.simulate(checked, inputs)) {
                Ok(Some((place, done))) => self.show(*is_coarse, &place, &done)?,
                Ok(None) => return Ok(()),
                Err(failure) => self.tell(&failure)?,
            };
            if !done {
                return Ok(());
            }
        }
        Ok(())
    }

    /// The run of a checked scenario and its folder; `None` where a file changed before its end.
    fn simulate(&self, checked: scenarios::Checked, inputs: &Inputs) -> Result<Option<(PathBuf, Done)>, Failure> {
        let place = match &self.args.out {
            Some(out) => out.clone(),
            None => store::default_place(&checked.model.name).map_err(|error| storing(&error))?,
        };
        store::check_places(std::slice::from_ref(&place)).map_err(|error| storing(&error))?;
        if !self.args.force {
            Origin::of_run(checked.document.path()).check(&place).map_err(|error| storing(&error))?;
        }
        let cancellation = Cancellation::default();
        let is_over = AtomicBool::new(false);
        let done = thread::scope(|scope| {
            scope.spawn(|| {
                while !is_over.load(Ordering::Relaxed) {
                    if inputs.have_changed() {
                        return cancellation.cancel();
                    }
                    thread::sleep(TICK);
                }
            });
            let done = run::one(checked, &place, &cancellation, self.viewer.as_ref(), self.shared);
            is_over.store(true, Ordering::Relaxed);
            done
        });
        Ok((!cancellation.is_cancelled()).then_some((place, done)))
    }

    /// Shows what a run gave; `false` where it failed.
    fn show(&self, is_coarse: bool, place: &Path, done: &Done) -> Result<bool, Failure> {
        if let Some(failure) = &done.failure {
            return self.tell(failure);
        }
        match &done.summary {
            Some(summary) if self.shared.json => print_line(&Event::Run { coarse: is_coarse, folder: place, summary })?,
            _ if self.shared.quiet || self.shared.json => {}
            _ => print(done.text.trim_end())?,
        }
        Ok(true)
    }

    /// Tells why there is no new result; `false`, as there is none.
    fn tell(&self, failure: &Failure) -> Result<bool, Failure> {
        let diagnostics = &failure.diagnostics;
        if self.shared.json {
            let records: Vec<_> = diagnostics.iter().map(Diagnostic::record).collect();
            print_line(&Event::Mistakes { diagnostics: json!(records) })?;
        }
        match self.shared.diagnostics {
            _ if self.shared.json => {}
            DiagnosticFormat::Text => print_diagnostics(diagnostics),
            DiagnosticFormat::Json => print_records(diagnostics),
        }
        Ok(false)
    }
}

/// The files on which the results rest, as far as they are known; of a scenario with mistakes, too.
fn names(path: &Path, changes: &[Assignment]) -> Vec<PathBuf> {
    let mut names = Document::sources(path);
    let read = Document::read(path).map(|document| document.with(changes));
    if let Ok(document) = read {
        names.extend(document.files().iter().cloned());
        // Those of a field may be a pattern.
        let named = document.named();
        let files = named.iter().filter_map(|path| scenarios::expanded(&path.display().to_string()).ok());
        names.extend(files.flatten());
    }
    names
}
