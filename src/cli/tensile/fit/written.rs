//! The files of a fit: the material and the page, checked before anything is computed.

use std::path::{Path, PathBuf};

use super::FitArgs;
use crate::{Failure, output};
use base::diagnostic::{Diagnostic, shown_path};

/// Where the files of a fit go.
pub(super) struct Places {
    pub(super) material: Option<PathBuf>,
    pub(super) page: Option<PathBuf>,
}

impl Places {
    /// The places that the arguments name.
    pub(super) fn from_args(args: &FitArgs) -> Result<Places, Failure> {
        let material = args.out.clone();
        if let Some(path) = material.as_deref().filter(|path| !output::ends_in(path, "toml")) {
            let message = format!("a material file ends in .toml, and {} does not", shown_path(path));
            return Err(Diagnostic::new(message).into());
        }
        let page = args.page.clone().or_else(|| material.as_ref().map(|path| path.with_extension("html")));
        let checked = [
            material.as_deref().map_or(Ok(()), |path| output::check(path, "toml", None, None)),
            page.as_deref().map_or(Ok(()), |path| output::check_page(path, None)),
        ];
        match Failure::all(checked.into_iter().filter_map(Result::err)) {
            Some(failure) => Err(failure),
            None => Ok(Places { material, page }),
        }
    }

    /// Writes the page and then the material, and gives their paths.
    pub(super) fn write(&self, material: &str, page: &str) -> Result<Vec<String>, Failure> {
        if let Some(path) = &self.page {
            output::write(path, |file| file.write_all(page.as_bytes()))?;
        }
        if let Some(path) = &self.material {
            output::write_sealed(&[(path.clone(), material.to_owned())])?;
        }
        Ok([&self.page, &self.material].into_iter().flatten().map(|path| shown_path(path)).collect())
    }
}

/// The name of a file without its folder.
pub(super) fn name(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}
