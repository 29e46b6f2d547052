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
            // Writing to a String cannot fail.
            let _ = write!(self.text, "{cell}");
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
