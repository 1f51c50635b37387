//! Where the elements of a face are small.

use super::loading::{Impact, Impactors};
use super::{Face, Guide, Impactor, ImpactorShape, Loading, ModelDiagnostics};
use crate::mesh::{Grading, Outline, Zone, import};
use crate::scenario::{Around, AroundChoice, Meshing, Scenario, Shape};

/// Growth of elements where it is not given: from one element to the next of half its size within two of the latter.
const GROWTH: f64 = 0.25;

/// Adds the grading of their elements to `faces`; none stays as it is where the keys of it are mistaken.
pub fn check(
    scenario: &Scenario,
    loading: &Loading,
    faces: &mut [Face],
    impactors: &[Impactor],
    shape: Option<&Outline>,
    mistakes: &mut ModelDiagnostics<'_>,
) {
    let shared = &scenario.specimen.mesh;
    for (place, face) in faces.iter_mut().enumerate() {
        let own = scenario.layer.get(place).map_or(shared, |layer| &layer.mesh);
        let keys = Keys { own, shared, place };
        let Some(fine) = own.fine.or(shared.fine).map(|fine| fine.0) else {
            keys.without_fine(mistakes);
            continue;
        };
        if matches!(scenario.specimen.shape, Shape::Mesh(_)) {
            let why = "an imported mesh has its own element sizes";
            mistakes.out_of_place(&keys.path("fine", own.fine.is_some()), why);
            continue;
        }
        let path = keys.path("fine", own.fine.is_some());
        if fine >= face.meshing.size {
            mistakes.report_with(&path, "`fine` is not smaller than `size`", "leave it out where all have one size");
            mistakes.label(&keys.path("size", own.size.is_some()), "the largest edge length");
            continue;
        }
        let Some(zones) = keys.zones(loading, face.height, impactors, mistakes) else { continue };
        let growth = own.growth.or(shared.growth).unwrap_or(GROWTH);
        let grading = Grading { fine, growth, zones };
        let beside = |zone: &Zone| {
            let distance = shape.and_then(|shape| shape.distance(zone.at));
            distance
                .is_some_and(|distance| grading.size_at(distance - zone.within, face.meshing.size) >= face.meshing.size)
        };
        if !grading.zones.is_empty() && grading.zones.iter().all(beside) {
            let path =
                if own.around.or(shared.around).is_some() { keys.path("around", own.around.is_some()) } else { path };
            let hint = "give a place on the film: x and y are measured from its origin";
            mistakes.report_with(&path, "no element of the film becomes finer: this place lies beside it", hint);
            continue;
        }
        face.meshing.grading = Some(grading);
    }
}

/// The keys of a face and those of all.
struct Keys<'a> {
    own: &'a Meshing,
    shared: &'a Meshing,
    place: usize,
}

impl Keys<'_> {
    /// Path of a key, which is one of the face's `own` or that of all faces.
    fn path(&self, key: &str, own: bool) -> String {
        let is_own = own && !std::ptr::eq(self.own, self.shared);
        if is_own { format!("layer.{}.mesh.{key}", self.place) } else { format!("specimen.mesh.{key}") }
    }

    /// Keys that are allowed with `fine` only.
    fn without_fine(&self, mistakes: &mut ModelDiagnostics<'_>) {
        let written = |meshing: &Meshing| {
            [
                ("around", meshing.around.is_some()),
                ("within", meshing.within.is_some()),
                ("growth", meshing.growth.is_some()),
            ]
        };
        for ((key, own), (_, shared)) in written(self.own).into_iter().zip(written(self.shared)) {
            if own || shared {
                mistakes.out_of_place(&self.path(key, own), "`fine` is the edge length there");
            }
        }
    }

    /// Where elements are fine: around a point, or where each impactor meets the film.
    fn zones(
        &self,
        loading: &Loading,
        height: f64,
        impactors: &[Impactor],
        mistakes: &mut ModelDiagnostics<'_>,
    ) -> Option<Vec<Zone>> {
        let (own, shared) = (self.own, self.shared);
        let around = own.around.or(shared.around);
        let within = own.within.or(shared.within).map(|within| within.0);
        if let Some(Around::Point(point)) = around {
            return Some(vec![Zone { at: point.map(|length| length.0), within: within.unwrap_or(0.0) }]);
        }
        let path = match around {
            Some(_) => self.path("around", own.around.is_some()),
            None => self.path("fine", own.fine.is_some()),
        };
        let hint = "give a point: `around = [\"0 mm\", \"0 mm\"]`";
        debug_assert!(matches!(around, None | Some(Around::Word(AroundChoice::Impactor))));
        if loading.impactors() == Impactors::None {
            mistakes.report_with(&path, "this loading has no impactor around which elements could be fine", hint);
            return None;
        }
        // A missing impactor is a mistake of its own.
        if impactors.is_empty() {
            return None;
        }
        if impactors.iter().any(|impactor| matches!(impactor.guide, Guide::Hinge { .. })) {
            mistakes.report_with(&path, "where an impactor on a hinge meets the film is not known", hint);
            return None;
        }
        let zone = |impactor: &Impactor| {
            let radius = footprint(&impactor.shape, impactor.orientation != [0.0; 3])?;
            Some(Zone { at: impactor.meeting_point(loading, height, radius), within: within.unwrap_or(radius) })
        };
        impactors.iter().map(zone).collect()
    }
}

impl Impactor {
    /// Where its centre is over the plane at `height` (m) when it is `radius` (m) above it, in free flight; x and y in
    /// m.
    fn meeting_point(&self, loading: &Loading, height: f64, radius: f64) -> [f64; 2] {
        let Some(Impact { gravity, .. }) = loading.impact() else { return self.position };
        let Some(fall) = self.height.map(|start| start - height - radius).filter(|fall| *fall > 0.0) else {
            return self.position;
        };
        let [x, y, z] = self.velocity;
        let speed = (z * z + 2.0 * gravity * fall).sqrt();
        // Time of the fall, from 2 fall = (initial + final speed) time.
        let time = 2.0 * fall / (speed - z);
        let drift = if time.is_finite() { [x * time, y * time] } else { [0.0; 2] };
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
