//! The declarations of experiment files: as a JSON Schema for editors, and as tables for the
//! reference.

use parameters::{Reference, for_people, schema_generator};
use schemars::Schema;

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

/// Returns the keys of an experiment file as tables in Markdown.
pub fn reference() -> String {
    let mut reference = Reference::default();
    reference.section::<TopLevel>("Top level");
    reference.section::<SeedsSpec>("`seeds`");
    reference.section::<CaseSpec>("`[[cases]]`");
    reference.section::<ParameterSpec>("`[parameters.NAME]`");
    reference.section::<RunSpec>("`[run]`");
    reference.section::<FigureSpec>("`[[figures]]`");
    reference.section::<Task>("`[task]`");
    reference.markdown()
}

/// Returns the columns of the tables of results as tables in Markdown.
pub fn result_columns() -> String {
    let missions = Row::TABLES.iter().map(ResultTable::reference);
    let plans = PlanRow::TABLES.iter().map(ResultTable::reference);
    missions.chain(plans).collect()
}
