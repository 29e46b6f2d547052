//! `protean report`.

use std::path::PathBuf;
use std::process::ExitCode;

use super::common::{ForceArg, JsonArg, QuietArg};
use super::logs;
use super::output::{print, print_json};
use report::page::report;
use scenario::kind::Kind;

/// Help below the options.
pub(super) const HELP: &str = "\
The page is one file without external resources. It animates the mission (space, arrow keys; `?` lists the keys) and
shows events, figures, latencies, outcome and scenario. A log that is truncated or lacks topics is shown as far as
possible; the page lists what is missing.

Exit codes: 0 success, 1 the page cannot be written, 2 the file is not a readable Protean log, 3 the log is incomplete
(stderr lists what is missing).";

/// Arguments of `protean report`.
#[derive(Debug, clap::Args)]
pub(super) struct ReportArgs {
    /// Log file
    log: PathBuf,
    /// Write the page to FILE [default: the log's name with .html]
    #[arg(long, short, value_name = "FILE")]
    out: Option<PathBuf>,
    #[command(flatten)]
    force: ForceArg,
    #[command(flatten)]
    json: JsonArg,
    #[command(flatten)]
    quiet: QuietArg,
}

/// Writes the page and prints the file's name.
pub fn run(kinds: &'static [Kind], args: &ReportArgs) -> ExitCode {
    logs::command(args.quiet.quiet, |watch| {
        let out = args.out.clone();
        let out = out.unwrap_or_else(|| args.log.with_extension("html"));
        let report = report(&args.log, kinds, &out, args.force.force, watch)?;
        let code = logs::of_condition(&args.log, &report.condition);
        if args.json.json {
            print_json(&serde_json::json!(report));
        } else {
            print(&out.display().to_string());
        }
        Ok(code)
    })
}
