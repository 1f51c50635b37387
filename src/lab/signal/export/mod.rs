//! Exports of tensile machines: several specimens in one table, side by side or below each other, with what was entered
//! about each in a head.
//!
//! Written after descriptions and printed examples of the exports of Zwick (testXpert), Instron (Bluehill), MTS
//! (TestSuite) and Shimadzu (Trapezium); their makers publish no format.

mod blocks;
mod head;
mod words;

use std::collections::BTreeMap;
use std::io::BufRead;
use std::path::Path;

use super::column_name::ColumnName;
use super::csv::{Mark, Separator};
use super::text::{self, Lines};
use crate::error::Error;
use blocks::Reader;

pub use words::{Key, is_displacement, is_force};

/// A quantity that a head states.
#[derive(Clone, Debug, PartialEq)]
pub struct Statement {
    /// SI.
    pub value: f64,
    /// As the head writes it: `Breite b0: 10,05 mm`.
    pub written: String,
}

/// What a head states of one specimen.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Stated {
    /// Its dimensions, and the speed of the jaws apart.
    pub quantities: BTreeMap<Key, Statement>,
    /// A word for the direction of the film.
    pub direction: Option<String>,
    /// Statements without a unit or with one of another quantity, which are not used.
    pub unused: Vec<String>,
}

impl Stated {
    /// Whether nothing is stated that is used.
    pub fn is_empty(&self) -> bool {
        self.quantities.is_empty() && self.direction.is_none()
    }

    /// All of it, as the head writes it.
    pub fn written(&self) -> Vec<String> {
        let quantities = self.quantities.values().map(|statement| statement.written.clone());
        let direction = self.direction.iter().map(|word| format!("direction: {word}"));
        quantities.chain(direction).chain(self.unused.iter().cloned()).collect()
    }
}

/// The specimens of a file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Export {
    /// In the order of the file.
    pub specimens: Vec<Specimen>,
}

/// One specimen.
#[derive(Clone, Debug, PartialEq)]
pub struct Specimen {
    /// As the file names it, or else its sheet or its number.
    pub name: String,
    /// Names and units of its columns.
    pub columns: Vec<ColumnName>,
    /// As many as columns, each as long as the others; as the file writes them, `NaN` for an empty cell.
    pub values: Vec<Vec<f64>>,
    /// What the head states of it.
    pub stated: Stated,
    /// Comments of its file or sheet: lines that start with `#`.
    pub comments: Vec<String>,
}

impl Export {
    /// Whether the file is more than one table without a head, which any reader of tables reads.
    pub fn is_of_machine(&self) -> bool {
        self.specimens.len() > 1 || self.specimens.iter().any(|specimen| !specimen.stated.is_empty())
    }
}

impl Specimen {
    /// Leaves out rows behind the last that has a value: those of longer specimens beside it.
    pub fn trim(&mut self) {
        let filled = |values: &Vec<f64>| values.iter().rposition(|value| !value.is_nan()).map_or(0, |last| last + 1);
        let rows = self.values.iter().map(filled).max().unwrap_or(0);
        self.values.iter_mut().for_each(|values| values.truncate(rows));
    }
}

/// The specimens of the text at `path`; none where it holds no force over displacement.
pub fn read_text(path: &Path) -> Result<Option<Export>, Error> {
    text::open(path).and_then(|mut lines| read(&mut lines, None)).map_err(|error| error.in_file(path))
}

/// The specimens in the lines of a text, or in those of a `sheet` between tabs; one that is not named in them is called after the
/// sheet, or numbered. None where they hold no force over displacement.
pub fn read(lines: &mut Lines<impl BufRead>, sheet: Option<&str>) -> Result<Option<Export>, Error> {
    let mut reader = Reader::default();
    if sheet.is_some() {
        // Cells of a workbook are whole: a quote in them is text, and so is `#` beside other cells.
        while let Some(line) = lines.line()? {
            let is_comment = !line.text.trim().contains('\t') && reader.push_comment(&line.text);
            if !is_comment {
                reader.push_cells(line.number, line.text.split('\t').map(|cell| cell.trim().to_owned()).collect())?;
            }
        }
    } else {
        let (first, Some(separator)) = separated(lines)? else { return Ok(None) };
        for (number, text) in first {
            reader.push(number, &text, separator)?;
        }
        while let Some(line) = lines.line()? {
            reader.push(line.number, &line.text, separator)?;
        }
    }
    let export = reader.finish(sheet)?;
    Ok((!export.specimens.is_empty()).then_some(export))
}

/// A row of texts in a head, with its number.
pub type TextRow = (usize, Vec<String>);

/// Most rows of anything but numbers, and most bytes of them.
const MOST_TEXTS: usize = 10_000;
const MOST_BYTES: usize = 1 << 26;
/// Lines in which the separator is looked for.
const SEPARATOR_WITHIN: usize = 1000;

/// Lines with their numbers.
type Numbered = Vec<(usize, String)>;

/// The lines up to the first row of numbers, and what separates these; none where no line is one of numbers.
fn separated(lines: &mut Lines<impl BufRead>) -> Result<(Numbered, Option<Separator>), Error> {
    let (mut first, mut held) = (Vec::new(), 0);
    while let Some(line) = lines.line()? {
        let is_comment = line.text.trim_start().starts_with('#');
        // A quoted cell may have a decimal comma between commas.
        let is_row = |separator: &Separator| !is_comment && is_numbers(&cells(*separator, &line.text));
        let separator = Separator::ALL.into_iter().find(is_row);
        held += line.text.len();
        first.push((line.number, line.text.into_owned()));
        if separator.is_some() {
            return Ok((first, separator));
        }
        if held > MOST_BYTES || (!is_comment && first.len() > SEPARATOR_WITHIN) {
            break;
        }
    }
    Ok((first, None))
}

fn cells(separator: Separator, line: &str) -> Vec<String> {
    separator.cells(line).map(|cell| cell.text.into_owned()).collect()
}

fn is_numbers(cells: &[String]) -> bool {
    numbers(cells, &mut Mark::Unknown).is_some_and(|found| found.iter().filter(|value| !value.is_nan()).count() > 1)
}

/// The cells as numbers, `NaN` for an empty one; none where some cell is anything else.
fn numbers(cells: &[String], mark: &mut Mark) -> Option<Vec<f64>> {
    let number = |cell: &String| if cell.is_empty() { Some(f64::NAN) } else { mark.number(cell, "").ok() };
    cells.iter().map(number).collect()
}

#[cfg(test)]
mod tests {
    //! Exports that were made after descriptions of those of machines (`tests/formats/make_machines.py`), and their mistakes.

    use std::collections::BTreeMap;
    use std::fs;
    use std::path::{Path, PathBuf};

    use serde::Deserialize;

    use crate::Error;
    use crate::experiment::coupon::{CouponReader, CouponTest, Dimensions, Rules};
    use crate::signal::file;

    /// A specimen as it was made; mm, N, mm/min.
    #[derive(Deserialize)]
    struct Expected {
        name: String,
        width: f64,
        thickness: f64,
        gauge: f64,
        speed: f64,
        rows: usize,
        strength: f64,
    }

    fn folder() -> PathBuf {
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/it/formats/machines")
    }

    fn reduce(path: &Path) -> Result<Vec<CouponTest>, Error> {
        CouponReader::new(Dimensions::default(), Rules::default()).read_all(path)
    }

    fn close(found: f64, expected: f64) -> bool {
        (found - expected).abs() <= 1e-6 * expected.abs()
    }

    /// In a text the row of names would be a comment, and the quotes would take its columns together. A cell alone is one.
    #[test]
    fn cells_of_a_workbook_are_whole() {
        let of = |first: &str, second: &str| {
            let head = format!("{first}\t\t{second}\t\nExtension\tLoad\tExtension\tLoad\n(mm)\t(N)\t(mm)\t(N)\n");
            let rows: String = (0..9).map(|row| format!("{row}\t{}\t{row}\t{}\n", 2 * row, 3 * row)).collect();
            let text = "\t# direction: MD\t\n".to_owned() + &head + &rows;
            let export = super::read(&mut super::Lines::new(text.as_bytes()), Some("Sheet")).unwrap().unwrap();
            assert!(export.specimens.iter().all(|own| own.comments == ["direction: MD"] && own.stated.is_empty()));
            export.specimens.into_iter().map(|own| (own.name, own.values)).unzip::<_, _, Vec<_>, Vec<_>>()
        };
        let (names, values) = of("A", "B");
        assert_eq!(names, ["A", "B"]);
        for [first, second] in [["#1", "#2"], ["\"A", "B\""]] {
            assert_eq!(of(first, second), (vec![first.to_owned(), second.to_owned()], values.clone()));
        }
    }

    #[test]
    fn every_specimen_is_reduced_with_what_the_head_states() {
        let text = fs::read_to_string(folder().join("expected.json")).unwrap();
        let expected: BTreeMap<String, Vec<Expected>> = serde_json::from_str(&text).unwrap();
        for (name, specimens) in &expected {
            let path = folder().join(name);
            let export =
                file::specimens(&path).unwrap_or_else(|error| panic!("{error}")).unwrap_or_else(|| panic!("{name}"));
            assert_eq!(export.specimens.len(), specimens.len(), "{name}");
            let tests = reduce(&path).unwrap_or_else(|error| panic!("{error}"));
            for ((expected, specimen), test) in specimens.iter().zip(&export.specimens).zip(&tests) {
                let what = format!("{name}, {}: {:?}", expected.name, specimen.stated);
                assert_eq!(specimen.name, expected.name, "{what}");
                assert!(specimen.values.iter().all(|values| values.len() == expected.rows), "{what}");
                assert!(close(test.coupon.width(), 1e-3 * expected.width), "{what}");
                assert!(close(test.coupon.thickness(), 1e-3 * expected.thickness), "{what}");
                assert!(close(test.coupon.gauge(), 1e-3 * expected.gauge), "{what}");
                assert!(close(test.sample.velocity, 1e-3 / 60.0 * expected.speed), "{what}");
                assert!(close(test.sample.rupture.strength, 1e6 * expected.strength), "{what}");
                let place = format!("{name}, {}", expected.name);
                assert!(test.specimen.is_some() && test.place().ends_with(place), "{what}");
            }
        }
    }

    /// Files that are cut at every byte, or of which some byte is another, are read or refused.
    #[test]
    fn damaged_exports_are_read_or_refused() {
        let scratch = tempfile::tempdir().unwrap();
        for entry in fs::read_dir(folder()).unwrap().flatten() {
            let bytes = fs::read(entry.path()).unwrap();
            let path = scratch.path().join(entry.file_name());
            for place in (0..bytes.len()).step_by(1 + bytes.len() / 60) {
                let mut other = bytes.clone();
                other[place] ^= 0x15;
                for damaged in [&bytes[..place], &other] {
                    fs::write(&path, damaged).unwrap();
                    if let Err(error) = reduce(&path) {
                        assert!(!error.to_string().is_empty());
                    }
                }
            }
        }
    }

    const ROWS: &str = "0;0\n1;4\n2;7\n3;9\n4;11\n5;12\n6;12,5\n7;0\n";

    fn twice(head: &str) -> String {
        let row = |row: &str| format!("{row};{row}\n");
        let rows: String = ROWS.lines().map(row).collect();
        format!("{head}\nA;;B\nWeg;Kraft;Weg;Kraft\nmm;N;mm;N\n{rows}")
    }

    #[test]
    fn mistakes_name_file_and_line() {
        let head = "Breite;10;mm\nDicke;50;µm\nEinspannlänge;50;mm\nGeschwindigkeit;100;mm/min\nRichtung;MD";
        let scratch = tempfile::tempdir().unwrap();
        let path = scratch.path().join("z.csv");
        let read = |text: &str| {
            fs::write(&path, text).unwrap();
            reduce(&path)
        };
        let tests = read(&twice(head).replace("A;;B", "Probe 1;;Probe 2")).unwrap();
        assert_eq!(tests.len(), 2);
        for (text, expected) in [
            (twice(&head.replace("Breite;10;mm", "")), "z.csv, A: the dimensions of the coupon are not known: width"),
            (
                twice(&head.replace("Breite;10;mm", "Breite;10;N")),
                "not known: width; the head states `Breite: 10 N (not a length)`",
            ),
            (twice(&head.replace("10;mm", "10;11;12;mm")), "states 3 values of `Breite` for 2 specimens: `A`, `B`"),
            (twice(&format!("{head}\nBreite;11;mm")), "twice: Breite: 10 mm and Breite: 11 mm"),
            (twice(&head.replace("MD", "")), "the direction of the coupon is not known"),
            (twice(&head.replace("100;mm/min", "100")), "the speed of the jaws is not known"),
            (twice(head).replace("3;9;3;9", "3;x;3;9"), "expected a number, found `x`"),
            (twice(head).replace("3;9;3;9", "3;9;3;9;9"), "expected at most 4 cells, found 5"),
        ] {
            let error = match read(&text) {
                Ok(tests) => panic!("{text}\n{tests:?}"),
                Err(error) => error.to_string(),
            };
            assert!(error.contains(expected), "{text}\ngave: {error}");
        }
    }
}
