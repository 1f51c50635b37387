//! `droptower deck read`: the mesh of a deck as a specimen.

use std::fs;
use std::path::{Path, PathBuf};

use clap::Args;
use serde::Serialize;

use crate::card::misread;
use crate::card::request::system;
use crate::{Failure, Shared, findings, output, print_figures};
use ::card::System;
use ::card::read::mesh::{FoundMesh, Include, Reader};
use ::card::read::{Fault, Mistake};
use base::diagnostic::{Diagnostic, folder_of, shown_path};
use base::file;
use base::finding::Finding;
use membrane::engine::Mesh;
use scene::mesh::export;

/// Longest deck, all of its files together, bytes.
const MOST_BYTES: u64 = 512 << 20;

/// Most files of a deck, and how deep they include each other.
const MOST_FILES: usize = 1000;
const DEEPEST: usize = 8;

/// The options of `deck read`.
#[derive(Debug, Args)]
pub(crate) struct ReadArgs {
    /// A deck of LS-DYNA, OpenRadioss, Abaqus or CalculiX
    pub deck: PathBuf,
    /// The mesh to write
    #[arg(long, short, value_name = "FILE")]
    pub out: PathBuf,
    /// Number or name of the part [default: the only one with elements of three or four nodes]
    #[arg(long, value_name = "PART")]
    pub part: Option<String>,
    /// The units of the deck: kg-m-s, t-mm-s, g-mm-ms, kg-mm-ms or lbf-in-s [default: those that a deck of droptower names]
    #[arg(long, value_name = "SYSTEM", value_parser = system)]
    pub units: Option<System>,
    /// Replace a file that exists
    #[arg(long)]
    pub force: bool,
}

/// What was written, for `--json`.
#[derive(Serialize)]
struct Summary {
    out: String,
    deck: String,
    part: String,
    units: &'static str,
    nodes: usize,
    elements: usize,
    size_m: [f64; 3],
    findings: Vec<Finding>,
}

pub(super) fn run(args: &ReadArgs, shared: &Shared) -> Result<(), Failure> {
    output::check(&args.out, "vtu", Some(&args.deck), Some(args.force))?;
    let shown = shown_path(&args.deck);
    let mut files = Files { read: vec![], left: MOST_BYTES };
    let text = files.text(&args.deck).map_err(|error| Diagnostic::new(format!("cannot read {shown}: {error}")))?;
    let system = args.units.or_else(|| ::card::units_of(&text)).ok_or_else(|| {
        let mistake = Diagnostic::new(format!("the units of {shown} are not known: decks have none of their own"));
        mistake.hint("name them, such as --units t-mm-s")
    })?;
    let mut reader = Reader::new(system);
    files.follow(&mut reader, &args.deck, text, 0)?;
    let FoundMesh { part, nodes, quads, tris, warnings } =
        reader.mesh(args.part.as_deref()).map_err(|error| match &error.mistake.fault {
            Fault::NoElements => Diagnostic::new(format!("{shown}: {}", error.mistake.fault)),
            Fault::SeveralParts(_) | Fault::NoSuchPart { .. } => {
                Diagnostic::new(format!("{shown}: {}", error.mistake.fault)).hint("name one of them: --part")
            }
            _ => {
                let path = files.read[error.file].clone();
                let text = file::read_text(&path, MOST_BYTES).unwrap_or_default();
                misread(&path, &text, &error.mistake)
            }
        })?;
    let elements = quads.len() + tris.len();
    let size_m = [0, 1, 2].map(|axis| {
        let range = nodes.iter().map(|node| node[axis]);
        range.clone().fold(f64::NEG_INFINITY, f64::max) - range.fold(f64::INFINITY, f64::min)
    });
    let mesh = Mesh { nodes: nodes.into_iter().map(Into::into).collect(), quads, tris, ..Mesh::default() };
    let text = export::vtu(&mesh);
    output::write(&args.out, |file| file.write_all(text.as_bytes()))?;
    let summary = Summary {
        out: shown_path(&args.out),
        deck: shown,
        part,
        units: system.name(),
        nodes: mesh.nodes.len(),
        elements,
        size_m,
        findings: warnings.iter().map(Finding::new).collect(),
    };
    print_figures(shared, &summary, || {
        let Summary { out, deck, part, units, nodes, elements, findings, .. } = &summary;
        let [x, y, z] = summary.size_m.map(|size| base::number::significant(1e3 * size, 4));
        format!(
            "part {part} of {deck}, {units}: {nodes} nodes, {elements} elements, {x} x {y} x {z} mm\n{}  {out}",
            findings::lines("  ", findings)
        )
    })
}

/// The files of a deck.
struct Files {
    /// Those that were read, in the order in which the reader was given them.
    read: Vec<PathBuf>,
    /// Bytes that may still be read.
    left: u64,
}

impl Files {
    fn text(&mut self, path: &Path) -> Result<String, file::FileError> {
        let text = file::read_text(path, self.left)?;
        self.left -= (text.len() as u64).min(self.left);
        Ok(text)
    }

    /// Gives the reader the text of a file and of all that it includes, which are in the folder of the deck or below it.
    fn follow(&mut self, reader: &mut Reader, path: &Path, text: String, depth: usize) -> Result<(), Diagnostic> {
        self.read.push(path.to_owned());
        let place = self.read.len() - 1;
        let includes = reader.read(&text, place).map_err(|mistake| misread(path, &text, &mistake))?;
        for Include { place, name } in includes {
            let refused = |why: String, hint: &str| {
                let mistake = Mistake { place, fault: Fault::Unknown(why) };
                misread(path, &text, &mistake).hint(hint.to_owned())
            };
            let included = self
                .within(path, &name)
                .map_err(|why| refused(why, "put its lines here, or the file beside the deck"))?;
            if depth >= DEEPEST || self.read.len() >= MOST_FILES || self.read.contains(&included) {
                let why = format!("`{name}` is included again, or too deep");
                return Err(refused(why, "a deck includes each file once"));
            }
            let inner = self
                .text(&included)
                .map_err(|error| refused(format!("cannot read `{name}`: {error}"), "check its name"))?;
            self.follow(reader, &included, inner, depth + 1)?;
        }
        Ok(())
    }

    /// The file `name` that `path` includes; in words why it is not read.
    fn within(&self, path: &Path, name: &str) -> Result<PathBuf, String> {
        let root =
            fs::canonicalize(folder_of(&self.read[0])).map_err(|error| format!("cannot read the folder: {error}"))?;
        let found =
            fs::canonicalize(folder_of(path).join(name)).map_err(|error| format!("cannot read `{name}`: {error}"))?;
        match found.starts_with(&root) {
            true => Ok(found),
            false => Err(format!("`{name}` is outside of the folder of the deck and is not read")),
        }
    }
}
