//! `set = { … }`: the overrides of a case or of a level of a parameter.

use config::{FieldPath, Node, Origin, Place, Value, write_value};

use super::reader::Reader;

/// One override of the scenario.
#[derive(Debug, Clone, PartialEq)]
pub struct Assignment {
    /// `key=value`, as `--set` takes it.
    pub argument: String,
    /// Location in the file: `experiment.toml:12`.
    pub label: String,
    /// Place of the key in the file; `None` on the command line.
    pub key_place: Option<Place>,
}

impl Assignment {
    /// Creates the override of an argument of `--set`.
    pub fn of_command_line(argument: &str) -> Self {
        Self {
            argument: argument.to_owned(),
            label: "--set".to_owned(),
            key_place: None,
        }
    }

    /// Returns its key.
    pub fn key(&self) -> &str {
        self.argument.split_once('=').map_or("", |(key, _)| key)
    }
}

/// Reads a table of overrides.
///
/// Keys are paths as `--set` takes them, quoted if they contain more than names (`"processes[+]"`).
/// A table overrides key by key; keys that it does not name are unchanged. A table with a `kind` or
/// a `command` is a whole process and replaces the previous one, as an empty table does.
pub fn read(reader: &mut Reader, path: &FieldPath, node: &Node) -> Vec<Assignment> {
    let mut found = Vec::new();
    if node
        .as_table()
        .is_some_and(|table| !table.entries.is_empty())
    {
        flatten(reader, "", node, node.origin, &mut found);
    } else {
        reader.wrong_type(
            path,
            node,
            "a table of overrides, for example { rules.time_limit = 60.0 }",
        );
    }
    found
}

fn flatten(reader: &Reader, prefix: &str, node: &Node, key: Origin, found: &mut Vec<Assignment>) {
    let whole = |table: &config::Table| {
        table.entries.is_empty() || table.get("kind").is_some() || table.get("command").is_some()
    };
    match &node.value {
        Value::Table(table) if prefix.is_empty() || !whole(table) => {
            for entry in &table.entries {
                let path = if prefix.is_empty() {
                    entry.key.clone()
                } else {
                    format!("{prefix}.{}", entry.key)
                };
                flatten(reader, &path, &entry.node, entry.origin, found);
            }
        }
        _ => found.push(Assignment {
            argument: format!("{prefix}={}", write_value(node)),
            label: reader.line_of(node),
            key_place: reader.sources.place(key),
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn arguments(text: &str) -> Vec<String> {
        let mut reader = Reader::new("e.toml", text).unwrap();
        let node = reader.root.get("set").cloned().unwrap();
        let found = read(&mut reader, &FieldPath::key("set"), &node);
        assert!(reader.problems.is_empty(), "{}", reader.problems);
        found.into_iter().map(|a| a.argument).collect()
    }

    #[test]
    fn tables_are_merged_and_processes_are_replaced() {
        let text = r#"
            [set]
            rules.time_limit = 5
            teams.evader = { scan = {}, limits = { v_max = 0.5 } }
            processes.evader_potential = { kind = "evader_braitenberg", team = "evader" }
            "processes[+]" = { kind = "perception" }
        "#;
        assert_eq!(
            arguments(text),
            [
                "rules.time_limit=5",
                "teams.evader.scan={}",
                "teams.evader.limits.v_max=0.5",
                r#"processes.evader_potential={ kind = "evader_braitenberg", team = "evader" }"#,
                r#"processes[+]={ kind = "perception" }"#,
            ]
        );
    }

    #[test]
    fn an_assignment_has_its_line() {
        let mut reader = Reader::new("e.toml", "[set]\na = 1\n\nb.c = 2\n").unwrap();
        let node = reader.root.get("set").cloned().unwrap();
        let found = read(&mut reader, &FieldPath::key("set"), &node);
        let labels: Vec<_> = found.iter().map(|a| a.label.as_str()).collect();
        assert_eq!(labels, ["e.toml:2", "e.toml:4"]);
    }
}
