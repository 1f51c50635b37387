//! The paper's identification (Tables 8 and 9): the multipliers that the virtual recordings were made with are found again.

use std::fs;

use serde_json::Value as Json;
use tempfile::TempDir;

use crate::workbench::{data, droptower, figures, printed, root};

/// What the study leaves with the faster of its methods.
fn study(folder: &TempDir, more: &[&str]) -> Json {
    let out = folder.path().join("study");
    let out = out.to_str().expect("UTF-8");
    let fast = ["--arg", "method=levenberg-marquardt", "--json", "--quiet", "--out", out];
    figures(&droptower(&root(), &[&["script", "scripts/paper-identification.rhai"], &fast[..], more].concat()))
}

fn rows<'j>(summary: &'j Json, table: &str) -> &'j [Json] {
    summary["tables"][table].as_array().unwrap_or_else(|| panic!("no {table}"))
}

fn figure(row: &Json, name: &str) -> f64 {
    row[name].as_f64().unwrap_or_else(|| panic!("no {name} in {row}"))
}

/// Every multiplier of Table 8 within `share` of the one that the recording was made with, which is the printed one; and the
/// errors of the films' own curves within those of the paper (3 % and 1 %).
fn finds_table_8(summary: &Json, share: f64) {
    let truth = fs::read_to_string(data("paper/table-8.csv")).expect("the printed table");
    let truth: Vec<Vec<f64>> = truth
        .lines()
        .filter(|line| line.starts_with('1'))
        .map(|line| line.split(',').map(|cell| cell.parse().expect("a number")).collect())
        .collect();
    assert_eq!((truth.len(), rows(summary, "table_8").len()), (5, 5));
    for (row, truth) in rows(summary, "table_8").iter().zip(&truth) {
        assert_eq!(figure(row, "test"), truth[0]);
        for (name, truth) in ["k1", "ke", "ky"].into_iter().zip(&truth[2..]) {
            let found = figure(row, name);
            assert!((found / truth - 1.0).abs() <= share, "{name} {found} for {truth}: {row}");
            assert_eq!(figure(row, &format!("paper_{name}")), *truth);
        }
        assert!(figure(row, "acceleration_error") <= 0.03 && figure(row, "displacement_error") <= 0.01, "{row}");
        assert!(figure(row, "iterations") > 1.0 && figure(row, "paper_iterations") == truth[1], "{row}");
    }
}

/// One film for all tests fits each worse than its own does; its errors stand beside the printed ones.
fn prints_table_9(summary: &Json) {
    for (averaged, own) in rows(summary, "table_9").iter().zip(rows(summary, "table_8")) {
        assert_eq!(averaged["test"], own["test"]);
        for name in ["acceleration_error", "displacement_error"] {
            assert!(figure(averaged, name) > figure(own, name), "{averaged}");
            assert!(figure(averaged, &format!("paper_{name}")) > 0.0, "{averaged}");
        }
    }
    assert_eq!(rows(summary, "table_9").len(), 5);
    assert_eq!(rows(summary, "leave_one_out").len(), 5);
}

#[test]
fn multipliers_are_found_within_two_per_cent_without_noise() {
    let folder = TempDir::new().expect("a folder");
    let coarse = ["--arg", "recordings=exact", "--set", "specimen.mesh.size=20 mm"];
    let summary = study(&folder, &coarse);
    finds_table_8(&summary, 0.02);
    prints_table_9(&summary);
}

/// On the mesh and from the virtual recordings that are shipped.
#[test]
fn multipliers_are_found_within_five_per_cent_from_noisy_recordings() {
    let folder = TempDir::new().expect("a folder");
    let summary = study(&folder, &[]);
    finds_table_8(&summary, 0.05);
    prints_table_9(&summary);
    assert!(rows(&summary, "table_9").iter().all(|row| row["ruptured"] == false));
    assert_eq!(rows(&summary, "prediction_1508")[0]["ruptured"], true);

    let film = folder.path().join("study/lldpe-averaged.toml");
    let shear = root().join("scenarios/materials/lldpe-shear.csv");
    fs::copy(shear, folder.path().join("study/lldpe-shear.csv")).expect("writable");
    let checked = printed(&droptower(folder.path(), &["check", film.to_str().expect("UTF-8")]));
    assert!(checked.starts_with("ok"), "{checked}");
    assert!(fs::read_to_string(film).expect("a film").contains("VIRTUAL"));
}
