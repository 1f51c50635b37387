//! Recordings of others, read by the functions that read the user's: values, units, counts, and every mistake in place.

use std::fs;
use std::path::Path;

use droptower::signal::{ChannelSelection, ReadOptions, Series, file};
use droptower::units::{Acceleration, Length, Moment, STANDARD_GRAVITY, Unit};
use proptest::prelude::*;

use crate::workbench::{any_text, close, data, mistaken, root, unit};

fn units(pairs: &[(&str, &str)]) -> ReadOptions {
    let units = pairs.iter().map(|(name, symbol)| ((*name).to_owned(), unit(symbol))).collect();
    ReadOptions { units, ..ReadOptions::default() }
}

#[test]
fn a_container_is_read_with_both_kinds_of_time() {
    for path in ["isomme_fixture", "isomme_fixture/test.mme", "isomme_fixture/Channel/test.chn"] {
        let read = file::read(&data(path), &ReadOptions::default()).expect("readable");
        let codes: Vec<&str> = read.channels.iter().map(|channel| channel.name.as_str()).collect();
        assert_eq!(codes, ["11HEADCG0000ACXP", "11CHST0000H3DSXP"]);
        let head = read.channel("Head CG X acceleration").expect("by its long name");
        let acceleration = head.quantity(Acceleration::DIMENSION).expect("an acceleration");
        assert_eq!(acceleration.values()[15], 42.0 * STANDARD_GRAVITY);
        assert_eq!(acceleration.time()[0], -5e-4);
        assert_eq!(head.filtered, Some(1000.0));
        let chest = read.channel("11CHST0000H3DSXP").expect("by its code").quantity(Length::DIMENSION);
        let chest = chest.expect("a length");
        close(chest.values()[6], 35e-6, 1e-12);
        assert!(chest.values()[12].is_nan(), "NOVALUE was not measured");
        assert_eq!(chest.values().iter().filter(|value| value.is_nan()).count(), 1);
        close(chest.time()[19], 0.0014, 1e-12);
        let (notes, comment) = (read.annotations.notes(), "Time zero: first contact with the barrier face".to_owned());
        assert_eq!(notes.contains(&comment), !path.ends_with("chn"), "{notes:?}");
    }
}

#[test]
fn the_measured_channel_has_the_extremes_of_its_header() {
    let read = file::read(&data("isomme_real_channel"), &ReadOptions::one(None)).expect("readable");
    let channel = &read.channels[0];
    let moment = channel.quantity(Moment::DIMENSION).expect("a moment");
    assert_eq!((channel.name.as_str(), moment.len()), ("24NECKUP00P2MOZP", 6000));
    assert_eq!(channel.filtered, None);
    for ([time, value], stated) in [
        (moment.largest().expect("samples"), [1.417e-1, 2.171756]),
        (moment.smallest().expect("samples"), [3.31e-2, -1.540194]),
    ] {
        assert_eq!(value, stated[1]);
        close(time, stated[0], 1e-9);
    }
    let absent = "78 of 79 listed channels are missing; the first is M0MBARLEMIUPACXP".to_owned();
    assert_eq!(read.annotations.notes(), ["there is no test (.mme)".to_owned(), absent]);
}

/// Changes of a channel, each of four lines: what is changed, into what (`-` is nothing), whether that is a note or a mistake in a
/// line, and what is said.
#[test]
fn what_a_header_states_is_checked_against_the_samples() {
    let text = fs::read_to_string(data("isomme_real_channel/test.001")).expect("the channel");
    let bench = tempfile::tempdir().expect("a folder");
    let path = bench.path().join("T.001");
    let changes = fs::read_to_string(root().join("tests/it/broken/files/headers.txt")).expect("changes");
    for change in changes.split("\n\n").skip(1) {
        let lines: Vec<String> = change.lines().map(|line| line.replace("\\n", "\n")).collect();
        let [from, to, told, expected] = &lines[..] else { panic!("{change}") };
        assert!(text.contains(from), "{from}");
        fs::write(&path, text.replacen(from, if to == "-" { "" } else { to }, 1)).expect("written");
        let said = match file::read(&path, &ReadOptions::default()) {
            Ok(read) if told == "note" => read.annotations.notes().join("; "),
            Err(error) if told != "note" => {
                let (file, line, _) = error.place().expect("a place");
                assert!(file == path && (told == "a line" || told.parse() == Ok(line)), "{change}: line {line}");
                error.to_string()
            }
            other => panic!("{change}: {other:?}"),
        };
        assert!(said.contains(expected), "{change}: {said}");
    }
}

#[test]
fn a_container_with_mistakes_is_refused_by_name() {
    let bench = tempfile::tempdir().expect("a folder");
    let path = |name: &str| bench.path().join(name);
    let refused = |path: &Path, expected: &str| {
        let error = file::read(path, &ReadOptions::default()).expect_err("a mistake").to_string();
        assert!(error.contains(expected), "{error}");
    };
    refused(&path("gone.mme"), "gone.mme: cannot be read: no such file or folder");
    refused(bench.path(), "neither a test (.mme) nor a list of channels (.chn)");
    fs::write(path("a.mme"), "").expect("written");
    refused(&path("a.mme"), "no folder `Channel` beside the test");
    fs::create_dir(path("CHANNEL")).expect("a folder");
    refused(bench.path(), "no channel files (`a.001`, …)");
    let axis = "Channel code:11TIRS000000TIRP\nUnit:ms\nNumber of samples:3\n";
    let value = "Channel code:11HEAD000000ACXP\nUnit:g\nReference channel:explicit\nReference channel name:";
    fs::write(path("CHANNEL/A.001"), format!("{axis}0\n1\n1\n")).expect("written");
    fs::write(path("CHANNEL/A.002"), format!("{value}11TIRS000000TIRP\n1\n2\n3\n")).expect("written");
    refused(bench.path(), "A.001:6:1: time does not increase: 1 after 1");
    fs::write(path("CHANNEL/A.001"), format!("{axis}0\nNOVALUE\n1\n")).expect("written");
    refused(bench.path(), "A.001:5:1: a sample of the time axis `11TIRS000000TIRP` was not measured");
    fs::write(path("CHANNEL/A.001"), format!("{axis}0\n1\n2\n")).expect("written");
    let read = file::read(bench.path(), &ReadOptions::default()).expect("readable now");
    assert_eq!(read.channels[0].series.time(), [0.0, 1e-3, 2e-3]);
    fs::write(path("CHANNEL/A.002"), format!("{value}11TIRS000000TIRP\n1\n2\n")).expect("written");
    refused(bench.path(), "`11HEAD000000ACXP` has 2 samples over 3 times of `11TIRS000000TIRP`");
    fs::write(path("CHANNEL/A.002"), format!("{value}11TIRS000000TIXX\n1\n2\n")).expect("written");
    refused(bench.path(), "the time of `11HEAD000000ACXP` is in `11TIRS000000TIXX`, which is missing");
    fs::write(path("b.mme"), "").expect("written");
    refused(bench.path(), "several tests in the folder: `a.mme`, `b.mme`");
}

#[test]
fn tables_with_mistakes_are_refused_in_place() {
    let bench = tempfile::tempdir().expect("a folder");
    let path = bench.path().join("r.csv");
    let refused = |text: &str, wanted: &ReadOptions, expected: &str| {
        fs::write(&path, text).expect("written");
        let error = file::read(&path, wanted).expect_err(text);
        let message = error.to_string();
        assert!(message.contains(expected), "{text:?} gave: {message}");
        assert_eq!(error.place().is_some(), !expected.starts_with("r.csv: "), "{text:?}");
    };
    for [_, expected, text] in mistaken("tables.txt") {
        refused(&text, &ReadOptions::default(), &expected);
    }
    let named = ReadOptions { names: vec!["time".into()], ..ReadOptions::default() };
    for (text, wanted, expected) in [
        ("time,a\n0,1\n", ReadOptions::one(Some("b")), "no channel `b` among `time`, `a`"),
        ("time,a [g],a [N]\n0,1,2\n", ReadOptions::one(Some("a")), "several channels are called `a`: `a [g]`, `a [N]`"),
        ("time,a,b\n0,1,2\n", ReadOptions::one(None), "r.csv:1:1: one channel is wanted, found 2: `a`, `b`"),
        ("0,1\n", named, "r.csv:1:1: 1 name (`time`) over 2 columns"),
        (
            "time,a [m/s2]\n0,1\n",
            units(&[("a", "g")]),
            "r.csv:1:6: mixed units: the file states `m/s2` of `a`, but `g`",
        ),
        ("time,b\n0,1\n", units(&[("a", "g")]), "r.csv:1:1: no channel `a` among `time`, `b`"),
    ] {
        refused(text, &wanted, expected);
    }
}

#[test]
fn tables_are_read_in_many_layouts() {
    let bench = tempfile::tempdir().expect("a folder");
    let path = bench.path().join("r.csv");
    for (text, time, values) in [
        ("time,a\n0,1\n0.5,-2.5\n", [0.0, 0.5], [1.0, -2.5]),
        ("time [ms],a [kN]\n0,0.001\n500,-0.0025\n", [0.0, 0.5], [1.0, -2.5]),
        ("Zeit / ms;Kraft / N\n0;1\n500;-2,5\n", [0.0, 0.5], [1.0, -2.5]),
        ("time,a\ns,N\n0,1\n0.5,-2.5\n", [0.0, 0.5], [1.0, -2.5]),
        ("time_ms\ta_N\n0\t1\n500\t-2.5\n", [0.0, 0.5], [1.0, -2.5]),
        ("  t   a\n  0   1\n .5  -2.5\n", [0.0, 0.5], [1.0, -2.5]),
        ("t a\n0,0 1,0\n0,5 -2,5\n", [0.0, 0.5], [1.0, -2.5]),
        ("a,time,\n1,0,\n-2.5,0.5,\n", [0.0, 0.5], [1.0, -2.5]),
        ("\"time\",\"a, left\"\r\n\"0\",\"1\"\r\n\"0.5\",\"-2.5\"\r\n", [0.0, 0.5], [1.0, -2.5]),
        ("\u{feff}Made by: nobody\nDate;2026-11-21\ntime;a\n\n0;1\n# pause\n0.5;-2.5", [0.0, 0.5], [1.0, -2.5]),
        ("0,1\n0.5,-2.5\n", [0.0, 0.5], [1.0, -2.5]),
    ] {
        fs::write(&path, text).expect("written");
        let read = file::read(&path, &ReadOptions::one(None)).unwrap_or_else(|error| panic!("{text:?} gave: {error}"));
        assert_eq!(read.channels[0].series, Series::new(time.to_vec(), values.to_vec()), "{text:?}");
    }
    fs::write(&path, b"time;Weg [\xb5m]\n0;1\n1;\n").expect("written");
    let read = file::read(&path, &ReadOptions::one(Some("Weg"))).expect("Windows-1252");
    assert_eq!(read.channels[0].series.values()[0], 1e-6);
    assert!(read.channels[0].series.values()[1].is_nan(), "an empty cell was not measured");
}

#[test]
fn assumptions_have_warnings() {
    let bench = tempfile::tempdir().expect("a folder");
    let path = bench.path().join("r.csv");
    fs::write(&path, "# virtual\nlab 3\ntime,T [°C]\n0,20\n1,21\n").expect("written");
    let read = file::read(&path, &ReadOptions::default()).expect("readable");
    let expected = [
        "virtual",
        "line 2 (before the header): lab 3",
        "time (`time`) has no unit; seconds are assumed",
        "the unit `°C` of `T [°C]` is not known; its values are as written",
    ];
    assert_eq!(read.annotations.notes(), expected);
    assert_eq!((read.channels[0].name.as_str(), read.channels[0].series.values()), ("T", &[20.0, 21.0][..]));
}

#[test]
fn unwanted_columns_are_not_parsed() {
    let bench = tempfile::tempdir().expect("a folder");
    let path = bench.path().join("long.csv");
    let rows = 100_000;
    let line = |row: usize| format!("{row},{},not,numbers,at all\n", 2 * row);
    let text: String = std::iter::once("time,a,b,c,d\n".to_owned()).chain((0..rows).map(line)).collect();
    fs::write(&path, text).expect("written");
    let read = file::read(&path, &ReadOptions::one(Some("a"))).expect("readable");
    assert_eq!((read.channels.len(), read.channels[0].series.len()), (1, rows));
    assert_eq!(read.channels[0].series.values()[rows - 1], 2.0 * (rows - 1) as f64);
    let all = ReadOptions { channels: ChannelSelection::All, ..ReadOptions::default() };
    let error = file::read(&path, &all).expect_err("no numbers").to_string();
    assert!(error.contains("long.csv:2:5: expected a number for `b`, found `not`"), "{error}");
}

/// Pieces that tables and containers are made of, in any order.
fn pieces() -> impl Strategy<Value = String> {
    let pieces = "time|a [g]|0|1.5|-2,5e3|NaN|inf|1e999|,|;|\t| |\n|\r\n|\"|#|:|[|]|(|)|/|_|µ|\u{feff}|Channel code|Number of samples|\
                  Sampling interval|Reference channel|explicit|implicit|NOVALUE|Unit|Name of channel 001|11HEADCG0000ACXP";
    let piece = prop::sample::select(pieces.split('|').collect::<Vec<_>>());
    prop_oneof![prop::collection::vec(piece, 0..60).prop_map(|pieces| pieces.concat()), any_text(0..=80)]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn no_text_makes_the_readers_panic(text in pieces(), bytes in prop::collection::vec(any::<u8>(), 0..40)) {
        let bench = tempfile::tempdir().expect("a folder");
        for name in ["r.csv", "r.001", "r.chn"] {
            let path = bench.path().join(name);
            fs::write(&path, [text.as_bytes(), &bytes].concat()).expect("written");
            let _ = file::read(&path, &ReadOptions::default());
            let _ = file::columns(&path, &ReadOptions::one(Some("a")));
            fs::write(&path, &text).expect("written");
            let _ = file::read(&path, &ReadOptions::default());
            let _ = file::read(&path, &ReadOptions { unit: Unit::parse("g").ok(), ..ReadOptions::one(None) });
        }
    }

    #[test]
    fn times_increase_in_every_recording_that_is_read(text in pieces()) {
        let bench = tempfile::tempdir().expect("a folder");
        let path = bench.path().join("r.csv");
        fs::write(&path, format!("time,a\n0,1\n1,2\n{text}\n")).expect("written");
        if let Ok(read) = file::read(&path, &ReadOptions::default()) {
            for channel in &read.channels {
                prop_assert_eq!(channel.series.time().len(), channel.series.values().len());
                prop_assert!(channel.series.time().windows(2).all(|pair| pair[0] < pair[1]));
                prop_assert!(channel.series.values().iter().all(|value| !value.is_infinite()));
            }
        }
    }
}

/// As LabVIEW and spreadsheets export tables: UTF-16 with its byte order mark, units in words.
#[test]
fn tables_in_utf_16_with_units_in_words_are_read() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("export.txt");
    let text = "\u{feff}Zeit in ms\tBeschleunigung in g\tKraft [N]\r\n0,0\t1,0\t2\r\n0,5\t-1,0\t3\r\n";
    let little: Vec<u8> = text.encode_utf16().flat_map(u16::to_le_bytes).collect();
    let big: Vec<u8> = text.encode_utf16().flat_map(u16::to_be_bytes).collect();
    for bytes in [little, big, text.as_bytes().to_vec()] {
        fs::write(&path, bytes).expect("a file");
        let found = file::read(&path, &ReadOptions::default()).expect("a recording");
        let acceleration = found.channel("Beschleunigung").expect("a channel");
        assert_eq!(acceleration.series.time(), [0.0, 0.5e-3]);
        assert_eq!(acceleration.series.values(), [9.80665, -9.80665]);
        assert_eq!(found.channel("Kraft").expect("a channel").series.values(), [2.0, 3.0]);
    }
}
