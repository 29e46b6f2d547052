//! Check of all values against their ranges.

use ciborium::Value as Data;
use schemars::JsonSchema;
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::{Map, Value};

use crate::error::ParamsError;
use crate::range::{Kind, Range};
use crate::schema;

/// A set of parameters.
pub trait Parameters: Serialize + DeserializeOwned + JsonSchema + 'static {
    /// Checks the relations between fields; each field is within its range already.
    ///
    /// # Errors
    /// [`ParamsError`] naming the field that does not match the others.
    fn check_relations(&self) -> Result<(), ParamsError> {
        Ok(())
    }
}

/// No parameters.
impl Parameters for () {}

/// Checks the range of every field, in the order of declaration, then the relations between fields.
///
/// # Errors
/// [`ParamsError`] with the path, the value and the expected one: the first of [`faults`].
pub fn check<P: Parameters>(params: &P) -> Result<(), ParamsError> {
    match faults(params).into_iter().next() {
        Some(fault) => Err(fault),
        None => Ok(()),
    }
}

/// All fields that are out of their ranges, in the order of declaration; if there is none, the
/// violated relations between fields.
pub fn faults<P: Parameters>(params: &P) -> Vec<ParamsError> {
    let data = match Data::serialized(params) {
        Ok(data) => data,
        Err(error) => return vec![ParamsError::new("", &error, "values that have a text form")],
    };
    let mut found = Vec::new();
    check_value(&data, schema::inline::<P>(), "", &mut found);
    if found.is_empty() {
        found.extend(params.check_relations().err());
    }
    found
}

/// Checks one value against its schema; `path` is its path.
fn check_value(data: &Data, schema: &Value, path: &str, found: &mut Vec<ParamsError>) {
    let Some(schema) = schema.as_object() else {
        return;
    };
    if let Some(branches) = branches(schema) {
        // The value has its type already: one of the branches matches.
        if let Some(branch) = branches.iter().find(|branch| accepts(branch, data)) {
            check_value(data, branch, path, found);
        }
        return;
    }
    match data {
        Data::Integer(n) => {
            found.extend(number(data, &i128::from(*n), Kind::Whole, schema, path));
        }
        Data::Float(x) => found.extend(number(data, x, Kind::Real, schema, path)),
        Data::Array(elements) => {
            let range = Range(schema);
            if !range.contains_length(elements.len()) {
                let length = format!("a list of {}", elements.len());
                found.push(ParamsError::new(path, &length, range.lengths()));
                return;
            }
            for (i, element) in elements.iter().enumerate() {
                let prefix = schema.get("prefixItems").and_then(|items| items.get(i));
                if let Some(schema) = prefix.or_else(|| schema.get("items")) {
                    check_value(element, schema, &format!("{path}[{i}]"), found);
                }
            }
        }
        Data::Map(entries) => {
            for (key, value) in entries {
                let Some(key) = key.as_text() else {
                    continue;
                };
                let known = schema.get("properties").and_then(|p| p.get(key));
                if let Some(schema) = known.or_else(|| schema.get("additionalProperties")) {
                    let dot = if path.is_empty() { "" } else { "." };
                    check_value(value, schema, &format!("{path}{dot}{key}"), found);
                }
            }
        }
        _ => {}
    }
}

fn number(
    data: &Data,
    text: &dyn core::fmt::Display,
    kind: Kind,
    schema: &Map<String, Value>,
    path: &str,
) -> Option<ParamsError> {
    let range = Range(schema);
    let refused = !range.contains(data);
    refused.then(|| ParamsError::new(path, text, range.numbers(kind)))
}

/// The alternatives of a schema that has some.
fn branches(schema: &Map<String, Value>) -> Option<&Vec<Value>> {
    let found = schema.get("oneOf").or_else(|| schema.get("anyOf"))?;
    found.as_array()
}

/// Returns `true` if a value has the type, the keys and the constants of a schema, regardless of
/// ranges.
fn accepts(schema: &Value, data: &Data) -> bool {
    let Some(schema) = schema.as_object() else {
        return true;
    };
    if let Some(branches) = branches(schema) {
        return branches.iter().any(|branch| accepts(branch, data));
    }
    let is_text = |value: &Value| data.as_text().is_some_and(|t| value.as_str() == Some(t));
    if schema.get("const").is_some_and(|value| !is_text(value)) {
        return false;
    }
    let listed = schema.get("enum").and_then(Value::as_array);
    if listed.is_some_and(|values| !values.iter().any(is_text)) {
        return false;
    }
    let has_type = |name: &str| match data {
        Data::Integer(_) => name == "integer" || name == "number",
        Data::Float(_) => name == "number",
        Data::Text(_) => name == "string",
        Data::Bool(_) => name == "boolean",
        Data::Null => name == "null",
        Data::Array(_) => name == "array",
        Data::Map(_) => name == "object",
        _ => false,
    };
    let typed = match schema.get("type") {
        Some(Value::String(name)) => has_type(name),
        Some(Value::Array(names)) => names.iter().filter_map(Value::as_str).any(has_type),
        _ => true,
    };
    typed && data.as_map().is_none_or(|map| accepts_keys(schema, map))
}

fn accepts_keys(schema: &Map<String, Value>, map: &[(Data, Data)]) -> bool {
    let value_of = |key: &str| map.iter().find(|(k, _)| k.as_text() == Some(key));
    let required = schema.get("required").and_then(Value::as_array);
    let complete = required.is_none_or(|keys| {
        let mut keys = keys.iter().filter_map(Value::as_str);
        keys.all(|key| value_of(key).is_some())
    });
    let properties = schema.get("properties").and_then(Value::as_object);
    let open = schema.get("additionalProperties") != Some(&Value::Bool(false));
    complete
        && map.iter().all(|(key, value)| {
            let known = key.as_text().and_then(|key| properties?.get(key));
            known.map_or(open, |schema| accepts(schema, value))
        })
}

#[cfg(test)]
mod tests;
