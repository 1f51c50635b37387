//! The film on a page: snapshots of faces and impactors, in few enough bytes to send the page by mail.

use std::collections::BTreeSet;

use crate::coarse::CoarseSurface;
use crate::drawn::DIGITS;
use crate::film_data::FilmData;
use crate::geometry::{Moment, RunScene, SceneBody, SceneFace, is_finite};
use crate::html::{data, escape};
use base::number::rounded;
use lab::signal::{Recording, column};
use membrane::engine::Surface;
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

/// The figure with the film in 3-D, as HTML that the page's script draws; empty without snapshots.
pub(crate) fn figure(model: &Model, outcome: &Outcome, signals: &Recording) -> String {
    let moments = moments(model, outcome, signals);
    let Some(scene) = page_scene(&outcome.films, &outcome.impactors, &outcome.snapshots, moments) else {
        return String::new();
    };
    let (data, note) = (data(&FilmData::of_scene(&scene)), note(&scene, outcome));
    format!("<figure class=\"film\">\n{data}<figcaption class=\"note\">{}</figcaption>\n</figure>\n", escape(&note))
}

/// The scene of a page: of fine meshes patches of several elements, and so many of the snapshots that its size allows. The ends
/// of springs are the last nodes of each face. `None` without a snapshot that can be drawn.
fn page_scene(films: &[Film], impactors: &[Surface], snapshots: &[Snapshot], moments: Vec<Moment>) -> Option<RunScene> {
    let snapshots: Vec<&Snapshot> = snapshots.iter().filter(|snapshot| is_finite(snapshot)).collect();
    let faces = coarse_faces(films, snapshots.first()?);
    let bytes: usize = faces.iter().map(CoarseFace::bytes).sum();
    let most = (MOST_BYTES / bytes.max(1)).clamp(2, MOST_STATES);
    let state = |at: usize| {
        let Snapshot { time, films, impactors } = snapshots[at];
        let films = faces.iter().zip(films).map(|(face, film)| face.state(film)).collect();
        Snapshot { time: *time, films, impactors: impactors.clone() }
    };
    let states = chosen_snapshots(&snapshots, &moments, most).into_iter().map(state).collect();
    let body = |surface: &Surface| {
        let SceneBody { points, patches } = SceneBody::from_surface(surface, SIDES);
        let single: Vec<[f32; 3]> = points.iter().map(|point| point.map(|c| c as f32)).collect();
        let coarse = CoarseSurface::from_points(&single, &patches, MOST_OF_BODY);
        let points = coarse.of_nodes(&points).into_iter().map(|point| point.map(|c| rounded(c, DIGITS)));
        SceneBody { points: points.collect(), patches: coarse.patches }
    };
    Some(RunScene {
        bodies: impactors.iter().map(body).collect(),
        is_coarsened: faces.iter().zip(films).any(|(face, film)| face.surface.patches.len() < film.outlines().count()),
        faces: faces.into_iter().zip(films).map(|(face, film)| face.face(film)).collect(),
        states,
        moments,
    })
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

/// One face of film as a page shows it.
struct CoarseFace {
    surface: CoarseSurface,
    /// The springs that are drawn.
    springs: Vec<FilmSpring>,
}

impl CoarseFace {
    /// Size of one snapshot, bytes.
    fn bytes(&self) -> usize {
        6 * (self.surface.nodes.len() + self.springs.len()) + 3 * self.surface.patches.len()
    }

    fn face(self, film: &Film) -> SceneFace {
        let first = self.surface.nodes.len();
        let springs =
            (first as u32..).zip(&self.springs).map(|(node, spring)| FilmSpring::at_node(node, spring.anchor));
        SceneFace {
            nodes: first + self.springs.len(),
            springs: springs.collect(),
            held: self.surface.edges(&film.held),
            patches: self.surface.patches,
            mirrored: film.mirrored,
        }
    }

    /// The part of a state of the film that is drawn.
    fn state(&self, film: &FilmState) -> FilmState {
        let ends = self.springs.iter().map(|spring| spring.end(&film.positions));
        let elements = || self.surface.element.iter().map(|element| *element as usize);
        let is_finite = |strains: &[f32; 3]| strains.iter().all(|strain| strain.is_finite());
        FilmState {
            positions: self.surface.of_nodes(&film.positions).into_iter().chain(ends).collect(),
            strains: elements().map(|element| film.strains[element]).collect(),
            failed: elements().map(|element| film.failed[element] || !is_finite(&film.strains[element])).collect(),
            ..FilmState::default()
        }
    }
}

fn coarse_faces(films: &[Film], first: &Snapshot) -> Vec<CoarseFace> {
    let images = |film: &Film| 1 << film.mirrored.iter().filter(|mirrored| **mirrored).count();
    let drawn: usize = films.iter().map(|film| images(film) * film.outlines().count()).sum();
    let face = |(film, state): (&Film, &FilmState)| {
        let outlines: Vec<[u32; 4]> = film.outlines().collect();
        // Patches are shared out by the numbers of elements.
        let share = (outlines.len() as f64 * (MOST_PATCHES as f64 / drawn as f64).min(1.0)) as usize;
        let surface = CoarseSurface::from_points(&state.positions, &outlines, share.max(LEAST_PATCHES));
        let springs = film.springs.iter().step_by(film.springs.len().div_ceil(MOST_SPRINGS).max(1)).copied().collect();
        CoarseFace { surface, springs }
    };
    films.iter().zip(&first.films).map(face).collect()
}

/// The caption: how many snapshots and patches are shown.
fn note(scene: &RunScene, outcome: &Outcome) -> String {
    let mut note = format!(
        "{} of {} snapshots, interpolated in between; displacements to scale, failed elements left out.",
        scene.states.len(),
        outcome.snapshots.len()
    );
    let shown: usize = scene.faces.iter().map(|face| face.patches.len()).sum();
    let elements: usize = outcome.films.iter().map(|film| film.outlines().count()).sum();
    if shown < elements {
        note += &format!(" The mesh is coarsened for the page: {shown} patches represent its {elements} elements.");
    }
    let springs: usize = outcome.films.iter().map(|film| film.springs.len()).sum();
    let drawn: usize = scene.faces.iter().map(|face| face.springs.len()).sum();
    if drawn < springs {
        note += &format!(" {drawn} of {springs} springs are drawn.");
    }
    if outcome.films.iter().any(|film| film.mirrored.contains(&true)) {
        note += " The part that was computed is mirrored into the whole film.";
    }
    note
}

#[cfg(test)]
pub mod tests {
    use super::*;

    /// A square sheet of `n` × `n` quadrilaterals.
    pub fn sheet(n: u32) -> (Vec<[f32; 3]>, Film) {
        let row = n + 1;
        let points =
            (0..row * row).map(|at| [(at % row) as f32 / n as f32, (at / row) as f32 / n as f32, 0.0]).collect();
        let corner = |at: u32| at / n * row + at % n;
        let quads = (0..n * n).map(|at| [corner(at), corner(at) + 1, corner(at) + row + 1, corner(at) + row]).collect();
        (points, Film { nodes: (row * row) as usize, quads, mirrored: [true; 2], ..Film::default() })
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
    fn a_face_of_few_elements_is_drawn_beside_a_fine_one() {
        let (fine, small) = (sheet(200), sheet(1));
        let states = [&fine, &small].map(|(points, film)| snapshot(0.0, points, film).films.remove(0));
        let first = Snapshot { time: 0.0, films: states.into(), impactors: vec![] };
        let patches: Vec<usize> =
            coarse_faces(&[fine.1, small.1], &first).iter().map(|face| face.surface.patches.len()).collect();
        assert!(patches[0] > 500 && patches[1] == 1, "{patches:?}");
    }

    #[test]
    fn a_page_holds_the_lines_of_springs() {
        let (points, sheet) = sheet(2);
        let spring = |y: f32| FilmSpring { anchor: [-0.25, y, 0.125], nodes: [0, 3], shares: [1.0 - 2.0 * y, 2.0 * y] };
        let all = 2 * MOST_SPRINGS;
        let springs: Vec<FilmSpring> = (0..all).map(|at| spring(0.5 * at as f32 / all as f32)).collect();
        let film = Film { springs, ..sheet };
        let states = [snapshot(0.0, &points, &film)];
        let scene = page_scene(&[film], &[], &states, vec![]).expect("a scene");
        let stored = FilmData::of_scene(&scene).scene().expect("a scene");
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
        let scene = page_scene(&[film], &[], &snapshots, vec![]).expect("a scene");
        let text = data(&FilmData::of_scene(&scene));
        assert!(scene.is_coarsened && text.len() < 1_400_000, "{}", text.len());
    }
}
