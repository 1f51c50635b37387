//! Tables in scripts: published numbers to compare with.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use rhai::{Array, Dynamic, Engine, Map, NativeCallContext};
use thiserror::Error;

use super::{Entry, Session, refuse};

/// Longest table that is read, bytes.
const LONGEST: u64 = 1 << 20;

/// Most cells that are read: as many as a list of a script holds.
const MOST_CELLS: usize = 10_000;

/// Why a file is no table.
#[derive(Debug, Error)]
enum TableError {
    #[error("cannot read {}: {source}", path.display())]
    Open { path: PathBuf, source: io::Error },
    #[error("{} is longer than {LONGEST} bytes or has more than {MOST_CELLS} cells; read_recording is for signals", path.display())]
    TooLong { path: PathBuf },
    #[error("{}: {source}", path.display())]
    Malformed { path: PathBuf, source: csv::Error },
}

/// Offers `read_table` to scripts that may read files.
pub(super) fn register(engine: &mut Engine) {
    engine.register_fn("read_table", |context: NativeCallContext, path: &str| {
        Session::of(&context).reads(Path::new(path));
        read(Path::new(path)).map_err(refuse)
    });
}

/// A map a row, by the names of the first line; `#` lines are comments, an empty cell is `()`.
fn read(path: &Path) -> Result<Array, TableError> {
    let open = |source| TableError::Open { path: path.into(), source };
    let malformed = |source| TableError::Malformed { path: path.into(), source };
    let too_long = || TableError::TooLong { path: path.into() };
    if fs::metadata(path).map_err(open)?.len() > LONGEST {
        return Err(too_long());
    }
    let text = fs::read_to_string(path).map_err(open)?;
    let mut reader = csv::ReaderBuilder::new().comment(Some(b'#')).trim(csv::Trim::All).from_reader(text.as_bytes());
    let names = reader.headers().map_err(malformed)?.clone();
    let mut rows = Array::new();
    for record in reader.records() {
        let record = record.map_err(malformed)?;
        let row: Map = names.iter().zip(&record).map(|(name, text)| (name.into(), cell(text))).collect();
        rows.push(row.into());
        if rows.len() * names.len() > MOST_CELLS {
            return Err(too_long());
        }
    }
    Ok(rows)
}

/// Numbers are such, the rest is text.
fn cell(text: &str) -> Dynamic {
    if text.is_empty() {
        return Dynamic::UNIT;
    }
    let integer = text.parse::<i64>().map(Dynamic::from);
    let number = integer.or_else(|_| text.parse::<f64>().map(Dynamic::from));
    number.unwrap_or_else(|_| text.to_owned().into())
}

/// The reference of tables.
pub const ENTRIES: &[Entry] = &[Entry {
    call: "read_table(path)",
    gives: "the rows of a small CSV file as a list of maps; numbers where a cell is one, () where it is empty",
    example: r#"let rows = read_table("data/paper/table-5.csv"); rows.len() == 4 && rows[0].direction == "MD" && rows[0].strain == 0.26"#,
}];

#[cfg(test)]
mod tests {
    use crate::script::reference::check::engine;

    #[test]
    fn cells_are_numbers_text_or_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("t.csv");
        std::fs::write(&path, "# source\na, b,c\n1,2.5,x y\n,-1e-3,\n").unwrap();
        let script = format!(
            "let t = read_table({path:?}); t.len() == 2 && t[0] == #{{ a: 1, b: 2.5, c: \"x y\" }} && t[1].a == () && t[1].b == -0.001"
        );
        assert!(engine().eval::<bool>(&script).unwrap());
        std::fs::write(&path, "a,b\n1\n").unwrap();
        let error = engine().run(&format!("read_table({path:?})")).unwrap_err().to_string();
        assert!(error.contains("t.csv: ") && error.contains("record"), "{error}");
        assert!(engine().run("read_table(\"no.csv\")").unwrap_err().to_string().contains("cannot read no.csv"));
    }
}
