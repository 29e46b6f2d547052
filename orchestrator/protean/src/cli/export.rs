//! `protean export`.

use std::path::PathBuf;
use std::process::ExitCode;

use platform::eprintln;
use tables::Format;

use super::common::{ForceArg, JsonArg, QuietArg};
use super::logs::{self, TopicArgs};
use super::output::{EXIT_PARTIAL, print, print_json};
use log_tools::{ExportOptions, export};

/// Help below the options.
pub(super) const HELP: &str = "\
Every topic with ROS 2 messages becomes a file: `world/state` becomes `world.state.csv`. The viewer topics of a run,
whose names begin with /, repeat the others and are skipped unless --topics selects them. A row is one element of a message (a robot, a particle); it repeats log_time_ns,
publish_time_ns, sequence and the fields of the message. A message without elements is one row. Columns of nested
fields are named `stamp.tick`, elements of short arrays `bounds.0`. Byte arrays are written as text or 0x…; nested
sequences as JSON. Floating-point numbers are written with enough digits to read the same value back.

Exit codes: 0 success, 1 the tables cannot be written, 2 wrong usage, or the file is not a readable MCAP file,
3 messages are missing or could not be decoded (stderr lists them).";

/// Values of `--format`.
#[derive(Debug, Clone, Copy, clap::ValueEnum)]
enum FormatArg {
    /// Comma-separated values
    Csv,
    /// Apache Parquet, with typed columns
    Parquet,
}

impl From<FormatArg> for Format {
    fn from(format: FormatArg) -> Self {
        match format {
            FormatArg::Csv => Self::Csv,
            FormatArg::Parquet => Self::Parquet,
        }
    }
}

/// Arguments of `protean export`.
#[derive(Debug, clap::Args)]
pub(super) struct ExportArgs {
    /// Log file
    log: PathBuf,
    /// Write the tables to directory DIR
    #[arg(long, short, value_name = "DIR")]
    out: PathBuf,
    /// File format of the tables
    #[arg(long, value_enum, default_value_t = FormatArg::Csv)]
    format: FormatArg,
    #[command(flatten)]
    topics: TopicArgs,
    #[command(flatten)]
    force: ForceArg,
    #[command(flatten)]
    json: JsonArg,
    #[command(flatten)]
    quiet: QuietArg,
}

/// Writes the messages of a log to tables.
pub fn run(args: ExportArgs) -> ExitCode {
    let options = ExportOptions {
        format: args.format.into(),
        topics: args.topics.into(),
        force: args.force.force,
    };
    logs::command(args.quiet.quiet, |watch| {
        let done = export(&args.log, &args.out, &options, watch)?;
        let code = logs::of_condition(&args.log, &done.source);
        if args.json.json {
            print_json(&serde_json::json!(done));
        } else {
            for table in done.tables.values() {
                print(&format!("{}: {} rows", table.file.display(), table.rows));
            }
        }
        if !args.quiet.quiet && !done.skipped.is_empty() {
            eprintln!("skipped topics:");
            for (topic, why) in &done.skipped {
                eprintln!("    {topic}: {why}");
            }
        }
        let undecodable: u64 = done.tables.values().map(|table| table.undecodable).sum();
        if undecodable > 0 {
            eprintln!("warning: {undecodable} messages do not match their schema");
            return Ok(ExitCode::from(EXIT_PARTIAL));
        }
        Ok(code)
    })
}
