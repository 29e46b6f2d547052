//! A TOML value with its place.

use std::fmt::Write;

use serde_json::Value as Json;

use super::path::{FieldPath, Step, is_bare};
use super::source::Origin;

/// A value and its place.
#[derive(Debug, Clone, PartialEq)]
pub struct Node {
    /// The value.
    pub value: Value,
    /// Place of the value.
    pub origin: Origin,
}

/// A TOML value.
#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    /// `true`, `false`.
    Bool(bool),
    /// An integer.
    Int(i64),
    /// A floating-point number.
    Float(f64),
    /// Text.
    Str(String),
    /// A date or time, as written.
    Datetime(String),
    /// `[…]` or `[[…]]`.
    Array(Vec<Node>),
    /// `{…}` or `[…]`.
    Table(Table),
}

/// A key, its place and its value.
#[derive(Debug, Clone, PartialEq)]
pub struct Entry {
    /// The key.
    pub key: String,
    /// Place of the key.
    pub origin: Origin,
    /// The value.
    pub node: Node,
}

/// Keys and values in the order of the text.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Table {
    /// The entries; keys are unique.
    pub entries: Vec<Entry>,
}

impl Table {
    /// Returns the entry with this key.
    pub fn entry(&self, key: &str) -> Option<&Entry> {
        self.entries.iter().find(|e| e.key == key)
    }

    /// Returns the value of this key.
    pub fn get(&self, key: &str) -> Option<&Node> {
        self.entry(key).map(|e| &e.node)
    }

    /// Returns the value of this key, mutable.
    pub fn get_mut(&mut self, key: &str) -> Option<&mut Node> {
        self.entries
            .iter_mut()
            .find(|e| e.key == key)
            .map(|e| &mut e.node)
    }

    /// Sets a key, replacing its value if it has one.
    pub fn set(&mut self, key: &str, origin: Origin, node: Node) {
        match self.entries.iter_mut().find(|e| e.key == key) {
            Some(entry) => {
                entry.origin = origin;
                entry.node = node;
            }
            None => self.entries.push(Entry {
                key: key.to_owned(),
                origin,
                node,
            }),
        }
    }

    /// Removes a key and returns its value.
    pub fn remove(&mut self, key: &str) -> Option<Node> {
        let index = self.entries.iter().position(|e| e.key == key)?;
        Some(self.entries.remove(index).node)
    }

    /// Merges `over` into this table: tables key by key; other values are replaced.
    pub fn overlay(&mut self, over: &Self) {
        for entry in &over.entries {
            match (
                self.get_mut(&entry.key).map(|n| &mut n.value),
                &entry.node.value,
            ) {
                (Some(Value::Table(below)), Value::Table(above)) => below.overlay(above),
                _ => self.set(&entry.key, entry.origin, entry.node.clone()),
            }
        }
    }
}

impl Node {
    /// Creates an empty table.
    pub fn empty_table(origin: Origin) -> Self {
        Self {
            value: Value::Table(Table::default()),
            origin,
        }
    }

    /// Creates text without a place.
    pub fn implied_str(text: &str) -> Self {
        Self {
            value: Value::Str(text.to_owned()),
            origin: Origin::Implied,
        }
    }

    /// Returns the table, if the value is one.
    pub fn as_table(&self) -> Option<&Table> {
        if let Value::Table(table) = &self.value {
            Some(table)
        } else {
            None
        }
    }

    /// Returns the table, if the value is one, mutable.
    pub fn as_table_mut(&mut self) -> Option<&mut Table> {
        if let Value::Table(table) = &mut self.value {
            Some(table)
        } else {
            None
        }
    }

    /// Returns the elements, if the value is an array.
    pub fn as_array(&self) -> Option<&[Self]> {
        if let Value::Array(list) = &self.value {
            Some(list)
        } else {
            None
        }
    }

    /// Returns the text, if the value is text.
    pub fn as_str(&self) -> Option<&str> {
        if let Value::Str(text) = &self.value {
            Some(text)
        } else {
            None
        }
    }

    /// Returns the value of a key, if this is a table with that key.
    pub fn get(&self, key: &str) -> Option<&Self> {
        self.as_table()?.get(key)
    }

    /// Returns the label of an element of an array: its `name`, else its `kind`.
    pub fn label(&self) -> Option<&str> {
        self.get("name")
            .or_else(|| self.get("kind"))
            .and_then(Self::as_str)
    }

    /// Returns the path step to element `index` of an array: by label if the element has one.
    pub fn element_step(&self, index: usize) -> Step {
        match self.label() {
            Some(name) if !name.is_empty() => Step::Named(index, name.to_owned()),
            _ => Step::Index(index),
        }
    }

    /// Returns the value at a path below this one.
    pub fn at(&self, path: &FieldPath) -> Option<&Self> {
        path.0.iter().try_fold(self, |node, step| match step {
            Step::Key(key) => node.get(key),
            Step::Index(i) | Step::Named(i, _) => node.as_array()?.get(*i),
        })
    }

    /// Returns the value at a path below this one, or the deepest existing value along the path.
    pub fn follow(&self, path: &FieldPath) -> &Self {
        let mut node = self;
        for step in &path.0 {
            let next = match step {
                Step::Key(key) => node.get(key),
                Step::Index(i) | Step::Named(i, _) => node.as_array().and_then(|a| a.get(*i)),
            };
            match next {
                Some(next) => node = next,
                None => break,
            }
        }
        node
    }

    /// Returns the place of the deepest value along a path that has one.
    pub fn origin_along(&self, path: &FieldPath) -> Origin {
        let mut node = self;
        let mut origin = self.origin;
        for step in &path.0 {
            let next = match step {
                Step::Key(key) => node.get(key),
                Step::Index(i) | Step::Named(i, _) => node.as_array().and_then(|a| a.get(*i)),
            };
            let Some(next) = next else { break };
            node = next;
            if node.origin != Origin::Implied {
                origin = node.origin;
            }
        }
        origin
    }

    /// Returns the name of the type for messages.
    pub fn type_name(&self) -> &'static str {
        match self.value {
            Value::Bool(_) => "true/false",
            Value::Int(_) => "a whole number",
            Value::Float(_) => "a number",
            Value::Str(_) => "text",
            Value::Datetime(_) => "a date",
            Value::Array(_) => "an array",
            Value::Table(_) => "a table",
        }
    }

    /// Renders the value as TOML on one line, cut after about 60 characters.
    pub fn render_short(&self) -> String {
        const WIDTH: usize = 60;
        let mut out = String::new();
        self.render(&mut out, WIDTH * 2);
        if out.chars().count() > WIDTH {
            out = out.chars().take(WIDTH).chain(['…']).collect();
        }
        out
    }

    /// Appends the value; stops soon after `limit` bytes. (Writing to a String cannot fail.)
    fn render(&self, out: &mut String, limit: usize) {
        if out.len() > limit {
            return;
        }
        match &self.value {
            Value::Bool(v) => out.push_str(&v.to_string()),
            Value::Int(v) => out.push_str(&v.to_string()),
            Value::Float(v) => out.push_str(&render_float(*v)),
            Value::Str(v) => {
                let _ = write!(out, "{v:?}");
            }
            Value::Datetime(v) => out.push_str(v),
            Value::Array(list) => {
                out.push('[');
                for (i, node) in list.iter().enumerate() {
                    if i > 0 {
                        out.push_str(", ");
                    }
                    node.render(out, limit);
                    if out.len() > limit {
                        return;
                    }
                }
                out.push(']');
            }
            Value::Table(table) => {
                out.push_str("{ ");
                for (i, entry) in table.entries.iter().enumerate() {
                    if i > 0 {
                        out.push_str(", ");
                    }
                    if is_bare(&entry.key) {
                        out.push_str(&entry.key);
                    } else {
                        let _ = write!(out, "{:?}", entry.key);
                    }
                    out.push_str(" = ");
                    entry.node.render(out, limit);
                    if out.len() > limit {
                        return;
                    }
                }
                out.push_str(" }");
            }
        }
    }

    /// Converts a JSON value. Leaves out `null`, which TOML does not have; converts numbers beyond the range
    /// of `i64` to floats.
    pub fn from_json(json: &Json) -> Option<Self> {
        let value = match json {
            Json::Null => return None,
            Json::Bool(v) => Value::Bool(*v),
            Json::Number(n) => match n.as_i64() {
                Some(v) => Value::Int(v),
                None => Value::Float(n.as_f64()?),
            },
            Json::String(v) => Value::Str(v.clone()),
            Json::Array(list) => Value::Array(list.iter().filter_map(Self::from_json).collect()),
            Json::Object(map) => {
                let mut table = Table::default();
                for (key, value) in map {
                    if let Some(node) = Self::from_json(value) {
                        table.set(key, Origin::Implied, node);
                    }
                }
                Value::Table(table)
            }
        };
        Some(Self {
            value,
            origin: Origin::Implied,
        })
    }
}

/// Renders a float as TOML: always with a point, an exponent or a name.
pub fn render_float(v: f64) -> String {
    if v.is_nan() {
        "nan".to_owned()
    } else if v.is_infinite() {
        if v > 0.0 { "inf" } else { "-inf" }.to_owned()
    } else {
        // Rust's debug form is the shortest text that reads back as the same bits.
        format!("{v:?}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn overlay_merges_tables_and_replaces_the_rest() {
        let json = |s: &str| Node::from_json(&serde_json::from_str(s).unwrap()).unwrap();
        let mut below = json(r#"{"a": 1, "t": {"x": 1, "y": 2}, "l": [1, 2]}"#);
        let above = json(r#"{"t": {"y": 3}, "l": [9], "b": true}"#);
        below
            .as_table_mut()
            .unwrap()
            .overlay(above.as_table().unwrap());
        // A table keeps the order of its keys; the new key is last.
        assert_eq!(
            below.render_short(),
            "{ a = 1, l = [9], t = { x = 1, y = 3 }, b = true }"
        );
    }

    #[test]
    fn long_values_are_cut() {
        let list = Json::Array((0..1_000_000).map(Json::from).collect());
        let text = Node::from_json(&list).unwrap().render_short();
        assert!(text.chars().count() <= 61);
        assert!(text.starts_with("[0, 1, 2,") && text.ends_with('…'));
    }

    #[test]
    fn rendered_floats_parse_as_floats() {
        assert_eq!(render_float(1.0), "1.0");
        assert_eq!(render_float(-0.0), "-0.0");
        assert_eq!(render_float(f64::NEG_INFINITY), "-inf");
        assert_eq!(render_float(0.1 + 0.2), "0.30000000000000004");
    }
}
