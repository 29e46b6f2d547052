//! Parser of ROS 2 message definitions (`ros2msg`).

use std::collections::BTreeMap;
use std::sync::Arc;

/// Maximum nesting of messages.
const MAX_NESTING: usize = 16;
/// Maximum number of fields of a definition, nested messages included.
const MAX_FIELDS: usize = 4096;
/// Maximum length of a definition (bytes).
const MAX_DEFINITION_BYTES: usize = 4 << 20;

/// Error of parsing a schema.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("invalid schema: {0}")]
pub struct SchemaError(pub String);

/// A primitive type of fixed size.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Number {
    /// `bool`
    Bool,
    /// `uint8`, `byte`, `char`
    U8,
    /// `int8`
    I8,
    /// `uint16`
    U16,
    /// `int16`
    I16,
    /// `uint32`
    U32,
    /// `int32`
    I32,
    /// `uint64`
    U64,
    /// `int64`
    I64,
    /// `float32`
    F32,
    /// `float64`
    F64,
}

impl Number {
    /// Returns size and alignment (bytes).
    pub fn size(self) -> usize {
        match self {
            Self::Bool | Self::U8 | Self::I8 => 1,
            Self::U16 | Self::I16 => 2,
            Self::U32 | Self::I32 | Self::F32 => 4,
            Self::U64 | Self::I64 | Self::F64 => 8,
        }
    }

    fn named(name: &str) -> Option<Self> {
        Some(match name {
            "bool" => Self::Bool,
            "uint8" | "byte" | "char" => Self::U8,
            "int8" => Self::I8,
            "uint16" => Self::U16,
            "int16" => Self::I16,
            "uint32" => Self::U32,
            "int32" => Self::I32,
            "uint64" => Self::U64,
            "int64" => Self::I64,
            "float32" => Self::F32,
            "float64" => Self::F64,
            _ => return None,
        })
    }
}

/// Type of a field.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Kind {
    /// A number.
    Number(Number),
    /// A string.
    Text,
    /// A message with these fields.
    Message(Arc<[Field]>),
}

/// Number of elements of a field.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Count {
    /// One.
    One,
    /// An array of this length.
    Fixed(usize),
    /// A sequence, prefixed by its length.
    Many,
}

/// A field.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Field {
    /// Its name.
    pub name: String,
    /// The type of an element.
    pub kind: Kind,
    /// The number of elements.
    pub count: Count,
}

/// A message definition with its nested messages.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Schema {
    /// Fields of the message, in order.
    pub fields: Arc<[Field]>,
}

impl Schema {
    /// Parses a definition: the fields of the message, then those of nested messages, separated by lines of
    /// `=`.
    ///
    /// # Errors
    /// [`SchemaError`] describes the invalid part.
    pub fn parse(text: &[u8]) -> Result<Self, SchemaError> {
        if text.len() > MAX_DEFINITION_BYTES {
            return Err(SchemaError(format!(
                "longer than {MAX_DEFINITION_BYTES} bytes"
            )));
        }
        let text = str::from_utf8(text).map_err(|e| SchemaError(e.to_string()))?;
        let mut sections: Vec<(String, Vec<&str>)> = vec![(String::new(), Vec::new())];
        let mut named = true;
        for line in text.lines() {
            if line.len() >= 3 && line.bytes().all(|b| b == b'=') {
                named = false;
            } else if !named && let Some(name) = line.strip_prefix("MSG:") {
                sections.push((name.trim().to_owned(), Vec::new()));
                named = true;
            } else if let Some((_, lines)) = sections.last_mut() {
                lines.push(line);
            }
        }
        let mut parser = Parser {
            sections: sections
                .iter()
                .map(|(n, l)| (short(n), l.as_slice()))
                .collect(),
            done: BTreeMap::new(),
            fields: 0,
        };
        let root = sections.first().map_or(&[][..], |(_, lines)| lines);
        Ok(Self {
            fields: parser.fields(root, 0)?,
        })
    }
}

struct Parser<'a> {
    sections: BTreeMap<String, &'a [&'a str]>,
    done: BTreeMap<String, (Arc<[Field]>, usize)>,
    /// Number of fields so far, counting every use of a nested message.
    fields: usize,
}

impl Parser<'_> {
    fn fields(&mut self, lines: &[&str], depth: usize) -> Result<Arc<[Field]>, SchemaError> {
        if depth > MAX_NESTING {
            return Err(SchemaError(format!("nested deeper than {MAX_NESTING}")));
        }
        let mut fields = Vec::new();
        for line in lines {
            // The text of a constant may contain a `#`; constants are skipped anyway.
            let line = line.split('#').next().unwrap_or_default().trim();
            let mut words = line.split_whitespace();
            let (Some(kind), Some(name)) = (words.next(), words.next()) else {
                if line.is_empty() {
                    continue;
                }
                return Err(SchemaError(format!("`{line}` is not a field")));
            };
            if name.contains('=') || words.next().is_some_and(|word| word.starts_with('=')) {
                continue;
            }
            self.fields += 1;
            if self.fields > MAX_FIELDS {
                return Err(SchemaError(format!("more than {MAX_FIELDS} fields")));
            }
            let (kind, count) = match kind.strip_suffix(']').and_then(|k| k.split_once('[')) {
                None => (kind, Count::One),
                Some((kind, "")) => (kind, Count::Many),
                Some((kind, bound)) if bound.starts_with("<=") => (kind, Count::Many),
                Some((kind, count)) => {
                    let count = count
                        .parse()
                        .map_err(|_| SchemaError(format!("`{line}`: not a length")))?;
                    (kind, Count::Fixed(count))
                }
            };
            let kind = self.kind(kind, depth)?;
            // The decoder limits the number of elements by the number of bytes, also in nested lists: every
            // element must take at least one byte.
            if count != Count::One && is_zero_size(&kind) {
                let what = format!("`{line}`: a list of messages without fields");
                return Err(SchemaError(what));
            }
            fields.push(Field {
                name: name.to_owned(),
                kind,
                count,
            });
        }
        Ok(fields.into())
    }

    fn kind(&mut self, name: &str, depth: usize) -> Result<Kind, SchemaError> {
        if let Some(number) = Number::named(name) {
            return Ok(Kind::Number(number));
        }
        if name == "string" || name.starts_with("string<=") {
            return Ok(Kind::Text);
        }
        let name = short(name);
        let key = if self.sections.contains_key(&name) || name.contains('/') {
            name.clone()
        } else {
            // A name without package.
            let end = format!("/{name}");
            let found = self.sections.keys().find(|key| key.ends_with(&end));
            found.cloned().unwrap_or_else(|| name.clone())
        };
        if let Some((fields, count)) = self.done.get(&key) {
            self.fields += count;
            return Ok(Kind::Message(Arc::clone(fields)));
        }
        let lines = match self.sections.get(&key) {
            Some(lines) => *lines,
            None if key == "builtin_interfaces/Time" => &["int32 sec", "uint32 nanosec"],
            None if key == "builtin_interfaces/Duration" => &["int32 sec", "uint32 nanosec"],
            None => return Err(SchemaError(format!("the type `{name}` is not defined"))),
        };
        let before = self.fields;
        let fields = self.fields(lines, depth + 1)?;
        self.done
            .insert(key, (Arc::clone(&fields), self.fields - before));
        Ok(Kind::Message(fields))
    }
}

/// Returns `true` if a value takes no bytes.
fn is_zero_size(kind: &Kind) -> bool {
    match kind {
        Kind::Number(_) | Kind::Text => false,
        Kind::Message(fields) => fields
            .iter()
            .all(|field| field.count == Count::Fixed(0) || is_zero_size_field(field)),
    }
}

/// Returns `true` if the field takes no bytes; a sequence has at least its length.
fn is_zero_size_field(field: &Field) -> bool {
    field.count != Count::Many && is_zero_size(&field.kind)
}

/// Shortens `pkg/msg/Name` to `pkg/Name`.
fn short(name: &str) -> String {
    name.replacen("/msg/", "/", 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_of_messages_that_take_no_bytes_are_refused() {
        let nothing = "Nothing[1000] many\n===\nMSG: a/Nothing\n";
        let nested = "A[9] a\n===\nMSG: p/A\nB b\n===\nMSG: p/B\nuint8[0] none\n";
        for text in [nothing, nested] {
            let error = Schema::parse(text.as_bytes()).unwrap_err();
            assert!(
                error.0.contains("a list of messages without fields"),
                "{error}"
            );
        }
        // Sequences with a length and single empty messages are allowed.
        for text in [
            "A[9] a\n===\nMSG: p/A\nuint8[] bytes\n",
            "Nothing one\n===\nMSG: a/Nothing\n",
            "uint8[0] none\n",
        ] {
            assert!(Schema::parse(text.as_bytes()).is_ok(), "{text}");
        }
    }
}
