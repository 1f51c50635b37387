//! Decks of CalculiX: a cube of one solid element with a side of one, which a static step stretches.

use super::{Input, Mode, Pull};
use crate::number::in_twenty;

/// The card, which the decks include.
const CARD: &str = "film.inp";

/// What comes before the step: a cube of side 1, held at x = 0, y = 0 and z = 0.
const CUBE: &str = "\
*NODE, NSET=ALL
1, 0, 0, 0
2, 1, 0, 0
3, 1, 1, 0
4, 0, 1, 0
5, 0, 0, 1
6, 1, 0, 1
7, 1, 1, 1
8, 0, 1, 1
*ELEMENT, TYPE=C3D8, ELSET=CUBE
1, 1, 2, 3, 4, 5, 6, 7, 8
*NSET, NSET=X0
1, 4, 5, 8
*NSET, NSET=Y0
1, 2, 5, 6
*NSET, NSET=Z0
1, 2, 3, 4
*NSET, NSET=ALONG
2, 3, 6, 7
*NSET, NSET=ACROSS
3, 4, 7, 8
*BOUNDARY
X0, 1
Y0, 2
Z0, 3
";

/// A deck a test.
pub(super) fn input(card: &str, pulls: &[Pull]) -> Input {
    let name = card.lines().find_map(|line| line.strip_prefix("*MATERIAL, NAME=")).unwrap_or_default();
    let decks = pulls.iter().map(|pull| (format!("{}.inp", pull.mode.key()), deck(name, pull)));
    let files = std::iter::once((CARD.to_owned(), card.to_owned())).chain(decks).collect();
    let calls = pulls.iter().map(|pull| (pull.mode.key(), vec!["-i".to_owned(), pull.mode.key().to_owned()]));
    Input { files, calls: calls.collect() }
}

fn deck(material: &str, pull: &Pull) -> String {
    let steps = pull.stretches.len();
    let along = pull.stretches.last().copied().unwrap_or(1.0);
    let held = |nodes: &str, axis: u8, stretch: f64| format!("{nodes}, {axis}, {axis}, {}\n", in_twenty(stretch - 1.0));
    let across = pull.mode.across(along).map_or_else(String::new, |across| held("ACROSS", 2, across));
    // Loads of a step grow in proportion to its time, so that increments of one size give stretches of one distance.
    format!(
        "** One element of film, {} tension: written by droptower\n*INCLUDE, INPUT={CARD}\n{CUBE}*SOLID SECTION, ELSET=CUBE, \
         MATERIAL={material}\n*STEP, NLGEOM, INC={}\n*STATIC, DIRECT\n{}, 1.\n*BOUNDARY\n{}{across}*NODE PRINT, \
         NSET=ALONG, TOTALS=ONLY\nRF\n*NODE PRINT, NSET=ACROSS, TOTALS=ONLY\nRF\n*END STEP\n",
        pull.mode.key(),
        10 * steps,
        in_twenty(1.0 / steps as f64),
        held("ALONG", 1, along),
    )
}

/// The file with the forces.
pub(super) fn result(mode: Mode) -> String {
    format!("{}.dat", mode.key())
}

/// Nominal stresses along and across, a row an increment: the forces on faces of area one.
pub(super) fn read(text: &str) -> Result<Vec<[f64; 2]>, String> {
    let mut lines = text.lines();
    let mut rows: Vec<[f64; 2]> = Vec::new();
    while let Some(line) = lines.next() {
        let axis = match line.split_once("for set ") {
            Some((_, rest)) if rest.starts_with("ALONG ") => 0,
            Some((_, rest)) if rest.starts_with("ACROSS ") => 1,
            _ => continue,
        };
        let values = lines.by_ref().find(|line| !line.trim().is_empty()).unwrap_or_default();
        let value = values.split_whitespace().nth(axis).and_then(|value| value.parse().ok());
        let force: f64 = value.ok_or_else(|| format!("no force follows `{}`", line.trim()))?;
        match (axis, rows.last_mut()) {
            (0, _) => rows.push([force, 0.0]),
            (_, Some(row)) => row[1] = force,
            (_, None) => return Err("the force across comes before the one along".to_owned()),
        }
    }
    Ok(rows)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn forces_are_read_by_increment() {
        let text = "\n total force (fx,fy,fz) for set ALONG and time  0.5000000E+00\n\n        9.425094E-01 -2.8E-17  0.0\n\n \
                    total force (fx,fy,fz) for set ACROSS and time  0.5000000E+00\n\n  0.000000E+00  3.773470E-01 -3.8E-17\n";
        assert_eq!(read(text), Ok(vec![[0.9425094, 0.377347]]));
        assert_eq!(read(""), Ok(vec![]));
        for bad in ["for set ALONG and time 1\n", "for set ALONG and\n\nx\n", "for set ACROSS and\n\n1 2 3\n"] {
            assert!(read(bad).is_err(), "{bad}");
        }
    }
}
