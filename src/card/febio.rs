//! Cards of FEBio: a `<material>` of its feb files, for shells, since its elastic membrane has no such law.

use super::film::{Film, Refusal, Request, bulk_modulus, shear_modulus};
use super::layout::whole;
use super::loss::Loss;
use membrane::material::{Elastic, HyperelasticLaw, Law};

/// Terms of Ogden's law, and of a Prony series.
const TERMS: usize = 6;

/// The card without its head.
pub(super) fn write(film: &Film<'_>, request: &Request, losses: &mut Vec<Loss>) -> Result<String, Refusal> {
    losses.extend(film.lost_to_rupture_and_heat());
    match &film.material.law {
        Law::Elastic(law) => Ok(isotropic(film, law, request, losses)),
        Law::TensionField(field) => {
            losses.push(Loss::Wrinkling);
            Ok(isotropic(film, &field.0, request, losses))
        }
        Law::Hyperelastic(law) => rubber(film, law, request, losses),
        Law::Fabric(_) | Law::RateFabric(_) => Err(request.no_law("fabric")),
        Law::Plastic(_) => Err(request.no_law("plastic film")),
    }
}

fn element(name: &str, value: f64, indent: usize) -> String {
    format!("{:indent$}<{name}>{}</{name}>\n", "", whole(value))
}

fn material(film: &Film<'_>, request: &Request, kind: &str, content: &str) -> String {
    let name: String = film.name.chars().map(|c| if "<>&\"".contains(c) { '_' } else { c }).collect();
    format!("<material id=\"{}\" name=\"{name}\" type=\"{kind}\">\n{content}</material>\n", request.id)
}

/// St. Venant–Kirchhoff, as here: linear in Green's strain.
fn isotropic(film: &Film<'_>, law: &Elastic, request: &Request, losses: &mut Vec<Loss>) -> String {
    losses.extend(film.material.viscosity.as_ref().map(|_| Loss::Viscosity));
    let content = element("density", film.material.density / request.system.density(), 2)
        + &element("E", law.young / request.system.stress(), 2)
        + &element("v", law.poisson, 2);
    material(film, request, "isotropic elastic", &content)
}

fn rubber(
    film: &Film<'_>,
    law: &HyperelasticLaw,
    request: &Request,
    losses: &mut Vec<Loss>,
) -> Result<String, Refusal> {
    let terms = request.ogden(law, TERMS)?;
    losses.push(Loss::Compressible { poisson: request.poisson_of(law) });
    losses.extend(film.wrinkling().then_some(Loss::Wrinkling));
    let viscosity = film.material.viscosity.as_ref();
    let instant = viscosity.map_or(1.0, |viscosity| viscosity.instant());
    let stress = request.system.stress() / instant;
    let density = film.material.density / request.system.density();
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
    let density = element("density", density, 2);
    let Some(viscosity) = viscosity else {
        return Ok(material(film, request, "Ogden", &(density + &constants(2))));
    };
    request.at_most(TERMS, viscosity.terms().len())?;
    let mut content = density + &element("g0", viscosity.long_term(), 2);
    for (place, term) in viscosity.terms().iter().enumerate() {
        let number = place + 1;
        content += &element(&format!("g{number}"), term.share, 2);
        content += &element(&format!("t{number}"), term.time / request.system.time(), 2);
    }
    content += &format!("  <elastic type=\"Ogden\">\n{}  </elastic>\n", constants(4));
    Ok(material(film, request, "uncoupled viscoelastic", &content))
}
