//! `protean process`: one process of a run.

use std::path::Path;
use std::process::ExitCode;

use platform::eprintln;

use super::output::EXIT_INVALID;
use latency::link;
use scenario::kind::{Kind, find};

/// Main function of a process; takes the path of its configuration.
type Run = fn(&Path) -> ExitCode;

/// Processes that no scenario names: the simulator, and the receiver of `protean latency`.
const INTERNAL: [(&str, Run); 2] = [
    (simulator::NAME, simulator::process::run),
    (link::SINK_KIND, link::sink),
];

/// Runs a process of this kind to its end.
pub fn run(kinds: &[Kind], kind: &str, config: &Path) -> ExitCode {
    if let Some((_, run)) = INTERNAL.iter().find(|(name, _)| *name == kind) {
        return run(config);
    }
    if let Some(kind) = find(kinds, kind) {
        return kind.run(config);
    }
    eprintln!("error: this program has no process of kind {kind:?}");
    ExitCode::from(EXIT_INVALID)
}
