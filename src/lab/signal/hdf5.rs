//! Recordings in HDF5, of h5py, pandas and others, and in MAT-files of version 7.3: data sets, columns of matrices and fields
//! of records, each called by the groups that it is in.

use std::collections::HashMap;
use std::path::Path;

use hdf5_pure::{AttrValue, Dataset, Datatype, DatatypeByteOrder, File, Group};

use super::Annotations;
use super::catalogue::{Binary, Catalogue, Columns, Reader};
use crate::error::{Error, refusal};
use base::file;

/// An HDF5 file whose data sets are listed.
struct Hdf5 {
    file: File,
    columns: Columns,
    sources: Vec<Source>,
    /// As they are found; part of the annotations then.
    comments: Vec<String>,
    /// Bytes of the file.
    length: u64,
    /// Groups and data sets that were listed.
    listed: usize,
    /// Path and bytes of the data set that was read last, whose columns are asked for one after the other.
    last: (String, Vec<u8>),
}

/// Where the values of a vector or a matrix are.
struct Source {
    /// Path of the data set.
    path: String,
    datatype: Datatype,
    rows: usize,
    /// Byte of the first value, and bytes to the value in the next row and column.
    start: usize,
    row: usize,
    column: usize,
    /// What values are multiplied by, and what is added then (CF conventions, packed data).
    scale: [f64; 2],
    /// The value that stands where nothing was measured, before that.
    fill: Option<f64>,
}

/// Most groups and data sets, and groups within groups.
const MOST_OBJECTS: usize = 20_000;
const DEEPEST: usize = 16;
/// Most bytes of values for each byte of the file: deflation packs no more than 1032 in one.
const MOST_PACKED: u64 = 1100;
/// Attributes that state a unit.
const UNITS: [&str; 4] = ["unit", "units", "Unit", "Units"];

/// Lists the data sets of the file at `path`. A text or a number among the attributes of the file becomes a comment, and
/// so does a data set of one value.
pub fn open(path: &Path) -> Result<Catalogue, Error> {
    let length = file::open(path).and_then(|file| Ok(file.metadata()?.len()))?;
    let file = File::open_streaming(path).map_err(in_object("/"))?;
    let root = file.root();
    let (columns, sources, comments) = (Columns::default(), Vec::new(), Vec::new());
    let mut hdf5 = Hdf5 { file, columns, sources, comments, length, listed: 0, last: (String::new(), Vec::new()) };
    let attributes = root.attrs().map_err(in_object("/"))?;
    hdf5.comments = attributes.iter().filter_map(comment).collect();
    hdf5.comments.sort();
    hdf5.list(&root, "", 0)?;
    let annotations = Annotations::new(std::mem::take(&mut hdf5.comments));
    Ok(Catalogue::new(std::mem::take(&mut hdf5.columns.entries), annotations, hdf5))
}

impl Hdf5 {
    fn list(&mut self, group: &Group, path: &str, depth: usize) -> Result<(), Error> {
        let shown = if path.is_empty() { "/" } else { path };
        let within = |name: &str| if path.is_empty() { name.to_owned() } else { format!("{path}/{name}") };
        for name in group.datasets().map_err(in_object(shown))? {
            self.count()?;
            let own = within(&name);
            let dataset = group.dataset(&name).map_err(in_object(&own))?;
            self.add(&dataset, [path, &name], &own)?;
        }
        for name in group.groups().map_err(in_object(shown))? {
            self.count()?;
            // What MATLAB keeps for itself: cells and objects.
            if depth < DEEPEST && !name.starts_with('#') {
                let own = within(&name);
                let inner = group.group(&name).map_err(in_object(&own))?;
                self.list(&inner, &own, depth + 1)?;
            }
        }
        Ok(())
    }

    fn count(&mut self) -> Result<(), Error> {
        self.listed += 1;
        if self.listed <= MOST_OBJECTS {
            return Ok(());
        }
        Err(refusal!("more than {MOST_OBJECTS} groups and data sets"))
    }

    /// Lists the channels of a data set: what it is follows from its type, its shape and its attributes together, so that one place
    /// decides, and says why a data set is none.
    fn add(&mut self, dataset: &Dataset, [group, name]: [&str; 2], path: &str) -> Result<(), Error> {
        let attributes = dataset.attrs().map_err(in_object(path))?;
        let class = text(&attributes, "MATLAB_class");
        let unit = UNITS.iter().find_map(|name| text(&attributes, name));
        let shape = dataset.shape().map_err(in_object(path))?;
        let datatype = dataset.datatype().map_err(in_object(path))?;
        let width = datatype.type_size() as usize;
        let is_text = |name: &str| attributes.get(name).is_some_and(|value| value.as_str().is_some());
        let unpacked = ["scale_factor", "add_offset", "_FillValue", "missing_value"];
        let packed =
            |name: &str| attributes.get(name).and_then(|value| value.to_f64s()).and_then(|all| all.first().copied());
        let scale = [packed("scale_factor").unwrap_or(1.0), packed("add_offset").unwrap_or(0.0)];
        let fill = packed("_FillValue").or_else(|| packed("missing_value"));
        let refused = match class {
            _ if unpacked.iter().any(|name| is_text(name)) => {
                Some("its attributes of packed values are texts".to_owned())
            }
            Some("char") => Some("it holds texts".to_owned()),
            Some("table" | "timetable" | "timeseries" | "string") => {
                let why = "it is an object; save the struct of it instead: table2struct(T, \"ToScalar\", true)";
                Some(why.to_owned())
            }
            _ if attributes.contains_key("MATLAB_empty") => return Ok(()),
            _ => None,
        };
        let count = shape.iter().try_fold(width as u64, |bytes, length| bytes.checked_mul(*length));
        let fits = count.is_some_and(|bytes| bytes <= self.length.saturating_mul(MOST_PACKED));
        let refused = refused.or_else(|| (!fits).then(|| "its shape is larger than the file can hold".to_owned()));
        let source = |rows: u64, datatype: Datatype, [start, row, column]: [usize; 3]| Source {
            path: path.to_owned(),
            datatype,
            rows: rows as usize,
            start,
            row,
            column,
            scale,
            fill,
        };
        if let (Datatype::Compound { members, .. }, None) = (&datatype, &refused)
            && !is_complex(members.iter().map(|member| member.name.as_str()))
        {
            let rows = shape.first().copied().filter(|_| shape.len() == 1);
            for member in members {
                let (base, columns) = match &member.datatype {
                    Datatype::Array { base_type, dimensions } if dimensions.len() == 1 => {
                        (base_type.as_ref().clone(), u64::from(dimensions[0]))
                    }
                    other => (other.clone(), 1),
                };
                let found = match (not_real(&base), rows) {
                    (Some(why), _) => Err(why),
                    (None, None) => Err("its records are no list".to_owned()),
                    (None, Some(rows)) => Ok([rows, columns]),
                };
                self.columns.push([path, &member.name], unit, self.sources.len(), found)?;
                let steps = [member.byte_offset as usize, width, base.type_size() as usize];
                self.sources.push(source(rows.unwrap_or(0), base, steps));
            }
            return Ok(());
        }
        let found = match (refused.or_else(|| not_real(&datatype)), &shape[..]) {
            (Some(why), _) => Err(why),
            (None, []) => Ok([1, 1]),
            (None, [rows]) => Ok([*rows, 1]),
            (None, [a, b]) if *a == 1 || *b == 1 => Ok([a * b, 1]),
            // MATLAB stores columns as rows.
            (None, [columns, rows]) if class.is_some() => Ok([*rows, *columns]),
            (None, [rows, columns]) => Ok([*rows, *columns]),
            (None, _) => Err("it has more than two dimensions".to_owned()),
        };
        let steps = match found {
            Ok([rows, columns]) if columns > 1 && class.is_some() => [0, width, width * rows as usize],
            Ok([_, columns]) => [0, width * columns as usize, width],
            Err(_) => [0; 3],
        };
        if let Ok([1, 1]) = found {
            let value = dataset.read_raw().map_err(in_object(path))?;
            let value = number(&datatype, &value).map(|value| value * scale[0] + scale[1]);
            self.comments.extend(value.map(|value| Annotations::value_comment(path, value)));
            return Ok(());
        }
        let rows = found.as_ref().map_or(0, |[rows, _]| *rows);
        self.columns.push([group, name], unit, self.sources.len(), found)?;
        self.sources.push(source(rows, datatype, steps));
        Ok(())
    }
}

/// The text of an attribute.
fn text<'a>(attributes: &'a HashMap<String, AttrValue>, name: &str) -> Option<&'a str> {
    attributes.get(name)?.as_str()
}

/// An attribute as a comment; those of pandas and PyTables, in capitals or about their own layout, are none.
fn comment((name, value): (&String, &AttrValue)) -> Option<String> {
    let value = match (value.as_str(), value.to_f64s().as_deref()) {
        (Some(text), _) => text.to_owned(),
        (None, Some([number])) => number.to_string(),
        _ => return None,
    };
    let is_own = name.chars().any(char::is_lowercase) && !name.starts_with("pandas_") && !name.starts_with("PYTABLES");
    is_own.then(|| Annotations::value_comment(name, value))
}

impl Reader for Hdf5 {
    fn values(&mut self, place: usize) -> Result<Vec<f64>, Error> {
        let (array, column) = self.columns.places[place];
        let source = &self.sources[array];
        if self.last.0 != source.path {
            let dataset = self.file.dataset(&source.path).map_err(in_object(&source.path))?;
            self.last = (source.path.clone(), dataset.read_raw().map_err(in_object(&source.path))?);
        }
        let bytes = &self.last.1;
        let [factor, offset] = source.scale;
        let value = |row: usize| {
            let at = source.start + row * source.row + column * source.column;
            number(&source.datatype, bytes.get(at..)?)
                .map(|value| if source.fill == Some(value) { f64::NAN } else { value * factor + offset })
        };
        let values: Option<Vec<f64>> = (0..source.rows).map(value).collect();
        let (path, found) = (&source.path, bytes.len());
        values.ok_or_else(|| refusal!("`{path}` has {found} bytes, fewer than its shape needs"))
    }
}

/// Why values of this type are no real numbers; none where they are.
fn not_real(datatype: &Datatype) -> Option<String> {
    let what = match datatype {
        Datatype::FixedPoint { size: 1 | 2 | 4 | 8, byte_order, .. } if is_plain(*byte_order) => return None,
        Datatype::FloatingPoint { size: 4 | 8, byte_order, .. } if is_plain(*byte_order) => return None,
        Datatype::Enumeration { base_type, .. } => return not_real(base_type),
        Datatype::String { .. } | Datatype::VariableLength { is_string: true, .. } => "texts",
        Datatype::Compound { members, .. } if is_complex(members.iter().map(|member| member.name.as_str())) => {
            "complex numbers"
        }
        Datatype::Compound { .. } => "records within records",
        Datatype::Reference { .. } => "references, such as a cell array",
        _ => "values that are no numbers of 1 to 8 bytes",
    };
    Some(format!("it holds {what}"))
}

/// Whether the names are those of the parts of complex numbers.
fn is_complex<'a>(names: impl Iterator<Item = &'a str>) -> bool {
    let names: Vec<&str> = names.collect();
    [["real", "imag"], ["r", "i"]].iter().any(|parts| names == parts)
}

fn is_plain(order: DatatypeByteOrder) -> bool {
    matches!(order, DatatypeByteOrder::LittleEndian | DatatypeByteOrder::BigEndian)
}

/// The number in `bytes`, which are at least as many as those of its type.
fn number(datatype: &Datatype, bytes: &[u8]) -> Option<f64> {
    let (meant, size, order) = match datatype {
        Datatype::FloatingPoint { size, byte_order, .. } => (Binary::Float, *size, *byte_order),
        Datatype::FixedPoint { size, byte_order, layout, .. } => {
            (if layout.signed { Binary::Signed } else { Binary::Unsigned }, *size, *byte_order)
        }
        Datatype::Enumeration { base_type, .. } => return number(base_type, bytes),
        _ => return None,
    };
    meant.number(bytes.get(..size as usize)?, order == DatatypeByteOrder::BigEndian)
}

/// The refusal of an object that is damaged, or of a kind that is not read.
fn in_object(object: &str) -> impl FnOnce(hdf5_pure::Error) -> Error {
    move |error| refusal!("`{object}`: {error}")
}

/// The first bytes of a file, or of what follows a block of its user.
const TAG: &[u8] = b"\x89HDF\r\n\x1a\n";

/// Whether the first bytes are those of HDF5. The block of MATLAB has 512 bytes.
pub fn is_own(first: &[u8]) -> bool {
    first.starts_with(TAG) || first.get(512..).is_some_and(|rest| rest.starts_with(TAG))
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    /// The file is empty before the second column is asked for.
    #[test]
    fn the_columns_of_an_array_are_read_at_once() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.h5");
        fs::copy(concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/it/formats/hdf5/h5py.h5"), &path).unwrap();
        let mut file = open(&path).unwrap();
        let first = file.entries.iter().position(|entry| entry.label().ends_with("sides(:,1)")).unwrap();
        let before = file.reader.values(first).unwrap();
        fs::write(&path, "").unwrap();
        let after = file.reader.values(first + 1).unwrap();
        assert!(before.len() == after.len() && before != after);
    }
}
