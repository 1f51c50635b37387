//! One file of a field: which of its columns hold places, displacements and the quality of the correlation, and its points.

use std::path::Path;

use crate::error::{Error, refusal};
use crate::signal::column_name::ColumnName;
use crate::signal::csv::{Column, Table};
use crate::signal::{Annotations, ReadOptions, file};
use base::diagnostic::listed;
use base::units::Length;

/// Words in the place of a number where nothing was matched.
const GAPS: &[&str] = &["nan", "-nan", "nan(ind)", "-nan(ind)", "n/a", "non numérique", "n. def.", "?"];

/// What the caller states about the files of a field.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FieldOptions {
    /// Length of one unit of places and displacements where a file states none, m.
    pub unit: Option<f64>,
}

/// The points of one file that were matched.
#[derive(Clone, Debug, PartialEq)]
pub struct FieldFile {
    /// The program whose names its columns have.
    pub program: &'static str,
    /// Labels of the columns of places and displacements.
    pub columns: [String; 6],
    /// Undeformed places, m.
    pub places: Vec<[f64; 3]>,
    /// Their displacements, m.
    pub displacements: Vec<[f64; 3]>,
    /// Points that were not matched.
    pub missing: usize,
    /// Comments of the file, and what its reading reports.
    pub annotations: Annotations,
}

/// Reads the field in the file at `path`: a table in text or a workbook, with the columns of one of the known programs. A point
/// counts as not matched where a cell is empty or no number, and where `sigma` is negative.
///
/// # Errors
/// The file is no such table, or a unit is missing.
pub fn read(path: &Path, options: &FieldOptions) -> Result<FieldFile, Error> {
    let table = file::columns(path, &ReadOptions { gaps: GAPS, ..ReadOptions::default() })?;
    let Table { columns, annotations } = with_names_of_comment(table);
    from_columns(columns, annotations, options).map_err(|error| error.in_file(path))
}

fn from_columns(
    mut columns: Vec<Column>,
    annotations: Annotations,
    options: &FieldOptions,
) -> Result<FieldFile, Error> {
    let Found { naming, places, displacements, sigma } = find(&columns)?;
    let all = [places, displacements].concat();
    for place in &all {
        in_metres(&mut columns[*place], options)?;
    }
    let of_row = |row: usize, three: [usize; 3]| three.map(|place| columns[place].values[row]);
    let is_matched = |row: usize| sigma.is_none_or(|sigma| columns[sigma].values[row] >= 0.0);
    let rows = columns[places[0]].values.len();
    let mut points = (Vec::new(), Vec::new());
    for row in 0..rows {
        let (place, mut displacement) = (of_row(row, places), of_row(row, displacements));
        if naming.deformed {
            displacement = [0, 1, 2].map(|axis| displacement[axis] - place[axis]);
        }
        if is_matched(row) && place.iter().chain(&displacement).all(|value| value.is_finite()) {
            points.0.push(place);
            points.1.push(displacement);
        }
    }
    let (places, displacements) = points;
    if places.is_empty() {
        return Err(refusal!("no point has a displacement"));
    }
    let label = |order: usize| columns[all[order]].label.clone();
    Ok(FieldFile {
        program: naming.program,
        columns: [0, 1, 2, 3, 4, 5].map(label),
        missing: rows - places.len(),
        places,
        displacements,
        annotations,
    })
}

/// Brings a column without a unit to that of the caller; any other must be a length.
fn in_metres(column: &mut Column, options: &FieldOptions) -> Result<(), Error> {
    let label = &column.label;
    let not_a_length = |unit: &str| {
        refusal!("`{label}` is in `{unit}`, not in a unit of length")
            .with_hint("export metric coordinates, not those of the image")
    };
    if let Some(unit) = &column.unit {
        return if unit.measures(Length::DIMENSION) { Ok(()) } else { Err(not_a_length(unit.symbol())) };
    }
    if let Some(unit) = ColumnName::read(label).unknown_unit {
        return Err(not_a_length(&unit));
    }
    let no_unit = || refusal!("`{label}` states no unit of length").with_hint("give it: `unit = \"mm\"`");
    let unit = options.unit.ok_or_else(no_unit)?;
    column.values.iter_mut().for_each(|value| *value *= unit);
    Ok(())
}

/// The table with the names of the last comment that has one for each column, where the file has no other header.
fn with_names_of_comment(mut table: Table) -> Table {
    let is_numbered = |(place, column): (usize, &Column)| column.label == format!("column {}", place + 1);
    if !table.columns.iter().enumerate().all(is_numbered) {
        return table;
    }
    let count = table.columns.len();
    let split = |comment: &String, separator: char| -> Option<Vec<ColumnName>> {
        let names: Vec<&str> = match separator {
            ' ' => comment.split_whitespace().collect(),
            other => comment.trim_end_matches(other).split(other).collect(),
        };
        (names.len() == count).then(|| names.into_iter().map(ColumnName::read).collect())
    };
    let names = |comment: &String| [';', '\t', ',', ' '].into_iter().find_map(|separator| split(comment, separator));
    if let Some(names) = table.annotations.comments().iter().rev().find_map(names) {
        for (column, ColumnName { name, label, unit, .. }) in table.columns.iter_mut().zip(names) {
            if let Some(unit) = &unit {
                column.values.iter_mut().for_each(|value| *value = unit.to_si(*value));
            }
            *column = Column { name, label, unit, values: std::mem::take(&mut column.values) };
        }
    }
    table
}

/// How a program names its columns.
struct Naming {
    /// The program.
    program: &'static str,
    /// Columns of the undeformed places.
    places: [&'static str; 3],
    /// Columns of the displacements.
    displacements: [&'static str; 3],
    /// Whether the second three are deformed places instead.
    deformed: bool,
}

const fn naming(program: &'static str, places: [&'static str; 3], displacements: [&'static str; 3]) -> Naming {
    Naming { program, places, displacements, deformed: false }
}

/// The namings, those of the most particular names first.
const NAMINGS: [Naming; 8] = [
    naming(
        "DICe",
        ["MODEL_COORDINATES_X", "MODEL_COORDINATES_Y", "MODEL_COORDINATES_Z"],
        ["MODEL_DISPLACEMENT_X", "MODEL_DISPLACEMENT_Y", "MODEL_DISPLACEMENT_Z"],
    ),
    naming("MatchID", ["X", "Y", "Z"], ["Horizontal Displacement U", "Vertical Displacement V", "Out-Of-Plane: W"]),
    naming(
        "MatchID",
        ["X", "Y", "Z"],
        ["Horizontal Displacement U", "Vertical Displacement V", "Out-Of-Plane Displacement W"],
    ),
    naming("ARAMIS", ["x_undef", "y_undef", "z_undef"], ["ux", "uy", "uz"]),
    naming("ARAMIS", ["x", "y", "z"], ["dx", "dy", "dz"]),
    Naming { deformed: true, ..naming("ARAMIS", ["x", "y", "z"], ["x+dx", "y+dy", "z+dz"]) },
    Naming { deformed: true, ..naming("ARAMIS", ["x_undef", "y_undef", "z_undef"], ["x_def", "y_def", "z_def"]) },
    naming("VIC-3D", ["X", "Y", "Z"], ["U", "V", "W"]),
];

/// Name of the standard deviation of the match, negative where there was none: of VIC-3D, and of DICe in capitals.
const SIGMA: &str = "sigma";

/// Columns of a file, by their places in it.
struct Found {
    naming: &'static Naming,
    places: [usize; 3],
    displacements: [usize; 3],
    sigma: Option<usize>,
}

/// The columns of a field among those of a file.
fn find(columns: &[Column]) -> Result<Found, Error> {
    let three = |names: [&str; 3]| names.map(|name| place(columns, name));
    let mut planar = None;
    for naming in &NAMINGS {
        match (three(naming.places), three(naming.displacements)) {
            ([Some(x), Some(y), Some(z)], [Some(u), Some(v), Some(w)]) => {
                let sigma = place(columns, SIGMA);
                return Ok(Found { naming, places: [x, y, z], displacements: [u, v, w], sigma });
            }
            ([Some(_), Some(_), _], [Some(u), Some(v), None]) => {
                planar.get_or_insert([u, v].map(|place| &columns[place].label));
            }
            _ => {}
        }
    }
    if let Some([u, v]) = planar {
        return Err(refusal!(
            "displacements in the plane alone (`{u}`, `{v}`): fields of two-dimensional correlation are not supported"
        ));
    }
    let found: Vec<String> = columns.iter().map(|column| column.label.clone()).collect();
    Err(refusal!("no columns of places and displacements that are known among {}", listed(&found)).with_hint(
        "export X, Y, Z and U, V, W of the undeformed places (VIC-3D, MatchID), x, y, z and dx, dy, dz (ARAMIS), or \
         MODEL_COORDINATES_* and MODEL_DISPLACEMENT_* (DICe)",
    ))
}

/// The place of a column of this name, in these letters or else in any case: VIC-3D has `X` in space and `x` in the image.
fn place(columns: &[Column], name: &str) -> Option<usize> {
    let wanted = plain(name);
    let exact = columns.iter().position(|column| plain(&column.name) == wanted);
    let wanted = wanted.to_lowercase();
    exact.or_else(|| columns.iter().position(|column| plain(&column.name).to_lowercase() == wanted))
}

/// A name without its group (`coor.X`), blanks and signs but for a plus.
fn plain(name: &str) -> String {
    let own = name.rsplit('.').next().unwrap_or(name);
    own.chars().filter(|letter| letter.is_alphanumeric() || *letter == '+').collect()
}
