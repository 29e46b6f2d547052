//! Check of all values against their ranges.

use core::fmt;

use ciborium::Value as Data;
use schemars::JsonSchema;
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::{Map, Value};

use crate::error::ParamsError;
use crate::range::{Kind, Range, plain};
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
    visit(
        &data,
        schema::inline::<P>(),
        "",
        &mut |data, schema, path| {
            let fault = fault(data, schema, path);
            let is_valid = fault.is_none();
            found.extend(fault);
            is_valid
        },
    );
    if found.is_empty() {
        found.extend(params.check_relations().err());
    }
    found
}

/// An angle, or a rate of angles, of an accepted size that suggests degrees.
#[derive(Debug, Clone, PartialEq)]
pub struct Unusual {
    /// Path of the parameter inside its table.
    pub field: String,
    /// Its value.
    pub value: f64,
    /// The usual maximum magnitude.
    pub usual: f64,
    /// Unit of both.
    pub unit: &'static str,
}

impl fmt::Display for Unusual {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            field,
            value,
            usual,
            unit,
        } = self;
        let (usual, radians) = (plain(&Value::from(*usual)), value.to_radians());
        write!(
            f,
            "`{field}` is {value} {unit}, usually at most {usual}; {value}° are {radians:.3} rad"
        )
    }
}

/// All angles and rates of angles beyond their usual magnitude, in the order of declaration.
pub fn unusual<P: Parameters>(params: &P) -> Vec<Unusual> {
    let mut found = Vec::new();
    // Values without a text form are faults.
    let data = Data::serialized(params).unwrap_or(Data::Null);
    visit(
        &data,
        schema::inline::<P>(),
        "",
        &mut |data, schema, path| {
            let (value, unit) = (data.as_float(), Range(schema).unit());
            if let (Some(value), Some(unit), Some(usual)) =
                (value, unit, Range(schema).usual_angle())
                && value.abs() > usual
            {
                let field = path.to_owned();
                found.push(Unusual {
                    field,
                    value,
                    usual,
                    unit,
                });
            }
            true
        },
    );
    found
}

/// Receives a number or a list with its schema and its path; returns `false` to leave out the elements of the list.
type Visitor<'a> = dyn FnMut(&Data, &'static Map<String, Value>, &str) -> bool + 'a;

/// Calls a visitor for each number and each list of a value.
fn visit(data: &Data, schema: &'static Value, path: &str, visitor: &mut Visitor<'_>) {
    let Some(schema) = schema.as_object() else {
        return;
    };
    if let Some(branches) = branches(schema) {
        // The value has its type already: one of the branches matches.
        if let Some(branch) = branches.iter().find(|branch| accepts(branch, data)) {
            visit(data, branch, path, visitor);
        }
        return;
    }
    match data {
        Data::Integer(_) | Data::Float(_) => {
            visitor(data, schema, path);
        }
        Data::Array(elements) => {
            if !visitor(data, schema, path) {
                return;
            }
            for (i, element) in elements.iter().enumerate() {
                let prefix = schema.get("prefixItems").and_then(|items| items.get(i));
                if let Some(schema) = prefix.or_else(|| schema.get("items")) {
                    visit(element, schema, &format!("{path}[{i}]"), visitor);
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
                    visit(value, schema, &format!("{path}{dot}{key}"), visitor);
                }
            }
        }
        _ => {}
    }
}

/// Returns the fault of a number, or of the length of a list.
fn fault(data: &Data, schema: &Map<String, Value>, path: &str) -> Option<ParamsError> {
    let range = Range(schema);
    let error = |found: String, expected| Some(ParamsError::new(path, &found, expected));
    match data {
        Data::Integer(n) if !range.contains(data) => {
            error(i128::from(*n).to_string(), range.numbers(Kind::Whole))
        }
        Data::Float(x) if !range.contains(data) => error(x.to_string(), range.numbers(Kind::Real)),
        Data::Array(elements) if !range.contains_length(elements.len()) => {
            error(format!("a list of {}", elements.len()), range.lengths())
        }
        _ => None,
    }
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
