//! `droptower list`: the scenarios of a folder; the files below a folder.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use clap::Args;
use serde::Serialize;

use crate::{Failure, Shared, print, print_json, tell};
use base::diagnostic::{Diagnostic, folder_of, shown_path};
use base::file;
use scene::scenario::{Document, Value};
use study::store::{self, run_files};

#[derive(Debug, Args)]
pub(crate) struct ListArgs {
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

pub(crate) fn run(args: &ListArgs, shared: &Shared) -> Result<(), Failure> {
    let (results, files): (Vec<_>, Vec<_>) = files(&args.folder)?.into_iter().partition(|file| is_result(file));
    let listed: Vec<Listed> = files.iter().filter_map(|file| listed(file)).collect();
    if shared.json {
        return print_json(&listed);
    }
    if listed.is_empty() {
        return Err(Diagnostic::new(format!("no scenarios in {}", shown_path(&args.folder))).into());
    }
    if !results.is_empty() && !shared.quiet {
        tell(&format!("note: the scenarios of result folders are left out: {}", results.len()));
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
    let (files, _) = below(folder, |name| name.ends_with(".toml"));
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

/// The files whose names are wanted, in the order of their paths, and the folders that cannot be read.
///
/// Hidden folders hold what other programs keep, and are left out. Links are followed; a folder to which several lead, also
/// from below itself, is searched once.
pub(crate) fn below(folder: &Path, is_wanted: impl Fn(&str) -> bool) -> (Vec<PathBuf>, Vec<Diagnostic>) {
    let mut search = Search { is_wanted, known: BTreeSet::new(), files: vec![], mistakes: vec![] };
    search.folder(folder);
    let Search { mut files, mistakes, .. } = search;
    files.sort_unstable();
    (files, mistakes)
}

struct Search<F> {
    is_wanted: F,
    /// Canonical paths of the folders that were searched.
    known: BTreeSet<PathBuf>,
    files: Vec<PathBuf>,
    mistakes: Vec<Diagnostic>,
}

impl<F: Fn(&str) -> bool> Search<F> {
    fn folder(&mut self, folder: &Path) {
        let found = fs::canonicalize(folder).and_then(|own| match self.known.insert(own) {
            // Sorted, so that of several links to a folder the same one is taken.
            true => file::entries(folder),
            false => Ok(vec![]),
        });
        let found = found.unwrap_or_else(|error| {
            self.mistakes.push(Diagnostic::new(format!("cannot read {}: {error}", shown_path(folder))));
            vec![]
        });
        let is_here = folder == Path::new(".");
        // None that is not UTF-8.
        let names = found.iter().filter_map(|path| path.file_name()?.to_str());
        for name in names.filter(|name| !name.starts_with('.')) {
            let path = if is_here { name.into() } else { folder.join(name) };
            if path.is_dir() {
                self.folder(&path);
            } else if (self.is_wanted)(name) {
                self.files.push(path);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(folder: &Path) -> Vec<String> {
        let (files, mistakes) = below(folder, |name| name.ends_with(".toml"));
        assert!(mistakes.is_empty(), "{mistakes:?}");
        let shown = |file: &PathBuf| file.strip_prefix(folder).expect("below").display().to_string().replace('\\', "/");
        files.iter().map(shown).collect()
    }

    #[test]
    fn hidden_folders_and_other_files_are_left_out() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["b/c", ".git", "a"] {
            fs::create_dir_all(folder.path().join(name)).unwrap();
        }
        for name in ["z.toml", "b/c/one.toml", "a/notes.txt", ".git/two.toml", "a/ä.toml"] {
            fs::write(folder.path().join(name), "").unwrap();
        }
        assert_eq!(found(folder.path()), ["a/ä.toml", "b/c/one.toml", "z.toml"]);
        let (files, mistakes) = below(&folder.path().join("none"), |_| true);
        assert!(files.is_empty() && mistakes[0].message.contains("cannot read"), "{mistakes:?}");
    }

    #[cfg(unix)]
    #[test]
    fn links_that_lead_in_a_circle_end() {
        use std::os::unix::fs::symlink;
        let folder = tempfile::tempdir().unwrap();
        fs::create_dir(folder.path().join("a")).unwrap();
        fs::write(folder.path().join("a/one.toml"), "").unwrap();
        for name in ["a/x", "a/y"] {
            symlink("..", folder.path().join(name)).unwrap();
        }
        symlink("a", folder.path().join("b")).unwrap();
        symlink("nowhere", folder.path().join("c")).unwrap();
        assert_eq!(found(folder.path()), ["a/one.toml"]);
    }
}
