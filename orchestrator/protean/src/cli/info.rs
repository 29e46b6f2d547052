//! `protean info`.

use std::path::PathBuf;
use std::process::ExitCode;

use super::common::{JsonArg, QuietArg};
use super::logs;
use super::output::{EXIT_PARTIAL, print, print_json};
use log_tools::{LogInfo, info_text};

/// Help below the options.
pub const HELP: &str = "\
Reads the whole file and verifies every checksum. `lost` counts messages missing from the sequence numbers of their
publishers. Logs of other programs and truncated logs are summarised as far as they can be read.

Exit codes: 0 the log is complete, 2 the file is not a readable MCAP file, 3 the log is incomplete (the output lists
what is missing).";

/// Arguments of `protean info`.
#[derive(Debug, clap::Args)]
pub struct InfoArgs {
    /// Log file
    log: PathBuf,
    #[command(flatten)]
    json: JsonArg,
    #[command(flatten)]
    quiet: QuietArg,
}

/// Prints the summary of a log.
pub fn run(args: &InfoArgs) -> ExitCode {
    logs::command(args.quiet.quiet, |watch| {
        let info = LogInfo::read(&args.log, watch)?;
        if args.json.json {
            print_json(&serde_json::json!(info));
        } else {
            print(&info_text(&info));
        }
        Ok(if info.condition.is_whole() {
            ExitCode::SUCCESS
        } else {
            ExitCode::from(EXIT_PARTIAL)
        })
    })
}
