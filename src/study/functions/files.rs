//! Files that a script writes beside its figures and tables.

use rhai::{Array, Dynamic, Engine};

use crate::script::{Entry, File, FileError, HostResult, MOST_BYTES, OutputCollector, number, refuse};
use lab::signal::Series;

/// Offers `write_csv` and `write_text` to scripts; their files are written with the other results, or not at all.
pub(super) fn register(collector: &OutputCollector, engine: &mut Engine) {
    let collect = |collector: &OutputCollector, name: &str, content: String| {
        collector.file(File { name: name.into(), content }).map_err(refuse)
    };
    let own = collector.clone();
    engine.register_fn("write_text", move |name: &str, text: &str| collect(&own, name, text.into()));
    let own = collector.clone();
    engine.register_fn("write_csv", move |name: &str, names: Array, columns: Array| {
        collect(&own, name, csv(&names, &columns, &Array::new())?)
    });
    let own = collector.clone();
    engine.register_fn("write_csv", move |name: &str, names: Array, columns: Array, comments: Array| {
        collect(&own, name, csv(&names, &columns, &comments)?)
    });
}

/// The text of a table: comments, a header, one row per value; a number that is not finite leaves its cell empty.
fn csv(names: &Array, columns: &Array, comments: &Array) -> HostResult<String> {
    if names.len() != columns.len() {
        return Err(refuse(format!("{} names for {} columns", names.len(), columns.len())));
    }
    let columns = columns.iter().map(Column::from_value).collect::<HostResult<Vec<_>>>()?;
    let columns: Vec<&[f64]> = columns.iter().map(Column::values).collect();
    let rows = columns.first().map_or(0, |column| column.len());
    if let Some(place) = columns.iter().position(|column| column.len() != rows) {
        let message = format!("column `{}` has {} rows, the first has {rows}", names[place], columns[place].len());
        return Err(refuse(message));
    }
    // Every cell takes at least the byte of its separator.
    if rows.saturating_mul(columns.len()) > MOST_BYTES {
        return Err(refuse(FileError::TooMuch));
    }
    let comments: String = comments.iter().flat_map(|comment| comment_lines(&comment.to_string())).collect();
    table(comments, names, &columns, MOST_BYTES)
}

fn comment_lines(comment: &str) -> Vec<String> {
    comment.lines().map(|line| format!("# {line}\n")).collect()
}

/// The `comments` followed by the table.
///
/// # Errors
/// The text exceeds `most` bytes; the rest is not formatted then.
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

/// A column from a script; a signal is not copied.
pub(super) enum Column {
    Signal(Series),
    List(Vec<f64>),
}

impl Column {
    /// The values of a signal or the numbers of a list, where `()` is NaN.
    pub(super) fn from_value(column: &Dynamic) -> HostResult<Column> {
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

/// The reference of files.
pub const ENTRIES: &[Entry] = &[
    Entry {
        call: "write_csv(name, [column name, …], [signal or list, …])",
        gives: "a file among the results with one row per value; the times of a signal are `signal.time()`",
        example: r#"write_csv("curves/md.csv", ["strain", "stress_Pa"], [[0, 0.26], [0, 8.4e6]])"#,
    },
    Entry {
        call: "write_csv(name, names, columns, [comment, …])",
        gives: "the same below lines of comments, which begin with `#`",
        example: r#"write_csv("md.csv", ["force_N"], [signal([0, 1], [0, 2.5])], ["virtual"])"#,
    },
    Entry {
        call: "write_text(name, text)",
        gives: "a text file among the results: .csv, .json, .md, .obj, .svg, .toml or .txt",
        example: r#"write_text("material.toml", "density = 915")"#,
    },
];

#[cfg(test)]
mod tests {
    use super::*;

    /// Its text, or copies of its columns, would take gigabytes.
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
