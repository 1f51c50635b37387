//! The material file and the shear curve beside it: written completely, and never over a file of the user.

use std::path::{Path, PathBuf};

use crate::{Failure, output};
use base::diagnostic::{Diagnostic, shown_path};

/// The paths of the material and its shear curve: `film.toml` and `film-shear.csv`.
pub(super) fn places(material: &Path) -> Result<[PathBuf; 2], Failure> {
    if !output::ends_in(material, "toml") {
        return Err(
            Diagnostic::new(format!("a material file ends in .toml, and {} does not", shown_path(material))).into()
        );
    }
    let stem = material.file_stem().unwrap_or_default().to_string_lossy();
    let shear = material.with_file_name(format!("{stem}-shear.csv"));
    let check = |place: &Path, ending| output::check(place, ending, None, None);
    let checked = [check(material, "toml"), check(&shear, "csv")];
    if let Some(failure) = Failure::all(checked.into_iter().filter_map(Result::err)) {
        return Err(failure);
    }
    Ok([material.to_path_buf(), shear])
}

/// Renames the files to their paths once all are written.
pub(super) fn write(texts: &[(PathBuf, String)]) -> Result<(), Failure> {
    output::write_sealed(texts)
}
