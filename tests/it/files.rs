//! Files of recorders and of tensile machines through the commands: what is read, converted and refused.

use std::fs;
use std::path::PathBuf;

use crate::workbench::{droptower, error, figures, printed, root};

fn formats(path: &str) -> PathBuf {
    root().join("tests/it/formats").join(path)
}

/// A channel is called by its group and its name, in every command, and its conversion is read back as the same numbers.
#[test]
fn channels_of_recorders_are_converted() {
    let folder = tempfile::tempdir().expect("a folder");
    for (file, column, unit) in [
        ("tdms/written.tdms", "Drop/Acceleration", "m/s2"),
        ("tdms/written.tdms", "Pressure", "Pa"),
        ("xlsx/sheets.xlsx", "Slow/Force", "N"),
        ("mat/nested.mat", "test/first/force_kN", "N"),
        ("mat/hdf5.mat", "drop/force_N", "N"),
        ("hdf5/h5py.h5", "drop/fast/acceleration", "m/s2"),
    ] {
        let path = formats(file);
        let path = path.to_str().expect("UTF-8");
        let convert = ["signal", "convert", path, "--column", column, "-o", "out.csv", "--force"];
        printed(&droptower(folder.path(), &convert));
        let of = |path: &str| figures(&droptower(folder.path(), &["signal", "info", "--json", path]));
        let csv = of("out.csv")[0]["channels"][0].clone();
        assert_eq!(csv["unit"], unit, "{file}: {csv}");
        let whole = of(path);
        let own = whole[0]["channels"].as_array().expect("channels").iter();
        let own = own
            .clone()
            .find(|own| own["label"] == column || own["name"] == column)
            .unwrap_or_else(|| panic!("{whole}"));
        assert_eq!((&csv["smallest"], &csv["largest"]), (&own["smallest"], &own["largest"]), "{file}");
    }
}

#[test]
fn specimens_of_machines_are_named_in_results() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = formats("machines/zwick-side-by-side.csv");
    let path = path.to_str().expect("UTF-8");
    let found = figures(&droptower(folder.path(), &["tensile", "reduce", "--json", path]));
    let names: Vec<&str> =
        found["specimens"].as_array().expect("specimens").iter().filter_map(|one| one["specimen"].as_str()).collect();
    assert_eq!(names, ["Probe 1", "Probe 2", "Probe 3"]);
    let stated = found["specimens"][0]["stated"].to_string();
    assert!(stated.contains("Breite b0: 15,0000 mm") && stated.contains("Dicke a0: 50,0000 µm"), "{stated}");
    let text = printed(&droptower(folder.path(), &["tensile", "reduce", path, "--width", "14 mm"]));
    assert!(text.contains("note[head-replaced]") && text.contains("width: 14 mm for Breite b0: 15,0000 mm"), "{text}");
    // The same file as a table has its columns twice.
    let output = droptower(folder.path(), &["signal", "info", path]);
    assert_eq!(output.status.code(), Some(2));
    assert!(error(&output).contains("`droptower tensile reduce`"), "{}", error(&output));
}

#[test]
fn other_formats_are_refused_with_the_conversion_that_helps() {
    let folder = tempfile::tempdir().expect("a folder");
    let damaged: &[u8] = b"TDSm\x0e\0\0\0\x69\x12\0\0\x10\0\0\0\0\0\0\0\xff\0\0\0\0\0\0\0";
    for (name, content, expected) in [
        ("a.mdf", &b"MDF     3.30    "[..], "convert it with asammdf"),
        ("a.mf4", b"MDF     4.10    ", "convert it with asammdf"),
        ("a.unv", b"    -1\n    58\n", "pyuff"),
        ("a.xls", b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1", "save it as .xlsx"),
        ("a.parquet", b"PAR1", "pandas.read_parquet"),
        ("a.tdms_index", b"TDSh\x0e\0\0\0", "the .tdms file beside it"),
        ("a.tdms", damaged, "byte 0: the raw data of the segment begin beyond its end"),
        ("a.xlsx", b"PK\x03\x04", "not a readable zip archive"),
        ("a.mat", b"\0\0\0\0\x01\0\0\0", "save FILE -v7"),
    ] {
        fs::write(folder.path().join(name), content).expect("written");
        let output = droptower(folder.path(), &["signal", "convert", name, "-o", "out.csv"]);
        assert_eq!(output.status.code(), Some(2), "{name}");
        assert!(error(&output).contains(expected), "{name}: {}", error(&output));
        assert!(!folder.path().join("out.csv").exists(), "{name}");
    }
    let listed = printed(&droptower(folder.path(), &["explain", "formats"]));
    assert!(listed.contains("NI TDMS") && listed.contains("not read; in Python: pyuff"), "{listed}");
}
