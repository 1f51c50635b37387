//! The one direction of flow in each package: no module names one that stands below it in `lib.rs`, and no files of a
//! package name each other in a cycle.

mod source;

use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::fs;
use std::path::{Path, PathBuf};

use source::{Crate, ModulePath};

/// Packages of several modules, which stand in `lib.rs` in the order of the flow.
const OF_MODULES: [&str; 6] = ["base", "membrane", "lab", "uncertainty", "scene", "study"];

/// Packages that are one module. The manifests keep the order of packages.
const OF_FILES: [&str; 5] = ["card", "plot", "report", "picture", "cli"];

/// The folder of a package.
fn folder_of(package: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("src").join(package)
}

/// The modules of the `lib.rs` in `folder`, in its order.
fn modules(folder: &Path) -> Vec<String> {
    let text = fs::read_to_string(folder.join("lib.rs")).expect("lib.rs is there");
    let names = text.lines().filter_map(|line| line.strip_prefix("pub mod ")?.strip_suffix(';'));
    names.map(str::to_owned).collect()
}

/// Which module names which, with one of the names.
type Graph = BTreeMap<ModulePath, BTreeMap<ModulePath, String>>;

fn graph(sources: &Crate) -> Graph {
    sources.modules.keys().map(|path| (path.clone(), sources.named_by(path))).collect()
}

/// The shortest cycle through `start`; none where no file that it names leads back.
///
/// What the root of a folder defines is shared by the files below it: that they name it does not count.
fn cycle(graph: &Graph, start: &ModulePath) -> Option<Vec<ModulePath>> {
    let mut before: BTreeMap<&ModulePath, &ModulePath> = BTreeMap::new();
    let mut queue = VecDeque::from([start]);
    while let Some(module) = queue.pop_front() {
        for named in graph[module].keys().filter(|named| !module.starts_with(named)) {
            if named == start {
                let back = std::iter::successors(Some(module), |module| before.get(module).copied());
                let mut round: Vec<ModulePath> = back.cloned().collect();
                round.reverse();
                return Some(round);
            }
            if !before.contains_key(named) {
                before.insert(named, module);
                queue.push_back(named);
            }
        }
    }
    None
}

/// The cycles between files, each once, in words.
fn cycles(graph: &Graph) -> Vec<String> {
    let mut seen = BTreeSet::new();
    let mut found = Vec::new();
    for start in graph.keys().filter(|path| !path.is_empty()) {
        let Some(round) = cycle(graph, start) else { continue };
        if seen.insert(round.iter().cloned().collect::<BTreeSet<_>>()) {
            let next = round.iter().cycle().skip(1);
            let step =
                |(one, other): (&ModulePath, &ModulePath)| format!("{} names {}", one.join("::"), graph[one][other]);
            let words: Vec<String> = round.iter().zip(next).map(step).collect();
            found.push(words.join(", "));
        }
    }
    found
}

fn crate_of(files: &[(&str, &str)]) -> Crate {
    Crate::of(files.iter().map(|(file, text)| (PathBuf::from(file), (*text).to_owned())))
}

#[test]
fn data_flows_one_way() {
    for folder in OF_MODULES.map(folder_of) {
        let order = modules(&folder);
        let place = |module: &String| order.iter().position(|other| other == module);
        let sources = Crate::read(&folder);
        let mut against = Vec::new();
        // Build scripts are no modules.
        let of_modules = |path: &&ModulePath| path.first().is_some_and(|module| module != "build");
        for path in sources.modules.keys().filter(of_modules) {
            let here = place(&path[0]).unwrap_or_else(|| panic!("{} is not a module of lib.rs", path[0]));
            let named = sources.mentions(path).into_iter();
            let below = named.filter(|name| name.first().and_then(place).is_some_and(|there| there > here));
            against.extend(below.map(|name| format!("{} names {}", path.join("::"), name.join("::"))));
        }
        assert!(against.is_empty(), "against the flow:\n{}", against.join("\n"));
    }
}

#[test]
fn no_files_of_a_package_name_each_other_in_a_cycle() {
    for folder in OF_MODULES.iter().chain(&OF_FILES).map(|package| folder_of(package)) {
        let found = cycles(&graph(&Crate::read(&folder)));
        assert!(found.is_empty(), "{}: cycles:\n{}", folder.display(), found.join("\n"));
    }
}

/// `dist` takes its packages from `release`, where those that only start, check and print are optimised little.
#[test]
fn what_is_shipped_is_optimised() {
    let manifest: toml::Table =
        fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("Cargo.toml")).unwrap().parse().unwrap();
    let packages = |profile: &str| manifest["profile"][profile]["package"].as_table().unwrap().clone();
    let full = toml::Value::Integer(3);
    let lowered = packages("release")
        .into_iter()
        .filter(|(_, package)| package.get("opt-level").is_some_and(|level| *level != full));
    let (lowered, dist): (Vec<_>, _) = (lowered.map(|(name, _)| name).collect(), packages("dist"));
    assert!(lowered.len() > 5, "only {lowered:?} are optimised less");
    for name in lowered {
        assert_eq!(dist.get(&name).and_then(|package| package.get("opt-level")), Some(&full), "{name} in dist");
    }
}

#[test]
fn names_lead_to_the_file_that_defines_them() {
    let sources = crate_of(&[
        ("lib.rs", "pub mod low; pub mod top;"),
        ("low.rs", "pub struct Low;"),
        ("top/mod.rs", "mod a; mod b; mod deep; pub use a::A; pub use deep::*; pub fn own() {}"),
        (
            "top/a.rs",
            "use super::{B as Other, own}; use crate::low::Low; // use super::C;\nconst T: &str = \"super::D\";",
        ),
        ("top/b.rs", "use super::a::{self, A}; fn f() { a::g(); super::Deep::new(); 'x' }"),
        ("top/deep/mod.rs", "pub struct Deep; impl Deep { fn f() { crate::top::b::h::<u8>() } }"),
    ]);
    let named = |path: &[&str]| {
        let path: ModulePath = path.iter().map(|name| (*name).to_owned()).collect();
        sources.named_by(&path).into_keys().map(|path| path.join("::")).collect::<Vec<_>>()
    };
    assert_eq!(named(&["top"]), [] as [&str; 0], "what is only passed on is not named");
    assert_eq!(named(&["top", "a"]), ["low", "top"]);
    assert_eq!(named(&["top", "b"]), ["top::a", "top::deep"]);
    assert_eq!(named(&["top", "deep"]), ["top::b"]);
}

#[test]
fn cycles_are_found_and_those_of_tests_are_not() {
    let cycles_of = |b: &str| {
        let sources = crate_of(&[
            ("top/mod.rs", "mod a; mod b; #[cfg(test)] mod check; pub use a::A; pub fn f() { a::A::new() }"),
            ("top/a.rs", "use super::{b::B, f}; pub struct A;"),
            ("top/b.rs", b),
            ("top/check.rs", "use super::A; use super::b::B;"),
        ]);
        cycles(&graph(&sources))
    };
    assert_eq!(cycles_of("fn g(a: &super::A) {}"), ["top::a names top::b::B, top::b names top::A"]);
    assert!(cycles_of("use super::f; #[cfg(test)] mod tests { use super::super::A; }").is_empty());
}
