//! The checked scenario: SI values, complete, immutable.

mod depth;
mod checker;
mod exclusions;
mod frame;
mod meshing;
mod law;
mod impactor;
pub mod loading;
mod material;
mod reference;
mod specimen;
mod variation;
mod warning;

use std::io;
use std::path::{Path, PathBuf};

use checker::Checker;
use exclusions::Scene;
pub use exclusions::exclusions;
use serde::{Deserialize, Serialize};

use crate::mesh::{Meshing, Outline, Side};
use crate::scenario::{self, Document, Scenario};
pub use crate::scenario::{Air, Align, Clamp, Contact, Guide, Hinge, Solver, Springs, Symmetry, Window};
use base::diagnostic::{Diagnostic, shown_path};
use base::file::Digest;
use base::number::{duration, significant};
pub use loading::Loading;
use membrane::engine::GuideFriction;
use membrane::material::Material;
pub use meshing::{DETAIL_BYTES, SNAPSHOT_BYTES, SNAPSHOT_MEMORY};
pub use variation::{Factor, Input, Level, Point, Points, Values, Variation, distribution, variation};
pub use warning::{ABSORPTION_NOT_GIVEN, CODES, Warning, warnings};

/// Checks a scenario and converts it to SI values.
///
/// # Errors
/// All mistakes of the scenario, at once.
pub fn check(document: &Document) -> Result<Model, Vec<Diagnostic>> {
    checked(document, document.scenario(), model)
}

/// Checks a material file alone.
///
/// # Errors
/// All mistakes of the file, at once.
pub fn check_material(document: &Document) -> Result<Material, Vec<Diagnostic>> {
    checked(document, document.material(), |written, checker| material::check(written, "", checker))
}

/// The value of what is written in `document`, with the mistakes found in it so far; none of both alone.
fn checked<W, T>(
    document: &Document,
    (written, mistakes): (Option<W>, Vec<Diagnostic>),
    value: impl FnOnce(&W, &mut Checker<'_>) -> Option<T>,
) -> Result<T, Vec<Diagnostic>> {
    let mut checker = Checker::new(document, mistakes);
    match written.and_then(|written| value(&written, &mut checker)) {
        Some(value) if checker.found.0.is_empty() => Ok(value),
        _ => Err(checker.into_mistakes()),
    }
}

/// Every part is checked before the first missing one ends it.
fn model(scenario: &Scenario, checker: &mut Checker<'_>) -> Option<Model> {
    let name = checker.document.name();
    let specimen = specimen::check(&scenario.specimen, checker);
    // Ahead of the parts below, which may be refused or required by its kind.
    let loading = loading::check(scenario, checker);
    let hold = frame::check_hold(scenario, &loading, checker);
    let shape = specimen.as_ref().map(|specimen| &specimen.shape);
    let has_holes = matches!(shape, Some(Outline::Polygon(polygon)) if !polygon.holes.is_empty());
    let has_vent = checker.is_written("air.vent");
    let scene = Scene { scenario, loading: &loading, hold: &hold, has_holes, has_vent };
    let refused = checker.exclude("", &exclusions::scene(), &scene);
    let mut faces = specimen::check_faces(&scene, checker);
    let frame = frame::check(&scene, specimen.as_ref(), faces.as_deref(), &refused, checker);
    let air = frame::check_air(&scene, faces.as_deref(), checker);
    let impactors = impactor::check(scenario, &loading, checker);
    let first = impactors.as_deref().unwrap_or_default().first();
    let (all, graded) = (impactors.as_deref().unwrap_or_default(), faces.as_deref_mut().unwrap_or_default());
    meshing::check_grading(&scene, graded, all, shape, checker);
    // Here, as the guide that decides the speed is checked with the impactors, and these need the loading.
    let loading = loading.with_impactor(first);
    let scene = Scene { loading: &loading, ..scene };
    let mut output = reference::check_output(&scene, specimen.as_ref(), checker);
    let reference = reference::check(&scene, specimen.as_ref(), faces.as_deref(), checker);
    if let (Some(field), Some(specimen)) = (reference.as_ref().and_then(|known| known.field.as_ref()), &specimen) {
        output.motion = Some(reference::motion(field, loading.run_time(&specimen.shape)));
    }
    let post = reference::check_post(scenario, checker);
    let contact = frame::check_contact(&scene, faces.as_deref(), impactors.as_deref().unwrap_or_default(), checker);
    if let Some(written) = &scenario.variation {
        variation::check(written, checker);
    }
    let model = Model {
        title: scenario.title.clone().unwrap_or_else(|| name.clone()),
        name,
        specimen: specimen?,
        faces: faces?,
        frame,
        impactors: impactors?,
        loading,
        contact,
        air,
        solver: scenario.solver,
        output,
        reference,
        post,
    };
    // Last, since these ask about the whole.
    meshing::check_size(&model, checker);
    depth::check(&model, checker);
    Some(model)
}

/// Everything one simulation needs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Model {
    /// Path under `scenarios/` without extension, e.g. `drop/1008`.
    pub name: String,
    /// The name of the run on pages and plots.
    pub title: String,
    /// Outline, symmetry and damping of the film.
    pub specimen: Specimen,
    /// The faces of film, from the first that comes into contact to the last; at least one.
    pub faces: Vec<Face>,
    /// The mounting frame.
    pub frame: Frame,
    /// The impactors; at least one exactly where the loading needs them. Of several, each has a name.
    pub impactors: Vec<Impactor>,
    /// The loading.
    pub loading: Loading,
    /// Contact between faces.
    pub contact: Contact,
    /// The air around the film, where it is computed.
    pub air: Option<Air>,
    /// Time stepping.
    pub solver: Solver,
    /// Sampling and channel filter.
    pub output: Output,
    /// The recording that the run is compared with.
    pub reference: Option<Reference>,
    /// The Rhai script that adds to the summary.
    pub post: Option<PathBuf>,
}

impl Model {
    /// The meshes of the specimen and of the impactors.
    pub fn meshes(&self) -> Vec<MeshInput<'_>> {
        let specimen = match &self.specimen.shape {
            Outline::Mesh { path, scale } => Some(MeshInput { key: "specimen.shape.mesh".into(), path, scale: *scale }),
            _ => None,
        };
        let mut meshes: Vec<MeshInput<'_>> = specimen.into_iter().collect();
        for (place, impactor) in self.impactors.iter().enumerate() {
            let key =
                if self.impactors.len() > 1 { format!("impactor.{place}.shape") } else { "impactor.shape".into() };
            impactor.shape.meshes(&key, &mut meshes);
        }
        meshes
    }

    /// Whether a tear of its film takes a fracture energy, so that the film holds beside it.
    pub fn can_tear(&self) -> bool {
        let energy = |face: &Face| face.material.rupture.as_ref().map_or(0.0, |rupture| rupture.fracture_energy);
        self.faces.iter().any(|face| energy(face) > 0.0)
    }

    /// The first impactor.
    pub fn impactor(&self) -> Option<&Impactor> {
        self.impactors.first()
    }

    /// The beginning of the names of signals and figures of each impactor: of one nothing, of several their names and
    /// an underscore.
    pub fn prefixes(&self) -> Vec<String> {
        match self.impactors.as_slice() {
            [_] => vec![String::new()],
            several => several.iter().map(|impactor| format!("{}_", impactor.words())).collect(),
        }
    }

    /// The name of each impactor, where there are several.
    pub fn names(&self) -> Vec<Option<&str>> {
        let several = self.impactors.len() > 1;
        self.impactors.iter().map(|impactor| impactor.name.as_deref().filter(|_| several)).collect()
    }

    /// Name of the film in reports: that of all faces where they have one in common, else "film".
    pub fn film(&self) -> &str {
        let mut names = self.faces.iter().map(|face| face.film.as_deref());
        let first = names.next().flatten();
        first.filter(|_| names.all(|name| name == first)).unwrap_or("film")
    }
}

/// A mesh that a run reads.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshInput<'m> {
    /// Path of the key that names its file.
    pub key: String,
    /// The file.
    pub path: &'m Path,
    /// Length of one unit of its coordinates, m.
    pub scale: f64,
}

/// Outline of the film and the part of it that is computed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Specimen {
    /// Outline of the film.
    pub shape: Outline,
    /// Mirror planes.
    pub symmetry: Symmetry,
    /// Mass-proportional damping of the film, 1/s.
    pub damping: f64,
    /// Points of each cut through all faces, m.
    pub cuts: Vec<Vec<[f64; 2]>>,
}

/// One face of film: `layers` layers that act as one membrane.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Face {
    /// z of the undeformed face, m.
    pub height: f64,
    /// Number of layers.
    pub layers: u32,
    /// Name of the film in reports, e.g. "LLDPE".
    pub film: Option<String>,
    /// Material of one layer.
    pub material: Material,
    /// Whether its break strains are not those of its curves: `break_factor` moves them.
    pub break_is_moved: bool,
    /// Biaxial coupling of a fabric that does not tell its source; none of one that does, and of other film.
    pub unsourced_coupling: Option<f64>,
    /// Angle from the x axis to MD, rad; under a stretch it puts the direction of loading along x.
    pub md_angle: f64,
    /// Engineering pre-strain along MD and TD: the film's own length is the span / (1 + pre-strain).
    pub prestrain: [f64; 2],
    /// Kind and size of its elements.
    pub meshing: Meshing,
    /// Whether it is brought to equilibrium with its pre-strain and its weight before the test.
    pub settle: bool,
}

impl Face {
    /// Thickness of all of its layers, m.
    pub fn thickness(&self) -> f64 {
        self.material.thickness * f64::from(self.layers)
    }
}

/// The mounting frame.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Frame {
    /// Edges that it clamps.
    pub hold: Hold,
    /// Bars along these edges.
    pub bars: Option<Bars>,
    /// The clamp, where film may slip in it.
    pub clamp: Option<Clamp>,
    /// The springs on which film hangs; `None` where its held edges are fixed.
    pub springs: Option<Springs>,
}

/// Bars along the held edges of film: below a single face; between two faces as high as these are apart.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Bars {
    /// Radius over which film bends, m.
    pub radius: f64,
    /// Coulomb coefficient between bars and film.
    pub friction: f64,
}

/// Clamped edges.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Hold {
    /// All edges.
    All,
    /// Sides of a rectangle.
    Sides(Vec<Side>),
    /// No edge.
    None,
}

/// The rigid body that comes into contact with the film.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Impactor {
    /// Its name; every one of several has one.
    pub name: Option<String>,
    /// Its surface.
    pub shape: ImpactorShape,
    /// kg; infinite where its motion is prescribed.
    pub mass: f64,
    /// Its degrees of freedom.
    pub guide: Guide,
    /// Friction of its guide; none for a free one.
    pub guide_friction: GuideFriction,
    /// Coulomb coefficient between impactor and film.
    pub friction: f64,
    /// Coefficient of restitution against other impactors, of which a pair has the smaller.
    pub restitution: f64,
    /// When it is released, s; until then it is held and touches nothing.
    pub release: f64,
    /// Moments of inertia about its own x, y and z, kg m²; those of a homogeneous body where there are none.
    pub inertia: Option<[f64; 3]>,
    /// Position of its centre of mass at the start: x, y in m.
    pub position: [f64; 2],
    /// Height of its centre of mass at the start, m; none where it starts in contact.
    pub height: Option<f64>,
    /// Rotation at the start from the upright position: an axis times an angle, rad.
    pub orientation: [f64; 3],
    /// Velocity of its centre of mass at the start, m/s.
    pub velocity: [f64; 3],
    /// Angular velocity at the start, rad/s.
    pub spin: [f64; 3],
}

impl Impactor {
    /// Its name in texts.
    pub fn words(&self) -> &str {
        self.name.as_deref().unwrap_or("impactor")
    }

    /// Whether it does not move along z alone.
    pub fn is_spatial(&self) -> bool {
        matches!(self.guide, Guide::Free | Guide::Line(_) | Guide::Hinge(_))
    }
}

/// Shape of the impactor, lengths in m; its axis is z, its tip points down.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum ImpactorShape {
    /// A ball.
    Sphere {
        /// Its radius.
        radius: f64,
    },
    /// A cylindrical shaft of this length with a hemispherical tip, and another one above.
    Hemisphere {
        /// Radius of tip and shaft.
        radius: f64,
        /// Length of the shaft.
        length: f64,
    },
    /// The shape of [`Hemisphere`](Self::Hemisphere) under its other name, with a given length.
    Capsule {
        /// Radius of shaft and ends.
        radius: f64,
        /// Length of the shaft.
        length: f64,
    },
    /// A flat-ended cylinder, axis along z.
    Cylinder {
        /// Radius of the flat end.
        radius: f64,
        /// Length along z.
        length: f64,
        /// Radius of its edges.
        edge: f64,
    },
    /// A cone with its tip down.
    Cone {
        /// Radius of the flat end.
        radius: f64,
        /// Length along z, with a sharp tip.
        length: f64,
        /// Radius of tip and edge.
        edge: f64,
    },
    /// A box.
    Box {
        /// Lengths along x, y and z.
        size: [f64; 3],
        /// Radius of its edges.
        edge: f64,
    },
    /// A closed surface from STL or OBJ.
    Mesh {
        /// The file.
        path: PathBuf,
        /// Length of one unit of its coordinates, m.
        scale: f64,
    },
    /// Parts of one density.
    Compound(Vec<Part>),
}

impl ImpactorShape {
    /// Adds the meshes of the shape, whose table has the key path `key`, to `meshes`.
    fn meshes<'m>(&'m self, key: &str, meshes: &mut Vec<MeshInput<'m>>) {
        match self {
            ImpactorShape::Mesh { path, scale } => {
                meshes.push(MeshInput { key: format!("{key}.mesh"), path, scale: *scale });
            }
            ImpactorShape::Compound(parts) => {
                for (place, part) in parts.iter().enumerate() {
                    part.shape.meshes(&format!("{key}.compound.{place}.shape"), meshes);
                }
            }
            _ => {}
        }
    }
}

/// A part of a compound body.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Part {
    /// Its shape, no compound.
    pub shape: ImpactorShape,
    /// Position of its own origin in the body, m.
    pub at: [f64; 3],
    /// Rotation about that point: an axis times an angle, rad.
    pub orientation: [f64; 3],
}

/// The signals and snapshots that a run records.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Output {
    /// Samples per second, Hz.
    pub sample_rate: f64,
    /// Number of snapshots for the recording.
    pub frames: usize,
    /// SAE J211 channel frequency class; `None` leaves the filtered channel equal to the raw one.
    pub filter: Option<f64>,
    /// The motion of a face that is recorded for the comparison with a field.
    pub motion: Option<Motion>,
}

/// Times at which the positions of all nodes of a face are recorded.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Motion {
    /// Index of the face.
    pub face: usize,
    /// Ascending, s.
    pub times: Vec<f64>,
}

/// What the run is compared with, measured or virtual: signals, a displacement field, or both.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Reference {
    /// Its keys as written, without `impactor`, `signals` and `field`, which are below. Postcard writes them, but cannot read a
    /// window: `decisive` leaves the reference out of what checkpoints hold.
    pub written: scenario::Reference,
    /// Index of the impactor that it was recorded of.
    pub impactor: usize,
    /// Signals from first contact on (`time_s` with `acceleration_m_s2` and/or `displacement_m`), or a raw recording.
    pub signals: Option<PathBuf>,
    /// Displacement field of a face.
    pub field: Option<FieldReference>,
}

impl Reference {
    /// All of its files, that of the signals first.
    pub fn files(&self) -> impl Iterator<Item = &PathBuf> {
        self.signals.iter().chain(self.field.iter().flat_map(|field| &field.files))
    }
}

/// A displacement field over time.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FieldReference {
    /// Its files in their order.
    pub files: Vec<PathBuf>,
    /// The time of each, s.
    pub times: Vec<f64>,
    /// Length of one unit where a file states none, m.
    pub unit: Option<f64>,
    /// Index of the face that was measured.
    pub face: usize,
    /// How it is brought into the axes of the run.
    pub align: Align,
}

impl Impactor {
    /// The impactor and its motion: `sphere 10.72 kg at 4.16 m/s`.
    pub fn in_words(&self) -> String {
        let (body, mass) = (self.body(), significant(self.mass, 4));
        let speed = self.velocity.iter().map(|v| v * v).sum::<f64>().sqrt();
        let at = if self.release > 0.0 { format!(" from {}", duration(self.release)) } else { String::new() };
        match self.guide {
            Guide::Fixed => format!("fixed {body}"),
            Guide::Hinge(_) => format!("{body} {mass} kg on a hinge{at}"),
            _ => format!("{body} {mass} kg at {} m/s{at}", significant(speed, 3)),
        }
    }

    /// The name of its shape.
    pub fn body(&self) -> &'static str {
        match self.shape {
            ImpactorShape::Sphere { .. } => "sphere",
            ImpactorShape::Hemisphere { .. } => "hemisphere",
            ImpactorShape::Capsule { .. } => "capsule",
            ImpactorShape::Cylinder { .. } => "cylinder",
            ImpactorShape::Cone { .. } => "cone",
            ImpactorShape::Box { .. } => "box",
            ImpactorShape::Mesh { .. } | ImpactorShape::Compound(_) => "body",
        }
    }
}

impl Model {
    /// Its layers: `2 x 8 layers of LLDPE` where all faces are alike, else `8 + 9 layers of LLDPE`.
    pub fn layers_in_words(&self) -> String {
        let counts: Vec<u32> = self.faces.iter().map(|face| face.layers).collect();
        let layers = match counts.as_slice() {
            [1] => "1 layer".into(),
            [count] => format!("{count} layers"),
            [first, rest @ ..] if rest.iter().all(|count| count == first) => {
                format!("{} x {first} layer{}", counts.len(), if *first == 1 { "" } else { "s" })
            }
            _ => {
                let counts: Vec<String> = counts.iter().map(u32::to_string).collect();
                format!("{} layers", counts.join(" + "))
            }
        };
        format!("{layers} of {}", self.film())
    }
}

/// The identity of a run, equal where its bits are: the checked model without its name, its paths and what is read
/// after the run, and the content of its meshes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Identity {
    model: Model,
    /// The files of its meshes, specimen first.
    meshes: Vec<Digest>,
}

impl Identity {
    /// The identity of the runs of `model`.
    ///
    /// # Errors
    /// A mesh cannot be read.
    pub fn from_model(model: &Model) -> io::Result<Identity> {
        let meshes = model.meshes().into_iter().map(|mesh| digest(mesh.path)).collect::<io::Result<_>>()?;
        Ok(Identity { model: decisive(model), meshes })
    }
}

fn digest(path: &Path) -> io::Result<Digest> {
    Digest::of_file(path).map_err(|error| io::Error::other(format!("{}: {error}", shown_path(path))))
}

/// The model without what does not determine the bits of its run: its name, the paths of its meshes, and what is read
/// after the run.
fn decisive(model: &Model) -> Model {
    let mut model = Model { name: String::new(), title: String::new(), reference: None, post: None, ..model.clone() };
    if let Outline::Mesh { path, .. } = &mut model.specimen.shape {
        *path = PathBuf::new();
    }
    model.impactors.iter_mut().for_each(|impactor| without_paths(&mut impactor.shape));
    model
}

fn without_paths(shape: &mut ImpactorShape) {
    match shape {
        ImpactorShape::Mesh { path, .. } => *path = PathBuf::new(),
        ImpactorShape::Compound(parts) => parts.iter_mut().for_each(|part| without_paths(&mut part.shape)),
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mesh_is_compared_by_what_its_file_holds() {
        let folder = tempfile::tempdir().unwrap();
        let [path, moved] = ["a.stl", "b.stl"].map(|name| folder.path().join(name));
        std::fs::write(&path, "solid film").unwrap();
        let before = digest(&path).unwrap();
        std::fs::rename(&path, &moved).unwrap();
        assert_eq!(digest(&moved).unwrap(), before);
        std::fs::write(&moved, "solid Film").unwrap();
        assert_ne!(digest(&moved).unwrap(), before);
        assert!(digest(&path).is_err());
    }
}
