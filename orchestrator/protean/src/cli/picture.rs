//! `protean picture`.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use mcap_log::derived;
use platform::atomic_file::Readers;

use super::logs;
use super::output::print;
use report::picture::{RunTrace, draw};

/// What stands below the options.
pub(super) const HELP: &str = "\
Logs that end in the middle are drawn as far as they go.

Exit codes: 0 done, 1 the picture cannot be written, 2 the log cannot be read, is not one of protean or does not
reach to --at, 3 done, but the log is not whole: what is missing, is said.";

/// Draws a log into an SVG file and prints the file's name.
pub fn picture(log: &Path, out: Option<PathBuf>, at: Option<f64>, force: bool) -> ExitCode {
    logs::command(false, |watch| {
        let out = out.unwrap_or_else(|| log.with_extension("svg"));
        let (trace, condition) = RunTrace::read(log, at, watch)?;
        derived::write(draw(&trace).as_bytes(), &out, log, force, Readers::Anybody)?;
        print(&out.display().to_string());
        Ok(logs::of_condition(log, &condition))
    })
}
