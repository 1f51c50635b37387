//! `signal info`, `filter` and `convert` on recordings: what they print, write and refuse.

use std::f64::consts::PI;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Output;

use droptower::signal::filter::{self, Standard};
use droptower::signal::{ReadOptions, file};
use droptower::units::STANDARD_GRAVITY;
use serde_json::Value as Json;

use crate::workbench::{self, codes, data, figures, printed, unit};

fn droptower(folder: &Path, arguments: &[&str]) -> Output {
    workbench::droptower(folder, &[&["signal"], arguments].concat())
}

/// 1000 samples of a half sine of 50 g and 10 ms at 10 kHz, shaken at 3 kHz.
fn shaken(folder: &Path) -> PathBuf {
    let sample = |i: usize| {
        let time = i as f64 * 1e-4;
        let pulse = if (0.02..0.03).contains(&time) { 50.0 * (100.0 * PI * (time - 0.02)).sin() } else { 0.0 };
        format!("{time:.4},{},{i}\n", pulse + 5.0 * (2.0 * PI * 3000.0 * time).sin())
    };
    let text: String = std::iter::once("time,accel [g],count\n".to_owned()).chain((0..1000).map(sample)).collect();
    fs::write(folder.join("data.csv"), text).expect("written");
    folder.join("data.csv")
}

#[test]
fn a_filtered_channel_is_written_in_si() {
    let bench = tempfile::tempdir().expect("a folder");
    let raw = shaken(bench.path());
    let measured = fs::read_to_string(&raw).expect("the file");
    fs::write(&raw, format!("# a virtual recording\n{measured}")).expect("written");
    let printed_json = |more: &[&str]| {
        let arguments = ["filter", "data.csv", "--column", "accel", "--class", "180", "-o", "f.csv", "--json"];
        figures(&droptower(bench.path(), &[&arguments, more].concat()))
    };
    // An empty file, as `mktemp` leaves one, is no loss.
    fs::write(bench.path().join("f.csv"), "").expect("written");
    let figures = printed_json(&[]);
    let text = fs::read_to_string(bench.path().join("f.csv")).expect("the output");
    let (comments, rows): (Vec<&str>, Vec<&str>) = text.lines().partition(|line| line.starts_with('#'));
    let expected = [
        "# value: accel [g] of data.csv",
        "# unit of value: m/s2",
        "# filtered by droptower: CFC 180 (ISO 6487)",
        "# a virtual recording",
    ];
    assert_eq!(comments, expected);
    assert!(rows[0] == "time_s,value" && rows[1].starts_with("0.0,"), "{}", rows[1]);
    assert_eq!(rows.len(), 1001);
    let wanted = ReadOptions { unit: Some(unit("m/s2")), ..ReadOptions::one(None) };
    let written = file::read(&bench.path().join("f.csv"), &wanted).expect("readable").channels.remove(0);
    let accel = file::read(&raw, &ReadOptions::one(Some("accel"))).expect("readable").channels.remove(0);
    let expected = filter::channel(&accel.series, 180.0, Standard::Iso6487).expect("filtered");
    assert_eq!(written.series.values(), expected.values());
    assert_eq!(figures["largest_after"], Json::from(expected.largest().expect("samples")[1]));
    assert_eq!(figures["unit"], "m/s2");
    let sae = printed_json(&["--standard", "sae", "--force"]);
    assert_ne!(sae["largest_after"], figures["largest_after"]);
    let finer = printed_json(&["--resample", "20 kHz", "--force"]);
    assert_eq!(finer["samples"], 1999);
    let coarser = printed_json(&["--resample", "4 kHz", "--force"]);
    let warned = |figures: &Json| figures["notes"].to_string().contains("without an anti-aliasing filter");
    assert!(warned(&coarser) && !warned(&finer), "{coarser}");
}

#[test]
fn mistakes_in_other_channels_do_not_matter() {
    let bench = tempfile::tempdir().expect("a folder");
    let place = |name: &str| bench.path().join(name);
    let head = "Channel code:11HEADCG0000ACXP\nUnit:m/s2\nSampling interval:1e-4\nReference channel:implicit\n\
                Time of first sample:0\nChannel frequency class:CFC 600\n";
    fs::write(place("t.001"), format!("{head}1\n2\n")).expect("written");
    fs::write(place("t.002"), b"Channel code:X\n\0").expect("written");
    fs::write(place("t.chn"), "Number of channels:1\nName of channel 001:11HEADCG0000ACXP\nstray\n").expect("written");
    let found = file::read(&place("t.001"), &ReadOptions::default()).expect("readable");
    assert_eq!(found.channels[0].series.values(), [1.0, 2.0]);
    assert_eq!(found.channels[0].filtered, Some(600.0));
    for expected in ["a channel beside it cannot be read", "the number of samples is not stated"] {
        let notes = found.annotations.notes();
        assert!(notes.iter().any(|note| note.contains(expected)), "{expected}: {notes:?}");
    }
    assert!(file::read(&place("t.002"), &ReadOptions::default()).is_err());
    assert!(file::read(&place("t.chn"), &ReadOptions::default()).is_err());
    fs::write(place("t.002"), head.replace("CFC 600", "odd") + "1\n2\n").expect("written");
    let found = file::read(&place("t.chn"), &ReadOptions::default()).expect("readable");
    assert_eq!(found.channels[1].filtered, None);
    for expected in ["t.chn: lines without a colon are left out: 1", "class `odd` is not known"] {
        let notes = found.annotations.notes();
        assert!(notes.iter().any(|note| note.contains(expected)), "{expected}: {notes:?}");
    }
    let error = file::read(&place("t.chn"), &ReadOptions::one(Some("11HEADCG0000ACXP"))).expect_err("two of one code");
    assert!(error.to_string().contains("2 channels are called `11HEADCG0000ACXP`"), "{error}");
    fs::write(place("t.chn"), "a:b\n".repeat(30_000)).expect("written");
    let error = file::read(&place("t.chn"), &ReadOptions::default()).expect_err("no header is so long");
    assert!(error.to_string().contains("t.chn:20001:1: the header is too long"), "{error}");
}

#[test]
fn virtual_recordings_stay_virtual() {
    let bench = tempfile::tempdir().expect("a folder");
    let drop = data("virtual/1008.csv");
    let drop = drop.to_str().expect("UTF-8");
    let filter = ["filter", drop, "--column", "accelerometer", "--class", "180", "-o", "f.csv"];
    for call in
        [&filter[..], &["convert", drop, "-o", "c.csv"], &["convert", "f.csv", "-o", "g.csv", "--unit", "value=m/s2"]]
    {
        printed(&droptower(bench.path(), call));
        let text =
            fs::read_to_string(bench.path().join(call[call.iter().position(|word| *word == "-o").expect("-o") + 1]));
        assert!(text.expect("written").contains("VIRTUAL drop test: nothing fell"), "{call:?}");
    }
    let filtered = fs::read_to_string(bench.path().join("f.csv")).expect("written");
    assert_eq!(filtered.lines().find(|line| !line.starts_with('#')), Some("time_s,value"));
}

/// A thorough run would take minutes by a cost quadratic in the columns.
#[test]
fn info_lists_many_thousand_columns() {
    let bench = tempfile::tempdir().expect("a folder");
    let count = thorough::choose(20_000, 100_000);
    let header: String = (1..=count).map(|place| format!(",a{place}")).collect();
    fs::write(bench.path().join("wide.csv"), format!("t{header}\n0{}\n", ",1".repeat(count))).expect("written");
    let text = printed(&droptower(bench.path(), &["info", "wide.csv"]));
    assert!(text.lines().count() > count && text.contains(&format!("  a{count}  ")), "{} lines", text.lines().count());
}

/// A letter behind a stroke or in round brackets is a name, unless laboratories measure in it.
#[test]
fn letters_of_names_are_no_units() {
    let bench = tempfile::tempdir().expect("a folder");
    fs::write(bench.path().join("a.csv"), "t,F/d,u/t,n/a,Sensor (a)\n0,1,2,3,4\n1,1,2,3,4\n").expect("written");
    printed(&droptower(bench.path(), &["convert", "a.csv", "-o", "b.csv"]));
    let text = fs::read_to_string(bench.path().join("b.csv")).expect("the table");
    assert!(text.ends_with("time_s,F/d,u/t,n/a,Sensor (a)\n0.0,1.0,2.0,3.0,4.0\n1.0,1.0,2.0,3.0,4.0\n"), "{text}");
}

#[test]
fn the_filter_reads_that_a_channel_was_filtered_before() {
    let bench = tempfile::tempdir().expect("a folder");
    let fixture = data("isomme_fixture/Channel/test.002");
    let fixture = fixture.to_str().expect("UTF-8");
    let info = figures(&droptower(bench.path(), &["filter", fixture, "--class", "1000", "-o", "f.csv", "--json"]));
    assert!(info["notes"][0].as_str().is_some_and(|note| note.contains("went through CFC 1000 before")), "{info}");
}

#[test]
fn units_and_names_survive_conversion() {
    let bench = tempfile::tempdir().expect("a folder");
    let file = |name: &str, text: &str| fs::write(bench.path().join(name), text).expect("written");
    file("a.csv", "# virtual\ntime,accel,laser [mm],T [°C]\n0,1,2,20\n0.001,3,4,21\n");
    file("two.csv", "time_s,accel_g,accel_m_s2\n0,1,2\n0.001,3,4\n");
    let convert = |arguments: &[&str]| {
        let output = droptower(bench.path(), &[&["convert"], arguments].concat());
        workbench::printed(&output)
    };
    convert(&["a.csv", "--unit", "accel=m/s2", "-o", "there.csv"]);
    convert(&["there.csv", "-o", "again.csv"]);
    for name in ["there.csv", "again.csv"] {
        let read = file::read(&bench.path().join(name), &ReadOptions::default()).expect("readable");
        for (channel, unit) in [("accel", Some("m/s2")), ("laser", Some("m")), ("T", None)] {
            let found = read.channel(channel).or_else(|_| read.channel("T [°C]")).expect("a channel");
            assert_eq!(found.value_unit().as_deref(), unit, "{name}: {channel}");
        }
        // That it is virtual holds still; that its time had no unit does not.
        assert!(read.annotations.notes().contains(&"virtual".to_owned()), "{name}: {:?}", read.annotations.notes());
        let found = codes(&read.annotations);
        assert!(!found.contains(&"time-unit-assumed".to_owned()), "{name}: {found:?}");
    }
    convert(&["two.csv", "-o", "apart.csv"]);
    let apart = file::read(&bench.path().join("apart.csv"), &ReadOptions::default()).expect("readable");
    let names: Vec<&str> = apart.channels.iter().map(|channel| channel.label.as_str()).collect();
    assert_eq!(names, ["accel_g [m/s2]", "accel_m_s2 [m/s2]"]);
    assert_eq!(apart.channels[0].series.values(), [STANDARD_GRAVITY, 3.0 * STANDARD_GRAVITY]);
}

/// A table has no place for the class of a filter and the long name of a code but its comments.
#[test]
fn class_and_long_name_are_in_the_comments_of_a_table() {
    let bench = tempfile::tempdir().expect("a folder");
    let fixture = data("isomme_fixture/test.mme").display().to_string();
    printed(&droptower(bench.path(), &["convert", &fixture, "-o", "t.csv"]));
    let text = fs::read_to_string(bench.path().join("t.csv")).expect("the table");
    for long in ["11HEADCG0000ACXP: Head CG X acceleration", "11CHST0000H3DSXP: "] {
        assert!(text.contains(&format!("# long name of {long}")), "{text}");
    }
    let found = file::read(&bench.path().join("t.csv"), &ReadOptions::default()).expect("readable");
    let classes: Vec<Option<f64>> = found.channels.iter().map(|channel| channel.filtered).collect();
    assert_eq!(classes, [Some(1000.0), Some(600.0)]);
}
