//! The rows as a table: `results.csv`.

use std::io::Write;

use super::cell::Value;
use super::manifest::Manifest;
use super::results::MissionId;
use super::row::Record;

/// The columns that every table of results has, beside those of the parameters, which stand between
/// `case` and `seed`.
pub const COLUMNS: [&str; 23] = [
    "case",
    "seed",
    "outcome",
    "evaders",
    "escaped",
    "caught",
    "held_out",
    "sim_time_s",
    "first_capture_s",
    "first_escape_s",
    "contacts",
    "evader_distance_m",
    "evader_mean_speed",
    "ticks",
    "escape_possible_fraction",
    "escape_impossible_from_s",
    "coverage_fraction",
    "coverable_fraction",
    "way_m",
    "digest",
    "error",
    "robots",
    "predictions",
];

/// The header of a table.
pub(super) fn header<R: Record>(manifest: &Manifest) -> Vec<&str> {
    let (case, others) = R::columns().split_at(1);
    let parameters = manifest.parameters.iter().map(String::as_str);
    let columns = case.iter().copied().chain(parameters);
    columns.chain(others.iter().copied()).collect()
}

/// Writes the rows as CSV, in the order in which they come.
///
/// Numbers are the shortest that read back as the same; what there is not is empty.
///
/// # Errors
/// What the writer said.
pub(super) fn write_csv<'a, R: Record + 'a>(
    out: impl Write,
    manifest: &Manifest,
    rows: impl Iterator<Item = (MissionId, &'a R)>,
) -> std::io::Result<()> {
    let records = rows.map(|(mission, row)| Ok((mission, record(manifest, mission, row)?)));
    write_records(out, manifest, &header::<R>(manifest), records)
}

/// Writes records as CSV, each with the mission that it is of.
///
/// # Errors
/// What the writer said.
pub(super) fn write_records(
    out: impl Write,
    manifest: &Manifest,
    header: &[&str],
    records: impl Iterator<Item = std::io::Result<(MissionId, Vec<Field>)>>,
) -> std::io::Result<()> {
    let mut csv = csv::WriterBuilder::new()
        .terminator(csv::Terminator::Any(b'\n'))
        .from_writer(out);
    csv.write_record(header).map_err(io)?;
    for record in records {
        let (mission, fields) = record?;
        let texts = fields.iter().zip(0..).map(|(field, column)| {
            // Parameters stay as they are written: 1.0 is not 1.
            let parameter = usize::checked_sub(column, 1).and_then(|i| {
                manifest
                    .cells
                    .get(mission.cell)
                    .and_then(|c| c.values.get(i))
            });
            parameter.map_or_else(|| field.to_string(), ToString::to_string)
        });
        csv.write_record(texts.collect::<Vec<_>>()).map_err(io)?;
    }
    csv.flush()
}

/// One field of the table.
#[derive(Debug, Clone, PartialEq)]
pub enum Field {
    /// There is none.
    Nothing,
    /// True or false.
    Bool(bool),
    /// A whole number.
    Int(i64),
    /// A number.
    Float(f64),
    /// Text.
    Text(String),
}

impl Field {
    /// A whole number; 0 of anything else.
    #[cfg(feature = "parquet")]
    pub(super) fn as_int(&self) -> i64 {
        match self {
            Self::Int(v) => *v,
            _ => 0,
        }
    }

    /// A number; NaN of anything else.
    #[cfg(feature = "parquet")]
    pub(super) fn as_float(&self) -> f64 {
        match self {
            Self::Float(v) => *v,
            Self::Int(v) => *v as f64,
            _ => f64::NAN,
        }
    }
}

impl std::fmt::Display for Field {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Nothing => Ok(()),
            Self::Bool(v) => write!(f, "{v}"),
            Self::Int(v) => write!(f, "{v}"),
            Self::Float(v) => write!(f, "{v}"),
            Self::Text(v) => f.write_str(v),
        }
    }
}

impl From<Option<f64>> for Field {
    fn from(value: Option<f64>) -> Self {
        value.map_or(Self::Nothing, Self::Float)
    }
}

impl From<&str> for Field {
    fn from(text: &str) -> Self {
        if text.is_empty() {
            Self::Nothing
        } else {
            Self::Text(text.to_owned())
        }
    }
}

impl From<&Value> for Field {
    fn from(value: &Value) -> Self {
        match value {
            Value::Bool(v) => Self::Bool(*v),
            Value::Int(v) => Self::Int(*v),
            Value::Float(v) => Self::Float(*v),
            Value::Text(v) => Self::Text(v.clone()),
        }
    }
}

/// The fields of one row, in the order of [`header`].
pub(super) fn record<R: Record>(
    manifest: &Manifest,
    mission: MissionId,
    row: &R,
) -> std::io::Result<Vec<Field>> {
    let mut record = label(manifest, mission);
    record.extend(row.fields()?);
    Ok(record)
}

/// What says which mission a row is of: case, parameters and seed.
pub(super) fn label(manifest: &Manifest, mission: MissionId) -> Vec<Field> {
    let cell = manifest.cells.get(mission.cell);
    let mut label = vec![cell.map_or(Field::Nothing, |c| c.case.as_str().into())];
    label.extend(cell.into_iter().flat_map(|c| &c.values).map(Field::from));
    // Seeds are below 2^63.
    label.push(Field::Int(mission.seed.cast_signed()));
    label
}

fn io(error: csv::Error) -> std::io::Error {
    match error.into_kind() {
        csv::ErrorKind::Io(error) => error,
        other => std::io::Error::other(format!("{other:?}")),
    }
}
