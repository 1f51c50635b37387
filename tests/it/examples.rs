//! The programs in `examples/` run and print the expected values.

// Their `main` functions only print the report.
#[allow(dead_code)]
#[path = "../../examples/run_and_read.rs"]
mod run_and_read;
#[allow(dead_code)]
#[path = "../../examples/search.rs"]
mod search;
#[allow(dead_code)]
#[path = "../../examples/single_element_law.rs"]
mod single_element_law;

/// The numbers of a line.
fn numbers(line: &str) -> Vec<f64> {
    line.split_whitespace().filter_map(|word| word.parse().ok()).collect()
}

#[test]
fn signals_and_figures_of_a_run_are_read() {
    let report = run_and_read::report().expect("a run");
    let line = |name: &str| numbers(report.lines().find(|line| line.starts_with(name)).expect(name));
    let [lowest, at, ..] = line("displacement_m")[..] else { panic!("{report}") };
    assert!((-0.20..-0.15).contains(&lowest) && (0.05..0.07).contains(&at), "{report}");
    let [absorption] = line("energy_absorption")[..] else { panic!("{report}") };
    assert!((0.8..0.95).contains(&absorption), "{report}");
    assert!(line("energy_balance_error")[0] < 0.01, "{report}");
}

#[test]
fn the_stress_of_a_law_on_a_single_element_is_its_closed_form() {
    let report = single_element_law::report();
    let rows: Vec<_> = report.lines().skip(1).map(numbers).collect();
    assert_eq!(rows.len(), 4, "{report}");
    for row in rows {
        let [_, stress, closed_form] = row[..] else { panic!("{report}") };
        assert!((stress - closed_form).abs() <= 2e-3, "{report}");
    }
}

#[test]
fn a_search_finds_the_multiplier_of_a_run() {
    let report = search::multiplier().expect("a multiplier");
    let found: f64 =
        report.split_once("ke ").and_then(|(_, rest)| rest.split(' ').next()?.parse().ok()).expect("a number");
    assert!((found / 3.41 - 1.0).abs() < 1e-3, "{report}");
}
