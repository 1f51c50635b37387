//! Links in the documents point to files that exist; the theory has what the sources cite of it; the citation is of this
//! version; examples of studies have no mistakes; pictures of curves are those of their script.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use crate::workbench::{droptower, printed, root};

fn documents() -> Vec<PathBuf> {
    let found = ["*.md", "docs/**/*.md", "editors/**/*.md", "data/**/*.md", "tests/**/*.md", "src/**/*.md"];
    let found = found.iter().flat_map(|pattern| {
        let pattern = root().join(pattern);
        glob::glob(&pattern.to_string_lossy()).expect("a pattern").map(|path| path.expect("a file"))
    });
    found.collect()
}

/// The targets of Markdown's links and pictures, without fragments.
fn targets(text: &str) -> Vec<&str> {
    let ends = text.match_indices("](").filter_map(|(at, _)| text[at + 2..].split(')').next());
    ends.map(|target| target.split('#').next().unwrap_or_default()).filter(|target| !target.is_empty()).collect()
}

#[test]
fn links_point_to_files() {
    let documents = documents();
    assert!(documents.len() > 8, "{documents:?}");
    for document in documents {
        let folder = document.parent().unwrap_or(Path::new(""));
        let text = fs::read_to_string(&document).expect("a text");
        for target in targets(&text).into_iter().filter(|target| !target.contains("://")) {
            assert!(folder.join(target).exists(), "{}: {target} does not exist", document.display());
        }
    }
}

/// A command outside of a block of code runs into the text beside it.
#[test]
fn commands_are_in_blocks_and_comments_end() {
    let commands = ["run", "script", "reduce", "fit", "calibrate", "new", "check", "sweep", "signal", "test", "export"];
    for document in fs::read_dir(root().join("docs")).expect("a folder").flatten().map(|entry| entry.path()) {
        let Ok(text) = fs::read_to_string(&document) else { continue };
        let mut is_code = false;
        for line in text.lines().filter(|_| document.extension().is_some_and(|ending| ending == "md")) {
            is_code ^= line.trim_start().starts_with("```");
            let command = line.strip_prefix("droptower ").and_then(|rest| rest.split(' ').next());
            let is_stray = command.is_some_and(|word| commands.contains(&word)) || line.contains("--->");
            assert!(is_code || !is_stray, "{}: {line}", document.display());
        }
    }
}

#[test]
fn the_readme_links_every_document() {
    let readme = fs::read_to_string(root().join("README.md")).expect("a text");
    let linked = targets(&readme);
    for document in fs::read_dir(root().join("docs")).expect("a folder").flatten() {
        let name = document.file_name().into_string().expect("UTF-8");
        let path = format!("docs/{name}");
        assert!(!name.ends_with(".md") || linked.contains(&path.as_str()), "{path} is not linked");
    }
}

/// Every crate that the manifests name stands in the table of dependencies, and no other.
#[test]
fn every_direct_dependency_is_explained() {
    let read = |path: &str| fs::read_to_string(root().join(path)).expect("a text");
    let table = |path: &str| read(path).parse::<toml::Table>().expect("a manifest");
    let of_workspace = table("Cargo.toml")["workspace"]["dependencies"].as_table().expect("a table").clone();
    let of_members = ["viz/Cargo.toml", "tests/loom/Cargo.toml"].map(table);
    let kinds = ["dependencies", "dev-dependencies"];
    let of_members =
        of_members.iter().flat_map(|manifest| kinds.iter().filter_map(|kind| manifest.get(*kind)?.as_table()));
    let named: BTreeSet<String> = of_members
        .chain([&of_workspace])
        .flatten()
        .filter(|(_, value)| value.get("path").is_none() && value.get("workspace").is_none())
        .map(|(name, value)| value.get("package").and_then(|name| name.as_str()).unwrap_or(name).to_owned())
        .collect();
    let document = read("docs/dependencies.md");
    let table = document.split("## ").next().unwrap_or_default();
    let rows = table.lines().filter_map(|line| line.strip_prefix("| `")?.split(" | ").next());
    let crates = rows.flat_map(|cell| cell.split(", ")).map(|name| name.trim_matches('`').to_owned());
    let explained: BTreeSet<String> = crates.collect();
    assert_eq!(named, explained);
}

/// The numbers that a text cites of `document` as `what`, "equation" or "section".
fn cited(text: &str, document: &str, what: &str) -> BTreeSet<String> {
    let lines = text.lines().map(|line| line.trim().trim_start_matches(['/', '!']).trim());
    let flowing = lines.collect::<Vec<_>>().join(" ");
    let is_number = |word: &&str| word.starts_with(|c: char| c.is_ascii_digit());
    let numbers = |rest: &str| {
        let words = rest.trim_start_matches('s').split(|c: char| !c.is_alphanumeric()).filter(|word| !word.is_empty());
        let listed = words.take_while(|word| is_number(word) || ["and", "to"].contains(word));
        listed.filter(is_number).map(str::to_owned).collect::<Vec<_>>()
    };
    flowing.split(document).skip(1).filter_map(|rest| rest.strip_prefix(what)).flat_map(numbers).collect()
}

/// Each of both documents has the numbers that the sources cite of it; no number stands in both.
#[test]
fn the_theory_has_the_equations_and_sections_that_sources_cite() {
    let read = |path: &str| fs::read_to_string(root().join(path)).expect("a text");
    let texts = [("theory.md, ", read("docs/theory.md")), ("methods.md, ", read("docs/methods.md"))];
    let mut known = BTreeSet::new();
    for (document, text) in &texts {
        let tags = text.split("\\tag{").skip(1).filter_map(|rest| rest.split('}').next());
        let equations = tags.map(|number| ("equation", number));
        let headings = text.lines().filter_map(|line| line.strip_prefix("## ")?.split('.').next());
        for (what, number) in equations.chain(headings.map(|number| ("section", number))) {
            let is_new = texts.iter().all(|(other, _)| !known.contains(&(*other, what, number)));
            assert!(is_new, "two {what}s have the number {number}");
            known.insert((*document, what, number));
        }
    }
    assert!(known.len() > 150, "{known:?}");
    let mut count = 0;
    for source in glob::glob(&root().join("src/**/*.rs").to_string_lossy()).expect("a pattern").flatten() {
        let text = fs::read_to_string(&source).expect("a text");
        for (document, _) in &texts {
            for what in ["equation", "section"] {
                for number in cited(&text, document, what) {
                    let is_known = known.contains(&(*document, what, number.as_str()));
                    assert!(is_known, "{}: {document}{what} {number} does not exist", source.display());
                    count += 1;
                }
            }
        }
    }
    assert!(count > 100, "{count} citations");
}

#[test]
fn the_citation_is_of_this_version() {
    let citation = fs::read_to_string(root().join("CITATION.cff")).expect("a text");
    let version = citation.lines().find_map(|line| line.strip_prefix("version: "));
    assert_eq!(version, Some(env!("CARGO_PKG_VERSION")));
}

/// The blocks of a document in a language.
fn blocks<'text>(text: &'text str, language: &str) -> Vec<&'text str> {
    let fence = format!("\n```{language}\n");
    text.split(fence.as_str()).skip(1).filter_map(|rest| rest.split("\n```").next()).collect()
}

/// Scripts and sweep of the pages on studies and calibration have no mistake that is found before a run.
#[test]
fn examples_of_studies_have_no_mistakes() {
    let read = |name: &str| fs::read_to_string(root().join("docs").join(name)).expect("a text");
    let (studies, calibration) = (read("studies.md"), read("calibration.md"));
    let scenario = root().join("scenarios/drop/1008.toml").to_string_lossy().replace('\\', "/");
    let scripts = blocks(&studies, "rhai");
    let [layers, main, film] = scripts[..] else { panic!("{} scripts", scripts.len()) };
    let study = blocks(&calibration, "rhai").join("\n");
    let sweep = format!("extends = \"{scenario}\"\n{}", blocks(&studies, "toml").join("\n"));
    let folder = tempfile::tempdir().expect("a folder");
    let texts = [layers, main, film, study.as_str(), sweep.as_str()];
    for (name, text) in ["layers.rhai", "main.rhai", "film.rhai", "study.rhai", "sweep.toml"].iter().zip(texts) {
        fs::write(folder.path().join(name), text).expect("a file");
    }
    let check = |arguments: &[&str]| printed(&droptower(folder.path(), arguments));
    check(&["script", "layers.rhai", "--check", "--scenario", &scenario]);
    check(&["script", "main.rhai", "--check", "--scenario", &scenario]);
    check(&["script", "study.rhai", "--check"]);
    check(&["check", "sweep.toml"]);
}

/// The names and texts of the pictures in a folder, by name.
fn pictures(folder: &Path) -> Vec<(String, String)> {
    let pattern = folder.join("*.svg");
    let paths = glob::glob(&pattern.to_string_lossy()).expect("a pattern").map(|path| path.expect("a file"));
    let name = |path: &Path| path.file_name().expect("a name").to_string_lossy().into_owned();
    paths.map(|path| (name(&path), fs::read_to_string(&path).expect("a text"))).collect()
}

/// The numbers of a picture, and the text around them.
fn parts(picture: &str) -> (Vec<f64>, String) {
    let of_number = |c: char| c.is_ascii_digit() || ".-".contains(c);
    (picture.split(|c| !of_number(c)).filter_map(|part| part.parse().ok()).collect(), picture.replace(of_number, ""))
}

/// Pictures of laws, and the figures beside them, are those of `scripts/which-law.rhai`; other mathematical libraries may
/// move a point by a tenth of a pixel.
#[test]
fn the_pictures_of_laws_are_those_of_their_script() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("which-law");
    let told = printed(&droptower(&root(), &["script", "scripts/which-law.rhai", "--out", &out.to_string_lossy()]));
    let page = fs::read_to_string(root().join("docs/materials.md")).expect("a text");
    let rows: Vec<&str> = told.lines().take_while(|line| line.trim() != "sets").collect();
    assert!(rows.len() > 6 && page.contains(&rows.join("\n")), "docs/materials.md does not show\n{}", rows.join("\n"));
    let (shipped, made) = (pictures(&root().join("docs/pictures/laws")), pictures(&out));
    let names = |pictures: &[(String, String)]| pictures.iter().map(|(name, _)| name.clone()).collect::<Vec<_>>();
    assert_eq!(names(&shipped), names(&made));
    for ((name, shipped), (_, made)) in shipped.iter().zip(&made) {
        assert!(page.contains(&format!("(pictures/laws/{name})")), "docs/materials.md does not show {name}");
        let ((old, words), (new, same_words)) = (parts(shipped), parts(made));
        let is_near = |(old, new): (&f64, &f64)| (old - new).abs() < 1.5;
        let is_same = words == same_words && old.len() == new.len() && old.iter().zip(&new).all(is_near);
        assert!(is_same, "docs/pictures/laws/{name} is not what scripts/which-law.rhai draws");
    }
}
