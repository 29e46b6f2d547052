//! Parameters as a table of the reference: one row per key.

use ciborium::Value as Data;
use schemars::JsonSchema;
use serde::Serialize;
use serde_json::{Map, Value};

use crate::publish::plain_text;
use crate::range::{Kind, Range};
use crate::schema;

/// The table of the parameters of `P` in Markdown, in the order of declaration: key, type, default,
/// range, unit, description.
pub fn markdown_table<P: Serialize + JsonSchema + Default + 'static>() -> String {
    let mut table = Table::default();
    let data = Data::serialized(&P::default()).unwrap_or(Data::Null);
    table.add_table("", schema::inline::<P>(), Some(&data));
    table.0
}

#[derive(Default)]
struct Table(String);

impl Table {
    /// The rows of a table's keys: those of its default value in their order, then the others.
    fn add_table(&mut self, prefix: &str, schema: &Value, data: Option<&Data>) {
        let empty = Map::new();
        let properties = schema.get("properties").and_then(Value::as_object);
        let properties = properties.unwrap_or(&empty);
        let entries = data.and_then(Data::as_map).map_or(&[][..], Vec::as_slice);
        for (key, value) in entries {
            if let Some((key, schema)) = key.as_text().and_then(|key| properties.get_key_value(key))
            {
                self.add(prefix, key, schema, Some(value));
            }
        }
        for (key, schema) in properties {
            if !entries.iter().any(|(k, _)| k.as_text() == Some(key)) {
                self.add(prefix, key, schema, None);
            }
        }
    }

    fn add(&mut self, prefix: &str, key: &str, schema: &Value, data: Option<&Data>) {
        let key = format!("{prefix}{key}");
        let own = without_null(schema);
        let is_table = own.get("properties").is_some();
        let is_absent = matches!(data, None | Some(Data::Null));
        if is_table && !is_absent {
            self.add_table(&format!("{key}."), own, data);
            return;
        }
        let default = match data {
            Some(data) if !is_absent => format!("`{}`", toml(data)),
            _ => match schema.get("default") {
                Some(Value::Null) | None => "–".to_owned(),
                Some(default) => format!("`{default}`"),
            },
        };
        let number = numbers_of(own);
        let range = number.map_or(String::new(), |(_, schema)| Range(schema).short());
        let is_list = types(own).first() == Some(&"array");
        let length = own.as_object().filter(|_| is_list).map(Range);
        let length = length.and_then(|own| own.has_lengths().then(|| own.lengths()));
        let parts = [range, length.unwrap_or_default()];
        let parts: Vec<String> = parts.into_iter().filter(|part| !part.is_empty()).collect();
        let range = parts.join("; ");
        let unit = number.and_then(|(_, schema)| Range(schema).unit());
        let cells = [
            format!("`{key}`"),
            type_name(own),
            default,
            range,
            unit.unwrap_or_default().to_owned(),
            description(schema, own),
        ];
        let cells = cells.map(|cell| cell.replace('|', "\\|"));
        if self.0.is_empty() {
            self.0.push_str(
                "| key | type | default | range | unit | meaning |\n|---|---|---|---|---|---|\n",
            );
        }
        self.0.push_str(&format!("| {} |\n", cells.join(" | ")));
        if is_table {
            self.add_table(&format!("{key}."), own, None);
        }
    }
}

/// A schema without the alternative of being absent.
fn without_null(schema: &Value) -> &Value {
    let branches = schema.get("anyOf").and_then(Value::as_array);
    let null = Value::from("null");
    branches
        .and_then(|all| all.iter().find(|one| one.get("type") != Some(&null)))
        .unwrap_or(schema)
}

fn types(schema: &Value) -> Vec<&str> {
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

/// The numbers of a value, if it is one or a list of some.
fn numbers_of(schema: &Value) -> Option<(Kind, &Map<String, Value>)> {
    match types(schema).first() {
        Some(&"number") => Some((Kind::Real, schema.as_object()?)),
        Some(&"integer") => Some((Kind::Whole, schema.as_object()?)),
        Some(&"array") => numbers_of(schema.get("items")?),
        _ => None,
    }
}

fn type_name(schema: &Value) -> String {
    if let Some(choices) = choices(schema) {
        let names: Vec<String> = choices
            .iter()
            .map(|(name, _)| format!("`{name}`"))
            .collect();
        return names.join(", ");
    }
    match types(schema).first() {
        Some(&"number") => "number".to_owned(),
        Some(&"integer") => "whole number".to_owned(),
        Some(&"boolean") => "true or false".to_owned(),
        Some(&"string") => "text".to_owned(),
        Some(&"array") => match schema.get("items") {
            Some(items) => format!("list of {}", plural(&type_name(without_null(items)))),
            None => "list".to_owned(),
        },
        _ => "table".to_owned(),
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

/// The names of a choice and what they stand for.
fn choices(schema: &Value) -> Option<Vec<(&str, &str)>> {
    if let Some(names) = schema.get("enum").and_then(Value::as_array) {
        return Some(
            names
                .iter()
                .filter_map(Value::as_str)
                .map(|n| (n, ""))
                .collect(),
        );
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
            let keys = branch.get("properties").and_then(Value::as_object)?;
            found.extend(keys.keys().map(|key| (key.as_str(), text)));
        }
    }
    Some(found)
}

/// The description of a parameter, then of its choices.
fn description(schema: &Value, own: &Value) -> String {
    let text = schema.get("description").and_then(Value::as_str);
    let mut text = plain_text(text.unwrap_or_default());
    for (name, meaning) in choices(own).unwrap_or_default() {
        if !meaning.is_empty() {
            text.push_str(&format!(" `{name}`: {}", plain_text(meaning)));
        }
    }
    text
}

/// A value as TOML.
fn toml(data: &Data) -> String {
    match data {
        Data::Integer(n) => i128::from(*n).to_string(),
        Data::Float(x) => format!("{x:?}"),
        Data::Bool(b) => b.to_string(),
        Data::Text(text) => format!("{text:?}"),
        Data::Array(elements) => {
            let elements: Vec<String> = elements.iter().map(toml).collect();
            format!("[{}]", elements.join(", "))
        }
        Data::Map(entries) => {
            let entries: Vec<String> = entries
                .iter()
                .map(|(key, value)| {
                    format!("{} = {}", key.as_text().unwrap_or_default(), toml(value))
                })
                .collect();
            format!("{{ {} }}", entries.join(", "))
        }
        _ => String::new(),
    }
}
