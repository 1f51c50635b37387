//! A test: a scenario and what its run must give.

use std::fs;
use std::path::{Path, PathBuf};

use clap::Args;

use super::{Failure, Shared, print, write_with_schema};
use base::diagnostic::{Diagnostic, shown_path};
use scene::scenario::Document;
use scene::scenario::FileKind;
use study::store;

#[derive(Debug, Args)]
pub(super) struct CaseArgs {
    /// The folder to write; files in it are not replaced
    folder: PathBuf,
    /// The scenario that the test extends; left out, a drop test to change
    #[arg(long, value_name = "SCENARIO")]
    scenario: Option<PathBuf>,
}

const EXPECTATIONS: &str = include_str!("templates/expect.toml");
const SCENARIO: &str = include_str!("templates/drop.toml");

pub(super) fn write(args: &CaseArgs, shared: &Shared) -> Result<(), Failure> {
    let scenario = match &args.scenario {
        Some(base) => {
            Document::read(base)?;
            extended(&args.folder, base)
        }
        None => SCENARIO.to_owned(),
    };
    let files = [
        (FileKind::Scenario, "scenario.toml", scenario.as_str()),
        (FileKind::Expectations, "expect.toml", EXPECTATIONS),
    ];
    let files = files.map(|(kind, name, text)| (kind, args.folder.join(name), text));
    if let Some((_, path, _)) = files.iter().find(|(_, path, _)| path.exists()) {
        return Err(super::exists(path, "give another folder, or remove it first"));
    }
    fs::create_dir_all(&args.folder).map_err(|error| {
        Failure::output(Diagnostic::new(format!("cannot create {}: {error}", shown_path(&args.folder))))
    })?;
    files.iter().try_for_each(|(kind, path, text)| write_with_schema(*kind, path, text))?;
    if shared.quiet {
        return Ok(());
    }
    let [scenario, expectations] = files.map(|(_, path, _)| shown_path(&path).to_string());
    let folder = shown_path(&args.folder);
    print(&format!("wrote {scenario}, {expectations}; try: droptower test {folder} --bless"))
}

/// A scenario in `folder` that extends another one.
fn extended(folder: &Path, base: &Path) -> String {
    let base = toml::Value::from(store::path_from(folder, base));
    format!(
        "extends = {base}\n\n# Coarse and short, so that the test takes seconds:\n# specimen.mesh.size = \"20 mm\"\n"
    )
}
