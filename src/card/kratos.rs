//! Cards of Kratos Multiphysics: one of the properties of its `StructuralMaterials.json`, for membrane elements.

use serde::Serialize;

use super::film::{Film, Refusal, Request};
use super::loss::Loss;
use membrane::material::{Elastic, Law};

#[derive(Serialize)]
struct Materials {
    /// Not read by Kratos: JSON has no comments.
    droptower: Vec<String>,
    properties: [Properties; 1],
}

#[derive(Serialize)]
struct Properties {
    model_part_name: &'static str,
    properties_id: u32,
    #[serde(rename = "Material")]
    material: Substance,
}

#[derive(Serialize)]
struct Substance {
    name: String,
    constitutive_law: ConstitutiveLaw,
    #[serde(rename = "Variables")]
    variables: Variables,
}

#[derive(Serialize)]
struct ConstitutiveLaw {
    name: &'static str,
}

#[derive(Serialize)]
#[serde(rename_all = "SCREAMING_SNAKE_CASE")]
struct Variables {
    thickness: f64,
    density: f64,
    young_modulus: f64,
    poisson_ratio: f64,
}

/// The card with its `head`.
pub(super) fn write(
    film: &Film<'_>,
    request: &Request,
    losses: &mut Vec<Loss>,
) -> Result<impl FnOnce(Vec<String>) -> String + use<>, Refusal> {
    let elastic = match &film.material.law {
        Law::Elastic(law) => law.clone(),
        Law::TensionField(field) => {
            losses.push(Loss::Wrinkling);
            field.0.clone()
        }
        Law::Hyperelastic(_) => return Err(request.no_law("rubber-like film")),
        Law::Fabric(_) | Law::RateFabric(_) => return Err(request.no_law("fabric")),
        Law::Plastic(_) => return Err(request.no_law("plastic film")),
    };
    losses.extend(film.lost_beside_the_law());
    let Elastic { young, poisson } = elastic;
    let system = request.system;
    let variables = Variables {
        thickness: film.material.thickness * f64::from(request.layers) / system.length(),
        density: film.material.density / system.density(),
        young_modulus: young / system.stress(),
        poisson_ratio: poisson,
    };
    let constitutive_law = ConstitutiveLaw { name: "LinearElasticPlaneStress2DLaw" };
    let material = Substance { name: film.name.to_owned(), constitutive_law, variables };
    let properties = [Properties { model_part_name: "Structure", properties_id: request.id, material }];
    Ok(move |droptower| {
        let text = serde_json::to_string_pretty(&Materials { droptower, properties });
        text.expect("numbers and texts") + "\n"
    })
}
