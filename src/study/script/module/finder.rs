//! Where modules are: beside the script, in its folder `modules`, or within droptower.

use std::fs;
use std::path::{Path, PathBuf};

use thiserror::Error;

use super::{LONGEST_SCRIPT, SHIPPED, ShippedModule, SourceText};
use base::diagnostic::{closest, shown_path};
use base::file;

/// Longest name of a module, bytes.
const LONGEST_NAME: usize = 200;

/// Extension of the file of a module.
const EXTENSION: &str = "rhai";

/// Folder beside a script in which its modules may be.
const FOLDER: &str = "modules";

/// Why a module cannot be read.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub(in crate::script) enum FindError {
    #[error("`{name}` cannot name a module")]
    Name { name: String },
    #[error("there is no module `{name}`")]
    Missing { name: String, hint: String },
    #[error("the module `{name}` leads out of the folder of the script, to {}", shown_path(target))]
    Outside { name: String, target: PathBuf },
    #[error(
        "a post script imports only what droptower ships: its run is repeated from its folder, which has no `{name}`"
    )]
    NotOffered { name: String },
    #[error("cannot read {}: {cause}", shown_path(path))]
    Read { path: PathBuf, cause: String },
    #[error("the script would import itself")]
    Itself,
}

impl FindError {
    pub fn hint(&self) -> Option<String> {
        match self {
            FindError::Name { .. } => Some(
                "names of letters, digits, `-` and `_`, in folders below that of the script: \"tower/film\"".into(),
            ),
            FindError::Missing { hint, .. } => Some(hint.clone()),
            FindError::NotOffered { .. } => Some("write the functions into the script".into()),
            _ => None,
        }
    }
}

/// Finds the modules of one script.
pub(in crate::script) struct Finder {
    /// The file of the script.
    pub script: PathBuf,
    pub shipped: Vec<ShippedModule>,
    /// Whether modules in files may be imported.
    pub reads_files: bool,
}

impl Finder {
    /// The text of the module `name`.
    pub fn find(&self, name: &str) -> Result<SourceText, FindError> {
        if name.starts_with(SHIPPED) {
            return self.find_shipped(name);
        }
        if !is_name(name) {
            return Err(FindError::Name { name: name.chars().take(LONGEST_NAME).collect() });
        }
        if !self.reads_files {
            return Err(FindError::NotOffered { name: name.into() });
        }
        let folder = self.script.parent().unwrap_or(Path::new(""));
        let file = format!("{name}.{EXTENSION}");
        let places = [folder.join(&file), folder.join(FOLDER).join(&file)];
        let Some(path) = places.iter().find(|path| fs::symlink_metadata(path).is_ok()) else {
            let [beside, below] = places.each_ref().map(|path| shown_path(path));
            return Err(FindError::Missing { name: name.into(), hint: format!("neither {beside} nor {below} exists") });
        };
        self.check_place(name, path, folder)?;
        let text = file::read_text(path, LONGEST_SCRIPT)
            .map_err(|error| FindError::Read { path: path.clone(), cause: error.to_string() })?;
        Ok(SourceText::new(path, &text))
    }

    fn find_shipped(&self, name: &str) -> Result<SourceText, FindError> {
        let names = || self.shipped.iter().map(|module| module.name);
        let Some(module) = self.shipped.iter().find(|module| module.name == name) else {
            let hint = match closest(name, names()) {
                Some(name) => format!("did you mean \"{name}\"?"),
                None => format!("droptower has {}", names().collect::<Vec<_>>().join(", ")),
            };
            return Err(FindError::Missing { name: name.into(), hint });
        };
        Ok(SourceText::new(format!("<{name}.{EXTENSION}>"), module.text))
    }

    /// Refuses links that lead out of the folder of the script.
    fn check_place(&self, name: &str, path: &Path, folder: &Path) -> Result<(), FindError> {
        let real = |path: &Path| {
            let path = if path.as_os_str().is_empty() { Path::new(".") } else { path };
            path.canonicalize().map_err(|error| FindError::Read { path: path.into(), cause: error.to_string() })
        };
        let target = real(path)?;
        if !target.starts_with(real(folder)?) {
            return Err(FindError::Outside { name: name.into(), target });
        }
        if self.script.canonicalize().is_ok_and(|script| script == target) {
            return Err(FindError::Itself);
        }
        Ok(())
    }
}

fn is_name(name: &str) -> bool {
    let letter = |c: char| c.is_ascii_alphanumeric() || "-_".contains(c);
    name.len() <= LONGEST_NAME && name.split('/').all(|part| !part.is_empty() && part.chars().all(letter))
}
