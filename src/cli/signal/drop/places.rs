//! The recordings that the arguments name.

use std::collections::HashSet;
use std::fs;
use std::path::{Path, PathBuf};

use super::args::DropArgs;
use crate::scenarios::expanded;
use base::diagnostic::{Diagnostic, shown_path};
use lab::signal::folder::{self, FolderContents};

/// The recordings of a call.
pub(super) struct Recordings {
    /// Each once, in the order of the arguments; whether a folder was searched for it.
    pub paths: Vec<(PathBuf, bool)>,
    /// Whether they are a list: several arguments, a glob or a folder of recordings.
    pub is_list: bool,
    /// What else is in the folders.
    pub left_out: Vec<String>,
}

impl Recordings {
    /// The recordings that files, globs and folders name, without the table that is written.
    pub(super) fn from_args(args: &DropArgs) -> Result<Recordings, Vec<Diagnostic>> {
        let mut found = Recordings { paths: vec![], is_list: args.recordings.len() > 1, left_out: vec![] };
        let mistakes: Vec<Diagnostic> =
            args.recordings.iter().filter_map(|argument| found.add(argument, args.out.as_deref()).err()).collect();
        let mut seen = HashSet::new();
        found.paths.retain(|(path, _)| seen.insert(fs::canonicalize(path).unwrap_or_else(|_| path.clone())));
        if mistakes.is_empty() { Ok(found) } else { Err(mistakes) }
    }

    fn add(&mut self, argument: &Path, out: Option<&Path>) -> Result<(), Diagnostic> {
        if argument.is_dir() {
            return self.add_folder(argument, out);
        }
        let paths = match argument.to_str() {
            Some(pattern) => expanded(pattern)?,
            None => vec![argument.to_owned()],
        };
        self.is_list |= paths != [argument.to_owned()];
        self.paths.extend(paths.into_iter().map(|path| (path, false)));
        Ok(())
    }

    fn add_folder(&mut self, place: &Path, out: Option<&Path>) -> Result<(), Diagnostic> {
        let contents = folder::contents(place);
        let FolderContents { recordings, others } =
            contents.map_err(|error| Diagnostic::new(format!("cannot list {}: {error}", shown_path(place))))?;
        if recordings == [place.to_owned()] {
            self.paths.push((place.to_owned(), false));
            return Ok(());
        }
        let out = out.and_then(|out| fs::canonicalize(out).ok());
        let is_own = |path: &PathBuf| out.is_some() && fs::canonicalize(path).ok() == out;
        let (own, recordings): (Vec<PathBuf>, Vec<PathBuf>) = recordings.into_iter().partition(is_own);
        if recordings.is_empty() {
            let message = format!("{} holds no recordings", shown_path(place));
            return Err(Diagnostic::new(message).hint("they are known by their endings: `droptower explain formats`"));
        }
        self.is_list = true;
        self.left_out.extend(others.iter().chain(&own).map(|path| shown_path(path)));
        self.paths.extend(recordings.into_iter().map(|path| (path, true)));
        Ok(())
    }
}
