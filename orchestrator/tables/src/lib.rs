//! Tables with typed columns, as CSV, as Apache Parquet or in memory (results of sweeps, messages of logs), and tables
//! on a terminal.

mod csv;
mod in_memory;
mod parquet;
mod terminal;

use std::fmt;
use std::io::{self, Write};

pub use in_memory::{ColumnValues, InMemory, Texts, Values};
pub use terminal::{Importance, TerminalTable};

/// File format of a table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// CSV: a line for every row.
    Csv,
    /// Apache Parquet, with typed columns.
    Parquet,
}

/// The type of a column.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Type {
    /// True or false.
    Bool,
    /// A signed integer of 64 bits.
    Int,
    /// An unsigned integer of 64 bits.
    UInt,
    /// A floating-point number of 32 bits.
    F32,
    /// A floating-point number of 64 bits.
    F64,
    /// Text in UTF-8.
    Text,
}

impl Type {
    /// Returns its name in the documentation.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Bool => "true or false",
            Self::Int | Self::UInt => "whole number",
            Self::F32 | Self::F64 => "number",
            Self::Text => "text",
        }
    }
}

/// A column.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Column {
    pub(crate) name: String,
    pub(crate) kind: Type,
}

impl Column {
    /// Returns a column with this name and type.
    pub fn new(name: impl Into<String>, kind: Type) -> Self {
        let name = name.into();
        Self { name, kind }
    }

    /// Returns its name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Returns it with another name.
    #[must_use]
    pub fn renamed(self, name: String) -> Self {
        Self { name, ..self }
    }
}

/// A cell of a table: a value of the type of its column, or empty.
#[derive(Debug, Clone, PartialEq)]
pub enum Cell {
    /// No value.
    Empty,
    /// Value of [`Type::Bool`].
    Bool(bool),
    /// Value of [`Type::Int`].
    Int(i64),
    /// Value of [`Type::UInt`].
    UInt(u64),
    /// Value of [`Type::F32`].
    F32(f32),
    /// Value of [`Type::F64`].
    F64(f64),
    /// Value of [`Type::Text`].
    Text(String),
}

impl Cell {
    /// Returns `true` if both have the same value, numbers with the same bits.
    pub fn is_same(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::F32(a), Self::F32(b)) => a.to_bits() == b.to_bits(),
            (Self::F64(a), Self::F64(b)) => a.to_bits() == b.to_bits(),
            (a, b) => a == b,
        }
    }
}

impl fmt::Display for Cell {
    /// Writes the shortest text that reads back to the same value; a floating-point number has a point or an exponent.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Empty => Ok(()),
            Self::Bool(v) => v.fmt(f),
            Self::Int(v) => v.fmt(f),
            Self::UInt(v) => v.fmt(f),
            Self::F32(v) => fmt::Debug::fmt(v, f),
            Self::F64(v) => fmt::Debug::fmt(v, f),
            Self::Text(v) => f.write_str(v),
        }
    }
}

/// Writer of the rows of a table.
pub trait Rows<W> {
    /// Writes a row: a cell for every column.
    ///
    /// # Errors
    /// The file cannot be written, or a cell is not of the type of its column.
    fn row(&mut self, cells: &[Cell]) -> io::Result<()>;

    /// Writes buffered rows and ends the table.
    ///
    /// # Errors
    /// The file cannot be written.
    fn finish(self: Box<Self>) -> io::Result<W>;
}

/// Creates the writer of a table with these columns.
///
/// # Errors
/// The file cannot be written.
pub fn begin<W: Write + Send + 'static>(
    format: Format,
    file: W,
    columns: &[Column],
) -> io::Result<Box<dyn Rows<W>>> {
    Ok(match format {
        Format::Csv => Box::new(csv::CsvRows::new(file, columns)?),
        Format::Parquet => Box::new(parquet::ParquetRows::new(file, columns)?),
    })
}
