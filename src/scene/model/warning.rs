//! Warnings about a scenario that is valid but implausible.

use super::{Face, Impactor, ImpactorShape, MeshInput, Model};
use crate::mesh::{Outline, import};
use crate::scenario::{Document, Implausible};
use base::findings;
use base::number::significant;
use base::units::{Length, Mass};
use membrane::material::{Criterion, Law, Tension};

/// Largest extent of a mesh that is likely, m.
const LARGEST_MESH: f64 = 10.0;

/// Longest mesh file whose extent is checked, bytes.
const LONGEST_MESH: u64 = 64 << 20;

findings! {
    /// Implausible values and combinations in a scenario.
    #[derive(Clone, Debug, PartialEq)]
    pub enum Warning {
        /// A value is outside its likely range.
        Value(value: Implausible => "key" = value.key, "value" = value.value)
            = "implausible-value" as IMPLAUSIBLE_VALUE, Warning;
            meaning "a value of the scenario, or the extent of a mesh, is far from what such tests have";
            remedy "check its unit: a bare number is in the SI unit, coordinates of meshes are in m; no change is \
                needed where it is meant";
            message "`{}` is {}, which is implausible: usual are {}{}", value.key, value.found, value.likely,
                value.meant.iter().map(|meant| format!("; did you mean \"{meant}\"?")).collect::<String>();
        /// A mesh is as large as if its coordinates were in another unit.
        Extent {
            key: String, "path of the key that names the file" => "key";
            extent: f64, "largest extent along x, y or z, m" => "extent_m";
        } = code &IMPLAUSIBLE_VALUE;
            message "the mesh of `{key}` is {} m wide, which is implausible; {}", significant(*extent, 3),
                match key.ends_with("polygon.file") {
                    true => "check the unit of the drawing".to_owned(),
                    false => format!("coordinates in mm are `{key} = {{ file = \"…\", unit = \"mm\" }}`"),
                };
        /// The limit of a rupture criterion is as small as if it were in another unit.
        RuptureLimit {
            limit: f64, "smallest limit, Pa or J/m3" => "limit";
            unit: &'static str, "its unit";
        } = code &IMPLAUSIBLE_VALUE;
            message "a limit of `specimen.material.rupture` is {} {unit}, which is implausible: usual are 10 kPa and more, or \
                10 kJ/m3 and more", significant(*limit, 3);
        Unstable {
            key: String, "path of the key of the law" => "key";
            tension: Tension, "in which kind of tension first" => "tension" = tension.to_string();
            stretch: f64, "from which stretch on" => "stretch";
        } = "hyperelastic-unstable", Warning;
            meaning "the stress of a hyperelastic law no longer grows with every strain beyond a stretch that is less \
                than 10 (Hill's criterion): film stretched farther may give way in a band of elements";
            remedy "fit the coefficients to tests in several kinds of tension, with signs that are stable, or see that \
                the film is stretched less";
            message "`{key}` is unstable in {tension} from a stretch of {} on", significant(*stretch, 3);
        CutOnMirrorPlane {
            cut: usize, "its place among the cuts, from zero" => "cut";
            axis: char, "the axis across the plane" => "axis" = axis.to_string();
        } = "cut-on-mirror-plane", Warning;
            meaning "a cut runs along a mirror plane of film that can tear: it is a row of elements of the computed part and one of \
                its image, twice as wide as a cut elsewhere, and a tear that goes on from it along the plane takes twice its \
                fracture energy";
            remedy "compute the whole: `specimen.symmetry = \"none\"`, or the half whose plane the cut crosses";
            message "`specimen.cuts.{cut}` runs along the mirror plane {axis} = 0, where a tear takes twice its energy";
        AbsorptionNotGiven {
            key: String, "paths of the keys that are left out" => "key";
        } = "absorption-not-given" as ABSORPTION_NOT_GIVEN, Note;
            meaning "an impactor rebounds from film whose fabric gives no `absorption`: it is zero, so that all energy \
                that the film stored is returned, and rebound and energy absorption say nothing about a test";
            remedy "give the `absorption` of the fabric, from the rebound of a drop test (`droptower reduce drop`), or \
                0 where it is meant";
            message "`{key}` {} not given and taken as zero: the rebound of the impactor says nothing about a test",
                if key.contains('`') { "are" } else { "is" };
    }
}

/// Implausible values and combinations in the scenario `document`, which was checked to be `model`.
pub fn warnings(document: &Document, model: &Model) -> Vec<Warning> {
    let darts: Vec<Implausible> = darts(document, model).into_iter().chain(heads(document, model)).collect();
    let mut values = document.implausible();
    values.retain(|value| darts.iter().all(|dart| dart.key != value.key));
    let values = values.into_iter().chain(darts).map(Warning::Value);
    let meshes = model.meshes().into_iter().filter_map(wide);
    let unstable = rupture_limits(model).into_iter().chain(unstable(document, model));
    let absorption = without_absorption(document, model).into_iter().chain(on_mirror_planes(model));
    values.chain(meshes).chain(drawing(document, model)).chain(unstable).chain(absorption).collect()
}

/// Radii of the heads of ASTM D1709, m, and the heaviest dart of its scope, kg.
const STANDARD_DARTS: ([f64; 2], f64) = ([19.05e-3, 25.4e-3], 6.0);

/// The heaviest striker with another hemisphere, kg: of ISO 7765-2 some 20 kg.
const HEAVIEST_STRIKER: f64 = 100.0;

/// Masses of darts that no standard has.
fn darts(document: &Document, model: &Model) -> Vec<Implausible> {
    let of_body = |(place, body): (usize, &Impactor)| {
        let ImpactorShape::Hemisphere { radius, .. } = body.shape else { return None };
        let (heads, standard) = STANDARD_DARTS;
        let is_standard = heads.iter().any(|head| (radius - head).abs() < 1e-3 * head);
        let likely = [1e-3, if is_standard { standard } else { HEAVIEST_STRIKER }];
        document.implausible_at(&document.impactor_key(place, "mass"), Mass::DIMENSION, likely)
    };
    model.impactors.iter().enumerate().filter_map(of_body).collect()
}

/// Radii of hemispheres that are wider than the film, or the diameters of the standard's heads.
fn heads(document: &Document, model: &Model) -> Vec<Implausible> {
    let shown = |length: f64| format!("{} mm", significant(1e3 * length, 4));
    let of_body = |(place, body): (usize, &Impactor)| {
        let ImpactorShape::Hemisphere { radius, .. } = body.shape else { return None };
        let film = match model.specimen.shape {
            Outline::Circle { radius } => radius,
            _ => f64::INFINITY,
        };
        let [small, large] = STANDARD_DARTS.0;
        let is_diameter = [small, large].iter().any(|head| (radius - 2.0 * head).abs() < 1e-3 * head);
        let likely = match is_diameter {
            true => format!("{} and {} (ASTM D1709)", shown(small), shown(large)),
            false if radius >= film => format!("less than the radius of the film, {}", shown(film)),
            false => return None,
        };
        let key = document.impactor_key(place, "shape.hemisphere.radius");
        let found = document.implausible_at(&key, Length::DIMENSION, [0.0, 0.99 * radius])?;
        Some(Implausible { likely, meant: (0.5 * radius < film).then(|| shown(0.5 * radius)), ..found })
    };
    model.impactors.iter().enumerate().filter_map(of_body).collect()
}

/// The limit of a stress or an energy below which no film holds, Pa or J/m³.
const LEAST_LIMIT: f64 = 1e4;

/// Limits of rupture criteria that no film has, each once.
fn rupture_limits(model: &Model) -> Vec<Warning> {
    let of_face = |face: &Face| {
        let rupture = face.material.rupture.as_ref()?;
        let unit = match rupture.criterion {
            Criterion::Stress => "Pa",
            Criterion::Energy => "J/m3",
            Criterion::Strain | Criterion::FibreStrain | Criterion::Break => return None,
        };
        let limit = rupture.limit;
        (limit < LEAST_LIMIT).then_some(Warning::RuptureLimit { limit, unit })
    };
    let mut warnings: Vec<Warning> = model.faces.iter().filter_map(of_face).collect();
    warnings.dedup();
    warnings
}

/// The hyperelastic laws that are unstable, each once.
fn unstable(document: &Document, model: &Model) -> Vec<Warning> {
    let of_face = |(place, face): (usize, &Face)| {
        let Law::Hyperelastic(law) = &face.material.law else { return None };
        let (tension, stretch) = law.instability()?;
        Some(Warning::Unstable { key: document.face_key(place, "material.hyperelastic"), tension, stretch })
    };
    let mut warnings: Vec<Warning> = model.faces.iter().enumerate().filter_map(of_face).collect();
    warnings.dedup();
    warnings
}

/// The cuts of film that can tear with a part in the first row of elements along a mirror plane, each once a plane.
fn on_mirror_planes(model: &Model) -> Vec<Warning> {
    let row = model.faces.iter().map(|face| face.meshing.size).fold(f64::INFINITY, f64::min);
    let is_along = |points: &[[f64; 2]], across: usize| {
        points.windows(2).any(|ends| {
            let is_near = ends.iter().all(|point| point[across].abs() < row);
            is_near && (ends[1][1 - across] - ends[0][1 - across]).abs() >= row
        })
    };
    let mut warnings = vec![];
    let planes = [(0, 'x'), (1, 'y')].into_iter().zip(model.specimen.symmetry.mirrors());
    for ((across, axis), _) in planes.filter(|(_, is_mirrored)| *is_mirrored && model.can_tear()) {
        let cuts = model.specimen.cuts.iter().enumerate().filter(|(_, points)| is_along(points, across));
        warnings.extend(cuts.map(|(cut, _)| Warning::CutOnMirrorPlane { cut, axis }));
    }
    warnings
}

/// The fabrics without `absorption` that an impactor falls on, by the paths of their keys, in one warning.
fn without_absorption(document: &Document, model: &Model) -> Option<Warning> {
    model.loading.impact()?;
    let layers = (0..model.faces.len()).map(|place| format!("layer.{place}.material.fabric"));
    let fabrics = std::iter::once("specimen.material.fabric".to_owned()).chain(layers);
    let is_left_out =
        |path: &String| document.find(path).is_some() && document.find(&format!("{path}.absorption")).is_none();
    let keys: Vec<String> = fabrics.filter(is_left_out).map(|path| format!("{path}.absorption")).collect();
    (!keys.is_empty()).then(|| Warning::AbsorptionNotGiven { key: keys.join("`, `") })
}

/// The warning of a drawing that is too wide.
fn drawing(document: &Document, model: &Model) -> Option<Warning> {
    const KEY: &str = "specimen.shape.polygon.file";
    let Outline::Polygon(polygon) = &model.specimen.shape else { return None };
    let extent = polygon.extent();
    (extent > LARGEST_MESH && document.find(KEY).is_some()).then(|| Warning::Extent { key: KEY.into(), extent })
}

/// The warning of a mesh that is too wide. A file that cannot be read is a mistake of its own.
fn wide(mesh: MeshInput<'_>) -> Option<Warning> {
    let length = std::fs::metadata(mesh.path).ok()?.len();
    let extent = mesh.scale * (length <= LONGEST_MESH).then(|| import::extent(mesh.path).ok()).flatten()?;
    (extent > LARGEST_MESH).then_some(Warning::Extent { key: mesh.key, extent })
}
