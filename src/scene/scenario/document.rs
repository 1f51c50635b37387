//! A scenario or material file with the files that it names: the one it extends, materials, curves.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use serde::de::DeserializeOwned;

use super::grammar::{self, Range, Rule};
use super::tree::{self, Assignment, Change, Entry, Node, Table, Unset, Value, merge};
use super::variation::{self, VariedKey};
use super::{Expectations, Implausible, Material, Scenario, curve_file, resolved, validate};
use base::diagnostic::{Diagnostic, Source, Span, shown_path, tidy_path};
use base::file::{self, FileError};
use base::units::{Dimension, percentage};
use lab::signal;

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
        let mut files = self.files.clone();
        let mut given = self.mistakes.clone();
        for assignment in assignments {
            if let Change::Set(tree) = assignment.change()
                && let Some((unread, text)) = replaced_file(&root, tree)
            {
                // A file that is replaced by another need not be there.
                let path = unread.span.source.folder.join(text);
                given.retain(|mistake| {
                    !mistake
                        .span
                        .as_ref()
                        .is_some_and(|span| span.is(&unread.span) || span.source.name == shown_path(&path))
                });
                files.retain(|file| *file != path);
            }
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
        let mistakes = given.into_iter().chain(reader.mistakes).collect();
        files.extend(reader.files);
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
        validate::implausible(&self.root, self.rule)
    }

    /// The quantity at the key path, where it is outside of a range that is narrower than that of its key.
    pub fn implausible_at(&self, path: &str, dimension: Dimension, likely: [f64; 2]) -> Option<Implausible> {
        validate::single(
            self.find(path)?,
            &Rule::Quantity(dimension, Range { from: None, to: None, likely: Some(likely) }),
            path,
        )
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

    /// Path of a key of the impactor at this place: of a list of them, or of the only one.
    pub fn impactor_key(&self, place: usize, key: &str) -> String {
        if self.find("impactor.0").is_some() { format!("impactor.{place}.{key}") } else { format!("impactor.{key}") }
    }

    /// Path of a key of the face at this place: its own where it is written, else that of the specimen.
    pub fn face_key(&self, place: usize, key: &str) -> String {
        let own = format!("layer.{place}.{key}");
        if self.find(&own).is_some() { own } else { format!("specimen.{key}") }
    }

    /// Place of the value at the key path; where it is left out, of the last key of the path that is there.
    pub fn span(&self, path: &str) -> Span {
        self.span_of(&path.split('.').collect::<Vec<_>>())
    }

    /// Place of the last key of the path; where it is left out, of the key before it.
    pub fn key_span(&self, path: &str) -> Span {
        self.along(path.split('.')).1.clone()
    }

    /// Place of the value under these keys, of which each may have dots in its name; where it is left out, of the last
    /// that is there.
    pub fn span_of(&self, keys: &[&str]) -> Span {
        let (node, key_span, is_whole) = self.along(keys.iter().copied());
        if is_whole && !matches!(node.value, Value::Table(_)) { node.span.clone() } else { key_span.clone() }
    }

    /// The last node along the keys, where its own key stands, and whether all of them are there.
    fn along<'k>(&self, keys: impl Iterator<Item = &'k str>) -> (&Node, &Span, bool) {
        let (mut node, mut span) = (&self.root, &self.root.span);
        for key in keys {
            let Some(next) = node.step(key) else { return (node, span, false) };
            (node, span) = next;
        }
        (node, span, true)
    }

    /// The path written under these keys, from the folder of the file in which it is written.
    pub fn file_of(&self, keys: &[&str]) -> Option<PathBuf> {
        let (node, _, is_whole) = self.along(keys.iter().copied());
        match &node.value {
            Value::Text(text) if is_whole => Some(node.span.source.folder.join(text)),
            _ => None,
        }
    }

    /// The path written at the key path, from the folder of the file in which it is written.
    pub fn file(&self, path: &str) -> Option<PathBuf> {
        self.file_of(&path.split('.').collect::<Vec<_>>())
    }
}

/// The text that an assignment replaces by another text or a table: the name of a file that could not be read, where one
/// is included.
fn replaced_file<'n>(base: &'n Node, over: &Node) -> Option<(&'n Node, &'n str)> {
    match (&base.value, &over.value) {
        (Value::Text(text), _) => Some((base, text)),
        (Value::Table(base), Value::Table(over)) => match over.entries.as_slice() {
            [Entry { key, node, .. }] => replaced_file(&base.get(key)?.node, node),
            _ => None,
        },
        _ => None,
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

/// Most bytes of a scenario with the files that it names. They are written by hand; larger files are not scenarios.
const MOST_BYTES: u64 = 32 << 20;

/// Most files in a chain of files that extend or name one another.
const LONGEST_CHAIN: usize = 32;

/// Reads files and those that they name, and collects mistakes.
#[derive(Default)]
pub struct Reader {
    pub mistakes: Vec<Diagnostic>,
    /// Every file that was read, in order.
    pub files: Vec<PathBuf>,
    /// Files that could not be read.
    pub unreadable: Vec<PathBuf>,
    /// The files being read, each with the place in the one before it that names it.
    chain: Vec<(PathBuf, Option<Span>)>,
    /// Bytes read so far.
    bytes: u64,
}

impl Reader {
    /// The tree of the file at `path`, which another file names at `named`.
    pub fn read(&mut self, path: &Path, rule: Option<&Rule>, named: Option<&Span>) -> Option<Node> {
        // Along a cycle through `..` or links, the path of one file differs each time.
        let identity = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
        if self.chain.iter().any(|(file, _)| *file == identity) {
            self.report(self.cycle(&identity), named);
            return None;
        }
        if self.chain.len() == LONGEST_CHAIN {
            let message = format!("more than {LONGEST_CHAIN} files that extend one another");
            self.report(Diagnostic::new(message), named);
            return None;
        }
        let source = self.text(path, named)?;
        self.chain.push((identity, named.cloned()));
        let node = match tree::parse(&source) {
            Ok(node) => match unrelated(&node, &source, rule).filter(|_| named.is_none()) {
                Some(mistake) => {
                    self.mistakes.push(mistake);
                    None
                }
                None => self.extended(node, rule),
            },
            Err(mistakes) => {
                self.mistakes.extend(unparsed(&source, path, mistakes));
                None
            }
        };
        self.chain.pop();
        node
    }

    /// The tree merged over what it extends; none where that cannot be read.
    fn extended(&mut self, mut node: Node, rule: Option<&Rule>) -> Option<Node> {
        let (extends, unset) = match &mut node.value {
            Value::Table(table) => (take_path(table, rule), Unset::take(table, rule)),
            _ => (None, vec![]),
        };
        // Before the merge, in which a file that is named replaces a table and a table of keys adds to it.
        let over = node.map(rule, |child, rule| self.include(plain(child, rule), rule));
        let Some((path, span)) = extends else {
            self.mistakes.extend(unset.iter().map(Unset::without_base));
            return Some(over);
        };
        let mut base = self.read(&path, rule, Some(&span))?;
        // From the base alone: a key that is left out may be given anew beside `unset`.
        self.mistakes.extend(unset.iter().filter_map(|unset| unset.apply(&mut base).err()));
        Some(merge(base, over, rule))
    }

    /// The tree with files in place of the paths that name them.
    pub fn include(&mut self, node: Node, rule: Option<&Rule>) -> Node {
        let Value::Text(text) = &node.value else {
            let original = node.clone();
            return self.extended(node, rule).unwrap_or(original);
        };
        let Some(rule) = rule.filter(|rule| rule.is_included()) else {
            return node;
        };
        let path = node.span.source.folder.join(text);
        let found = match rule.table() {
            Some(_) => {
                let found = self.read(&path, Some(rule), Some(&node.span));
                found.filter(|found| self.is_no_scenario(found, &path, &node.span))
            }
            None => self.curve(&path, &node.span),
        };
        match found {
            Some(found) => Node { included: true, ..found },
            None => node,
        }
    }

    /// Reports a file that is a scenario, where a table of one is named.
    fn is_no_scenario(&mut self, found: &Node, path: &Path, named: &Span) -> bool {
        let Value::Table(table) = &found.value else { return true };
        let is_scenario = table.entries.iter().any(|entry| entry.key == "specimen");
        if is_scenario {
            let mistake = Diagnostic::new(format!("{} is a scenario, not a material", shown_path(path)));
            self.report(mistake.hint("`droptower new material` writes a file of a material"), Some(named));
        }
        !is_scenario
    }

    fn curve(&mut self, path: &Path, named: &Span) -> Option<Node> {
        // A file that is no text is read where its columns are; it counts by its size.
        let size = fs::metadata(path).map_or(0, |file| file.len());
        if size > MOST_BYTES.saturating_sub(self.bytes) {
            let why = format!("a scenario and its files may have {} MB", MOST_BYTES >> 20);
            self.report(Diagnostic::new(format!("cannot read {}: {why}", shown_path(path))), Some(named));
            return None;
        }
        let found = match signal::file::lists_channels(path) {
            true => {
                self.bytes += size;
                self.files.push(path.to_owned());
                let source = Source::file(path, String::new());
                curve_file::read_as_recording(path, &source).map_err(|mistake| vec![mistake])
            }
            false => curve_file::read(path, &self.text(path, Some(named))?),
        };
        match found {
            Ok(node) => Some(node),
            Err(mistakes) => {
                self.mistakes.extend(mistakes);
                None
            }
        }
    }

    fn text(&mut self, path: &Path, named: Option<&Span>) -> Option<Arc<Source>> {
        match file::read_text(path, MOST_BYTES.saturating_sub(self.bytes)) {
            Ok(text) => {
                self.bytes += text.len() as u64;
                self.files.push(path.to_owned());
                Some(Source::file(path, text))
            }
            Err(error) => {
                self.unreadable.push(path.to_owned());
                let hint = error.hint().map(str::to_owned);
                let why = match error {
                    FileError::TooLarge { .. } => format!("a scenario and its files may have {} MB", MOST_BYTES >> 20),
                    other => other.to_string(),
                };
                let message = format!("cannot read {}: {why}", shown_path(path));
                self.report(Diagnostic { hint, ..Diagnostic::new(message) }, named);
                None
            }
        }
    }

    fn cycle(&self, again: &Path) -> Diagnostic {
        let start = self.chain.iter().position(|(file, _)| file == again).unwrap_or(0);
        let cycle = &self.chain[start..];
        let files = cycle.iter().map(|(file, _)| file.as_path());
        let names: Vec<String> = files.chain([again]).map(shown_path).collect();
        let mistake = Diagnostic::new(format!("cyclic `extends`: {}", names.join(" → ")));
        let links = cycle.iter().skip(1).filter_map(|(_, named)| named.as_ref());
        links.fold(mistake, |mistake, link| mistake.label(link, "this file extends the next"))
    }

    fn report(&mut self, mistake: Diagnostic, named: Option<&Span>) {
        self.mistakes.push(match named {
            Some(span) => mistake.at(span),
            None => mistake,
        });
    }
}

/// A percentage as its fraction, where a number is expected.
fn plain(node: Node, rule: Option<&Rule>) -> Node {
    match (&node.value, rule) {
        (Value::Text(text), Some(Rule::Number { whole: false, .. })) => match percentage(text) {
            Some(share) => Node { value: Value::Number(share), ..node },
            None => node,
        },
        _ => node,
    }
}

/// Most syntax errors of a file that are reported.
const MOST_ERRORS: usize = 10;

/// The syntax errors of a file; of one that is hardly TOML, that it is no scenario.
fn unparsed(source: &Arc<Source>, path: &Path, mut mistakes: Vec<Diagnostic>) -> Vec<Diagnostic> {
    if !path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("toml")) {
        return vec![no_scenario(source, "it is not a TOML file")];
    }
    let others = mistakes.len().saturating_sub(MOST_ERRORS);
    if others > 0 {
        mistakes.truncate(MOST_ERRORS);
        let message = format!("{} has {others} more lines that are not TOML", source.name);
        mistakes.push(Diagnostic::new(message).hint("is it a scenario?"));
    }
    mistakes
}

/// The mistake of a scenario or a material with keys of which none is one of either.
fn unrelated(node: &Node, source: &Arc<Source>, rule: Option<&Rule>) -> Option<Diagnostic> {
    let Value::Table(table) = &node.value else { return None };
    let rules = [grammar::scenario(), grammar::material()];
    rule.filter(|rule| rules.iter().any(|other| std::ptr::eq(*rule, *other)))?;
    let known = |key: &str| rules.iter().any(|rule| rule.table().is_some_and(|table| table.key(key).is_some()));
    let is_unrelated = table.entries.len() > 1 && !table.entries.iter().any(|entry| known(&entry.key));
    is_unrelated.then(|| no_scenario(source, "it has none of the keys of one"))
}

fn no_scenario(source: &Arc<Source>, why: &str) -> Diagnostic {
    let mistake = Diagnostic::new(format!("{} is no scenario: {why}", source.name));
    mistake.hint("`droptower new drop my.toml` writes one to start from")
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
