//! Full-field measurements: displacement fields of stereo digital image correlation, a file an image, over time.
//!
//! Written after descriptions and printed examples of the exports of VIC-3D, MatchID, ARAMIS (GOM) and DICe.

mod file;
mod motion;
#[cfg(test)]
mod tests;

use std::cmp::Ordering;
use std::collections::HashMap;
use std::path::{Path, PathBuf};

use crate::error::{Error, refusal};
use crate::signal::column_name::ColumnName;
use crate::signal::csv::Column;
use crate::signal::{Annotations, ReadOptions, file as signal_file};
use base::diagnostic::listed;
use base::units::Time;

pub use file::{FieldFile, FieldOptions, read};
pub use motion::RigidMotion;

/// Most points of all files together: the measured and the simulated displacement of each are held.
const MOST_POINTS: usize = 20_000_000;

/// A displacement field over time.
#[derive(Clone, Debug, PartialEq)]
pub struct Field {
    /// The program whose names the columns of the first file have.
    pub program: &'static str,
    /// Labels of the columns of places and displacements of the first file.
    pub columns: [String; 6],
    /// Undeformed places of all states, each once, m.
    pub places: Vec<[f64; 3]>,
    /// One entry a file.
    pub states: Vec<FieldState>,
    /// Comments of the first file, and what its reading reports.
    pub annotations: Annotations,
}

/// The displacements at one time.
#[derive(Clone, Debug, PartialEq)]
pub struct FieldState {
    /// Its file.
    pub path: PathBuf,
    /// On the time axis of the run, s.
    pub time: f64,
    /// Index of the place and displacement (m), of every point that was matched.
    pub points: Vec<(u32, [f64; 3])>,
    /// Points of the file that were not matched.
    pub missing: usize,
}

impl Field {
    /// Reads files, each with its time (s).
    ///
    /// # Errors
    /// A file is no field, or all of them have too many points.
    pub fn read(files: &[(PathBuf, f64)], options: &FieldOptions) -> Result<Option<Field>, Error> {
        let mut field: Option<Field> = None;
        let mut known: HashMap<[u64; 3], u32> = HashMap::new();
        let mut count = 0;
        for (path, time) in files {
            let FieldFile { program, columns, places, displacements, missing, annotations } = read(path, options)?;
            count += places.len();
            if count > MOST_POINTS {
                return Err(refusal!("the files of the field have more than {MOST_POINTS} points"));
            }
            let field =
                field.get_or_insert_with(|| Field { program, columns, places: vec![], states: vec![], annotations });
            let mut index = |place: [f64; 3]| {
                *known.entry(place.map(f64::to_bits)).or_insert_with(|| {
                    field.places.push(place);
                    // At most MOST_POINTS.
                    (field.places.len() - 1) as u32
                })
            };
            let points = places.into_iter().map(&mut index).zip(displacements).collect();
            field.states.push(FieldState { path: path.clone(), time: *time, points, missing });
        }
        Ok(field)
    }

    /// Points that were matched, of all states.
    pub fn points(&self) -> usize {
        self.states.iter().map(|state| state.points.len()).sum()
    }
}

/// The files in the order of the numbers in their names, those of equal numbers in the order of their names.
pub fn in_order(mut files: Vec<PathBuf>) -> Vec<PathBuf> {
    files.sort_by(|a, b| by_number(a, b));
    files
}

/// Compares names piece by piece, digits as the number that they are: `f_9` comes before `f_10`.
fn by_number(a: &Path, b: &Path) -> Ordering {
    let name = |path: &Path| path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    let (first, second) = (name(a), name(b));
    let mut pieces = pieces(&first).into_iter().zip(pieces(&second));
    let of_pieces = pieces.find_map(|(a, b)| {
        let digits = |piece: &str| piece.starts_with(|letter: char| letter.is_ascii_digit());
        let order = match (digits(a), digits(b)) {
            (true, true) => {
                let [a, b] = [a, b].map(|piece| piece.trim_start_matches('0'));
                a.len().cmp(&b.len()).then_with(|| a.cmp(b))
            }
            _ => a.cmp(b),
        };
        Some(order).filter(|order| order.is_ne())
    });
    of_pieces.unwrap_or_else(|| first.len().cmp(&second.len())).then_with(|| a.cmp(b))
}

/// The name in runs of digits and runs of anything else.
fn pieces(name: &str) -> Vec<&str> {
    let is_digit = |letter: char| letter.is_ascii_digit();
    let mut pieces = Vec::new();
    let mut rest = name;
    while let Some(first) = rest.chars().next() {
        let end = rest.find(|letter| is_digit(letter) != is_digit(first)).unwrap_or(rest.len());
        let (piece, behind) = rest.split_at(end);
        pieces.push(piece);
        rest = behind;
    }
    pieces
}

/// The times (s) in the table at `path`: its column of time, or its only column; in seconds where it states no unit.
///
/// # Errors
/// It is no table, has no column of time, or times do not increase.
pub fn read_times(path: &Path) -> Result<Vec<f64>, Error> {
    let columns = signal_file::columns(path, &ReadOptions::default())?.columns;
    let is_time = |column: &&Column| {
        column.unit.as_ref().is_none_or(|unit| unit.measures(Time::DIMENSION))
            && ColumnName::read(&column.label).is_time()
    };
    let found = columns.iter().find(is_time).or(match &columns[..] {
        [only] if only.unit.as_ref().is_none_or(|unit| unit.measures(Time::DIMENSION)) => Some(only),
        _ => None,
    });
    let times = found.map(|column| column.values.clone()).ok_or_else(|| {
        let labels: Vec<String> = columns.iter().map(|column| column.label.clone()).collect();
        refusal!("no column of time among {}", listed(&labels)).in_file(path)
    })?;
    let mut latest = f64::NEG_INFINITY;
    for (place, time) in times.iter().enumerate() {
        if time.is_nan() || *time <= latest {
            let error = refusal!("time {} does not come after the one before it", place + 1);
            return Err(error.in_file(path));
        }
        latest = *time;
    }
    Ok(times)
}
