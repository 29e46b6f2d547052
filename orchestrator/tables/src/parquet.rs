//! Tables as Apache Parquet.

use std::io::{self, Write};
use std::sync::Arc;

use parquet::basic::{Compression, ConvertedType, LogicalType, Repetition, Type as Physical};
use parquet::data_type::{
    BoolType, ByteArray, ByteArrayType, DataType, DoubleType, FloatType, Int64Type,
};
use parquet::errors::ParquetError;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedColumnWriter, SerializedFileWriter};
use parquet::schema::types::Type as Node;

use super::{Cell, Column, Rows, Type};

/// Maximum number of buffered cells; then they are written.
const MAX_CELLS: usize = 1 << 18;

pub struct ParquetRows<W: Write + Send> {
    writer: SerializedFileWriter<W>,
    kinds: Vec<Type>,
    /// Buffered cells, by column.
    cells: Vec<Vec<Cell>>,
    rows: usize,
}

impl<W: Write + Send> ParquetRows<W> {
    pub fn new(file: W, columns: &[Column]) -> io::Result<Self> {
        let schema = || -> Result<Node, ParquetError> {
            let fields: Result<Vec<_>, _> = columns.iter().map(node).collect();
            Node::group_type_builder("messages")
                .with_fields(fields?)
                .build()
        };
        let schema = Arc::new(schema().map_err(io::Error::other)?);
        let properties = WriterProperties::builder()
            .set_compression(Compression::ZSTD(parquet::basic::ZstdLevel::default()))
            .build();
        let writer = SerializedFileWriter::new(file, schema, Arc::new(properties));
        Ok(Self {
            writer: writer.map_err(io::Error::other)?,
            kinds: columns.iter().map(|column| column.kind).collect(),
            cells: vec![Vec::new(); columns.len()],
            rows: 0,
        })
    }

    fn write(&mut self) -> Result<(), ParquetError> {
        if self.rows == 0 {
            return Ok(());
        }
        self.rows = 0;
        let mut group = self.writer.next_row_group()?;
        for (cells, kind) in self.cells.iter_mut().zip(&self.kinds) {
            if let Some(mut column) = group.next_column()? {
                write_column(&mut column, *kind, cells)?;
                column.close()?;
            }
            cells.clear();
        }
        group.close()?;
        Ok(())
    }
}

impl<W: Write + Send> Rows<W> for ParquetRows<W> {
    fn row(&mut self, cells: &[Cell]) -> io::Result<()> {
        for (column, cell) in self.cells.iter_mut().zip(cells) {
            column.push(cell.clone());
        }
        self.rows += 1;
        if self.rows * self.kinds.len() >= MAX_CELLS {
            self.write().map_err(io::Error::other)?;
        }
        Ok(())
    }

    fn finish(mut self: Box<Self>) -> io::Result<W> {
        self.write().map_err(io::Error::other)?;
        self.writer.into_inner().map_err(io::Error::other)
    }
}

fn node(column: &Column) -> Result<Arc<Node>, ParquetError> {
    let physical = match column.kind {
        Type::Bool => Physical::BOOLEAN,
        Type::Int | Type::UInt => Physical::INT64,
        Type::F32 => Physical::FLOAT,
        Type::F64 => Physical::DOUBLE,
        Type::Text => Physical::BYTE_ARRAY,
    };
    let builder =
        Node::primitive_type_builder(&column.name, physical).with_repetition(Repetition::OPTIONAL);
    let builder = match column.kind {
        Type::Text => builder
            .with_converted_type(ConvertedType::UTF8)
            .with_logical_type(Some(LogicalType::String)),
        Type::UInt => builder.with_converted_type(ConvertedType::UINT_64),
        _ => builder,
    };
    Ok(Arc::new(builder.build()?))
}

fn write_column(
    column: &mut SerializedColumnWriter<'_>,
    kind: Type,
    cells: &[Cell],
) -> Result<(), ParquetError> {
    let levels: Vec<i16> = cells
        .iter()
        .map(|cell| i16::from(*cell != Cell::Empty))
        .collect();
    match kind {
        Type::Bool => batch::<BoolType>(column, &levels, cells, |cell| match cell {
            Cell::Bool(v) => Some(*v),
            _ => None,
        }),
        Type::Int | Type::UInt => batch::<Int64Type>(column, &levels, cells, |cell| match cell {
            Cell::Int(v) => Some(*v),
            // The type of the column is unsigned.
            Cell::UInt(v) => Some(v.cast_signed()),
            _ => None,
        }),
        Type::F32 => batch::<FloatType>(column, &levels, cells, |cell| match cell {
            Cell::F32(v) => Some(*v),
            _ => None,
        }),
        Type::F64 => batch::<DoubleType>(column, &levels, cells, |cell| match cell {
            Cell::F64(v) => Some(*v),
            _ => None,
        }),
        Type::Text => batch::<ByteArrayType>(column, &levels, cells, |cell| match cell {
            Cell::Text(v) => Some(ByteArray::from(v.as_bytes().to_vec())),
            _ => None,
        }),
    }
}

fn batch<T: DataType>(
    column: &mut SerializedColumnWriter<'_>,
    levels: &[i16],
    cells: &[Cell],
    value: impl Fn(&Cell) -> Option<T::T>,
) -> Result<(), ParquetError> {
    let values: Vec<T::T> = cells.iter().filter_map(value).collect();
    column
        .typed::<T>()
        .write_batch(&values, Some(levels), None)?;
    Ok(())
}
