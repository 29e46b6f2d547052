//! Rows of results as a table: `results.csv`, `results.parquet`.
//!
//! The columns are `case`, the parameters, `seed`, and those of the kind of row
//! ([`Record::COLUMNS`]).

use std::io::{self, Write};

use tables::{self, Cell, Column, Format, Type};

use super::cell::Value;
use super::manifest::Manifest;
use super::mission_id::MissionId;
use super::row::{Record, Row};

/// Returns `true` if every table of missions has a column of this name, so that no parameter can.
pub(super) fn is_taken(name: &str) -> bool {
    ["case", "seed"].contains(&name) || Row::COLUMNS.iter().any(|column| column.name == name)
}

/// Writes the rows in their order.
///
/// Numbers have the shortest form that reads back as the same number. Missing values are empty, in
/// Parquet null.
///
/// # Errors
/// The error of the writer.
pub(super) fn write<'a, R: Record + 'a, W: Write + Send + 'static>(
    format: Format,
    file: W,
    manifest: &Manifest,
    rows: impl Iterator<Item = (MissionId, &'a R)>,
) -> io::Result<W> {
    let parameters: Vec<Type> = (0..manifest.parameters.len())
        .map(|index| match format {
            // As in the experiment file: 1.0 is not 1.
            Format::Csv => Type::Text,
            Format::Parquet => type_of(manifest, index),
        })
        .collect();
    let mut columns = vec![Column::new("case", Type::Text)];
    let names = manifest.parameters.iter().zip(&parameters);
    columns.extend(names.map(|(name, &kind)| Column::new(name, kind)));
    columns.push(Column::new("seed", Type::Int));
    columns.extend(R::COLUMNS.iter().map(|c| Column::new(c.name, c.kind())));
    let mut table = tables::begin(format, file, &columns)?;
    let mut cells = Vec::with_capacity(columns.len());
    for (mission, row) in rows {
        let cell = manifest.cells.get(mission.cell);
        cells.clear();
        cells.push(cell.map_or(Cell::Empty, |c| Cell::Text(c.case.clone())));
        for (index, &kind) in parameters.iter().enumerate() {
            let value = cell.and_then(|c| c.values.get(index));
            cells.push(value.map_or(Cell::Empty, |v| parameter(v, kind)));
        }
        // Seeds are below 2^63.
        cells.push(Cell::Int(mission.seed.cast_signed()));
        for column in R::COLUMNS {
            cells.push(column.cell(row)?);
        }
        table.row(&cells)?;
    }
    table.finish()
}

/// Returns the type of all values of a parameter.
fn type_of(manifest: &Manifest, index: usize) -> Type {
    let values = manifest.cells.iter().filter_map(|c| c.values.get(index));
    let all = |is: fn(&Value) -> bool| values.clone().all(is);
    if all(|v| matches!(v, Value::Int(_))) {
        Type::Int
    } else if all(|v| v.number().is_some()) {
        Type::F64
    } else if all(|v| matches!(v, Value::Bool(_))) {
        Type::Bool
    } else {
        Type::Text
    }
}

/// Returns the value of a parameter in a column of this type.
fn parameter(value: &Value, kind: Type) -> Cell {
    match (kind, value) {
        (Type::Int, Value::Int(v)) => Cell::Int(*v),
        (Type::F64, value) => value.number().map_or(Cell::Empty, Cell::F64),
        (Type::Bool, Value::Bool(v)) => Cell::Bool(*v),
        (_, value) => Cell::Text(value.to_string()),
    }
}

#[cfg(test)]
mod tests {
    use parquet::file::reader::{FileReader as _, SerializedFileReader};
    use parquet::record::Field;
    use tempfile::NamedTempFile;

    use super::super::Outcome;
    use super::super::tests::{GOOD, load};
    use super::*;
    use recorder::PredictionOutcome;

    fn rows() -> Vec<(MissionId, Row)> {
        let of = |cell, seed| {
            let row = Row {
                evaders: 2,
                escaped: 1,
                sim_time_s: 12.25,
                first_escape_s: (seed == 1).then_some(0.1 + 0.2),
                digest: "é".repeat(3),
                predictions: vec![PredictionOutcome {
                    robot: "evader_1".to_owned(),
                    method: "curve, \"fitted\"".to_owned(),
                    observer: 7,
                    horizon_s: 2.0,
                    predictions: 40,
                    without: 0,
                    mean_m: Some(0.25),
                    median_m: None,
                    rms_m: None,
                    goals_observed: 3,
                    key_recovered_s: None,
                    key_recovered_after: None,
                }],
                ..Row::failed(if seed == 2 { "broken" } else { "" })
            };
            let row = if seed == 1 {
                let outcome = Outcome::Ended;
                Row { outcome, ..row }
            } else {
                row
            };
            (MissionId { cell, seed }, row)
        };
        (0..6).flat_map(|cell| [of(cell, 1), of(cell, 2)]).collect()
    }

    fn written(format: Format) -> NamedTempFile {
        let manifest = load(GOOD).unwrap().manifest();
        let rows = rows();
        let file = NamedTempFile::new().unwrap();
        write(format, file, &manifest, rows.iter().map(|(m, r)| (*m, r))).unwrap()
    }

    #[test]
    fn parquet_and_csv_have_equal_values() {
        let (text, parquet) = (written(Format::Csv), written(Format::Parquet));
        let mut csv = csv::Reader::from_path(text.path()).unwrap();
        let names = csv.headers().unwrap().clone();
        let at = |name: &str| names.iter().position(|n| n == name).unwrap();
        let reader = SerializedFileReader::new(parquet.reopen().unwrap()).unwrap();
        let read: Vec<_> = reader
            .get_row_iter(None)
            .unwrap()
            .map(Result::unwrap)
            .collect();
        let records: Vec<_> = csv.records().map(Result::unwrap).collect();
        assert_eq!((read.len(), records.len()), (12, 12));
        for (record, row) in records.iter().zip(&read) {
            for (index, (name, field)) in row.get_column_iter().enumerate() {
                assert_eq!(*name, names[index]);
                let text = match field {
                    Field::Null => String::new(),
                    Field::Str(v) => v.clone(),
                    Field::Long(v) => v.to_string(),
                    Field::Double(v) if name == "relative_speed" => {
                        // A column of numbers contains 2 as 2.0.
                        assert_eq!(record[index].parse::<f64>().unwrap(), *v);
                        continue;
                    }
                    Field::Double(v) => v.to_string(),
                    other => panic!("{name}: {other:?}"),
                };
                assert_eq!(record[index], text, "{name}");
            }
        }
        let first: Vec<_> = read[0].get_column_iter().map(|(_, f)| f.clone()).collect();
        assert_eq!(first[at("seed")], Field::Long(1));
        assert_eq!(first[at("first_escape_s")], Field::Double(0.1 + 0.2));
        assert_eq!(first[at("first_capture_s")], Field::Null);
        let Field::Str(predictions) = &first[at("predictions")] else {
            panic!("predictions are no text: {:?}", first[at("predictions")]);
        };
        let predictions: Vec<PredictionOutcome> = serde_json::from_str(predictions).unwrap();
        assert_eq!(predictions, rows()[0].1.predictions);
    }
}
