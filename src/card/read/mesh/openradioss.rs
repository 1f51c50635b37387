//! Meshes of OpenRadioss: `/NODE`, `/SHELL`, `/SH3N` and the titles of `/PART`.

use super::line::Fields;
use super::{Include, Reader};
use crate::read::{Fault, Mistake, Place};

/// What the lines below a block are.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Below {
    Nothing,
    Node,
    /// Elements of a part.
    Elements(u32),
    Title(u32),
}

/// Blocks of elements that are no film.
const OTHERS: [&str; 12] =
    ["BRICK", "BRIC20", "PENTA6", "SHEL16", "TETRA4", "TETRA10", "QUAD", "TRIA", "BEAM", "TRUSS", "SPRING", "SPHCEL"];

pub(super) fn read(reader: &mut Reader, text: &str, file: usize) -> Result<Vec<Include>, Mistake> {
    const NODE: [usize; 4] = [10, 20, 20, 20];
    const ELEMENT: [usize; 5] = [10; 5];
    let (mut includes, mut below) = (vec![], Below::Nothing);
    for (index, line) in text.lines().enumerate() {
        let (number, line) = (index + 1, line.trim_end());
        let place = |column: usize| Place { line: number, column };
        if let Some(name) = line.strip_prefix("#include") {
            includes.push(Include { place: place(1), name: name.trim().to_owned() });
            continue;
        }
        if line.starts_with(['#', '$']) || line.is_empty() {
            continue;
        }
        let Some(words) = line.strip_prefix('/') else {
            match below {
                Below::Nothing => {}
                Below::Node => reader.add_node(0, &Fields::in_columns(line, number, &NODE)?)?,
                Below::Elements(part) => {
                    reader.add_element([part, 0], &Fields::in_columns(line, number, &ELEMENT)?, 1, file)?;
                }
                Below::Title(part) => {
                    line.trim().clone_into(&mut reader.parts[part as usize].name);
                    below = Below::Nothing;
                }
            }
            continue;
        };
        let words: Vec<String> = words.split('/').map(|word| word.trim().to_ascii_uppercase()).collect();
        let part = |reader: &mut Reader| -> Result<u32, Mistake> {
            let written = words.get(1).map_or("", String::as_str);
            let fault = Fault::NotANumber { name: "the part", text: written.to_owned() };
            let found = written.parse::<i64>().ok().filter(|part| (0..1_000_000_000_000).contains(part));
            Ok(reader.part(found.ok_or(Mistake { place: place(words[0].chars().count() + 3), fault })?))
        };
        below = match words[0].as_str() {
            "END" => break,
            "NODE" => Below::Node,
            "SHELL" | "SH3N" => Below::Elements(part(reader)?),
            "PART" => Below::Title(part(reader)?),
            "TRANSFORM" | "SUBMODEL" | "PARAMETER" => {
                let fault = Fault::Unknown(format!("/{} changes the mesh and is not read", words[0]));
                return Err(Mistake { place: place(1), fault });
            }
            other => {
                if OTHERS.contains(&other) {
                    reader.not_read(format!("/{other}"), number);
                }
                Below::Nothing
            }
        };
    }
    Ok(includes)
}
