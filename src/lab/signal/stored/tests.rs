//! Files that other programs wrote or that were made after descriptions of their formats, read as those programs' readers
//! read them: `tests/formats/recordings.py` made them and what is expected of them.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use serde::Deserialize;

use crate::signal::file::{self, ReadOptions};
use crate::signal::{ChannelSelection, Measurement};

const FORMATS: [&str; 5] = ["tdms", "xlsx", "mat", "hdf5", "t01"];

/// What another reader finds in a channel, in SI where its unit is known.
#[derive(Deserialize)]
struct Expected {
    time: Vec<f64>,
    /// None where nothing was measured.
    values: Vec<Option<f64>>,
}

fn folder(format: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/it/formats").join(format)
}

fn close(found: &[f64], expected: &[f64]) -> bool {
    let largest = expected.iter().fold(0.0, |largest: f64, value| largest.max(value.abs()));
    found.len() == expected.len()
        && found.iter().zip(expected).all(|(found, expected)| {
            (found.is_nan() && expected.is_nan()) || (found - expected).abs() <= 1e-9 * largest
        })
}

/// Every channel of every file of a format.
fn check(format: &str) {
    let text = fs::read_to_string(folder(format).join("expected.json")).unwrap();
    let expected: BTreeMap<String, BTreeMap<String, Expected>> = serde_json::from_str(&text).unwrap();
    for (name, channels) in &expected {
        let path = folder(format).join(name);
        let found = file::read(&path, &ReadOptions::default()).unwrap_or_else(|error| panic!("{error}"));
        let labels: Vec<&str> = found.channels.iter().map(|channel| channel.label.as_str()).collect();
        assert_eq!(labels.len(), channels.len(), "{name}: {labels:?}");
        for (label, expected) in channels {
            let channel = found.channel(label).unwrap_or_else(|error| panic!("{name}: {error}"));
            assert!(close(channel.series.time(), &expected.time), "{name}, {label}: {:?}", channel.series.time());
            let values: Vec<f64> = expected.values.iter().map(|value| value.unwrap_or(f64::NAN)).collect();
            assert!(close(channel.series.values(), &values), "{name}, {label}: {:?}", channel.series.values());
            let one = ReadOptions { channels: ChannelSelection::Named(vec![label.clone()]), ..ReadOptions::default() };
            let Measurement { channels, .. } = file::read(&path, &one).unwrap();
            assert!(close(channels[0].series.values(), channel.series.values()), "{name}, {label}");
        }
    }
}

/// Files of up to 400 bytes that are cut at every byte, and of which every byte is another, are read or refused; longer ones at some
/// 80 places.
fn damage(format: &str) {
    let scratch = tempfile::tempdir().unwrap();
    for entry in fs::read_dir(folder(format)).unwrap().flatten().filter(|entry| !entry.file_name().eq("expected.json"))
    {
        let bytes = fs::read(entry.path()).unwrap();
        let path = scratch.path().join(entry.file_name());
        let step = if bytes.len() <= 400 { 1 } else { 1 + bytes.len() / 80 };
        for place in (0..bytes.len()).step_by(step) {
            let mut other = bytes.clone();
            other[place] ^= 0xff;
            for damaged in [&bytes[..place], &other] {
                fs::write(&path, damaged).unwrap();
                for read in [
                    file::read(&path, &ReadOptions::default()).map(drop),
                    file::columns(&path, &ReadOptions::default()).map(drop),
                ] {
                    if let Err(error) = read {
                        assert!(!error.to_string().is_empty());
                        let _ = (error.message().len(), error.hint().map(str::len), error.place());
                    }
                }
            }
        }
    }
}

/// As npTDMS, pandas, SciPy and h5py read them; time histories as they were made.
#[test]
fn files_are_read_as_other_readers_read_them() {
    FORMATS.iter().for_each(|format| check(format));
}

#[test]
fn damaged_files_are_read_or_refused() {
    FORMATS.iter().for_each(|format| damage(format));
}
