//! `droptower list`: the scenarios of a folder.

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use clap::Args;
use serde::Serialize;

use super::{Failure, Shared, print, print_json, progress, search};
use base::diagnostic::{Diagnostic, folder_of, shown_path};
use scene::scenario::{Document, Value};
use study::store::{self, run_files};

#[derive(Debug, Args)]
pub(super) struct ListArgs {
    /// The folder to search; result folders in it are left out
    #[arg(default_value = ".")]
    pub folder: PathBuf,
}

/// A scenario of the folder.
#[derive(Serialize)]
struct Listed {
    name: String,
    path: String,
    /// `None` where the file is meant as a scenario and has mistakes in its TOML; `droptower check` gives the reason.
    title: Option<String>,
}

pub(super) fn run(args: &ListArgs, shared: &Shared) -> Result<(), Failure> {
    let (results, files): (Vec<_>, Vec<_>) = files(&args.folder)?.into_iter().partition(|file| is_result(file));
    let listed: Vec<Listed> = files.iter().filter_map(|file| listed(file)).collect();
    if shared.json {
        return print_json(&listed);
    }
    if listed.is_empty() {
        return Err(Diagnostic::new(format!("no scenarios in {}", shown_path(&args.folder))).into());
    }
    if !results.is_empty() && !shared.quiet {
        progress::end_of_work();
        // With standard error closed, there is nowhere to print.
        let _ = writeln!(io::stderr(), "note: the scenarios of result folders are left out: {}", results.len());
    }
    let width = listed.iter().map(|scenario| scenario.path.chars().count()).max().unwrap_or(0);
    let lines: Vec<String> = listed
        .iter()
        .map(|scenario| {
            let title = scenario.title.as_deref().unwrap_or("(not readable; see droptower check)");
            format!("{:width$}  {title}", scenario.path)
        })
        .collect();
    print(&lines.join("\n"))
}

fn files(folder: &Path) -> Result<Vec<PathBuf>, Diagnostic> {
    if !folder.is_dir() {
        return Err(Diagnostic::new(format!("{} is not a folder", shown_path(folder))));
    }
    // Folders that others own are no reason to list nothing.
    let (files, _) = search::below(folder, |name| name.ends_with(".toml"));
    Ok(files)
}

/// Whether the file is the resolved scenario of a stored run.
fn is_result(path: &Path) -> bool {
    path.file_name().is_some_and(|name| name == run_files::SCENARIO) && store::is_run(folder_of(path))
}

/// The file as a scenario; none where it is something else, e.g. a material or the settings of another program.
fn listed(path: &Path) -> Option<Listed> {
    let shown = shown_path(path);
    let Ok(document) = Document::read(path) else {
        let text = fs::read_to_string(path).ok()?;
        let is_meant = ["specimen", "extends"].iter().any(|key| text.contains(key));
        return is_meant.then(|| Listed { name: shown.clone(), path: shown, title: None });
    };
    document.find("specimen")?;
    let name = document.name();
    let title = match document.find("title").map(|node| &node.value) {
        Some(Value::Text(title)) => title.clone(),
        _ => name.clone(),
    };
    Some(Listed { name, path: shown, title: Some(title) })
}
