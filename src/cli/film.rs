//! The film that a card is made from.

use std::fs;
use std::path::{Path, PathBuf};

use sha2::{Digest, Sha256};

use base::diagnostic::{Diagnostic, shown_path};
use membrane::material::Material;
use scene::model::{self, Face};
use scene::scenario::Document;
use study::store::run_files;

/// A film, and what it was made from.
pub(crate) struct Source {
    pub(crate) name: String,
    pub(crate) material: Material,
    /// Layers that it stands for: those of its face, one of a material.
    pub(crate) layers: u32,
    /// Lines for the head of a card.
    pub(crate) origin: Vec<String>,
}

/// The film of a material, of a scenario or of a run's folder; of several faces that of `face`, counted from 1.
pub(crate) fn read(path: &Path, face: Option<usize>) -> Result<Source, Vec<Diagnostic>> {
    let file = if path.is_dir() { in_folder(path)? } else { path.to_path_buf() };
    let document = Document::read(&file)?;
    if document.is_material() {
        let document = Document::read_material(&file)?;
        let material = model::check_material(&document)?;
        if let Some(face) = face {
            let mistake = Diagnostic::new(format!("{} is a material, which has no face {face}", shown_path(&file)));
            return Err(vec![mistake.hint("leave --face out")]);
        }
        let named = document.material().0.and_then(|written| written.name);
        let name = named.unwrap_or_else(|| document.name());
        return Ok(Source { name, material, layers: 1, origin: origin(&document)? });
    }
    let model = model::check(&document)?;
    let Face { film, material, layers, .. } = chosen(&model.faces, face, &file)?;
    let name = film.clone().unwrap_or_else(|| document.name());
    Ok(Source { name, material: material.clone(), layers: *layers, origin: origin(&document)? })
}

/// The file of a film among the results of a study.
const FILM: &str = "film.toml";

/// The scenario of a run, or the film of a study.
pub(crate) fn in_folder(folder: &Path) -> Result<PathBuf, Vec<Diagnostic>> {
    let files = [run_files::SCENARIO, FILM].map(|name| folder.join(name));
    files.into_iter().find(|file| file.is_file()).ok_or_else(|| {
        let mistake = Diagnostic::new(format!("{} has neither {} nor {FILM}", shown_path(folder), run_files::SCENARIO));
        vec![mistake.hint("name the folder of a run, that of a study which wrote its film, or a material or scenario")]
    })
}

fn chosen<'a>(faces: &'a [Face], face: Option<usize>, file: &Path) -> Result<&'a Face, Vec<Diagnostic>> {
    let count = faces.len();
    let found = match (faces, face) {
        ([only], None) => Some(only),
        (_, Some(face)) => face.checked_sub(1).and_then(|place| faces.get(place)),
        (faces, None) => faces.first().filter(|first| faces.iter().all(|face| face.material == first.material)),
    };
    found.ok_or_else(|| {
        let mistake = Diagnostic::new(format!("{} has {count} faces of film", shown_path(file)));
        vec![mistake.hint(format!("name one of them: --face 1 to --face {count}"))]
    })
}

/// The file and its checksum, which also covers the files that it reads, one behind the other in their order.
pub(crate) fn origin(document: &Document) -> Result<Vec<String>, Vec<Diagnostic>> {
    let file = document.path();
    let others: Vec<&PathBuf> = document.files().iter().filter(|other| *other != file).collect();
    let mut digest = Sha256::new();
    for path in std::iter::once(file).chain(others.iter().map(|path| path.as_path())) {
        digest.update(fs::read(path).map_err(|error| vec![Diagnostic::new(format!("{}: {error}", shown_path(path)))])?);
    }
    let digest: String = digest.finalize().iter().map(|byte| format!("{byte:02x}")).collect();
    let names: Vec<String> = others.iter().map(|path| shown_path(path)).collect();
    let others = if names.is_empty() { String::new() } else { format!(" and {}", names.join(", ")) };
    Ok(vec![format!("from {}{others}, SHA-256 {digest}", shown_path(file))])
}
