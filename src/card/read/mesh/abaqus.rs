//! Meshes of Abaqus and CalculiX: `*NODE` and `*ELEMENT` by element set, in parts of an assembly or without.

use super::line::Fields;
use super::{Include, Reader};
use crate::read::{Fault, Mistake, Place};

/// Types of elements of three and four nodes of which a film can be.
const TYPES: [&str; 22] = [
    "M3D3", "M3D4", "M3D4R", "S3", "S3R", "S3RS", "S3S", "STRI3", "S4", "S4R", "S4RS", "S4RSW", "S4R5", "S4S", "CPS3",
    "CPS4", "CPS4R", "R3D3", "R3D4", "SFM3D3", "SFM3D4", "SFM3D4R",
];

/// Keywords that make nodes or elements, or move them.
const MAKERS: [&str; 8] = ["NGEN", "NFILL", "NCOPY", "NMAP", "ELGEN", "ELCOPY", "SYSTEM", "PARAMETER"];

/// What the lines below a keyword are.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Below {
    Nothing,
    Node,
    /// Elements of a part.
    Elements(u32),
    Instance,
}

/// One pass over the lines, since a keyword says what those below it are, and the part around them which nodes their numbers mean;
/// it gives the files that the text includes, for the caller to read.
pub(super) fn read(reader: &mut Reader, text: &str, file: usize) -> Result<Vec<Include>, Mistake> {
    let (mut includes, mut below) = (vec![], Below::Nothing);
    // Numbers of nodes are those of a part: its name, and the scope that it is.
    let (mut within, mut scope) = (String::new(), 0);
    for (index, line) in text.lines().enumerate() {
        let (number, line) = (index + 1, line.trim_end());
        let mistake = |fault: Fault| Err(Mistake { place: Place { line: number, column: 1 }, fault });
        if line.starts_with("**") || line.trim().is_empty() {
            continue;
        }
        let Some(written) = line.strip_prefix('*') else {
            match below {
                Below::Nothing => {}
                Below::Node => reader.add_node(scope, &Fields::separated(line, number))?,
                Below::Elements(part) => {
                    let fields = Fields::separated(line, number);
                    reader.add_element([part, scope], &fields, 1, file)?;
                }
                Below::Instance => return mistake(Fault::Unknown("an instance that is moved is not read".into())),
            }
            continue;
        };
        let mut words = written.split(',');
        let name =
            words.next().unwrap_or_default().split_whitespace().collect::<Vec<_>>().join(" ").to_ascii_uppercase();
        let parameters: Vec<(String, &str)> = words
            .filter_map(|word| word.split_once('='))
            .map(|(key, value)| (key.trim().to_ascii_uppercase(), value.trim().trim_matches('"')))
            .collect();
        let parameter = |key: &str| parameters.iter().find(|(name, _)| name == key).map(|(_, value)| *value);
        below = match name.as_str() {
            "NODE" => match parameter("SYSTEM").filter(|system| !system.eq_ignore_ascii_case("R")) {
                Some(system) => {
                    return mistake(Fault::Unknown(format!("coordinates of the system {system} are not read")));
                }
                None => Below::Node,
            },
            "ELEMENT" => {
                let kind = parameter("TYPE").unwrap_or_default().to_ascii_uppercase();
                if TYPES.contains(&kind.as_str()) {
                    let set = parameter("ELSET").map_or(within.as_str(), |set| set);
                    let set = if set.is_empty() { "film" } else { set };
                    let set = if within.is_empty() || parameter("ELSET").is_none() {
                        set.to_owned()
                    } else {
                        format!("{within}.{set}")
                    };
                    Below::Elements(reader.part_named(&set))
                } else {
                    reader.not_read(kind, number);
                    Below::Nothing
                }
            }
            "INCLUDE" => {
                let Some(name) = parameter("INPUT") else { return mistake(Fault::Missing { name: "INPUT" }) };
                includes.push(Include { place: Place { line: number, column: 1 }, name: name.to_owned() });
                Below::Nothing
            }
            "PART" => {
                parameter("NAME").unwrap_or_default().clone_into(&mut within);
                scope += 1;
                Below::Nothing
            }
            "END PART" => {
                within.clear();
                Below::Nothing
            }
            "INSTANCE" => Below::Instance,
            other if MAKERS.contains(&other) => {
                return mistake(Fault::Unknown(format!("*{other} changes the mesh and is not read")));
            }
            _ => Below::Nothing,
        };
    }
    Ok(includes)
}
