//! The one direction of flow in each package: no file names a module that stands below its own in `lib.rs`.

use std::fs;
use std::path::{Path, PathBuf};

/// Packages of several modules, which stand in `lib.rs` in the order of the flow. The manifests keep the order of packages.
const OF_MODULES: [&str; 6] = ["base", "membrane", "lab", "uncertainty", "scene", "study"];

/// The Rust files at `path` and below it, without those of tests.
fn sources(path: &Path) -> Vec<PathBuf> {
    let is_test = path.file_stem().is_some_and(|stem| stem.to_string_lossy().ends_with("tests"));
    match fs::read_dir(path) {
        _ if is_test => vec![],
        Ok(entries) => entries.flat_map(|entry| sources(&entry.expect("an entry").path())).collect(),
        Err(_) if path.is_file() && path.extension().is_some_and(|name| name == "rs") => vec![path.to_owned()],
        Err(_) => vec![],
    }
}

/// The modules of its own package that a text names, above its tests.
fn named(text: &str) -> Vec<&str> {
    let text = text.split("#[cfg(test)]\nmod ").next().unwrap_or(text);
    let code = text.lines().filter(|line| !line.trim_start().starts_with("//"));
    let paths = code.flat_map(|line| line.split("crate::").skip(1));
    let names = paths.flat_map(|path| match path.strip_prefix('{') {
        Some(list) => list.split('}').next().unwrap_or(list).split(", ").collect(),
        None => vec![path],
    });
    names.map(|path| &path[..path.find(|c: char| c != '_' && !c.is_alphanumeric()).unwrap_or(path.len())]).collect()
}

#[test]
fn data_flows_one_way() {
    let mut against = vec![];
    for package in OF_MODULES {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("src").join(package);
        let text = fs::read_to_string(folder.join("lib.rs")).expect("lib.rs is there");
        let order: Vec<_> = text.lines().filter_map(|line| line.strip_prefix("pub mod ")?.strip_suffix(';')).collect();
        assert!(order.len() > 1, "{package} has {order:?}");
        for (place, module) in order.iter().enumerate() {
            let files = [folder.join(module), folder.join(format!("{module}.rs"))];
            let files: Vec<PathBuf> = files.iter().flat_map(|file| sources(file)).collect();
            assert!(!files.is_empty(), "{module} has no file");
            for file in files {
                let text = fs::read_to_string(&file).expect("UTF-8");
                let below = named(&text).into_iter().filter(|name| order[place + 1..].contains(name));
                against.extend(below.map(|name| format!("{} names {name}", file.display())));
            }
        }
    }
    assert!(against.is_empty(), "against the flow:\n{}", against.join("\n"));
}
