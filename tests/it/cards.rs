//! `droptower export card` and `import card`: films that go to other solvers and come back.

use std::fs;

use crate::workbench::{droptower, figures, finding_codes, printed, root};

/// Written for each solver that is read, read again and written once more: the same card.
#[test]
fn a_film_goes_and_comes_back() {
    let bench = tempfile::tempdir().expect("a folder");
    let run = |arguments: &[&str]| drop(printed(&droptower(bench.path(), arguments)));
    let scenario = root().join("scenarios/drop/1008.toml");
    let aluminium = root().join("scenarios/materials/aluminium.toml");
    for (film, target, ending) in
        [(&scenario, "ls-dyna", "k"), (&scenario, "openradioss", "rad"), (&aluminium, "openradioss", "rad")]
    {
        let [first, second] = ["a", "b"].map(|name| format!("{target}-{name}.{ending}"));
        let film = film.to_str().expect("UTF-8");
        run(&["export", "card", film, "--for", target, "-o", &first, "--force"]);
        run(&["import", "card", &first, "-o", "film.toml", "--force"]);
        run(&["check", "film.toml"]);
        run(&["export", "card", "film.toml", "--for", target, "-o", &second, "--force"]);
        let curves = |path: &str| -> Vec<f64> {
            let text = fs::read_to_string(bench.path().join(path)).expect("the card");
            let lines = text.lines().filter(|line| !line.starts_with(['$', '#', '*', '/']));
            lines.flat_map(str::split_whitespace).filter_map(|word| word.trim_matches(',').parse().ok()).collect()
        };
        let (one, other) = (curves(&first), curves(&second));
        assert_eq!(one.len(), other.len(), "{target}");
        for (a, b) in one.iter().zip(&other) {
            assert!((a - b).abs() <= 2e-6 * a.abs(), "{target}: {a} and {b}");
        }
    }
}

#[test]
fn what_a_card_loses_is_a_finding() {
    let bench = tempfile::tempdir().expect("a folder");
    let film = root().join("scenarios/materials/lldpe-rates.toml");
    let film = film.to_str().expect("UTF-8");
    let card = ["export", "card", film, "--for", "openradioss", "-o", "film.rad", "--rate", "4 1/s", "--json"];
    let summary = figures(&droptower(bench.path(), &card));
    let codes = finding_codes(&summary);
    assert!(codes.contains(&"card-rates") && codes.contains(&"card-unloading-from"), "{codes:?}");
}
