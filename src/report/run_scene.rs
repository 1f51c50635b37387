//! The scene of a run: the faces of film with the fields that colour them, the impactors and the bars of the frame.

use std::f32::consts::PI;

use membrane::engine::Surface;
use scene::simulate::{Film, FilmSpring, FilmState, Image, Outcome, Snapshot};

/// Sides of a round impactor.
const SIDES: u32 = 72;

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
#[derive(Clone, Debug)]
pub struct SceneFace {
    /// Number of nodes.
    pub nodes: usize,
    /// Nodes at the corners of each patch, an element or several; a triangle has its last corner twice.
    pub patches: Vec<[u32; 4]>,
    /// Whether x = 0 and y = 0 are mirror planes.
    pub mirrored: [bool; 2],
    /// Springs of the frame on which it hangs.
    pub springs: Vec<FilmSpring>,
}

/// Surface of a body about its centre of mass.
#[derive(Clone, Debug)]
pub struct SceneBody {
    /// Vertices, m.
    pub points: Vec<[f32; 3]>,
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

impl SceneFace {
    /// The lines of its springs, from the frame to the film.
    pub fn spring_lines(&self, film: &FilmState) -> impl Iterator<Item = [[f32; 3]; 2]> {
        self.springs.iter().map(|spring| [spring.anchor, spring.end(&film.positions)])
    }

    /// The face and its mirror images.
    pub fn images(&self) -> impl Iterator<Item = Image> + use<> {
        Image::all(self.mirrored)
    }
}

impl SceneBody {
    /// The triangulated `surface` of an impactor; round shapes have `sides` sides.
    pub(crate) fn from_surface(surface: &Surface, sides: u32) -> SceneBody {
        let (points, triangles) = surface.triangles(sides);
        let single = |point: &nalgebra::Point3<f64>| <[f64; 3]>::from(point.coords).map(|c| c as f32);
        SceneBody {
            points: points.iter().map(single).collect(),
            patches: triangles.iter().map(|&[a, b, c]| [a, b, c, c]).collect(),
        }
    }
}

impl RunScene {
    /// Every element of `outcome` in all its snapshots; `None` without snapshots.
    pub(crate) fn of_outcome(outcome: &Outcome, moments: Vec<Moment>) -> Option<RunScene> {
        let states = outcome.snapshots.clone();
        let face = |film: &Film| SceneFace {
            nodes: film.nodes,
            patches: film.outlines().collect(),
            mirrored: film.mirrored,
            springs: film.springs.clone(),
        };
        let scene = RunScene {
            faces: outcome.films.iter().map(face).collect(),
            bodies: outcome.impactors.iter().map(|surface| SceneBody::from_surface(surface, SIDES)).collect(),
            states,
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

    /// Values at the nodes of a face, in its unit: the mean of the intact elements around each, zero where there is none.
    /// An element that is a triangle has its last corner twice.
    pub fn at_nodes(&self, nodes: usize, elements: impl Iterator<Item = [u32; 4]>, state: &FilmState) -> Vec<f32> {
        let mut sums = vec![(0.0_f32, 0.0_f32); nodes];
        for (element, (corners, _)) in elements.zip(&state.failed).enumerate().filter(|(_, (_, failed))| !**failed) {
            let corners = if corners[2] == corners[3] { &corners[..3] } else { &corners[..] };
            for node in corners {
                let (sum, elements) = &mut sums[*node as usize];
                *sum += self.factor * self.value(state, element);
                *elements += 1.0;
            }
        }
        let mean = |(sum, elements): (f32, f32)| sum / elements.max(1.0);
        sums.into_iter().map(mean).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_at_nodes_are_means_of_the_intact_elements() {
        let elements = [[0, 1, 2, 3], [1, 4, 2, 2], [4, 5, 2, 2]];
        let state = FilmState {
            positions: vec![[0.0; 3]; 6],
            strains: vec![[0.1, 0.4, 0.3], [0.2, 0.0, -0.5], [7.0, 0.0, 0.0]],
            failed: vec![false, false, true],
            ..FilmState::default()
        };
        let at_nodes = |field: &Field| field.at_nodes(6, elements.into_iter(), &state);
        let strains = at_nodes(&FIELDS[0]);
        let expected = [40.0, 30.0, 30.0, 40.0, 20.0, 0.0];
        for (strain, expected) in strains.iter().zip(expected) {
            assert!((strain - expected).abs() < 1e-5, "{strains:?}");
        }
        assert_eq!(FIELDS.each_ref().map(|field| field.largest(&state)), [0.4, 0.2, 0.4, 0.5, 0.0, 0.0, 0.0, 0.0]);
        let thin = FilmState { thickness_ratio: vec![0.9, 0.7, 0.1], ..state.clone() };
        assert!((FIELDS[4].largest(&thin) - 0.3).abs() < 1e-6, "of the intact elements");
        let shear = at_nodes(&FIELDS[3]);
        assert!((shear[4] - 0.5_f32.to_degrees()).abs() < 1e-4, "shear is in degrees: {shear:?}");
        assert_eq!(Field::all_in(std::slice::from_ref(&state)).count(), 4);
        assert_eq!(Field::all_in(&[thin]).map(|field| field.key).last(), Some("thickness"));
    }
}
