//! Tables as Apache Parquet.

use std::io;
use std::sync::Arc;

use parquet::basic::{ConvertedType, Repetition, Type as Physical};
use parquet::data_type::{BoolType, ByteArray, ByteArrayType, DataType, DoubleType};
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedFileWriter, SerializedRowGroupWriter};
use parquet::schema::types::{Type, TypePtr};
use serde_json::{Map, Value};

use super::{Column, Values};
use crate::units::Unit;

/// Key of the metadata under which the SI units of columns are, as a JSON object.
pub const UNITS: &str = "units";

/// Key of the metadata under which the comments are, one a line.
pub const COMMENTS: &str = "comments";

/// Columns of equal length as an Apache Parquet file of one row group; every column may have gaps. Its metadata hold the
/// units that the names state, and the `comments`.
///
/// # Errors
/// Memory is exhausted.
pub fn to_parquet(columns: &[Column], comments: &[String]) -> io::Result<Vec<u8>> {
    written(columns, metadata(columns, comments)).map_err(io::Error::other)
}

fn metadata(columns: &[Column], comments: &[String]) -> Vec<KeyValue> {
    let unit = |column: &Column| Some((column.name.clone(), unit(&column.name)?.si_symbol().into()));
    let units: Map<String, Value> = columns.iter().filter_map(unit).collect();
    let mut entries = vec![KeyValue::new(UNITS.to_owned(), Value::from(units).to_string())];
    if !comments.is_empty() {
        entries.push(KeyValue::new(COMMENTS.to_owned(), comments.join("\n")));
    }
    entries
}

/// The unit in a name: `force_N`, `force [N]`.
fn unit(name: &str) -> Option<Unit> {
    let bracketed = name.strip_suffix(']').and_then(|name| name.rsplit_once('['));
    match bracketed {
        Some((_, symbol)) => Unit::parse(symbol).ok(),
        None => Unit::of_name(name).map(|(_, unit)| unit),
    }
}

fn written(columns: &[Column], metadata: Vec<KeyValue>) -> Result<Vec<u8>, ParquetError> {
    let fields = columns.iter().map(field).collect::<Result<_, _>>()?;
    let schema = Arc::new(Type::group_type_builder("schema").with_fields(fields).build()?);
    let by = concat!("droptower ", env!("CARGO_PKG_VERSION")).to_owned();
    let properties =
        Arc::new(WriterProperties::builder().set_created_by(by).set_key_value_metadata(Some(metadata)).build());
    let mut file = SerializedFileWriter::new(Vec::new(), schema, properties)?;
    let mut group = file.next_row_group()?;
    for column in columns {
        match &column.values {
            Values::Numbers(values) => write::<DoubleType>(&mut group, values)?,
            Values::Flags(values) => write::<BoolType>(&mut group, values)?,
            Values::Texts(values) => {
                let bytes = |text: &Option<String>| text.as_deref().map(ByteArray::from);
                write::<ByteArrayType>(&mut group, &values.iter().map(bytes).collect::<Vec<_>>())?;
            }
        }
    }
    group.close()?;
    file.into_inner()
}

fn field(column: &Column) -> Result<TypePtr, ParquetError> {
    let (physical, converted) = match column.values {
        Values::Numbers(_) => (Physical::DOUBLE, ConvertedType::NONE),
        Values::Flags(_) => (Physical::BOOLEAN, ConvertedType::NONE),
        Values::Texts(_) => (Physical::BYTE_ARRAY, ConvertedType::UTF8),
    };
    let field = Type::primitive_type_builder(&column.name, physical);
    Ok(Arc::new(field.with_repetition(Repetition::OPTIONAL).with_converted_type(converted).build()?))
}

/// Writes the next column: the values that there are, and in which rows.
fn write<T: DataType>(
    group: &mut SerializedRowGroupWriter<'_, Vec<u8>>,
    values: &[Option<T::T>],
) -> Result<(), ParquetError> {
    let Some(mut column) = group.next_column()? else { return Ok(()) };
    let levels: Vec<i16> = values.iter().map(|value| i16::from(value.is_some())).collect();
    let present: Vec<T::T> = values.iter().flatten().cloned().collect();
    column.typed::<T>().write_batch(&present, Some(&levels), None)?;
    column.close()
}

#[cfg(test)]
mod tests {
    use parquet::file::reader::{FileReader, SerializedFileReader};
    use parquet::record::Field;

    use super::*;

    #[test]
    fn a_table_is_read_back_with_its_gaps() {
        let column = |name: &str, values| Column { name: name.into(), values };
        let columns = vec![
            column("mass_kg", Values::Numbers(vec![Some(10.0), None, Some(-0.1)])),
            column("ruptured", Values::Flags(vec![None, Some(true), Some(false)])),
            column("failure", Values::Texts(vec![Some("µ".into()), None, Some(String::new())])),
        ];
        let reader = SerializedFileReader::new(bytes::Bytes::from(to_parquet(&columns, &[]).unwrap())).unwrap();
        let rows: Vec<Vec<Field>> = reader
            .get_row_iter(None)
            .unwrap()
            .map(|row| row.unwrap().get_column_iter().map(|(_, field)| field.clone()).collect())
            .collect();
        let text = |text: &str| Field::Str(text.into());
        assert_eq!(
            rows,
            [
                vec![Field::Double(10.0), Field::Null, text("µ")],
                vec![Field::Null, Field::Bool(true), Field::Null],
                vec![Field::Double(-0.1), Field::Bool(false), text("")],
            ]
        );
    }

    #[test]
    fn metadata_hold_units_and_comments() {
        let columns = ["time_s", "accel [m/s2]", "energy_absorption", "peak_force_kN"];
        let columns = columns.map(|name| Column::of_numbers(name, [1.0]));
        let bytes = to_parquet(&columns, &["virtual".into(), "filtered".into()]).unwrap();
        let reader = SerializedFileReader::new(bytes::Bytes::from(bytes)).unwrap();
        let entries = reader.metadata().file_metadata().key_value_metadata().unwrap().clone();
        let found: Vec<(&str, &str)> =
            entries.iter().map(|entry| (entry.key.as_str(), entry.value.as_deref().unwrap())).collect();
        let units = r#"{"time_s":"s","accel [m/s2]":"m/s2","peak_force_kN":"N"}"#;
        assert_eq!(found, [(UNITS, units), (COMMENTS, "virtual\nfiltered")]);
    }
}
