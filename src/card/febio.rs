//! Cards of FEBio: a `<material>` of its feb files, for shells, since its elastic membrane has no such law. Names and constants are
//! those of its sources (`FEBioMech/FEOgdenMaterial.cpp`, `FEUncoupledViscoElasticMaterial.cpp`).

use super::film::{Draft, Terms, bulk_modulus, shear_modulus};
use super::layout::whole;
use super::loss::Loss;
use base::diagnostic::Diagnostic;
use membrane::material::{Elastic, HyperelasticLaw, Law};

/// Terms of Ogden's law, and of a Prony series.
const TERMS: usize = 6;

/// The card without its head.
pub(super) fn write(draft: &mut Draft<'_>) -> Result<String, Diagnostic> {
    draft.lose_rupture_and_heat();
    let law = &draft.film.material.law;
    match (draft.linear(law), law) {
        (Some(elastic), _) => Ok(isotropic(draft, elastic)),
        (None, Law::Hyperelastic(law)) => rubber(draft, law),
        (None, Law::Plastic(_)) => Err(draft.request.no_law("plastic film")),
        (None, _) => Err(draft.request.no_law("fabric")),
    }
}

fn element(name: &str, value: f64, indent: usize) -> String {
    format!("{:indent$}<{name}>{}</{name}>\n", "", whole(value))
}

fn material(draft: &Draft<'_>, kind: &str, content: &str) -> String {
    let name: String = draft.film.name.chars().map(|c| if "<>&\"".contains(c) { '_' } else { c }).collect();
    let density = element("density", draft.density(), 2);
    let id = draft.request.id;
    format!("<material id=\"{id}\" name=\"{name}\" type=\"{kind}\">\n{density}{content}</material>\n")
}

/// St. Venant–Kirchhoff, as here: linear in Green's strain.
fn isotropic(draft: &mut Draft<'_>, law: &Elastic) -> String {
    draft.losses.extend(draft.film.material.viscosity.as_ref().map(|_| Loss::Viscosity));
    let content = element("E", draft.stress(law.young), 2) + &element("v", law.poisson, 2);
    material(draft, "isotropic elastic", &content)
}

fn rubber(draft: &mut Draft<'_>, law: &HyperelasticLaw) -> Result<String, Diagnostic> {
    let request = draft.request;
    let terms = request.ogden(law, TERMS)?;
    draft.lose_of_rubber(law);
    let viscosity = draft.film.material.viscosity.as_ref();
    let instant = viscosity.map_or(1.0, |viscosity| viscosity.instant());
    let stress = request.system.stress() / instant;
    let constants = |indent: usize| {
        // W = Σ c/m² (…) there.
        let pair = |(place, term): (usize, &membrane::material::OgdenTerm)| {
            let number = place + 1;
            element(&format!("c{number}"), term.mu * term.alpha / stress, indent)
                + &element(&format!("m{number}"), term.alpha, indent)
        };
        let bulk = element("k", bulk_modulus(shear_modulus(law), request.poisson_of(law)) / stress, indent);
        terms.iter().enumerate().map(pair).collect::<String>() + &bulk
    };
    let Some(viscosity) = viscosity else {
        return Ok(material(draft, "Ogden", &constants(2)));
    };
    request.at_most(TERMS, viscosity.terms().len(), Terms::Prony)?;
    let mut content = element("g0", viscosity.long_term(), 2);
    for (place, term) in viscosity.terms().iter().enumerate() {
        let number = place + 1;
        content += &element(&format!("g{number}"), term.share, 2);
        content += &element(&format!("t{number}"), term.time / request.system.time(), 2);
    }
    content += &format!("  <elastic type=\"Ogden\">\n{}  </elastic>\n", constants(4));
    Ok(material(draft, "uncoupled viscoelastic", &content))
}
