//! The rows as a table: `results.csv`.

use std::io::Write;

use super::cell::Value;
use super::manifest::Manifest;
use super::results::MissionId;
use super::row::Row;

/// The columns that every table of results has, beside those of the parameters, which stand between
/// `case` and `seed`.
pub const COLUMNS: [&str; 19] = [
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
    "digest",
    "error",
    "robots",
];

/// The header of a table.
pub(super) fn header(manifest: &Manifest) -> Vec<&str> {
    let (case, others) = COLUMNS.split_at(1);
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
pub(super) fn write_csv<'a>(
    out: impl Write,
    manifest: &Manifest,
    rows: impl Iterator<Item = (MissionId, &'a Row)>,
) -> std::io::Result<()> {
    let mut csv = csv::WriterBuilder::new()
        .terminator(csv::Terminator::Any(b'\n'))
        .from_writer(out);
    csv.write_record(header(manifest)).map_err(io)?;
    for (mission, row) in rows {
        let fields = record(manifest, mission, row)?;
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
pub(super) enum Field {
    /// There is none.
    Nothing,
    Bool(bool),
    Int(i64),
    Float(f64),
    Text(String),
}

impl Field {
    #[cfg(feature = "parquet")]
    pub fn as_int(&self) -> i64 {
        match self {
            Self::Int(v) => *v,
            _ => 0,
        }
    }

    #[cfg(feature = "parquet")]
    pub fn as_float(&self) -> f64 {
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
pub(super) fn record(
    manifest: &Manifest,
    mission: MissionId,
    row: &Row,
) -> std::io::Result<Vec<Field>> {
    let cell = manifest.cells.get(mission.cell);
    let mut record = vec![cell.map_or(Field::Nothing, |c| c.case.as_str().into())];
    record.extend(cell.into_iter().flat_map(|c| &c.values).map(Field::from));
    // Seeds are below 2^63.
    record.push(Field::Int(mission.seed.cast_signed()));
    record.push(row.outcome.name().into());
    // A mission that failed has no numbers.
    let known = !row.is_failed();
    let int = |value: u64| {
        if known {
            Field::Int(value.cast_signed())
        } else {
            Field::Nothing
        }
    };
    let float = |value: f64| Field::from(known.then_some(value));
    record.extend([row.evaders, row.escaped, row.caught, row.held_out].map(|n| int(n.into())));
    record.push(float(row.sim_time_s));
    record.push(row.first_capture_s.into());
    record.push(row.first_escape_s.into());
    record.push(int(row.contacts.into()));
    record.push(float(row.evader_distance_m));
    record.push(row.evader_mean_speed.into());
    record.push(int(row.ticks));
    record.push(row.escape_possible_fraction.into());
    record.push(row.escape_impossible_from_s.into());
    record.push(row.digest.as_str().into());
    record.push(row.error.as_str().into());
    record.push(if known {
        Field::Text(serde_json::to_string(&row.robots)?)
    } else {
        Field::Nothing
    });
    Ok(record)
}

fn io(error: csv::Error) -> std::io::Error {
    match error.into_kind() {
        csv::ErrorKind::Io(error) => error,
        other => std::io::Error::other(format!("{other:?}")),
    }
}
