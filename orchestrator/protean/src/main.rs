//! The `protean` command.

use std::process::ExitCode;

fn main() -> ExitCode {
    protean::main_with(protean::kinds::KINDS.to_vec())
}
