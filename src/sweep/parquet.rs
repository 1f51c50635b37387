//! The table of a sweep as Apache Parquet.

use std::io;
use std::sync::Arc;

use parquet::basic::{ConvertedType, Repetition, Type as Physical};
use parquet::data_type::{BoolType, ByteArray, ByteArrayType, DataType, DoubleType};
use parquet::errors::ParquetError;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedFileWriter, SerializedRowGroupWriter};
use parquet::schema::types::{Type, TypePtr};

use super::table::{Column, Table, Values};

impl Table {
    /// As an Apache Parquet file of one row group; every column may have gaps.
    ///
    /// # Errors
    /// Memory is exhausted.
    pub fn to_parquet(&self) -> io::Result<Vec<u8>> {
        written(self).map_err(io::Error::other)
    }
}

fn written(table: &Table) -> Result<Vec<u8>, ParquetError> {
    let fields = table.columns.iter().map(field).collect::<Result<_, _>>()?;
    let schema = Arc::new(Type::group_type_builder("runs").with_fields(fields).build()?);
    let by = concat!("droptower ", env!("CARGO_PKG_VERSION")).to_owned();
    let properties = Arc::new(WriterProperties::builder().set_created_by(by).build());
    let mut file = SerializedFileWriter::new(Vec::new(), schema, properties)?;
    let mut group = file.next_row_group()?;
    for column in &table.columns {
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
        let table = Table { columns, inputs: 0, figures: 0 };
        let reader = SerializedFileReader::new(bytes::Bytes::from(table.to_parquet().unwrap())).unwrap();
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
}
