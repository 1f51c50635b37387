//! Meshes of LS-DYNA: `*NODE`, `*ELEMENT_SHELL` and the headings of `*PART`.

use super::line::Fields;
use super::{Include, Reader};
use crate::read::{Fault, Mistake, Place};

/// What the lines below a keyword are.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Below {
    Nothing,
    Node,
    /// Elements, each with so many lines more.
    Shell(usize),
    /// Elements of a kind that is not read.
    Others,
    PartHeading,
    Part,
    Include,
}

/// One pass over the lines, since a keyword says what those below it are and may change the width of their fields; it gives the
/// files that the text includes, for the caller to read.
pub(super) fn read(reader: &mut Reader, text: &str, file: usize) -> Result<Vec<Include>, Mistake> {
    /// Widths of the fields of a node, and of all those of an element: of the three formats.
    const NODE: [[usize; 4]; 3] = [[8, 16, 16, 16], [20, 20, 20, 20], [10, 16, 16, 16]];
    const SHELL: [usize; 3] = [8, 20, 10];
    const FIELDS: usize = 6;
    let (mut includes, mut below, mut format, mut long_deck, mut skip) = (vec![], Below::Nothing, 0, false, 0);
    let (mut keyword, mut heading) = (String::new(), "");
    for (index, line) in text.lines().enumerate() {
        let (number, line) = (index + 1, line.trim_end());
        let place = |column: usize| Place { line: number, column };
        if line.starts_with('$') || line.is_empty() && below != Below::PartHeading {
            continue;
        }
        if let Some(written) = line.strip_prefix('*') {
            let written = written.to_ascii_uppercase();
            let mut words = written.split_whitespace();
            let name = words.next().unwrap_or_default();
            long_deck |= name == "KEYWORD" && words.clone().any(|word| word == "LONG=Y");
            let (name, own) = match name.strip_suffix('+') {
                Some(name) => (name, Some(1)),
                None => (name, None),
            };
            let is_wide = words.any(|word| word == "%") || name.ends_with('%');
            let name = name.trim_end_matches('%');
            format = own.unwrap_or(if is_wide { 2 } else { usize::from(long_deck) });
            if name == "END" {
                break;
            }
            below = match name {
                "NODE" => Below::Node,
                "ELEMENT_SHELL" => Below::Shell(0),
                "ELEMENT_SHELL_THICKNESS" | "ELEMENT_SHELL_BETA" => Below::Shell(1),
                "INCLUDE" => Below::Include,
                "PART" | "PART_TITLE" => Below::PartHeading,
                _ if name.starts_with("INCLUDE") => {
                    return Err(Mistake { place: place(1), fault: Fault::Include(format!("*{name}")) });
                }
                _ if name.starts_with("ELEMENT") => Below::Others,
                "NODE_TRANSFORM" | "DEFINE_TRANSFORMATION" | "NODE_SCALAR" | "PARAMETER" => {
                    let fault = Fault::Unknown(format!("*{name} changes the mesh and is not read"));
                    return Err(Mistake { place: place(1), fault });
                }
                _ => Below::Nothing,
            };
            (keyword, skip) = (format!("*{name}"), 0);
            continue;
        }
        match below {
            Below::Nothing => {}
            Below::Node => reader.add_node(0, &Fields::in_columns(line, number, &NODE[format])?)?,
            Below::Shell(_) if skip > 0 => skip -= 1,
            Below::Shell(more) => {
                let fields = Fields::in_columns(line, number, &[SHELL[format]; FIELDS])?;
                let part = fields.whole(1, "the part")?;
                let part = reader.part(part);
                reader.add_element([part, 0], &fields, 2, file)?;
                skip = more;
            }
            Below::Others => reader.not_read(keyword.clone(), number),
            Below::PartHeading => (heading, below) = (line.trim(), Below::Part),
            Below::Part => {
                let width = if format == 1 { 20 } else { 10 };
                let part = Fields::in_columns(line, number, &[width])?.whole(0, "the part")?;
                let part = reader.part(part) as usize;
                heading.clone_into(&mut reader.parts[part].name);
                below = Below::PartHeading;
            }
            Below::Include => {
                if line.ends_with('+') {
                    let fault = Fault::Unknown("a name of a file over several lines is not read".into());
                    return Err(Mistake { place: place(1), fault });
                }
                includes.push(Include { place: place(1), name: line.trim().to_owned() });
            }
        }
    }
    Ok(includes)
}
