//! `protean recover`.

use std::path::PathBuf;
use std::process::ExitCode;

use super::logs;
use super::output::{print, print_json};
use log_tools::recover;

/// What stands below the options.
pub(super) const HELP: &str = "\
Writes everything that can be read into a new log with an index and a summary: every whole chunk whose
checksum fits. The messages keep their order, times and numbers. The log itself stays as it is.

Exit codes: 0 no data were missing, 1 the new log cannot be written, 2 the file cannot be read or is not
an MCAP file, 3 something is lost: what, is said.";

/// What `protean recover` takes.
#[derive(Debug, clap::Args)]
pub(super) struct RecoverArgs {
    /// A log that ends in the middle, or is damaged
    log: PathBuf,
    /// Write the new log to this file
    #[arg(long, short, value_name = "FILE")]
    out: PathBuf,
    /// Overwrite the file if it exists
    #[arg(long)]
    force: bool,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
    /// Show nothing but errors and the result
    #[arg(long, short)]
    quiet: bool,
}

/// Makes a log that can be opened from one that is not whole.
pub fn run(args: &RecoverArgs) -> ExitCode {
    logs::command(args.quiet, |watch| {
        let done = recover(&args.log, &args.out, args.force, watch)?;
        let code = logs::of_condition(&args.log, &done.source);
        if args.json {
            print_json(&serde_json::json!(done));
        } else {
            let lost = match done.lost {
                _ if done.source.data => String::new(),
                Some(lost) => format!(", {lost} lost"),
                None => ", how many are lost is not known".to_owned(),
            };
            print(&format!(
                "{}: {} messages up to {:.2} s{lost}, {} attachments, {} metadata records",
                args.out.display(),
                done.messages,
                done.end_s,
                done.attachments,
                done.metadata,
            ));
        }
        Ok(code)
    })
}
