//! Exports that were made after descriptions of those of machines (`tests/formats/make_machines.py`), and their mistakes.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use serde::Deserialize;

use crate::Error;
use crate::experiment::coupon::{CouponReader, CouponTest, Dimensions, Rules};
use crate::signal::file;

/// A specimen as it was made; mm, N, mm/min.
#[derive(Deserialize)]
struct Expected {
    name: String,
    width: f64,
    thickness: f64,
    gauge: f64,
    speed: f64,
    rows: usize,
    strength: f64,
}

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/it/formats/machines")
}

fn reduce(path: &Path) -> Result<Vec<CouponTest>, Error> {
    CouponReader::new(Dimensions::default(), Rules::default()).read_all(path)
}

fn close(found: f64, expected: f64) -> bool {
    (found - expected).abs() <= 1e-6 * expected.abs()
}

#[test]
fn every_specimen_is_reduced_with_what_the_head_states() {
    let text = fs::read_to_string(folder().join("expected.json")).unwrap();
    let expected: BTreeMap<String, Vec<Expected>> = serde_json::from_str(&text).unwrap();
    for (name, specimens) in &expected {
        let path = folder().join(name);
        let export =
            file::specimens(&path).unwrap_or_else(|error| panic!("{error}")).unwrap_or_else(|| panic!("{name}"));
        assert_eq!(export.specimens.len(), specimens.len(), "{name}");
        let tests = reduce(&path).unwrap_or_else(|error| panic!("{error}"));
        for ((expected, specimen), test) in specimens.iter().zip(&export.specimens).zip(&tests) {
            let what = format!("{name}, {}: {:?}", expected.name, specimen.stated);
            assert_eq!(specimen.name, expected.name, "{what}");
            assert!(specimen.values.iter().all(|values| values.len() == expected.rows), "{what}");
            assert!(close(test.coupon.width(), 1e-3 * expected.width), "{what}");
            assert!(close(test.coupon.thickness(), 1e-3 * expected.thickness), "{what}");
            assert!(close(test.coupon.gauge(), 1e-3 * expected.gauge), "{what}");
            assert!(close(test.sample.velocity, 1e-3 / 60.0 * expected.speed), "{what}");
            assert!(close(test.sample.rupture.strength, 1e6 * expected.strength), "{what}");
            assert!(test.specimen.is_some() && test.place().ends_with(format!("{name}, {}", expected.name)), "{what}");
        }
    }
}

/// Files that are cut at every byte, or of which some byte is another, are read or refused.
#[test]
fn damaged_exports_are_read_or_refused() {
    let scratch = tempfile::tempdir().unwrap();
    for entry in fs::read_dir(folder()).unwrap().flatten() {
        let bytes = fs::read(entry.path()).unwrap();
        let path = scratch.path().join(entry.file_name());
        for place in (0..bytes.len()).step_by(1 + bytes.len() / 60) {
            let mut other = bytes.clone();
            other[place] ^= 0x15;
            for damaged in [&bytes[..place], &other] {
                fs::write(&path, damaged).unwrap();
                if let Err(error) = reduce(&path) {
                    assert!(!error.to_string().is_empty());
                }
            }
        }
    }
}

const ROWS: &str = "0;0\n1;4\n2;7\n3;9\n4;11\n5;12\n6;12,5\n7;0\n";

fn twice(head: &str) -> String {
    let row = |row: &str| format!("{row};{row}\n");
    let rows: String = ROWS.lines().map(row).collect();
    format!("{head}\nA;;B\nWeg;Kraft;Weg;Kraft\nmm;N;mm;N\n{rows}")
}

#[test]
fn mistakes_name_file_and_line() {
    let head = "Breite;10;mm\nDicke;50;µm\nEinspannlänge;50;mm\nGeschwindigkeit;100;mm/min\nRichtung;MD";
    let scratch = tempfile::tempdir().unwrap();
    let path = scratch.path().join("z.csv");
    let read = |text: &str| {
        fs::write(&path, text).unwrap();
        reduce(&path)
    };
    let tests = read(&twice(head).replace("A;;B", "Probe 1;;Probe 2")).unwrap();
    assert_eq!(tests.len(), 2);
    for (text, expected) in [
        (twice(&head.replace("Breite;10;mm", "")), "z.csv, A: the dimensions of the coupon are not known: width"),
        (
            twice(&head.replace("Breite;10;mm", "Breite;10;N")),
            "not known: width; the head states `Breite: 10 N (not a length)`",
        ),
        (twice(&head.replace("10;mm", "10;11;12;mm")), "states 3 values of `Breite` for 2 specimens: `A`, `B`"),
        (twice(&format!("{head}\nBreite;11;mm")), "twice: Breite: 10 mm and Breite: 11 mm"),
        (twice(&head.replace("MD", "")), "the direction of the coupon is not known"),
        (twice(&head.replace("100;mm/min", "100")), "the speed of the jaws is not known"),
        (twice(head).replace("3;9;3;9", "3;x;3;9"), "expected a number, found `x`"),
        (twice(head).replace("3;9;3;9", "3;9;3;9;9"), "expected at most 4 cells, found 5"),
    ] {
        let error = match read(&text) {
            Ok(tests) => panic!("{text}\n{tests:?}"),
            Err(error) => error.to_string(),
        };
        assert!(error.contains(expected), "{text}\ngave: {error}");
    }
}
