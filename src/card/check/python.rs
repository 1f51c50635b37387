//! Elements of solvers that are packages of Python: a script of ours, `element.json` and, of Kratos, the card.

use serde_json::{Value, json};

use super::{Input, Mode, Pull};
use crate::film::{bulk_modulus, ogden_terms, shear_modulus};
use crate::{Film, Loss, Refusal, System};
use membrane::material::{Elastic, HyperelasticLaw, Law, Polynomial};

/// What both scripts leave.
pub(super) const RESULT: &str = "result.csv";

fn input(script: &'static str, text: &str, element: &Value) -> Input {
    let element = serde_json::to_string_pretty(element).expect("numbers and texts") + "\n";
    let files = vec![(script.to_owned(), text.to_owned()), ("element.json".to_owned(), element)];
    Input { files, calls: vec![("element", vec![script.to_owned()])] }
}

fn paths(pulls: &[Pull]) -> Value {
    pulls.iter().map(|pull| json!({ "name": pull.mode.key(), "stretches": pull.stretches })).collect()
}

/// The element of Kratos with the card.
pub(super) fn kratos(card: &str, pulls: &[Pull]) -> Input {
    let mut input = input("kratos_element.py", include_str!("kratos_element.py"), &json!({ "paths": paths(pulls) }));
    input.files.push(("film.json".to_owned(), card.to_owned()));
    input
}

/// The element of FElupe, whose materials are objects of Python.
pub(super) fn felupe(
    film: &Film<'_>,
    poisson: f64,
    system: System,
    pulls: &[Pull],
    losses: &mut Vec<Loss>,
) -> Result<Input, Refusal> {
    let refused = |law| Err(Refusal::NoLaw { target: "FElupe", law });
    let stress = system.stress();
    let elastic = |law: &Elastic| {
        // Lamé's constants.
        let mu = law.young / (2.0 + 2.0 * law.poisson) / stress;
        json!({ "name": "saint_venant_kirchhoff", "mu": mu, "lmbda": 2.0 * mu * law.poisson / (1.0 - 2.0 * law.poisson) })
    };
    let (law, bulk) = match &film.material.law {
        Law::Elastic(law) => (elastic(law), 0.0),
        Law::TensionField(field) => (elastic(&field.0), 0.0),
        Law::Hyperelastic(law) => {
            losses.push(Loss::Compressible { poisson });
            (rubber(law, stress)?, bulk_modulus(shear_modulus(law), poisson) / stress)
        }
        Law::Fabric(_) | Law::RateFabric(_) => return refused("fabric"),
        Law::Plastic(_) => return refused("plastic film"),
    };
    losses.extend(film.wrinkling().then_some(Loss::Wrinkling));
    losses.extend(film.lost_beside_the_law());
    let element = json!({ "law": law, "bulk": bulk, "paths": paths(pulls) });
    Ok(input("felupe_element.py", include_str!("felupe_element.py"), &element))
}

/// A function of `felupe.constitution.tensortrax.models.hyperelastic` and its arguments.
fn rubber(law: &HyperelasticLaw, stress: f64) -> Result<Value, Refusal> {
    let refused = |law| Err(Refusal::NoLaw { target: "FElupe", law });
    let polynomial = match law {
        HyperelasticLaw::Polynomial(film) => &film.energy,
        HyperelasticLaw::Ogden(_) => {
            // W = Σ 2μ/α² (…) there.
            let terms = ogden_terms(law).unwrap_or_default();
            let mu: Vec<f64> = terms.iter().map(|term| 0.5 * term.mu * term.alpha / stress).collect();
            let alpha: Vec<f64> = terms.iter().map(|term| term.alpha).collect();
            return Ok(json!({ "name": "ogden", "mu": mu, "alpha": alpha }));
        }
        HyperelasticLaw::Gent(_) => return refused("Gent's energy"),
        HyperelasticLaw::CompressibleNeoHookean(_) => return refused("compressible neo-Hookean film"),
    };
    let Polynomial { first, second } = polynomial;
    let [c10, c20, c30] = first.map(|c| c / stress);
    match (*second == 0.0, c20 == 0.0 && c30 == 0.0) {
        (true, true) => Ok(json!({ "name": "neo_hooke", "mu": 2.0 * c10 })),
        (true, false) => Ok(json!({ "name": "yeoh", "C10": c10, "C20": c20, "C30": c30 })),
        (false, true) => Ok(json!({ "name": "mooney_rivlin", "C10": c10, "C01": second / stress })),
        (false, false) => refused("Yeoh's energy with a term in I2"),
    }
}

/// Nominal stresses along and across of one test.
pub(super) fn read(text: &str, mode: Mode) -> Result<Vec<[f64; 2]>, String> {
    let mut lines = text.lines();
    if lines.next() != Some("path,stretch,along,across") {
        return Err("the first line does not name its columns".to_owned());
    }
    let mut rows = Vec::new();
    for line in lines {
        let mut cells = line.split(',');
        let is_of_mode = cells.next() == Some(mode.key());
        let values: Option<Vec<f64>> = cells.map(|cell| cell.parse().ok()).collect();
        match values.as_deref() {
            Some([_, along, across]) if is_of_mode => rows.push([*along, *across]),
            Some([_, _, _]) => {}
            _ => return Err(format!("`{line}` is not a path and three numbers")),
        }
    }
    Ok(rows)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_of_a_test_are_read() {
        let text = "path,stretch,along,across\nuniaxial,1.1,2.0,0\nplanar,1.1,3.0,1.5\nplanar,1.2,4.0,2.5\n";
        assert_eq!(read(text, Mode::Planar), Ok(vec![[3.0, 1.5], [4.0, 2.5]]));
        assert_eq!(read(text, Mode::Equibiaxial), Ok(vec![]));
        for bad in
            ["", "path\n", "path,stretch,along,across\nplanar,1.1\n", "path,stretch,along,across\nplanar,1,x,2\n"]
        {
            assert!(read(bad, Mode::Planar).is_err(), "{bad}");
        }
    }
}
