//! Tables as CSV.

use std::fmt::Write as _;
use std::io::{self, BufWriter, Write};

use super::{Cell, Column, Rows};

pub struct CsvRows<W: Write> {
    writer: csv::Writer<BufWriter<W>>,
    /// Buffer for the text of a cell.
    text: String,
}

impl<W: Write> CsvRows<W> {
    pub fn new(file: W, columns: &[Column]) -> io::Result<Self> {
        let mut writer = csv::Writer::from_writer(BufWriter::new(file));
        writer.write_record(columns.iter().map(|column| &column.name))?;
        Ok(Self {
            writer,
            text: String::new(),
        })
    }
}

impl<W: Write> Rows<W> for CsvRows<W> {
    fn row(&mut self, cells: &[Cell]) -> io::Result<()> {
        for cell in cells {
            self.text.clear();
            let infinity = match cell {
                Cell::F32(v) if v.is_infinite() => Some(f64::from(*v)),
                Cell::F64(v) if v.is_infinite() => Some(*v),
                _ => None,
            };
            // Writing to a String cannot fail. A number beyond the largest one is infinite for every reader; DuckDB takes
            // `inf` for a date, and polars other words for texts.
            let _ = match infinity {
                Some(v) => write!(self.text, "{}1e999", if v < 0.0 { "-" } else { "" }),
                None => write!(self.text, "{cell}"),
            };
            self.writer.write_field(&self.text)?;
        }
        self.writer.write_record(None::<&[u8]>)?;
        Ok(())
    }

    fn finish(self: Box<Self>) -> io::Result<W> {
        let buffer = self
            .writer
            .into_inner()
            .map_err(csv::IntoInnerError::into_error)?;
        buffer.into_inner().map_err(io::IntoInnerError::into_error)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::Type;

    /// Returns the text of a cell.
    fn written(cell: Cell) -> String {
        let mut rows = Box::new(CsvRows::new(Vec::new(), &[Column::new("x", Type::F64)]).unwrap());
        rows.row(&[cell]).unwrap();
        let text = String::from_utf8(rows.finish().unwrap()).unwrap();
        text.lines().nth(1).unwrap().to_owned()
    }

    proptest! {
        #[test]
        fn a_floating_point_number_is_written_as_one_and_keeps_its_bits(bits: u64, whole: i32) {
            for value in [f64::from_bits(bits), f64::from(whole), f64::INFINITY, -f64::INFINITY] {
                let (long, short) = (written(Cell::F64(value)), written(Cell::F32(value as f32)));
                if value.is_nan() {
                    prop_assert_eq!([&*long, &*short], ["NaN"; 2]);
                    continue;
                }
                prop_assert_eq!(long.parse::<f64>().unwrap().to_bits(), value.to_bits());
                let read: f32 = short.parse().unwrap();
                prop_assert_eq!(read.to_bits(), (value as f32).to_bits());
                for text in [long, short] {
                    prop_assert!(text.contains(['.', 'e']), "{}", text);
                }
            }
        }
    }
}
