//! Decoder of the fields of a CDR message.

use tables::Cell;

use super::schema::{Count, Field, Kind, Primitive, Schema};

/// Size of the encapsulation header (bytes).
const ENCAPSULATION: usize = 4;
/// Maximum number of bytes after the last field: writers fill up the last word.
const MAX_PADDING: usize = 3;

/// Error of decoding a message.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum DecodeError {
    /// The encapsulation is not plain CDR.
    #[error("{} is not decoded, only plain CDR", encoding(*.0))]
    Encapsulation([u8; 4]),
    /// The message is too short.
    #[error("the message ends in the middle of `{0}`")]
    Short(String),
    /// Text is not UTF-8, or wide text not UTF-16.
    #[error("`{0}` is not Unicode text")]
    Text(String),
    /// A length exceeds the message.
    #[error("`{0}` declares more elements than the message has bytes")]
    Count(String),
    /// The message is longer than its fields.
    #[error("{0} bytes are left after the last field: the schema is not that of the message")]
    Left(usize),
}

/// Returns the name of the encoding that an encapsulation header states.
fn encoding(head: [u8; 4]) -> String {
    match head {
        [0, 2 | 3, ..] => "PL_CDR (a list of parameters)".to_owned(),
        [0, 6..=11 | 16..=21, ..] => "XCDR2 (version 2 of CDR)".to_owned(),
        head => format!("the encoding {head:02x?}"),
    }
}

/// Decoder of a message that fits its schema.
#[derive(Debug, Clone, Copy)]
pub struct Cdr<'a> {
    body: &'a [u8],
    at: usize,
    little: bool,
    /// Type of the units of wide text.
    unit: Primitive,
}

impl<'a> Cdr<'a> {
    /// Creates the decoder of a message with its encapsulation header, after a check that its fields take all of its bytes.
    ///
    /// # Errors
    /// The bytes are not a message of this schema: [`DecodeError`].
    pub fn new(schema: &Schema, bytes: &'a [u8]) -> Result<Self, DecodeError> {
        let short = || DecodeError::Short("the encapsulation header".to_owned());
        let (head, body) = bytes.split_first_chunk::<4>().ok_or_else(short)?;
        let little = match head {
            [0, 1, ..] => true,
            [0, 0, ..] => false,
            _ => return Err(DecodeError::Encapsulation(*head)),
        };
        let with = |unit| {
            let cdr = Self {
                body,
                at: 0,
                little,
                unit,
            };
            let mut end = cdr;
            end.skip(&schema.root, "the message")?;
            match end.left() {
                0..=MAX_PADDING => Ok(cdr),
                left => Err(DecodeError::Left(left)),
            }
        };
        // ROS 2 writes a unit of UTF-16 in 32 bits, other programs in 16; only one of both takes all bytes.
        with(Primitive::U32).or_else(|error| with(Primitive::U16).map_err(|_| error))
    }

    /// Returns the number of bytes that have not been read.
    fn left(&self) -> usize {
        self.body.len().saturating_sub(self.at)
    }

    fn take(&mut self, count: usize, name: &str) -> Result<&'a [u8], DecodeError> {
        let end = self.at.checked_add(count);
        let bytes = end.and_then(|end| self.body.get(self.at..end));
        let bytes = bytes.ok_or_else(|| DecodeError::Short(name.to_owned()))?;
        self.at += count;
        Ok(bytes)
    }

    /// Returns the bits of the next number of `N` bytes.
    fn bits<const N: usize>(&mut self, name: &str) -> Result<u64, DecodeError> {
        self.at = self.at.next_multiple_of(N);
        let bytes = self.take(N, name)?.iter();
        let joined = |bits, byte: &u8| bits << 8 | u64::from(*byte);
        Ok(if self.little {
            bytes.rev().fold(0, joined)
        } else {
            bytes.fold(0, joined)
        })
    }

    /// Returns the next number or text.
    ///
    /// # Errors
    /// The bytes are not a message of this schema: [`DecodeError`].
    pub fn primitive(&mut self, kind: Primitive, name: &str) -> Result<Cell, DecodeError> {
        Ok(match kind {
            Primitive::Bool => Cell::Bool(self.bits::<1>(name)? != 0),
            Primitive::U8 => Cell::UInt(self.bits::<1>(name)?),
            Primitive::U16 => Cell::UInt(self.bits::<2>(name)?),
            Primitive::U32 => Cell::UInt(self.bits::<4>(name)?),
            Primitive::U64 => Cell::UInt(self.bits::<8>(name)?),
            Primitive::I8 => Cell::Int(i64::from(self.bits::<1>(name)? as u8 as i8)),
            Primitive::I16 => Cell::Int(i64::from(self.bits::<2>(name)? as u16 as i16)),
            Primitive::I32 => Cell::Int(i64::from(self.bits::<4>(name)? as u32 as i32)),
            Primitive::I64 => Cell::Int(self.bits::<8>(name)? as i64),
            Primitive::F32 => Cell::F32(f32::from_bits(self.bits::<4>(name)? as u32)),
            Primitive::F64 => Cell::F64(f64::from_bits(self.bits::<8>(name)?)),
            Primitive::Text => Cell::Text(self.text(name)?.to_owned()),
            Primitive::WideText => Cell::Text(self.wide_text(name)?),
        })
    }

    fn text(&mut self, name: &str) -> Result<&'a str, DecodeError> {
        let length = self.bits::<4>(name)?;
        let bytes = self.take(length as usize, name)?;
        let bytes = bytes.strip_suffix(&[0]).unwrap_or(bytes);
        str::from_utf8(bytes).map_err(|_| DecodeError::Text(name.to_owned()))
    }

    fn wide_text(&mut self, name: &str) -> Result<String, DecodeError> {
        let mut units = Vec::new();
        let invalid = || DecodeError::Text(name.to_owned());
        for _ in 0..self.bits::<4>(name)? {
            let unit = match self.unit {
                Primitive::U16 => self.bits::<2>(name)?,
                _ => self.bits::<4>(name)?,
            };
            units.push(u16::try_from(unit).map_err(|_| invalid())?);
        }
        let units = units.strip_suffix(&[0]).unwrap_or(&units);
        String::from_utf16(units).map_err(|_| invalid())
    }

    /// Returns the number of elements of this field that follow; at most as many as the message can contain.
    ///
    /// # Errors
    /// The bytes are not a message of this schema: [`DecodeError`].
    pub fn count(&mut self, field: &Field) -> Result<usize, DecodeError> {
        let count = match field.count {
            Count::One => return Ok(1),
            Count::Fixed(count) => count,
            Count::Many => self.bits::<4>(&field.name)? as usize,
        };
        // Every element takes at least one byte.
        if count > self.left() {
            return Err(DecodeError::Count(field.name.clone()));
        }
        Ok(count)
    }

    /// Visits every value of one element of a field, with its name and end offset (bytes).
    ///
    /// # Errors
    /// The bytes are not a message of this schema: [`DecodeError`].
    pub fn element(
        &mut self,
        kind: &Kind,
        name: &str,
        visit: &mut dyn FnMut(&str, Cell, usize),
    ) -> Result<(), DecodeError> {
        match kind {
            Kind::Primitive(primitive) => {
                let cell = self.primitive(*primitive, name)?;
                visit(name, cell, self.at);
            }
            Kind::Message(fields) => {
                for field in fields.iter() {
                    self.field(field, &format!("{name}.{}", field.name), visit)?;
                }
            }
            Kind::Nothing => self.skip(kind, name)?,
        }
        Ok(())
    }

    /// Visits every value of a field, with its name, such as `robots[3].x`, and end offset (bytes).
    ///
    /// # Errors
    /// The bytes are not a message of this schema: [`DecodeError`].
    pub fn field(
        &mut self,
        field: &Field,
        name: &str,
        visit: &mut dyn FnMut(&str, Cell, usize),
    ) -> Result<(), DecodeError> {
        if field.count == Count::One {
            return self.element(&field.kind, name, visit);
        }
        for index in 0..self.count(field)? {
            self.element(&field.kind, &format!("{name}[{index}]"), visit)?;
        }
        Ok(())
    }

    /// Skips one element.
    ///
    /// # Errors
    /// The bytes are not a message of this schema: [`DecodeError`].
    pub fn skip(&mut self, kind: &Kind, name: &str) -> Result<(), DecodeError> {
        match kind {
            Kind::Primitive(Primitive::Text) => self.text(name).map(drop),
            Kind::Primitive(primitive) => self.primitive(*primitive, name).map(drop),
            Kind::Message(fields) => {
                for field in fields.iter() {
                    for _ in 0..self.count(field)? {
                        self.skip(&field.kind, &field.name)?;
                    }
                }
                Ok(())
            }
            Kind::Nothing => self.take(1, name).map(drop),
        }
    }
}

/// Returns the field that contains this byte of an encoded message, and its value.
///
/// # Errors
/// The bytes are not a message of this schema: [`DecodeError`].
pub fn field_at(
    schema: &Schema,
    bytes: &[u8],
    at: usize,
) -> Result<Option<(String, Cell)>, DecodeError> {
    let mut found = None;
    let mut cdr = Cdr::new(schema, bytes)?;
    for field in schema.fields() {
        cdr.field(field, &field.name, &mut |name, cell, end| {
            if found.is_none() && end + ENCAPSULATION > at {
                found = Some((name.to_owned(), cell));
            }
        })?;
        if found.is_some() {
            break;
        }
    }
    Ok(found)
}
