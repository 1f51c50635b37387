//! Recordings from files in scripts.

use std::path::Path;

use rhai::{Array, Dynamic, Engine, EvalAltResult, NativeCallContext};

use super::{Answer, Entry, Session, refuse};
use crate::signal::file::{self, Wanted};
use crate::signal::{ChannelError, Measurement, Series};

/// Offers the type `measurement` to scripts that may read files.
pub fn register(engine: &mut Engine) {
    super::table::register(engine);
    super::coupon::register_reading(engine);
    engine
        .register_type_with_name::<Measurement>("measurement")
        .register_fn("read_recording", read)
        .register_fn("names", names)
        .register_fn("notes", |m: &mut Measurement| texts(m.notes.iter()))
        .register_fn("unit", unit)
        .register_fn("channel", |m: &mut Measurement, name: &str| channel(m, name))
        .register_indexer_get(|m: &mut Measurement, name: &str| channel(m, name));
}

/// The path is relative to the working directory.
fn read(context: NativeCallContext, path: &str) -> Answer<Measurement> {
    Session::of(&context).reads_recording(Path::new(path));
    file::read(Path::new(path), &Wanted::default()).map_err(|error| hinted(&error, error.hint()))
}

fn names(m: &mut Measurement) -> Array {
    texts(m.channels.iter().map(|channel| &channel.name))
}

fn texts<'a>(texts: impl Iterator<Item = &'a String>) -> Array {
    texts.map(|text| Dynamic::from(text.clone())).collect()
}

fn channel(m: &Measurement, name: &str) -> Answer<Series> {
    m.channel(name).map(|channel| channel.series.clone()).map_err(missing)
}

fn unit(m: &mut Measurement, name: &str) -> Answer<String> {
    m.channel(name).map(|channel| channel.value_unit().unwrap_or_default()).map_err(missing)
}

fn missing(error: ChannelError) -> Box<EvalAltResult> {
    hinted(&error, error.hint())
}

fn hinted(error: &impl std::fmt::Display, hint: Option<String>) -> Box<EvalAltResult> {
    match hint {
        Some(hint) => refuse(format!("{error} ({hint})")),
        None => refuse(error),
    }
}

/// The reference of what scripts do with recordings.
pub const ENTRIES: &[Entry] = &[
    Entry {
        call: "read_recording(path)",
        gives: "the recording in a file (CSV or ISO-MME), values in SI; the path is relative to the working directory",
        example: "read_recording(args.recording).names().len() > 0",
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
        gives: "the SI unit of the channel's values; empty where the file does not tell the unit",
        example: "read_recording(args.recording).unit(\"acceleration\") == \"m/s2\"",
    },
    Entry {
        call: "recording.notes()",
        gives: "what was assumed or found odd while reading",
        example: "read_recording(args.recording).notes().len() == 0",
    },
];

#[cfg(test)]
mod tests {
    use crate::script::reference::check::{assert_refused, engine};

    #[test]
    fn mistakes_are_said() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("r.csv");
        std::fs::write(&path, "time [ms],acceleration [g]\n0,1\n1,2\n").unwrap();
        let misspelt = format!("read_recording({path:?})[\"accelration\"]");
        let cases = [
            ("read_recording(\"no.csv\")", "no.csv: cannot be read: "),
            (misspelt.as_str(), "(did you mean `acceleration`?)"),
        ];
        assert_refused(&engine(), &cases);
    }
}
