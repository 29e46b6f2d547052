//! `protean report`.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use platform::eprintln;
use platform::output_format::OutputFormat;

use super::common::{ForceArg, JsonArg, QuietArg, out};
use super::logs;
use super::output::{EXIT_FAILED, print, print_json};
use report::page::report;

/// Help below the options.
pub const HELP: &str = "\
The page is one file without external resources. It animates the mission (space, arrow keys; `?` lists the keys) and
shows events, figures, latencies, outcome and scenario. Two logs are shown side by side with one clock. A log that is truncated or lacks topics is shown as far as
possible; the page lists what is missing.

Exit codes: 0 success, 1 the page cannot be written or shown, 2 the file is not a readable Protean log, 3 the log is incomplete
(stderr lists what is missing).";

/// Arguments of `protean report`.
#[derive(Debug, clap::Args)]
pub struct ReportArgs {
    /// Log file; two: side by side
    #[arg(value_name = "LOG", required = true, num_args = 1..=2)]
    logs: Vec<PathBuf>,
    /// Write the page to FILE [default: the log's name with .html; of two logs: FIRST-SECOND.html]
    #[arg(long, short, value_name = "FILE", value_parser = out(OutputFormat::PAGE))]
    out: Option<PathBuf>,
    /// Show the page in the browser (xdg-open)
    #[arg(long)]
    open: bool,
    #[command(flatten)]
    force: ForceArg,
    #[command(flatten)]
    json: JsonArg,
    #[command(flatten)]
    quiet: QuietArg,
}

/// Writes the page and prints the file's name.
pub fn run(args: &ReportArgs) -> ExitCode {
    logs::command(args.quiet.quiet, |watch| {
        let logs: Vec<&Path> = args.logs.iter().map(PathBuf::as_path).collect();
        let out = args.out.clone().unwrap_or_else(|| page_of(&logs));
        let reports = report(&logs, &out, args.force.force, None, watch)?;
        let conditions = reports.iter().map(|report| &report.condition);
        let code = logs::of_conditions(logs.iter().copied().zip(conditions));
        match &*reports {
            _ if !args.json.json => print(&out.display().to_string()),
            [report] => print_json(&serde_json::json!(report)),
            reports => print_json(&serde_json::json!(reports)),
        }
        if args.open
            && let Err(why) = platform::browser::open(&out)
        {
            eprintln!(
                "error: cannot show the page with xdg-open: {why}; open {} in a browser",
                out.display()
            );
            return Ok(ExitCode::from(EXIT_FAILED));
        }
        Ok(code)
    })
}

/// File for the page of these logs, beside the first.
fn page_of(logs: &[&Path]) -> PathBuf {
    let names = logs.iter().filter_map(|log| log.file_stem());
    let names: Vec<_> = names.map(|name| name.to_string_lossy()).collect();
    let first = logs.first().copied().unwrap_or(Path::new(""));
    first.with_file_name(format!("{}.html", names.join("-")))
}
