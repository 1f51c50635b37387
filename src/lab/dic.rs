//! Full-field measurements: displacement fields of stereo digital image correlation, a file an image, over time.
//!
//! Written after descriptions and printed examples of the exports of VIC-3D, MatchID, ARAMIS (GOM) and DICe.

use std::cmp::Ordering;
use std::collections::HashMap;
use std::path::{Path, PathBuf};

use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};

use crate::error::{Error, refusal};
use crate::signal::column_name::ColumnName;
use crate::signal::{Annotations, MeasuredChannel, Measurement, ReadOptions, file};
use base::diagnostic::{file_name, listed};
use base::units::{Length, Time};

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
    let (first, second) = (file_name(a), file_name(b));
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
    let columns = file::columns(path, &ReadOptions::default())?.channels;
    let is_time = |column: &&MeasuredChannel| {
        column.unit.as_ref().is_none_or(|unit| unit.measures(Time::DIMENSION))
            && ColumnName::read(&column.label).is_time()
    };
    let found = columns.iter().find(is_time).or(match &columns[..] {
        [only] if only.unit.as_ref().is_none_or(|unit| unit.measures(Time::DIMENSION)) => Some(only),
        _ => None,
    });
    let times = found.map(|column| column.series.values().to_vec()).ok_or_else(|| {
        let labels = listed(columns.iter().map(|column| &column.label));
        refusal!("no column of time among {labels}").in_file(path)
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
    let Measurement { channels, annotations } = with_names_of_comment(table);
    from_columns(channels, annotations, options).map_err(|error| error.in_file(path))
}

fn from_columns(
    mut columns: Vec<MeasuredChannel>,
    annotations: Annotations,
    options: &FieldOptions,
) -> Result<FieldFile, Error> {
    let Found { naming, places, displacements, sigma } = find(&columns)?;
    let all = [places, displacements].concat();
    for place in &all {
        in_metres(&mut columns[*place], options)?;
    }
    let of_row = |row: usize, three: [usize; 3]| three.map(|place| columns[place].series.values()[row]);
    let is_matched = |row: usize| sigma.is_none_or(|sigma| columns[sigma].series.values()[row] >= 0.0);
    let rows = columns[places[0]].series.len();
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
fn in_metres(column: &mut MeasuredChannel, options: &FieldOptions) -> Result<(), Error> {
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
    column.series = column.series.with_values(column.series.values().iter().map(|value| value * unit).collect());
    Ok(())
}

/// The table with the names of the last comment that has one for each column, where the file has no other header.
fn with_names_of_comment(mut table: Measurement) -> Measurement {
    let is_numbered = |(place, column): (usize, &MeasuredChannel)| column.label == format!("column {}", place + 1);
    if !table.channels.iter().enumerate().all(is_numbered) {
        return table;
    }
    let count = table.channels.len();
    let split = |comment: &String, separator: char| -> Option<Vec<ColumnName>> {
        let names: Vec<&str> = match separator {
            ' ' => comment.split_whitespace().collect(),
            other => comment.trim_end_matches(other).split(other).collect(),
        };
        (names.len() == count).then(|| names.into_iter().map(ColumnName::read).collect())
    };
    let names = |comment: &String| [';', '\t', ',', ' '].into_iter().find_map(|separator| split(comment, separator));
    if let Some(names) = table.annotations.comments().iter().rev().find_map(names) {
        for (column, ColumnName { name, label, unit, .. }) in table.channels.iter_mut().zip(names) {
            if let Some(unit) = &unit {
                let values = column.series.values().iter().map(|value| unit.to_si(*value)).collect();
                column.series = column.series.with_values(values);
            }
            (column.name, column.label, column.unit) = (name, label, unit);
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
fn find(columns: &[MeasuredChannel]) -> Result<Found, Error> {
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
    let found = listed(columns.iter().map(|column| &column.label));
    Err(refusal!("no columns of places and displacements that are known among {found}").with_hint(
        "export X, Y, Z and U, V, W of the undeformed places (VIC-3D, MatchID), x, y, z and dx, dy, dz (ARAMIS), or \
         MODEL_COORDINATES_* and MODEL_DISPLACEMENT_* (DICe)",
    ))
}

/// The place of a column of this name, in these letters or else in any case: VIC-3D has `X` in space and `x` in the image.
fn place(columns: &[MeasuredChannel], name: &str) -> Option<usize> {
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

/// A rigid motion x ↦ R x + t.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RigidMotion {
    /// R.
    pub rotation: UnitQuaternion<f64>,
    /// t, m.
    pub translation: Vector3<f64>,
}

impl RigidMotion {
    /// The motion with a translation (m) after a rotation, an axis times an angle (rad).
    pub fn new(translation: [f64; 3], rotation: [f64; 3]) -> RigidMotion {
        let rotation = UnitQuaternion::from_scaled_axis(Vector3::from(rotation));
        RigidMotion { rotation, translation: translation.into() }
    }

    /// No motion.
    pub fn identity() -> RigidMotion {
        RigidMotion { rotation: UnitQuaternion::identity(), translation: Vector3::zeros() }
    }

    /// The image of a point.
    pub fn apply(&self, point: [f64; 3]) -> [f64; 3] {
        (self.rotation * Vector3::from(point) + self.translation).into()
    }

    /// The image of a vector.
    pub fn rotate(&self, vector: [f64; 3]) -> [f64; 3] {
        (self.rotation * Vector3::from(vector)).into()
    }

    /// The motion back.
    pub fn inverse(&self) -> RigidMotion {
        let rotation = self.rotation.inverse();
        RigidMotion { rotation, translation: rotation * -self.translation }
    }

    /// The rotation as an axis times an angle, rad.
    pub fn rotation_vector(&self) -> [f64; 3] {
        self.rotation.scaled_axis().into()
    }

    /// The motion that brings the first points of the `pairs` closest to the second, in least squares: the singular value
    /// decomposition of their covariance (Kabsch 1976; Umeyama 1991, equation 40). None where the points of either side lie
    /// on a line, which leaves a rotation about it open.
    pub fn of_pairs(pairs: &[[[f64; 3]; 2]]) -> Option<RigidMotion> {
        let mean = |side: usize| {
            pairs.iter().map(|pair| Vector3::from(pair[side])).sum::<Vector3<f64>>() / pairs.len().max(1) as f64
        };
        let (from, to) = (mean(0), mean(1));
        let covariance: Matrix3<f64> =
            pairs.iter().map(|[a, b]| (Vector3::from(*b) - to) * (Vector3::from(*a) - from).transpose()).sum();
        let svd = covariance.svd(true, true);
        let (u, v_t) = (svd.u?, svd.v_t?);
        let [first, second] = [svd.singular_values[0], svd.singular_values[1]];
        if !(first.is_finite() && second > 1e-9 * first) {
            return None;
        }
        let sign = if (u.determinant() * v_t.determinant()) < 0.0 { -1.0 } else { 1.0 };
        let rotation = u * Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, sign)) * v_t;
        let rotation = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(rotation));
        Some(RigidMotion { rotation, translation: to - rotation * from })
    }
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::path::PathBuf;

    use super::*;

    fn read_text(name: &str, text: &[u8], unit: Option<f64>) -> Result<FieldFile, crate::Error> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(name);
        fs::write(&path, text).unwrap();
        read(&path, &FieldOptions { unit })
    }

    /// Files made after descriptions and printed headers of exports; none is an export itself.
    #[test]
    fn exports_of_each_program_are_read() {
        for (program, name, unit) in [
            ("VIC-3D", "vic", None),
            ("VIC-3D", "vic-plain", Some(1e-3)),
            ("MatchID", "matchid", None),
            ("MatchID", "matchid-older", None),
            ("ARAMIS", "aramis", Some(1e-3)),
            ("ARAMIS", "aramis-deformed", None),
            ("ARAMIS", "nodemap", None),
            ("DICe", "dice", Some(1e-3)),
        ] {
            let path = format!(concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/it/formats/fields/{}.csv"), name);
            let found = read(path.as_ref(), &FieldOptions { unit }).unwrap_or_else(|error| panic!("{name}: {error}"));
            assert_eq!((found.program, found.missing), (program, 1), "{name}");
            let near = |found: &[[f64; 3]], expected: [[f64; 3]; 2]| {
                let pairs = found.iter().flatten().zip(expected.as_flattened());
                let is_same = pairs.into_iter().all(|(a, b)| (a - b).abs() < 1e-12);
                assert!(found.len() == 2 && is_same, "{program}: {found:?}");
            };
            near(&found.places, [[0.01, -0.02, 0.0015], [0.012, -0.02, 0.0015]]);
            near(&found.displacements, [[0.0005, 0.0, -0.002], [0.00025, 0.0, -0.002]]);
        }
    }

    #[test]
    fn what_is_no_field_is_refused_by_name() {
        for (text, expected) in [
            ("x,y,F\n1,2,3\n", "no columns of places and displacements that are known among `x`, `y`, `F`"),
            ("x,y,u,v\n1,2,3,4\n", "displacements in the plane alone (`u`, `v`)"),
            ("X,Y,Z,U,V\n1,2,3,4,5\n", "displacements in the plane alone (`U`, `V`): fields of two-dimensional"),
            ("X,Y,Z,U,V,W\n1,2,3,4,5,6\n", "field.csv: `X` states no unit of length"),
            ("X [Pixel],Y,Z,U,V,W\n1,2,3,4,5,6\n", "`X [Pixel]` is in `Pixel`, not in a unit of length"),
            ("X [s],Y,Z,U,V,W\n1,2,3,4,5,6\n", "`X [s]` is in `s`, not in a unit of length"),
            ("X [m],Y [m],Z [m],U [m],V [m],W [m]\n1,2,3,4,5,\n", "no point has a displacement"),
            (
                "X [m],Y [m],Z [m],U [m],V [m],W [m]\n1,2,3,4,5,x\n",
                "field.csv:2:11: expected a number for `W`, found `x`",
            ),
        ] {
            let error = read_text("field.csv", text.as_bytes(), None).unwrap_err().to_string();
            assert!(error.contains(expected), "{text:?} gave: {error}");
        }
    }

    #[test]
    fn files_are_in_the_order_of_their_numbers() {
        let paths = |names: &[&str]| names.iter().map(PathBuf::from).collect::<Vec<_>>();
        let found = in_order(paths(&["b/f_10.csv", "a/f_9.csv", "f_009b.csv", "f_100.csv", "e_200.csv", "f.csv"]));
        assert_eq!(found, paths(&["e_200.csv", "f.csv", "a/f_9.csv", "f_009b.csv", "b/f_10.csv", "f_100.csv"]));
    }

    #[test]
    fn states_share_their_places() {
        let folder = tempfile::tempdir().unwrap();
        let head = "X [mm],Y [mm],Z [mm],U [mm],V [mm],W [mm],sigma\n";
        let file = |name: &str, rows: &str| {
            let path = folder.path().join(name);
            fs::write(&path, format!("{head}{rows}")).unwrap();
            path
        };
        let first = file("1.csv", "0,0,0,0,0,0,0\n1,0,0,0,0,0,0\n2,0,0,0,0,0,-1\n");
        let second = file("2.csv", "1,0,0,0,0,3,0\n2,0,0,0,0,4,0\n");
        let field = Field::read(&[(first, 0.0), (second, 0.5)], &FieldOptions::default()).unwrap().unwrap();
        assert_eq!((field.places.len(), field.points()), (3, 4));
        assert_eq!(field.states[1].points, [(1, [0.0, 0.0, 0.003]), (2, [0.0, 0.0, 0.004])]);
        assert_eq!((field.states[0].missing, field.states[1].time), (1, 0.5));
    }

    #[test]
    fn times_come_from_a_table() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("times.csv");
        let times = |text: &str| {
            fs::write(&path, text).unwrap();
            read_times(&path).map_err(|error| error.to_string())
        };
        assert_eq!(times("image,time [ms]\n0,0\n1,2.5\n").unwrap(), [0.0, 0.0025]);
        assert_eq!(times("0.0\n0.5\n").unwrap(), [0.0, 0.5]);
        assert!(times("image,load\n0,0\n").unwrap_err().contains("no column of time among `image`, `load`"));
        assert!(times("time_s\n0\n0\n").unwrap_err().contains("time 2 does not come after"));
    }

    #[test]
    fn pairs_of_points_give_back_their_motion() {
        let rotation = nalgebra::UnitQuaternion::from_scaled_axis(nalgebra::Vector3::new(0.3, -1.2, 2.0));
        let motion = RigidMotion { rotation, translation: nalgebra::Vector3::new(0.1, -0.4, 2.0) };
        let flat = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 2.0, 0.0]];
        let pairs: Vec<_> = flat.iter().map(|place| [*place, motion.apply(*place)]).collect();
        let found = RigidMotion::of_pairs(&pairs).unwrap();
        assert!(found.rotation.angle_to(&motion.rotation) < 1e-12, "{found:?}");
        assert!((found.translation - motion.translation).norm() < 1e-12, "{found:?}");
        let there = motion.inverse().apply(motion.apply([0.3, 0.4, 0.5]));
        assert!((nalgebra::Vector3::from(there) - nalgebra::Vector3::new(0.3, 0.4, 0.5)).norm() < 1e-12);
        assert!(RigidMotion::of_pairs(&pairs[..2]).is_none(), "two points leave a rotation open");
    }
}
