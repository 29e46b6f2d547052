//! The `protean` command.

#![cfg_attr(not(test), warn(clippy::unwrap_used, clippy::expect_used))]
#![cfg_attr(not(test), warn(clippy::panic, clippy::unreachable))]

use std::process::ExitCode;

fn main() -> ExitCode {
    protean::main_with(protean::kinds::KINDS.to_vec())
}
