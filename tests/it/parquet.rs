//! Tables as Apache Parquet: on request, with the names and the numbers of the CSV.

use std::fs::{self, File};
use std::path::Path;

use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::record::Field;

use crate::workbench::{data, droptower, error, figures, printed, root};

/// Coarse and short.
const QUICK: [&str; 4] = ["--set", "specimen.mesh.size=50mm", "--set", "loading.impact.duration=12ms"];

/// Names of the columns and the cells of the rows, as text; empty where there is nothing.
fn table(path: &Path) -> (Vec<String>, Vec<Vec<String>>) {
    let file = File::open(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    let reader = SerializedFileReader::new(file).expect("Parquet");
    let fields = reader.metadata().file_metadata().schema_descr().columns().iter();
    let names = fields.map(|column| column.name().to_owned()).collect();
    let text = |field: &Field| match field {
        Field::Null => String::new(),
        Field::Double(number) => number.to_string(),
        Field::Str(text) => text.clone(),
        other => other.to_string(),
    };
    let rows = reader
        .get_row_iter(None)
        .expect("rows")
        .map(|row| row.expect("a row").get_column_iter().map(|(_, field)| text(field)).collect());
    (names, rows.collect())
}

/// The same of a CSV, numbers in one form.
fn csv(path: &Path) -> (Vec<String>, Vec<Vec<String>>) {
    let mut reader = csv::ReaderBuilder::new().comment(Some(b'#')).from_path(path).expect("a table");
    let names = reader.headers().expect("names").iter().map(str::to_owned).collect();
    let cell = |text: &str| text.parse::<f64>().map_or_else(|_| text.to_owned(), |number| number.to_string());
    (names, reader.records().map(|row| row.expect("a row").iter().map(cell).collect()).collect())
}

#[test]
fn every_table_of_a_run_and_a_study_is_also_parquet_on_request() {
    let bench = tempfile::tempdir().expect("a folder");
    let scenario = root().join("scenarios/drop/1008.toml").display().to_string();
    let script = bench.path().join("study.rhai");
    fs::write(
        &script,
        r#"table("mixed", [#{ layers: 8, word: "a", odd: true }, #{ layers: 9.5, word: (), odd: () }]);"#,
    )
    .expect("written");
    let run = |more: &[&str]| {
        printed(&droptower(bench.path(), &[&["run", &scenario, "--out", "run"], &QUICK[..], more].concat()));
        printed(&droptower(bench.path(), &[&["script", "study.rhai", "--out", "study"], more].concat()));
    };
    run(&["--parquet"]);
    for name in ["run/signals", "run/energies", "run/tables/energy_shares", "study/tables/mixed"] {
        let [parquet, text] = ["parquet", "csv"].map(|ending| bench.path().join(format!("{name}.{ending}")));
        let (found, expected) = (table(&parquet), csv(&text));
        assert!(!expected.1.is_empty());
        assert_eq!(found, expected, "{name}");
    }
    assert!(fs::read_to_string(bench.path().join("run/report.html")).expect("the page").contains("signals.parquet"));
    // What was written is ours: it is replaced by the next run, and absent where it is not asked for.
    run(&[]);
    for name in ["run/signals", "study/tables/mixed"] {
        assert!(!bench.path().join(format!("{name}.parquet")).exists());
    }
}

#[test]
fn a_comparison_has_the_signals_and_the_figures_of_all_runs() {
    let bench = tempfile::tempdir().expect("a folder");
    let file = |name: &str, text: &str| {
        let place = bench.path().join(name);
        fs::create_dir_all(place.parent().expect("a folder")).expect("a folder");
        fs::write(place, text).expect("written");
    };
    file("a/signals.csv", "time_s,force_N,depth_m\n0,1,5\n1,2,6\n");
    file("a/summary.json", r#"{"peak_force_N": 2.0, "ruptured": false}"#);
    file("b/signals.csv", "time_s,force_N\n0,3\n0.5,\n2,4\n");
    file("b/summary.json", r#"{"peak_force_N": 4.0, "ruptured": true, "cause": "x"}"#);
    file("c/signals.csv", "time_s,depth_m\n0,7\n");
    file("c/summary.json", "{}");
    printed(&droptower(bench.path(), &["compare", "a", "b", "c", "--out", "both", "--parquet"]));
    let of = |name: &str| {
        let (names, rows) = table(&bench.path().join("both").join(name));
        (names.join(" "), rows.iter().map(|row| row.join(" ")).collect::<Vec<_>>())
    };
    assert_eq!(
        of("signals.parquet"),
        (
            "run time_s force_N depth_m".into(),
            ["a 0 1 5", "a 1 2 6", "b 0 3 ", "b 0.5  ", "b 2 4 ", "c 0  7"].map(str::to_owned).to_vec()
        )
    );
    assert_eq!(
        of("figures.parquet"),
        ("run peak_force_N ruptured cause".into(), ["a 2 false ", "b 4 true x", "c   "].map(str::to_owned).to_vec())
    );
    printed(&droptower(bench.path(), &["compare", "a", "b", "--out", "both", "--force"]));
    assert!(!bench.path().join("both/signals.parquet").exists());
}

#[test]
fn a_recording_is_converted_with_its_units_and_comments() {
    let bench = tempfile::tempdir().expect("a folder");
    let fixture = data("isomme_fixture").display().to_string();
    let convert =
        |to: &str, more: &[&str]| droptower(bench.path(), &[&["signal", "convert", &fixture, "-o", to], more].concat());
    for to in ["t.csv", "t.parquet"] {
        let done = figures(&convert(to, &["--json"]));
        assert_eq!(done["out"], to);
    }
    let path = bench.path().join("t.parquet");
    assert_eq!(table(&path), csv(&bench.path().join("t.csv")));
    let reader = SerializedFileReader::new(File::open(&path).expect("a file")).expect("Parquet");
    let entries = reader.metadata().file_metadata().key_value_metadata().expect("metadata").clone();
    let entry = |key: &str| entries.iter().find(|entry| entry.key == key).and_then(|entry| entry.value.clone());
    let units = r#"{"time_s":"s","11HEADCG0000ACXP_m_s2":"m/s2","11CHST0000H3DSXP_m":"m"}"#;
    assert_eq!(entry("units").as_deref(), Some(units));
    assert!(entry("comments").is_some_and(|text| text.contains("filtered before: 11HEADCG0000ACXP with CFC 1000")));
    let refused = convert("t.parquet", &[]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(error(&refused).contains("t.parquet already exists"), "{}", error(&refused));
}
