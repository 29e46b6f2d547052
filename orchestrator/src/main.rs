//! The `protean` command.

#![cfg_attr(not(test), warn(clippy::unwrap_used, clippy::expect_used))]
#![cfg_attr(not(test), warn(clippy::panic, clippy::unreachable))]

use std::process::ExitCode;

fn main() -> ExitCode {
    orchestrator::memory::share_arenas();
    orchestrator::descriptors::raise_limit();
    orchestrator::cli::main()
}
