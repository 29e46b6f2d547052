//! The JSON Schemas of files against the scenarios and experiments that there are.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use platform::file_kind::{FileKind, TOML_KEYS};
use serde_json::Value as Json;

use kinds::KINDS;

/// Collects the parts of a document that a schema refuses; supports the keywords of our schemas.
fn refusals(root: &Json, schema: &Json, value: &Json, path: &str, found: &mut Vec<String>) {
    let Some(object) = schema.as_object() else {
        if schema == &Json::Bool(false) {
            found.push(format!("{path}: nothing is allowed here"));
        }
        return;
    };
    let accepts = |schema: &Json| {
        let mut found = Vec::new();
        refusals(root, schema, value, path, &mut found);
        found.is_empty()
    };
    for (keyword, rule) in object {
        let rules = || rule.as_array().unwrap();
        let ok = match keyword.as_str() {
            "$ref" => {
                let at = rule.as_str().unwrap().trim_start_matches('#');
                refusals(root, root.pointer(at).unwrap(), value, path, found);
                true
            }
            "type" => match rule {
                Json::Array(names) => names.iter().any(|name| has_type(name, value)),
                name => has_type(name, value),
            },
            "enum" => rules().contains(value),
            "const" => rule == value,
            "minimum" => value.as_f64().is_none_or(|x| x >= rule.as_f64().unwrap()),
            "maximum" => value.as_f64().is_none_or(|x| x <= rule.as_f64().unwrap()),
            "exclusiveMinimum" => value.as_f64().is_none_or(|x| x > rule.as_f64().unwrap()),
            "exclusiveMaximum" => value.as_f64().is_none_or(|x| x < rule.as_f64().unwrap()),
            "minItems" => value
                .as_array()
                .is_none_or(|list| list.len() as u64 >= rule.as_u64().unwrap()),
            "maxItems" => value
                .as_array()
                .is_none_or(|list| list.len() as u64 <= rule.as_u64().unwrap()),
            "minLength" => value
                .as_str()
                .is_none_or(|text| text.len() as u64 >= rule.as_u64().unwrap()),
            "maxLength" => value
                .as_str()
                .is_none_or(|text| text.len() as u64 <= rule.as_u64().unwrap()),
            "items" => {
                for (i, element) in value.as_array().into_iter().flatten().enumerate() {
                    refusals(root, rule, element, &format!("{path}[{i}]"), found);
                }
                true
            }
            "required" => value.as_object().is_none_or(|table| {
                rules()
                    .iter()
                    .all(|key| table.contains_key(key.as_str().unwrap()))
            }),
            "properties" => {
                for (key, value) in value.as_object().into_iter().flatten() {
                    if let Some(schema) = rule.get(key) {
                        refusals(root, schema, value, &format!("{path}.{key}"), found);
                    }
                }
                true
            }
            "additionalProperties" => {
                let known = object.get("properties");
                for (key, value) in value.as_object().into_iter().flatten() {
                    if known.and_then(|known| known.get(key)).is_none() {
                        refusals(root, rule, value, &format!("{path}.{key}"), found);
                    }
                }
                true
            }
            "allOf" => {
                for rule in rules() {
                    refusals(root, rule, value, path, found);
                }
                true
            }
            "anyOf" => rules().iter().any(accepts),
            "oneOf" => rules().iter().filter(|rule| accepts(rule)).count() == 1,
            "if" => {
                if accepts(rule) {
                    refusals(root, &object["then"], value, path, found);
                }
                true
            }
            "then" | "writeOnly" | "definitions" | "$schema" | "title" | "description"
            | "default" | "format" | "x-unit" => true,
            other => panic!("the schema uses {other}, which this test does not know"),
        };
        if !ok {
            found.push(format!("{path}: {value} breaks {keyword} {rule}"));
        }
    }
}

fn has_type(name: &Json, value: &Json) -> bool {
    match name.as_str().unwrap() {
        "object" => value.is_object(),
        "array" => value.is_array(),
        "string" => value.is_string(),
        "boolean" => value.is_boolean(),
        "null" => value.is_null(),
        "number" => value.is_number(),
        "integer" => value.is_i64() || value.is_u64(),
        other => panic!("{other}"),
    }
}

fn refused_scenario(text: &str) -> Vec<String> {
    refused(&scenario::schema::schema(KINDS).to_value(), text)
}

fn refused_experiment(text: &str) -> Vec<String> {
    refused(&sweep::schema::schema().to_value(), text)
}

fn refused(schema: &Json, text: &str) -> Vec<String> {
    let document = serde_json::to_value(toml::from_str::<toml::Table>(text).unwrap()).unwrap();
    let mut found = Vec::new();
    refusals(schema, schema, &document, "", &mut found);
    found
}

/// Checks every file of a folder.
fn check_folder(folder: &str, refused: fn(&str) -> Vec<String>) {
    let directory = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let mut count = 0;
    for entry in fs::read_dir(directory.join(folder)).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|e| e == "toml") {
            let text = fs::read_to_string(&path).unwrap();
            assert_eq!(refused(&text), Vec::<String>::new(), "{}", path.display());
            count += 1;
        }
    }
    assert!(count > 10);
}

#[test]
fn every_scenario_of_the_repository_fits_the_schema() {
    check_folder("scenarios", refused_scenario);
}

#[test]
fn every_experiment_of_the_repository_fits_the_schema() {
    check_folder("experiments", refused_experiment);
}

#[test]
fn a_wrong_value_of_an_experiment_is_refused() {
    let right = "kind = 'planning'\nseeds = { count = 3 }\nrun = { timeout_s = 5 }\ngrid = { speed = [3] }\n\
                 parameters.speed = { scale = 'key' }\n[[cases]]\nname = 'first'\n[[figures]]\nname = 'a'\n\
                 x = 'speed'\n[task]\noptions.nodes = 2\ninstances.radius = [5, 200]";
    assert_eq!(refused_experiment(right), [""; 0]);
    for (text, field) in [
        ("seeds = { count = -1 }", ".seeds"),
        ("seeds = { count = 1000001 }", ".seeds"),
        ("seeds = { first = 1 }", ".seeds"),
        ("kind = 'games'", ".kind"),
        ("run = { timeout_s = 0.5 }", ".run"),
        ("run = { timeout = 10 }", ".run"),
        ("grid = { speed = 3 }", ".grid"),
        ("parameters.speed = { scale = true }", ".parameters"),
        ("[[cases]]\ntitle = 'first'", ".cases"),
        (
            "[[figures]]\nname = 'a'\nx = 'b'\nmetric = 'luck'",
            ".figures",
        ),
        ("task.options.nodes = 1", ".task"),
        ("task.instances.radius = [5, 201]", ".task"),
        ("scenarios = 'chase'", ".scenarios"),
    ] {
        let found = refused_experiment(text);
        let at_field = found.iter().any(|refusal| refusal.starts_with(field));
        assert!(at_field, "{text}: {found:?}");
    }
}

#[test]
fn a_wrong_value_of_a_test_is_refused() {
    let refused = |text: &str| refused(&mission_tests::schema().to_value(), text);
    for right in [
        "scenario = 'chase'\nexpect.no_contact = true",
        "scenario = 'chase'\nseeds = [1, 2]\nexpect.escape_share = { over = 9, within = [0, 1] }",
        "[[test]]\nscenario = 'a.toml'\nseeds = '1..3'\nset.rules.time_limit = 2\n\
         expect.columns.ticks = { at_most = 3 }",
    ] {
        assert_eq!(refused(right), [""; 0], "{right}");
    }
    for wrong in [
        "scenario = 'chase'",
        "scenario = 'chase'\nseed = -1\nexpect.no_contact = true",
        "scenario = 'chase'\nseeds = 3\nexpect.no_contact = true",
        "scenario = 'chase'\nexpect.no_contacts = true",
        "[[test]]\nexpect.no_contact = true",
    ] {
        assert_ne!(refused(wrong), [""; 0], "{wrong}");
    }
}

#[test]
fn params_are_those_of_the_kind() {
    let process = |kind: &str, params: &str| {
        refused_scenario(&format!(
            "[[processes]]\nkind = \"{kind}\"\n[processes.params]\n{params}\n"
        ))
    };
    assert_eq!(
        process("pursuer", "assignment = { period_s = 0.5 }"),
        [""; 0]
    );
    assert_eq!(process("pursuer", "preset = 'paper'"), [""; 0]);
    for (kind, params, field) in [
        ("pursuer", "assignment = { period_s = 0 }", "period_s"),
        ("pursuer", "preset = 'papyrus'", "preset"),
        ("pursuer", "particles = 3", "particles"),
        ("referee", "preset = 'paper'", "preset"),
        ("chaser", "", "kind"),
    ] {
        let found = process(kind, params);
        assert!(
            found.iter().any(|text| text.contains(field)),
            "{kind} {params}: {found:?}"
        );
    }
}

#[test]
fn descriptions_end_with_range_and_unit() {
    let schema = serde_json::to_string(&scenario::schema::schema(KINDS)).unwrap();
    assert!(schema.contains(
        "Time between two assignments of the cut-off method.\\n\\nA finite number above 0 (s)."
    ));
}

#[test]
fn the_keys_that_tell_files_apart_are_those_of_the_schemas() {
    let keys = |schema: Json| -> BTreeSet<String> {
        schema["properties"]
            .as_object()
            .unwrap()
            .keys()
            .cloned()
            .collect()
    };
    let scenario = keys(scenario::schema::schema(KINDS).to_value());
    let experiment = keys(sweep::schema::schema().to_value());
    let only = |all: &BTreeSet<String>, others: &BTreeSet<String>| -> BTreeSet<String> {
        all.difference(others).cloned().collect()
    };
    for (kind, own) in TOML_KEYS {
        let own: BTreeSet<String> = own.iter().map(|&key| key.to_owned()).collect();
        match kind {
            FileKind::Scenario => assert_eq!(own, only(&scenario, &experiment)),
            FileKind::Experiment => assert_eq!(own, only(&experiment, &scenario)),
            _ => assert!(
                own.is_disjoint(&scenario) && own.is_disjoint(&experiment),
                "{own:?}"
            ),
        }
    }
}
