//! Tables in memory, by column.

use std::collections::BTreeMap;
use std::io;

use super::{Cell, Column, Rows, Type};

/// Values of a column, one for each row; rows without a value have a placeholder.
#[derive(Debug, Clone, PartialEq)]
pub enum Values {
    /// Values of [`Type::Bool`]; placeholder `false`.
    Bool(Vec<bool>),
    /// Values of [`Type::Int`]; placeholder 0.
    Int(Vec<i64>),
    /// Values of [`Type::UInt`]; placeholder 0.
    UInt(Vec<u64>),
    /// Values of [`Type::F32`]; placeholder NaN.
    F32(Vec<f32>),
    /// Values of [`Type::F64`]; placeholder NaN.
    F64(Vec<f64>),
    /// Values of [`Type::Text`]; placeholder the empty text.
    Text(Texts),
}

/// Texts of a column; each text is stored once.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Texts {
    /// Index in `distinct` of the text of each row.
    pub codes: Vec<i32>,
    /// The different texts, in the order of their first rows.
    pub distinct: Vec<String>,
    /// Indices by text.
    known: BTreeMap<String, i32>,
}

impl Texts {
    fn push(&mut self, text: &str) -> io::Result<()> {
        // The text of a message repeats in the rows of its elements.
        let last = self.codes.last().copied();
        let place = last.and_then(|code| usize::try_from(code).ok());
        let same = place.and_then(|place| self.distinct.get(place));
        let code = match last.filter(|_| same.is_some_and(|same| same == text)) {
            Some(code) => code,
            None => self.code(text)?,
        };
        self.codes.push(code);
        Ok(())
    }

    fn code(&mut self, text: &str) -> io::Result<i32> {
        if let Some(code) = self.known.get(text) {
            return Ok(*code);
        }
        let code = i32::try_from(self.distinct.len()).map_err(io::Error::other)?;
        self.distinct.push(text.to_owned());
        self.known.insert(text.to_owned(), code);
        Ok(code)
    }
}

impl Values {
    fn new(kind: Type) -> Self {
        match kind {
            Type::Bool => Self::Bool(Vec::new()),
            Type::Int => Self::Int(Vec::new()),
            Type::UInt => Self::UInt(Vec::new()),
            Type::F32 => Self::F32(Vec::new()),
            Type::F64 => Self::F64(Vec::new()),
            Type::Text => Self::Text(Texts::default()),
        }
    }

    /// Appends the value of a cell or the placeholder.
    fn push(&mut self, cell: &Cell) -> io::Result<()> {
        match (self, cell) {
            (Self::Bool(values), Cell::Bool(value)) => values.push(*value),
            (Self::Bool(values), Cell::Empty) => values.push(false),
            (Self::Int(values), Cell::Int(value)) => values.push(*value),
            (Self::Int(values), Cell::Empty) => values.push(0),
            (Self::UInt(values), Cell::UInt(value)) => values.push(*value),
            (Self::UInt(values), Cell::Empty) => values.push(0),
            (Self::F32(values), Cell::F32(value)) => values.push(*value),
            (Self::F32(values), Cell::Empty) => values.push(f32::NAN),
            (Self::F64(values), Cell::F64(value)) => values.push(*value),
            (Self::F64(values), Cell::Empty) => values.push(f64::NAN),
            (Self::Text(texts), Cell::Text(value)) => texts.push(value)?,
            (Self::Text(texts), Cell::Empty) => texts.push("")?,
            (_, cell) => {
                let what = format!("the cell `{cell}` is not of the type of its column");
                return Err(io::Error::new(io::ErrorKind::InvalidData, what));
            }
        }
        Ok(())
    }
}

/// A column with its values.
#[derive(Debug, Clone, PartialEq)]
pub struct ColumnValues {
    /// Name.
    pub name: String,
    /// One value for each row.
    pub values: Values,
    /// `true` for each row without a value; absent if every row has one.
    pub empty: Option<Vec<bool>>,
}

/// Table in memory; its end returns the columns.
#[derive(Debug)]
pub struct InMemory {
    columns: Vec<ColumnValues>,
    rows: usize,
}

impl InMemory {
    /// Creates the table with these columns.
    pub fn new(columns: &[Column]) -> Self {
        let columns = columns.iter().map(|column| ColumnValues {
            name: column.name.clone(),
            values: Values::new(column.kind),
            empty: None,
        });
        Self {
            columns: columns.collect(),
            rows: 0,
        }
    }
}

impl Rows<Vec<ColumnValues>> for InMemory {
    fn row(&mut self, cells: &[Cell]) -> io::Result<()> {
        let rows = self.rows;
        for (column, cell) in self.columns.iter_mut().zip(cells) {
            column.values.push(cell)?;
            let is_empty = matches!(cell, Cell::Empty);
            match &mut column.empty {
                Some(empty) => empty.push(is_empty),
                None if is_empty => {
                    let mut empty = vec![false; rows];
                    empty.push(true);
                    column.empty = Some(empty);
                }
                None => {}
            }
        }
        self.rows += 1;
        Ok(())
    }

    fn finish(self: Box<Self>) -> io::Result<Vec<ColumnValues>> {
        Ok(self.columns)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(columns: &[(&str, Type)], rows: &[&[Cell]]) -> io::Result<Vec<ColumnValues>> {
        let columns = columns.iter().map(|(name, kind)| Column::new(*name, *kind));
        let columns: Vec<Column> = columns.collect();
        let mut table = Box::new(InMemory::new(&columns));
        for row in rows {
            table.row(row)?;
        }
        table.finish()
    }

    #[test]
    fn a_column_has_a_value_or_a_placeholder_for_each_row() {
        let text = |text: &str| Cell::Text(text.to_owned());
        let columns = table(
            &[("n", Type::UInt), ("x", Type::F64), ("name", Type::Text)],
            &[
                &[Cell::UInt(7), Cell::F64(0.5), text("b")],
                &[Cell::UInt(8), Cell::Empty, text("a")],
                &[Cell::UInt(9), Cell::F64(1.5), text("b")],
                &[Cell::UInt(9), Cell::F64(2.5), text("b")],
            ],
        );
        let [n, x, name] = &columns.unwrap()[..] else {
            panic!("three columns")
        };
        assert_eq!(
            (&n.values, &n.empty),
            (&Values::UInt(vec![7, 8, 9, 9]), &None)
        );
        assert_eq!(x.empty, Some(vec![false, true, false, false]));
        assert!(matches!(&x.values, Values::F64(v) if v[1].is_nan() && v[3] == 2.5));
        let Values::Text(texts) = &name.values else {
            panic!("texts")
        };
        assert_eq!(texts.codes, [0, 1, 0, 0]);
        assert_eq!(texts.distinct, ["b", "a"]);
    }

    #[test]
    fn a_cell_of_another_type_is_refused() {
        let error = table(&[("n", Type::Bool)], &[&[Cell::F32(1.0)]]).unwrap_err();
        assert_eq!(error.kind(), io::ErrorKind::InvalidData);
    }
}
