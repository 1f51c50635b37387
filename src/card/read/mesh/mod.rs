//! Meshes in decks of other solvers: nodes, and elements of three and four nodes by part.
//!
//! A [`Reader`] is given the text of a deck and of the files that it includes, one after the other, and then gives the mesh of one
//! part. It knows no files: what is included is named, and whoever reads the files decides about that.

mod abaqus;
mod line;
mod ls_dyna;
mod openradioss;

use std::collections::{BTreeMap, HashMap};

use super::{Fault, Mistake, Place};
use crate::system::System;
use base::findings;

use line::Fields;

/// A file that a deck includes.
#[derive(Clone, Debug, PartialEq)]
pub struct Include {
    /// Where it is named.
    pub place: Place,
    /// As written.
    pub name: String,
}

/// A mistake in one of the files.
#[derive(Clone, Debug, PartialEq)]
pub struct InFile {
    /// As it was given to [`Reader::read`].
    pub file: usize,
    /// What.
    pub mistake: Mistake,
}

/// The mesh of a part.
#[derive(Clone, Debug, PartialEq)]
pub struct FoundMesh {
    /// Number or name of the part.
    pub part: String,
    /// Those of its elements, m, in the order of the deck.
    pub nodes: Vec<[f64; 3]>,
    /// Corners of the elements of four nodes.
    pub quads: Vec<[u32; 4]>,
    /// Corners of the elements of three nodes.
    pub tris: Vec<[u32; 3]>,
    /// What the deck says besides.
    pub warnings: Vec<MeshWarning>,
}

findings! {
    /// Something in a deck that its mesh does not have.
    #[derive(Clone, Debug, PartialEq)]
    pub enum MeshWarning {
        Elements {
            kind: String, "keyword or type of the elements" => "kind";
            line: usize, "of the first" => "line";
        } = "deck-elements-not-read", Note;
            meaning "a deck has elements that are none of a film: not of three or four nodes";
            remedy "nothing, if they are not film; elements with nodes on their edges are written without them first";
            message "line {line}: elements of {kind} are not read";
        Parts {
            read: String, "the part that was read" => "read";
            others: usize, "parts with elements besides" => "others";
        } = "deck-other-parts", Note;
            meaning "a deck has several parts of elements of which a film can be, of which one was read";
            remedy "another one: `--part`";
            message "{others} other parts are not read; {read} is";
    }
}

/// Most nodes, and most elements, of all files of a deck.
const MOST: usize = 5_000_000;

/// The formats of decks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Format {
    LsDyna,
    OpenRadioss,
    Abaqus,
}

/// The nodes and elements of a deck so far.
#[derive(Debug)]
pub struct Reader {
    system: System,
    format: Option<Format>,
    /// By the scope of their numbers, which are those of one part in Abaqus' assemblies, and number.
    nodes: HashMap<(u32, i64), [f64; 3]>,
    elements: Vec<Element>,
    parts: Vec<Part>,
    /// Places among the parts, by their keys.
    places: HashMap<String, u32>,
    unread: BTreeMap<String, usize>,
}

#[derive(Clone, Copy, Debug)]
struct Element {
    part: u32,
    scope: u32,
    /// A triangle has its last one twice.
    corners: [i64; 4],
    file: u32,
    line: u32,
}

/// A part by its number, or by its name alone.
#[derive(Clone, Debug, Default)]
struct Part {
    number: Option<i64>,
    name: String,
}

impl Part {
    /// What it is called on the command line.
    fn key(&self) -> String {
        self.number.map_or_else(|| self.name.clone(), |number| number.to_string())
    }

    fn is(&self, wanted: &str) -> bool {
        self.key() == wanted || self.name.eq_ignore_ascii_case(wanted)
    }
}

impl Reader {
    /// A reader of a deck in the units of `system`.
    pub fn new(system: System) -> Reader {
        Reader {
            system,
            format: None,
            nodes: HashMap::new(),
            elements: vec![],
            parts: vec![],
            places: HashMap::new(),
            unread: BTreeMap::new(),
        }
    }

    /// Reads the text of the `file`, counted by the caller; what it includes.
    ///
    /// # Errors
    /// [`Mistake`], the first.
    pub fn read(&mut self, text: &str, file: usize) -> Result<Vec<Include>, Mistake> {
        let format = self.format.or_else(|| format_of(text));
        self.format = format;
        match format {
            Some(Format::LsDyna) => ls_dyna::read(self, text, file),
            Some(Format::OpenRadioss) => openradioss::read(self, text, file),
            Some(Format::Abaqus) => abaqus::read(self, text, file),
            None => Err(Mistake { place: Place { line: 1, column: 1 }, fault: Fault::UnknownFormat }),
        }
    }

    /// The mesh of the part whose number or name is `wanted`; of the only one that has elements, where none is named.
    ///
    /// # Errors
    /// There is no such part, or an element is at a node that is not there.
    pub fn mesh(self, wanted: Option<&str>) -> Result<FoundMesh, InFile> {
        let nowhere = |fault| InFile { file: 0, mistake: Mistake { place: Place { line: 1, column: 1 }, fault } };
        let mut with_elements: Vec<u32> = self.elements.iter().map(|element| element.part).collect();
        with_elements.sort_unstable();
        with_elements.dedup();
        let keys = || -> Vec<String> { with_elements.iter().map(|part| self.parts[*part as usize].key()).collect() };
        let part = match (wanted, with_elements.as_slice()) {
            (_, []) => return Err(nowhere(Fault::NoElements)),
            (None, [only]) => *only,
            (None, _) => return Err(nowhere(Fault::SeveralParts(shown(&keys())))),
            (Some(wanted), parts) => {
                let found = parts.iter().find(|part| self.parts[**part as usize].is(wanted));
                let fault = || Fault::NoSuchPart { wanted: wanted.to_owned(), parts: shown(&keys()) };
                *found.ok_or_else(|| nowhere(fault()))?
            }
        };
        let mut mesh = FoundMesh {
            part: self.parts[part as usize].key(),
            nodes: vec![],
            quads: vec![],
            tris: vec![],
            warnings: self
                .unread
                .iter()
                .map(|(kind, line)| MeshWarning::Elements { kind: kind.clone(), line: *line })
                .collect(),
        };
        if with_elements.len() > 1 {
            mesh.warnings.push(MeshWarning::Parts { read: mesh.part.clone(), others: with_elements.len() - 1 });
        }
        let mut numbers: HashMap<(u32, i64), u32> = HashMap::new();
        for Element { scope, corners, file, line, .. } in self.elements.iter().filter(|element| element.part == part) {
            let mut corner = |number: i64| -> Result<u32, InFile> {
                if let Some(known) = numbers.get(&(*scope, number)) {
                    return Ok(*known);
                }
                let place = Place { line: *line as usize, column: 1 };
                let missing =
                    || InFile { file: *file as usize, mistake: Mistake { place, fault: Fault::NoNode(number) } };
                let node = self.nodes.get(&(*scope, number)).ok_or_else(missing)?;
                let new = mesh.nodes.len() as u32;
                mesh.nodes.push(node.map(|value| value * self.system.length()));
                numbers.insert((*scope, number), new);
                Ok(new)
            };
            let [a, b, c] = [corner(corners[0])?, corner(corners[1])?, corner(corners[2])?];
            match corners[3] == corners[2] {
                true => mesh.tris.push([a, b, c]),
                false => mesh.quads.push([a, b, c, corner(corners[3])?]),
            }
        }
        Ok(mesh)
    }

    /// Adds a node of which the number and the coordinates are fields from `place` on.
    fn add_node(&mut self, scope: u32, fields: &Fields<'_>) -> Result<(), Mistake> {
        let number = fields.whole(0, "the number of a node")?;
        let at = [fields.real(1, "x")?, fields.real(2, "y")?, fields.real(3, "z")?];
        if self.nodes.len() >= MOST {
            return Err(fields.mistake(0, Fault::TooMany { what: "nodes", most: MOST }));
        }
        match self.nodes.insert((scope, number), at) {
            Some(other) if other != at => Err(fields.mistake(0, Fault::Twice(number))),
            _ => Ok(()),
        }
    }

    /// Adds an element whose corners are fields from `first` on; none but zeros behind the third is a triangle.
    fn add_element(&mut self, of: [u32; 2], fields: &Fields<'_>, first: usize, file: usize) -> Result<(), Mistake> {
        let corner = |place: usize| fields.whole(first + place, "the number of a node");
        let [a, b, c] = [corner(0)?, corner(1)?, corner(2)?];
        let fourth = if fields.is_blank(first + 3) { c } else { corner(3)? };
        let corners = [a, b, c, if fourth == 0 { c } else { fourth }];
        if self.elements.len() >= MOST {
            return Err(fields.mistake(0, Fault::TooMany { what: "elements", most: MOST }));
        }
        let [part, scope] = of;
        self.elements.push(Element { part, scope, corners, file: file as u32, line: fields.line() as u32 });
        Ok(())
    }

    /// The part of this number.
    fn part(&mut self, number: i64) -> u32 {
        self.place(Part { number: Some(number), name: String::new() })
    }

    /// The part of this name, however it is capitalised.
    fn part_named(&mut self, name: &str) -> u32 {
        self.place(Part { number: None, name: name.to_owned() })
    }

    fn place(&mut self, part: Part) -> u32 {
        *self.places.entry(part.key().to_ascii_uppercase()).or_insert_with(|| {
            self.parts.push(part);
            self.parts.len() as u32 - 1
        })
    }

    fn not_read(&mut self, kind: String, line: usize) {
        self.unread.entry(kind).or_insert(line);
    }
}

/// The first names of a list.
fn shown(names: &[String]) -> String {
    const MOST_NAMES: usize = 20;
    let first: Vec<&str> = names.iter().take(MOST_NAMES).map(String::as_str).collect();
    let more = if names.len() > MOST_NAMES { ", …" } else { "" };
    format!("{}{more}", first.join(", "))
}

/// The format of a text by its first telling line.
fn format_of(text: &str) -> Option<Format> {
    let mut after_node = false;
    for line in text.lines() {
        let upper = line.trim_end().to_ascii_uppercase();
        if upper.starts_with('/') || upper.starts_with("#RADIOSS") {
            return Some(Format::OpenRadioss);
        }
        if upper.starts_with("**") {
            return Some(Format::Abaqus);
        }
        if upper.starts_with('$') {
            return Some(Format::LsDyna);
        }
        if let Some(keyword) = upper.strip_prefix('*') {
            let name = keyword.split([',', ' ']).next().unwrap_or_default();
            match name {
                "NODE" if !keyword.contains(',') => after_node = true,
                _ if name.contains('_') || name == "KEYWORD" || name == "TITLE" => return Some(Format::LsDyna),
                _ => return Some(Format::Abaqus),
            }
        } else if after_node && !upper.trim().is_empty() {
            // LS-DYNA's free format has commas too, but its files begin with their keyword.
            return Some(if upper.contains(',') { Format::Abaqus } else { Format::LsDyna });
        }
    }
    after_node.then_some(Format::LsDyna)
}
