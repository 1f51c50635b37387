//! The checker of a document: it collects the mistakes, each at the place of a key path.

use std::collections::BTreeSet;
use std::path::PathBuf;

use crate::scenario::{Document, MeshFile};
use base::diagnostic::{Diagnostic, Diagnostics, shown_path};

/// The mistakes found so far, and the document that says where they are.
pub struct Checker<'d> {
    pub document: &'d Document,
    pub found: Diagnostics,
}

impl<'d> Checker<'d> {
    pub fn new(document: &'d Document, mistakes: Vec<Diagnostic>) -> Checker<'d> {
        Checker { document, found: Diagnostics(mistakes) }
    }

    /// A mistake in the value at the key path.
    pub fn report(&mut self, path: &str, message: impl Into<String>) {
        self.found.report(&self.document.span(path), message);
    }

    /// A mistake in the value at the key path, and what to write instead.
    pub fn report_with(&mut self, path: &str, message: impl Into<String>, hint: impl Into<String>) {
        self.found.report_with(&self.document.span(path), message, hint);
    }

    /// A mistake in the value at the key path, and what to write instead, where that is known.
    pub fn report_with_hint_if(&mut self, path: &str, message: impl Into<String>, hint: Option<String>) {
        self.found.0.push(Diagnostic::new(message).at(&self.document.span(path)).hint_if(hint));
    }

    /// A mistake as [`report_with`](Self::report_with) has it, in place of a value.
    pub fn refuse<T>(&mut self, path: &str, message: impl Into<String>, hint: impl Into<String>) -> Option<T> {
        self.report_with(path, message, hint);
        None
    }

    /// Lets the last mistake also point at the key path, where it is written.
    pub fn label(&mut self, path: &str, text: impl Into<String>) {
        if !self.is_written(path) {
            return;
        }
        let span = self.document.span(path);
        if let Some(mistake) = self.found.0.pop() {
            self.found.0.push(mistake.label(&span, text));
        }
    }

    /// The value at the key path, whose number is implausible, in the unit that is, as a hint; none where it is
    /// likely.
    pub fn meant(&self, path: &str) -> Option<String> {
        let found = self.document.implausible().into_iter().find(|value| value.key == path)?;
        found.meant.map(|meant| format!("did you mean \"{meant}\"?"))
    }

    /// A key that is missing at the key path.
    pub fn missing(&mut self, path: &str, hint: impl Into<String>) {
        self.report_with(path, format!("missing key `{path}`"), hint);
    }

    /// A key that is not allowed beside another.
    pub fn out_of_place(&mut self, path: &str, why: impl Into<String>) {
        self.found.report_with(&self.document.key_span(path), format!("`{path}` is not allowed here"), why);
    }

    /// Whether the document has the key.
    pub fn is_written(&self, path: &str) -> bool {
        self.document.find(path).is_some()
    }

    /// Whether the value at the key path is written in another file than the one that is checked.
    pub fn is_inherited(&self, path: &str) -> bool {
        let source = &self.document.span(path).source.name;
        let mut others = self.document.files().iter().filter(|file| *file != self.document.path());
        others.any(|file| shown_path(file) == *source)
    }

    /// The existing file named at the key path.
    pub fn file(&mut self, path: &str) -> Option<PathBuf> {
        let file = self.document.file(path)?;
        if file.is_file() {
            return Some(file);
        }
        let shown = shown_path(&file);
        self.report(path, format!("cannot read {shown}: there is no such file"));
        None
    }

    /// The existing file with a mesh that is written at the key path, and the length of one unit of its coordinates, m.
    pub fn mesh(&mut self, path: &str, written: &MeshFile) -> Option<(PathBuf, f64)> {
        match written {
            MeshFile::Path(_) => Some((self.file(path)?, 1.0)),
            MeshFile::Table(table) => Some((self.file(&format!("{path}.file"))?, table.unit.metres() * table.scale)),
        }
    }

    /// All mistakes in the order of the text, without repetitions.
    pub fn into_mistakes(self) -> Vec<Diagnostic> {
        let mut mistakes = self.found.0;
        let place =
            |mistake: &Diagnostic| mistake.span.as_ref().map(|span| (span.source.name.clone(), span.range.start));
        mistakes.sort_by_cached_key(place);
        // Faces with one material repeat all of its mistakes, in turn.
        let mut known = BTreeSet::new();
        mistakes.retain(|mistake| known.insert((place(mistake), mistake.message.clone())));
        mistakes
    }
}
