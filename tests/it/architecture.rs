//! The one direction of flow: no module names one that stands below it in `lib.rs`.

use std::fs;
use std::path::{Path, PathBuf};

fn source() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("src")
}

/// The modules of `lib.rs`, in its order.
fn modules() -> Vec<String> {
    let text = fs::read_to_string(source().join("lib.rs")).expect("lib.rs is there");
    let names = text.lines().filter_map(|line| line.strip_prefix("pub mod ")?.strip_suffix(';'));
    names.map(str::to_owned).collect()
}

fn rust_files(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).expect("a folder of src");
    let mut files = Vec::new();
    for path in entries.map(|entry| entry.expect("an entry").path()) {
        if path.is_dir() {
            files.extend(rust_files(&path));
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            files.push(path);
        }
    }
    files
}

/// The module of `lib.rs` that a file belongs to; none for `lib.rs` and `main.rs`.
fn module_of(file: &Path) -> Option<String> {
    let inside = file.strip_prefix(source()).expect("a file of src");
    let name = inside.components().next()?.as_os_str().to_string_lossy().into_owned();
    let name = name.trim_end_matches(".rs").to_owned();
    (name != "lib" && name != "main").then_some(name)
}

/// Every `x` of `crate::x`, and of `crate::{x, …}`, outside comments.
fn named_modules(text: &str) -> Vec<String> {
    let code: Vec<&str> = text.lines().filter(|line| !line.trim_start().starts_with("//")).collect();
    let code = code.join("\n");
    let mut names = Vec::new();
    for (place, marker) in code.match_indices("crate::") {
        let part_of_a_word = code[..place].ends_with(|c: char| c.is_alphanumeric() || c == '_');
        if !part_of_a_word {
            names.extend(heads(&code[place + marker.len()..]));
        }
    }
    names
}

/// The first names of what follows `crate::`: one, or those of a group.
fn heads(rest: &str) -> Vec<String> {
    let Some(group) = rest.strip_prefix('{') else {
        return vec![head(rest)];
    };
    let (mut depth, mut start, mut names) = (0, 0, Vec::new());
    for (place, letter) in group.char_indices() {
        match letter {
            '{' => depth += 1,
            '}' if depth > 0 => depth -= 1,
            '}' | ',' if depth == 0 => {
                names.push(head(&group[start..place]));
                start = place + 1;
                if letter == '}' {
                    break;
                }
            }
            _ => {}
        }
    }
    names
}

fn head(text: &str) -> String {
    text.trim_start().chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect()
}

#[test]
fn data_flows_one_way() {
    let order = modules();
    let place = |name: &str| order.iter().position(|module| module == name);
    let mut against = Vec::new();
    for file in rust_files(&source()) {
        let Some(own) = module_of(&file) else { continue };
        let here = place(&own).unwrap_or_else(|| panic!("{own} is not a module of lib.rs"));
        let text = fs::read_to_string(&file).expect("a source file");
        for name in named_modules(&text) {
            if place(&name).is_some_and(|there| there > here) {
                against.push(format!("{} names crate::{name}", file.display()));
            }
        }
    }
    assert!(against.is_empty(), "against the flow:\n{}", against.join("\n"));
}

#[test]
fn the_reader_of_names_sees_groups() {
    let text = "use crate::{a, b::{c, d}, e::f};\nlet x = crate::g::h();\n// crate::not\nmacro_crate::no";
    assert_eq!(named_modules(text), ["a", "b", "e", "g"]);
}
