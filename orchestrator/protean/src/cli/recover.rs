//! `protean recover`.

use std::path::PathBuf;
use std::process::ExitCode;

use platform::output_format::OutputFormat;

use super::common::{ForceArg, JsonArg, QuietArg, out};
use super::logs;
use super::output::{print, print_json};
use log_tools::{RecoveryReport, recover};
use recorder::time_text;

/// Help below the options.
pub const HELP: &str = "\
Copies every complete chunk with a correct checksum to a new log, and writes an index and a summary. Messages keep
their order, times and sequence numbers. The damaged log is not changed. Of logs joined end to end, the second becomes
FILE with `_2` at the end of its name, and so on.

Exit codes: 0 no messages were missing, 1 the new log cannot be written, 2 wrong usage, or the file is not a readable
MCAP file, 3 messages are lost, or bytes follow the log (stderr lists them).";

/// Arguments of `protean recover`.
#[derive(Debug, clap::Args)]
pub struct RecoverArgs {
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

fn text(done: &RecoveryReport) -> String {
    let lost = match done.lost {
        _ if done.source.data => String::new(),
        Some(lost) => format!(", {lost} lost"),
        None => ", unknown number lost".to_owned(),
    };
    format!(
        "{}: {} messages up to {} s{lost}, {} attachments, {} metadata records",
        done.out.display(),
        done.messages,
        time_text(done.end_s),
        done.attachments,
        done.metadata,
    )
}

/// Repairs a log.
pub fn run(args: &RecoverArgs) -> ExitCode {
    logs::command(args.quiet.quiet, |watch| {
        let done = recover(&args.log, &args.out, args.force.force, watch)?;
        let all = || std::iter::once(&done).chain(&done.further);
        let code = logs::of_conditions(all().map(|done| (&*args.log, &done.source)));
        if args.json.json {
            print_json(&serde_json::json!(done));
        } else {
            let lines: Vec<String> = all().map(text).collect();
            print(&lines.join("\n"));
        }
        Ok(code)
    })
}
