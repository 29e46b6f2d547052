//! Columns of results: name, type and value in one place, for header, CSV and Parquet.

use std::io;

use tables::{Cell, Type};

/// A column of the table of results, after the columns of the parameters and `seed`.
pub struct ResultColumn<R: 'static> {
    /// Name.
    pub name: &'static str,
    /// Meaning, unit, and when there is no value; one line of Markdown for the reference.
    pub(super) meaning: &'static str,
    get: Get<R>,
}

/// Function that returns the value of a column of a row; the variant is the type of the column.
enum Get<R: 'static> {
    Bool(fn(&R) -> Option<bool>),
    Int(fn(&R) -> Option<u64>),
    Float(fn(&R) -> Option<f64>),
    /// Text; an empty text is no value.
    Text(fn(&R) -> &str),
    /// JSON as text; an empty text is no value.
    Json(fn(&R) -> serde_json::Result<String>),
}

impl<R> ResultColumn<R> {
    pub(super) const fn bool(
        name: &'static str,
        meaning: &'static str,
        get: fn(&R) -> Option<bool>,
    ) -> Self {
        let get = Get::Bool(get);
        Self { name, meaning, get }
    }

    pub(super) const fn int(
        name: &'static str,
        meaning: &'static str,
        get: fn(&R) -> Option<u64>,
    ) -> Self {
        let get = Get::Int(get);
        Self { name, meaning, get }
    }

    pub(super) const fn float(
        name: &'static str,
        meaning: &'static str,
        get: fn(&R) -> Option<f64>,
    ) -> Self {
        let get = Get::Float(get);
        Self { name, meaning, get }
    }

    pub(super) const fn text(
        name: &'static str,
        meaning: &'static str,
        get: fn(&R) -> &str,
    ) -> Self {
        let get = Get::Text(get);
        Self { name, meaning, get }
    }

    pub(super) const fn json(
        name: &'static str,
        meaning: &'static str,
        get: fn(&R) -> serde_json::Result<String>,
    ) -> Self {
        let get = Get::Json(get);
        Self { name, meaning, get }
    }

    pub(super) fn kind(&self) -> Type {
        match self.get {
            Get::Bool(_) => Type::Bool,
            Get::Int(_) => Type::Int,
            Get::Float(_) => Type::F64,
            Get::Text(_) | Get::Json(_) => Type::Text,
        }
    }

    /// Returns its line of the reference.
    pub(super) fn reference(&self) -> String {
        let kind = match self.get {
            Get::Json(_) => "JSON",
            _ => self.kind().name(),
        };
        format!("| `{}` | {kind} | {} |\n", self.name, self.meaning)
    }

    /// Returns the value of a row.
    ///
    /// # Errors
    /// A value cannot be written as JSON.
    pub(super) fn cell(&self, row: &R) -> io::Result<Cell> {
        let text = |text: String| {
            if text.is_empty() {
                Cell::Empty
            } else {
                Cell::Text(text)
            }
        };
        Ok(match self.get {
            Get::Bool(get) => get(row).map_or(Cell::Empty, Cell::Bool),
            // Counts and ticks are below 2^63.
            Get::Int(get) => get(row).map_or(Cell::Empty, |v| Cell::Int(v.cast_signed())),
            Get::Float(get) => get(row).map_or(Cell::Empty, Cell::F64),
            Get::Text(get) => text(get(row).to_owned()),
            Get::Json(get) => text(get(row)?),
        })
    }
}
