//! A `serde` deserializer over [`Node`]s whose errors contain their place.

use std::fmt;
use std::mem::take;
use std::ops::Deref;

use serde::de::value::StrDeserializer;
use serde::de::{
    self, DeserializeSeed, EnumAccess, Error as _, Expected, IntoDeserializer, MapAccess,
    SeqAccess, Unexpected, VariantAccess, Visitor,
};
use serde::forward_to_deserialize_any;
use thiserror::Error;

use super::node::{Entry, Node, Value};
use super::path::{FieldPath, Step};
use super::source::Origin;

/// Reason why a value cannot be read into its type.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum ReadFault {
    /// The table has a key that the type does not define.
    UnknownKey {
        /// The key.
        key: String,
        /// The keys of the type.
        known: Vec<String>,
    },
    /// A word that is not one of the choices.
    UnknownChoice {
        /// The word.
        found: String,
        /// The choices.
        known: Vec<String>,
    },
    /// A required key is missing.
    Missing {
        /// The key.
        key: String,
    },
    /// A value of the wrong type.
    Type {
        /// Name of the type found.
        found: String,
        /// Name of the type expected.
        expected: String,
    },
    /// A value of the right type that is out of range.
    Range {
        /// Description of the allowed values.
        expected: String,
    },
    /// Any other error of the type.
    Other(String),
}

/// A [`ReadFault`] and its place.
#[derive(Debug, Clone, PartialEq, Error)]
#[error("{}: {:?}", .0.path, .0.fault)]
pub struct ReadError(Box<ReadProblem>);

/// Contents of a [`ReadError`].
#[derive(Debug, Clone, PartialEq)]
pub struct ReadProblem {
    /// Path of the value, relative to the node that was read.
    pub path: FieldPath,
    /// Place of the value in the text.
    pub origin: Origin,
    /// The value, shortened, if there is one.
    pub value: Option<String>,
    /// Reason.
    pub fault: ReadFault,
    located: bool,
}

impl Deref for ReadError {
    type Target = ReadProblem;

    fn deref(&self) -> &ReadProblem {
        &self.0
    }
}

impl ReadError {
    /// Creates an error about the node that was read.
    pub fn new(fault: ReadFault) -> Self {
        Self(Box::new(ReadProblem {
            path: FieldPath::default(),
            origin: Origin::Implied,
            value: None,
            fault,
            located: false,
        }))
    }

    /// Sets the place of an error that has none: the node, or the entry of the node that the error names.
    fn at(mut self, node: &Node) -> Self {
        let ReadProblem {
            path,
            origin,
            value,
            fault,
            located,
        } = &mut *self.0;
        if *located {
            return self;
        }
        *located = true;
        *origin = node.origin;
        match fault {
            ReadFault::UnknownKey { key, .. } => {
                path.0.push(Step::Key(key.clone()));
                if let Some(entry) = node.as_table().and_then(|t| t.entry(key)) {
                    *origin = entry.origin;
                    *value = Some(entry.node.render_short());
                }
            }
            ReadFault::Missing { key } => path.0.push(Step::Key(key.clone())),
            ReadFault::Type { found, .. } => {
                node.type_name().clone_into(found);
                *value = Some(node.render_short());
            }
            _ => *value = Some(node.render_short()),
        }
        self
    }

    /// Sets the place of an error about a key of a table.
    fn at_key(mut self, entry: &Entry) -> Self {
        let ReadProblem {
            path,
            origin,
            value,
            fault,
            located,
        } = &mut *self.0;
        if *located {
            return self;
        }
        *located = true;
        *origin = entry.origin;
        *value = Some(entry.node.render_short());
        path.0.push(Step::Key(entry.key.clone()));
        if let ReadFault::UnknownChoice { found, known } = fault {
            *fault = ReadFault::UnknownKey {
                key: take(found),
                known: take(known),
            };
        }
        self
    }

    fn under(mut self, step: Step) -> Self {
        self.0.path.0.insert(0, step);
        self
    }
}

impl de::Error for ReadError {
    fn custom<T: fmt::Display>(message: T) -> Self {
        Self::new(ReadFault::Other(message.to_string()))
    }

    fn invalid_type(_: Unexpected<'_>, expected: &dyn Expected) -> Self {
        let expected = readable(&expected.to_string());
        Self::new(ReadFault::Type {
            found: String::new(),
            expected,
        })
    }

    fn invalid_value(_: Unexpected<'_>, expected: &dyn Expected) -> Self {
        Self::new(ReadFault::Range {
            expected: readable(&expected.to_string()),
        })
    }

    fn invalid_length(_: usize, expected: &dyn Expected) -> Self {
        Self::new(ReadFault::Range {
            expected: readable(&expected.to_string()),
        })
    }

    fn unknown_variant(found: &str, known: &'static [&'static str]) -> Self {
        Self::new(ReadFault::UnknownChoice {
            found: found.to_owned(),
            known: owned(known),
        })
    }

    fn unknown_field(key: &str, known: &'static [&'static str]) -> Self {
        Self::new(ReadFault::UnknownKey {
            key: key.to_owned(),
            known: owned(known),
        })
    }

    fn missing_field(key: &'static str) -> Self {
        Self::new(ReadFault::Missing {
            key: key.to_owned(),
        })
    }

    fn duplicate_field(key: &'static str) -> Self {
        Self::new(ReadFault::Other(format!("duplicate key `{key}`")))
    }
}

fn owned(list: &[&str]) -> Vec<String> {
    list.iter().map(|&s| s.to_owned()).collect()
}

/// Translates the types that `serde` expects into terms of TOML.
fn readable(expected: &str) -> String {
    match expected {
        "f64" | "f32" => "a number",
        "u64" | "usize" | "u128" => "a whole number, 0 or more",
        "u8" => "a whole number from 0 to 255",
        "u16" => "a whole number from 0 to 65535",
        "u32" => "a whole number from 0 to 4294967295",
        "a nonzero u64" | "a nonzero u32" | "a nonzero usize" => "a whole number, 1 or more",
        "i8" | "i16" | "i32" | "i64" | "isize" => "a whole number",
        "a boolean" => "true or false",
        "a string" | "string" | "str" => "text in quotes",
        "a map" => "a table",
        "a sequence" => "an array",
        other => {
            if other.starts_with("struct ") || other.starts_with("internally tagged enum") {
                "a table"
            } else if let Some(count) = other
                .strip_prefix("an array of length ")
                .or(other.strip_prefix("a tuple of size "))
            {
                return format!("an array of {count} values");
            } else {
                return other.to_owned();
            }
        }
    }
    .to_owned()
}

impl IntoDeserializer<'_, ReadError> for &Node {
    type Deserializer = NodeReader<Self>;

    fn into_deserializer(self) -> Self::Deserializer {
        NodeReader(self)
    }
}

/// Deserializer of one node.
pub struct NodeReader<N>(pub N);

impl<'de> de::Deserializer<'de> for NodeReader<&Node> {
    type Error = ReadError;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, ReadError> {
        let node = self.0;
        match &node.value {
            Value::Bool(v) => visitor.visit_bool(*v),
            Value::Int(v) => visitor.visit_i64(*v),
            // Every quantity of a scenario is finite; NaN would pass range checks.
            Value::Float(v) if !v.is_finite() => Err(ReadError::new(ReadFault::Range {
                expected: "a finite number".to_owned(),
            })),
            Value::Float(v) => visitor.visit_f64(*v),
            Value::Str(v) | Value::Datetime(v) => visitor.visit_str(v),
            Value::Array(list) => {
                let mut access = Elements { list, next: 0 };
                visitor
                    .visit_seq(&mut access)
                    .and_then(|value| match list.len() - access.next {
                        0 => Ok(value),
                        _ => Err(ReadError::new(ReadFault::Range {
                            expected: format!("an array of {} values", access.next),
                        })),
                    })
            }
            Value::Table(table) => visitor.visit_map(Entries {
                rest: table.entries.iter(),
                current: None,
            }),
        }
        .map_err(|e| e.at(node))
    }

    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, ReadError> {
        let node = self.0;
        visitor.visit_some(self).map_err(|e| e.at(node))
    }

    fn deserialize_newtype_struct<V: Visitor<'de>>(
        self,
        _name: &'static str,
        visitor: V,
    ) -> Result<V::Value, ReadError> {
        let node = self.0;
        visitor.visit_newtype_struct(self).map_err(|e| e.at(node))
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        _name: &'static str,
        variants: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, ReadError> {
        let node = self.0;
        match &node.value {
            Value::Str(text) => visitor.visit_enum(StrDeserializer::new(text)),
            Value::Table(table) => match table.entries.as_slice() {
                [entry] => visitor.visit_enum(Variant { entry }),
                _ => Err(ReadError::new(ReadFault::Range {
                    expected: format!(
                        "a table with one key: {}",
                        super::suggest::list_choices(variants)
                    ),
                })),
            },
            _ => Err(ReadError::new(ReadFault::Type {
                found: String::new(),
                expected: super::suggest::list_choices(variants),
            })),
        }
        .map_err(|e| e.at(node))
    }

    fn deserialize_ignored_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, ReadError> {
        visitor.visit_unit()
    }

    /// Parameters of a kind without any: an empty table.
    fn deserialize_unit<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, ReadError> {
        match &self.0.value {
            Value::Table(table) if table.entries.is_empty() => visitor.visit_unit(),
            _ => self.deserialize_any(visitor),
        }
    }

    forward_to_deserialize_any! {
        bool i8 i16 i32 i64 i128 u8 u16 u32 u64 u128 f32 f64 char str string bytes byte_buf
        unit_struct seq tuple tuple_struct map struct identifier
    }
}

struct Elements<'a> {
    list: &'a [Node],
    next: usize,
}

impl<'de> SeqAccess<'de> for &mut Elements<'_> {
    type Error = ReadError;

    fn next_element_seed<T: DeserializeSeed<'de>>(
        &mut self,
        seed: T,
    ) -> Result<Option<T::Value>, ReadError> {
        let Some(node) = self.list.get(self.next) else {
            return Ok(None);
        };
        let index = self.next;
        self.next += 1;
        seed.deserialize(NodeReader(node))
            .map(Some)
            .map_err(|e| e.at(node).under(node.element_step(index)))
    }

    fn size_hint(&self) -> Option<usize> {
        Some(self.list.len() - self.next)
    }
}

struct Entries<'a> {
    rest: std::slice::Iter<'a, Entry>,
    current: Option<&'a Entry>,
}

impl<'de> MapAccess<'de> for Entries<'_> {
    type Error = ReadError;

    fn next_key_seed<K: DeserializeSeed<'de>>(
        &mut self,
        seed: K,
    ) -> Result<Option<K::Value>, ReadError> {
        self.current = self.rest.next();
        let Some(entry) = self.current else {
            return Ok(None);
        };
        seed.deserialize(StrDeserializer::new(&entry.key))
            .map(Some)
            .map_err(|e: ReadError| e.at_key(entry))
    }

    fn next_value_seed<V: DeserializeSeed<'de>>(&mut self, seed: V) -> Result<V::Value, ReadError> {
        let entry = self
            .current
            .ok_or_else(|| ReadError::custom("value requested before its key"))?;
        seed.deserialize(NodeReader(&entry.node))
            .map_err(|e| e.at(&entry.node).under(Step::Key(entry.key.clone())))
    }
}

/// `{ variant = content }`.
struct Variant<'a> {
    entry: &'a Entry,
}

impl<'de, 'a> EnumAccess<'de> for Variant<'a> {
    type Error = ReadError;
    type Variant = NodeReader<&'a Entry>;

    fn variant_seed<V: DeserializeSeed<'de>>(
        self,
        seed: V,
    ) -> Result<(V::Value, Self::Variant), ReadError> {
        let variant = seed
            .deserialize(StrDeserializer::new(&self.entry.key))
            .map_err(|e: ReadError| e.at_key(self.entry))?;
        Ok((variant, NodeReader(self.entry)))
    }
}

impl<'de> VariantAccess<'de> for NodeReader<&Entry> {
    type Error = ReadError;

    fn unit_variant(self) -> Result<(), ReadError> {
        match self.0.node.as_table() {
            Some(table) if table.entries.is_empty() => Ok(()),
            _ => Err(ReadError::new(ReadFault::Range {
                expected: "a variant without contents".to_owned(),
            })
            .at_key(self.0)),
        }
    }

    fn newtype_variant_seed<T: DeserializeSeed<'de>>(self, seed: T) -> Result<T::Value, ReadError> {
        let entry = self.0;
        seed.deserialize(NodeReader(&entry.node))
            .map_err(|e| e.at(&entry.node).under(Step::Key(entry.key.clone())))
    }

    fn tuple_variant<V: Visitor<'de>>(self, _: usize, visitor: V) -> Result<V::Value, ReadError> {
        let entry = self.0;
        de::Deserializer::deserialize_any(NodeReader(&entry.node), visitor)
            .map_err(|e| e.under(Step::Key(entry.key.clone())))
    }

    fn struct_variant<V: Visitor<'de>>(
        self,
        _: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, ReadError> {
        self.tuple_variant(0, visitor)
    }
}
