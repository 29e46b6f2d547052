//! `protean schema`.

use std::process::ExitCode;

use clap::ValueEnum;

use super::output::{print, print_json};
use scenario::kind::Kind;

/// The header of planners in C and C++, which a test of `library_planner` compares with the declared interface.
const PLANNER: &str = include_str!("../../../../examples/cpp_planner/protean_planner.h");

/// Subject of a schema.
#[derive(Debug, Clone, Copy, ValueEnum)]
pub enum SchemaOf {
    /// Scenario files: JSON Schema, for editors
    Scenario,
    /// Experiment files: JSON Schema, for editors
    Experiment,
    /// Files of `protean test`: JSON Schema, for editors
    Test,
    /// Planners in C and C++: the header `protean_planner.h`
    Planner,
}

/// Prints a schema.
pub fn schema(kinds: &[Kind], subject: SchemaOf) -> ExitCode {
    match subject {
        SchemaOf::Scenario => print_json(&scenario::schema::schema(kinds).to_value()),
        SchemaOf::Experiment => print_json(&sweep::schema::schema().to_value()),
        SchemaOf::Test => print_json(&mission_tests::schema().to_value()),
        SchemaOf::Planner => print(PLANNER.trim_end()),
    }
    ExitCode::SUCCESS
}
