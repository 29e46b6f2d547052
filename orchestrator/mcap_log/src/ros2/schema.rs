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

/// A primitive type.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Primitive {
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
    /// `string`, in UTF-8.
    Text,
    /// `wstring`, in UTF-16.
    WideText,
}

impl Primitive {
    fn named(name: &str) -> Option<Self> {
        Some(match name {
            "bool" => Self::Bool,
            "uint8" | "byte" | "char" | "octet" => Self::U8,
            "int8" => Self::I8,
            "uint16" => Self::U16,
            "int16" => Self::I16,
            "uint32" => Self::U32,
            "int32" => Self::I32,
            "uint64" => Self::U64,
            "int64" => Self::I64,
            "float32" => Self::F32,
            "float64" => Self::F64,
            "string" => Self::Text,
            "wstring" => Self::WideText,
            _ if name.starts_with("string<=") => Self::Text,
            _ if name.starts_with("wstring<=") => Self::WideText,
            _ => return None,
        })
    }
}

/// Type of a field.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Kind {
    /// A number or a text.
    Primitive(Primitive),
    /// A message with these fields.
    Message(Arc<[Field]>),
    /// A message without fields; it takes one byte.
    Nothing,
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
    /// The message: [`Kind::Message`] or [`Kind::Nothing`].
    pub(super) root: Kind,
}

impl Schema {
    /// Parses the definition of the message `name` (`PACKAGE/msg/NAME`): its fields, then those of nested messages,
    /// separated by lines of `=`.
    ///
    /// # Errors
    /// [`SchemaError`] describes the invalid part.
    pub fn parse(name: &str, text: &[u8]) -> Result<Self, SchemaError> {
        if text.len() > MAX_DEFINITION_BYTES {
            return Err(SchemaError(format!(
                "longer than {MAX_DEFINITION_BYTES} bytes"
            )));
        }
        let text = str::from_utf8(text).map_err(|e| SchemaError(e.to_string()))?;
        let mut sections: Vec<(String, Vec<&str>)> = vec![(short(name), Vec::new())];
        let mut named = true;
        for line in text.lines() {
            if line.len() >= 3 && line.bytes().all(|b| b == b'=') {
                named = false;
            } else if !named && let Some(name) = line.strip_prefix("MSG:") {
                sections.push((short(name.trim()), Vec::new()));
                named = true;
            } else if let Some((_, lines)) = sections.last_mut() {
                lines.push(line);
            }
        }
        let root = sections.first().map_or(&[][..], |(_, lines)| lines);
        let nested = sections.iter().skip(1);
        let mut parser = Parser {
            sections: nested.map(|(n, l)| (n.clone(), l.as_slice())).collect(),
            done: BTreeMap::new(),
            fields: 0,
        };
        Ok(Self {
            root: parser.message(&short(name), root, 0)?,
        })
    }

    /// Returns the fields of the message, in order.
    pub fn fields(&self) -> &[Field] {
        match &self.root {
            Kind::Message(fields) => fields,
            Kind::Primitive(_) | Kind::Nothing => &[],
        }
    }
}

struct Parser<'a> {
    sections: BTreeMap<String, &'a [&'a str]>,
    done: BTreeMap<String, (Kind, usize)>,
    /// Number of fields so far, counting every use of a nested message.
    fields: usize,
}

impl Parser<'_> {
    /// Parses the fields of the message `owner`.
    fn message(&mut self, owner: &str, lines: &[&str], depth: usize) -> Result<Kind, SchemaError> {
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
                // The decoder limits the number of elements by the number of bytes, also in nested lists: every
                // element must take at least one byte.
                Some((kind, count)) => match count.parse() {
                    Ok(count) if count > 0 => (kind, Count::Fixed(count)),
                    _ => return Err(SchemaError(format!("`{line}`: not a length above 0"))),
                },
            };
            if fields.iter().any(|field: &Field| field.name == name) {
                return Err(SchemaError(format!(
                    "`{line}`: another field has this name"
                )));
            }
            fields.push(Field {
                name: name.to_owned(),
                kind: self.kind(owner, kind, depth)?,
                count,
            });
        }
        Ok(if fields.is_empty() {
            Kind::Nothing
        } else {
            Kind::Message(fields.into())
        })
    }

    /// Returns the type `name` of a field of the message `owner`.
    fn kind(&mut self, owner: &str, name: &str, depth: usize) -> Result<Kind, SchemaError> {
        if let Some(primitive) = Primitive::named(name) {
            return Ok(Kind::Primitive(primitive));
        }
        let key = self.key(owner, name)?;
        if let Some((kind, count)) = self.done.get(&key) {
            self.fields += count;
            return Ok(kind.clone());
        }
        let lines = match self.sections.get(&key) {
            Some(lines) => *lines,
            None if key == "builtin_interfaces/Time" => &["int32 sec", "uint32 nanosec"],
            None if key == "builtin_interfaces/Duration" => &["int32 sec", "uint32 nanosec"],
            None => return Err(SchemaError(format!("the type `{name}` is not defined"))),
        };
        let before = self.fields;
        let kind = self.message(&key, lines, depth + 1)?;
        self.done.insert(key, (kind.clone(), self.fields - before));
        Ok(kind)
    }

    /// Returns the full name of the message `name` that a field of the message `owner` has: one of the same package, else
    /// the only one of this name.
    fn key(&self, owner: &str, name: &str) -> Result<String, SchemaError> {
        match name {
            "time" => return Ok("builtin_interfaces/Time".to_owned()),
            "duration" => return Ok("builtin_interfaces/Duration".to_owned()),
            name if name.contains('/') => return Ok(short(name)),
            _ => {}
        }
        let package = owner.rsplit_once('/').map_or("", |(package, _)| package);
        let near = format!("{package}/{name}");
        if self.sections.contains_key(&near) {
            return Ok(near);
        }
        let end = format!("/{name}");
        let is_it = |key: &&String| *key == name || key.ends_with(&end);
        let mut found = self.sections.keys().filter(is_it);
        match (found.next(), found.next()) {
            (Some(a), Some(b)) => Err(SchemaError(format!("`{name}` is {a} or {b}"))),
            (found, _) => Ok(found.map_or(near, String::clone)),
        }
    }
}

/// Shortens `pkg/msg/Name` to `pkg/Name`.
fn short(name: &str) -> String {
    name.replacen("/msg/", "/", 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> Result<Schema, SchemaError> {
        Schema::parse("p/msg/T", text.as_bytes())
    }

    #[test]
    fn every_element_takes_a_byte() {
        let error = parse("A[9] a\n===\nMSG: p/A\nuint8[0] none\n").unwrap_err();
        assert!(error.0.contains("not a length above 0"), "{error}");
        let many = parse("Nothing[1000] many\n===\nMSG: p/Nothing\nint8 X=5\n").unwrap();
        assert_eq!(many.fields()[0].kind, Kind::Nothing);
        assert_eq!(parse("# no field\n").unwrap().root, Kind::Nothing);
    }

    #[test]
    fn names_without_package_are_of_the_package_of_their_message() {
        let two = "===\nMSG: a/A\nint8 x\n===\nMSG: b/A\nfloat64 x\n===\nMSG: b/B\nA a\n";
        let field = |schema: &Schema| schema.fields()[0].kind.clone();
        let nested = parse(&format!("b/B b\n{two}")).unwrap();
        let Kind::Message(fields) = field(&nested) else {
            panic!("a message")
        };
        assert_eq!(
            fields[0].kind,
            field(&parse(&format!("b/A a\n{two}")).unwrap())
        );
        let error = parse(&format!("A a\n{two}")).unwrap_err();
        assert!(error.0.contains("`A` is a/A or b/A"), "{error}");
        assert!(parse("Header h\n===\nMSG: std_msgs/Header\ntime stamp\n").is_ok());
    }
}
