//! Recordings from files in scripts.

use std::path::Path;

use rhai::{Array, Dynamic, Engine, EvalAltResult, Identifier, Map, NativeCallContext};

use crate::script::{Entry, HostResult, Session, refuse};
use base::units::Unit;
use lab::Error;
use lab::signal::file::{self, ReadOptions};
use lab::signal::{Measurement, Series};

/// Offers the type `measurement` to scripts that may read files.
pub(super) fn register(engine: &mut Engine) {
    engine
        .register_type_with_name::<Measurement>("measurement")
        .register_fn("read_recording", |context: NativeCallContext, path: &str| {
            read(&context, path, &ReadOptions::default())
        })
        .register_fn("read_recording", |context: NativeCallContext, path: &str, more: Map| {
            read(&context, path, &wanted(&more)?)
        })
        .register_fn("names", names)
        .register_fn("notes", |m: &mut Measurement| texts(m.annotations.notes().iter()))
        .register_fn("unit", unit)
        .register_fn("filter_class", filter_class)
        .register_fn("channel", |m: &mut Measurement, name: &str| channel(m, name))
        .register_indexer_get(|m: &mut Measurement, name: &str| channel(m, name));
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
                return Err(refuse(format!("unknown key `{other}`; a recording is read with time, columns or units")));
            }
        }
    }
    Ok(wanted)
}

fn text(value: &Dynamic, what: &str) -> HostResult<String> {
    let text = value.clone().into_string();
    text.map_err(|found| refuse(format!("expected {what} as text, found {found}")))
}

fn list(value: &Dynamic) -> HostResult<Vec<String>> {
    let names = value.read_lock::<Array>();
    let names = names.ok_or_else(|| refuse(format!("expected a list of columns, found {}", value.type_name())))?;
    names.iter().map(|name| text(name, "the name of a column")).collect()
}

fn units(value: &Dynamic) -> HostResult<Vec<(String, Unit)>> {
    let units = value.read_lock::<Map>();
    let units =
        units.ok_or_else(|| refuse(format!("expected units as #{{ name: unit }}, found {}", value.type_name())))?;
    let unit = |(name, symbol): (&Identifier, &Dynamic)| {
        let unit = Unit::parse(&text(symbol, "a unit")?).map_err(refuse)?;
        Ok((name.to_string(), unit))
    };
    units.iter().map(unit).collect()
}

fn names(m: &mut Measurement) -> Array {
    texts(m.channels.iter().map(|channel| &channel.name))
}

fn texts<'a>(texts: impl Iterator<Item = &'a String>) -> Array {
    texts.map(|text| Dynamic::from(text.clone())).collect()
}

fn channel(m: &Measurement, name: &str) -> HostResult<Series> {
    m.channel(name).map(|channel| channel.series.clone()).map_err(hinted)
}

fn unit(m: &mut Measurement, name: &str) -> HostResult<String> {
    m.channel(name).map(|channel| channel.value_unit().unwrap_or_default()).map_err(hinted)
}

fn filter_class(m: &mut Measurement, name: &str) -> HostResult<Dynamic> {
    let class = m.channel(name).map_err(hinted)?.filtered;
    Ok(class.map_or(Dynamic::UNIT, Dynamic::from))
}

/// A refusal of the laboratory, with what helps.
pub(super) fn hinted(error: Error) -> Box<EvalAltResult> {
    match error.hint() {
        Some(hint) => refuse(format!("{error} ({hint})")),
        None => refuse(error),
    }
}

/// The reference of recordings.
pub const ENTRIES: &[Entry] = &[
    Entry {
        call: "read_recording(path)",
        gives: "the recording in a file (any format of `droptower explain formats`), values in SI; the path is relative to the working directory",
        example: "read_recording(args.recording).names() == [\"acceleration\"]",
    },
    Entry {
        call: "read_recording(path, #{ time, columns, units })",
        gives: "the same with what the file lacks: the column of time, names of all columns, units of channels",
        example: r#"read_recording(args.recording, #{ time: "time", units: #{ acceleration: "g" } }).unit("acceleration") == "m/s2""#,
    },
    Entry {
        call: "recording.names()",
        gives: "the names of its channels",
        example: "read_recording(args.recording).names().contains(\"acceleration\")",
    },
    Entry {
        call: "recording.channel(name), recording[name]",
        gives: "the channel as a signal",
        example: "let r = read_recording(args.recording); r[\"acceleration\"].len() == r.channel(\"acceleration\").len()",
    },
    Entry {
        call: "recording.unit(name)",
        gives: "the SI unit of the channel's values; empty where the file has none",
        example: "read_recording(args.recording).unit(\"acceleration\") == \"m/s2\"",
    },
    Entry {
        call: "recording.filter_class(name)",
        gives: "the channel frequency class that the file states for the channel, or ()",
        example: "read_recording(args.recording).filter_class(\"acceleration\") == ()",
    },
    Entry {
        call: "recording.notes()",
        gives: "notes on what was assumed or is irregular in the file",
        example: "read_recording(args.recording).notes().len() == 0",
    },
];

#[cfg(test)]
mod tests {
    use crate::functions::check::engine;

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
}
