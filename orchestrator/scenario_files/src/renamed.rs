//! Parameters and kinds that had another name in earlier versions.

use config::{Node, Value};

/// Former and present names. A name has one meaning in all kinds.
const NAMES: [(&str, &str); 6] = [
    ("eyes", "viewpoint"),
    ("fellow_weight", "teammate_weight"),
    ("keep_away", "avoid_radius"),
    ("keyed_coverage", "coverage_keyed"),
    ("least_look_ahead", "min_look_ahead"),
    ("most_miss", "max_miss"),
];

/// Returns the present name of a parameter or kind with this former name.
pub fn present_name(former: &str) -> Option<&'static str> {
    NAMES
        .iter()
        .find(|(old, _)| *old == former)
        .map(|(_, new)| *new)
}

/// Gives the kinds and parameters in a scenario from a log their present names.
pub fn update(scenario: &mut Node) {
    let processes = scenario.as_table_mut();
    if let Some(processes) = processes.and_then(|root| root.get_mut("processes")) {
        update_tables(processes);
    }
}

fn update_tables(node: &mut Node) {
    match &mut node.value {
        Value::Array(items) => items.iter_mut().for_each(update_tables),
        Value::Table(table) => {
            for entry in &mut table.entries {
                if let Some(present) = present_name(&entry.key) {
                    present.clone_into(&mut entry.key);
                }
                match &mut entry.node.value {
                    Value::Str(kind) if entry.key == "kind" => {
                        if let Some(present) = present_name(kind) {
                            present.clone_into(kind);
                        }
                    }
                    // The part of observations with shortest paths.
                    Value::Str(text) if entry.key == "observation" => {
                        let parts = text.split('+');
                        let parts = parts.map(|part| if part == "way" { "path" } else { part });
                        *text = parts.collect::<Vec<_>>().join("+");
                    }
                    _ => update_tables(&mut entry.node),
                }
            }
        }
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use config::{Diagnostics, SourceKind, Sources, parse_document};

    use super::*;

    #[test]
    fn kinds_and_parameters_of_processes_alone_are_renamed() {
        let parse = |text: &str| {
            let mut sources = Sources::default();
            let source = sources.add(SourceKind::File, "log.toml", text);
            parse_document(&sources, source, &mut Diagnostics::default()).unwrap()
        };
        let mut scenario = parse(
            "robots = [{ eyes = 1 }]\n[[processes]]\nkind = \"keyed_coverage\"\n\
             params = { eyes = 1, observation = \"state+way\" }\n",
        );
        update(&mut scenario);
        let processes = scenario.get("processes").and_then(Node::as_array).unwrap();
        let kind = processes[0].get("kind").and_then(Node::as_str);
        assert_eq!(kind, Some("coverage_keyed"));
        let params = processes[0].get("params").unwrap();
        assert_eq!(params.get("eyes"), None);
        assert!(params.get("viewpoint").is_some());
        let observation = params.get("observation").and_then(Node::as_str);
        assert_eq!(observation, Some("state+path"));
        let robots = scenario.get("robots").and_then(Node::as_array).unwrap();
        assert!(robots[0].get("eyes").is_some());
    }
}
