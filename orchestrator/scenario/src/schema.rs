//! The JSON Schema of scenario files, for editors.

use parameters::{for_people, schema_generator};
use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde_json::{Value as Json, json};

use super::kind::Kind;
use super::resolve::TopLevel;
use super::spec::ProcessBlock;

/// The schema of a scenario file whose processes are of these kinds: `params` of a process has the
/// keys of its `kind`.
pub fn schema(kinds: &[Kind]) -> Schema {
    let mut generator = schema_generator();
    let cases: Vec<Json> = kinds
        .iter()
        .map(|kind| case(*kind, &mut generator))
        .collect();
    let names: Vec<&str> = kinds.iter().map(|kind| kind.name).collect();
    let mut schema = generator.into_root_schema_for::<TopLevel>();
    let blocks = format!("/definitions/{}", ProcessBlock::schema_name());
    if let Some(block) = schema.pointer_mut(&blocks).and_then(Json::as_object_mut) {
        if let Some(kind) = block
            .get_mut("properties")
            .and_then(|properties| properties.get_mut("kind"))
            .and_then(Json::as_object_mut)
        {
            kind.insert("type".into(), "string".into());
            kind.insert("enum".into(), json!(names));
        }
        block.insert("allOf".into(), cases.into());
    }
    schema.insert("title".into(), "Protean scenario".into());
    for_people(&mut schema);
    schema
}

/// What `params` may be for one kind.
fn case(kind: Kind, generator: &mut SchemaGenerator) -> Json {
    let mut params = kind.schema(generator).to_value();
    // The kind's own schema is referred to from other kinds, which have other presets.
    let reference = params.get("$ref").and_then(Json::as_str);
    if let Some(name) = reference.and_then(|r| r.strip_prefix("#/definitions/"))
        && let Some(definition) = generator.definitions().get(name)
    {
        params = definition.clone();
    }
    let presets: Vec<&str> = kind.presets().iter().map(|(name, _)| *name).collect();
    if !presets.is_empty()
        && let Some(properties) = params.get_mut("properties").and_then(Json::as_object_mut)
    {
        let description = "Values that are taken where nothing else is said.";
        properties.insert(
            "preset".into(),
            json!({ "description": description, "enum": presets }),
        );
    }
    json!({
        "if": { "properties": { "kind": { "const": kind.name } }, "required": ["kind"] },
        "then": { "properties": { "params": params } },
    })
}
