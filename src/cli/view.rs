//! `droptower view`: opens recordings in the installed Rerun viewer.

use std::ffi::OsString;
use std::io;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use clap::Args;

use crate::failure::all;
use crate::{Failure, Shared, tell};
use base::diagnostic::{Diagnostic, shown_path};
use study::store::run_files;

#[derive(Debug, Args)]
pub(super) struct ViewArgs {
    /// Folders of runs, or recordings
    #[arg(required = true, value_name = "RUN")]
    pub runs: Vec<PathBuf>,
    /// The viewer's program [default: $DROPTOWER_VIEWER, else `rerun` on the PATH or beside droptower]
    #[arg(long, value_name = "PROGRAM")]
    pub viewer: Option<OsString>,
}

/// Version of the viewer that recordings are written for.
const VERSION: &str = "0.36";

/// How to install the viewer.
const INSTALL: &str = "`pip install \"droptower[viewer]\"`, `pip install rerun-sdk==0.36.3` or `cargo install rerun-cli --version 0.36.3 --locked` installs it; \
     --viewer or $DROPTOWER_VIEWER names one that is not on the PATH";

/// Opens the recordings and waits until the viewer is closed.
pub(super) fn run(args: &ViewArgs, shared: &Shared) -> Result<(), Failure> {
    let recordings = all(args.runs.iter().map(|run| recording(run)))?;
    open(&program(args), &recordings, shared.quiet)
}

/// The recording of a run.
fn recording(run: &Path) -> Result<PathBuf, Diagnostic> {
    if !run.exists() {
        let mistake = Diagnostic::new(format!("there is no {}", shown_path(run)));
        return Err(mistake.hint("name the folder of a run, such as runs/drop/1008"));
    }
    let recording = if run.is_file() { run.to_owned() } else { run.join(run_files::RECORDING) };
    if recording.is_file() {
        return absolute(&recording);
    }
    let mistake = Diagnostic::new(format!("{} holds no recording.rrd", shown_path(run)));
    let page = run.join(run_files::REPORT);
    if page.is_file() && !run.join(run_files::SIGNALS).exists() {
        return Err(mistake.hint(format!("only runs have one; the page is {}", shown_path(&page))));
    }
    Err(mistake.hint("runs that failed too early have none, nor do those of a build without the feature `rerun`"))
}

/// The absolute path, which no viewer reads as an option.
fn absolute(recording: &Path) -> Result<PathBuf, Diagnostic> {
    std::path::absolute(recording)
        .map_err(|error| Diagnostic::new(format!("cannot open {}: {error}", shown_path(recording))))
}

fn program(args: &ViewArgs) -> OsString {
    let named = args.viewer.clone().or_else(|| std::env::var_os("DROPTOWER_VIEWER").filter(|name| !name.is_empty()));
    named.or_else(beside).unwrap_or_else(|| "rerun".into())
}

/// The viewer that is installed in the folder of this program, where none is on the path: there a Python environment has
/// both.
fn beside() -> Option<OsString> {
    let name = format!("rerun{}", std::env::consts::EXE_SUFFIX);
    let path = std::env::var_os("PATH").unwrap_or_default();
    if std::env::split_paths(&path).any(|folder| folder.join(&name).is_file()) {
        return None;
    }
    let viewer = std::env::current_exe().ok()?.with_file_name(name);
    viewer.is_file().then(|| viewer.into_os_string())
}

fn open(program: &OsString, recordings: &[PathBuf], quiet: bool) -> Result<(), Failure> {
    let version = version(program)?;
    if !quiet && !is_supported(&version) {
        tell(&format!("warning: recordings are written for the Rerun viewer {VERSION}, this is {version}"));
    }
    let status = Command::new(program).args(recordings).status().map_err(|error| not_started(program, &error))?;
    if status.success() {
        return Ok(());
    }
    let name = shown_path(Path::new(program));
    Err(Failure::output(Diagnostic::new(format!("the Rerun viewer `{name}` failed: {status}"))))
}

/// The version that the viewer prints.
fn version(program: &OsString) -> Result<String, Diagnostic> {
    let output = Command::new(program).arg("--version").stdin(Stdio::null()).output();
    let output = output.map_err(|error| not_started(program, &error))?;
    Ok(String::from_utf8_lossy(&output.stdout).lines().next().unwrap_or("a program without a version").to_owned())
}

fn not_started(program: &OsString, error: &io::Error) -> Diagnostic {
    let name = shown_path(Path::new(program));
    let message = match error.kind() {
        io::ErrorKind::NotFound => format!("the Rerun viewer `{name}` is not installed"),
        _ => format!("the Rerun viewer `{name}` cannot be started: {error}"),
    };
    Diagnostic::new(message).hint(INSTALL)
}

/// Whether recordings are written for a viewer of this version.
fn is_supported(version: &str) -> bool {
    version
        .split_whitespace()
        .any(|word| word.strip_prefix(VERSION).is_some_and(|rest| rest.is_empty() || rest.starts_with('.')))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_viewer_of_another_minor_version_is_not_supported() {
        assert!(is_supported("rerun-cli 0.36.3 [rustc 1.92.0] x86_64-unknown-linux-gnu release-0.36.3 d2f3"));
        assert!(!is_supported("rerun-cli 0.37.0 (built with 0.366)"));
        assert!(!is_supported("GNU bash, version 5.2"));
    }
}
