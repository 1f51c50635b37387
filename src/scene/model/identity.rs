//! The identity of a run: all that decides its bits.

use std::io;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::{ImpactorShape, Model};
use crate::mesh::Outline;
use base::diagnostic::shown_path;
use base::file::Digest;

/// The identity of a run, equal where its bits are: the checked model without its name, its paths and what is read
/// after the run, and the content of its meshes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Identity {
    model: Model,
    /// The files of its meshes, specimen first.
    meshes: Vec<Digest>,
}

impl Identity {
    /// The identity of the runs of `model`.
    ///
    /// # Errors
    /// A mesh cannot be read.
    pub fn from_model(model: &Model) -> io::Result<Identity> {
        let meshes = model.meshes().into_iter().map(|mesh| digest(mesh.path)).collect::<io::Result<_>>()?;
        Ok(Identity { model: decisive(model), meshes })
    }
}

fn digest(path: &Path) -> io::Result<Digest> {
    Digest::of_file(path).map_err(|error| io::Error::other(format!("{}: {error}", shown_path(path))))
}

/// The model without what does not determine the bits of its run: its name, the paths of its meshes, and what is read
/// after the run.
fn decisive(model: &Model) -> Model {
    let mut model = Model { name: String::new(), title: String::new(), reference: None, post: None, ..model.clone() };
    if let Outline::Mesh { path, .. } = &mut model.specimen.shape {
        *path = PathBuf::new();
    }
    model.impactors.iter_mut().for_each(|impactor| without_paths(&mut impactor.shape));
    model
}

fn without_paths(shape: &mut ImpactorShape) {
    match shape {
        ImpactorShape::Mesh { path, .. } => *path = PathBuf::new(),
        ImpactorShape::Compound(parts) => parts.iter_mut().for_each(|part| without_paths(&mut part.shape)),
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mesh_is_compared_by_what_its_file_holds() {
        let folder = tempfile::tempdir().unwrap();
        let [path, moved] = ["a.stl", "b.stl"].map(|name| folder.path().join(name));
        std::fs::write(&path, "solid film").unwrap();
        let before = digest(&path).unwrap();
        std::fs::rename(&path, &moved).unwrap();
        assert_eq!(digest(&moved).unwrap(), before);
        std::fs::write(&moved, "solid Film").unwrap();
        assert_ne!(digest(&moved).unwrap(), before);
        assert!(digest(&path).is_err());
    }
}
