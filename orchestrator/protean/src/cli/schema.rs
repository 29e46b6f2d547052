//! `protean schema`.

use std::process::ExitCode;

use clap::ValueEnum;

use super::output::print_json;
use scenario::kind::Kind;

/// A kind of file that has a schema.
#[derive(Debug, Clone, Copy, ValueEnum)]
pub(super) enum File {
    /// A scenario
    Scenario,
    /// An experiment
    Experiment,
}

/// Prints the schema of a kind of file.
pub fn schema(kinds: &[Kind], file: File) -> ExitCode {
    let schema = match file {
        File::Scenario => scenario::schema::schema(kinds),
        File::Experiment => sweep::schema::schema(),
    };
    print_json(&schema.to_value());
    ExitCode::SUCCESS
}
