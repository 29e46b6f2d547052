//! The declarations of scenario files: as a JSON Schema for editors, and as tables for the reference.

use geometry::map::{CellMap, VectorMap};
use geometry::region::Region;
use geometry::shape::Shape;
use parameters::{Reference, for_people, schema_generator};
use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde_json::{Value as Json, json};
use sim_backend::spec::{CoverageSpec, RulesSpec};

use super::events::{EventBlock, WhenBlock};
use super::kind::Kind;
use super::resolve::TopLevel;
use super::spec::{LogSpec, ProcessBlock, RobotBlock, RunSpec};
use super::world::WorldBlock;

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

/// The keys of a scenario file as tables in Markdown.
pub fn reference() -> String {
    let mut reference = Reference::default();
    reference.section::<TopLevel>("Top level");
    reference.section::<RunSpec>("`[run]`");
    reference.section::<WorldBlock>("`[world]`");
    reference.section::<VectorMap>("`[world.map.vector]`");
    reference.section::<CellMap>("`[world.map.cells]`");
    reference.section::<RulesSpec>("`[rules]`");
    reference.section::<CoverageSpec>("`[rules.coverage]`");
    reference.section::<RobotBlock>("`[[robots]]`");
    reference.section::<ProcessBlock>("`[[processes]]`");
    reference.section::<EventBlock>("`[[events]]`");
    reference.section::<WhenBlock>("`when`");
    reference.section::<LogSpec>("`[log]`");
    reference.section::<Shape>("Shapes");
    reference.section::<Region>("Regions");
    reference.markdown()
}

/// The parameters of kinds of processes as tables in Markdown.
pub fn parameters(kinds: &[Kind]) -> String {
    let mut reference = Reference::default();
    for kind in kinds {
        let (first, rest) = kind.summary.split_at(1);
        let summary = format!("{}{rest}.", first.to_uppercase());
        reference.add(&format!("`{}`", kind.name), &summary, |generator| {
            kind.schema(generator)
        });
    }
    reference.markdown()
}
