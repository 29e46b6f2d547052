//! Writer of [`Node`]s as TOML.

use std::fmt::Write;

use super::node::{Node, Table, Value, render_float};
use super::path::is_bare;

/// Renders the tree as a TOML document: `[tables]` and `[[arrays of tables]]` on separate lines, contents of
/// array elements inline. Returns an empty document if the node is not a table.
pub fn write_document(root: &Node) -> String {
    let mut out = String::new();
    if let Some(table) = root.as_table() {
        write_table(&mut out, "", table);
    }
    out
}

fn write_table(out: &mut String, path: &str, table: &Table) {
    let inner = |key: &str| {
        let key = render_key(key);
        if path.is_empty() {
            key
        } else {
            format!("{path}.{key}")
        }
    };
    for entry in table.entries.iter().filter(|e| !has_own_lines(&e.node)) {
        // Writing to a String cannot fail.
        let _ = writeln!(
            out,
            "{} = {}",
            render_key(&entry.key),
            write_value(&entry.node)
        );
    }
    for entry in table.entries.iter().filter(|e| has_own_lines(&e.node)) {
        let name = inner(&entry.key);
        match &entry.node.value {
            Value::Table(table) => {
                let _ = writeln!(out, "\n[{name}]");
                write_table(out, &name, table);
            }
            Value::Array(list) => {
                for element in list.iter().filter_map(Node::as_table) {
                    let _ = writeln!(out, "\n[[{name}]]");
                    for entry in &element.entries {
                        let _ = writeln!(
                            out,
                            "{} = {}",
                            render_key(&entry.key),
                            write_value(&entry.node)
                        );
                    }
                }
            }
            _ => {}
        }
    }
}

fn has_own_lines(node: &Node) -> bool {
    match &node.value {
        Value::Table(_) => true,
        Value::Array(list) => !list.is_empty() && list.iter().all(|n| n.as_table().is_some()),
        _ => false,
    }
}

/// Renders the value as TOML on one line.
pub fn write_value(node: &Node) -> String {
    match &node.value {
        Value::Bool(v) => v.to_string(),
        Value::Int(v) => v.to_string(),
        Value::Float(v) => render_float(*v),
        Value::Str(v) => quoted(v),
        Value::Datetime(v) => v.clone(),
        Value::Array(list) => {
            let parts: Vec<String> = list.iter().map(write_value).collect();
            format!("[{}]", parts.join(", "))
        }
        Value::Table(table) if table.entries.is_empty() => "{}".to_owned(),
        Value::Table(table) => {
            let parts: Vec<String> = table
                .entries
                .iter()
                .map(|e| format!("{} = {}", render_key(&e.key), write_value(&e.node)))
                .collect();
            format!("{{ {} }}", parts.join(", "))
        }
    }
}

fn render_key(key: &str) -> String {
    if is_bare(key) {
        key.to_owned()
    } else {
        quoted(key)
    }
}

/// Renders a TOML basic string.
fn quoted(text: &str) -> String {
    let mut out = String::with_capacity(text.len() + 2);
    out.push('"');
    for c in text.chars() {
        match c {
            '"' => out.push_str("\\\""),
            '\\' => out.push_str("\\\\"),
            '\n' => out.push_str("\\n"),
            '\t' => out.push_str("\\t"),
            '\r' => out.push_str("\\r"),
            c if c.is_control() => {
                let _ = write!(out, "\\u{:04X}", c as u32);
            }
            c => out.push(c),
        }
    }
    out.push('"');
    out
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use serde_json::{Value as Json, json};

    use super::super::diagnostic::Diagnostics;
    use super::super::parse::parse_document;
    use super::super::read::read_once;
    use super::super::source::{SourceKind, Sources};
    use super::*;

    fn round_trip(json: &Json) -> Json {
        let text = write_document(&Node::from_json(json).unwrap());
        let mut sources = Sources::default();
        let id = sources.add(SourceKind::File, "t.toml", &text);
        let mut problems = Diagnostics::default();
        let node = parse_document(&sources, id, &mut problems);
        assert!(problems.is_empty(), "{problems}\n{text}");
        read_once(&node.unwrap()).unwrap()
    }

    #[test]
    fn tables_arrays_of_tables_and_inline_parts_are_laid_out() {
        let json = json!({
            "title": "a \"b\"\n\u{1}", "list": [], "world": { "r": 0.5, "map": { "walls": [ { "c": { "r": 1 } } ] } },
            "robots": [ { "name": "a", "pos": [1.0, 2.0] }, { "name": "b" } ],
        });
        let text = write_document(&Node::from_json(&json).unwrap());
        let want = "list = []\ntitle = \"a \\\"b\\\"\\n\\u0001\"\n\n[[robots]]\nname = \"a\"\n\
                    pos = [1.0, 2.0]\n\n[[robots]]\nname = \"b\"\n\n[world]\nr = 0.5\n\n[world.map]\n\n\
                    [[world.map.walls]]\nc = { r = 1 }\n";
        assert_eq!(text, want);
        assert_eq!(round_trip(&json), json);
    }

    fn any_json() -> impl Strategy<Value = Json> {
        let leaf = prop_oneof![
            any::<bool>().prop_map(Json::from),
            any::<i64>().prop_map(Json::from),
            any::<f64>()
                .prop_filter("finite", |v| v.is_finite())
                .prop_map(Json::from),
            any::<String>().prop_map(Json::from),
        ];
        leaf.prop_recursive(4, 40, 5, |inner| {
            prop_oneof![
                prop::collection::vec(inner.clone(), 0..5).prop_map(Json::from),
                prop::collection::btree_map(any::<String>(), inner, 0..5)
                    .prop_map(|m| Json::Object(m.into_iter().collect())),
            ]
        })
    }

    proptest! {
        #[test]
        fn every_tree_reads_back_as_it_was(map in prop::collection::btree_map(any::<String>(), any_json(), 0..5)) {
            let json = Json::Object(map.into_iter().collect());
            prop_assert_eq!(round_trip(&json), json);
        }
    }
}
