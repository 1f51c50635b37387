//! Writes a recording and reads it back.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::BufReader;
use std::path::Path;

use droptower_viz::{
    BodyShape, BodyTrack, Chart, Document, Event, FilmFrame, FilmTrack, Moment, Places, Pose, Scene, Severity,
    SignalTrack, Stroke, TIME, VizError, write,
};
use re_log_encoding::DecoderApp;
use re_sdk::log::{Chunk, LogMsg};
use re_sdk_types::ComponentDescriptor;
use re_sdk_types::archetypes::{Mesh3D, Scalars, Transform3D};
use re_sdk_types::components::{Position3D, TriangleIndices};
use re_sdk_types::external::re_types_core::Loggable;

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
        mirrored: [true, true],
        range: [0.0, 0.1],
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
        values: positions.iter().map(|p| -p[2]).collect(),
        visible: vec![true; 2 * (n * n) as usize],
        positions,
    }
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
        films,
        signals,
        diagrams: vec![],
    }
}

/// Chunks of the recording (not of the blueprint), by entity.
fn read(path: &Path) -> BTreeMap<String, Vec<Chunk>> {
    let file = BufReader::new(File::open(path).unwrap());
    let mut entities = BTreeMap::<String, Vec<Chunk>>::new();
    for message in DecoderApp::decode_lazy(file) {
        if let LogMsg::ArrowMsg(store, message) = message.unwrap()
            && store.is_recording()
        {
            let chunk = Chunk::from_arrow_msg(&message).unwrap();
            let entity = chunk.entity_path().to_string();
            entities.entry(entity).or_default().push(chunk);
        }
    }
    entities
}

/// Each row of one component in time order; static rows come first.
fn rows<T: Loggable>(chunks: &[Chunk], component: &ComponentDescriptor) -> Vec<(i64, Vec<T>)> {
    let mut rows = Vec::new();
    for chunk in chunks {
        let Some(column) = chunk.components().get_array(component.component) else {
            continue;
        };
        let times = chunk.timelines().get(&TIME.into());
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

fn written(scene: &Scene) -> (BTreeMap<String, Vec<Chunk>>, u64) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("recording.rrd");
    write(&path, scene).unwrap();
    (read(&path), std::fs::metadata(&path).unwrap().len())
}

#[test]
fn everything_in_the_scene_comes_back() {
    let scene = scene(vec![film(4, 5)], vec![signal("velocity_m_s", 1200)]);
    let (entities, _) = written(&scene);
    for entity in ["/scene", "/scene/film", "/scene/impactor", "/summary", "/events"] {
        assert!(entities.contains_key(entity), "{entity} in {:?}", entities.keys());
    }

    let film = &entities["/scene/film"];
    let positions = rows::<Position3D>(film, &Mesh3D::descriptor_vertex_positions());
    assert_eq!(positions.len(), 5);
    let (time, last) = &positions[4];
    assert_eq!(*time, 2_000_000);
    for (read, given) in last.iter().zip(&scene.films[0].frames[4].positions) {
        for (read, given) in read.0.0.iter().zip(given) {
            assert!((read - given).abs() <= 0.5 / 262_144.0);
        }
    }
    let triangles = rows::<TriangleIndices>(film, &Mesh3D::descriptor_triangle_indices());
    assert_eq!((triangles.len(), triangles[0].0), (1, i64::MIN));

    let values =
        rows::<re_sdk_types::components::Scalar>(&entities["/signals/velocity_m_s"], &Scalars::descriptor_scalars());
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
    let (entities, _) = written(&scene(vec![film], Vec::new()));
    let triangles = rows::<TriangleIndices>(&entities["/scene/film"], &Mesh3D::descriptor_triangle_indices());
    let counts: Vec<_> = triangles.iter().map(|(time, t)| (*time, t.len())).collect();
    // What is left of nothing is one triangle without area.
    assert_eq!(counts, [(0, 8), (1_000_000, 7), (1_500_000, 1)]);
}

#[test]
fn an_ordinary_drop_test_stays_small() {
    let mut lower = film(20, 240);
    lower.name = "lower".to_owned();
    let signals = (0..12).map(|i| signal(&format!("channel_{i}"), 1200)).collect();
    let (_, bytes) = written(&scene(vec![film(20, 240), lower], signals));
    println!("{bytes} bytes");
    assert!(bytes < 8_000_000, "{bytes} bytes");
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
