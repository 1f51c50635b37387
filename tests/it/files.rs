//! Files of recorders and of tensile machines through the commands: what is read, converted and refused.

use std::path::PathBuf;

use crate::workbench::{droptower, figures, printed, root};

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
