//! Recovery of known coefficients, Treloar's and Kawabata's rubber, stability.

use std::path::Path;

use super::super::*;
use super::Energy;
use crate::material::Tension;

fn rubber(name: &str) -> DataSet {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/rubber").join(name);
    StressReader::default().read(&path).expect("a test")
}

fn treloar() -> Vec<DataSet> {
    ["treloar-ut.csv", "treloar-et.csv", "treloar-ps.csv"].map(rubber).into()
}

#[test]
fn scratch() {
    let biaxial = [rubber("kawabata-biaxial.csv")];
    for word in [
        "neo-hookean",
        "compressible-neo-hookean",
        "mooney-rivlin",
        "yeoh",
        "gent",
        "ogden:1",
        "ogden:2",
        "ogden:3",
        "ogden:4",
        "ogden:6",
    ] {
        for weighting in [Weighting::Absolute, Weighting::Relative] {
            for (which, sets) in [
                ("all", treloar()),
                ("ut", treloar()[..1].to_vec()),
                ("kaw", ["kawabata-ut.csv", "kawabata-et.csv", "kawabata-ps.csv"].map(rubber).into()),
            ] {
                let started = std::time::Instant::now();
                let rest: Vec<DataSet> = treloar().into_iter().chain(biaxial.clone()).collect();
                match fit_law(word.parse().expect("a law"), &sets, &rest, &FitOptions { weighting, stable_to: None }) {
                    Ok(fit) => {
                        let r = |tests: &[TestFit]| {
                            tests
                                .iter()
                                .map(|t| format!("{:.5}/{:.1}%", t.quality.r_squared, 100.0 * t.quality.relative_rms))
                                .collect::<Vec<_>>()
                        };
                        println!(
                            "{word} {weighting} {which}: {:?} predicted {:?} in {:?}",
                            r(&fit.tests),
                            r(&fit.predictions),
                            started.elapsed()
                        );
                        for c in &fit.coefficients {
                            print!(
                                "  {} = {:.5e} +- {:?}",
                                c.name,
                                c.value,
                                c.standard_error.map(|e| (e * 1e4).round() * 1e-4)
                            );
                        }
                        println!();
                        for f in fit.findings() {
                            println!("    {f}");
                        }
                    }
                    Err(error) => println!("{word} {weighting} {which}: {error}"),
                }
            }
        }
    }
}
