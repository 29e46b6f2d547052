//! The declarations of experiment files: as a JSON Schema for editors, and as tables for the
//! reference.

use parameters::{for_people, schema_generator};
use scenario::schema::Section;
use schemars::{Schema, SchemaGenerator};

use super::columns::ResultTable;
use super::planning::PlanRow;
use super::row::{Record as _, Row};
use super::spec::{CaseSpec, FigureSpec, ParameterSpec, RunSpec, SeedsSpec, TopLevel};
use super::task::Task;

/// Returns the schema of an experiment file.
pub fn schema() -> Schema {
    let mut schema = schema_generator().into_root_schema_for::<TopLevel>();
    schema.insert("title".into(), "Protean experiment".into());
    for_people(&mut schema);
    schema
}

/// Returns the parts of an experiment file that have a section of the reference: its heading, and the schema.
pub fn sections() -> [Section; 7] {
    [
        ("Top level", SchemaGenerator::subschema_for::<TopLevel>),
        ("`seeds`", SchemaGenerator::subschema_for::<SeedsSpec>),
        ("`[[cases]]`", SchemaGenerator::subschema_for::<CaseSpec>),
        (
            "`[parameters.NAME]`",
            SchemaGenerator::subschema_for::<ParameterSpec>,
        ),
        ("`[run]`", SchemaGenerator::subschema_for::<RunSpec>),
        (
            "`[[figures]]`",
            SchemaGenerator::subschema_for::<FigureSpec>,
        ),
        ("`[task]`", SchemaGenerator::subschema_for::<Task>),
    ]
}

/// Returns the columns of the tables of results as tables in Markdown.
pub fn result_columns() -> String {
    let missions = Row::TABLES.iter().map(ResultTable::reference);
    let plans = PlanRow::TABLES.iter().map(ResultTable::reference);
    missions.chain(plans).collect()
}
