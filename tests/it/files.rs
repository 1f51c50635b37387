//! Files of recorders and of tensile machines through the commands: what is read, converted and refused.

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
    let found = figures(&droptower(folder.path(), &["reduce", "coupon", "--json", path]));
    let names: Vec<&str> =
        found["specimens"].as_array().expect("specimens").iter().filter_map(|one| one["specimen"].as_str()).collect();
    assert_eq!(names, ["Probe 1", "Probe 2", "Probe 3"]);
    let stated = found["specimens"][0]["stated"].to_string();
    assert!(stated.contains("Breite b0: 15,0000 mm") && stated.contains("Dicke a0: 50,0000 µm"), "{stated}");
    let text = printed(&droptower(folder.path(), &["reduce", "coupon", path, "--width", "14 mm"]));
    assert!(text.contains("note[head-replaced]") && text.contains("width: 14 mm for Breite b0: 15,0000 mm"), "{text}");
    // The same file as a table has its columns twice.
    let output = droptower(folder.path(), &["signal", "info", path]);
    assert_eq!(output.status.code(), Some(2));
    assert!(error(&output).contains("`droptower reduce coupon`"), "{}", error(&output));
}
