//! `protean process`: one process of a run.

use std::path::Path;
use std::process::ExitCode;

use platform::eprintln;

use super::output::EXIT_INVALID;
use scenario::kind::{Kind, find};

/// Runs a process of this kind to its end.
pub fn run(kinds: &[Kind], kind: &str, config: &Path) -> ExitCode {
    // No scenario names the simulator.
    if kind == simulator::NAME {
        return simulator::process::run(config);
    }
    if let Some(kind) = find(kinds, kind) {
        return kind.run(config);
    }
    eprintln!("error: this program has no process of kind {kind:?}");
    ExitCode::from(EXIT_INVALID)
}
