//! `protean export`.

use std::path::PathBuf;
use std::process::ExitCode;

use platform::eprintln;
use tables::Format;

use super::logs::{self, TopicArgs};
use super::output::{EXIT_PARTIAL, print, print_json};
use log_tools::{ExportOptions, export};

/// What stands below the options.
pub(super) const HELP: &str = "\
Every topic of ROS 2 messages (all of ours but the viewers', and those of ROS 2 itself) becomes a file,
`world/state` for example `world.state.csv`. A row is an element of a message (a robot, a particle), behind
log_time_ns, publish_time_ns, sequence and the fields of the message; a message without elements has one
row. Nested fields are called `stamp.tick`, elements of short arrays `bounds.0`; bytes are text or 0x…,
sequences within elements JSON. Numbers are written so that they read back to the same bits.

Exit codes: 0 done, 1 the tables cannot be written, 2 wrong usage, or the file cannot be read or is not
an MCAP file, 3 done, but messages are missing or could not be decoded: which, is said.";

/// The form of the tables, as the option names it.
#[derive(Debug, Clone, Copy, clap::ValueEnum)]
enum FormatArg {
    /// Text, a line for every row.
    Csv,
    /// Apache Parquet, with a type for every column.
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

/// What `protean export` takes.
#[derive(Debug, clap::Args)]
pub(super) struct ExportArgs {
    /// A log
    log: PathBuf,
    /// Write the tables into this directory
    #[arg(long, short, value_name = "DIR")]
    out: PathBuf,
    /// Form of the tables
    #[arg(long, value_enum, default_value_t = FormatArg::Csv)]
    format: FormatArg,
    #[command(flatten)]
    topics: TopicArgs,
    /// Write into a directory that is not empty, over tables of the same names
    #[arg(long)]
    force: bool,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
    /// Show nothing but errors and the result
    #[arg(long, short)]
    quiet: bool,
}

/// Writes the messages of a log as tables.
pub fn run(args: ExportArgs) -> ExitCode {
    let options = ExportOptions {
        format: args.format.into(),
        topics: args.topics.into(),
        force: args.force,
    };
    logs::command(args.quiet, |watch| {
        let done = export(&args.log, &args.out, &options, watch)?;
        let code = logs::of_condition(&args.log, &done.source);
        if args.json {
            print_json(&serde_json::json!(done));
        } else {
            for table in done.tables.values() {
                print(&format!("{}: {} rows", table.file.display(), table.rows));
            }
        }
        if !args.quiet && !done.skipped.is_empty() {
            eprintln!("no tables of:");
            for (topic, why) in &done.skipped {
                eprintln!("    {topic}: {why}");
            }
        }
        let undecodable: u64 = done.tables.values().map(|table| table.undecodable).sum();
        if undecodable > 0 {
            eprintln!("warning: {undecodable} messages do not have the form of their schema");
            return Ok(ExitCode::from(EXIT_PARTIAL));
        }
        Ok(code)
    })
}
