//! Files that a script leaves beside its figures and tables: curves, recordings, materials.

use std::collections::BTreeMap;

use rhai::{Array, Dynamic, Engine};
use thiserror::Error;

use super::{Entry, HostResult, OutputCollector, number, refuse};
use crate::signal::Series;

/// Endings that a file may have: what people and programs read as text.
const ENDINGS: [&str; 5] = ["csv", "json", "md", "toml", "txt"];

/// Most files that one script leaves.
const MOST_FILES: usize = 10_000;

/// Most that they hold together, bytes.
const MOST_BYTES: usize = 256 << 20;

/// Longest name of a file, bytes.
const LONGEST_NAME: usize = 200;

/// A file as a script gave it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct File {
    /// Its place in the folder of the results, `/` between the parts.
    pub name: String,
    pub content: String,
}

/// Why a file is not kept.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum FileError {
    #[error("`{name}` cannot name a file: folders and names of letters, digits, `-`, `_` and `.`, ending in .{}", ENDINGS.join(", ."))]
    Name { name: String },
    #[error("`{name}` belongs to droptower's own results")]
    Reserved { name: String },
    #[error("`{name}` would be a file and a folder at once, because of `{other}`")]
    Folder { name: String, other: String },
    #[error("a script leaves at most {MOST_FILES} files of {} MB together", MOST_BYTES >> 20)]
    TooMuch,
}

/// The files of one script, no two of which share a name on any file system.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Files {
    files: Vec<File>,
    /// Where the file of a name, in lower case, is among them.
    places: BTreeMap<String, usize>,
    /// What they hold together, bytes.
    bytes: usize,
}

impl Files {
    /// The files in the order in which they were first given.
    pub fn iter(&self) -> impl Iterator<Item = &File> {
        self.files.iter()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.files.is_empty()
    }

    /// Their places in the folder of the results.
    pub fn names(&self) -> Vec<String> {
        self.files.iter().map(|file| file.name.clone()).collect()
    }

    /// Adds the file, or replaces the one of this name; `reserved` names, and what lies in folders of such a name, are refused.
    pub(super) fn put(&mut self, file: File, reserved: &[&str]) -> Result<(), FileError> {
        check_name(&file.name, reserved)?;
        let lower = file.name.to_ascii_lowercase();
        if let Some(place) = self.clash(&lower) {
            return Err(FileError::Folder { name: file.name, other: self.files[place].name.clone() });
        }
        let same = self.places.get(&lower).copied();
        let others = self.bytes - same.map_or(0, |place| self.files[place].content.len());
        let bytes = others + file.content.len();
        if bytes > MOST_BYTES || (same.is_none() && self.files.len() >= MOST_FILES) {
            return Err(FileError::TooMuch);
        }
        self.bytes = bytes;
        match same {
            Some(place) => self.files[place] = file,
            None => {
                self.places.insert(lower, self.files.len());
                self.files.push(file);
            }
        }
        Ok(())
    }

    /// The file that would be a folder of the one called `lower`, or would lie in it.
    fn clash(&self, lower: &str) -> Option<usize> {
        let above = lower.match_indices('/').find_map(|(end, _)| self.places.get(&lower[..end]));
        let within = format!("{lower}/");
        let first = self.places.range(within.clone()..).next();
        let below = first.filter(|(name, _)| name.starts_with(&within)).map(|(_, place)| place);
        above.or(below).copied()
    }
}

fn check_name(name: &str, reserved: &[&str]) -> Result<(), FileError> {
    let letter = |c: char| c.is_ascii_alphanumeric() || "-_.".contains(c);
    let plain = |part: &str| !part.is_empty() && !part.starts_with('.') && part.chars().all(letter);
    let ending = name.rsplit_once('.').map(|(_, ending)| ending);
    if name.len() > LONGEST_NAME || !name.split('/').all(plain) || !ending.is_some_and(|end| ENDINGS.contains(&end)) {
        return Err(FileError::Name { name: name.chars().take(LONGEST_NAME).collect() });
    }
    let first = name.split('/').next().unwrap_or(name);
    if reserved.iter().any(|reserved| reserved.eq_ignore_ascii_case(first)) {
        return Err(FileError::Reserved { name: name.into() });
    }
    Ok(())
}

/// Offers `write_csv` and `write_text` to scripts; what they give is written with the other results, or not at all.
pub(super) fn register(collector: &OutputCollector, engine: &mut Engine) {
    let keep = |collector: &OutputCollector, name: &str, content: String| {
        collector.file(File { name: name.into(), content }).map_err(refuse)
    };
    let own = collector.clone();
    engine.register_fn("write_text", move |name: &str, text: &str| keep(&own, name, text.into()));
    let own = collector.clone();
    engine.register_fn("write_csv", move |name: &str, names: Array, columns: Array| {
        keep(&own, name, csv(&names, &columns, &Array::new())?)
    });
    let own = collector.clone();
    engine.register_fn("write_csv", move |name: &str, names: Array, columns: Array, comments: Array| {
        keep(&own, name, csv(&names, &columns, &comments)?)
    });
}

/// Comments, a header and a row a value; a number that is not finite leaves its cell empty.
fn csv(names: &Array, columns: &Array, comments: &Array) -> HostResult<String> {
    if names.len() != columns.len() {
        return Err(refuse(format!("{} names for {} columns", names.len(), columns.len())));
    }
    let columns = columns.iter().map(Column::of).collect::<HostResult<Vec<_>>>()?;
    let columns: Vec<&[f64]> = columns.iter().map(Column::values).collect();
    let rows = columns.first().map_or(0, |column| column.len());
    if let Some(place) = columns.iter().position(|column| column.len() != rows) {
        let message = format!("column `{}` has {} rows, the first has {rows}", names[place], columns[place].len());
        return Err(refuse(message));
    }
    // Every cell takes a byte at least, for what stands before the next.
    if rows.saturating_mul(columns.len()) > MOST_BYTES {
        return Err(refuse(FileError::TooMuch));
    }
    let comments: String = comments.iter().flat_map(|comment| comment_lines(&comment.to_string())).collect();
    table(comments, names, &columns, MOST_BYTES)
}

fn comment_lines(comment: &str) -> Vec<String> {
    comment.lines().map(|line| format!("# {line}\n")).collect()
}

/// The `comments` with the table behind them; given up as soon as that is longer than `most` bytes.
fn table(comments: String, names: &Array, columns: &[&[f64]], most: usize) -> HostResult<String> {
    let mut out = csv::Writer::from_writer(comments.into_bytes());
    out.write_record(names.iter().map(Dynamic::to_string)).map_err(refuse)?;
    for row in 0..columns.first().map_or(0, |column| column.len()) {
        out.write_record(columns.iter().map(|column| cell(column[row]))).map_err(refuse)?;
        if out.get_ref().len() > most {
            return Err(refuse(FileError::TooMuch));
        }
    }
    let bytes = out.into_inner().map_err(|error| refuse(error.error()))?;
    String::from_utf8(bytes).map_err(refuse)
}

/// The shortest digits that read back to the same number.
fn cell(value: f64) -> String {
    if value.is_finite() { value.to_string() } else { String::new() }
}

/// What a script gives for a column; a signal shares its values with it.
pub(super) enum Column {
    Signal(Series),
    List(Vec<f64>),
}

impl Column {
    /// The values of a signal, or the numbers of a list; `()` is a value that was not measured.
    pub(super) fn of(column: &Dynamic) -> HostResult<Column> {
        if let Some(series) = column.read_lock::<Series>() {
            return Ok(Column::Signal(series.clone()));
        }
        let Some(items) = column.read_lock::<Array>() else {
            return Err(refuse(format!("a column is a signal or a list of numbers, not {}", column.type_name())));
        };
        let value = |item: &Dynamic| if item.is_unit() { Ok(f64::NAN) } else { number(item, "a cell") };
        items.iter().map(value).collect::<HostResult<_>>().map(Column::List)
    }

    pub(super) fn values(&self) -> &[f64] {
        match self {
            Column::Signal(series) => series.values(),
            Column::List(values) => values,
        }
    }
}

/// The reference of what a script writes into files.
pub const ENTRIES: &[Entry] = &[
    Entry {
        call: "write_csv(name, [column name, …], [signal or list, …])",
        gives: "a file beside the results, a row a value; times of a signal are `signal.times()`",
        example: r#"write_csv("curves/md.csv", ["strain", "stress_Pa"], [[0, 0.26], [0, 8.4e6]]); true"#,
    },
    Entry {
        call: "write_csv(name, names, columns, [comment, …])",
        gives: "the same with `#` lines on top",
        example: r#"write_csv("md.csv", ["force_N"], [signal([0, 1], [0, 2.5])], ["virtual"]); true"#,
    },
    Entry {
        call: "write_text(name, text)",
        gives: "a text file beside the results: .csv, .json, .md, .toml or .txt",
        example: r#"write_text("material.toml", "density = 915"); true"#,
    },
];

#[cfg(test)]
mod tests {
    use super::*;

    fn put(files: &mut Files, name: &str) -> Result<(), FileError> {
        files.put(File { name: name.into(), content: "x".into() }, &["summary.json", "tables"])
    }

    #[test]
    fn names_stay_in_the_folder_and_clear_of_the_results() {
        for name in ["../x.csv", "/x.csv", "a/../x.csv", "a//x.csv", ".x.csv", "x", "x.exe", "a b.csv", "C:\\x.csv", ""]
        {
            assert!(matches!(put(&mut Files::default(), name), Err(FileError::Name { .. })), "{name}");
        }
        for name in ["summary.json", "Summary.json", "tables/x.csv"] {
            assert!(matches!(put(&mut Files::default(), name), Err(FileError::Reserved { .. })), "{name}");
        }
    }

    #[test]
    fn no_two_files_share_a_place() {
        let mut files = Files::default();
        for name in ["a.csv", "A.csv", "b/c.csv", "b/d.csv"] {
            put(&mut files, name).unwrap();
        }
        assert_eq!(files.iter().count(), 3);
        assert!(matches!(put(&mut files, "a.csv/x.csv"), Err(FileError::Folder { .. })));
        put(&mut files, "e.txt/f.csv").unwrap();
        assert!(matches!(put(&mut files, "e.txt"), Err(FileError::Folder { .. })));
    }

    #[test]
    fn what_is_replaced_no_longer_counts() {
        let half = "x".repeat(MOST_BYTES / 2 + 1);
        let mut files = Files::default();
        let mut put = |name: &str| files.put(File { name: name.into(), content: half.clone() }, &[]);
        put("a.csv").unwrap();
        put("A.csv").unwrap();
        assert_eq!(put("b.csv"), Err(FileError::TooMuch));
    }

    /// As text or as copies of the columns it would take gigabytes.
    #[test]
    fn a_table_that_is_too_large_is_refused_before_it_is_written() {
        let long = Dynamic::from(Series::new(vec![0.0; 1_000_000], vec![0.0; 1_000_000]));
        let error = csv(&vec!["a".into(); 9_000], &vec![long; 9_000], &Array::new()).unwrap_err().to_string();
        assert!(error.contains("256 MB"), "{error}");
        let digits = vec![-1e-300; 1_000];
        assert!(table(String::new(), &vec!["a".into()], &[&digits], 100_000).is_err(), "digits count too");
        assert!(table(String::new(), &vec!["a".into()], &[&digits], 400_000).is_ok());
    }

    #[test]
    fn a_table_has_its_comments_its_header_and_gaps() {
        let list = |items: [f64; 2]| Dynamic::from(items.map(Dynamic::from).to_vec());
        let names: Array = vec!["a, b".into(), "c".into()];
        let columns: Array = vec![list([0.1, 2.0]), list([f64::NAN, -1e-7])];
        let text = csv(&names, &columns, &vec!["virtual\nmade up".into()]).unwrap();
        assert_eq!(text, "# virtual\n# made up\n\"a, b\",c\n0.1,\n2,-0.0000001\n");
        let ragged: Array = vec![list([0.0, 1.0]), Dynamic::from(vec![Dynamic::from(1.0)])];
        assert!(csv(&names, &ragged, &Array::new()).unwrap_err().to_string().contains("`c` has 1 rows"));
        assert!(csv(&names, &ragged[..1].to_vec(), &Array::new()).is_err());
    }
}
