//! Columns and tables of results: name, type and value in one place, for header, CSV and Parquet.

use tables::{Cell, Column, Type};

/// A part of the result of a mission that is a row of a table: the result itself, or one of its robots.
pub trait Part<R>: Sized + 'static {
    /// Name of the files of the table, without extension.
    const TABLE: &'static str;

    /// Heading and rows of the table in the reference: `Robots`, `one row per mission and robot`.
    const REFERENCE: [&'static str; 2];

    /// The columns of the table after `case`, the parameters and `seed`.
    const COLUMNS: &'static [ResultColumn<Self>];

    /// Returns the rows of a mission, in order.
    fn rows(row: &R) -> &[Self];
}

/// A table of results, with any number of rows for each mission.
pub struct ResultTable<R: 'static> {
    /// Name of its files, without extension.
    pub name: &'static str,
    columns: fn() -> Vec<Column>,
    rows: fn(&R) -> Vec<Vec<Cell>>,
    reference: fn() -> String,
}

impl<R> ResultTable<R> {
    /// Returns the table of a kind of parts.
    pub(super) const fn from_part<P: Part<R>>() -> Self {
        Self {
            name: P::TABLE,
            columns: || {
                let columns = P::COLUMNS.iter();
                columns.map(|c| Column::new(c.name, c.kind)).collect()
            },
            rows: |row| {
                let parts = P::rows(row).iter();
                let cells = |part| P::COLUMNS.iter().map(|c| c.cell(part)).collect();
                parts.map(cells).collect()
            },
            reference: || {
                let (name, [heading, rows]) = (P::TABLE, P::REFERENCE);
                let lines: String = P::COLUMNS.iter().map(ResultColumn::reference).collect();
                format!(
                    "\n## {heading}\n\n`{name}.csv`, `{name}.parquet`: {rows}.\n\n\
                     | column | type | meaning |\n|---|---|---|\n{lines}"
                )
            },
        }
    }

    /// Returns its columns after `case`, the parameters and `seed`.
    pub(super) fn columns(&self) -> Vec<Column> {
        (self.columns)()
    }

    /// Returns the cells of these columns for each of its rows of a mission.
    pub(super) fn rows(&self, row: &R) -> Vec<Vec<Cell>> {
        (self.rows)(row)
    }

    /// Returns its section of the reference.
    pub(super) fn reference(&self) -> String {
        (self.reference)()
    }
}

/// A column of a table of results.
pub struct ResultColumn<R: 'static> {
    /// Name.
    pub name: &'static str,
    /// Meaning, unit, and when there is no value; one line of Markdown for the reference.
    pub(super) meaning: &'static str,
    /// The type of its values.
    pub kind: Type,
    pub(super) cell: fn(&R) -> Cell,
}

/// Declares columns, each by the [`Type`] of its values, its name, its meaning, and its value in a row.
macro_rules! columns {
    ($row:ident; $($kind:ident $name:literal, $meaning:literal => $value:expr;)*) => {
        &[$($crate::columns::ResultColumn {
            name: $name,
            meaning: $meaning,
            kind: tables::Type::$kind,
            cell: |$row| $crate::columns::Value::cell($value),
        }),*]
    };
}
pub(super) use columns;

/// A value of a column.
pub(super) trait Value {
    fn cell(self) -> Cell;
}

impl Value for bool {
    fn cell(self) -> Cell {
        Cell::Bool(self)
    }
}

impl Value for u32 {
    fn cell(self) -> Cell {
        Cell::Int(self.into())
    }
}

impl Value for u64 {
    // Counts and ticks are below 2^63.
    fn cell(self) -> Cell {
        Cell::Int(self.cast_signed())
    }
}

impl Value for f64 {
    fn cell(self) -> Cell {
        Cell::F64(self)
    }
}

/// Text; an empty text is no value.
impl Value for &str {
    fn cell(self) -> Cell {
        match self {
            "" => Cell::Empty,
            text => Cell::Text(text.to_owned()),
        }
    }
}

impl<T: Value> Value for Option<T> {
    fn cell(self) -> Cell {
        self.map_or(Cell::Empty, T::cell)
    }
}

impl<R> ResultColumn<R> {
    /// Returns its line of the reference.
    fn reference(&self) -> String {
        let kind = self.kind.name();
        format!("| `{}` | {kind} | {} |\n", self.name, self.meaning)
    }

    /// Returns the value of a row.
    pub fn cell(&self, row: &R) -> Cell {
        (self.cell)(row)
    }
}
