//! The film: its outline and mirror planes, and its faces in the order in which the impactor comes into contact with them.

use std::f64::consts::FRAC_PI_2;

use statrs::distribution::{ContinuousCDF, Normal};

use super::exclusions::Scene;
use super::{Checker, Face, Loading, Specimen, Symmetry, material};
use crate::mesh::{Element, MeshErrorKind, Meshing, Outline, Polygon, import};
use crate::scenario::{self, Layer, Layers, MountingCurve, Scale, Scenario};
use base::diagnostic::shown_path;
use base::number::significant;
use base::units::Length;
use membrane::material::{Criterion, Curve, Law, LayerBreaks, Material};

/// The specimen in SI values; none where the file of its mesh is missing.
pub fn check(specimen: &scenario::Specimen, checker: &mut Checker<'_>) -> Option<Specimen> {
    let shape = match &specimen.shape {
        scenario::Shape::Rectangle([x, y]) => Outline::Rectangle { x: x.0, y: y.0 },
        scenario::Shape::Circle(circle) => Outline::Circle { radius: circle.radius() },
        scenario::Shape::Polygon(written) => Outline::Polygon(polygon(written, specimen.symmetry, checker)?),
        scenario::Shape::Mesh(file) => {
            let (path, scale) = checker.mesh("specimen.shape.mesh", file)?;
            Outline::Mesh { path, scale }
        }
    };
    let cuts = specimen.cuts.iter().map(|cut| cut.iter().map(|point| point.map(|length| length.0)).collect()).collect();
    Some(Specimen { shape, symmetry: specimen.symmetry, damping: specimen.damping.0, cuts })
}

/// The outline with its holes, from corners or a drawing.
fn polygon(written: &scenario::Polygon, symmetry: Symmetry, checker: &mut Checker<'_>) -> Option<Polygon> {
    const KEY: &str = "specimen.shape.polygon";
    let key = |name: &str| format!("{KEY}.{name}");
    let (path, polygon) = match (&written.file, &written.points) {
        // Neither or both are a mistake that was reported when they were read.
        (None, None) | (Some(_), Some(_)) => return None,
        (None, Some(points)) => {
            if written.unit.is_some() && !checker.is_inherited(&key("unit")) {
                checker.out_of_place(&key("unit"), "corners have their own units");
            }
            let holes = written.holes.iter().map(|hole| corners(hole)).collect();
            (key("points"), Polygon { outer: corners(points), holes })
        }
        (Some(_), None) => {
            // Those of inherited corners go with them.
            if !written.holes.is_empty() && !checker.is_inherited(&key("holes")) {
                checker.out_of_place(&key("holes"), "`file` gives the holes");
            }
            let path = key("file");
            let file = checker.file(&path)?;
            match import::polygon(&file, written.unit.map(scenario::MeshUnit::metres)) {
                Ok(polygon) => (path, polygon),
                Err(fault) => {
                    let message = format!("{}: {fault}", shown_path(&file));
                    match fault.kind {
                        MeshErrorKind::NoUnit => checker.report_with(&path, message, "give it: `unit = \"mm\"`"),
                        MeshErrorKind::OtherUnit => {
                            checker.report_with(&key("unit"), message, "leave `unit` out, or correct the drawing");
                        }
                        _ => checker.report(&path, message),
                    }
                    return None;
                }
            }
        }
    };
    match polygon.check(symmetry.mirrors()) {
        Ok(()) => Some(polygon),
        Err(fault) => {
            let path = match fault.kind {
                MeshErrorKind::Hole(hole) if written.file.is_none() => key(&format!("holes.{hole}")),
                _ => path,
            };
            checker.report(&path, fault.to_string());
            None
        }
    }
}

/// The corners of a loop, m; without a last one that repeats the first.
fn corners(points: &[[Length; 2]]) -> Vec<[f64; 2]> {
    let mut corners: Vec<[f64; 2]> = points.iter().map(|point| point.map(|length| length.0)).collect();
    if corners.len() > 3 && corners.first() == corners.last() {
        corners.pop();
    }
    corners
}

/// Whether fibres at this angle lie along the axes, so that a mirror plane leaves them as they are.
pub fn is_along_axes(angle: f64) -> bool {
    let quarters = angle / FRAC_PI_2;
    (quarters - quarters.round()).abs() < 1e-9
}

/// The faces; none where a material is missing or no material.
pub(super) fn check_faces(scene: &Scene<'_>, checker: &mut Checker<'_>) -> Option<Vec<Face>> {
    let Scene { scenario, loading, .. } = *scene;
    let own = scenario.specimen.material.as_ref();
    let shared = own.map(|written| film(written, "specimen.material", checker));
    let layers = if scenario.layer.is_empty() { &stacked(scenario) } else { &scenario.layer };
    let faces = layers.iter().enumerate().map(|(place, layer)| face(scenario, layer, place, shared.as_ref(), checker));
    let faces: Vec<Option<Face>> = faces.collect();
    let mut faces = faces.into_iter().collect::<Option<Vec<Face>>>()?;
    heights(&faces, scenario, loading, checker);
    if let Some(angle) = loading.md_angle() {
        faces.iter_mut().for_each(|face| face.md_angle = angle);
    }
    rested(&mut faces, scenario, checker);
    mirrored(&faces, scenario, checker);
    prestrained(&faces, scenario, checker);
    taut(&faces, scenario, loading, checker);
    Some(faces)
}

/// What a layer is made of.
#[derive(Clone)]
struct Film<'s> {
    written: &'s scenario::Material,
    material: Material,
    /// The MD and TD curves without multipliers, to which film relaxes on the frame; none where it does not.
    relaxed: Option<[Curve; 2]>,
}

impl Film<'_> {
    /// The face of a layer of this film.
    fn face(&self, scenario: &Scenario, layer: &Layer, meshing: Meshing) -> Face {
        let fabric = self.written.fabric.as_ref();
        let moves = |fabric: &scenario::Fabric| [&fabric.md, &fabric.td].iter().any(|own| own.break_factor != 1.0);
        let unsourced = fabric.filter(|fabric| fabric.biaxial_source.is_none());
        Face {
            height: layer.height.0,
            layers: layer.count,
            film: self.written.name.clone(),
            material: self.of_layers(layer.count),
            break_is_moved: fabric.is_some_and(moves),
            unsourced_coupling: unsourced.map(|fabric| fabric.biaxial),
            md_angle: layer.md_angle.unwrap_or(scenario.specimen.md_angle).0,
            prestrain: self.prestrain([layer.prestrain.md, layer.prestrain.td]),
            meshing,
            settle: layer.settle,
        }
    }

    /// The material of `count` layers.
    fn of_layers(&self, count: u32) -> Material {
        let mut material = self.material.clone();
        let scatter = self.written.fabric.as_ref().map_or(0.0, |fabric| fabric.break_scatter);
        material.law = material.law.with_layer_breaks(layer_breaks(scatter, count));
        material
    }

    /// The pre-strain at which the curves have the stress of film that was mounted with `written` and has relaxed: its
    /// stress-free length has grown by the rest (theory.md, equation 3b).
    fn prestrain(&self, written: [f64; 2]) -> [f64; 2] {
        let (Some(relaxed), Law::Fabric(fabric)) = (&self.relaxed, &self.material.law) else { return written };
        let dynamic = [fabric.md(), fabric.td()];
        std::array::from_fn(|fibre| match written[fibre] {
            strain if strain > 0.0 => dynamic[fibre].strain_at(relaxed[fibre].stress(strain)).min(strain),
            slack => slack,
        })
    }
}

/// Break strains of `layers` over their mean, with the standard deviation `scatter`: the quantiles of a normal
/// distribution in the middle of as many equal parts (theory.md, equation 17b).
fn layer_breaks(scatter: f64, layers: u32) -> LayerBreaks {
    if scatter.is_nan() || scatter <= 0.0 {
        return LayerBreaks::default();
    }
    let normal = Normal::standard();
    let quantile = |layer: u32| normal.inverse_cdf((f64::from(layer) + 0.5) / f64::from(layers));
    let factors = (0..layers).map(|layer| 1.0 + scatter * quantile(layer)).collect();
    // The range of the scatter was checked before; there are no such layers outside it.
    LayerBreaks::new(factors).unwrap_or_default()
}

fn film<'s>(written: &'s scenario::Material, path: &str, checker: &mut Checker<'_>) -> Option<Film<'s>> {
    let material = material::check(written, path, checker)?;
    Some(Film { written, material, relaxed: relaxed(written, path, checker) })
}

/// The curves without multipliers where film relaxes to them; those with them were checked before.
fn relaxed(written: &scenario::Material, path: &str, checker: &mut Checker<'_>) -> Option<[Curve; 2]> {
    let fabric = written.fabric.as_ref().filter(|fabric| fabric.mounting == MountingCurve::QuasiStatic)?;
    if fabric.md.rates.is_some() || fabric.td.rates.is_some() {
        let why = "film with `rates` is mounted at the slowest of them";
        checker.out_of_place(&format!("{path}.fabric.mounting"), why);
        return None;
    }
    if fabric.biaxial > 0.0 {
        let message = "film with `biaxial` cannot be mounted at its quasi-static curves";
        checker.report_with(&format!("{path}.fabric.mounting"), message, "leave one of them out");
        checker.label(&format!("{path}.fabric.biaxial"), "the coupling");
        return None;
    }
    let mut unscaled = written.clone();
    let fabric = unscaled.fabric.as_mut()?;
    (fabric.scale, fabric.md.scale, fabric.td.scale) = (Scale::default(), None, None);
    match material::check(&unscaled, path, checker)?.law {
        Law::Fabric(fabric) => Some([fabric.md().clone(), fabric.td().clone()]),
        _ => None,
    }
}

/// The faces of `[layers]`, which differ in height only, each as a `[[layer]]`.
fn stacked(scenario: &Scenario) -> Vec<Layer> {
    let Layers { count, faces, prestrain, settle } = scenario.layers.clone().unwrap_or_default();
    let layer = |height: Length| Layer { height, count, prestrain, settle, ..Layer::default() };
    faces.into_iter().map(layer).collect()
}

/// The face of a layer, of the `shared` film where it has none of its own.
fn face(
    scenario: &Scenario,
    layer: &Layer,
    place: usize,
    shared: Option<&Option<Film<'_>>>,
    checker: &mut Checker<'_>,
) -> Option<Face> {
    let (table, hint) = match scenario.layer.is_empty() {
        true => ("specimen".to_owned(), "what one layer is made of"),
        false => (format!("layer.{place}"), "or give `specimen.material` for all layers"),
    };
    let path = format!("{table}.material");
    let film = match (&layer.material, shared) {
        (Some(written), _) => film(written, &path, checker),
        (None, Some(shared)) => shared.clone(),
        (None, None) => {
            checker.missing(&path, hint);
            None
        }
    };
    let mesh = layer.mesh.over(&scenario.specimen.mesh);
    let meshing = meshing(scenario, &mesh, &format!("{table}.mesh.size"), checker);
    Some(film?.face(scenario, layer, meshing?))
}

/// The meshing of a face as `written`, with the size of its elements at `path`.
fn meshing(scenario: &Scenario, written: &scenario::Meshing, path: &str, checker: &mut Checker<'_>) -> Option<Meshing> {
    let imported = matches!(scenario.specimen.shape, scenario::Shape::Mesh(_));
    let size = match (written.size, imported) {
        (Some(size), false) => size.0,
        (None, true) => 0.0,
        (Some(_), true) => {
            let path = if checker.is_written(path) { path } else { "specimen.mesh.size" };
            // A key of the base scenario cannot be deleted here, only unset.
            let inherited = checker.is_inherited(path);
            let remedy = if inherited { "; `unset = [\"specimen.mesh.size\"]` leaves it out" } else { "" };
            checker.out_of_place(path, format!("an imported mesh has its own element size{remedy}"));
            return None;
        }
        (None, false) => {
            checker.missing(path, "the edge length of an element, like \"10 mm\"");
            return None;
        }
    };
    Some(Meshing { element: written.element.unwrap_or(Element::Quad4), size, grading: None })
}

/// Key path of the height of a face.
pub(super) fn height_path(scenario: &Scenario, place: usize) -> String {
    if scenario.layer.is_empty() { format!("layers.faces.{place}") } else { format!("layer.{place}.height") }
}

/// Key path of the table of a face.
fn face_path(scenario: &Scenario, place: usize) -> String {
    if scenario.layer.is_empty() { "layers".to_owned() } else { format!("layer.{place}") }
}

fn heights(faces: &[Face], scenario: &Scenario, loading: &Loading, checker: &mut Checker<'_>) {
    if let Some(message) = loading.refuses_faces().filter(|_| faces.len() > 1) {
        checker.report(&height_path(scenario, 1), message);
    }
    for (place, pair) in faces.windows(2).enumerate() {
        let path = height_path(scenario, place + 1);
        if pair[1].height == pair[0].height {
            checker.report(&path, "two faces have the same height");
            checker.label(&height_path(scenario, place), "the other face");
        } else if pair[1].height > pair[0].height {
            checker.report_with(
                &path,
                "the faces are not ordered from the highest to the lowest",
                "the impactor comes from above, so the first face is the highest",
            );
            checker.label(&height_path(scenario, place), "the face before it");
        }
    }
}

/// Under pressure, film with negative pre-strain has no equilibrium near its flat shape.
fn taut(faces: &[Face], scenario: &Scenario, loading: &Loading, checker: &mut Checker<'_>) {
    if !loading.is_by_gas() {
        return;
    }
    for (place, face) in faces.iter().enumerate() {
        for (key, prestrain) in ["md", "td"].into_iter().zip(face.prestrain) {
            if prestrain < 0.0 {
                let path = format!("{}.prestrain.{key}", face_path(scenario, place));
                let hint = "nothing resists the pressure until the film is taut; use a pre-strain of at least 0";
                checker.report_with(&path, "pressure on film that is wrinkled at the start", hint);
            }
        }
    }
}

/// Lets viscous film rest between mounting and loading.
fn rested(faces: &mut [Face], scenario: &Scenario, checker: &mut Checker<'_>) {
    let Some(rest) = scenario.specimen.rest else { return };
    if faces.iter().all(|face| face.material.viscosity.is_none()) {
        checker.out_of_place("specimen.rest", "no film has `prony`, by which its stress would relax");
    }
    for face in faces {
        face.material.viscosity = face.material.viscosity.take().map(|viscosity| viscosity.rested(rest.0));
    }
}

/// Pre-strain must not break the film.
fn prestrained(faces: &[Face], scenario: &Scenario, checker: &mut Checker<'_>) {
    for (place, face) in faces.iter().enumerate() {
        let path = face_path(scenario, place);
        let [md, td] = face.prestrain.map(|prestrain| 1.0 + prestrain);
        let stress = face.material.law.virgin_stress([[md, 0.0, 0.0], [0.0, td, 0.0]]);
        if face.prestrain != [0.0; 2] && stress.iter().flatten().any(|stress| !stress.is_finite()) {
            let message = "pre-strain stretches the film beyond the limit of its law";
            checker.report_with(&format!("{path}.prestrain"), message, "use less pre-strain, or a larger `jm`");
            continue;
        }
        if let Some(message) = torn(face) {
            checker.report_with(&format!("{path}.prestrain"), message, "use less pre-strain, or a larger limit");
            continue;
        }
        // A limit that is no limit has its own mistake.
        if face.material.rupture.as_ref().is_some_and(|rupture| rupture.limit <= 0.0) {
            continue;
        }
        let ends = face.material.break_strains();
        let fibres = [("md", "MD"), ("td", "TD")].into_iter().zip(ends);
        for (((key, name), end), prestrain) in fibres.zip(face.prestrain) {
            if prestrain < end {
                continue;
            }
            let end = significant(end, 4);
            let message = format!("pre-strain {prestrain} breaks the film: {name} breaks at {end}");
            let path = format!("{path}.prestrain.{key}");
            let hint = written_material(scenario, place).and_then(|written| scaled_break(written, key));
            checker.report_with_hint_if(&path, message, hint);
        }
    }
}

/// Why pre-strain tears film whose rupture criterion is a stress or an energy, if it surely does: every element would fail
/// in the first step. Viscous film is left out, since its stress depends on how long it rested.
fn torn(face: &Face) -> Option<String> {
    let rupture = face.material.rupture.filter(|_| face.material.viscosity.is_none())?;
    let [md, td] = face.prestrain.map(|prestrain| 1.0 + prestrain);
    let gradient = [[md, 0.0, 0.0], [0.0, td, 0.0]];
    let (value, what, unit) = match rupture.criterion {
        Criterion::Stress => {
            let stress = face.material.law.virgin_stress(gradient);
            (stress[0][0].max(stress[1][1]), "stress", "Pa")
        }
        Criterion::Energy => (face.material.law.virgin_energy(gradient), "energy", "J/m3"),
        Criterion::Strain | Criterion::FibreStrain | Criterion::Break => return None,
    };
    let limit = rupture.limit;
    let shown = |value| significant(value, 4);
    (face.prestrain != [0.0; 2] && value >= limit).then(|| {
        format!("pre-strain tears the film: its {what} is {} {unit}, the limit {} {unit}", shown(value), shown(limit))
    })
}

/// The material of a face as written.
fn written_material(scenario: &Scenario, place: usize) -> Option<&scenario::Material> {
    let own = scenario.layer.get(place).and_then(|layer| layer.material.as_ref());
    own.or(scenario.specimen.material.as_ref())
}

/// The break strain of the fibre set `key` as written, with the multipliers that change it; none where there are none.
fn scaled_break(written: &scenario::Material, key: &str) -> Option<String> {
    let fabric = written.fabric.as_ref()?;
    let fibre = if key == "md" { &fabric.md } else { &fabric.td };
    let end = fibre.points.break_point.or_else(|| fibre.points.curve.as_ref()?.last().copied())?.0;
    let Scale { k1, ke, .. } = fibre.scale.unwrap_or(fabric.scale);
    let shown = |value| significant(value, 4);
    let is_changed = fabric.scale_break && (k1, ke) != (1.0, 1.0);
    is_changed.then(|| {
        format!("the multipliers k1 {} and ke {} change its break strain {}", shown(k1), shown(ke), shown(end))
    })
}

/// With mirror planes, fibres lie along the axes.
fn mirrored(faces: &[Face], scenario: &Scenario, checker: &mut Checker<'_>) {
    if scenario.specimen.symmetry == Symmetry::None {
        return;
    }
    let oblique = faces.iter().position(|face| !is_along_axes(face.md_angle));
    let Some(place) = oblique else { return };
    let own = checker.document.face_key(place, "md_angle");
    let path = if checker.is_written(&own) { own } else { "loading.stretch.direction".to_owned() };
    checker.report_with(
        &path,
        "oblique fibres have no mirror planes",
        "set `specimen.symmetry` to \"none\", or rotate MD to a multiple of 90 deg",
    );
}
