//! Cards of Kratos Multiphysics: one of the properties of its `StructuralMaterials.json`, for membrane elements.

use serde_json::json;

use super::film::Draft;
use base::diagnostic::Diagnostic;
use membrane::material::{Elastic, Law};

/// The card with its head.
pub(super) fn write(draft: &mut Draft<'_>) -> Result<String, Diagnostic> {
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
    let materials = json!({
        // Not read by Kratos: JSON has no comments.
        "droptower": super::head_of_card(draft),
        "properties": [{
            "model_part_name": "Structure",
            "properties_id": request.id,
            "Material": {
                "name": film.name,
                "constitutive_law": { "name": "LinearElasticPlaneStress2DLaw" },
                "Variables": {
                    "THICKNESS": film.material.thickness * f64::from(request.layers) / request.system.length(),
                    "DENSITY": draft.density(),
                    "YOUNG_MODULUS": draft.stress(*young),
                    "POISSON_RATIO": poisson,
                },
            },
        }],
    });
    Ok(format!("{materials:#}\n"))
}
