//! `droptower watch`: runs a scenario again on every save of it or of a file that it names. The last good result stays
//! until the next one is complete.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};
use std::{fs, thread};

use clap::Args;
use serde::Serialize;
use serde_json::{Value, json};

use crate::args::{Changes, ViewerArgs};
use crate::failure::both;
use crate::folder::ResultArgs;
use crate::live::Viewer;
use crate::run::{self, Done};
use crate::scenarios;
use crate::{
    DiagnosticFormat, Failure, Shared, print_diagnostics, print_line, print_records, print_unless_quiet, shell,
};
use base::cancellation::Cancellation;
use base::diagnostic::{Diagnostic, shown_path};
use base::periodic;
use scene::scenario::{Assignment, Document};
use study::store::Origin;

#[derive(Debug, Args)]
pub(crate) struct WatchArgs {
    /// Scenario file
    #[arg(value_name = "SCENARIO", add = shell::scenarios())]
    scenario: PathBuf,
    #[command(flatten)]
    changes: Changes,
    #[command(flatten)]
    results: ResultArgs,
    /// Before each run, run with elements of this size ("40 mm"), whose result is there sooner
    #[arg(long, value_name = "SIZE")]
    coarse: Option<String>,
    #[command(flatten)]
    viewer: ViewerArgs,
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
pub(crate) fn run(args: &WatchArgs, shared: &Shared) -> Result<(), Failure> {
    let (changes, viewer) = both(changes(args), args.viewer.viewer())?;
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

fn changes(args: &WatchArgs) -> Result<Vec<(bool, Vec<Assignment>)>, Failure> {
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
        let text = format!("watching {} and the files that it names; Ctrl-C ends", shown_path(&self.args.scenario));
        print_unless_quiet(self.shared, &text)
    }

    /// Runs the scenario as it is now, until a file changes.
    fn turn(&self, inputs: &mut Inputs) -> Result<(), Failure> {
        inputs.look();
        for (is_coarse, changes) in &self.changes {
            // Known before they are read, so that a save in between is seen.
            inputs.extend(names(&self.args.scenario, changes));
            let verdict = scenarios::check(&self.args.scenario, changes);
            let done = match verdict.and_then(|checked| self.simulate(checked, inputs)) {
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
        let origin = Origin::of_run(checked.document.path());
        let place = self.args.results.place(&checked.model.name, origin)?.folder;
        let cancellation = Cancellation::default();
        let look = || {
            if inputs.have_changed() {
                cancellation.cancel();
            }
        };
        let run = || run::one(checked, &place, &cancellation, self.viewer.as_ref(), self.shared);
        let done = periodic::during(TICK, look, run);
        Ok((!cancellation.is_cancelled()).then_some((place, done)))
    }

    /// Shows what a run gave; `false` where it failed.
    fn show(&self, is_coarse: bool, place: &Path, done: &Done) -> Result<bool, Failure> {
        if let Some(failure) = &done.failure {
            return self.tell(failure);
        }
        match &done.summary {
            Some(summary) if self.shared.json => print_line(&Event::Run { coarse: is_coarse, folder: place, summary })?,
            _ if self.shared.json => {}
            _ => print_unless_quiet(self.shared, done.text.trim_end())?,
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

/// Time between two looks at the files. They are looked at, in place of waiting for the system to tell, because network
/// drives tell nothing.
pub(crate) const TICK: Duration = Duration::from_millis(150);

/// The mark by which a saved file is noticed: time and length; `None` where there is no file.
type State = Option<(SystemTime, u64)>;

/// Files as they were when they were read.
#[derive(Debug)]
struct Inputs(BTreeMap<PathBuf, State>);

impl Inputs {
    /// The scenario alone.
    pub(crate) fn new(scenario: &Path) -> Inputs {
        Inputs(BTreeMap::from([(scenario.to_owned(), state(scenario))]))
    }

    /// Takes the files as they are now.
    pub(crate) fn look(&mut self) {
        for (path, known) in &mut self.0 {
            *known = state(path);
        }
    }

    /// Adds files; those that are known stay as they were.
    pub(crate) fn extend(&mut self, paths: Vec<PathBuf>) {
        for path in paths {
            let now = state(&path);
            self.0.entry(path).or_insert(now);
        }
    }

    /// Whether a file was saved, removed or made since.
    fn have_changed(&self) -> bool {
        self.0.iter().any(|(path, known)| state(path) != *known)
    }

    /// Waits until a file has changed, and then until it stays as it is: an editor may write in several parts.
    pub(crate) fn wait(&mut self) {
        while !self.have_changed() {
            thread::sleep(TICK);
        }
        loop {
            self.look();
            thread::sleep(TICK / 2);
            if !self.have_changed() {
                return;
            }
        }
    }
}

fn state(path: &Path) -> State {
    let about = fs::metadata(path).ok()?;
    Some((about.modified().ok()?, about.len()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn saved_removed_and_new_files_are_seen() {
        let folder = tempfile::tempdir().unwrap();
        let [one, other] = ["one", "other"].map(|name| folder.path().join(name));
        fs::write(&one, "1").unwrap();
        let mut inputs = Inputs::new(&one);
        inputs.extend(vec![other.clone(), one.clone()]);
        assert!(!inputs.have_changed());
        fs::write(&other, "").unwrap();
        assert!(inputs.have_changed());
        inputs.look();
        fs::write(&one, "12").unwrap();
        assert!(inputs.have_changed());
        inputs.look();
        fs::remove_file(&one).unwrap();
        assert!(inputs.have_changed());
        inputs.wait();
        assert!(!inputs.have_changed());
    }
}
