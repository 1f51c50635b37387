//! What a run refuses before its first step, found without running it.

use super::build;
use super::fault::RunError;
use super::mount;
use crate::mesh::{MeshError, Outline};
use crate::model::Model;
use crate::scenario::Document;
use base::diagnostic::Diagnostic;

/// Checks that the scene of `model`, which `document` was checked to be, can be mounted: as a run does, but for what
/// depends on the equilibrium of the film before the test.
///
/// # Errors
/// Why not, at its place.
pub fn check(document: &Document, model: &Model) -> Result<(), Vec<Diagnostic>> {
    let key = |place: usize, key: &str| {
        let is_list = document.find("impactor.0").is_some();
        if is_list { format!("impactor.{place}.{key}") } else { format!("impactor.{key}") }
    };
    let surfaces = model.impactors.iter().enumerate();
    let surfaces = surfaces.filter_map(|(place, impactor)| Some((place, mount::surface(&impactor.shape).err()?)));
    let mut mistakes: Vec<Diagnostic> =
        surfaces.map(|(place, error)| diagnostic(document, &key(place, "shape"), &error)).collect();
    if mistakes.is_empty() {
        mistakes.extend(refusal(model).map(|error| diagnostic(document, &place_of(&error, model, key), &error)));
    }
    if mistakes.is_empty() { Ok(()) } else { Err(mistakes) }
}

/// Why the scene cannot be mounted, if so.
fn refusal(model: &Model) -> Option<RunError> {
    let scene = match build::scene(model) {
        Ok(scene) => scene,
        Err(error) => return Some(error),
    };
    // Film that settles lifts bodies in contact with it, together.
    let overlap = scene.engine.overlap_of_impactors(|[a, b]| a.in_contact == b.in_contact)?;
    Some(RunError::of_overlap(model, overlap))
}

fn diagnostic(document: &Document, key: &str, error: &RunError) -> Diagnostic {
    let mistake = Diagnostic::new(error.to_string()).at(&document.span(key));
    Diagnostic { hint: error.hint(), ..mistake }
}

/// Path of the key that an error is about; `of` gives that of a key of an impactor.
fn place_of(error: &RunError, model: &Model, of: impl Fn(usize, &str) -> String) -> String {
    let named = |name: &str| model.impactors.iter().position(|impactor| impactor.words() == name).unwrap_or_default();
    match error {
        RunError::Mesh(MeshError::File { .. } | MeshError::Polygon(_) | MeshError::Outline { .. }) => {
            match model.specimen.shape {
                Outline::Mesh { .. } => "specimen.shape.mesh".to_owned(),
                _ => "specimen.shape".to_owned(),
            }
        }
        RunError::Mesh(MeshError::Size { .. } | MeshError::Growth { .. } | MeshError::TooMany { .. }) => {
            "specimen.mesh".to_owned()
        }
        RunError::FibreDirection(_) => "specimen.md_angle".to_owned(),
        RunError::Overlap { impactor, .. } | RunError::Below { impactor, .. } | RunError::InFrame { impactor, .. } => {
            of(*impactor, "position")
        }
        RunError::ImpactorsOverlap { names: [_, second], .. } => of(named(second), "position"),
        RunError::Missed => of(0, "position"),
        // Those of the impactors are known before.
        RunError::Surface(_) => "frame.bars.radius".to_owned(),
        RunError::ClampTooWeak { .. } => "frame.clamp.force".to_owned(),
        RunError::SpringTooShort { .. } => "frame.springs.length".to_owned(),
        RunError::SpringsUneven { .. } | RunError::SideWithoutSpring { .. } => "frame.springs.count".to_owned(),
        RunError::NoHeldEdge { .. } => "frame.hold".to_owned(),
        RunError::CutMisses { cut, .. } => format!("specimen.cuts.{cut}"),
        RunError::CutsPart { .. } | RunError::CutsFree { .. } => "specimen.cuts".to_owned(),
        RunError::FacesCross => "contact".to_owned(),
        RunError::StateMismatch(_) | RunError::Cancelled | RunError::Failure(_) => String::new(),
    }
}
