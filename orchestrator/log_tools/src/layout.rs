//! Conversion of the fields of a message to rows of a table.

use std::collections::BTreeSet;
use std::io;

use mcap_log::ros2::{Cdr, Count, DecodeError, Field, Kind, Primitive, Schema, SchemaError};
use tables::{Cell, Column, Type};

use crate::message_json::{bytes, is_bytes, json};

/// Maximum number of columns of a table.
const MAX_COLUMNS: usize = 2048;
/// Maximum length of an array of numbers or messages with one column for each number.
const MAX_ARRAY_NUMBERS: usize = 64;
const MAX_ARRAY_MESSAGES: usize = 16;

/// Mapping of a topic's messages to rows.
#[derive(Debug, Clone)]
pub struct Layout {
    schema: Schema,
    /// Number of fields before the sequence with one row per element; all fields if there is none.
    before: usize,
    /// Columns; several may have the same name.
    columns: Vec<Column>,
    /// Number of columns of an element.
    element_columns: usize,
}

impl Layout {
    /// Creates the layout. The rows are the elements of the message's first sequence that does not consist of bytes.
    pub(crate) fn new(schema: Schema) -> Result<Self, SchemaError> {
        let many = |field: &Field| field.count == Count::Many && !is_bytes(field);
        let fields = schema.fields();
        let at = fields.iter().position(many).unwrap_or(fields.len());
        let (before, elements, after) = parts(fields, at);
        let mut columns: Vec<Column> = ["log_time_ns", "publish_time_ns", "sequence"]
            .map(|name| Column::new(name, Type::UInt))
            .to_vec();
        for field in before.iter().chain(after) {
            flatten(field, &field.name, &mut columns)?;
        }
        let count = columns.len();
        if let Some(field) = elements {
            columns.push(Column::new(format!("{}.index", field.name), Type::UInt));
            flatten_one(&field.kind, &field.name, &mut columns)?;
        }
        Ok(Self {
            element_columns: columns.len() - count,
            schema,
            before: at,
            columns,
        })
    }

    /// Returns the columns, no two with the same name. With `robot_names`, each of [`Layout::columns_with_robots`] has
    /// another for the name, after all others.
    pub(crate) fn columns(&self, robot_names: bool) -> Vec<Column> {
        let mut columns = self.columns.clone();
        let robots = self.columns_with_robots().filter(|_| robot_names);
        let robots = robots.filter_map(|at| self.columns.get(at));
        columns.extend(robots.map(|c| Column::new(format!("{}_name", c.name()), Type::Text)));
        distinct(columns)
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
        let mut cdr = Cdr::new(&self.schema, message)?;
        let mut row = first.to_vec();
        let (before, elements, after) = parts(self.schema.fields(), self.before);
        for field in before {
            cells(&mut cdr, field, &mut row)?;
        }
        let Some(field) = elements else {
            return Ok(take(&mut row));
        };
        let count = cdr.count(field)?;
        // First pass: find the fields after the elements. Second pass: write the elements.
        let mut elements = cdr;
        if !after.is_empty() {
            for _ in 0..count {
                cdr.skip(&field.kind, &field.name)?;
            }
        }
        for field in after {
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

/// Returns the first `before` fields, the next one, and the others.
fn parts(fields: &[Field], before: usize) -> (&[Field], Option<&Field>, &[Field]) {
    let (before, rest) = fields.split_at(before);
    match rest.split_first() {
        Some((elements, after)) => (before, Some(elements), after),
        None => (before, None, rest),
    }
}

/// Gives each column a name of its own: the first one of a name keeps it, others get `_2`, `_3`, ….
fn distinct(columns: Vec<Column>) -> Vec<Column> {
    let wanted: BTreeSet<String> = columns.iter().map(|c| c.name().to_owned()).collect();
    let mut used = BTreeSet::new();
    let named = columns.into_iter().map(|column| {
        let mut name = column.name().to_owned();
        let mut number = 1;
        while used.contains(&name) || (number > 1 && wanted.contains(&name)) {
            number += 1;
            name = format!("{}_{number}", column.name());
        }
        used.insert(name.clone());
        column.renamed(name)
    });
    named.collect()
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
        (_, Kind::Primitive(Primitive::U8)) => Form::Bytes,
        (_, Kind::Primitive(Primitive::Text | Primitive::WideText)) => Form::Json,
        (Count::Fixed(n), Kind::Primitive(_)) if n <= MAX_ARRAY_NUMBERS => Form::Each(n),
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
        Kind::Nothing => return Ok(()),
        Kind::Primitive(primitive) => match primitive {
            Primitive::Bool => Type::Bool,
            Primitive::U8 | Primitive::U16 | Primitive::U32 | Primitive::U64 => Type::UInt,
            Primitive::I8 | Primitive::I16 | Primitive::I32 | Primitive::I64 => Type::Int,
            Primitive::F32 => Type::F32,
            Primitive::F64 => Type::F64,
            Primitive::Text | Primitive::WideText => Type::Text,
        },
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
        Kind::Primitive(primitive) => row.push(cdr.primitive(*primitive, name)?),
        Kind::Message(fields) => fields.iter().try_for_each(|field| cells(cdr, field, row))?,
        Kind::Nothing => cdr.skip(kind, name)?,
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const NAMES: [&str; 9] = [
        "log_time_ns",
        "publish_time_ns",
        "sequence",
        "sequence_2",
        "index",
        "robot",
        "robot_name",
        "list.index",
        "a.0",
    ];

    /// Returns the lines of fields with different names; the first type of a name may be a list.
    fn fields(kinds: &'static [&'static str]) -> impl Strategy<Value = String> {
        let names = prop::sample::subsequence(&NAMES[..], 0..=NAMES.len());
        let kinds = prop::collection::vec(prop::sample::select(kinds), NAMES.len());
        (names.prop_shuffle(), kinds).prop_map(|(names, kinds)| {
            let lines = names.iter().zip(kinds);
            let lines = lines.map(|(name, kind)| format!("{kind} {name}\n"));
            lines.collect::<Vec<String>>().concat()
        })
    }

    proptest! {
        #[test]
        fn every_column_has_a_name_of_its_own(
            own in fields(&["uint32", "string", "N", "N[2]"]),
            list in prop::sample::select(&["N[] list\n", "uint32[] list\n", "uint32[2] a\n", ""][..]),
            nested in fields(&["uint32", "float64[2]"]),
            robot_names: bool,
        ) {
            let text = format!("{own}{list}===\nMSG: p/N\nuint8 x\n{nested}");
            let layout = Layout::new(Schema::parse("p/msg/T", text.as_bytes()).unwrap()).unwrap();
            let columns = layout.columns(robot_names);
            let names: BTreeSet<&str> = columns.iter().map(Column::name).collect();
            prop_assert_eq!(names.len(), columns.len(), "{}{:?}", text, columns);
            // Columns of the log keep their names, and so does the first of each other name.
            let kept = columns.iter().zip(&layout.columns);
            for (at, (column, wanted)) in kept.enumerate() {
                let earlier = layout.columns[..at].iter().any(|c| c.name() == wanted.name());
                prop_assert_eq!(column == wanted, !earlier, "{}{:?}", text, columns);
            }
        }
    }
}
