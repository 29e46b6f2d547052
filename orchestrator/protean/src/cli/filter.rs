//! `protean filter`.

use std::path::PathBuf;
use std::process::ExitCode;

use super::logs::{self, PartArgs};
use super::output::{print, print_json};
use log_tools::{FilterOptions, filter};

/// What stands below the options.
pub(super) const HELP: &str = "\
Times are simulated seconds; in logs of other programs, seconds since the first message. With --start the
last message from before it of every topic that describes a lasting state (the world's state, map, shapes
and coverage, verdicts, the viewers' pictures, what ROS 2 calls transient local) is written at the start,
so that viewers and replays have the world as it was then. Manifest, scenario and attachments are kept.
The digest of the run is kept as `run_digest`: it is not that of the new log.

Exit codes: 0 done, 1 the new log cannot be written, 2 wrong usage, or the file cannot be read or is not
an MCAP file, 3 done, but the log is not whole: what is missing is said.";

/// What `protean filter` takes.
#[derive(Debug, clap::Args)]
pub(super) struct FilterArgs {
    /// A log
    log: PathBuf,
    /// Write the new log to this file
    #[arg(long, short, value_name = "FILE")]
    out: PathBuf,
    #[command(flatten)]
    part: PartArgs,
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

/// Writes a part of a log into a new one.
pub fn run(args: FilterArgs) -> ExitCode {
    let options = FilterOptions {
        start_s: args.part.start,
        end_s: args.part.end,
        topics: args.part.topics.into(),
        force: args.force,
    };
    logs::command(args.quiet, |watch| {
        let done = filter(&args.log, &args.out, &options, watch)?;
        let code = logs::of_condition(&args.log, &done.source);
        if args.json {
            print_json(&serde_json::json!(done));
        } else {
            let late = match done.late_states {
                0 => String::new(),
                n => format!("; {n} older states behind the start are left out"),
            };
            print(&format!(
                "{}: {} messages on {} topics, {} of them from before the start{late}",
                args.out.display(),
                done.messages,
                done.topics,
                done.restored,
            ));
        }
        Ok(code)
    })
}
