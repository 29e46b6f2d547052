//! Messages as JSON, decoded by the schema in the log.

use std::fmt::Write as _;

use mcap_log::reader::{Channel, Schema as LogSchema};
use mcap_log::ros2::{Cdr, Count, DecodeError, Field, Kind, Primitive, Schema, SchemaError};
use tables::Cell;

/// Reason why the messages of a channel cannot be decoded.
#[derive(Debug, thiserror::Error)]
pub enum Undecodable {
    #[error("it has no schema")]
    NoSchema,
    #[error(
        "its encoding is `{messages}` with a schema in `{schema}`; only ROS 2 messages (`cdr` with `ros2msg`) are decoded"
    )]
    Encoding { messages: String, schema: String },
    #[error(transparent)]
    Schema(#[from] SchemaError),
}

/// Returns the schema of a channel with ROS 2 messages.
///
/// # Errors
/// Its messages cannot be decoded.
pub fn schema_of(channel: &Channel, schema: Option<&LogSchema>) -> Result<Schema, Undecodable> {
    let schema = schema.ok_or(Undecodable::NoSchema)?;
    if channel.message_encoding != "cdr" || schema.encoding != "ros2msg" {
        return Err(Undecodable::Encoding {
            messages: channel.message_encoding.clone(),
            schema: schema.encoding.clone(),
        });
    }
    Ok(Schema::parse(&schema.name, &schema.data)?)
}

/// Returns a message as a JSON object, its fields in the order of the schema.
pub fn object(schema: &Schema, message: &[u8]) -> Result<String, DecodeError> {
    let mut text = String::new();
    let mut cdr = Cdr::new(schema, message)?;
    fields(&mut cdr, schema.fields(), &mut text, ByteForm::Text)?;
    Ok(text)
}

/// Form of a byte array within a JSON value.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum ByteForm {
    /// A string as [`bytes`] returns it.
    Text,
    /// An array of numbers.
    Numbers,
}

/// Returns `true` if the elements of a field are bytes.
pub fn is_bytes(field: &Field) -> bool {
    field.count != Count::One && field.kind == Kind::Primitive(Primitive::U8)
}

/// Reads a byte array: as text without trailing zeros, or in hexadecimal if it is not printable text.
pub fn bytes(cdr: &mut Cdr<'_>, field: &Field) -> Result<String, DecodeError> {
    let mut bytes = Vec::new();
    for _ in 0..cdr.count(field)? {
        if let Cell::UInt(byte) = cdr.primitive(Primitive::U8, &field.name)? {
            bytes.push(byte as u8);
        }
    }
    let end = bytes
        .iter()
        .rposition(|&b| b != 0)
        .map_or(0, |last| last + 1);
    let text = bytes
        .get(..end)
        .and_then(|bytes| str::from_utf8(bytes).ok());
    Ok(
        match text.filter(|text| !text.chars().any(char::is_control)) {
            Some(text) => text.to_owned(),
            None => bytes.iter().fold("0x".to_owned(), |mut text, byte| {
                // A write to a String cannot fail.
                let _ = write!(text, "{byte:02x}");
                text
            }),
        },
    )
}

/// Appends a field as JSON, byte arrays as arrays of numbers; numbers that are not finite become null.
pub fn json(cdr: &mut Cdr<'_>, field: &Field, text: &mut String) -> Result<(), DecodeError> {
    value(cdr, field, text, ByteForm::Numbers)
}

fn value(
    cdr: &mut Cdr<'_>,
    field: &Field,
    text: &mut String,
    form: ByteForm,
) -> Result<(), DecodeError> {
    if field.count == Count::One {
        return element(cdr, &field.kind, &field.name, text, form);
    }
    if form == ByteForm::Text && is_bytes(field) {
        text.push_str(&quoted(&bytes(cdr, field)?));
        return Ok(());
    }
    text.push('[');
    for index in 0..cdr.count(field)? {
        if index > 0 {
            text.push(',');
        }
        element(cdr, &field.kind, &field.name, text, form)?;
    }
    text.push(']');
    Ok(())
}

fn element(
    cdr: &mut Cdr<'_>,
    kind: &Kind,
    name: &str,
    text: &mut String,
    form: ByteForm,
) -> Result<(), DecodeError> {
    let cell = match kind {
        Kind::Message(of_message) => return fields(cdr, of_message, text, form),
        Kind::Primitive(primitive) => cdr.primitive(*primitive, name)?,
        Kind::Nothing => {
            text.push_str("{}");
            return cdr.skip(kind, name);
        }
    };
    let not_finite = match &cell {
        Cell::F32(v) => !v.is_finite(),
        Cell::F64(v) => !v.is_finite(),
        _ => false,
    };
    text.push_str(&match cell {
        Cell::Text(cell) => quoted(&cell),
        _ if not_finite => "null".to_owned(),
        cell => cell.to_string(),
    });
    Ok(())
}

fn fields(
    cdr: &mut Cdr<'_>,
    fields: &[Field],
    text: &mut String,
    form: ByteForm,
) -> Result<(), DecodeError> {
    text.push('{');
    for (index, field) in fields.iter().enumerate() {
        if index > 0 {
            text.push(',');
        }
        text.push_str(&quoted(&field.name));
        text.push(':');
        value(cdr, field, text, form)?;
    }
    text.push('}');
    Ok(())
}

/// Returns a JSON string.
pub fn quoted(text: &str) -> String {
    serde_json::Value::from(text).to_string()
}
