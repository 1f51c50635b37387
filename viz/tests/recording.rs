//! Writes a recording and reads it back.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::BufReader;
use std::path::Path;

use droptower_viz::{
    Axis, BodyShape, BodyTrack, Chart, Curve, Diagram, Document, Event, FilmFrame, FilmTrack, ITERATION, Look, Moment,
    Places, Pose, Quantity, Scene, Severity, SignalTrack, State, Stroke, TIME, VizError, write,
};
use re_log_encoding::DecoderApp;
use re_sdk::TimelineName;
use re_sdk::log::{Chunk, LogMsg};
use re_sdk_types::archetypes::{LineStrips2D, LineStrips3D, Mesh3D, Points3D, Scalars, Transform3D};
use re_sdk_types::blueprint::components::{TimelineName as BlueprintTimeline, ViewClass};
use re_sdk_types::components::{Color, LineStrip2D, LineStrip3D, Position3D, Scalar, TriangleIndices};
use re_sdk_types::external::re_types_core::Loggable;
use re_sdk_types::{ComponentDescriptor, ComponentIdentifier};

/// A square of n × n cells that sinks to a depth of one tenth, over `frames` states.
fn film(n: u32, frames: usize) -> FilmTrack {
    let node = |column: u32, row: u32| row * (n + 1) + column;
    let cell = |row: u32, column: u32| {
        let [a, b] = [node(column, row), node(column + 1, row)];
        let [c, d] = [node(column + 1, row + 1), node(column, row + 1)];
        [[a, b, c], [a, c, d]]
    };
    let cells = (0..n).flat_map(|row| (0..n).map(move |column| [row, column]));
    FilmTrack {
        name: "film".to_owned(),
        triangles: cells.flat_map(|[row, column]| cell(row, column)).collect(),
        held: vec![[0, 1]],
        mirrored: [true, true],
        frames: (0..frames).map(|index| state(n, index, frames)).collect(),
    }
}

/// Sinks like a membrane under a sphere, with a ripple so that every digit moves.
fn state(n: u32, index: usize, frames: usize) -> FilmFrame {
    let share = index as f32 / (frames - 1) as f32;
    let nodes = (0..=n).flat_map(|row| (0..=n).map(move |column| [column, row]));
    let position = |[column, row]: [u32; 2]| {
        let [x, y] = [column, row].map(|i| 0.2 * i as f32 / n as f32);
        let ripple = 1e-3 * share * (97.0 * x + 61.0 * y + 40.0 * share).sin();
        [x, y, -0.1 * share * (1.0 - 25.0 * (x * x).max(y * y)) + ripple]
    };
    let positions: Vec<[f32; 3]> = nodes.map(position).collect();
    FilmFrame {
        time: index as f64 * 5e-4,
        values: vec![positions.iter().map(|p| -p[2]).collect(); 2],
        visible: vec![true; 2 * (n * n) as usize],
        touching: if index == 0 { vec![] } else { vec![0, 1, 2] },
        positions,
    }
}

fn quantity(key: &'static str) -> Quantity {
    Quantity { key, title: key.to_owned(), words: key.to_owned(), range: [0.0, 0.1] }
}

fn signal(name: &str, samples: usize) -> SignalTrack {
    SignalTrack {
        path: format!("signals/{name}"),
        label: name.to_owned(),
        places: Places::Times((0..samples).map(|i| i as f64 * 1e-4).collect()),
        values: (0..samples).map(|i| (i as f32 * 0.01).sin()).collect(),
        stroke: Stroke::nth(0),
    }
}

fn scene(films: Vec<FilmTrack>, signals: Vec<SignalTrack>) -> Scene {
    Scene {
        name: "test".to_owned(),
        documents: vec![Document { path: "summary".into(), title: "Summary".into(), text: "# A test".into() }],
        charts: vec![Chart { title: "All".to_owned(), signals: signals.iter().map(|s| s.path.clone()).collect() }],
        body: Some(BodyTrack {
            name: "impactor".to_owned(),
            shape: BodyShape::Sphere { radius: 0.15 },
            poses: (0..3)
                .map(|i| Pose { time: f64::from(i), position: [0.0, 0.0, i as f32], rotation: [0.0, 0.0, 0.0, 1.0] })
                .collect(),
        }),
        events: vec![Event { at: Moment::Time(0.5), severity: Severity::Warning, text: "rupture".to_owned() }],
        quantities: vec![quantity("md"), quantity("td")],
        films,
        signals,
        ..Scene::default()
    }
}

/// Chunks by entity.
type Entities = BTreeMap<String, Vec<Chunk>>;

/// What a file holds: the recording and the blueprint.
fn read(path: &Path) -> [Entities; 2] {
    let file = BufReader::new(File::open(path).unwrap());
    let mut stores = [Entities::new(), Entities::new()];
    for message in DecoderApp::decode_lazy(file) {
        if let LogMsg::ArrowMsg(store, message) = message.unwrap() {
            let chunk = Chunk::from_arrow_msg(&message).unwrap();
            let entity = chunk.entity_path().to_string();
            stores[usize::from(store.is_blueprint())].entry(entity).or_default().push(chunk);
        }
    }
    stores
}

/// Each row of one component in time order; static rows come first.
fn rows<T: Loggable>(chunks: &[Chunk], component: &ComponentDescriptor) -> Vec<(i64, Vec<T>)> {
    rows_on(TIME, chunks, component.component)
}

/// The same on any timeline.
fn rows_on<T: Loggable>(
    timeline: &'static str,
    chunks: &[Chunk],
    component: ComponentIdentifier,
) -> Vec<(i64, Vec<T>)> {
    let mut rows = Vec::new();
    for chunk in chunks {
        let Some(column) = chunk.components().get_array(component) else {
            continue;
        };
        let times = chunk.timelines().get(&TimelineName::from_static_str(timeline));
        for row in 0..chunk.num_rows() {
            if !arrow_is_valid(column, row) {
                continue;
            }
            let time = times.map_or(i64::MIN, |times| times.times_raw()[row]);
            rows.push((time, T::from_arrow(&column.value(row)).unwrap()));
        }
    }
    rows.sort_by_key(|(time, _)| *time);
    rows
}

fn arrow_is_valid(column: &re_sdk::external::arrow::array::ListArray, row: usize) -> bool {
    use re_sdk::external::arrow::array::Array;
    column.is_valid(row)
}

/// The recording of a scene.
fn written(scene: &Scene) -> Entities {
    let [recording, _] = both(scene);
    recording
}

/// Recording and blueprint of a scene.
fn both(scene: &Scene) -> [Entities; 2] {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("recording.rrd");
    write(&path, scene).unwrap();
    read(&path)
}

#[test]
fn everything_in_the_scene_comes_back() {
    let scene = scene(vec![film(4, 5)], vec![signal("velocity_m_s", 1200)]);
    let entities = written(&scene);
    let shown =
        ["/scene", "/scene/film", "/scene/impactor", "/scene/frame/film", "/legends/td/bar", "/summary", "/events"];
    for entity in shown {
        assert!(entities.contains_key(entity), "{entity} in {:?}", entities.keys());
    }

    let film = &entities["/scene/film"];
    let positions = rows::<Position3D>(film, &Mesh3D::descriptor_vertex_positions());
    assert_eq!(positions.len(), 5);
    let (time, last) = &positions[4];
    assert_eq!(*time, 2_000_000);
    for (read, given) in last.iter().zip(&scene.films[0].frames[4].positions) {
        for (read, given) in read.0.0.iter().zip(given) {
            assert!((read - given).abs() <= 0.5 / 32_768.0);
        }
    }
    let triangles = rows::<TriangleIndices>(film, &Mesh3D::descriptor_triangle_indices());
    assert_eq!((triangles.len(), triangles[0].0), (1, 0), "triangles that stay are logged once");
    for quantity in ["Colours:md", "Colours:td"] {
        assert_eq!(rows_on::<Color>(TIME, film, quantity.into()).len(), 5);
    }
    let touching = rows::<Position3D>(&entities["/scene/contact/film"], &Points3D::descriptor_positions());
    let counts: Vec<usize> = touching.iter().map(|(_, points)| points.len()).collect();
    assert_eq!(counts, [12; 4], "four images of three nodes, from the second state on");
    let held = rows::<LineStrip3D>(&entities["/scene/frame/film"], &LineStrips3D::descriptor_strips());
    assert_eq!(held.iter().map(|(_, strips)| strips.len()).collect::<Vec<_>>(), [4; 5], "edges that move follow");

    let values = rows::<Scalar>(&entities["/signals/velocity_m_s"], &Scalars::descriptor_scalars());
    assert_eq!(values.len(), 1200);
    assert_eq!(values[1199].0, 119_900_000);
    assert_eq!(values[7].1[0].0.0, f64::from((0.07_f32).sin()));

    let moves = rows::<re_sdk_types::components::Translation3D>(
        &entities["/scene/impactor"],
        &Transform3D::descriptor_translation(),
    );
    assert_eq!(moves.len(), 3);
    assert_eq!(moves[2].1[0].0.0, [0.0, 0.0, 2.0]);
}

#[test]
fn broken_triangles_vanish_when_they_break() {
    let mut film = film(2, 4);
    film.frames[2].visible[3] = false;
    film.frames[3].visible.fill(false);
    let entities = written(&scene(vec![film], Vec::new()));
    let triangles = rows::<TriangleIndices>(&entities["/scene/film"], &Mesh3D::descriptor_triangle_indices());
    let counts: Vec<_> = triangles.iter().map(|(time, t)| (*time, t.len())).collect();
    // What is left of nothing is one triangle without area.
    assert_eq!(counts, [(0, 8), (1_000_000, 7), (1_500_000, 1)]);
}

#[test]
fn the_viewer_is_told_what_to_show() {
    let [_, blueprint] = both(&scene(vec![film(2, 2)], vec![signal("velocity_m_s", 3)]));
    let classes = blueprint.values().flatten().flat_map(|chunk| {
        rows_on::<ViewClass>("blueprint", std::slice::from_ref(chunk), "ViewBlueprint:class_identifier".into())
    });
    let mut classes: Vec<String> = classes.map(|(_, class)| class[0].0.to_string()).collect();
    classes.sort();
    assert_eq!(classes, ["2D", "2D", "3D", "3D", "TextDocument", "TextLog", "TimeSeries"]);
    let is_set = |name: &str| blueprint.keys().filter(|path| path.ends_with(name)).count();
    assert_eq!((is_set("/EyeControls3D"), is_set("/Background"), is_set("/TextLogColumns")), (2, 4, 1));
    assert!(blueprint.contains_key("/time_panel"));
}

#[test]
fn a_search_closes_in_along_its_iterations() {
    let axis = |words: &str| Axis { words: words.to_owned(), logarithmic: false };
    let line = |height: f64, look| Curve { name: "curve".to_owned(), points: vec![[0.0, 0.0], [1.0, height]], look };
    let state =
        |number: u32| State { at: Moment::Iteration(number), curves: vec![line(1.0 / f64::from(number), Look::Line)] };
    let objective = SignalTrack {
        places: Places::Iterations(vec![1, 2, 4]),
        values: vec![1.0, 0.5, 0.25],
        ..signal("objective", 0)
    };
    let timed = signal("acceleration", 4);
    let diagram = Diagram {
        path: "searches/0".to_owned(),
        title: "closing in".to_owned(),
        axes: [axis("x"), axis("y")],
        curves: vec![line(0.2, Look::Dashed)],
        states: [1, 2, 4].map(state).to_vec(),
        window: Some([0.0, 0.5]),
    };
    let scene = Scene { diagrams: vec![diagram], ..scene(vec![], vec![objective, timed]) };
    let [entities, blueprint] = both(&scene);
    let strips = LineStrips2D::descriptor_strips().component;
    let states = rows_on::<LineStrip2D>(ITERATION, &entities["/searches/0/states/0"], strips);
    assert_eq!(states.iter().map(|(number, _)| *number).collect::<Vec<_>>(), [1, 2, 4]);
    assert!(
        rows_on::<LineStrip2D>(TIME, &entities["/searches/0/states/0"], strips).iter().all(|(at, _)| *at == i64::MIN)
    );
    let ends: Vec<f32> = states.iter().map(|(_, strips)| strips[0].0[1].y()).collect();
    assert!(ends.windows(2).all(|pair| pair[0] < pair[1]), "up is less in the plane of the viewer: {ends:?}");
    let target = rows_on::<LineStrip2D>(ITERATION, &entities["/searches/0/curves/0"], strips);
    assert!(target.len() == 1 && target[0].1.len() > 10, "the target stays, in dashes");
    let scalars = Scalars::descriptor_scalars().component;
    let values = rows_on::<Scalar>(ITERATION, &entities["/signals/objective"], scalars);
    assert_eq!(
        values.iter().map(|(at, value)| (*at, value[0].0.0)).collect::<Vec<_>>(),
        [(1, 1.0), (2, 0.5), (4, 0.25)]
    );
    assert_eq!(rows::<Scalar>(&entities["/signals/acceleration"], &Scalars::descriptor_scalars()).len(), 4);
    let timeline =
        rows_on::<BlueprintTimeline>("blueprint", &blueprint["/time_panel"], "TimePanelBlueprint:timeline".into());
    assert_eq!(timeline[0].1[0].0.as_str(), ITERATION);
}

#[test]
fn lists_that_do_not_fit_are_refused() {
    let mut short = film(2, 2);
    short.frames[1].positions.pop();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("recording.rrd");
    let error = write(&path, &scene(vec![short], Vec::new())).unwrap_err();
    assert!(matches!(error, VizError::Nodes { found: 8, expected: 9, .. }));
    assert!(!path.exists());
}
