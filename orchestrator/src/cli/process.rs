//! `protean process`: being one process of a run.

use std::path::Path;
use std::process::ExitCode;

use platform::eprintln;
use runtime::Wiring;

use super::EXIT_INVALID;
use crate::latency::link;
use crate::wirings::{self, WiringVisitor};

/// Runs the process of this kind to its end.
pub fn run(kind: &str, config: &Path) -> ExitCode {
    struct Live<'a>(&'a Path);
    impl WiringVisitor for Live<'_> {
        type Output = ExitCode;
        fn visit<W: Wiring + 'static>(self) -> ExitCode {
            runtime::run::<W>(self.0)
        }
    }
    match kind {
        "simulator" => simulator::process::run(config),
        link::SINK_KIND => link::sink(config),
        other => wirings::visit(other, Live(config)).unwrap_or_else(|| {
            eprintln!("error: no process of kind {other:?} in this program");
            ExitCode::from(EXIT_INVALID)
        }),
    }
}
