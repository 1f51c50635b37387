//! Writes a recording and reads it back.

use std::time::Duration;

use droptower_viz::{
    Body, Chart, Charts, Document, Event, Extent, PointState, PointTrack, Quantity, Scene, Severity, SignalTrack,
    Stage, Stroke, TIME,
};
use playback::Playback;
use plot::{Curve, Plot, Window};
use re_sdk_types::archetypes::{LineStrips2D, LineStrips3D, Points2D, Transform3D};
use re_sdk_types::blueprint::components::{ContainerKind, IncludedContent, PlaybackSpeed, ViewClass};
use re_sdk_types::components::{Color, LineStrip2D, LineStrip3D, Text, Translation3D};
use report::geometry::{FIELDS, SceneBody, SceneFace};
use scene::simulate::{FilmSpring, FilmState, Snapshot};

/// A film and its states.
type Film = (SceneFace, Vec<Snapshot>);

/// A square of n × n cells that sinks to a depth of one tenth, over `snapshots` states.
fn film(n: u32, snapshots: usize) -> Film {
    let node = |column: u32, row: u32| row * (n + 1) + column;
    let cell = |row: u32, column: u32| {
        let [a, b] = [node(column, row), node(column + 1, row)];
        let [c, d] = [node(column + 1, row + 1), node(column, row + 1)];
        [a, b, c, d]
    };
    let cells = (0..n).flat_map(|row| (0..n).map(move |column| [row, column]));
    let face = SceneFace {
        nodes: ((n + 1) * (n + 1)) as usize,
        patches: cells.map(|[row, column]| cell(row, column)).collect(),
        held: vec![[0, 1]],
        springs: vec![FilmSpring { anchor: [0.1, -0.1, 0.0], nodes: [0, 1], shares: [0.25, 0.75] }],
        mirrored: [true; 2],
    };
    (face, (0..snapshots).map(|index| state(n, index, snapshots)).collect())
}

/// Sinks like a membrane under a sphere, with a ripple so that every digit moves.
fn state(n: u32, index: usize, snapshots: usize) -> Snapshot {
    let share = index as f32 / (snapshots - 1) as f32;
    let nodes = (0..=n).flat_map(|row| (0..=n).map(move |column| [column, row]));
    let position = |[column, row]: [u32; 2]| {
        let [x, y] = [column, row].map(|i| 0.2 * i as f32 / n as f32);
        let ripple = 1e-3 * share * (97.0 * x + 61.0 * y + 40.0 * share).sin();
        [x, y, -0.1 * share * (1.0 - 25.0 * (x * x).max(y * y)) + ripple]
    };
    let film = FilmState {
        positions: nodes.map(position).collect(),
        strains: vec![[0.1 * share, 0.05 * share, 0.0]; (n * n) as usize],
        failed: vec![false; (n * n) as usize],
        in_contact: if index == 0 { vec![] } else { vec![0, 1, 2] },
        ..FilmState::default()
    };
    Snapshot { films: vec![film], ..bodies(index as f64 * 5e-4, 0.0) }
}

/// The impactor at a height.
fn bodies(time: f64, height: f64) -> Snapshot {
    Snapshot { time, films: vec![], impactors: vec![([0.0, 0.0, height], [0.0, 0.0, 0.0, 1.0])] }
}

fn quantity(key: &str) -> Quantity {
    let field = FIELDS.iter().find(|field| field.key == key).unwrap();
    Quantity { field, range: [0.0, 0.1] }
}

#[test]
fn points_are_at_every_one_of_their_times() {
    let state = |time: f64| PointState {
        time,
        positions: vec![[0.0, 0.0, time as f32], [0.1, 0.0, 0.0]],
        colours: vec![[68, 1, 84], [253, 231, 37]],
    };
    let track = PointTrack { name: "field".into(), radius: 1e-3, states: vec![state(0.0), state(0.5)] };
    let played = written(Scene { points: vec![track], ..scene(&[], vec![]) }, &[]);
    let marks = played.marks("/scene/field");
    let ends: Vec<[f32; 3]> = marks.iter().map(|(_, points)| points[0]).collect();
    assert_eq!(ends, [[0.0, 0.0, 0.0], [0.0, 0.0, 0.5]]);
    assert!(marks[0].0 < marks[1].0, "{marks:?}");
}

fn signal(name: &str, samples: usize) -> SignalTrack {
    SignalTrack {
        path: format!("signals/{name}"),
        label: name.to_owned(),
        times: (0..samples).map(|i| i as f64 * 1e-4).collect(),
        values: (0..samples).map(|i| (i as f32 * 0.01).sin()).collect(),
        stroke: Stroke::nth(0),
    }
}

fn beside(charts: Vec<Chart>) -> Charts {
    Charts { beside: charts, tabs: vec![] }
}

fn scene(films: &[Film], signals: Vec<SignalTrack>) -> Scene {
    let ends = films.iter().flat_map(|(face, snapshots)| snapshots.iter().map(move |snapshot| (face, snapshot)));
    Scene {
        extent: ends.fold(Extent::default(), |extent, (face, snapshot)| extent.with(face, &snapshot.films[0])),
        name: "test".to_owned(),
        documents: vec![Document { path: "summary".into(), title: "Summary".into(), text: "# A test".into() }],
        charts: beside(vec![Chart { title: "All".to_owned(), tracks: signals }]),
        bodies: vec![Body {
            name: "impactor".to_owned(),
            surface: SceneBody {
                points: vec![[0.1, 0.0, 0.1], [-0.1, 0.0, 0.1], [0.0, 0.1, -0.1], [0.0, -0.1, -0.1]],
                patches: vec![[0, 2, 1, 1], [0, 1, 3, 3], [0, 3, 2, 2], [1, 2, 3, 3]],
            },
            top: 0.1,
        }],
        events: vec![Event { time: 0.5, severity: Severity::Warning, text: "rupture".to_owned() }],
        quantities: vec![quantity("md"), quantity("td")],
        faces: films.iter().map(|(face, _)| face.clone()).collect(),
        ..Scene::default()
    }
}

/// The recording of a scene with the states of its films, read back.
fn written(scene: Scene, films: &[Film]) -> Playback {
    played(scene, |stage| {
        for (index, (_, snapshots)) in films.iter().enumerate() {
            // Of a face alone, which is that of its index.
            let all = |snapshot: &Snapshot| Snapshot {
                films: vec![snapshot.films[0].clone(); index + 1],
                ..snapshot.clone()
            };
            snapshots.iter().for_each(|snapshot| stage.film(index, &all(snapshot)).unwrap());
        }
        (0..3).for_each(|place| stage.bodies(&bodies(f64::from(place), f64::from(place))).unwrap());
    })
}

/// The recording of a scene and of what happens on its stage, read back.
fn played(scene: Scene, happens: impl FnOnce(&mut Stage)) -> Playback {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("recording.rrd");
    let mut stage = Stage::file(&path, scene).unwrap();
    happens(&mut stage);
    stage.finish(Duration::from_secs(60)).unwrap();
    let bytes = std::fs::read(&path).unwrap();
    assert!(bytes[bytes.len() - 64..].windows(4).any(|word| word == b"FOOT"), "the file ends with its index of chunks");
    Playback::read(&path).unwrap()
}

#[test]
fn everything_in_the_scene_comes_back() {
    let films = [film(4, 5)];
    let played = written(scene(&films, vec![signal("velocity_m_s", 1200)]), &films);
    let entities: Vec<&str> = played.entities().collect();
    for entity in
        ["/", "/scene/face-1", "/scene/impactor", "/scene/frame/face-1", "/legends/td/bar", "/summary", "/events"]
    {
        assert!(entities.contains(&entity), "{entity} in {entities:?}");
    }

    let states = played.nodes("/scene/face-1");
    assert_eq!((states.len(), states[4].0), (5, 2_000_000));
    for (read, given) in states[4].1.iter().flatten().zip(films[0].1[4].films[0].positions.iter().flatten()) {
        assert!((read - given).abs() <= 0.5 / 32_768.0);
    }
    let triangles = played.triangles("/scene/face-1");
    assert_eq!((triangles.len(), triangles[0].0), (1, 0), "triangles that stay are logged once");
    for quantity in ["Colours:md", "Colours:td"] {
        assert_eq!(played.rows::<Color>(TIME, "/scene/face-1", quantity.into()).len(), 5);
    }
    let in_contact = played.marks("/scene/contact/face-1");
    let counts: Vec<usize> = in_contact.iter().map(|(_, points)| points.len()).collect();
    assert_eq!(counts, [12; 4], "four images of three nodes, from the second state on");
    let strips = LineStrips3D::descriptor_strips().component;
    let held = played.rows::<LineStrip3D>(TIME, "/scene/frame/face-1", strips);
    assert_eq!(held.iter().map(|(_, strips)| strips.len()).collect::<Vec<_>>(), [4; 5], "edges that move follow");
    let springs = played.rows::<LineStrip3D>(TIME, "/scene/springs/face-1", strips);
    assert_eq!(springs.iter().map(|(_, strips)| strips.len()).collect::<Vec<_>>(), [4; 5], "as do springs");
    let [from, to] = [0, 1].map(|node| films[0].1[4].films[0].positions[node]);
    for (axis, (read, anchor)) in springs[4].1[0].0[1].0.iter().zip(springs[4].1[0].0[0].0).enumerate() {
        let off = [read - (0.25 * from[axis] + 0.75 * to[axis]), anchor - [0.1, -0.1, 0.0][axis]];
        assert!(off.iter().all(|off| off.abs() < 1e-4), "{off:?}");
    }

    let values = played.values(TIME, "/signals/velocity_m_s");
    assert_eq!((values.len(), values[1199].0, values[7].1), (1200, 119_900_000, f64::from((0.07_f32).sin())));
    let moved = Transform3D::descriptor_translation().component;
    let moves = played.rows::<Translation3D>(TIME, "/scene/impactor", moved);
    assert_eq!((moves.len(), moves[2].1[0].0.0), (3, [0.0, 0.0, 2.0]));
}

#[test]
fn failed_elements_are_hidden() {
    let (face, mut snapshots) = film(2, 4);
    snapshots[2].films[0].failed[3] = true;
    snapshots[3].films[0].failed.fill(true);
    let films = [(face, snapshots)];
    let triangles = written(scene(&films, Vec::new()), &films).triangles("/scene/face-1");
    let counts: Vec<_> = triangles.iter().map(|(time, t)| (*time, t.len())).collect();
    // An empty film is one triangle without area.
    assert_eq!(counts, [(0, 8), (1_000_000, 6), (1_500_000, 1)]);
}

#[test]
fn the_blueprint_arranges_the_views() {
    let films = [film(2, 2)];
    let played = written(Scene { duration: 12.0, ..scene(&films, vec![signal("velocity_m_s", 3)]) }, &films);
    let classes = views(&played);
    assert_eq!(classes, ["2D", "2D", "3D", "3D", "TextDocument", "TextLog", "TimeSeries"]);
    assert_eq!(speeds(&played), [2.0]);
    let set = |name: &str| played.blueprint().filter(|path| path.ends_with(name)).count();
    assert_eq!(["/EyeControls3D", "/Background", "/TextLogColumns", "/time_panel"].map(set), [2, 4, 1, 1]);
}

/// The layout of a second recording is taken from the first: its views, and what is logged to their paths, have those names.
#[test]
fn the_layout_of_every_recording_is_whole() {
    for sides in [3, 4, 3] {
        let films = [film(sides, 2), film(sides, 2)];
        let played = written(scene(&films, vec![signal("a", 10)]), &films);
        let all: Vec<&str> = played.blueprint().collect();
        let view = |path: &&str| path.strip_prefix("/view/").is_some_and(|rest| !rest.contains('/'));
        let views: Vec<&str> = all.iter().copied().filter(view).collect();
        assert!(views.len() >= 4, "{all:?}");
        for path in all.iter().filter(|path| path.starts_with("/view/")) {
            assert!(views.iter().any(|view| path.starts_with(view)), "{path} belongs to none of {views:?}");
        }
        for film in ["face-1", "face-2"] {
            let place = format!("/ViewContents/overrides/scene/{film}/visualizers");
            assert_eq!(all.iter().filter(|path| path.ends_with(&place)).count(), 2, "{film}: {all:?}");
        }
    }
}

/// Recordings leave no threads: hundreds of runs of one command would need as many.
#[cfg(target_os = "linux")]
#[test]
fn recordings_leave_no_threads() {
    let threads = || std::fs::read_dir("/proc/self/task").unwrap().count();
    let films = [film(5, 2)];
    let write = || drop(written(scene(&films, vec![signal("threads", 10)]), &films));
    write();
    let before = threads();
    (0..20).for_each(|_| write());
    // Other tests run beside this one.
    assert!(threads() < before + 20, "{before} threads became {}", threads());
}

#[test]
fn a_diagram_has_its_curves_in_the_plane_of_the_viewer() {
    let played = written(Scene { diagrams: vec![diagram()], ..scene(&[], vec![]) }, &[]);
    let curve = |number: usize| {
        let strips = LineStrips2D::descriptor_strips().component;
        played.rows::<LineStrip2D>(TIME, &format!("/plots/0/curves/{number}"), strips)
    };
    let (line, dashed) = (curve(0), curve(1));
    assert!(line.len() == 1 && line[0].0 == i64::MIN, "it is there at every time");
    let [from, to] = [0, 1].map(|end| line[0].1[0].0[end].y());
    assert!(to < from, "up is less in the plane of the viewer: {from} to {to}");
    assert!(dashed[0].1.len() > 10, "a reference is dashed");
}

/// A diagram of a line and of its reference.
fn diagram() -> Plot {
    let line = |height: f64| Curve::line("curve", [[0.0, 0.0], [1.0, height]]);
    let plot = Plot::new("a line", ["x", "y"], vec![line(1.0), line(0.2).dashed()]);
    let window = Some(Window { label: "window".to_owned(), range: [0.0, 0.5] });
    Plot { window, ..plot }
}

/// Kinds of the views that a recording opens with, in alphabetical order.
fn views(played: &Playback) -> Vec<String> {
    let class = |path: &str| played.blueprint_rows::<ViewClass>(path, "ViewBlueprint:class_identifier".into());
    let mut classes: Vec<String> =
        played.blueprint().flat_map(class).map(|(_, class)| class[0].0.to_string()).collect();
    classes.sort();
    classes
}

#[test]
fn a_small_film_is_rounded_by_its_own_size() {
    let (mut face, mut snapshots) = film(10, 2);
    face.springs.clear();
    let positions = snapshots.iter_mut().flat_map(|snapshot| &mut snapshot.films[0].positions);
    positions.flatten().for_each(|c| *c *= 2.5e-3);
    let films = [(face, snapshots)];
    let states = written(scene(&films, vec![]), &films).nodes("/scene/face-1");
    for (read, given) in states[1].1.iter().flatten().zip(films[0].1[1].films[0].positions.iter().flatten()) {
        assert!((read - given).abs() <= 1e-3 / 16_384.0, "{read} {given}");
    }
}

#[test]
fn a_wider_range_of_colours_has_numbers_from_its_own_moment_on() {
    let films = [film(2, 4)];
    let played = played(scene(&films, vec![]), |stage| {
        stage.film(0, &films[0].1[0]).unwrap();
        stage.set_ranges(1e-3, &[[0.0, 0.5]]).unwrap();
        stage.film(0, &films[0].1[2]).unwrap();
    });
    let labels = Points2D::descriptor_labels().component;
    let last = |(at, words): (i64, Vec<Text>)| (at, words[words.len() - 2].to_string());
    let numbers: Vec<_> = played.rows::<Text>(TIME, "/legends/md/numbers", labels).into_iter().map(last).collect();
    assert_eq!(numbers, [(0, "0.1".to_owned()), (1_000_000, "0.5".to_owned())]);
}

#[test]
fn a_scene_is_completed_when_its_run_has_ended() {
    let films = [film(2, 1)];
    let played = played(scene(&films, vec![signal("force_N", 3)]), |stage| {
        let more = SignalTrack { times: vec![4e-4], values: vec![7.0], ..signal("force_N", 0) };
        let rest = Scene { diagrams: vec![diagram()], ..scene(&[], vec![more, signal("filtered", 4)]) };
        stage.complete(rest).unwrap();
    });
    let force = played.values(TIME, "/signals/force_N");
    assert_eq!((force.len(), force[3]), (4, (400_000, 7.0)));
    assert_eq!(played.values(TIME, "/signals/filtered").len(), 4);
    assert!(played.entities().any(|entity| entity == "/plots/0/frame"), "a diagram of the end");
    // Views of the beginning, and of the end with one diagram more.
    let planes = views(&played).iter().filter(|class| *class == "2D").count();
    assert_eq!(planes, 2 + 3);
}

/// Seconds of the timeline a second of watching, where the recording says it.
fn speeds(played: &Playback) -> Vec<f64> {
    let speed = played.blueprint_rows::<PlaybackSpeed>("/time_panel", "TimePanelBlueprint:playback_speed".into());
    speed.into_iter().map(|(_, speed)| speed[0].0.0).collect()
}

#[test]
fn many_charts_stand_behind_each_other_and_nothing_that_lasts_no_time_is_played() {
    let signals: Vec<SignalTrack> = (0..30).map(|index| signal(&index.to_string(), 2)).collect();
    let chart = |track: SignalTrack| Chart { title: track.label.clone(), tracks: vec![track] };
    let charts = beside(signals.into_iter().map(chart).collect());
    let played = written(Scene { charts, ..scene(&[], vec![]) }, &[]);
    let rows = |path: &str| {
        played.blueprint_rows::<IncludedContent>(path, "ContainerBlueprint:contents".into()).into_iter().last()
    };
    let most = played.blueprint().filter(|path| path.starts_with("/container/")).filter_map(|path| {
        let kind = played.blueprint_rows::<ContainerKind>(path, "ContainerBlueprint:container_kind".into());
        kind.iter().any(|(_, kind)| kind[0] == ContainerKind::Vertical).then(|| rows(path))?
    });
    assert_eq!(most.map(|(_, contents)| contents.len()).max(), Some(5), "four charts and the tabs of the others");
    assert!(speeds(&played).is_empty());
}

#[test]
fn lists_that_do_not_fit_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("recording.rrd");
    let longer = SignalTrack { values: vec![0.0; 3], ..signal("force_N", 2) };
    let error = Stage::file(&path, scene(&[], vec![longer])).err().unwrap();
    assert_eq!(error.to_string(), "recording: signal `signals/force_N`: 3 values at 2 times");
    assert!(!path.exists());
}
