//! `protean recover`.

use std::path::PathBuf;
use std::process::ExitCode;

use platform::output_format::OutputFormat;

use super::common::{ForceArg, JsonArg, QuietArg, out};
use super::logs;
use super::output::{print, print_json};
use log_tools::recover;

/// Help below the options.
pub(super) const HELP: &str = "\
Copies every complete chunk with a correct checksum to a new log, and writes an index and a summary. Messages keep
their order, times and sequence numbers. The damaged log is not changed.

Exit codes: 0 no messages were missing, 1 the new log cannot be written, 2 wrong usage, or the file is not a readable
MCAP file, 3 messages are lost (stderr lists what is missing).";

/// Arguments of `protean recover`.
#[derive(Debug, clap::Args)]
pub(super) struct RecoverArgs {
    /// Truncated or damaged log file
    log: PathBuf,
    /// Write the new log to FILE
    #[arg(long, short, value_name = "FILE", value_parser = out(OutputFormat::LOG))]
    out: PathBuf,
    #[command(flatten)]
    force: ForceArg,
    #[command(flatten)]
    json: JsonArg,
    #[command(flatten)]
    quiet: QuietArg,
}

/// Repairs a log.
pub fn run(args: &RecoverArgs) -> ExitCode {
    logs::command(args.quiet.quiet, |watch| {
        let done = recover(&args.log, &args.out, args.force.force, watch)?;
        let code = logs::of_condition(&args.log, &done.source);
        if args.json.json {
            print_json(&serde_json::json!(done));
        } else {
            let lost = match done.lost {
                _ if done.source.data => String::new(),
                Some(lost) => format!(", {lost} lost"),
                None => ", unknown number lost".to_owned(),
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
