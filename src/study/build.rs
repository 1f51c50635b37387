//! Names the build after its sources: what another build computes may differ in its bits.

use std::path::{Path, PathBuf};
use std::{env, fs, io};

use sha2::{Digest, Sha256};

/// What decides the results: the sources, the modules that scripts import, and the versions of the dependencies.
const SOURCES: [&str; 4] = ["src", "scripts/droptower", "Cargo.toml", "Cargo.lock"];

fn main() -> io::Result<()> {
    let root = PathBuf::from(env::var_os("CARGO_MANIFEST_DIR").unwrap_or_default()).join("../..");
    let mut files = vec![];
    for source in SOURCES {
        println!("cargo::rerun-if-changed=../../{source}");
        gather(&root.join(source), &mut files)?;
    }
    files.sort();
    let mut digest = Sha256::new();
    for file in files {
        let name = file.strip_prefix(&root).unwrap_or(&file);
        digest.update(name.to_string_lossy().replace('\\', "/"));
        // A checkout may have other line ends.
        digest.update(fs::read(&file)?.into_iter().filter(|byte| *byte != b'\r').collect::<Vec<u8>>());
    }
    let name: String = digest.finalize().iter().take(8).map(|byte| format!("{byte:02x}")).collect();
    println!("cargo::rustc-env=DROPTOWER_BUILD={name}");
    Ok(())
}

/// The files at or below `path`; none where there is none, as a lock file of an installed package may be missing.
fn gather(path: &Path, files: &mut Vec<PathBuf>) -> io::Result<()> {
    if path.is_dir() {
        for entry in fs::read_dir(path)? {
            gather(&entry?.path(), files)?;
        }
    } else if path.is_file() {
        files.push(path.to_owned());
    }
    Ok(())
}
