//! `protean report`.

use std::path::PathBuf;
use std::process::ExitCode;

use super::logs;
use super::output::{print, print_json};
use report::page::report;
use scenario::kind::Kind;

/// What stands below the options.
pub(super) const HELP: &str = "\
The page is one file: open it in a browser, send it to somebody. It plays the mission (space, arrows; `?`
lists the keys), with its events, figures, latencies, outcome and scenario. It loads nothing from anywhere.
Logs that end in the middle or lack topics are shown as far as they go; the page says what is missing.

Exit codes: 0 done, 1 the page cannot be written, 2 the log cannot be read or is not one of protean, 3 done,
but the log is not whole: what is missing, is said.";

/// What `protean report` takes.
#[derive(Debug, clap::Args)]
pub(super) struct ReportArgs {
    /// A log of a run
    log: PathBuf,
    /// Write the page to this file [default: the log's name with .html]
    #[arg(long, short, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Overwrite the page if it exists
    #[arg(long)]
    force: bool,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
    /// Show nothing but errors and the result
    #[arg(long, short)]
    quiet: bool,
}

/// Writes the page and prints the file's name.
pub fn run(kinds: &'static [Kind], args: &ReportArgs) -> ExitCode {
    logs::command(args.quiet, |watch| {
        let out = args.out.clone();
        let out = out.unwrap_or_else(|| args.log.with_extension("html"));
        let report = report(&args.log, kinds, &out, args.force, watch)?;
        let code = logs::of_condition(&args.log, &report.condition);
        if args.json {
            print_json(&serde_json::json!(report));
        } else {
            print(&out.display().to_string());
        }
        Ok(code)
    })
}
