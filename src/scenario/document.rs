//! A scenario file with everything it names: what it extends, its materials, its curves.

use std::fs;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use serde::Deserialize;

use super::assignment::Assignment;
use super::grammar::{self, Rule};
use super::merge::merge;
use super::tree::{self, Node, Table, Value};
use super::{Scenario, curve_file, resolved, validate};
use crate::diagnostic::{Diagnostic, Source, Span, shown_path};

/// Files of the language are written by hand; what is larger is something else.
const LARGEST_FILE: u64 = 16 << 20;

/// Files that extend or name one another, one below the other.
const LONGEST_CHAIN: usize = 32;

/// A scenario as written, merged along `extends`, with the places of all its parts.
#[derive(Clone, Debug)]
pub struct Document {
    root: Node,
    path: PathBuf,
    /// Files that could not be read in place of the paths that name them.
    mistakes: Vec<Diagnostic>,
}

impl Document {
    /// Reads the scenario file at `path` and all files that it names.
    ///
    /// # Errors
    /// The file, or one that it extends, cannot be read or is not TOML.
    pub fn read(path: &Path) -> Result<Document, Vec<Diagnostic>> {
        let mut reader = Reader::default();
        match reader.read(path, Some(grammar::scenario()), None) {
            Some(root) => Ok(Document { root, path: path.to_owned(), mistakes: reader.mistakes }),
            None => Err(reader.mistakes),
        }
    }

    /// The same scenario with changes laid over it.
    pub fn with(&self, assignments: &[Assignment]) -> Document {
        let rule = Some(grammar::scenario());
        let mut reader = Reader::default();
        let mut root = self.root.clone();
        for assignment in assignments {
            let over = reader.include(assignment.tree().clone(), rule);
            root = merge(root, over, rule);
        }
        root.span = self.root.span.clone();
        let mistakes = self.mistakes.iter().cloned();
        Document { root, path: self.path.clone(), mistakes: mistakes.chain(reader.mistakes).collect() }
    }

    /// The scenario as its structs, and everything that is wrong with how it is written. Values that are
    /// only out of range or unknown do not keep it from being read, so that all mistakes show at once.
    pub fn scenario(&self) -> (Option<Scenario>, Vec<Diagnostic>) {
        let mut mistakes = self.mistakes.clone();
        mistakes.extend(validate::validate(&self.root, grammar::scenario()));
        match Scenario::deserialize(self.root.to_toml()) {
            Ok(scenario) => (Some(scenario), mistakes),
            Err(error) if mistakes.is_empty() => {
                let mistake = Diagnostic::new(error.message().to_owned()).at(&self.root.span);
                (None, vec![mistake])
            }
            Err(_) => (None, mistakes),
        }
    }

    /// The whole scenario as one TOML text that runs from any folder: paths absolute, materials and
    /// curves in place.
    pub fn resolved(&self) -> String {
        resolved::text(&self.root, grammar::scenario())
    }

    /// The file that was read.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Path below the last folder called `scenarios`, without extension, e.g. `drop/1008`; the name of the
    /// file where there is no such folder.
    pub fn name(&self) -> String {
        let absolute = std::path::absolute(&self.path).unwrap_or_else(|_| self.path.clone());
        let bare = crate::diagnostic::tidy_path(&absolute).with_extension("");
        let parts: Vec<_> = bare.components().map(|part| part.as_os_str().to_string_lossy().into_owned()).collect();
        let folders = parts.len().saturating_sub(1);
        let start = parts[..folders].iter().rposition(|part| part == "scenarios").map_or(folders, |place| place + 1);
        parts[start..].join("/")
    }

    /// What stands at the key path, e.g. `layers.faces.1`.
    pub fn find(&self, path: &str) -> Option<&Node> {
        self.root.find(path)
    }

    /// Where the value at the key path stands; where it is left out, the key of the table it belongs to.
    pub fn span(&self, path: &str) -> Span {
        match self.root.find(path) {
            Some(node) if !matches!(node.value, Value::Table(_)) => node.span.clone(),
            _ => self.key_span(path),
        }
    }

    /// Where the last key of the path stands; where it is left out, the key before it.
    pub fn key_span(&self, path: &str) -> Span {
        let mut node = &self.root;
        let mut span = &self.root.span;
        for step in path.split('.') {
            match &node.value {
                Value::Table(table) => {
                    let Some(entry) = table.get(step) else { break };
                    (node, span) = (&entry.node, &entry.key_span);
                }
                Value::List(items) => {
                    let place = step.parse::<usize>().ok();
                    let Some(item) = place.and_then(|p| items.get(p)) else {
                        break;
                    };
                    (node, span) = (item, &item.span);
                }
                _ => break,
            }
        }
        span.clone()
    }

    /// The path written at the key path, from the folder of the file in which it is written.
    pub fn file(&self, path: &str) -> Option<PathBuf> {
        let node = self.root.find(path)?;
        match &node.value {
            Value::Text(text) => Some(node.span.source.folder.join(text)),
            _ => None,
        }
    }
}

/// Reads files and what they name, and collects what goes wrong.
#[derive(Default)]
struct Reader {
    mistakes: Vec<Diagnostic>,
    /// The files being read, each named by the one before it.
    chain: Vec<PathBuf>,
}

impl Reader {
    /// The tree of the file at `path`, which stands at `named` in the file that names it.
    fn read(&mut self, path: &Path, rule: Option<&Rule>, named: Option<&Span>) -> Option<Node> {
        let identity = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
        if self.chain.contains(&identity) {
            self.report(self.circle(&identity), named);
            return None;
        }
        if self.chain.len() == LONGEST_CHAIN {
            let message = format!("more than {LONGEST_CHAIN} files that extend one another");
            self.report(Diagnostic::new(message), named);
            return None;
        }
        let source = self.text(path, named)?;
        let mistakes_before = self.mistakes.len();
        self.chain.push(identity);
        let node = match tree::parse(&source) {
            Ok(node) => self.extended(node, rule),
            Err(mistakes) => {
                self.mistakes.extend(mistakes);
                None
            }
        };
        self.chain.pop();
        debug_assert!(node.is_some() || self.mistakes.len() > mistakes_before);
        node
    }

    /// The tree laid over what it extends; none where that cannot be read.
    fn extended(&mut self, mut node: Node, rule: Option<&Rule>) -> Option<Node> {
        let extends = match &mut node.value {
            Value::Table(table) => take_path(table, rule),
            _ => None,
        };
        let over = self.include_within(node, rule);
        let Some((path, span)) = extends else {
            return Some(over);
        };
        let base = self.read(&path, rule, Some(&span))?;
        Some(merge(base, over, rule))
    }

    /// The tree with files in place of the paths that name them.
    fn include(&mut self, node: Node, rule: Option<&Rule>) -> Node {
        let Value::Text(text) = &node.value else {
            let kept = node.clone();
            return self.extended(node, rule).unwrap_or(kept);
        };
        let Some(rule) = rule.filter(|rule| rule.is_included()) else {
            return node;
        };
        let path = node.span.source.folder.join(text);
        let found = match rule.table() {
            Some(_) => self.read(&path, Some(rule), Some(&node.span)),
            None => self.curve(&path, &node.span),
        };
        match found {
            Some(found) => Node { included: true, ..found },
            None => node,
        }
    }

    fn include_within(&mut self, node: Node, rule: Option<&Rule>) -> Node {
        let value = match node.value {
            Value::Table(mut table) => {
                let keys = rule.and_then(Rule::table);
                for entry in &mut table.entries {
                    let rule = keys.and_then(|k| k.key(&entry.key)).map(|key| &key.rule);
                    entry.node = self.include(entry.node.clone(), rule);
                }
                Value::Table(table)
            }
            Value::List(items) => {
                let items = items.into_iter().enumerate();
                let items = items.map(|(place, item)| self.include(item, rule.and_then(|rule| rule.item(place))));
                Value::List(items.collect())
            }
            other => other,
        };
        Node { value, ..node }
    }

    fn curve(&mut self, path: &Path, named: &Span) -> Option<Node> {
        let source = self.text(path, Some(named))?;
        match curve_file::read(&source) {
            Ok(node) => Some(node),
            Err(mistakes) => {
                self.mistakes.extend(mistakes);
                None
            }
        }
    }

    fn text(&mut self, path: &Path, named: Option<&Span>) -> Option<Arc<Source>> {
        match read_text(path) {
            Ok(text) => Some(Source::file(path, text)),
            Err(why) => {
                let message = format!("cannot read {}: {why}", shown_path(path));
                self.report(Diagnostic::new(message), named);
                None
            }
        }
    }

    fn circle(&self, again: &Path) -> Diagnostic {
        let start = self.chain.iter().position(|file| file == again);
        let files = self.chain[start.unwrap_or(0)..].iter();
        let names: Vec<String> = files.map(PathBuf::as_path).chain([again]).map(shown_path).collect();
        Diagnostic::new(format!("files extend in a circle: {}", names.join(" → ")))
    }

    fn report(&mut self, mistake: Diagnostic, named: Option<&Span>) {
        self.mistakes.push(match named {
            Some(span) => mistake.at(span),
            None => mistake,
        });
    }
}

/// Takes `extends` out of a table that may have it.
fn take_path(table: &mut Table, rule: Option<&Rule>) -> Option<(PathBuf, Span)> {
    rule?.table()?.key("extends")?;
    let Value::Text(text) = &table.get("extends")?.node.value else {
        return None;
    };
    let text = text.clone();
    let entry = table.remove("extends")?;
    let folder = &entry.node.span.source.folder;
    Some((folder.join(text), entry.node.span))
}

fn read_text(path: &Path) -> Result<String, String> {
    let file = fs::File::open(path).map_err(|error| reason(&error))?;
    let kind = file.metadata().map_err(|error| reason(&error))?;
    if !kind.is_file() {
        return Err("it is not a file".to_owned());
    }
    let mut bytes = Vec::new();
    file.take(LARGEST_FILE + 1).read_to_end(&mut bytes).map_err(|error| reason(&error))?;
    if bytes.len() as u64 > LARGEST_FILE {
        return Err(format!("it is larger than {} MB", LARGEST_FILE >> 20));
    }
    String::from_utf8(bytes).map_err(|_| "it is not UTF-8 text".to_owned())
}

fn reason(error: &std::io::Error) -> String {
    match error.kind() {
        std::io::ErrorKind::NotFound => "there is no such file".to_owned(),
        std::io::ErrorKind::PermissionDenied => "permission denied".to_owned(),
        _ => error.to_string(),
    }
}
