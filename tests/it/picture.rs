//! `droptower picture`: scenes and plots of stored runs as files.

use std::fs;
use std::path::Path;
use std::sync::LazyLock;

use droptower::picture::{Part, ScenePicture, View};
use droptower::plot::Style;
use droptower::report::StoredPage;
use droptower::report::geometry::{FIELDS, RunScene, SceneBody, SceneFace};
use droptower::simulate::{FilmSpring, FilmState, Snapshot};
use image::RgbImage;
use tempfile::TempDir;

use crate::workbench::{droptower, figures, printed, refused};

/// A folder with a short, coarse run in `run`.
static RUN: LazyLock<TempDir> = LazyLock::new(|| {
    let folder = tempfile::tempdir().expect("a folder");
    printed(&droptower(folder.path(), &["new", "drop", "drop.toml"]));
    let changes = ["--set", "specimen.mesh.size=40mm", "--set", "loading.impact.duration=60ms"];
    printed(&droptower(folder.path(), &[&["run", "drop.toml", "--out", "run"][..], &changes].concat()));
    folder
});

const WHITE: [u8; 3] = [255; 3];

fn pixels(path: &Path) -> RgbImage {
    image::open(path).expect("a picture").into_rgb8()
}

/// Draws the run into `name` and gives what is printed as JSON.
fn draw(name: &str, arguments: &[&str]) -> serde_json::Value {
    figures(&droptower(RUN.path(), &[&["picture", "run", "-o", name, "--json"][..], arguments].concat()))
}

/// Two square elements side by side, 0.1 m wide, above a small triangle; the second may have failed.
fn scene(is_torn: bool) -> RunScene {
    let at = |x: f32, y: f32| [0.1 * x, 0.1 * y, 0.0];
    let film = FilmState {
        positions: vec![at(0.0, 0.0), at(1.0, 0.0), at(2.0, 0.0), at(0.0, 1.0), at(1.0, 1.0), at(2.0, 1.0)],
        strains: vec![[0.0, 0.1, 0.0], [0.3, 0.4, 0.0]],
        failed: vec![false, is_torn],
        ..FilmState::default()
    };
    let patches = vec![[0, 1, 4, 3], [1, 2, 5, 4]];
    let face = SceneFace { nodes: 6, patches, ..SceneFace::default() };
    let body = SceneBody { points: vec![[0.0; 3], [0.01, 0.0, 0.0], [0.0, 0.01, 0.0]], patches: vec![[0, 1, 2, 2]] };
    let pose = ([0.15, 0.05, -0.01], [0.0, 0.0, 0.0, 1.0]);
    let intact = FilmState { failed: vec![false; 2], ..film.clone() };
    let state = |time, film| Snapshot { time, films: vec![film], impactors: vec![pose] };
    let states = vec![state(0.0, intact), state(1e-3, film)];
    RunScene { faces: vec![face], bodies: vec![body], states, moments: vec![], is_coarsened: false }
}

/// The colours of the last state of `scene` from above, at points of the film in m; its picture has 10 pixels a mm.
fn colours_at<const N: usize>(scene: &RunScene, points: [[f64; 2]; N]) -> [[u8; 3]; N] {
    let letters = 8.0;
    // The scene has one height of letters beside it, 2.4 above, 7.2 for the colour bar.
    let [left, top] = [letters, 2.4 * letters];
    let style = Style {
        width: Style::points(0.2) + left + 7.2 * letters,
        height: Style::points(0.1) + top + letters,
        letters,
        family: "Arial".into(),
        line: 1.0,
        has_title: false,
    };
    let picture = ScenePicture {
        scene,
        state: &scene.states[1],
        field: &FIELDS[0],
        range: [0.0, 40.0],
        view: "top".parse::<View>().expect("a view"),
        in_perspective: false,
        part: Part::Whole,
        title: "",
        caption: "",
    };
    let dpi = 254.0;
    let drawn = picture.draw(&style, dpi).expect("a drawing").png().expect("a picture");
    let drawn = image::load_from_memory(&drawn).expect("a PNG").into_rgb8();
    points.map(|[x, y]| {
        let [x, y] = [left / 72.0 * dpi + 1e4 * x, top / 72.0 * dpi + 1e4 * (0.1 - y)];
        drawn.get_pixel(x as u32, y as u32).0
    })
}

#[test]
fn film_has_the_colour_of_its_field_where_it_is_and_failed_elements_are_left_out() {
    let points = [[0.003, 0.05], [0.05, 0.05], [0.195, 0.05], [0.202, 0.05]];
    let [first, middle, second, beside] = colours_at(&scene(false), points);
    // Light from above, as seen from there: 0.68 + 0.32 · 0.79 of the colours of viridis.
    let near = |found: [u8; 3], viridis: [f64; 3]| {
        let expected = viridis.map(|part| part * (0.68 + 0.32 * 0.79));
        assert!(found.iter().zip(expected).all(|(a, b)| (f64::from(*a) - b).abs() < 16.0), "{found:?} {expected:?}");
    };
    near(first, [59.0, 82.0, 139.0]);
    near(second, [253.0, 231.0, 37.0]);
    assert!(middle != first && middle != second, "between nodes the field is interpolated");
    assert_eq!(beside, WHITE);
    let [first, failed] = colours_at(&scene(true), [[0.05, 0.05], [0.195, 0.02]]);
    near(first, [59.0, 82.0, 139.0]);
    assert_eq!(failed, WHITE);
}

/// A spring across the place of an element that has failed, from the frame to the side of the other one.
#[test]
fn springs_are_lines_from_the_frame_to_the_film() {
    let mut hung = scene(true);
    let across = [[0.15, 0.0199], [0.15, 0.02], [0.15, 0.0201]];
    assert_eq!(colours_at(&hung, across), [WHITE; 3]);
    hung.faces[0].springs = vec![FilmSpring { anchor: [0.2, 0.02, 0.0], nodes: [1, 4], shares: [0.8, 0.2] }];
    let line = colours_at(&hung, across);
    assert!(line[1] == [48, 54, 60] && !line.contains(&WHITE), "{line:?}");
    assert_eq!(colours_at(&hung, [[0.15, 0.03]]), [WHITE], "and nothing beside it");
}

#[test]
fn bodies_beneath_film_are_hidden_and_beside_it_seen() {
    let [under, torn] = [false, true].map(|is_torn| colours_at(&scene(is_torn), [[0.152, 0.052]])[0]);
    assert_ne!(torn, WHITE, "through the tear the body is seen");
    let is_grey = |[r, g, b]: [u8; 3]| r.abs_diff(g) < 10 && g.abs_diff(b) < 12;
    assert!(is_grey(torn) && !is_grey(under), "{torn:?} {under:?}");
}

#[test]
fn a_scene_is_as_large_as_asked_and_the_same_again() {
    let first = draw("one.png", &["--at", "lowest-point"]);
    assert_eq!(first["pixels"], serde_json::json!([1600, 1000]));
    let small = ["--size", "640x480", "--dpi", "96", "--view", "front", "--part", "half", "--perspective", "--at"];
    draw("small.png", &[&small[..], &["lowest-point"]].concat());
    draw("again.png", &[&small[..], &["lowest"]].concat());
    let [one, two, again] =
        ["one.png", "small.png", "again.png"].map(|name| fs::read(RUN.path().join(name)).expect("a picture"));
    assert_eq!(two, again, "the same inputs give the same bytes");
    assert_eq!(pixels(&RUN.path().join("one.png")).dimensions(), (1600, 1000));
    let small = pixels(&RUN.path().join("small.png"));
    assert_eq!(small.dimensions(), (640, 480));
    let coloured = small.pixels().filter(|pixel| pixel.0.iter().max().unwrap() - pixel.0.iter().min().unwrap() > 60);
    assert!(coloured.count() > 3000, "the film and the colour bar");
    let density = one.windows(4).position(|name| name == b"pHYs").expect("its size on paper");
    assert_eq!(one[density + 4..density + 8], 7874_u32.to_be_bytes(), "200 dpi");
}

#[test]
fn the_kept_state_nearest_in_time_is_told() {
    let page = StoredPage::read(&RUN.path().join("run")).expect("a page");
    let scene = page.scene().expect("a film");
    let time = |found: serde_json::Value| found["time_s"].as_f64().expect("a time");
    let nearest = scene.nearest(0.0213).time;
    let small = |name: &str, more: &[&str]| {
        time(draw(name, &[&["--size", "320x200", "--dpi", "50", "--at"][..], more].concat()))
    };
    assert_eq!(small("told-at.png", &["21.3 ms"]), nearest);
    let again = small("told-again.png", &["21.3 ms", "--again"]);
    assert!((again - 0.0213).abs() <= (nearest - 0.0213).abs() && (again - 0.0213).abs() < 1e-3, "{again} {nearest}");
    let contact = small("told-contact.png", &["first-contact"]);
    assert!(contact < 0.01, "the drop begins at first contact: {contact}");
    let told = ["picture", "run", "-o", "told.svg", "--at", "21.3ms", "--dpi", "50"];
    let text = printed(&droptower(RUN.path(), &told));
    let words = ["the kept state nearest to 21.3ms", "larger fibre strain from 0 to"];
    assert!(words.iter().all(|words| text.contains(words)), "{text}");
    let listed = figures(&droptower(RUN.path(), &["picture", "run", "--json"]));
    assert_eq!(listed["states_s"].as_array().map(Vec::len), Some(scene.states.len()));
    assert!(listed["plots"].as_array().is_some_and(|plots| plots.iter().any(|name| name == "contact-force")));
}

#[test]
fn an_svg_has_the_width_and_the_letters_of_a_journal() {
    let read = |name: &str| fs::read_to_string(RUN.path().join(name)).expect("a picture");
    let column = ["--plot", "acceleration", "--style", "single-column"];
    draw("column.svg", &column);
    draw("times.svg", &[&column[..], &["--font", "Times New Roman", "--font-size", "7pt", "--width", "84mm"]].concat());
    let [column, times] = ["column.svg", "times.svg"].map(read);
    assert!(column.starts_with("<svg width=\"90mm\" height=\"59.4mm\""), "{column}");
    // Units are hundredths of a point.
    assert!(column.contains("font-size=\"800\"") && !column.contains("Acceleration of the impactor"), "{column}");
    assert!(column.contains("acceleration"), "its axis has a label");
    assert!(times.starts_with("<svg width=\"84mm\"") && times.contains("font-size=\"700\""), "{times}");
    assert!(times.contains("font-family=\"Times New Roman\""), "{times}");
    let scene = draw("scene.svg", &["--style", "double-column", "--dpi", "100"]);
    assert_eq!(scene["pixels"], serde_json::json!([748, 374]));
    let text = read("scene.svg");
    assert!(text.starts_with("<svg width=\"190mm\" height=\"95mm\"") && text.contains("data:image/png;base64,"));
    assert!(text.contains("Larger fibre strain (%)") && text.contains(" ms, "), "bar and caption are text");
}

#[test]
fn plots_of_comparisons_and_sheets_of_paper_are_drawn() {
    let shorter = ["--set", "specimen.mesh.size=40mm", "--set", "loading.impact.duration=20ms"];
    printed(&droptower(RUN.path(), &[&["run", "drop.toml", "--out", "shorter"][..], &shorter].concat()));
    printed(&droptower(RUN.path(), &["compare", "run", "shorter", "--out", "compared"]));
    let listed = figures(&droptower(RUN.path(), &["picture", "compared", "--json"]));
    let name = listed["plots"][0].as_str().expect("a plot").to_owned();
    printed(&droptower(RUN.path(), &["picture", "compared", "--plot", &name, "-o", "compared.png", "--dpi", "50"]));
    let drawn = pixels(&RUN.path().join("compared.png"));
    assert_eq!(drawn.dimensions(), (400, 250));
    let letters = drawn.pixels().filter(|pixel| pixel.0.iter().all(|part| *part < 110)).count();
    assert!(letters > 300, "letters are drawn wherever the program runs: {letters}");
    refused(&droptower(RUN.path(), &["picture", "compared", "-o", "no.png"]), "has no film in 3-D");
}

#[test]
fn a_picture_is_replaced_by_force() {
    fs::write(RUN.path().join("mine.png"), "mine").expect("a file");
    printed(&droptower(RUN.path(), &["picture", "run", "-o", "mine.png", "--force", "--dpi", "50"]));
    assert_eq!(pixels(&RUN.path().join("mine.png")).dimensions(), (400, 250));
}
