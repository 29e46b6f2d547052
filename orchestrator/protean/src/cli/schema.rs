//! `protean schema`.

use std::process::ExitCode;

use clap::ValueEnum;

use super::output::{print, print_json};
use scenario::kind::Kind;

/// Subject of a schema.
#[derive(Debug, Clone, Copy, ValueEnum)]
pub(super) enum SchemaOf {
    /// Scenario files: JSON Schema, for editors
    Scenario,
    /// Experiment files: JSON Schema, for editors
    Experiment,
    /// Messages: Python module of ctypes structures, for planners that use the iceoryx2 package
    Messages,
    /// Messages: C header, for programs that use the C or C++ library of iceoryx2
    MessagesC,
    /// Planners in C and C++: the header `protean_planner.h`
    Planner,
}

/// Prints a schema.
pub(super) fn schema(kinds: &[Kind], subject: SchemaOf) -> ExitCode {
    match subject {
        SchemaOf::Scenario => print_json(&scenario::schema::schema(kinds).to_value()),
        SchemaOf::Experiment => print_json(&sweep::schema::schema().to_value()),
        SchemaOf::Messages => print(ipc_types::python::module().trim_end()),
        SchemaOf::MessagesC => print(ipc_types::c_header::messages().trim_end()),
        SchemaOf::Planner => print(library_planner::header::planner().trim_end()),
    }
    ExitCode::SUCCESS
}
