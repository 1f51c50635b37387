//! The lines of earlier sessions.

use std::fs;
use std::path::{Path, PathBuf};

use rustyline::history::FileHistory;
use rustyline::{Editor, Helper};

/// Most lines that are kept.
pub(super) const MOST_LINES: usize = 1000;

/// The file of earlier lines, which sessions share; none where the user has no folder for such data.
pub(super) struct History(Option<PathBuf>);

impl History {
    /// Gives the lines so far to `editor`.
    pub fn open<H: Helper>(editor: &mut Editor<H, FileHistory>) -> History {
        let path = dirs::data_dir().map(|folder| folder.join(Path::new("droptower").join("repl-history")));
        if let Some(path) = &path {
            // The first session has neither.
            let _ = path.parent().map(fs::create_dir_all);
            let _ = editor.load_history(path);
        }
        History(path)
    }

    /// Keeps the line that was typed last.
    pub fn keep<H: Helper>(&self, editor: &mut Editor<H, FileHistory>) {
        if let Some(path) = &self.0 {
            // What cannot be written is only lost from the list of earlier lines.
            let _ = editor.append_history(path);
        }
    }
}
