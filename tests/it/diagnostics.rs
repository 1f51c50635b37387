//! Every mistake in a scenario is reported at its place, with a hint where one helps.
//!
//! `broken/*.toml` are scenarios with mistakes. Each offending line ends in `# error: …`, with `# hint: …` where there
//! is a hint; one line may have several. Lines of the files that a scenario names are included.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use droptower::diagnostic::{Diagnostic, Label, render};
use droptower::model::{self, Model};
use droptower::scenario::{Assignment, Document};
use droptower::simulate;
use proptest::prelude::*;

use crate::verification::tower::checked;
use crate::workbench::any_text;

/// File, line, message and hint of a mistake.
type Mistake = (String, usize, String, Option<String>);

fn broken() -> Vec<PathBuf> {
    let paths = glob::glob("tests/it/broken/*.toml").expect("a good pattern");
    paths.map(|path| path.expect("a readable folder")).collect()
}

fn check(path: &Path) -> Result<Model, Vec<Diagnostic>> {
    let document = Document::read(path)?;
    let model = model::check(&document)?;
    simulate::check(&document, &model).map(|()| model)
}

/// The mistakes that the comments of a scenario, and of the parts that it names, expect.
fn expected(path: &Path) -> BTreeSet<Mistake> {
    let mut files = vec![path.to_owned()];
    let mut next = 0;
    while next < files.len() {
        let text = fs::read_to_string(&files[next]).expect("a text file");
        let parts = glob::glob("tests/it/broken/parts/*").expect("a good pattern").flatten();
        let new: Vec<PathBuf> = parts.filter(|p| text.contains(&file_name(p)) && !files.contains(p)).collect();
        files.extend(new);
        next += 1;
    }
    files.iter().flat_map(|file| comments(file)).collect()
}

fn file_name(path: &Path) -> String {
    path.file_name().expect("a file").to_string_lossy().into_owned()
}

fn comments(file: &Path) -> Vec<Mistake> {
    let text = fs::read_to_string(file).expect("a text file");
    let mut mistakes = Vec::new();
    for (number, line) in text.lines().enumerate() {
        for comment in line.split("# error: ").skip(1) {
            let (message, hint) = match comment.split_once(" # hint: ") {
                Some((message, hint)) => (message, Some(hint.trim().to_owned())),
                None => (comment, None),
            };
            mistakes.push((file.display().to_string(), number + 1, message.trim().to_owned(), hint));
        }
    }
    mistakes
}

fn found(mistakes: &[Diagnostic]) -> BTreeSet<Mistake> {
    let comparable = |mistake: &Diagnostic| {
        let span = mistake.span.as_ref();
        let file = span.map(|span| span.source.name.clone()).unwrap_or_default();
        let line = span.map_or(0, |span| span.start().0);
        (file, line, mistake.message.clone(), mistake.hint.clone())
    };
    mistakes.iter().map(comparable).collect()
}

#[test]
fn every_mistake_is_reported_at_its_place() {
    let mut wrong = Vec::new();
    for path in broken() {
        let mistakes = check(&path).err().unwrap_or_default();
        let (expected, found) = (expected(&path), found(&mistakes));
        let missed: Vec<_> = expected.difference(&found).map(|f| format!("  not found: {f:?}")).collect();
        let surplus: Vec<_> = found.difference(&expected).map(|f| format!("  not expected: {f:?}")).collect();
        if !(missed.is_empty() && surplus.is_empty() && !found.is_empty()) {
            wrong.push(format!("{}\n{}\n{}", path.display(), missed.join("\n"), surplus.join("\n")));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn a_conflict_points_at_both_places() {
    for (file, labels) in [
        ("exclusive.toml", &["is given here"][..]),
        ("extends-circle.toml", &["this file extends the next", "this file extends the next"]),
    ] {
        let mistakes = check(&Path::new("tests/it/broken").join(file)).expect_err("a mistake");
        let found = mistakes.iter().find(|mistake| !mistake.labels.is_empty()).expect("labels");
        let fits = |(label, text): (&Label, &&str)| label.text.ends_with(text);
        assert!(found.labels.len() == labels.len() && found.labels.iter().zip(labels).all(fits), "{found:?}");
    }
}

#[test]
fn messages_are_lower_case_without_full_stop() {
    for path in broken() {
        for (_, _, message, hint) in expected(&path) {
            for text in [Some(message), hint].into_iter().flatten() {
                assert!(!text.ends_with('.'), "full stop: {text}");
                assert!(!text.starts_with(|c: char| c.is_ascii_uppercase()), "upper case: {text}");
            }
        }
    }
}

#[test]
fn the_parts_of_the_scenarios_check() {
    for part in ["tower", "coupon"] {
        let path = format!("tests/it/broken/parts/{part}.toml");
        checked(check(Path::new(&path)));
    }
}

fn tower() -> Document {
    Document::read(Path::new("tests/it/broken/parts/tower.toml")).expect("the tower reads")
}

fn set(argument: &str) -> Result<Model, Vec<Diagnostic>> {
    let assignment = Assignment::from_argument(argument)?;
    model::check(&tower().with(&[assignment]))
}

#[test]
fn set_accepts_toml_and_bare_text() {
    let size = |argument: &str| set(argument).map(|model| model.faces[0].meshing.size);
    for argument in [
        "specimen.mesh.size=20mm",
        "specimen.mesh.size=20 mm",
        "specimen.mesh.size = \"2 cm\"",
        "specimen.mesh.size=0.02",
    ] {
        assert!(matches!(size(argument), Ok(found) if found == 0.02), "{argument}: {:?}", size(argument));
    }
    assert!(matches!(set("frame.hold=none"), Ok(model) if model.frame.hold == model::Hold::None));
    let friction = |argument: &str| set(argument).map(|model| model.impactor().map(|impactor| impactor.friction));
    assert!(matches!(friction("impactor.friction=10 %"), Ok(Some(0.1))));
    assert!(matches!(set("layers.faces.1=\"-50 mm\""), Ok(model) if model.faces[1].height == -0.05));
}

#[test]
fn set_replaces_a_key_that_excludes_it() {
    let model = set("loading.impact.drop_height=1m").expect("drop_height replaces velocity");
    let velocity = model.loading.impact().expect("still an impact").velocity;
    assert!((velocity - (2.0 * 9.81_f64).sqrt()).abs() < 1e-12);
    assert!(set("specimen.shape.circle.radius=20cm").is_ok());
}

/// What goes with inherited keys is left alone, and what is set with them is not.
#[test]
fn what_is_set_is_not_inherited() {
    let arguments = ["specimen.shape.polygon.points=[[0, 0], [0.2, 0], [0.1, 0.15]]", "specimen.shape.polygon.unit=mm"];
    let assignments = arguments.map(|argument| Assignment::from_argument(argument).expect("a value"));
    let bulge = Document::read(Path::new("tests/it/broken/parts/bulge.toml")).expect("it reads");
    let mistakes = model::check(&bulge.with(&assignments)).expect_err("corners have their own units");
    assert_eq!(mistakes[0].message, "`specimen.shape.polygon.unit` is not allowed here");
}

/// Springs and a clamp give way before film breaks, and springs stop no impactor.
#[test]
fn film_that_gives_way_is_indented_deeper() {
    let springs = "frame.springs={ stiffness = 1e3, count = 40, length = 0.1 }";
    let clamp = "frame.clamp={ force = \"9 N\", friction = 0.3 }";
    for (file, frame) in [("indent-deep", springs), ("indent-deep", clamp), ("indent-frame", springs)] {
        let document = Document::read(Path::new(&format!("tests/it/broken/{file}.toml"))).expect("it reads");
        checked(model::check(&document.with(&[Assignment::from_argument(frame).expect("a value")])));
    }
}

#[test]
fn a_child_leaves_out_what_it_inherits() {
    let folder = tempfile::tempdir().expect("a folder");
    let tower = fs::canonicalize("tests/it/broken/parts/tower.toml").expect("a path");
    let path = folder.path().join("imported.toml");
    let text =
        |unset: &str| format!("extends = '{}'\n{unset}specimen.shape = {{ mesh = \"film.stl\" }}\n", tower.display());
    fs::write(folder.path().join("film.stl"), "solid\nendsolid\n").expect("writable");
    fs::write(&path, text("")).expect("writable");
    let mistakes = check(&path).expect_err("an imported mesh has its own size");
    assert!(mistakes[0].hint.as_ref().is_some_and(|hint| hint.contains("unset = [\"specimen.mesh.size\"]")));
    fs::write(&path, text("unset = [\"specimen.mesh.size\"]\n")).expect("writable");
    // The file has no mesh in it.
    let model = checked(Document::read(&path).and_then(|document| model::check(&document)));
    assert_eq!(model.faces[0].meshing.size, 0.0);
    let resolved = Document::read(&path).expect("it reads").resolved();
    assert!(!resolved.contains("unset") && !resolved.contains("size"), "{resolved}");
    // What is left out is given anew: nothing of the inherited table is merged.
    let fresh =
        "unset = [\"impactor\"]\nimpactor = { shape = { sphere = { radius = \"50 mm\" } }, mass = 1, friction = 0 }\n";
    fs::write(&path, format!("extends = '{}'\n{fresh}", tower.display())).expect("writable");
    let impactor = checked(check(&path)).impactors.remove(0);
    assert_eq!((impactor.mass, impactor.friction), (1.0, 0.0));
}

#[test]
fn set_changes_entries_of_lists() {
    let document = Document::read(Path::new("tests/it/broken/symmetry-layers.toml")).expect("it reads");
    let arguments = ["layer.1.md_angle=0 deg", "layer.1.material=tests/it/broken/parts/film.toml"];
    let assignments = arguments.map(|argument| Assignment::from_argument(argument).expect("a value"));
    assert_eq!(checked(model::check(&document.with(&assignments))).faces[1].md_angle, 0.0);
}

#[test]
fn an_assignment_changes_one_key_of_a_material_file() {
    let scale: toml::Value = toml::from_str("v = { k1 = 2.0, ke = 3.0, ky = 1.0 }").expect("a table");
    let assignment = Assignment::from_value("specimen.material.fabric.scale", &scale["v"], "script");
    let changed = model::check(&tower().with(&[assignment.expect("a value")])).expect("a model");
    let unchanged = model::check(&tower()).expect("a model");
    assert_ne!(changed.faces[0].material, unchanged.faces[0].material);
}

#[test]
fn mesh_files_are_bounded_before_they_are_read() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("film.stl");
    let file = fs::File::create(&path).expect("writable");
    let film = format!("{{ mesh = '{}' }}", path.display());
    let square = r#"{ rectangle = ["1 m", "1 m"] }, mesh = { size = "10 mm" }"#;
    let sphere = r#"{ sphere = { radius = "0.1 m" } }"#;
    for (length, specimen, impactor, expected) in [
        (800_000_000, film.as_str(), sphere, "the mesh is too large for memory: 16 000 000 elements need about 8.4 GB"),
        (2_000_000_000, square, film.as_str(), "the mesh file is too long: 2.0 GB"),
    ] {
        file.set_len(length).expect("room");
        let text = format!(
            "specimen = {{ shape = {specimen}, material = {{ density = 1e3, thickness = 1e-5, \
             elastic = {{ young = 1e8, poisson = 0.4 }} }} }}\n\
             impactor = {{ shape = {impactor}, mass = 1, friction = 0 }}\n\
             loading.impact = {{ velocity = 1, duration = \"10 ms\" }}\n"
        );
        let scenario = folder.path().join("scenario.toml");
        fs::write(&scenario, text).expect("writable");
        let mistakes = check(&scenario).expect_err("too long");
        let messages: Vec<&str> = mistakes.iter().map(|mistake| mistake.message.as_str()).collect();
        assert_eq!(messages, [expected]);
    }
}

#[test]
fn chains_of_files_are_limited() {
    let folder = tempfile::tempdir().expect("a folder");
    for link in 0..40 {
        let text = format!("extends = \"{}.toml\"\n", link + 1);
        fs::write(folder.path().join(format!("{link}.toml")), text).expect("writable");
    }
    let mistakes = check(&folder.path().join("0.toml")).expect_err("too long");
    assert_eq!(mistakes[0].message, "more than 32 files that extend one another");
}

const TEMPLATE: &str = include_str!("../../src/cli/new/templates/drop.toml");

/// Pieces of text that change the structure of a scenario.
fn piece() -> impl Strategy<Value = String> {
    let pieces =
        "[|]|{|}|\"|=|\n[[layer]]\n|nan|-1e400|99999999999999999999|\"12 kg\"|1979-05-27|extends = \".\"|curve";
    let piece = prop::sample::select(pieces.split('|').collect::<Vec<_>>());
    prop_oneof![14 => piece.prop_map(str::to_owned), 1 => any_text(0..=8)]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, ..ProptestConfig::default() })]

    #[test]
    fn no_text_makes_the_parser_panic(
        cuts in prop::collection::vec((0.0..1.0f64, 0usize..30, piece()), 1..4)
    ) {
        let mut text: Vec<char> = TEMPLATE.chars().collect();
        for (place, length, piece) in cuts {
            let start = ((text.len() as f64) * place) as usize;
            let end = (start + length).min(text.len());
            text.splice(start..end, piece.chars());
        }
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("mutated.toml");
        fs::write(&path, text.into_iter().collect::<String>()).expect("writable");
        if let Err(mistakes) = check(&path) {
            prop_assert!(!mistakes.is_empty());
            render(&mistakes, true);
        }
    }
}
