//! Names the build after what decides the bits of its results, as far as that is known before the program runs.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::{env, fs, io};

use sha2::{Digest, Sha256};

/// All that decides the figures of a run: the sources from the files of a scenario to its figures, the modules that
/// scripts import, and the versions of the dependencies.
const SOURCES: [&str; 12] = [
    "src/base",
    "src/membrane",
    "src/lab",
    "src/scene",
    "src/study/script",
    "src/study/functions",
    "src/study/post",
    "src/study/evaluate.rs",
    "src/study/field_comparison",
    "scripts/droptower",
    "Cargo.lock",
    "Cargo.toml",
];

/// Lines in which the compiler states what decides the bits that it makes.
const COMPILER: [&str; 4] = ["release: ", "commit-hash: ", "host: ", "LLVM version: "];

/// Variables in which cargo describes the machine that the program is made for.
const MACHINE: [&str; 2] = ["TARGET", "CARGO_CFG_TARGET_FEATURE"];

fn main() -> io::Result<()> {
    let variable = |name: &str| env::var(name).unwrap_or_default();
    let root = PathBuf::from(variable("CARGO_MANIFEST_DIR")).join("../..");
    SOURCES.iter().for_each(|source| println!("cargo::rerun-if-changed=../../{source}"));
    let mut digest = Sha256::new();
    for (name, path) in sources(&root)? {
        digest.update(name);
        // A checkout may have other line ends.
        digest.update(fs::read(path)?.into_iter().filter(|byte| *byte != b'\r').collect::<Vec<u8>>());
    }
    let about = Command::new(variable("RUSTC")).arg("-vV").output()?;
    let about = String::from_utf8_lossy(&about.stdout);
    about
        .lines()
        .filter(|line| COMPILER.iter().any(|start| line.starts_with(start)))
        .for_each(|line| digest.update(line));
    MACHINE.iter().for_each(|name| digest.update(variable(name)));
    let name: String = digest.finalize().iter().take(8).map(|byte| format!("{byte:02x}")).collect();
    println!("cargo::rustc-env=DROPTOWER_BUILD={name}");
    Ok(())
}

/// The files that are digested, by their names from `root` on with `/` between the parts.
pub(crate) fn sources(root: &Path) -> io::Result<Vec<(String, PathBuf)>> {
    let mut files = vec![];
    for source in SOURCES {
        gather(root, source.to_owned(), &mut files)?;
    }
    files.sort();
    Ok(files)
}

/// The files at or below `name`, without those of tests; none where there is none, as a lock file of an installed package
/// may be missing.
fn gather(root: &Path, name: String, files: &mut Vec<(String, PathBuf)>) -> io::Result<()> {
    let path = root.join(&name);
    if is_of_tests(&path) {
        return Ok(());
    }
    if path.is_dir() {
        for entry in fs::read_dir(path)? {
            gather(root, format!("{name}/{}", entry?.file_name().to_string_lossy()), files)?;
        }
    } else if path.is_file() {
        files.push((name, path));
    }
    Ok(())
}

/// Whether the file or folder holds tests alone: `tests.rs`, `edge_tests.rs`, `tearing_tests/`.
fn is_of_tests(path: &Path) -> bool {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    stem == "tests" || stem.ends_with("_tests")
}
