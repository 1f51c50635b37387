//! `droptower list`: the scenarios of a folder.

use std::path::{Path, PathBuf};

use clap::Args;
use serde::Serialize;

use super::{Failure, Shared, print, print_json};
use crate::diagnostic::{Diagnostic, shown_path};
use crate::scenario::{Document, Value};

#[derive(Debug, Args)]
pub(super) struct ListArgs {
    /// The folder to search
    #[arg(default_value = "scenarios")]
    pub folder: PathBuf,
}

/// A scenario of the folder.
#[derive(Serialize)]
struct Listed {
    name: String,
    path: String,
    /// `None` where the file cannot be read; `droptower check` gives the reason.
    title: Option<String>,
}

pub(super) fn run(args: &ListArgs, shared: &Shared) -> Result<(), Failure> {
    let listed: Vec<Listed> = files(&args.folder)?.iter().filter_map(|file| listed(file)).collect();
    if shared.json {
        return print_json(&listed);
    }
    if listed.is_empty() {
        return Err(Diagnostic::new(format!("no scenarios in {}", shown_path(&args.folder))).into());
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
    let folder = glob::Pattern::escape(&folder.to_string_lossy());
    let paths = glob::glob(&format!("{folder}/**/*.toml"))
        .map_err(|error| Diagnostic::new(format!("cannot search {folder}: {error}")))?;
    Ok(paths.filter_map(Result::ok).collect())
}

/// The file as a scenario; none where it is something else, e.g. a material.
fn listed(path: &Path) -> Option<Listed> {
    let shown = shown_path(path);
    let Ok(document) = Document::read(path) else {
        return Some(Listed { name: shown.clone(), path: shown, title: None });
    };
    document.find("specimen")?;
    let name = document.name();
    let title = match document.find("title").map(|node| &node.value) {
        Some(Value::Text(title)) => title.clone(),
        _ => name.clone(),
    };
    Some(Listed { name, path: shown, title: Some(title) })
}
