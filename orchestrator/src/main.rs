//! The `protean` command.

#![cfg_attr(not(test), warn(clippy::unwrap_used, clippy::expect_used))]
#![cfg_attr(not(test), warn(clippy::panic, clippy::unreachable))]

use std::process::ExitCode;

fn main() -> ExitCode {
    orchestrator::memory::share_arenas();
    orchestrator::descriptors::raise_limit();
    if let Err(error) = orchestrator::signals::as_needed() {
        eprintln!("error: cannot set how signals are taken: {error}");
        return ExitCode::FAILURE;
    }
    orchestrator::cli::main()
}
