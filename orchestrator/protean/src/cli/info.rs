//! `protean info`.

use std::path::Path;
use std::process::ExitCode;

use super::logs;
use super::output::{EXIT_PARTIAL, print, print_json};
use log_tools::{LogInfo, info_text};

/// What stands below the options.
pub(super) const HELP: &str = "\
The whole file is read and every checksum in it is checked. `lost` counts the messages that are missing
by the numbers of their senders. Files of other programs and files that end in the middle are described
as far as they go.

Exit codes: 0 the log is whole, 2 it cannot be read or is not an MCAP file, 3 it is not whole: what is
missing is said.";

/// Prints what a log holds.
pub fn info(log: &Path, json: bool, quiet: bool) -> ExitCode {
    logs::command(quiet, |watch| {
        let info = LogInfo::read(log, watch)?;
        if json {
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
