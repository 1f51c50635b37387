use std::path::Path;

use super::*;
use crate::signal::{Channel, Recording};

fn read_text(text: &str) -> Result<Recording, ReadError> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("r.csv");
    std::fs::write(&path, text).unwrap();
    read(&path)
}

#[test]
fn a_written_recording_reads_back_to_the_same_bits() {
    let recording = Recording {
        time: vec![0.0, 1e-4, 2e-4],
        channels: vec![
            Channel { name: "acceleration_m_s2".into(), values: vec![-9.81, 0.1 + 0.2, 1e-300] },
            Channel { name: "displacement_m".into(), values: vec![-0.0, 1.0 / 3.0, 6.02e23] },
        ],
    };
    let mut text = Vec::new();
    write(&recording, &mut text).unwrap();
    let text = String::from_utf8(text).unwrap();
    assert!(text.starts_with("time_s,acceleration_m_s2,displacement_m\n0.0,-9.81,-0.0\n"), "{text}");
    assert_eq!(read_text(&text).unwrap(), recording);
}

#[test]
fn an_empty_cell_means_not_measured() {
    let laser = read_text("# virtual\ntime_s, displacement_m\n0, \n1, 2.5\n").unwrap();
    let values = laser.channel("displacement_m").unwrap();
    assert!(values[0].is_nan());
    assert_eq!(values[1], 2.5);
}

#[test]
fn every_mistake_is_refused_by_name_and_place() {
    for (text, expected) in [
        ("", "no samples"),
        ("time_s,a\n", "no samples"),
        ("a,b\n1,2\n", "r.csv:1:1: no column of time among `a`, `b`"),
        ("time_s,a,a\n0,1,2\n", "r.csv:1:10: two columns are called `a`"),
        ("time_s,a\n0,1\n1,x7\n", "r.csv:3:3: expected a number for `a`, found `x7`"),
        ("time_s,a\n0,1\n,2\n", "r.csv:3:1: the sample has no time"),
        ("time_s,a\n0,NaN\n", "r.csv:2:3: `a` is not finite"),
        ("time_s,a\n0,inf\n", "r.csv:2:3: `a` is not finite"),
        ("time_s,a\n0,1\n1,1\n1,1\n", "r.csv:4:1: time does not increase: 1 after 1"),
        ("time_s,a\n0,1\n1\n", "r.csv:3:1: expected 2 cells, found 1"),
    ] {
        let error = read_text(text).unwrap_err().to_string();
        assert!(error.contains(expected), "{text:?} gave: {error}");
    }
}

#[test]
fn a_missing_file_is_named() {
    let error = read(Path::new("no/such.csv")).unwrap_err().to_string();
    assert!(error.starts_with("no/such.csv: cannot be read: "), "{error}");
}
