//! `droptower export deck`: whole tests that go to other solvers.

use std::fs;

use crate::workbench::{droptower, figures, finding_codes, refused, root};

/// Test 1008 on a coarse mesh, for each solver.
#[test]
fn a_test_goes_with_what_it_loses() {
    let bench = tempfile::tempdir().expect("a folder");
    let run = |arguments: &[&str]| droptower(bench.path(), arguments);
    let tower = root().join("scenarios/drop/1008.toml");
    let coarse = format!("extends = {tower:?}\n[specimen]\nmesh = {{ element = \"quad4\", size = \"50 mm\" }}\n");
    fs::write(bench.path().join("coarse.toml"), &coarse).expect("a scenario");
    for (target, file) in [("ls-dyna", "film.k"), ("openradioss", "film_0000.rad")] {
        let deck = format!("{target}-deck");
        let written = run(&["export", "deck", "coarse.toml", "--for", target, "-o", &deck, "--json"]);
        let summary = figures(&written);
        assert_eq!(summary["files"][0], file);
        let codes = finding_codes(&summary);
        assert!(codes.contains(&"deck-mounting") && codes.contains(&"deck-part"), "{codes:?}");
        // The head says the same as the terminal.
        let text = fs::read_to_string(bench.path().join(&deck).join(file)).expect("the deck");
        for finding in summary["findings"].as_array().expect("findings") {
            let message = finding["message"].as_str().expect("a message").replace('ν', "nu");
            assert!(text.contains(&message), "{message}");
        }
        // The mass of the computed quarter is in the deck.
        assert!(text.contains("0.00268") || text.contains("0.00267"), "{target}");
    }
}

#[test]
fn a_folder_is_replaced_only_where_it_is_a_deck() {
    let bench = tempfile::tempdir().expect("a folder");
    let tower = root().join("scenarios/drop/1008.toml");
    let tower = tower.to_str().expect("UTF-8");
    let write = |more: &[&str]| {
        droptower(bench.path(), &[&["export", "deck", tower, "--for", "ls-dyna", "-o", "deck"], more].concat())
    };
    assert_eq!(write(&[]).status.code(), Some(0));
    refused(&write(&[]), "holds a deck and is not replaced");
    assert_eq!(write(&["--force"]).status.code(), Some(0));
    fs::write(bench.path().join("deck/d3plot"), "results").expect("a file");
    refused(&write(&["--force"]), "`d3plot`, which is no file of a deck");
    assert_eq!(fs::read_dir(bench.path()).expect("a folder").count(), 1, "nothing else is left");
}
