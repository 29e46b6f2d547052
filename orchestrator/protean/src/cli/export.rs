//! `protean export`.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use platform::eprintln;
use platform::output_format::OutputFormat;
use tables::Format;

use super::common::{ForceArg, JsonArg, QuietArg, out};
use super::logs::{self, TopicArgs};
use super::output::{EXIT_PARTIAL, print, print_json};
use log_tools::{ExportOptions, Ros2Bag, export, ros2bag};

/// Help below the options.
pub const HELP: &str = "\
With --out, every topic with ROS 2 messages becomes a table: `world/state` becomes `world.state.csv`. The viewer topics
of a run, whose names begin with /, repeat the others and are skipped unless --topics selects them. A row is one element
of a message (a robot, a particle); it repeats log_time_ns, publish_time_ns, sequence and the fields of the message. A
message without elements is one row. Columns of nested fields are named `stamp.tick`, elements of short arrays
`bounds.0`. The index of a robot (`robot`) has a second column with its name (`robot_name`), last in the table. A field
with the name of an earlier column becomes `sequence_2`. Byte arrays are written as text or 0x…; nested sequences as
JSON. In CSV, floating-point numbers have a point or an exponent and enough digits to read the same value back;
infinity is 1e999, which pandas, polars and DuckDB read as infinite.

The table `patrols` has the idleness of patrols over time: a row for each patrol and state of the world, with mean and
maximum over the places of the time since the last visit, the place of the maximum, and the share of the places visited
so far. The table `beliefs` has the errors of the beliefs about robots in play: the share of the particles' weight that is
nearer to the mean than the true position, by the covariance; distance of the mean from it; deviation; squared error by
the covariance; effective number of particles. --topics selects both like topics.

With --ros2bag, the directory gets a copy of the log and the metadata.yaml that `ros2 bag` expects.

Exit codes: 0 success, 1 the files cannot be written, 2 wrong usage, or the file is not a readable MCAP file,
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
pub struct ExportArgs {
    /// Log file
    log: PathBuf,
    /// Write the tables to directory DIR
    #[arg(long, short, value_name = "DIR", required_unless_present = "ros2bag", value_parser = out(OutputFormat::FOLDER))]
    out: Option<PathBuf>,
    /// Write a ROS 2 bag to directory DIR instead of tables
    #[arg(long, value_name = "DIR", conflicts_with_all = ["out", "format", "topics", "exclude"], value_parser = out(OutputFormat::FOLDER))]
    ros2bag: Option<PathBuf>,
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

/// Exports a log.
pub fn run(args: &ExportArgs) -> ExitCode {
    match (&args.ros2bag, &args.out) {
        (Some(out), _) => bag(args, out),
        (None, out) => tables(args, out.as_deref().unwrap_or(Path::new("."))),
    }
}

/// Writes a log as a ROS 2 bag.
fn bag(args: &ExportArgs, out: &Path) -> ExitCode {
    logs::command(args.quiet.quiet, |watch| {
        let bag = ros2bag(&args.log, out, args.force.force, watch)?;
        if args.json.json {
            print_json(&serde_json::json!(bag));
        } else {
            let Ros2Bag {
                log,
                metadata,
                messages,
                topics,
            } = bag;
            print(&format!(
                "{}: {messages} messages of {topics} topics",
                log.display()
            ));
            print(&metadata.display().to_string());
        }
        Ok(ExitCode::SUCCESS)
    })
}

/// Writes the messages of a log to tables.
fn tables(args: &ExportArgs, out: &Path) -> ExitCode {
    let options = ExportOptions {
        format: args.format.into(),
        topics: args.topics.clone().into(),
        force: args.force.force,
    };
    logs::command(args.quiet.quiet, |watch| {
        let done = export(&args.log, out, &options, watch)?;
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
        let mut code = code;
        for (topic, table) in &done.tables {
            if let Some(fault) = &table.fault {
                let count = table.undecodable;
                eprintln!("warning: {topic}: {count} messages do not match their schema: {fault}");
                code = ExitCode::from(EXIT_PARTIAL);
            }
        }
        Ok(code)
    })
}
