//! Conversion of the fields of a message to rows of a table.

use std::io;

use mcap_log::ros2::{Cdr, Count, DecodeError, Field, Kind, Number, Schema, SchemaError};
use tables::{Cell, Column, Type};

use crate::message_json::{bytes, is_bytes, json};

/// Maximum number of columns of a table.
const MAX_COLUMNS: usize = 2048;
/// Maximum length of an array of numbers or messages with one column for each number.
const MAX_ARRAY_NUMBERS: usize = 64;
const MAX_ARRAY_MESSAGES: usize = 16;

/// Mapping of a topic's messages to rows.
#[derive(Debug, Clone)]
pub(crate) struct Layout {
    before: Vec<Field>,
    /// Sequence with one row per element.
    elements: Option<Field>,
    after: Vec<Field>,
    columns: Vec<Column>,
    /// Number of columns of an element.
    element_columns: usize,
}

impl Layout {
    /// Creates the layout. The rows are the elements of the message's first sequence that does not consist of bytes.
    pub(crate) fn new(schema: &Schema) -> Result<Self, SchemaError> {
        let many = |field: &Field| field.count == Count::Many && !is_bytes(field);
        let at = schema.fields.iter().position(many);
        let (before, rest) = schema.fields.split_at(at.unwrap_or(schema.fields.len()));
        let (elements, after) = match rest.split_first() {
            Some((elements, after)) => (Some(elements.clone()), after),
            None => (None, rest),
        };
        let mut columns: Vec<Column> = ["log_time_ns", "publish_time_ns", "sequence"]
            .map(|name| Column::new(name, Type::UInt))
            .to_vec();
        for field in before.iter().chain(after) {
            flatten(field, &field.name, &mut columns)?;
        }
        let count = columns.len();
        if let Some(field) = &elements {
            columns.push(Column::new(format!("{}.index", field.name), Type::UInt));
            flatten_one(&field.kind, &field.name, &mut columns)?;
        }
        let element_columns = columns.len() - count;
        Ok(Self {
            before: before.to_vec(),
            elements,
            after: after.to_vec(),
            columns,
            element_columns,
        })
    }

    pub(crate) fn columns(&self) -> &[Column] {
        &self.columns
    }

    /// Returns the positions of the columns whose numbers are indices of robots, by their names in Protean's messages.
    pub(crate) fn columns_with_robots(&self) -> impl Iterator<Item = usize> {
        let is_robot = |column: &Column| {
            let name = column.name().rsplit('.').next();
            matches!(name, Some("robot" | "observer" | "target"))
        };
        let columns = self.columns.iter().enumerate();
        columns.filter_map(move |(at, column)| is_robot(column).then_some(at))
    }

    /// Passes on the rows of a message, each beginning with the cells in `first`; `take` may append cells. A message
    /// without elements has one row; a message that cannot be decoded has none.
    pub(crate) fn rows(
        &self,
        first: &[Cell],
        message: &[u8],
        take: &mut dyn FnMut(&mut Vec<Cell>) -> io::Result<()>,
    ) -> Result<io::Result<()>, DecodeError> {
        let mut cdr = Cdr::new(message)?;
        let mut row = first.to_vec();
        for field in &self.before {
            cells(&mut cdr, field, &mut row)?;
        }
        let Some(field) = &self.elements else {
            return Ok(take(&mut row));
        };
        let count = cdr.count(field)?;
        // First pass: find the fields after the elements. Second pass: write the elements.
        let mut elements = cdr;
        for _ in 0..count {
            cdr.skip(&field.kind, &field.name)?;
        }
        for field in &self.after {
            cells(&mut cdr, field, &mut row)?;
        }
        let of_message = row.len();
        if count == 0 {
            row.resize(of_message + self.element_columns, Cell::Empty);
            return Ok(take(&mut row));
        }
        for index in 0..count {
            row.truncate(of_message);
            row.push(Cell::UInt(index as u64));
            cells_of_one(&mut elements, &field.kind, &field.name, &mut row)?;
            if let Err(error) = take(&mut row) {
                return Ok(Err(error));
            }
        }
        Ok(Ok(()))
    }
}

/// Form of a field in a table.
enum Form {
    One,
    /// One or several columns for each of this many elements.
    Each(usize),
    /// Bytes in one column.
    Bytes,
    /// JSON in one column.
    Json,
}

fn form(field: &Field) -> Form {
    match (field.count, &field.kind) {
        (Count::One, _) => Form::One,
        (_, Kind::Number(Number::U8)) => Form::Bytes,
        (Count::Fixed(n), Kind::Number(_)) if n <= MAX_ARRAY_NUMBERS => Form::Each(n),
        (Count::Fixed(n), Kind::Message(_)) if n <= MAX_ARRAY_MESSAGES => Form::Each(n),
        _ => Form::Json,
    }
}

fn flatten(field: &Field, name: &str, columns: &mut Vec<Column>) -> Result<(), SchemaError> {
    match form(field) {
        Form::One => flatten_one(&field.kind, name, columns),
        Form::Each(count) => {
            (0..count).try_for_each(|i| flatten_one(&field.kind, &format!("{name}.{i}"), columns))
        }
        Form::Bytes | Form::Json => add(Column::new(name, Type::Text), columns),
    }
}

fn flatten_one(kind: &Kind, name: &str, columns: &mut Vec<Column>) -> Result<(), SchemaError> {
    let kind = match kind {
        Kind::Message(fields) => {
            return fields
                .iter()
                .try_for_each(|field| flatten(field, &format!("{name}.{}", field.name), columns));
        }
        Kind::Text => Type::Text,
        Kind::Number(Number::Bool) => Type::Bool,
        Kind::Number(Number::U8 | Number::U16 | Number::U32 | Number::U64) => Type::UInt,
        Kind::Number(Number::I8 | Number::I16 | Number::I32 | Number::I64) => Type::Int,
        Kind::Number(Number::F32) => Type::F32,
        Kind::Number(Number::F64) => Type::F64,
    };
    add(Column::new(name, kind), columns)
}

fn add(column: Column, columns: &mut Vec<Column>) -> Result<(), SchemaError> {
    if columns.len() >= MAX_COLUMNS {
        return Err(SchemaError(format!("more than {MAX_COLUMNS} columns")));
    }
    columns.push(column);
    Ok(())
}

fn cells(cdr: &mut Cdr<'_>, field: &Field, row: &mut Vec<Cell>) -> Result<(), DecodeError> {
    match form(field) {
        Form::One => cells_of_one(cdr, &field.kind, &field.name, row),
        Form::Each(count) => {
            (0..count).try_for_each(|_| cells_of_one(cdr, &field.kind, &field.name, row))
        }
        Form::Bytes => {
            row.push(Cell::Text(bytes(cdr, field)?));
            Ok(())
        }
        Form::Json => {
            let mut text = String::new();
            json(cdr, field, &mut text)?;
            row.push(Cell::Text(text));
            Ok(())
        }
    }
}

fn cells_of_one(
    cdr: &mut Cdr<'_>,
    kind: &Kind,
    name: &str,
    row: &mut Vec<Cell>,
) -> Result<(), DecodeError> {
    match kind {
        Kind::Number(number) => row.push(cdr.number(*number, name)?),
        Kind::Text => row.push(cdr.text(name)?),
        Kind::Message(fields) => {
            return fields.iter().try_for_each(|field| cells(cdr, field, row));
        }
    }
    Ok(())
}
