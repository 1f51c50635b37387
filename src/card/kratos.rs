//! Cards of Kratos Multiphysics: one of the properties of its `StructuralMaterials.json`, for membrane elements.

use serde::Serialize;

use super::film::{Draft, Refusal};
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

/// The card with its head.
pub(super) fn write(draft: &mut Draft<'_>) -> Result<String, Refusal> {
    let (film, request) = (draft.film, draft.request);
    let law = &film.material.law;
    let Elastic { young, poisson } = draft.linear(law).ok_or_else(|| {
        request.no_law(match law {
            Law::Hyperelastic(_) => "rubber-like film",
            Law::Plastic(_) => "plastic film",
            _ => "fabric",
        })
    })?;
    draft.lose_beside_the_law();
    let variables = Variables {
        thickness: film.material.thickness * f64::from(request.layers) / request.system.length(),
        density: draft.density(),
        young_modulus: draft.stress(*young),
        poisson_ratio: *poisson,
    };
    let constitutive_law = ConstitutiveLaw { name: "LinearElasticPlaneStress2DLaw" };
    let material = Substance { name: film.name.to_owned(), constitutive_law, variables };
    let properties = [Properties { model_part_name: "Structure", properties_id: request.id, material }];
    let text = serde_json::to_string_pretty(&Materials { droptower: super::head(draft), properties });
    Ok(text.expect("numbers and texts") + "\n")
}
