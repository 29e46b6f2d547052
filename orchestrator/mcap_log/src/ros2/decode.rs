//! Decoder of the fields of a CDR message.

use tables::Cell;

use super::schema::{Count, Field, Kind, Number};

/// Size of the encapsulation header (bytes).
const ENCAPSULATION: usize = 4;

/// Error of decoding a message.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum DecodeError {
    /// The encapsulation is not plain CDR.
    #[error("encoding {0:02x?} is not plain CDR")]
    Encapsulation([u8; 4]),
    /// The message is too short.
    #[error("the message ends in the middle of `{0}`")]
    Short(String),
    /// Text is not UTF-8.
    #[error("`{0}` is not UTF-8")]
    Text(String),
    /// A length exceeds the message.
    #[error("`{0}` declares more elements than the message has bytes")]
    Count(String),
}

/// Sequential decoder of a message.
#[derive(Debug, Clone, Copy)]
pub struct Cdr<'a> {
    body: &'a [u8],
    at: usize,
    little: bool,
}

impl<'a> Cdr<'a> {
    /// Creates the decoder of a message with its encapsulation header.
    ///
    /// # Errors
    /// The bytes are not a message of this schema: [`DecodeError`].
    pub fn new(bytes: &'a [u8]) -> Result<Self, DecodeError> {
        let short = || DecodeError::Short("the encapsulation header".to_owned());
        let (head, body) = bytes.split_first_chunk::<4>().ok_or_else(short)?;
        let little = match head {
            [0, 1, ..] => true,
            [0, 0, ..] => false,
            _ => return Err(DecodeError::Encapsulation(*head)),
        };
        Ok(Self {
            body,
            at: 0,
            little,
        })
    }

    fn take(&mut self, count: usize, name: &str) -> Result<&'a [u8], DecodeError> {
        let end = self.at.checked_add(count);
        let bytes = end.and_then(|end| self.body.get(self.at..end));
        let bytes = bytes.ok_or_else(|| DecodeError::Short(name.to_owned()))?;
        self.at += count;
        Ok(bytes)
    }

    /// Returns the end of the value that was read last, as offset in the message (bytes).
    pub fn end(&self) -> usize {
        ENCAPSULATION + self.at
    }

    fn align(&mut self, size: usize) {
        self.at = self.at.next_multiple_of(size);
    }

    /// Returns the next number.
    ///
    /// # Errors
    /// The bytes are not a message of this schema: [`DecodeError`].
    pub fn number(&mut self, kind: Number, name: &str) -> Result<Cell, DecodeError> {
        let size = kind.size();
        self.align(size);
        let bytes = self.take(size, name)?;
        let mut word = [0; 8];
        for (to, from) in word.iter_mut().zip(bytes) {
            *to = *from;
        }
        if !self.little
            && let Some(part) = word.get_mut(..size)
        {
            part.reverse();
        }
        let bits = u64::from_le_bytes(word);
        Ok(match kind {
            Number::Bool => Cell::Bool(bits != 0),
            Number::U8 | Number::U16 | Number::U32 | Number::U64 => Cell::UInt(bits),
            Number::I8 => Cell::Int(i64::from(bits as u8 as i8)),
            Number::I16 => Cell::Int(i64::from(bits as u16 as i16)),
            Number::I32 => Cell::Int(i64::from(bits as u32 as i32)),
            Number::I64 => Cell::Int(bits as i64),
            Number::F32 => Cell::F32(f32::from_bits(bits as u32)),
            Number::F64 => Cell::F64(f64::from_bits(bits)),
        })
    }

    /// Returns the next text.
    ///
    /// # Errors
    /// The bytes are not a message of this schema: [`DecodeError`].
    pub fn text(&mut self, name: &str) -> Result<Cell, DecodeError> {
        let Cell::UInt(length) = self.number(Number::U32, name)? else {
            return Ok(Cell::Empty);
        };
        let bytes = self.take(length as usize, name)?;
        let bytes = bytes.strip_suffix(&[0]).unwrap_or(bytes);
        let text = str::from_utf8(bytes).map_err(|_| DecodeError::Text(name.to_owned()))?;
        Ok(Cell::Text(text.to_owned()))
    }

    /// Returns the number of elements of this field that follow; at most as many as the message can contain.
    ///
    /// # Errors
    /// The bytes are not a message of this schema: [`DecodeError`].
    pub fn count(&mut self, field: &Field) -> Result<usize, DecodeError> {
        let count = match field.count {
            Count::One => 1,
            Count::Fixed(count) => count,
            Count::Many => match self.number(Number::U32, &field.name)? {
                Cell::UInt(count) => count as usize,
                _ => 0,
            },
        };
        // An element without fields takes no bytes; no valid message has many of them.
        if count > self.body.len() - self.at.min(self.body.len()) && count > 1 {
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
            Kind::Number(number) => {
                let cell = self.number(*number, name)?;
                visit(name, cell, self.at);
            }
            Kind::Text => {
                let cell = self.text(name)?;
                visit(name, cell, self.at);
            }
            Kind::Message(fields) => {
                for field in fields.iter() {
                    self.field(field, &format!("{name}.{}", field.name), visit)?;
                }
            }
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
            Kind::Number(number) => {
                self.align(number.size());
                self.take(number.size(), name).map(drop)
            }
            Kind::Text => self.text(name).map(drop),
            Kind::Message(fields) => {
                for field in fields.iter() {
                    for _ in 0..self.count(field)? {
                        self.skip(&field.kind, &field.name)?;
                    }
                }
                Ok(())
            }
        }
    }
}

/// Returns the field that contains this byte of an encoded message, and its value.
///
/// # Errors
/// The bytes are not a message of this schema: [`DecodeError`].
pub fn field_at(
    fields: &[Field],
    bytes: &[u8],
    at: usize,
) -> Result<Option<(String, Cell)>, DecodeError> {
    let mut found = None;
    let mut cdr = Cdr::new(bytes)?;
    for field in fields {
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
