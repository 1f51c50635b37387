//! Searches without a script: `cargo run --release --example search`.

use std::error::Error;

use droptower::confidence::{Colour, Confidence, ConfidenceOptions};
use droptower::diagnostic::{Diagnostic, render};
use droptower::identify::{
    Evaluation, Method, Objective, Search, SearchError, Trial, linearize_at_start, minimize, with_evaluator,
};
use droptower::model;
use droptower::scenario::{Assignment, Document};
use droptower::signal::{Series, norm::relative_residuals};
use droptower::simulate::{self, Cancellation, RunOptions};

fn main() -> Result<(), Box<dyn Error>> {
    // Any closure from a point to residuals is an objective, here a decay through six readings.
    let readings = [3.0, 2.2, 1.5, 1.2, 0.8, 0.6];
    let decay = |x: &[f64]| -> Vec<f64> {
        readings.iter().enumerate().map(|(i, reading)| x[0] * (-x[1] * i as f64).exp() - reading).collect()
    };
    print!("{}", fit(&decay, &["amplitude", "rate"], vec![2.0, 0.2])?);
    print!("{}", multiplier()?);
    Ok(())
}

/// The multiplier `ke` of drop test 1008 on a coarse mesh, from the displacement of a run with 3.41.
pub fn multiplier() -> Result<String, Box<dyn Error>> {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/scenarios/drop/1008.toml");
    let coarse = Assignment::from_argument("specimen.mesh.size=40mm").map_err(text)?;
    let short = Assignment::from_argument("loading.impact.duration=65ms").map_err(text)?;
    let document = Document::read(path.as_ref()).map_err(text)?.with(&[coarse, short]);
    let recorded = displacement(&document, 3.41, &Cancellation::default())?;
    fit(&DropTest { document, recorded }, &["ke"], vec![2.5])
}

/// A drop test whose simulated displacement is compared with a recorded one.
struct DropTest {
    document: Document,
    recorded: Series,
}

impl Objective for DropTest {
    /// The relative residuals of the displacement; an error of the run is a failed trial.
    fn trial(&self, x: &[f64], cancellation: &Cancellation) -> Trial {
        let residuals = displacement(&self.document, x[0], cancellation)
            .and_then(|simulated| Ok(relative_residuals(&simulated, &self.recorded, [0.0, 0.06])?.values().to_vec()));
        Evaluation::from(residuals).into()
    }
}

/// The displacement of a run, which ends early if its trial is cancelled.
fn displacement(document: &Document, ke: f64, cancellation: &Cancellation) -> Result<Series, Box<dyn Error>> {
    let change = Assignment::from_argument(&format!("specimen.material.fabric.scale.ke={ke}")).map_err(text)?;
    let model = model::check(&document.with(&[change])).map_err(text)?;
    let options = RunOptions { cancellation: cancellation.clone(), ..RunOptions::default() };
    let outcome = simulate::run_with(&model, options, &mut |_| {})?;
    Ok(outcome.signals.series("displacement_m").ok_or("no displacement")?)
}

/// Fits `objective` from `start`: one line for each parameter with its interval of 95 %, and the warnings.
pub fn fit(objective: &dyn Objective, names: &[&str], start: Vec<f64>) -> Result<String, Box<dyn Error>> {
    let names: Vec<String> = names.iter().map(|name| (*name).to_owned()).collect();
    let search = Search { difference: 0.01, names: names.clone(), ..Search::new(Method::LevenbergMarquardt, start) };
    let result = with_evaluator(objective, 2, |evaluator| minimize(&search, evaluator, &mut |_| {}))?;
    let options = ConfidenceOptions { colour: Colour::White, relative: true, ..ConfidenceOptions::new(names) };
    let estimate = Search { start: result.best.x.clone(), ..search };
    let confidence = with_evaluator(objective, 2, |evaluator| {
        let linearization = linearize_at_start(&estimate, evaluator)?;
        Confidence::from_linearization(&linearization, &options)
            .map_err(|error| SearchError::Refused(error.to_string()))
    })?;
    let parameters = confidence.names.iter().zip(&confidence.x).zip(&confidence.intervals);
    let parameters =
        parameters.map(|((name, x), [lower, upper])| format!("{name} {x:.4} ({lower:.4} to {upper:.4})\n"));
    let warnings = result.warnings.iter().map(ToString::to_string);
    let warnings = warnings.chain(confidence.warnings.iter().map(ToString::to_string));
    let warnings = warnings.map(|warning| format!("warning: {warning}\n"));
    Ok(format!("{}: {}", result.best.reason, parameters.chain(warnings).collect::<String>()))
}

fn text(mistakes: Vec<Diagnostic>) -> String {
    render(&mistakes, false)
}
