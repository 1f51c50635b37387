//! The film on a page: snapshots of faces and impactors, in few enough bytes to send the page by mail.

use std::collections::BTreeSet;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde_json::{Value, json};

use crate::coarse::{CoarseSurface, bounds};
use crate::drawn::DIGITS;
use crate::html::{data, escape};
use crate::run_scene::{Moment, RunScene, SceneBody};
use base::number::rounded;
use lab::signal::{Recording, column};
use scene::model::Model;
use scene::model::loading::Test;
use scene::simulate::{Film, FilmSpring, FilmState, Outcome, Snapshot};
use study::post::lowest_point;

/// Most snapshots on a page.
const MOST_STATES: usize = 32;

/// Most bytes of all snapshots; base64 makes a third more of them.
const MOST_BYTES: usize = 900_000;

/// Most patches of the whole film, mirror images included; more are slow to draw.
const MOST_PATCHES: usize = 8_000;

/// Most springs of a face; of more every second one is drawn, every third …
const MOST_SPRINGS: usize = 240;

/// Least patches of a face beside faces with very many elements.
const LEAST_PATCHES: usize = 8;

/// Most patches of an impactor that is a mesh.
const MOST_OF_BODY: usize = 2_000;

/// Sides of a round impactor.
const SIDES: u32 = 36;

/// The byte of a strain that marks a failed element; others are below.
pub(crate) const FAILED: u8 = u8::MAX;

/// The figure with the film in 3-D, as HTML that the page's script draws; empty without snapshots.
pub(crate) fn figure(model: &Model, outcome: &Outcome, signals: &Recording) -> String {
    let snapshots: Vec<&Snapshot> = outcome.snapshots.iter().filter(|snapshot| is_finite(snapshot)).collect();
    let Some(first) = snapshots.first() else {
        return String::new();
    };
    let faces = faces(&outcome.films, first);
    let bytes: usize = faces.iter().map(Face::bytes).sum();
    let most = (MOST_BYTES / bytes.max(1)).clamp(2, MOST_STATES);
    let moments = moments(model, outcome, signals);
    let chosen = chosen_snapshots(&snapshots, &moments, most);
    let states: Vec<&Snapshot> = chosen.iter().map(|at| snapshots[*at]).collect();
    let bodies = outcome.impactors.iter().map(|surface| SceneBody::from_surface(surface, SIDES)).collect();
    let scene = Scene { faces, states, moments, bodies };
    let note = scene.note(outcome);
    let data = data(&scene.contents());
    format!("<figure class=\"film\">\n{data}<figcaption class=\"note\">{}</figcaption>\n</figure>\n", escape(&note))
}

/// The scene of a run with every element in all its snapshots, and the moments that its page has; `None` without
/// snapshots.
pub fn run_scene(model: &Model, outcome: &Outcome, signals: &Recording) -> Option<RunScene> {
    RunScene::of_outcome(outcome, moments(model, outcome, signals))
}

/// The events of a run that a page jumps to.
fn moments(model: &Model, outcome: &Outcome, signals: &Recording) -> Vec<Moment> {
    let peak = |channel: &str| Some(signals.series(channel)?.largest()?[0]);
    let moment = |words, time| Moment { words, time };
    let mut moments = Vec::new();
    if model.loading.test() == Test::Impact {
        for (name, prefix) in model.names().into_iter().zip(model.prefixes()) {
            let words = |what: &str| name.map_or_else(|| what.to_owned(), |name| format!("{what}, {name}"));
            let braking = peak(&format!("{prefix}{}", column::ACCELERATION_FILTERED.name));
            moments.extend(braking.map(|time| moment(words("largest deceleration"), time)));
            moments.extend(lowest_point(signals, &prefix).map(|[time, _]| moment(words("lowest point"), time)));
        }
    } else {
        moments.extend(peak(column::FORCE.name).map(|time| moment("largest force".to_owned(), time)));
    }
    moments.extend(outcome.rupture_time.map(|time| moment("rupture".to_owned(), time)));
    moments.sort_by(|a, b| a.time.total_cmp(&b.time));
    moments
}

/// Indices of at most `most` snapshots: the first and the last, those at the moments or next after them, and others
/// evenly between.
fn chosen_snapshots(snapshots: &[&Snapshot], moments: &[Moment], most: usize) -> BTreeSet<usize> {
    let last = snapshots.len() - 1;
    // A failed element is shown failed in the next snapshot.
    let after = |time: f64| snapshots.partition_point(|snapshot| snapshot.time < time).min(last);
    let wanted = [0, last].into_iter().chain(moments.iter().map(|moment| after(moment.time)));
    let mut chosen = BTreeSet::new();
    for at in wanted {
        if chosen.len() < most {
            chosen.insert(at);
        }
    }
    let others = most - chosen.len();
    chosen.extend((1..=others).map(|other| other * last / (others + 1)));
    chosen
}

pub(crate) fn is_finite(snapshot: &Snapshot) -> bool {
    let finite = |place: &[f32; 3]| place.iter().all(|c| c.is_finite());
    let bodies = &snapshot.impactors;
    let placed = bodies.iter().all(|(position, rotation)| position.iter().chain(rotation).all(|c| c.is_finite()));
    placed && snapshot.films.iter().all(|film| film.positions.iter().all(finite))
}

/// One face of film as it is drawn.
struct Face {
    index: usize,
    mirrored: [bool; 2],
    /// Number of its elements.
    elements: usize,
    surface: CoarseSurface,
    /// The springs that are drawn.
    springs: Vec<FilmSpring>,
}

impl Face {
    /// Positions of its nodes and after them of the ends of its springs, from those of all nodes of the mesh.
    fn positions(&self, points: &[[f32; 3]]) -> Vec<[f32; 3]> {
        let ends = self.springs.iter().map(|spring| spring.end(points));
        self.surface.positions(points).into_iter().chain(ends).collect()
    }

    /// Size of one snapshot, bytes.
    fn bytes(&self) -> usize {
        6 * (self.surface.nodes.len() + self.springs.len()) + 3 * self.surface.patches.len()
    }
}

fn faces(films: &[Film], first: &Snapshot) -> Vec<Face> {
    let images = |film: &Film| 1 << film.mirrored.iter().filter(|mirrored| **mirrored).count();
    let drawn: usize = films.iter().map(|film| images(film) * (film.quads.len() + film.tris.len())).sum();
    let face = |(index, film): (usize, &Film)| {
        let outlines: Vec<[u32; 4]> = film.outlines().collect();
        // Patches are shared out by the numbers of elements.
        let share = (outlines.len() as f64 * (MOST_PATCHES as f64 / drawn as f64).min(1.0)) as usize;
        let surface = CoarseSurface::from_points(&first.films[index].positions, &outlines, share.max(LEAST_PATCHES));
        let springs = film.springs.iter().step_by(film.springs.len().div_ceil(MOST_SPRINGS).max(1)).copied().collect();
        Face { index, mirrored: film.mirrored, elements: outlines.len(), surface, springs }
    };
    films.iter().enumerate().map(face).collect()
}

/// The scene that is drawn.
struct Scene<'a> {
    faces: Vec<Face>,
    states: Vec<&'a Snapshot>,
    moments: Vec<Moment>,
    bodies: Vec<SceneBody>,
}

impl Scene<'_> {
    fn contents(&self) -> Value {
        let places: Vec<Vec<[f32; 3]>> = self.states.iter().map(|state| self.places(state)).collect();
        let ends = bounds(self.states.iter().flat_map(|state| self.intact(state)));
        // Compressive fibre strains have the colour of zero.
        let fibre = self.range(|[md, td, _]| [md.max(0.0), td.max(0.0)]);
        let shear = self.range(|[_, _, shear]| [*shear; 2]);
        let state = |(state, places): (&&Snapshot, &Vec<[f32; 3]>)| {
            let strains: Vec<u8> =
                self.faces.iter().flat_map(|face| strains(face, state, [fibre, fibre, shear])).collect();
            let pose = |(position, rotation): &([f64; 3], [f64; 4])| {
                position.iter().chain(rotation).map(|c| rounded(*c, DIGITS)).collect::<Vec<_>>()
            };
            json!({
                "time": rounded(state.time * 1e3, DIGITS),
                "places": text(quantised(places, ends).flat_map(u16::to_le_bytes)),
                "strains": text(strains),
                "poses": state.impactors.iter().map(pose).collect::<Vec<_>>(),
            })
        };
        let moment = |Moment { words, time }: &Moment| json!([words, rounded(time * 1e3, DIGITS)]);
        let face = |face: &Face| {
            json!({
                "nodes": face.surface.nodes.len() + face.springs.len(),
                "patches": text(face.surface.corners().flat_map(u32::to_le_bytes)),
                "mirrored": face.mirrored,
                "springs": face.springs.iter().map(|spring| spring.anchor.map(near)).collect::<Vec<_>>(),
            })
        };
        json!({
            "box": ends,
            "fibre": fibre,
            "shear": shear,
            "faces": self.faces.iter().map(face).collect::<Vec<_>>(),
            "states": self.states.iter().zip(&places).map(state).collect::<Vec<_>>(),
            "moments": self.moments.iter().map(moment).collect::<Vec<_>>(),
            "bodies": self.bodies.iter().map(body).collect::<Vec<_>>(),
            "coarsened": self.faces.iter().any(|face| face.surface.patches.len() < face.elements),
        })
    }

    /// Positions of the nodes of all faces and of the ends of their springs.
    fn places(&self, state: &Snapshot) -> Vec<[f32; 3]> {
        self.faces.iter().flat_map(|face| face.positions(&state.films[face.index].positions)).collect()
    }

    /// Positions of the corners of intact elements; nodes of failed ones may be anywhere.
    fn intact(&self, state: &Snapshot) -> impl Iterator<Item = [f32; 3]> {
        self.faces.iter().flat_map(|Face { index, surface, .. }| {
            let film = &state.films[*index];
            let intact = surface.patches.iter().zip(&surface.element).filter(|(_, element)| is_intact(film, **element));
            intact.flat_map(|(patch, _)| patch.map(|node| film.positions[surface.nodes[node as usize] as usize]))
        })
    }

    /// Smallest and largest strain of intact elements that are drawn; the range is never empty.
    fn range(&self, of: fn(&[f32; 3]) -> [f32; 2]) -> [f32; 2] {
        let states =
            self.states.iter().flat_map(|state| self.faces.iter().map(|face| (&state.films[face.index], face)));
        let values = states.flat_map(|(film, face)| {
            let intact = face.surface.element.iter().filter(|at| is_intact(film, **at));
            intact.flat_map(|at| of(&film.strains[*at as usize]))
        });
        let [low, high] = values.fold([0.0_f32, 0.0], |[low, high], value| [low.min(value), high.max(value)]);
        if high - low > 1e-6 { [low, high] } else { [low, low + 1e-6] }
    }

    /// The caption: how many snapshots and patches are shown.
    fn note(&self, outcome: &Outcome) -> String {
        let mut note = format!(
            "{} of {} snapshots, interpolated in between; displacements to scale, failed elements left out.",
            self.states.len(),
            outcome.snapshots.len()
        );
        let shown: usize = self.faces.iter().map(|face| face.surface.patches.len()).sum();
        let elements: usize = outcome.films.iter().map(|film| film.quads.len() + film.tris.len()).sum();
        if shown < elements {
            note += &format!(" The mesh is coarsened for the page: {shown} patches represent its {elements} elements.");
        }
        let springs: usize = outcome.films.iter().map(|film| film.springs.len()).sum();
        let drawn: usize = self.faces.iter().map(|face| face.springs.len()).sum();
        if drawn < springs {
            note += &format!(" {drawn} of {springs} springs are drawn.");
        }
        if outcome.films.iter().any(|film| film.mirrored.contains(&true)) {
            note += " The part that was computed is mirrored into the whole film.";
        }
        note
    }
}

/// Whether an element is neither failed nor without finite strains.
fn is_intact(film: &FilmState, element: u32) -> bool {
    let at = element as usize;
    !film.failed[at] && film.strains[at].iter().all(|strain| strain.is_finite())
}

/// Strains along MD and TD and shear of each patch, as shares of their ranges, clamped to them.
fn strains(face: &Face, state: &Snapshot, ranges: [[f32; 2]; 3]) -> Vec<u8> {
    let film = &state.films[face.index];
    let share =
        |value: f32, [low, high]: [f32; 2]| ((value - low) / (high - low) * f32::from(FAILED - 1)).round() as u8;
    let patch = |at: &u32| match is_intact(film, *at) {
        true => [0, 1, 2].map(|part| share(film.strains[*at as usize][part], ranges[part])),
        false => [FAILED; 3],
    };
    face.surface.element.iter().flat_map(patch).collect()
}

/// Coordinates as shares of the box along each axis.
fn quantised(places: &[[f32; 3]], [low, high]: [[f32; 3]; 2]) -> impl Iterator<Item = u16> {
    let most = f32::from(u16::MAX);
    let share = move |axis: usize, value: f32| {
        let extent = high[axis] - low[axis];
        if extent > 0.0 { ((value - low[axis]) / extent * most).round() as u16 } else { 0 }
    };
    places.iter().flat_map(move |place| [0, 1, 2].map(|axis| share(axis, place[axis])))
}

fn text(bytes: impl IntoIterator<Item = u8>) -> String {
    STANDARD.encode(bytes.into_iter().collect::<Vec<u8>>())
}

/// A coordinate with the digits of a page.
fn near(c: f32) -> f64 {
    rounded(f64::from(c), DIGITS)
}

fn body(SceneBody { points, patches }: &SceneBody) -> Value {
    let coarse = CoarseSurface::from_points(points, patches, MOST_OF_BODY);
    let places = coarse.positions(points);
    json!({ "points": places.iter().map(|place| place.map(near)).collect::<Vec<_>>(), "patches": coarse.patches })
}

#[cfg(test)]
pub mod tests {
    use scene::mesh::{Mesh, Quality};

    use super::*;
    use crate::stored;

    /// A square sheet of `n` × `n` quadrilaterals.
    pub fn sheet(n: u32) -> (Vec<[f32; 3]>, Film) {
        let row = n + 1;
        let points =
            (0..row * row).map(|at| [(at % row) as f32 / n as f32, (at / row) as f32 / n as f32, 0.0]).collect();
        let corner = |at: u32| at / n * row + at % n;
        let quads = (0..n * n).map(|at| [corner(at), corner(at) + 1, corner(at) + row + 1, corner(at) + row]).collect();
        let quality = Quality::from_mesh(&Mesh::default());
        (
            points,
            Film {
                nodes: (row * row) as usize,
                quads,
                tris: vec![],
                mirrored: [true; 2],
                held: vec![],
                springs: vec![],
                quality,
            },
        )
    }

    fn snapshot(time: f64, points: &[[f32; 3]], film: &Film) -> Snapshot {
        let state = FilmState {
            positions: points.to_vec(),
            strains: vec![[0.1, 0.5, -0.2]; film.quads.len()],
            failed: (0..film.quads.len()).map(|at| at == 0).collect(),
            ..FilmState::default()
        };
        Snapshot { time, films: vec![state], impactors: vec![] }
    }

    #[test]
    fn a_film_is_read_back_as_it_was_written() {
        let (points, film) = sheet(3);
        let bodies =
            vec![SceneBody { points: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.5]], patches: vec![[0, 1, 2, 2]] }];
        let pose = ([0.5, 0.25, 0.125], [0.0, 0.0, 0.6, 0.8]);
        let states = [0.0, 1.5e-3].map(|time| Snapshot { impactors: vec![pose], ..snapshot(time, &points, &film) });
        let moments = vec![Moment { words: "lowest point".into(), time: 1.5e-3 }];
        let written = Scene { faces: faces(&[film], &states[0]), states: states.iter().collect(), moments, bodies };
        let found = stored::film_scene(&written.contents()).expect("a film");
        assert_eq!((found.faces.len(), found.faces[0].nodes, found.faces[0].mirrored), (1, 16, [true; 2]));
        assert_eq!(found.faces[0].patches, written.faces[0].surface.patches);
        assert_eq!((&found.moments, found.is_coarsened), (&written.moments, false));
        assert_eq!((&found.bodies[0].points, found.bodies[0].patches[0]), (&written.bodies[0].points, [0, 1, 2, 2]));
        for (found, written) in found.states.iter().zip(&states) {
            assert_eq!((found.time, &found.impactors), (written.time, &written.impactors));
            let [film, own] = [&found.films[0], &written.films[0]];
            assert_eq!(film.failed, own.failed);
            let near = |a: &[f32; 3], b: &[f32; 3]| (0..3).all(|k| (a[k] - b[k]).abs() <= 2e-3);
            assert!(film.positions.iter().zip(&own.positions).all(|(a, b)| near(a, b)));
            assert!(film.strains.iter().zip(&own.strains).skip(1).all(|(a, b)| near(a, b)), "{:?}", film.strains);
        }
        let mut damaged = written.contents();
        damaged["states"][0]["strains"] = "AAAA".into();
        let fault = |damaged: &Value| stored::film_scene(damaged).expect_err("a mismatch");
        assert_eq!(fault(&damaged), "strains and patches of the film do not fit together");
        damaged["faces"][0]["nodes"] = 5.into();
        assert_eq!(fault(&damaged), "corners and nodes of the film do not fit together");
    }

    #[test]
    fn a_face_of_few_elements_is_drawn_beside_a_fine_one() {
        let (fine, small) = (sheet(200), sheet(1));
        let states = [&fine, &small].map(|(points, film)| snapshot(0.0, points, film).films.remove(0));
        let first = Snapshot { time: 0.0, films: states.into(), impactors: vec![] };
        let patches: Vec<usize> =
            faces(&[fine.1, small.1], &first).iter().map(|face| face.surface.patches.len()).collect();
        assert!(patches[0] > 500 && patches[1] == 1, "{patches:?}");
    }

    #[test]
    fn failed_elements_do_not_extend_the_bounds() {
        let (mut points, film) = sheet(2);
        let outlines: Vec<[u32; 4]> = film.outlines().collect();
        let face = Face {
            index: 0,
            mirrored: film.mirrored,
            elements: outlines.len(),
            surface: CoarseSurface::from_points(&points, &outlines, 100),
            springs: vec![],
        };
        // A corner of the first element alone, which has failed.
        points[0] = [-1e6; 3];
        let state = snapshot(0.0, &points, &film);
        let scene = Scene { faces: vec![face], states: vec![&state], moments: vec![], bodies: vec![] };
        assert_eq!(scene.contents()["box"], json!([[0.0, 0.0, 0.0], [1.0, 1.0, 0.0]]));
    }

    #[test]
    fn a_page_holds_the_lines_of_springs() {
        let (points, sheet) = sheet(2);
        let spring = |y: f32| FilmSpring { anchor: [-0.25, y, 0.125], nodes: [0, 3], shares: [1.0 - 2.0 * y, 2.0 * y] };
        let all = 2 * MOST_SPRINGS;
        let springs: Vec<FilmSpring> = (0..all).map(|at| spring(0.5 * at as f32 / all as f32)).collect();
        let film = Film { springs, ..sheet };
        let state = snapshot(0.0, &points, &film);
        let scene = Scene { faces: faces(&[film], &state), states: vec![&state], moments: vec![], bodies: vec![] };
        let stored = stored::film_scene(&scene.contents()).unwrap();
        let face = &stored.faces[0];
        let lines: Vec<[[f32; 3]; 2]> = face.spring_lines(&stored.states[0].films[0]).collect();
        assert_eq!(lines.len(), MOST_SPRINGS, "every second one");
        for (at, [anchor, end]) in lines.into_iter().enumerate() {
            let y = at as f32 / all as f32;
            assert!((anchor[1] - y).abs() < 1e-6 && anchor[2] == 0.125, "{anchor:?}");
            assert!(end[0].abs() < 1e-4 && (end[1] - y).abs() < 1e-4, "{at}: {end:?}");
        }
        assert!(face.patches.iter().flatten().all(|node| (*node as usize) < face.nodes - MOST_SPRINGS));
    }

    #[test]
    fn chosen_snapshots_include_the_moments() {
        let (points, film) = sheet(1);
        let snapshots: Vec<Snapshot> = (0..240).map(|at| snapshot(f64::from(at) * 0.5e-3, &points, &film)).collect();
        let snapshots: Vec<&Snapshot> = snapshots.iter().collect();
        let at = |words: &str, time| Moment { words: words.into(), time };
        let chosen = chosen_snapshots(&snapshots, &[at("lowest point", 57.3e-3), at("rupture", 80.2e-3)], 32);
        assert!(chosen.len() <= 32 && chosen.len() > 28, "{}", chosen.len());
        assert!([0, 239, 115, 161].iter().all(|at| chosen.contains(at)), "{chosen:?}");
        assert_eq!(chosen_snapshots(&snapshots[..1], &[at("lowest point", 1.0)], 32).len(), 1);
    }

    #[test]
    fn the_largest_film_stays_below_its_size_limit() {
        let (points, film) = sheet(300);
        let snapshots: Vec<Snapshot> = (0..40).map(|at| snapshot(f64::from(at), &points, &film)).collect();
        let outlines: Vec<[u32; 4]> = film.outlines().collect();
        let surface = CoarseSurface::from_points(&points, &outlines, MOST_PATCHES / 4);
        let face = Face { index: 0, mirrored: film.mirrored, elements: outlines.len(), surface, springs: vec![] };
        let most = (MOST_BYTES / face.bytes()).clamp(2, MOST_STATES);
        let states = snapshots.iter().take(most).collect();
        let scene = Scene { faces: vec![face], states, moments: vec![], bodies: vec![] };
        let text = data(&scene.contents());
        assert!(text.len() < 1_400_000, "{}", text.len());
    }
}
