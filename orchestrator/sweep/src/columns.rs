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
                columns.map(|c| Column::new(c.name, c.kind())).collect()
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
    get: Getter<R>,
}

/// Function that returns the value of a column of a row; the variant is the type of the column.
enum Getter<R: 'static> {
    Bool(fn(&R) -> Option<bool>),
    Int(fn(&R) -> Option<u64>),
    Float(fn(&R) -> Option<f64>),
    /// Text; an empty text is no value.
    Text(fn(&R) -> &str),
}

impl<R> ResultColumn<R> {
    pub(super) const fn bool(
        name: &'static str,
        meaning: &'static str,
        get: fn(&R) -> Option<bool>,
    ) -> Self {
        let get = Getter::Bool(get);
        Self { name, meaning, get }
    }

    pub(super) const fn int(
        name: &'static str,
        meaning: &'static str,
        get: fn(&R) -> Option<u64>,
    ) -> Self {
        let get = Getter::Int(get);
        Self { name, meaning, get }
    }

    pub(super) const fn float(
        name: &'static str,
        meaning: &'static str,
        get: fn(&R) -> Option<f64>,
    ) -> Self {
        let get = Getter::Float(get);
        Self { name, meaning, get }
    }

    pub(super) const fn text(
        name: &'static str,
        meaning: &'static str,
        get: fn(&R) -> &str,
    ) -> Self {
        let get = Getter::Text(get);
        Self { name, meaning, get }
    }

    /// Returns the type of its values.
    pub fn kind(&self) -> Type {
        match self.get {
            Getter::Bool(_) => Type::Bool,
            Getter::Int(_) => Type::Int,
            Getter::Float(_) => Type::F64,
            Getter::Text(_) => Type::Text,
        }
    }

    /// Returns its line of the reference.
    fn reference(&self) -> String {
        let kind = self.kind().name();
        format!("| `{}` | {kind} | {} |\n", self.name, self.meaning)
    }

    /// Returns the value of a row.
    pub fn cell(&self, row: &R) -> Cell {
        match self.get {
            Getter::Bool(get) => get(row).map_or(Cell::Empty, Cell::Bool),
            // Counts and ticks are below 2^63.
            Getter::Int(get) => get(row).map_or(Cell::Empty, |v| Cell::Int(v.cast_signed())),
            Getter::Float(get) => get(row).map_or(Cell::Empty, Cell::F64),
            Getter::Text(get) => match get(row) {
                "" => Cell::Empty,
                text => Cell::Text(text.to_owned()),
            },
        }
    }
}
