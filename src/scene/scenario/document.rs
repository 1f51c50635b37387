//! A scenario or material file with the files that it names: the one it extends, materials, curves.

use std::path::{Path, PathBuf};

use serde::de::DeserializeOwned;

use super::assignment::{Assignment, Change};
use super::grammar::{self, Rule};
use super::merge::merge;
use super::reader::Reader;
use super::tree::{Entry, Node, Value};
use super::variation::{self, VariedKey};
use super::{Expectations, Implausible, Material, Scenario, plausible, resolved, validate};
use base::diagnostic::{Diagnostic, Span, tidy_path};

/// The table of what varies.
const VARIATION: &str = "variation";

/// A scenario or a material as written, merged along `extends`, with the source of each part.
#[derive(Clone, Debug)]
pub struct Document {
    root: Node,
    path: PathBuf,
    rule: &'static Rule,
    /// The files it was read from.
    files: Vec<PathBuf>,
    /// Files that could not be read in place of the paths that name them.
    mistakes: Vec<Diagnostic>,
}

impl Document {
    /// Reads the scenario file at `path` and all files that it names.
    ///
    /// # Errors
    /// The file, or one that it extends, cannot be read or is not TOML.
    pub fn read(path: &Path) -> Result<Document, Vec<Diagnostic>> {
        Document::read_by(path, grammar::scenario())
    }

    /// Reads the material file at `path` and all files that it names.
    ///
    /// # Errors
    /// The file, or one that it extends, cannot be read or is not TOML.
    pub fn read_material(path: &Path) -> Result<Document, Vec<Diagnostic>> {
        Document::read_by(path, grammar::material())
    }

    /// Reads the file about what a run must give at `path`.
    ///
    /// # Errors
    /// The file, or one that it extends, cannot be read or is not TOML.
    pub fn read_expectations(path: &Path) -> Result<Document, Vec<Diagnostic>> {
        Document::read_by(path, grammar::expectations())
    }

    /// Bytes that it takes in memory, about.
    pub fn size(&self) -> usize {
        self.root.size()
    }

    /// The files that reading the scenario at `path` looks at, even where it cannot be read.
    pub fn sources(path: &Path) -> Vec<PathBuf> {
        let mut reader = Reader::default();
        reader.read(path, Some(grammar::scenario()), None);
        reader.files.into_iter().chain(reader.unreadable).collect()
    }

    fn read_by(path: &Path, rule: &'static Rule) -> Result<Document, Vec<Diagnostic>> {
        let mut reader = Reader::default();
        match reader.read(path, Some(rule), None) {
            Some(root) => {
                let Reader { files, mistakes, .. } = reader;
                Ok(Document { root, path: path.to_owned(), rule, files, mistakes })
            }
            None => Err(reader.mistakes),
        }
    }

    /// Whether what was read as a scenario has the keys of a material and no specimen.
    pub fn is_material(&self) -> bool {
        let has = |key: &str| self.find(key).is_some();
        let of_a_material = ["density", "thickness", "fabric", "elastic", "hyperelastic", "plastic"];
        !has("specimen") && of_a_material.into_iter().any(has)
    }

    /// A copy of the scenario without the keys that `assignments` leave out, and with the others merged into it. Two
    /// that exclude each other are a mistake, as in a file.
    pub fn with(&self, assignments: &[Assignment]) -> Document {
        let rule = Some(self.rule);
        let mut reader = Reader::default();
        let mut root = self.root.clone();
        let mut set: Option<Node> = None;
        for assignment in assignments {
            match assignment.change() {
                Change::Unset(unset) => reader.mistakes.extend(unset.apply(&mut root).err()),
                Change::Set(tree) if into_list(&root, tree, "").is_some() => {
                    reader.mistakes.extend(into_list(&root, tree, ""));
                }
                Change::Set(tree) => {
                    let over = reader.include(tree.clone(), rule);
                    set = Some(match set {
                        // Without the rule: of two assignments that exclude each other, the later would else drop the
                        // earlier unnoticed.
                        Some(before) => merge(before, over, None),
                        None => over,
                    });
                }
            }
        }
        if let Some(set) = set {
            root = merge(root, set, rule);
        }
        // Missing keys are shown in the file, not in the last argument.
        root.span = self.root.span.clone();
        let mistakes = self.mistakes.iter().cloned().chain(reader.mistakes).collect();
        let files = self.files.iter().cloned().chain(reader.files).collect();
        Document { root, path: self.path.clone(), rule: self.rule, files, mistakes }
    }

    /// The scenario as its structs, and the mistakes in how it is written. It is read although values are out of range
    /// or keys unknown, so that all mistakes are reported at once.
    pub fn scenario(&self) -> (Option<Scenario>, Vec<Diagnostic>) {
        self.written()
    }

    /// The material as its struct, likewise; only of what was read as a material.
    pub fn material(&self) -> (Option<Material>, Vec<Diagnostic>) {
        self.written()
    }

    /// The expectations of a run as their struct, likewise; only of a document that was read as such.
    pub fn expectations(&self) -> (Option<Expectations>, Vec<Diagnostic>) {
        self.written()
    }

    fn written<T: DeserializeOwned>(&self) -> (Option<T>, Vec<Diagnostic>) {
        let mut mistakes = self.mistakes.clone();
        mistakes.extend(validate::validate(&self.root, self.rule));
        match T::deserialize(self.root.to_toml()) {
            Ok(written) => (Some(written), mistakes),
            // An error of serde is mostly a mistake that was reported already, and that with its place.
            Err(error) if mistakes.is_empty() => {
                let mistake = Diagnostic::new(error.message().to_owned()).at(&self.root.span);
                (None, vec![mistake])
            }
            Err(_) => (None, mistakes),
        }
    }

    /// Values that are implausible, although a run could use them.
    pub fn implausible(&self) -> Vec<Implausible> {
        plausible::implausible(&self.root, self.rule)
    }

    /// The whole scenario as one TOML text that runs from any folder: paths absolute, materials and
    /// curves in place.
    pub fn resolved(&self) -> String {
        resolved::text(&self.root, self.rule)
    }

    /// The material of the specimen as the text of a material file, paths absolute and curves in place; none where only faces
    /// have one.
    pub fn material_text(&self) -> Option<String> {
        let node = self.find("specimen.material")?;
        matches!(node.value, Value::Table(_)).then(|| resolved::text(node, grammar::material()))
    }

    /// The text of the scenario with the post script read from a copy called `name` beside it.
    pub fn resolved_beside_script(&self, name: &str) -> String {
        resolved::text_with(&self.root, self.rule, &[("post.script", name)])
    }

    /// Every file that it was read from: its own, what it extends, materials and curves. Meshes and recordings are only
    /// named.
    pub fn files(&self) -> &[PathBuf] {
        &self.files
    }

    /// Every file that its keys name and whose content does not stand in the place of the key: meshes, outlines, recordings,
    /// scripts.
    pub fn named(&self) -> Vec<PathBuf> {
        resolved::paths(&self.root, self.rule)
    }

    /// The file that was read.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Path below the last folder called `scenarios`, without extension, e.g. `drop/1008`; the name of the
    /// file where there is no such folder. That of a run folder, `runs/drop/1008/scenario.toml`, has the name of the
    /// folder.
    pub fn name(&self) -> String {
        let absolute = std::path::absolute(&self.path).unwrap_or_else(|_| self.path.clone());
        let bare = tidy_path(&absolute).with_extension("");
        let parts: Vec<_> = bare.components().map(|part| part.as_os_str().to_string_lossy().into_owned()).collect();
        let folders = parts.len().saturating_sub(1);
        let runs = parts[..folders].iter().rposition(|part| part == "runs");
        if let (Some(place), Some("scenario")) = (runs, parts.last().map(String::as_str))
            && place + 1 < folders
        {
            return parts[place + 1..folders].join("/");
        }
        let start = parts[..folders].iter().rposition(|part| part == "scenarios").map_or(folders, |place| place + 1);
        parts[start..].join("/")
    }

    /// The keys that vary from run to run of a sweep, as written.
    pub fn varied_keys(&self) -> Vec<VariedKey> {
        let rule = self.rule.under(VARIATION).and_then(Rule::table);
        match (self.root.find(VARIATION).map(|node| &node.value), rule) {
            (Some(Value::Table(table)), Some(rule)) => variation::varied_keys(table, rule),
            _ => vec![],
        }
    }

    /// A copy of the scenario in which nothing varies.
    pub fn without_variation(&self) -> Document {
        let mut document = self.clone();
        if let Value::Table(table) = &mut document.root.value {
            table.remove(VARIATION);
        }
        document
    }

    /// The node at the key path, e.g. `layers.faces.1`.
    pub fn find(&self, path: &str) -> Option<&Node> {
        self.root.find(path)
    }

    /// Place of the value at the key path; where it is left out, of the key of its table.
    pub fn span(&self, path: &str) -> Span {
        match self.root.find(path) {
            Some(node) if !matches!(node.value, Value::Table(_)) => node.span.clone(),
            _ => self.key_span(path),
        }
    }

    /// Place of the last key of the path; where it is left out, of the key before it.
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

    /// Place of the value under these keys, of which each may have dots in its name; where it is left out, of the last
    /// that is there.
    pub fn span_of(&self, keys: &[&str]) -> Span {
        let mut span = self.root.span.clone();
        let mut node = &self.root;
        for key in keys {
            let Value::Table(table) = &node.value else { break };
            let Some(entry) = table.get(key) else { break };
            node = &entry.node;
            span = if matches!(node.value, Value::Table(_)) { entry.key_span.clone() } else { node.span.clone() };
        }
        span
    }

    /// The path written under these keys, from the folder of the file in which it is written.
    pub fn file_of(&self, keys: &[&str]) -> Option<PathBuf> {
        let mut node = &self.root;
        for key in keys {
            let Value::Table(table) = &node.value else { return None };
            node = &table.get(key)?.node;
        }
        match &node.value {
            Value::Text(text) => Some(node.span.source.folder.join(text)),
            _ => None,
        }
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

/// The mistake of an assignment to a key of a list of tables without the number of one, or to one by its number where there
/// is a single table. `path` is that of the nodes.
fn into_list(base: &Node, over: &Node, path: &str) -> Option<Diagnostic> {
    let Value::Table(over) = &over.value else { return None };
    let [Entry { key, key_span, node }] = over.entries.as_slice() else { return None };
    let is_number = key.parse::<usize>().is_ok();
    let below = if path.is_empty() { key.clone() } else { format!("{path}.{key}") };
    match &base.value {
        Value::List(items) if !is_number && items.iter().all(|item| matches!(item.value, Value::Table(_))) => {
            let mistake = Diagnostic::new(format!("`{path}` is a list of tables")).at(key_span);
            Some(mistake.hint(format!("number the one that is meant: `{path}.0.{key}`")))
        }
        Value::Table(_) if is_number => {
            let mistake = Diagnostic::new(format!("`{path}` is one table")).at(key_span);
            Some(mistake.hint("leave the number out"))
        }
        Value::Table(base) => into_list(&base.get(key)?.node, node, &below),
        Value::List(items) => into_list(items.get(key.parse::<usize>().ok()?)?, node, &below),
        _ => None,
    }
}
