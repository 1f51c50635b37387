//! Tables in scripts: published numbers to compare with.

use std::collections::HashSet;
use std::path::{Path, PathBuf};

use rhai::{Array, Dynamic, Engine, Map};
use thiserror::Error;

use crate::script::{Entry, refuse};
use base::file::{self, FileError};

/// Longest table that is read, bytes.
const LONGEST: u64 = 1 << 20;

/// Most cells that are read, the limit of lists.
const MOST_CELLS: usize = 10_000;

/// Why a table cannot be read.
#[derive(Debug, Error)]
enum TableError {
    #[error("cannot read {}: {source}", path.display())]
    Open { path: PathBuf, source: FileError },
    #[error("{} is longer than {LONGEST} bytes or has more than {MOST_CELLS} cells; read_recording is for signals", path.display())]
    TooLong { path: PathBuf },
    #[error("{} is not a file", path.display())]
    NoFile { path: PathBuf },
    #[error("{}: two columns are called `{name}`", path.display())]
    Duplicate { path: PathBuf, name: String },
    #[error("{}: `{name}` of row {row} is not finite; leave the cell empty where there is no number", path.display())]
    NotFinite { path: PathBuf, row: usize, name: String },
    #[error("{}: {source}", path.display())]
    Malformed { path: PathBuf, source: csv::Error },
}

/// Offers `read_table` to scripts that may read files.
pub(super) fn register(engine: &mut Engine) {
    engine.register_fn("read_table", |path: &str| read(Path::new(path)).map_err(refuse));
}

/// One map per row, by the names in the header; `#` lines are comments, an empty cell is `()`.
fn read(path: &Path) -> Result<Array, TableError> {
    let malformed = |source| TableError::Malformed { path: path.into(), source };
    let text = text(path)?;
    let mut reader = csv::ReaderBuilder::new().comment(Some(b'#')).trim(csv::Trim::All).from_reader(text.as_bytes());
    let names = reader.headers().map_err(malformed)?.clone();
    let mut seen = HashSet::new();
    if let Some(name) = names.iter().find(|name| !seen.insert(*name)) {
        return Err(TableError::Duplicate { path: path.into(), name: name.into() });
    }
    let mut rows = Array::new();
    for record in reader.records() {
        let record = record.map_err(malformed)?;
        let row = rows.len() + 1;
        let not_finite = |name: &str| TableError::NotFinite { path: path.into(), row, name: name.into() };
        let pair = |(name, text): (&str, &str)| Ok((name.into(), cell(text).ok_or_else(|| not_finite(name))?));
        let row = names.iter().zip(&record).map(pair).collect::<Result<Map, _>>()?;
        rows.push(row.into());
        if rows.len() * names.len() > MOST_CELLS {
            return Err(TableError::TooLong { path: path.into() });
        }
    }
    Ok(rows)
}

fn text(path: &Path) -> Result<String, TableError> {
    let place = || path.into();
    file::read_text(path, LONGEST).map_err(|error| match error {
        FileError::TooLarge { .. } => TableError::TooLong { path: place() },
        FileError::NotAFile => TableError::NoFile { path: place() },
        source => TableError::Open { path: place(), source },
    })
}

/// A number or a text; none for a number that is not finite.
fn cell(text: &str) -> Option<Dynamic> {
    if text.is_empty() {
        return Some(Dynamic::UNIT);
    }
    if let Ok(integer) = text.parse::<i64>() {
        return Some(integer.into());
    }
    match text.parse::<f64>() {
        Ok(number) => number.is_finite().then(|| number.into()),
        Err(_) => Some(text.to_owned().into()),
    }
}

/// The reference of tables.
pub const ENTRIES: &[Entry] = &[Entry {
    call: "read_table(path)",
    gives: "the rows of a small CSV file as a list of maps; numeric cells are numbers, empty ones ()",
    example: r#"let rows = read_table("data/paper/table-5.csv"); rows.len() == 4 && rows[0].direction == "MD" && rows[0].strain == 0.26"#,
}];

#[cfg(test)]
mod tests {
    use crate::functions::check::engine;

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
        for (text, expected) in
            [("a,b,a\n1,2,3\n", "two columns are called `a`"), ("a,b\n1,2\n# c\n3,nan\n", "`b` of row 2 is not finite")]
        {
            std::fs::write(&path, text).unwrap();
            let error = engine().run(&format!("read_table({path:?})")).unwrap_err().to_string();
            assert!(error.contains(expected), "{error}");
        }
        assert!(engine().run("read_table(\"no.csv\")").unwrap_err().to_string().contains("cannot read no.csv"));
    }

    #[cfg(unix)]
    #[test]
    fn devices_and_long_files_are_refused() {
        let error = engine().run("read_table(\"/dev/zero\")").unwrap_err().to_string();
        assert!(error.contains("/dev/zero is not a file"), "{error}");
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("t.csv");
        std::fs::write(&path, "x".repeat((1 << 20) + 1)).unwrap();
        assert!(engine().run(&format!("read_table({path:?})")).unwrap_err().to_string().contains("is longer than"));
    }
}
