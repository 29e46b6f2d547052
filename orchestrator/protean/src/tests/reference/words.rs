//! Schemas in words.

use parameters::plain_text;
use serde_json::{Map, Value};

use super::types::Types;

/// The alternatives of a schema with the names of their types, without `null`; the schema
/// itself, if it has none.
pub(super) fn alternatives<'a>(
    types: &Types<'a>,
    schema: &'a Value,
) -> Vec<(Option<&'a str>, &'a Value)> {
    let (name, own) = types.resolve(schema);
    let Some(all) = own.get("anyOf").and_then(Value::as_array) else {
        return vec![(name, own)];
    };
    let null = Value::from("null");
    let others = all.iter().filter(|one| one.get("type") != Some(&null));
    others.flat_map(|one| alternatives(types, one)).collect()
}

/// The types of a schema, without `null`.
pub(super) fn types(schema: &Value) -> Vec<&str> {
    match schema.get("type") {
        Some(Value::String(name)) => vec![name],
        Some(Value::Array(names)) => names
            .iter()
            .filter_map(Value::as_str)
            .filter(|name| *name != "null")
            .collect(),
        _ => Vec::new(),
    }
}

/// The keys of a table.
pub(super) fn properties_of(schema: &Value) -> Option<&Map<String, Value>> {
    schema.get("properties")?.as_object()
}

/// Returns `true` if a type is a table, or a choice with tables.
pub(super) fn is_table<'a>(types: &Types<'a>, schema: &'a Value) -> bool {
    let has_keys = |table: &'a Value| properties_of(types.resolve(table).1).is_some();
    has_keys(schema)
        || choice_tables(schema)
            .iter()
            .any(|choice| has_keys(choice.value))
}

/// The schema of the numbers of a value that is a number or a list of numbers.
pub(super) fn numbers_of(schema: &Value) -> Option<&Map<String, Value>> {
    match types(schema).first() {
        Some(&("number" | "integer")) => schema.as_object(),
        Some(&"array") => numbers_of(schema.get("items")?),
        _ => None,
    }
}

/// The name of a type.
pub(super) fn type_name<'a>(defined: &Types<'a>, schema: &'a Value) -> String {
    if let Some(choices) = choices(schema) {
        let names: Vec<String> = choices
            .iter()
            .map(|(name, _)| format!("`{name}`"))
            .collect();
        return names.join(", ");
    }
    if let Some(name) = schema.get("const").and_then(Value::as_str) {
        return format!("`{name}`");
    }
    match types(schema).first() {
        Some(&"number") => "number".to_owned(),
        Some(&"integer") => "whole number".to_owned(),
        Some(&"boolean") => "true or false".to_owned(),
        Some(&"string") => "text".to_owned(),
        Some(&"array") => match schema.get("items") {
            Some(items) => {
                let items = alternatives(defined, items).into_iter();
                let names: Vec<String> = items
                    .map(|(_, item)| plural(&type_name(defined, item)))
                    .collect();
                format!("list of {}", names.join(" or "))
            }
            None => "list".to_owned(),
        },
        Some(&"object") => "table".to_owned(),
        _ => "any".to_owned(),
    }
}

fn plural(name: &str) -> String {
    match name {
        "true or false" | "text" => name.to_owned(),
        _ if name.starts_with('`') => name.to_owned(),
        _ if name.starts_with("list of") => name.replacen("list", "lists", 1),
        _ => format!("{name}s"),
    }
}

/// The names of a choice with their descriptions.
pub(super) fn choices(schema: &Value) -> Option<Vec<(&str, &str)>> {
    if let Some(names) = schema.get("enum").and_then(Value::as_array) {
        let names = names.iter().filter_map(Value::as_str);
        return Some(names.map(|name| (name, "")).collect());
    }
    let branches = schema.get("oneOf").and_then(Value::as_array)?;
    let mut found = Vec::new();
    for branch in branches {
        let text = branch.get("description").and_then(Value::as_str);
        let text = text.unwrap_or_default();
        if let Some(name) = branch.get("const").and_then(Value::as_str) {
            found.push((name, text));
        } else if let Some(names) = branch.get("enum").and_then(Value::as_array) {
            found.extend(names.iter().filter_map(Value::as_str).map(|n| (n, "")));
        } else {
            let keys = properties_of(branch)?;
            found.extend(keys.keys().map(|key| (key.as_str(), text)));
        }
    }
    Some(found)
}

/// A choice with a value.
#[derive(Clone, Copy)]
pub(super) struct Choice<'a> {
    pub name: &'a str,
    pub text: &'a str,
    /// The schema of the value.
    pub value: &'a Value,
}

/// The choices with a value.
pub(super) fn choice_tables(schema: &Value) -> Vec<Choice<'_>> {
    let branches = schema.get("oneOf").and_then(Value::as_array);
    let mut found = Vec::new();
    for branch in branches.into_iter().flatten() {
        let text = branch.get("description").and_then(Value::as_str);
        let text = text.unwrap_or_default();
        for (name, value) in properties_of(branch).into_iter().flatten() {
            found.push(Choice { name, text, value });
        }
    }
    found
}

/// The description of a parameter, then of its choices.
pub(super) fn description<'a>(schema: &Value, parts: impl Iterator<Item = &'a Value>) -> String {
    let text = schema.get("description").and_then(Value::as_str);
    let mut text = plain_text(text.unwrap_or_default());
    for (name, meaning) in parts.filter_map(choices).flatten() {
        if !meaning.is_empty() {
            let space = if text.is_empty() { "" } else { " " };
            text.push_str(&format!("{space}`{name}`: {}", plain_text(meaning)));
        }
    }
    text
}

/// The default values of a table's keys.
pub(super) fn default_of(schema: &Value) -> Map<String, Value> {
    let properties = properties_of(schema).into_iter().flatten();
    properties
        .filter_map(|(key, schema)| Some((key.clone(), schema.get("default")?.clone())))
        .collect()
}

/// The values of a table that differ from others, each as `key.key = value`.
pub(super) fn difference(given: &Map<String, Value>, others: &Map<String, Value>) -> Vec<String> {
    let mut found = Vec::new();
    for (key, value) in given {
        match (value, others.get(key)) {
            (Value::Object(value), Some(Value::Object(other))) => {
                let below = difference(value, other).into_iter();
                found.extend(below.map(|change| format!("{key}.{change}")));
            }
            (value, other) if Some(value) != other && !value.is_null() => {
                found.push(format!("{key} = {}", toml(value)));
            }
            _ => {}
        }
    }
    found
}

/// A value as TOML.
pub(super) fn toml(value: &Value) -> String {
    match value {
        Value::String(text) => format!("{text:?}"),
        Value::Array(elements) => {
            let elements: Vec<String> = elements.iter().map(toml).collect();
            format!("[{}]", elements.join(", "))
        }
        Value::Object(entries) => {
            let entries = entries.iter().filter(|(_, value)| !value.is_null());
            let entries = entries.map(|(key, value)| format!("{key} = {}", toml(value)));
            format!("{{ {} }}", entries.collect::<Vec<String>>().join(", "))
        }
        other => other.to_string(),
    }
}
