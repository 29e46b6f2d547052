//! The types that schemas refer to.

use serde_json::{Map, Value};

/// Where a generator keeps the types that have a name.
const DEFINITIONS: &str = "#/$defs/";

/// The types that have a name.
pub(super) struct Types<'a> {
    pub read: &'a Map<String, Value>,
    /// Schemas whose `required` lists all fields, in the order of declaration.
    pub order: &'a Map<String, Value>,
}

impl<'a> Types<'a> {
    /// A schema, or the type that it refers to, with its name.
    pub fn resolve(&self, schema: &'a Value) -> (Option<&'a str>, &'a Value) {
        let named = referred(schema).and_then(|name| self.read.get_key_value(name));
        match named {
            Some((name, schema)) => (Some(name), schema),
            None => (None, schema),
        }
    }
}

/// The name of the type that a schema refers to.
pub(super) fn referred(schema: &Value) -> Option<&str> {
    let target = schema.get("$ref")?.as_str()?;
    target.strip_prefix(DEFINITIONS)
}
