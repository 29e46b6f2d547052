//! `protean filter`.

use std::path::PathBuf;
use std::process::ExitCode;

use platform::output_format::OutputFormat;

use super::common::{ForceArg, JsonArg, QuietArg, out};
use super::logs::{self, PartArgs};
use super::output::{print, print_json};
use log_tools::{FilterOptions, filter};

/// Help below the options.
pub(super) const HELP: &str = "\
Times are simulated seconds; in logs of other programs, seconds since the first message. With --start, the new log
begins with the last earlier message of every latched topic (world state, map, shapes, coverage, verdicts, viewer
topics, transient-local topics of ROS 2), so that viewers and replays have the state at that time. Manifest, scenario
and attachments are kept. The digest of the run is kept as `run_digest`; it is not the digest of the new log.

Exit codes: 0 success, 1 the new log cannot be written, 2 wrong usage, or the file is not a readable MCAP file,
3 success, but the log is incomplete (stderr lists what is missing).";

/// Arguments of `protean filter`.
#[derive(Debug, clap::Args)]
pub(super) struct FilterArgs {
    /// Log file
    log: PathBuf,
    /// Write the new log to FILE
    #[arg(long, short, value_name = "FILE", value_parser = out(OutputFormat::LOG))]
    out: PathBuf,
    #[command(flatten)]
    part: PartArgs,
    #[command(flatten)]
    force: ForceArg,
    #[command(flatten)]
    json: JsonArg,
    #[command(flatten)]
    quiet: QuietArg,
}

/// Copies a part of a log to a new log.
pub fn run(args: FilterArgs) -> ExitCode {
    let options = FilterOptions {
        start_s: args.part.span.start,
        end_s: args.part.span.end,
        topics: args.part.topics.into(),
        force: args.force.force,
    };
    logs::command(args.quiet.quiet, |watch| {
        let done = filter(&args.log, &args.out, &options, watch)?;
        let code = logs::of_condition(&args.log, &done.source);
        if args.json.json {
            print_json(&serde_json::json!(done));
        } else {
            let late = match done.late_states {
                0 => String::new(),
                n => format!("; {n} earlier states, logged after the start, are left out"),
            };
            print(&format!(
                "{}: {} messages on {} topics, {} of them latched before the start{late}",
                args.out.display(),
                done.messages,
                done.topics,
                done.restored,
            ));
        }
        Ok(code)
    })
}
