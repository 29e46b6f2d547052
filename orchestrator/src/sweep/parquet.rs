//! The table of results as Apache Parquet, with a type for every column.

use std::io::Write;
use std::sync::Arc;

use parquet::basic::{Compression, ConvertedType, LogicalType, Repetition, Type as Physical};
use parquet::data_type::{BoolType, ByteArray, ByteArrayType, DoubleType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedColumnWriter, SerializedFileWriter};
use parquet::schema::types::Type;

use super::cell::Value;
use super::manifest::Manifest;
use super::results::MissionId;
use super::row::Record;
use super::table::{self, Field};

/// Rows that are written at once.
const ROW_GROUP: usize = 65_536;

/// The type of a column.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Bool,
    Int,
    Float,
    Text,
}

/// Writes the rows in the order in which they come; what there is not is null.
///
/// # Errors
/// What the writer said.
pub(super) fn write<'a, R: Record + 'a>(
    out: impl Write + Send,
    manifest: &Manifest,
    rows: impl Iterator<Item = (MissionId, &'a R)>,
) -> std::io::Result<()> {
    let mut records = Vec::new();
    for (mission, row) in rows {
        records.push(table::record(manifest, mission, row)?);
    }
    write_records::<R>(out, manifest, &records).map_err(std::io::Error::other)
}

fn write_records<R: Record>(
    out: impl Write + Send,
    manifest: &Manifest,
    records: &[Vec<Field>],
) -> Result<(), ParquetError> {
    let kinds = kinds::<R>(manifest);
    let header = table::header::<R>(manifest);
    let fields = header.iter().zip(&kinds);
    let fields: Result<Vec<_>, _> = fields.map(|(name, &kind)| column(name, kind)).collect();
    let schema = Type::group_type_builder("results")
        .with_fields(fields?)
        .build()?;
    let properties = WriterProperties::builder()
        .set_compression(Compression::ZSTD(parquet::basic::ZstdLevel::default()))
        .build();
    let mut writer = SerializedFileWriter::new(out, Arc::new(schema), Arc::new(properties))?;
    for part in records.chunks(ROW_GROUP) {
        let mut group = writer.next_row_group()?;
        for (index, &kind) in kinds.iter().enumerate() {
            if let Some(mut column) = group.next_column()? {
                write_column(&mut column, kind, part.iter().filter_map(|r| r.get(index)))?;
                column.close()?;
            }
        }
        group.close()?;
    }
    writer.close()?;
    Ok(())
}

/// The types of the columns.
fn kinds<R: Record>(manifest: &Manifest) -> Vec<Kind> {
    let of_column = |name: &str| match name {
        "case" | "outcome" | "digest" | "error" | "robots" => Kind::Text,
        "seed" | "evaders" | "escaped" | "caught" | "held_out" | "contacts" | "ticks"
        | "obstacles" | "iterations" | "control_points" => Kind::Int,
        "honest" => Kind::Bool,
        _ => Kind::Float,
    };
    let of_parameter = |index: usize| {
        let values = manifest
            .cells
            .iter()
            .filter_map(|cell| cell.values.get(index));
        let all = |is: fn(&Value) -> bool| values.clone().all(is);
        if all(|v| matches!(v, Value::Int(_))) {
            Kind::Int
        } else if all(|v| v.number().is_some()) {
            Kind::Float
        } else if all(|v| matches!(v, Value::Bool(_))) {
            Kind::Bool
        } else {
            Kind::Text
        }
    };
    let (case, others) = R::columns().split_at(1);
    let parameters = (0..manifest.parameters.len()).map(of_parameter);
    let columns = case.iter().map(|name| of_column(name)).chain(parameters);
    columns
        .chain(others.iter().map(|name| of_column(name)))
        .collect()
}

fn column(name: &str, kind: Kind) -> Result<Arc<Type>, ParquetError> {
    let physical = match kind {
        Kind::Bool => Physical::BOOLEAN,
        Kind::Int => Physical::INT64,
        Kind::Float => Physical::DOUBLE,
        Kind::Text => Physical::BYTE_ARRAY,
    };
    let mut builder =
        Type::primitive_type_builder(name, physical).with_repetition(Repetition::OPTIONAL);
    if kind == Kind::Text {
        builder = builder
            .with_converted_type(ConvertedType::UTF8)
            .with_logical_type(Some(LogicalType::String));
    }
    Ok(Arc::new(builder.build()?))
}

fn write_column<'a>(
    column: &mut SerializedColumnWriter<'_>,
    kind: Kind,
    fields: impl Iterator<Item = &'a Field> + Clone,
) -> Result<(), ParquetError> {
    let present: Vec<i16> = fields
        .clone()
        .map(|f| i16::from(*f != Field::Nothing))
        .collect();
    let levels = Some(present.as_slice());
    let fields = fields.filter(|f| **f != Field::Nothing);
    match kind {
        Kind::Bool => {
            let values: Vec<bool> = fields.map(|f| *f == Field::Bool(true)).collect();
            column
                .typed::<BoolType>()
                .write_batch(&values, levels, None)?;
        }
        Kind::Int => {
            let values: Vec<i64> = fields.map(Field::as_int).collect();
            column
                .typed::<Int64Type>()
                .write_batch(&values, levels, None)?;
        }
        Kind::Float => {
            let values: Vec<f64> = fields.map(Field::as_float).collect();
            column
                .typed::<DoubleType>()
                .write_batch(&values, levels, None)?;
        }
        Kind::Text => {
            let values: Vec<ByteArray> = fields
                .map(|f| ByteArray::from(f.to_string().into_bytes()))
                .collect();
            column
                .typed::<ByteArrayType>()
                .write_batch(&values, levels, None)?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use parquet::file::reader::{FileReader as _, SerializedFileReader};
    use parquet::record::Field as Read;

    use super::super::row::Row;
    use super::super::tests::{GOOD, load};
    use super::*;

    #[test]
    fn what_is_read_back_is_what_the_csv_says() {
        let manifest = Manifest::of(&load(GOOD).unwrap());
        let mut rows = Vec::new();
        for cell in 0..6 {
            for seed in 1..=2 {
                let row = Row {
                    evaders: 2,
                    escaped: 1,
                    sim_time_s: 12.25,
                    first_escape_s: (seed == 1).then_some(0.1 + 0.2),
                    digest: "é".repeat(3),
                    ..Row::failed(if seed == 2 { "broken" } else { "" })
                };
                let outcome = super::super::Outcome::Ended;
                let row = if seed == 1 {
                    Row { outcome, ..row }
                } else {
                    row
                };
                rows.push((MissionId { cell, seed }, row));
            }
        }
        let path = tempfile::NamedTempFile::new().unwrap();
        let pairs = || rows.iter().map(|(m, r)| (*m, r));
        write(path.as_file(), &manifest, pairs()).unwrap();
        let mut csv = Vec::new();
        table::write_csv(&mut csv, &manifest, pairs()).unwrap();
        let mut csv = csv::Reader::from_reader(csv.as_slice());
        let names: Vec<String> = csv.headers().unwrap().iter().map(str::to_owned).collect();

        let reader = SerializedFileReader::new(path.reopen().unwrap()).unwrap();
        let read: Vec<_> = reader
            .get_row_iter(None)
            .unwrap()
            .map(Result::unwrap)
            .collect();
        assert_eq!(read.len(), rows.len());
        for (record, row) in csv.records().zip(&read) {
            let record = record.unwrap();
            for (index, (name, field)) in row.get_column_iter().enumerate() {
                assert_eq!(*name, names[index]);
                let text = match field {
                    Read::Null => String::new(),
                    Read::Str(v) => v.clone(),
                    Read::Long(v) => v.to_string(),
                    Read::Double(v) if name == "relative_speed" => {
                        // A column of numbers holds 2 as 2.0.
                        assert_eq!(record[index].parse::<f64>().unwrap(), *v);
                        continue;
                    }
                    Read::Double(v) => v.to_string(),
                    other => panic!("{name}: {other:?}"),
                };
                assert_eq!(record[index], text, "{name}");
            }
        }
        let long = |name: &str| names.iter().position(|n| n == name).unwrap();
        let first: Vec<_> = read[0].get_column_iter().map(|(_, f)| f.clone()).collect();
        assert_eq!(first[long("seed")], Read::Long(1));
        assert_eq!(first[long("first_escape_s")], Read::Double(0.1 + 0.2));
        assert_eq!(first[long("first_capture_s")], Read::Null);
    }
}
