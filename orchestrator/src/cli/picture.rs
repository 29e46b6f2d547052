//! `protean picture`.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use super::{EXIT_FAILED, EXIT_INVALID, print};
use crate::picture::{RunTrace, draw, save};

/// Draws a log into an SVG file and prints the file's name.
pub fn picture(log: &Path, out: Option<PathBuf>, at: Option<f64>, force: bool) -> ExitCode {
    let out = out.unwrap_or_else(|| log.with_extension("svg"));
    let drawn = RunTrace::read(log, at).and_then(|trace| save(&draw(&trace), &out, log, force));
    match drawn {
        Ok(()) => {
            print(&out.display().to_string());
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(if error.is_output_failure() {
                EXIT_FAILED
            } else {
                EXIT_INVALID
            })
        }
    }
}
