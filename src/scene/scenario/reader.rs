//! Reading of files and of those that they name: the one they extend, materials, curves.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::curve_file;
use super::grammar::{self, Rule};
use super::merge::{Unset, merge};
use super::tree::{self, Node, Table, Value};
use base::diagnostic::{Diagnostic, Source, Span, shown_path};
use base::file::{self, FileError};
use base::units::percentage;
use lab::signal;

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
        let over = self.include_within(node, rule);
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

    fn include_within(&mut self, node: Node, rule: Option<&Rule>) -> Node {
        let value = match node.value {
            Value::Table(mut table) => {
                for entry in &mut table.entries {
                    let rule = rule.and_then(|rule| rule.under(&entry.key));
                    entry.node = self.include(plain(entry.node.clone(), rule), rule);
                }
                Value::Table(table)
            }
            Value::List(items) => {
                let items = items.into_iter().enumerate();
                let items = items.map(|(place, item)| {
                    let rule = rule.and_then(|rule| rule.item(place));
                    self.include(plain(item, rule), rule)
                });
                Value::List(items.collect())
            }
            other => other,
        };
        Node { value, ..node }
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
