//! What of a run is drawn: faces of film with their mirror images, springs and the fields that colour them, impactors and
//! the bars of the frame. Pages, series for ParaView, recordings and pictures show this geometry.

use std::collections::HashMap;
use std::f32::consts::PI;

use membrane::engine::Surface;
use nalgebra::{Isometry3, Point3, Quaternion, Translation3, UnitQuaternion, Vector3};
use scene::simulate::{Film, FilmSpring, FilmState, Image, Outcome, Snapshot};
use serde::{Deserialize, Serialize};

/// The parts and fields of a run that can be drawn.
///
/// A page holds it coarsened and with strains alone ([`StoredPage::scene`](crate::StoredPage::scene)); an outcome holds
/// every element and every field of its snapshots ([`run_scene`](crate::run_scene)).
#[derive(Clone, Debug)]
pub struct RunScene {
    /// The faces of film, in the order of [`Snapshot::films`].
    pub faces: Vec<SceneFace>,
    /// The impactors, and after them the frame's bars, in the order of [`Snapshot::impactors`].
    pub bodies: Vec<SceneBody>,
    /// The kept states, ascending in time; at least one.
    pub states: Vec<Snapshot>,
    /// Events of the run, ascending in time.
    pub moments: Vec<Moment>,
    /// Whether the faces have fewer patches than the run has elements.
    pub is_coarsened: bool,
}

/// Topology of one face.
#[derive(Clone, Debug, Default)]
pub struct SceneFace {
    /// Number of nodes.
    pub nodes: usize,
    /// Nodes at the corners of each patch, an element or several; a triangle has its last corner twice.
    pub patches: Vec<[u32; 4]>,
    /// Whether x = 0 and y = 0 are mirror planes.
    pub mirrored: [bool; 2],
    /// Edges by which a frame or jaws hold it, as pairs of nodes.
    pub held: Vec<[u32; 2]>,
    /// Springs of the frame on which it hangs.
    pub springs: Vec<FilmSpring>,
}

/// Surface of a body about its centre of mass.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SceneBody {
    /// Vertices, m.
    pub points: Vec<[f64; 3]>,
    /// Vertices at the corners of each patch, counter-clockwise seen from outside; a triangle has its last corner twice.
    pub patches: Vec<[u32; 4]>,
}

/// An event of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Moment {
    /// The event, such as `lowest point`.
    pub words: String,
    /// Time, s.
    pub time: f64,
}

/// Whether all of a snapshot is somewhere.
pub fn is_finite(snapshot: &Snapshot) -> bool {
    let bodies = &snapshot.impactors;
    let placed = bodies.iter().all(|(position, rotation)| position.iter().chain(rotation).all(|c| c.is_finite()));
    placed && snapshot.films.iter().all(|film| film.positions.iter().flatten().all(|c| c.is_finite()))
}

/// Where the bodies of a snapshot are.
pub fn poses(snapshot: &Snapshot) -> impl Iterator<Item = Isometry3<f64>> {
    snapshot.impactors.iter().map(|(position, [i, j, k, w])| {
        let rotation = UnitQuaternion::from_quaternion(Quaternion::new(*w, *i, *j, *k));
        Isometry3::from_parts(Translation3::from(*position), rotation)
    })
}

impl From<&Film> for SceneFace {
    fn from(film: &Film) -> SceneFace {
        SceneFace {
            nodes: film.nodes,
            patches: film.outlines().collect(),
            mirrored: film.mirrored,
            held: film.held.clone(),
            springs: film.springs.clone(),
        }
    }
}

impl SceneFace {
    /// The lines of its springs, from the frame to the film.
    pub fn spring_lines(&self, film: &FilmState) -> impl Iterator<Item = [[f32; 3]; 2]> {
        self.springs.iter().map(|spring| [spring.anchor, spring.end(&film.positions)])
    }

    /// The face and its mirror images.
    pub fn images(&self) -> impl Iterator<Item = Image> + use<> {
        Image::all(self.mirrored)
    }

    /// Whether each patch is drawn: it has not failed, and its corners are somewhere.
    pub fn drawn(&self, film: &FilmState) -> Vec<bool> {
        let is_finite = |node: &u32| film.positions[*node as usize].iter().all(|c| c.is_finite());
        let patches = self.patches.iter().zip(&film.failed);
        patches.map(|(patch, failed)| !failed && patch.iter().all(is_finite)).collect()
    }
}

/// Sides of a round body.
const SIDES: u32 = 64;

impl SceneBody {
    /// The bodies of a run.
    pub fn all(surfaces: &[Surface]) -> Vec<SceneBody> {
        surfaces.iter().map(|surface| SceneBody::from_surface(surface, SIDES)).collect()
    }

    /// The triangulated `surface` of an impactor; round shapes have `sides` sides.
    pub(crate) fn from_surface(surface: &Surface, sides: u32) -> SceneBody {
        let (points, triangles) = surface.triangles(sides);
        SceneBody {
            points: points.into_iter().map(|point| point.coords.into()).collect(),
            patches: triangles.iter().map(|&[a, b, c]| [a, b, c, c]).collect(),
        }
    }

    /// Its vertices where it is.
    pub fn placed(&self, pose: Isometry3<f64>) -> impl Iterator<Item = Vector3<f64>> {
        self.points.iter().map(move |point| (pose * Point3::from(*point)).coords)
    }
}

/// The corners of a patch; a triangle has its last one twice.
pub fn corners(patch: &[u32; 4]) -> &[u32] {
    if patch[2] == patch[3] { &patch[..3] } else { patch }
}

/// Unit normals at the corners of each patch that is `drawn`: of those around the corner by their areas, as far as they turn
/// away from the patch by less than the angle whose cosine is `crease`. Others, and those without an area, have none.
pub fn corner_normals(
    points: &[Vector3<f64>],
    patches: &[[u32; 4]],
    drawn: &[bool],
    crease: f64,
) -> Vec<[Vector3<f64>; 4]> {
    // Twice the area along the normal, by the diagonals; right for triangles, too.
    let area = |(patch, drawn): (&[u32; 4], &bool)| {
        let [p, q, r, s] = patch.map(|node| points[node as usize]);
        if *drawn { (r - p).cross(&(s - q)) } else { Vector3::zeros() }
    };
    let areas: Vec<Vector3<f64>> = patches.iter().zip(drawn).map(area).collect();
    let mut around: Vec<Vec<u32>> = vec![vec![]; points.len()];
    for (at, patch) in patches.iter().enumerate().filter(|(at, _)| drawn[*at]) {
        corners(patch).iter().for_each(|node| around[*node as usize].push(at as u32));
    }
    let mean = |own: &Vector3<f64>, node: u32| {
        let others = around[node as usize].iter().map(|other| areas[*other as usize]);
        let sum: Vector3<f64> = others.filter(|other| other.dot(own) > crease * other.norm() * own.norm()).sum();
        sum.try_normalize(0.0).or(own.try_normalize(0.0)).unwrap_or_default()
    };
    patches.iter().zip(&areas).map(|(patch, own)| patch.map(|node| mean(own, node))).collect()
}

/// A surface of triangles with a vertex for each normal of a point: several at edges.
#[derive(Clone, Debug, Default)]
pub struct Vertices {
    /// Point of the surface that each is.
    pub points: Vec<u32>,
    /// Its normal.
    pub normals: Vec<[f32; 3]>,
    /// Vertices at the corners of each triangle.
    pub triangles: Vec<[u32; 3]>,
}

impl Vertices {
    /// The vertices of patches with these [normals](corner_normals) at their corners, whose parts are `rounded`; patches without
    /// normals are left out.
    pub fn new(patches: &[[u32; 4]], normals: &[[Vector3<f64>; 4]], rounded: impl Fn(f64) -> f32) -> Vertices {
        let mut vertices = Vertices::default();
        let mut known: HashMap<(u32, [u32; 3]), u32> = HashMap::new();
        for (patch, normals) in patches.iter().zip(normals).filter(|(_, normals)| normals[0] != Vector3::zeros()) {
            let [p, q, r, s] = [0, 1, 2, 3].map(|corner| {
                // Minus zero is zero.
                let normal = <[f32; 3]>::from(normals[corner].map(|c| rounded(c) + 0.0));
                // By the bits of the rounded normal, which patches around a smooth point share; a float is no key.
                *known.entry((patch[corner], normal.map(f32::to_bits))).or_insert_with(|| {
                    vertices.points.push(patch[corner]);
                    vertices.normals.push(normal);
                    vertices.points.len() as u32 - 1
                })
            });
            vertices.triangles.push([p, q, r]);
            if r != s {
                vertices.triangles.push([p, r, s]);
            }
        }
        vertices
    }
}

impl RunScene {
    /// Every element of `outcome` in all its snapshots; `None` without snapshots.
    pub(crate) fn of_outcome(outcome: &Outcome, moments: Vec<Moment>) -> Option<RunScene> {
        let scene = RunScene {
            faces: outcome.films.iter().map(SceneFace::from).collect(),
            bodies: SceneBody::all(&outcome.impactors),
            states: outcome.snapshots.clone(),
            moments,
            is_coarsened: false,
        };
        (!scene.states.is_empty()).then_some(scene)
    }

    /// The state whose time is nearest to `time` (s).
    pub fn nearest(&self, time: f64) -> &Snapshot {
        let apart = |state: &Snapshot| (state.time - time).abs();
        let nearest = self.states.iter().min_by(|a, b| apart(a).total_cmp(&apart(b)));
        nearest.unwrap_or_else(|| unreachable!("a scene has states"))
    }

    /// The first state at or after `time` (s), else the last: it shows what happens at that time.
    pub fn at_or_after(&self, time: f64) -> &Snapshot {
        // Times on a page are rounded.
        let after = self.states.iter().find(|state| state.time >= time * (1.0 - 1e-6));
        after.or(self.states.last()).unwrap_or_else(|| unreachable!("a scene has states"))
    }
}

/// A field of the film: a number of each element, or patch of several.
#[derive(Debug)]
pub struct Field {
    /// By which users name it.
    pub key: &'static str,
    /// The quantity in words.
    pub title: &'static str,
    /// Its symbol.
    pub symbol: &'static str,
    /// Unit in which it is shown.
    pub unit: &'static str,
    /// Factor from its values to the unit.
    factor: f32,
    values: Values,
}

/// What the value of an element follows from.
#[derive(Debug)]
enum Values {
    /// Its strains along MD and TD and in shear, which all film has.
    Strains(fn([f32; 3]) -> f32),
    /// A number of each element, which film has where its law or its surroundings give it.
    Given(fn(&FilmState) -> &[f32], fn(f32) -> f32),
}

/// The fields to choose from, the default first. A mirror image reverses a shear angle, so its magnitude is shown. The
/// last four only where a law gives the thickness or a plastic strain, where film can tear, and where it warms up.
pub const FIELDS: [Field; 8] = [
    Field::of_strains("largest", ["Larger fibre strain", "max(MD, TD)", "%"], 100.0, |[md, td, _]| md.max(td)),
    Field::of_strains("md", ["Strain MD", "MD", "%"], 100.0, |[md, _, _]| md),
    Field::of_strains("td", ["Strain TD", "TD", "%"], 100.0, |[_, td, _]| td),
    Field::of_strains("shear", ["Shear", "|γ|", "°"], 180.0 / PI, |[_, _, shear]| shear.abs()),
    Field::given(
        "thickness",
        ["Loss of thickness", "1 − h/h₀", "%"],
        100.0,
        |film| &film.thickness_ratio,
        |ratio| 1.0 - ratio,
    ),
    Field::given("plastic", ["Plastic strain", "equivalent", "%"], 100.0, |film| &film.plastic_strain, |strain| strain),
    Field::given("damage", ["Damage", "share of the force lost", "%"], 100.0, |film| &film.damage, |share| share),
    Field::given("warming", ["Warming", "ΔT", "K"], 1.0, |film| &film.warming, |growth| growth),
];

/// Least upper end of the range of a field: strains below it are rounding errors.
const LEAST: f32 = 1e-6;

impl Field {
    /// A field that follows from strains: its key, its title, symbol and unit, the factor to that.
    const fn of_strains(key: &'static str, words: [&'static str; 3], factor: f32, of: fn([f32; 3]) -> f32) -> Field {
        let [title, symbol, unit] = words;
        Field { key, title, symbol, unit, factor, values: Values::Strains(of) }
    }

    /// A field that film has where it has these numbers, and what is made of them.
    const fn given(
        key: &'static str,
        words: [&'static str; 3],
        factor: f32,
        numbers: fn(&FilmState) -> &[f32],
        of: fn(f32) -> f32,
    ) -> Field {
        let [title, symbol, unit] = words;
        Field { key, title, symbol, unit, factor, values: Values::Given(numbers, of) }
    }

    /// The value of an element, by its index.
    fn value(&self, state: &FilmState, element: usize) -> f32 {
        match self.values {
            Values::Strains(of) => of(state.strains[element]),
            Values::Given(numbers, of) => numbers(state).get(element).copied().map_or(f32::NAN, of),
        }
    }

    /// The fields of faces in the states `films` at one time.
    pub fn all_in(films: &[FilmState]) -> impl Iterator<Item = &'static Field> {
        let is_shown = |field: &&Field| match field.values {
            Values::Strains(_) => true,
            Values::Given(numbers, _) => films.iter().any(|film| !numbers(film).is_empty()),
        };
        FIELDS.iter().filter(is_shown)
    }

    /// From zero to the largest value of an intact element in any of `states`, in its unit.
    pub fn range<'a>(&self, states: impl Iterator<Item = &'a FilmState>) -> [f32; 2] {
        [0.0, self.factor * states.map(|state| self.largest(state)).fold(LEAST, f32::max)]
    }

    fn largest(&self, state: &FilmState) -> f32 {
        let intact = state.failed.iter().enumerate().filter(|(_, failed)| !**failed);
        intact.map(|(element, _)| self.value(state, element)).fold(0.0, f32::max)
    }

    /// Values at the nodes of a face, in its unit: the mean of the intact patches around each that have one, zero where there is
    /// none.
    pub fn at_nodes(&self, face: &SceneFace, state: &FilmState) -> Vec<f32> {
        let mut sums = vec![(0.0_f32, 0.0_f32); face.nodes];
        let patches = face.patches.iter().zip(&state.failed).enumerate();
        let values = patches.map(|(place, (patch, failed))| (patch, *failed, self.factor * self.value(state, place)));
        for (patch, _, value) in values.filter(|(_, failed, value)| !failed && !value.is_nan()) {
            for node in corners(patch) {
                let (sum, patches) = &mut sums[*node as usize];
                *sum += value;
                *patches += 1.0;
            }
        }
        let mean = |(sum, patches): (f32, f32)| sum / patches.max(1.0);
        sums.into_iter().map(mean).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_at_nodes_are_means_of_the_intact_elements() {
        let patches = vec![[0, 1, 2, 3], [1, 4, 2, 2], [4, 5, 2, 2]];
        let face = SceneFace { nodes: 6, patches, ..SceneFace::default() };
        let state = FilmState {
            positions: vec![[0.0; 3]; 6],
            strains: vec![[0.1, 0.4, 0.3], [0.2, 0.0, -0.5], [7.0, 0.0, 0.0]],
            failed: vec![false, false, true],
            ..FilmState::default()
        };
        let at_nodes = |field: &Field| field.at_nodes(&face, &state);
        let strains = at_nodes(&FIELDS[0]);
        let expected = [40.0, 30.0, 30.0, 40.0, 20.0, 0.0];
        for (strain, expected) in strains.iter().zip(expected) {
            assert!((strain - expected).abs() < 1e-5, "{strains:?}");
        }
        assert_eq!(FIELDS.each_ref().map(|field| field.largest(&state)), [0.4, 0.2, 0.4, 0.5, 0.0, 0.0, 0.0, 0.0]);
        let thin = FilmState { thickness_ratio: vec![0.9, 0.7, 0.1], ..state.clone() };
        assert!((FIELDS[4].largest(&thin) - 0.3).abs() < 1e-6, "of the intact elements");
        let lost = FilmState { thickness_ratio: vec![f32::NAN, 0.7, 0.1], ..state.clone() };
        let losses = FIELDS[4].at_nodes(&face, &lost);
        assert_eq!([losses[0], losses[1]], [0.0, losses[4]], "without thickness there is none to lose");
        assert!((losses[4] - 30.0).abs() < 1e-4, "{losses:?}");
        let shear = at_nodes(&FIELDS[3]);
        assert!((shear[4] - 0.5_f32.to_degrees()).abs() < 1e-4, "shear is in degrees: {shear:?}");
        assert_eq!(Field::all_in(std::slice::from_ref(&state)).count(), 4);
        assert_eq!(Field::all_in(&[thin]).map(|field| field.key).last(), Some("thickness"));
    }

    #[test]
    fn a_fold_is_smooth_below_the_crease_angle() {
        // Two squares that meet at 45°.
        let rise = std::f64::consts::FRAC_PI_4.sin();
        let point = |x: f64, z: f64, y: f64| Vector3::new(x, y, z);
        let points: Vec<Vector3<f64>> = [0.0, 1.0]
            .iter()
            .flat_map(|y| [point(0.0, 0.0, *y), point(1.0, 0.0, *y), point(1.0 + rise, rise, *y)])
            .collect();
        let patches = [[0, 1, 4, 3], [1, 2, 5, 4]];
        let [smooth, sharp] = [0.5, 0.9].map(|crease| corner_normals(&points, &patches, &[true; 2], crease));
        assert!((smooth[0][1] - smooth[1][0]).norm() < 1e-12, "one normal along the fold");
        assert!((sharp[0][1] - Vector3::z()).norm() < 1e-12, "that of the patch");
        assert!((smooth[0][0] - Vector3::z()).norm() < 1e-12, "away from the fold");
        let alone = corner_normals(&points, &patches, &[true, false], 0.5);
        assert!((alone[0][1] - Vector3::z()).norm() < 1e-12, "deleted elements do not count");
        assert_eq!(alone[1], [Vector3::zeros(); 4]);
        let triangle = corner_normals(&points, &[[0, 1, 4, 4]], &[true], 0.5);
        assert!((triangle[0][0] - Vector3::z()).norm() < 1e-12);
    }

    /// Eight corners with three normals each; a slanted one of a flat pyramid, one for all around.
    #[test]
    fn edges_are_sharp_and_what_is_round_is_smooth() {
        let vertices = |points: &[Vector3<f64>], patches: &[[u32; 4]]| {
            let normals = corner_normals(points, patches, &vec![true; patches.len()], 0.866);
            Vertices::new(patches, &normals, |c| c as f32)
        };
        let cube: Vec<_> =
            (0..8).map(|corner| Vector3::new(corner & 1, corner >> 1 & 1, corner >> 2).map(f64::from)).collect();
        let sides = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let corners = vertices(&cube, &sides);
        assert_eq!((corners.points.len(), corners.triangles.len()), (24, 12));
        for triangle in &corners.triangles {
            let normals = triangle.map(|corner| corners.normals[corner as usize]);
            assert!(normals.iter().all(|normal| *normal == normals[0]), "{normals:?}");
        }

        let around = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 0.1]];
        let pyramid = around.map(Vector3::from);
        let corners = vertices(&pyramid, &[[0, 1, 4, 4], [1, 2, 4, 4], [2, 3, 4, 4], [3, 0, 4, 4]]);
        let tip: Vec<_> = corners.points.iter().zip(&corners.normals).filter(|(point, _)| **point == 4).collect();
        assert_eq!(tip.iter().map(|(_, normal)| **normal).collect::<Vec<_>>(), [[0.0, 0.0, 1.0]]);
    }
}
