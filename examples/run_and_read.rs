//! Runs a scenario and reads its signals and figures: `cargo run --release --example run_and_read`.

use std::error::Error;
use std::fmt::Write;
use std::path::Path;

use droptower::diagnostic::{Diagnostic, render};
use droptower::model;
use droptower::post::Plan;
use droptower::scenario::{Assignment, Document};
use droptower::simulate;

fn main() -> Result<(), Box<dyn Error>> {
    print!("{}", report()?);
    Ok(())
}

/// What the example prints: the largest values of drop test 1008 on a coarse mesh.
pub fn report() -> Result<String, Box<dyn Error>> {
    let mistakes = |mistakes: Vec<Diagnostic>| render(&mistakes, false);

    // As written in the file, with one key changed as `--set` does; then checked and in SI units.
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios/drop/1008.toml");
    let coarse = Assignment::from_argument("specimen.mesh.size=40mm").map_err(mistakes)?;
    let document = Document::read(&path).map_err(mistakes)?.with(&[coarse]);
    let model = model::check(&document).map_err(mistakes)?;

    // The plan reads the reference and compiles the post script, so that neither can fail after the run.
    let plan = Plan::prepare(&model)?;
    let outcome = simulate::run(&model, &mut |_| {})?;
    let results = plan.measure(&model, &outcome)?;

    let mut report = format!("{}: {} elements, {} steps\n", model.name, outcome.elements, outcome.steps);
    for name in ["displacement_m", "acceleration_filtered_m_s2", "contact_force_N"] {
        let series = results.signals.series(name).ok_or(name)?;
        let smallest = series.smallest().ok_or("no samples")?;
        let largest = series.largest().ok_or("no samples")?;
        writeln!(
            report,
            "{name:<28} {:>10.4} at {:.4} s  {:>10.4} at {:.4} s",
            smallest[1], smallest[0], largest[1], largest[0]
        )?;
    }
    let summary = results.summary(&model);
    for figure in ["energy_absorption", "acceleration_error", "energy_balance_error"] {
        writeln!(report, "{figure:<28} {:>10.4}", summary[figure].as_f64().ok_or(figure)?)?;
    }
    Ok(report)
}
