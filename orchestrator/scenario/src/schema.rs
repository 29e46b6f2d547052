//! Declarations of scenario files: a JSON Schema for editors, and the sections of the reference.

use geometry::map::{CellMap, VectorMap};
use geometry::region::Region;
use geometry::shape::Shape;
use parameters::{for_people, schema_generator};
use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde_json::{Value as Json, json};
use sim_backend::spec::{CoverageSpec, RulesSpec};

use super::events::{EventBlock, WhenBlock};
use super::expect::{ExpectSpec, MeanSpec, RangeSpec, ShareSpec};
use super::kind::Kind;
use super::resolve::TopLevel;
use super::spec::{LinkSpec, LogSpec, ProcessBlock, RobotBlock, RunSpec};
use super::world::WorldBlock;

/// Returns the schema of a scenario file with these kinds of processes: the keys of `params` depend on
/// `kind`.
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

/// Returns the schema of `params` for one kind.
fn case(kind: Kind, generator: &mut SchemaGenerator) -> Json {
    let mut params = kind.schema(generator).to_value();
    // Other kinds, with other presets, refer to the kind's own schema.
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
        let description = "Named set of default values.";
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

/// A part of a file that has a section of the reference: heading, and function that generates the schema.
pub type Section = (&'static str, fn(&mut SchemaGenerator) -> Schema);

/// Returns the parts of a scenario file that have a section of the reference: its heading, and the schema.
pub fn sections() -> [Section; 19] {
    [
        ("Top level", SchemaGenerator::subschema_for::<TopLevel>),
        ("`[run]`", SchemaGenerator::subschema_for::<RunSpec>),
        ("`[world]`", SchemaGenerator::subschema_for::<WorldBlock>),
        (
            "`[world.map.vector]`",
            SchemaGenerator::subschema_for::<VectorMap>,
        ),
        (
            "`[world.map.cells]`",
            SchemaGenerator::subschema_for::<CellMap>,
        ),
        ("`[rules]`", SchemaGenerator::subschema_for::<RulesSpec>),
        (
            "`[rules.coverage]`",
            SchemaGenerator::subschema_for::<CoverageSpec>,
        ),
        ("`[[robots]]`", SchemaGenerator::subschema_for::<RobotBlock>),
        (
            "`[[processes]]`",
            SchemaGenerator::subschema_for::<ProcessBlock>,
        ),
        ("`[[events]]`", SchemaGenerator::subschema_for::<EventBlock>),
        ("`when`", SchemaGenerator::subschema_for::<WhenBlock>),
        ("`[[links]]`", SchemaGenerator::subschema_for::<LinkSpec>),
        ("`[log]`", SchemaGenerator::subschema_for::<LogSpec>),
        ("`[expect]`", SchemaGenerator::subschema_for::<ExpectSpec>),
        ("Ranges", SchemaGenerator::subschema_for::<RangeSpec>),
        ("Shares", SchemaGenerator::subschema_for::<ShareSpec>),
        ("Means", SchemaGenerator::subschema_for::<MeanSpec>),
        ("Shapes", SchemaGenerator::subschema_for::<Shape>),
        ("Regions", SchemaGenerator::subschema_for::<Region>),
    ]
}
