//! Where the elements of a face are small, and the memory that a run needs, checked before anything is allocated.

use std::f64::consts::PI;
use std::fs;
use std::path::Path;

use super::exclusions::Scene;
use super::loading::{Impact, Impactors};
use super::{Checker, Face, Guide, Impactor, ImpactorShape, Loading, Model, Warning};
use crate::mesh::{Element, Grading, Outline, Zone, import};
use crate::scenario::{Around, Implausible, Meshing, Shape};
use base::number::{grouped, rounded, significant};

/// Growth of elements where it is not given: from one element to the next of half its size within two of the latter.
const GROWTH: f64 = 0.25;

/// Adds the grading of their elements to `faces`; none stays as it is where the keys of it are mistaken.
pub(super) fn check_grading(
    scene: &Scene<'_>,
    faces: &mut [Face],
    impactors: &[Impactor],
    shape: Option<&Outline>,
    checker: &mut Checker<'_>,
) {
    let Scene { scenario, loading, .. } = *scene;
    let shared = &scenario.specimen.mesh;
    for (place, face) in faces.iter_mut().enumerate() {
        let written = scenario.layer.get(place).map_or(shared.clone(), |layer| layer.mesh.over(shared));
        let key = |checker: &Checker<'_>, key: &str| checker.document.face_key(place, &format!("mesh.{key}"));
        let Some(fine) = written.fine.map(|fine| fine.0) else {
            for path in ["around", "within", "growth"].map(|name| key(checker, name)) {
                if checker.is_written(&path) {
                    checker.out_of_place(&path, "`fine` is the edge length there");
                }
            }
            continue;
        };
        let path = key(checker, "fine");
        if matches!(scenario.specimen.shape, Shape::Mesh(_)) {
            checker.out_of_place(&path, "an imported mesh has its own element sizes");
            continue;
        }
        if fine >= face.meshing.size {
            checker.report_with(&path, "`fine` is not smaller than `size`", "leave it out where all have one size");
            checker.label(&key(checker, "size"), "the largest edge length");
            continue;
        }
        let path = if written.around.is_some() { key(checker, "around") } else { path };
        let Some(zones) = zones(&written, &path, loading, face.height, impactors, checker) else { continue };
        let grading = Grading { fine, growth: written.growth.unwrap_or(GROWTH), zones };
        let beside = |zone: &Zone| {
            let distance = shape.and_then(|shape| shape.distance(zone.at));
            distance
                .is_some_and(|distance| grading.size_at(distance - zone.within, face.meshing.size) >= face.meshing.size)
        };
        if !grading.zones.is_empty() && grading.zones.iter().all(beside) {
            let hint = "give a place on the film: x and y are measured from its origin";
            checker.report_with(&path, "no element of the film becomes finer: this place lies beside it", hint);
            continue;
        }
        face.meshing.grading = Some(grading);
    }
}

/// Where elements are fine as `written`, around a point or where each impactor meets the film; a mistake is at `path`.
fn zones(
    written: &Meshing,
    path: &str,
    loading: &Loading,
    height: f64,
    impactors: &[Impactor],
    checker: &mut Checker<'_>,
) -> Option<Vec<Zone>> {
    let within = written.within.map(|within| within.0);
    if let Some(Around::Point(point)) = written.around {
        return Some(vec![Zone { at: point.map(|length| length.0), within: within.unwrap_or(0.0) }]);
    }
    let hint = "give a point: `around = [\"0 mm\", \"0 mm\"]`";
    if loading.impactors() == Impactors::None {
        return checker.refuse(path, "this loading has no impactor around which elements could be fine", hint);
    }
    // A missing impactor is a mistake of its own.
    if impactors.is_empty() {
        return None;
    }
    if impactors.iter().any(|impactor| matches!(impactor.guide, Guide::Hinge(_))) {
        return checker.refuse(path, "where an impactor on a hinge meets the film is not known", hint);
    }
    let zone = |impactor: &Impactor| {
        let radius = footprint(&impactor.shape, impactor.orientation != [0.0; 3])?;
        Some(Zone { at: impactor.meeting_point(loading, height, radius), within: within.unwrap_or(radius) })
    };
    impactors.iter().map(zone).collect()
}

impl Impactor {
    /// Where its centre is over the plane at `height` (m) when it is `radius` (m) above it, in free flight or on its line; x
    /// and y in m.
    fn meeting_point(&self, loading: &Loading, height: f64, radius: f64) -> [f64; 2] {
        let Some(Impact { gravity, .. }) = loading.impact() else { return self.position };
        let Some(fall) = self.height.map(|start| start - height - radius).filter(|fall| *fall > 0.0) else {
            return self.position;
        };
        let (along, times) = match self.guide {
            Guide::Line(line) => (line, -fall / line[2]),
            _ => {
                let [.., z] = self.velocity;
                let speed = (z * z + 2.0 * gravity * fall).sqrt();
                // Time of the fall, from 2 fall = (initial + final speed) time.
                (self.velocity, 2.0 * fall / (speed - z))
            }
        };
        let drift = if times.is_finite() { [along[0] * times, along[1] * times] } else { [0.0; 2] };
        [self.position[0] + drift[0], self.position[1] + drift[1]]
    }
}

/// Largest distance of the surface from the body's own axis, or from its centre where it is inclined, m; none where its
/// mesh cannot be read, which is a mistake of its own.
fn footprint(shape: &ImpactorShape, inclined: bool) -> Option<f64> {
    let of_axis = |radius: f64, half: f64| if inclined { radius.hypot(half) } else { radius };
    Some(match shape {
        ImpactorShape::Sphere { radius } => *radius,
        ImpactorShape::Hemisphere { radius, .. } | ImpactorShape::Capsule { radius, .. } => *radius,
        ImpactorShape::Cylinder { radius, length, .. } | ImpactorShape::Cone { radius, length, .. } => {
            of_axis(*radius, 0.5 * length)
        }
        ImpactorShape::Box { size: [x, y, z], .. } => of_axis(0.5 * x.hypot(*y), 0.5 * z),
        ImpactorShape::Mesh { path, scale } => 0.5 * scale * import::extent(path).ok()?,
        ImpactorShape::Compound(parts) => {
            let reach = |part: &super::Part| {
                let is_inclined = inclined || part.orientation != [0.0; 3];
                let [x, y, z] = part.at;
                let away = of_axis(x.hypot(y), z);
                Some(away + footprint(&part.shape, is_inclined)?)
            };
            parts.iter().map(reach).collect::<Option<Vec<f64>>>()?.into_iter().fold(0.0, f64::max)
        }
    })
}

/// Most memory of the film of a run, bytes. The bound is the same on every machine: a film finer than this is a mistake
/// in the unit of `specimen.mesh.size`.
const MOST_MEMORY: f64 = 4e9;
/// One sample: about 20 channels as numbers, as text of a CSV, and once more while that is written; bytes.
const PER_SAMPLE: f64 = 20.0 * 8.0 * 3.0;
/// Bytes of one element and its share of the nodes in a binary STL file. Text files have more, so that the estimate is
/// conservative.
const FILE_PER_ELEMENT: f64 = 50.0;
/// Largest mesh file that is read, bytes.
const LONGEST_FILE: f64 = 1e9;
/// Elements of a graded mesh, whose sizes step by factors of two, over the squares of the wanted sizes; at most.
const GRADED: f64 = 2.0;
/// Memory of a snapshot, bytes an element: positions of a node, strains of an element.
pub const SNAPSHOT_BYTES: f64 = 12.0 + 13.0;
/// Further memory of a snapshot with its detail, bytes an element: velocity of a node; stresses, largest strains,
/// layers left, thickness and fibres of an element.
pub const DETAIL_BYTES: f64 = 12.0 + 56.0;
/// Displacement of a node at one time of a recorded motion, bytes.
const MOTION_BYTES: f64 = 12.0;
/// Memory that the snapshots of a run may take, bytes; fewer are taken of a finer mesh.
pub const SNAPSHOT_MEMORY: f64 = 4e8;

/// Refuses runs that do not fit into memory and elements larger than the film.
pub fn check_size(model: &Model, checker: &mut Checker<'_>) {
    files(model, checker);
    let (mut total, mut film, mut memory) = (0.0, 0.0, 0.0);
    for (place, face) in model.faces.iter().enumerate() {
        let path = mesh_path(model, place, checker);
        if face.meshing.size > largest_side(&model.specimen.shape) {
            let message = "an element is larger than the film";
            checker.report_with(&path, message, "a bare number is in m");
            return;
        }
        let elements = elements(model, face);
        total += elements;
        film += elements * per_element(face.meshing.element);
        memory = film + (total * SNAPSHOT_BYTES * model.output.frames as f64).min(SNAPSHOT_MEMORY);
        if memory > MOST_MEMORY {
            let message = format!(
                "the mesh is too large for memory: {} elements need about {} GB",
                grouped(rounded(total, 3) as u64),
                significant(memory * 1e-9, 2)
            );
            let fit = total * (MOST_MEMORY - (memory - film)).max(0.0) / film;
            too_large(&path, message, fit, checker);
            return;
        }
    }
    if checker.found.0.is_empty() {
        samples(model, memory + motion(model, memory, checker), checker);
    }
}

/// Reports a mesh that is too large, of whose elements so many `fit`, at the sizes that are implausible where there are any: they
/// are its cause.
fn too_large(path: &str, message: String, fit: f64, checker: &mut Checker<'_>) {
    let is_size = |value: &Implausible| value.key.starts_with("specimen.shape.") || value.key.ends_with("mesh.size");
    let sizes: Vec<Implausible> = checker.document.implausible().into_iter().filter(is_size).collect();
    let fit = grouped(rounded(fit, 2) as u64);
    let hint = format!("a run may take {} GB: about {fit} such elements", MOST_MEMORY / 1e9);
    if sizes.is_empty() {
        return checker.report_with(path, message, hint);
    }
    for size in sizes {
        let key = size.key.clone();
        checker.report_with(&key, Warning::Value(size).to_string(), format!("{message}; {hint}"));
    }
}

/// Refuses mesh files that are too large to be read.
fn files(model: &Model, checker: &mut Checker<'_>) {
    for mesh in model.meshes() {
        let length = length(mesh.path);
        if length > LONGEST_FILE {
            let message = format!("the mesh file is too long: {:.1} GB", length / 1e9);
            checker.report_with(&mesh.key, message, format!("at most {} GB are read", LONGEST_FILE / 1e9));
        }
    }
}

/// Memory of the recorded motion of a face, bytes; refused where it does not fit beside the rest.
fn motion(model: &Model, rest: f64, checker: &mut Checker<'_>) -> f64 {
    let Some(motion) = &model.output.motion else { return 0.0 };
    let nodes = model.faces.get(motion.face).map_or(0.0, |face| elements(model, face));
    let memory = motion.times.len() as f64 * nodes * MOTION_BYTES;
    if rest + memory > MOST_MEMORY {
        let message = format!("the film at {} times needs about {:.1} GB of memory", motion.times.len(), memory / 1e9);
        let hint = format!("a run may take {} GB: leave files out", MOST_MEMORY / 1e9);
        checker.report_with("reference.field.times", message, hint);
    }
    memory
}

/// Refuses recordings that do not fit into memory beside the `film`, bytes.
fn samples(model: &Model, film: f64, checker: &mut Checker<'_>) {
    let samples = model.run_time() * model.output.sample_rate;
    let memory = film + samples * PER_SAMPLE;
    if memory > MOST_MEMORY {
        let message = format!("{samples:.2e} samples and the film need about {:.1} GB of memory", memory / 1e9);
        checker.report_with("output.sample_rate", message, format!("a run may take {} GB", MOST_MEMORY / 1e9));
    }
}

/// Key path of the element size of a face.
fn mesh_path(model: &Model, place: usize, checker: &Checker<'_>) -> String {
    match model.specimen.shape {
        Outline::Mesh { .. } => "specimen.shape.mesh".to_owned(),
        _ => checker.document.face_key(place, "mesh.size"),
    }
}

/// Bytes of a file; zero where it cannot be read, which is a mistake of its own.
fn length(path: &Path) -> f64 {
    fs::metadata(path).map_or(0.0, |file| file.len() as f64)
}

fn largest_side(shape: &Outline) -> f64 {
    match shape {
        Outline::Rectangle { x, y } => x.max(*y),
        Outline::Circle { radius } => 2.0 * radius,
        Outline::Polygon(polygon) => polygon.extent(),
        Outline::Mesh { .. } => f64::INFINITY,
    }
}

/// Memory that a run takes for one element with its share of the nodes, of contact and of observers, bytes: the
/// resident memory of a million elements with two snapshots over their number, and a little more. The engine's own
/// arrays are two thirds of it.
fn per_element(element: Element) -> f64 {
    match element {
        Element::Quad4 => 500.0,
        Element::Quad4Full => 800.0,
        Element::Tri3 => 350.0,
    }
}

/// Elements of one face; those of an imported mesh are estimated from the length of its file.
fn elements(model: &Model, face: &Face) -> f64 {
    let (size, copies) = (face.meshing.size, model.specimen.symmetry.copies());
    let triangles = if face.meshing.element == Element::Tri3 { 2.0 } else { 1.0 };
    if let (Some(grading), Some(area)) = (&face.meshing.grading, model.specimen.shape.area()) {
        let is_computed_part = matches!(model.specimen.shape, Outline::Polygon(_));
        let parts = if is_computed_part { 1.0 } else { copies };
        return GRADED * triangles * grading.cells(area, size) / parts;
    }
    let whole = match &model.specimen.shape {
        Outline::Mesh { path, .. } => return length(path) / FILE_PER_ELEMENT,
        _ if size <= 0.0 => return 0.0, // the range was checked before
        Outline::Rectangle { x, y } => (x / size).ceil() * (y / size).ceil(),
        Outline::Circle { radius } => PI * (radius / size).powi(2),
        // Its computed part, of irregular elements.
        Outline::Polygon(polygon) => return 1.5 * triangles * polygon.area() / (size * size),
    };
    whole * triangles / copies
}
