//! Recordings and tables that scripts read.

use std::collections::HashSet;
use std::path::Path;

use rhai::{Array, Dynamic, Engine, EvalAltResult, Identifier, Map, NativeCallContext};

use crate::script::{HostResult, Session, refuse, refuse_hinted};
use base::file::{FileError, read_text};
use base::units::Unit;
use lab::signal::file::{self, ReadOptions};
use lab::signal::{MeasuredChannel, Measurement};

/// Offers the type `measurement` and `read_table` to scripts that may read files.
pub(super) fn register(engine: &mut Engine) {
    engine
        .register_type_with_name::<Measurement>("measurement")
        .register_fn("read_recording", |context: NativeCallContext, path: &str| {
            read(&context, path, &ReadOptions::default())
        })
        .register_fn("read_recording", |context: NativeCallContext, path: &str, more: Map| {
            read(&context, path, &wanted(&more)?)
        })
        .register_fn("names", |m: &mut Measurement| texts(m.channels.iter().map(|channel| &channel.name)))
        .register_fn("notes", |m: &mut Measurement| texts(m.annotations.notes().iter()))
        .register_fn("unit", |m: &mut Measurement, name: &str| {
            channel(m, name, |found| found.value_unit().unwrap_or_default())
        })
        .register_fn("filter_class", |m: &mut Measurement, name: &str| {
            channel(m, name, |found| found.filtered.map_or(Dynamic::UNIT, Dynamic::from))
        })
        .register_fn("channel", |m: &mut Measurement, name: &str| channel(m, name, |found| found.series.clone()))
        .register_indexer_get(|m: &mut Measurement, name: &str| channel(m, name, |found| found.series.clone()))
        .register_fn("read_table", |path: &str| read_table(Path::new(path)));
}

/// The path is relative to the working directory.
fn read(context: &NativeCallContext, path: &str, wanted: &ReadOptions) -> HostResult<Measurement> {
    let (session, path) = (Session::from_context(context), Path::new(path));
    let measurement = file::read(path, wanted).map_err(hinted)?;
    session.add_recording(path, measurement.annotations.is_virtual());
    Ok(measurement)
}

/// The read options from a script: `#{ time: name, columns: [name, …], units: #{ name: unit } }`, each as on the
/// command line.
pub(super) fn wanted(more: &Map) -> HostResult<ReadOptions> {
    let mut wanted = ReadOptions::default();
    for (key, value) in more {
        match key.as_str() {
            "time" => wanted.time = Some(text(value, "the name of the column of time")?),
            "columns" => wanted.names = list(value)?,
            "units" => wanted.units = units(value)?,
            other => {
                return Err(refuse!("unknown key `{other}`; a recording is read with time, columns or units"));
            }
        }
    }
    Ok(wanted)
}

fn text(value: &Dynamic, what: &str) -> HostResult<String> {
    let text = value.clone().into_string();
    text.map_err(|found| refuse!("expected {what} as text, found {found}"))
}

fn list(value: &Dynamic) -> HostResult<Vec<String>> {
    let names = value.read_lock::<Array>();
    let names = names.ok_or_else(|| refuse!("expected a list of columns, found {}", value.type_name()))?;
    names.iter().map(|name| text(name, "the name of a column")).collect()
}

fn units(value: &Dynamic) -> HostResult<Vec<(String, Unit)>> {
    let units = value.read_lock::<Map>();
    let units = units.ok_or_else(|| refuse!("expected units as #{{ name: unit }}, found {}", value.type_name()))?;
    let unit = |(name, symbol): (&Identifier, &Dynamic)| {
        let unit = Unit::parse(&text(symbol, "a unit")?).map_err(refuse)?;
        Ok((name.to_string(), unit))
    };
    units.iter().map(unit).collect()
}

fn texts<'a>(texts: impl Iterator<Item = &'a String>) -> Array {
    texts.map(|text| Dynamic::from(text.clone())).collect()
}

/// What `of` says about a channel.
fn channel<T>(m: &Measurement, name: &str, of: impl Fn(&MeasuredChannel) -> T) -> HostResult<T> {
    m.channel(name).map(of).map_err(hinted)
}

/// A refusal of the laboratory, with what helps.
fn hinted(error: lab::Error) -> Box<EvalAltResult> {
    refuse_hinted(&error, error.hint())
}

/// Longest table that is read, bytes.
const LONGEST: u64 = 1 << 20;

/// Most cells that are read, the limit of lists.
const MOST_CELLS: usize = 10_000;

/// One map per row, by the names in the header; `#` lines are comments, an empty cell is `()`.
fn read_table(path: &Path) -> HostResult<Array> {
    let shown = path.display();
    let malformed = |error: csv::Error| refuse!("{shown}: {error}");
    let too_long = || {
        let limit = format!("is longer than {LONGEST} bytes or has more than {MOST_CELLS} cells");
        refuse!("{shown} {limit}; read_recording is for signals")
    };
    let text = read_text(path, LONGEST).map_err(|error| match error {
        FileError::TooLarge { .. } => too_long(),
        FileError::NotAFile => refuse!("{shown} is not a file"),
        error => refuse!("cannot read {shown}: {error}"),
    })?;
    let mut reader = csv::ReaderBuilder::new().comment(Some(b'#')).trim(csv::Trim::All).from_reader(text.as_bytes());
    let names = reader.headers().map_err(malformed)?.clone();
    let mut seen = HashSet::new();
    if let Some(name) = names.iter().find(|name| !seen.insert(*name)) {
        return Err(refuse!("{shown}: two columns are called `{name}`"));
    }
    let mut rows = Array::new();
    for record in reader.records() {
        let record = record.map_err(malformed)?;
        let row = rows.len() + 1;
        let not_finite = |name: &str| {
            let message = format!("{shown}: `{name}` of row {row} is not finite");
            refuse!("{message}; leave the cell empty where there is no number")
        };
        let pair = |(name, text): (&str, &str)| Ok((name.into(), cell(text).ok_or_else(|| not_finite(name))?));
        rows.push(names.iter().zip(&record).map(pair).collect::<HostResult<Map>>()?.into());
        if rows.len() * names.len() > MOST_CELLS {
            return Err(too_long());
        }
    }
    Ok(rows)
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

#[cfg(test)]
mod tests {
    use crate::functions::tests::engine;

    #[test]
    fn options_complete_what_a_file_lacks() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("r.csv");
        std::fs::write(&path, "clock,a\n0,1\n1,2\n").unwrap();
        for more in [r#"time: "clock", units: #{ a: "kN", clock: "ms" }"#, r#"columns: ["time [ms]", "a [kN]"]"#] {
            let script = format!(
                "let r = read_recording({path:?}, #{{ {more} }}); r.unit(\"a\") == \"N\" && r.a.max() == 2000.0 && r.a.times() == [0.0, 0.001] && r.filter_class(\"a\") == ()"
            );
            assert!(engine().eval::<bool>(&script).unwrap(), "{more}");
        }
    }

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
