//! `protean picture`.

use std::path::PathBuf;
use std::process::ExitCode;

use platform::output_format::OutputFormat;

use super::common::{ForceArg, out};
use super::logs;
use super::output::print;
use report::picture::save;

/// Help below the options.
pub const HELP: &str = "\
A truncated log is drawn as far as it can be read.

Exit codes: 0 success, 1 the picture cannot be written, 2 the file is not a readable Protean log or ends before --at,
3 the log is incomplete (stderr lists what is missing).";

/// Arguments of `protean picture`.
#[derive(Debug, clap::Args)]
pub struct PictureArgs {
    /// Log file
    log: PathBuf,
    /// Write the picture to FILE (.svg, .png or .pdf) [default: the log's name with .svg]
    #[arg(long, short, value_name = "FILE", value_parser = out(OutputFormat::PICTURE))]
    out: Option<PathBuf>,
    /// Draw the state and the beliefs at simulated time T (s) [default: the end]
    #[arg(long, value_name = "T")]
    at: Option<f64>,
    #[command(flatten)]
    force: ForceArg,
}

/// Draws a log into a file and prints the file's name.
pub fn run(args: &PictureArgs) -> ExitCode {
    let log = &args.log;
    logs::command(false, |watch| {
        let out = args.out.clone();
        let out = out.unwrap_or_else(|| log.with_extension("svg"));
        let condition = save(log, args.at, &out, args.force.force, watch)?;
        print(&out.display().to_string());
        Ok(logs::of_condition(log, &condition))
    })
}
