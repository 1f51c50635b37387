//! The values of runs from a table in CSV: a column for each key that varies, a row for each run.

use std::path::Path;

use csv::{ReaderBuilder, StringRecord, Trim};

use super::super::ModelDiagnostics;
use super::{Factor, Values};
use crate::scenario::{Node, Value, VariedKey};
use base::diagnostic::{Diagnostic, Source, Span, shown_path};
use base::file;

/// Most bytes of a table.
const MOST_BYTES: u64 = 1 << 30;

/// Reads the table in `path`, which the scenario names at `named`.
pub(super) fn read(path: &Path, named: &Span, mistakes: &mut ModelDiagnostics<'_>) -> Vec<Factor> {
    let before = mistakes.found.0.len();
    match columns(path, named, mistakes) {
        Ok(_) if mistakes.found.0.len() > before => vec![],
        Ok(factors) => factors,
        Err(mistake) => {
            mistakes.found.0.push(mistake);
            vec![]
        }
    }
}

fn columns(path: &Path, named: &Span, mistakes: &mut ModelDiagnostics<'_>) -> Result<Vec<Factor>, Diagnostic> {
    let refused = |why: String| Diagnostic::new(format!("cannot read {}: {why}", shown_path(path))).at(named);
    let text = file::read_text(path, MOST_BYTES).map_err(|error| refused(error.to_string()))?;
    let source = Source::file(path, text);
    let mut reader = ReaderBuilder::new().comment(Some(b'#')).trim(Trim::All).from_reader(source.text.as_bytes());
    let header = reader.headers().map_err(|error| refused(error.to_string()))?.clone();
    let rows: Vec<StringRecord> =
        reader.records().collect::<Result<_, _>>().map_err(|error| refused(error.to_string()))?;
    if rows.is_empty() {
        return Err(refused("it has no rows".into()).hint("a header with the paths of keys, then a row for each run"));
    }
    let place = |record: &StringRecord| {
        let start = record.position().map_or(0, |position| position.byte() as usize).min(source.text.len());
        let line = source.text[start..].trim_start_matches(['\r', '\n']);
        let start = source.text.len() - line.len();
        Span::new(&source, start..start + line.lines().next().unwrap_or_default().len())
    };
    let head = place(&header);
    let mut factors = Vec::new();
    for (column, label) in header.iter().enumerate() {
        let items = rows.iter().map(|row| Node::new(value(row.get(column).unwrap_or_default()), place(row)));
        let node = Node::new(Value::List(items.collect()), head.clone());
        match key(label, &head, node) {
            Ok(key) => {
                mistakes.found.0.extend(key.validate());
                factors.extend(Factor::read(&key, mistakes));
            }
            Err(mistake) => mistakes.found.0.push(mistake),
        }
    }
    Ok(factors)
}

/// The key that a column is called by, with or without its unit behind.
fn key(label: &str, head: &Span, node: Node) -> Result<VariedKey, Diagnostic> {
    let of = |path: &str| VariedKey { path: path.into(), span: head.clone(), node: node.clone() };
    let whole = of(label);
    let Err(mistake) = whole.rule() else { return Ok(whole) };
    let without_unit = label.char_indices().filter(|(_, letter)| *letter == '_').find_map(|(end, _)| {
        let key = of(&label[..end]);
        let suffix = key.rule().ok()?.dimension()?.suffix();
        (suffix == label[end + 1..]).then_some(key)
    });
    without_unit.ok_or(mistake)
}

/// A cell: a number, a Boolean, or a string.
fn value(cell: &str) -> Value {
    if let Ok(whole) = cell.parse::<i64>() {
        return Value::Whole(whole);
    }
    match (cell.parse::<f64>(), cell.parse::<bool>()) {
        (Ok(number), _) => Value::Number(number),
        (_, Ok(flag)) => Value::Flag(flag),
        _ => Value::Text(cell.into()),
    }
}

impl Values {
    /// Number of listed values; `None` of a distribution.
    pub(super) fn count(&self) -> Option<usize> {
        match self {
            Values::Levels(levels) => Some(levels.len()),
            Values::Distribution(_) => None,
        }
    }
}
