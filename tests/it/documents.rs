//! Links in the documents point to files that exist.

use std::fs;
use std::path::{Path, PathBuf};

use crate::workbench::root;

fn documents() -> Vec<PathBuf> {
    let found = ["*.md", "docs/**/*.md", "data/**/*.md", "tests/**/*.md", "src/**/*.md"];
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
