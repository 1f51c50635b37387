//! The texts of a session below each other, so that every line of it has one number.

use std::path::{Path, PathBuf};

use crate::script::Fault;
use crate::script::module::{Import, SourceText};

/// Name of the inputs in messages.
pub(super) const INPUT: &str = "<input>";

const BEGINS: &str = "import ";

/// Most lines of a session: positions of the interpreter end here.
pub(super) const MOST_LINES: usize = u16::MAX as usize;

/// The inputs that ran so far.
#[derive(Clone, Debug, Default)]
pub(super) struct Transcript {
    text: String,
    lines: usize,
    files: Vec<Loaded>,
    /// Each import once, at its place.
    imports: Vec<Import>,
}

/// A file among the inputs.
#[derive(Clone, Debug)]
struct Loaded {
    source: SourceText,
    /// Lines before it, and those of it.
    before: usize,
    lines: usize,
}

impl Transcript {
    /// The lines so far.
    pub fn lines(&self) -> usize {
        self.lines
    }

    /// With a further input, which is in `file` where it was not typed.
    pub fn followed_by(&self, input: &str, file: Option<&SourceText>) -> Transcript {
        let mut longer = self.clone();
        let text = as_statement(input);
        let lines = text.lines().count();
        longer.files.extend(file.map(|source| Loaded { source: source.clone(), before: self.lines, lines }));
        longer.lines += lines;
        longer.text += &text;
        longer
    }

    /// Keeps those that it does not have.
    pub fn add_imports(&mut self, imports: &[Import]) {
        for import in imports {
            if !self.imports.iter().any(|other| (&other.name, &other.alias) == (&import.name, &import.alias)) {
                self.imports.push(import.clone());
            }
        }
    }

    /// The whole text and a further input, as it was typed, under the name of inputs.
    pub fn source(&self, input: &str) -> SourceText {
        SourceText::new(Path::new(INPUT), &format!("{}{input}", self.text))
    }

    /// As many lines, empty but for the imports at their places.
    pub fn imports_alone(&self) -> String {
        let mut lines = vec![String::new(); self.lines];
        for Import { name, alias, position } in &self.imports {
            let Some(line) = position.line().and_then(|line| lines.get_mut(line - 1)) else { continue };
            let begin = position.position().unwrap_or(1).saturating_sub(1 + BEGINS.len());
            *line = format!("{line:begin$}{BEGINS}{name:?} as {alias};");
        }
        lines.iter().map(|line| format!("{line}\n")).collect()
    }

    /// A fault in a file that was loaded, at its line there.
    pub fn in_its_file(&self, fault: Fault) -> Fault {
        let holds = |file: &&Loaded| file.before < fault.line && fault.line <= file.before + file.lines;
        match self.files.iter().find(holds).filter(|_| fault.file == Path::new(INPUT)) {
            Some(file) => {
                let SourceText { file: path, text } = file.source.clone();
                Fault { file: path, text, line: fault.line - file.before, ..fault }
            }
            None => fault,
        }
    }
}

/// The folder of a file, in which its modules are.
pub(super) fn folder_of(file: Option<&SourceText>) -> PathBuf {
    file.and_then(|file| file.file.parent()).unwrap_or(Path::new("")).into()
}

/// The lines of an input, which others may follow: its last value needs a semicolon then.
pub(super) fn as_statement(input: &str) -> String {
    let input = input.trim_end();
    match input.lines().last() {
        _ if input.ends_with(';') => format!("{input}\n"),
        Some(last) if last.contains("//") => format!("{input}\n;\n"),
        _ => format!("{input};\n"),
    }
}
