//! Named types of schemas.

use serde_json::{Map, Value};

/// Path of the named types in a generated schema.
const DEFINITIONS: &str = "#/$defs/";

/// The named types.
pub(super) struct Types<'a> {
    pub read: &'a Map<String, Value>,
    /// Schemas whose `required` lists all fields, in the order of declaration.
    pub order: &'a Map<String, Value>,
}

impl<'a> Types<'a> {
    /// Resolves a schema's reference; returns the type with its name.
    pub fn resolve(&self, schema: &'a Value) -> (Option<&'a str>, &'a Value) {
        let named = referred(schema).and_then(|name| self.read.get_key_value(name));
        match named {
            Some((name, schema)) => (Some(name), schema),
            None => (None, schema),
        }
    }
}

/// The name of the type to which a schema refers.
pub(super) fn referred(schema: &Value) -> Option<&str> {
    let target = schema.get("$ref")?.as_str()?;
    target.strip_prefix(DEFINITIONS)
}
