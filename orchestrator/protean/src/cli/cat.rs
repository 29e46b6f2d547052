//! `protean cat`.

use std::io::{self, BufWriter, ErrorKind, Write as _};
use std::num::NonZeroU64;
use std::ops::ControlFlow;
use std::path::PathBuf;
use std::process::ExitCode;

use log_tools::{CatOptions, cat};
use mcap_log::Topics;
use platform::eprintln;
use platform::terminal::escape_controls;

use super::logs::{self, ExcludeArg, SpanArgs};
use super::output::EXIT_FAILED;

/// Help below the options.
pub const HELP: &str = "\
Prints one line for every message, in the order of the log:

  {\"topic\":\"robot/command\",\"log_time_s\":0.05,\"message\":{…}}

ROS 2 messages are decoded with the schema in the log; byte arrays become text or 0x…. JSON messages are printed as
they are. Messages in other encodings have the fields `bytes` (length) and `note` (reason) instead of `message`.
Floating-point numbers have a point or an exponent; those that are not finite become null.

Examples:
  protean cat logs/chase-1.mcap --limit 5
  protean cat logs/chase-1.mcap robot/command | jq .message

Exit codes: 0 success, 1 the output cannot be written, 2 wrong usage, or the file is not a readable MCAP file,
3 interrupted, or messages of the log are missing.";

/// Arguments of `protean cat`.
#[derive(Debug, clap::Args)]
pub struct CatArgs {
    /// Log file
    log: PathBuf,
    /// Topics [default: all]; `*` matches any text, e.g. `'world/*'`
    #[arg(value_name = "TOPIC")]
    topics: Vec<String>,
    /// Topics as other commands take them
    #[arg(long = "topics", hide = true, value_delimiter = ',')]
    more_topics: Vec<String>,
    #[command(flatten)]
    exclude: ExcludeArg,
    #[command(flatten)]
    span: SpanArgs,
    /// Stop after N messages
    #[arg(long, value_name = "N")]
    limit: Option<NonZeroU64>,
}

/// Prints the messages of a log.
pub fn run(args: CatArgs) -> ExitCode {
    let options = CatOptions {
        start_s: args.span.start,
        end_s: args.span.end,
        topics: Topics {
            only: [args.topics, args.more_topics].concat(),
            without: args.exclude.exclude,
        },
        limit: args.limit,
    };
    // Progress would mix with the messages.
    let quiet = true;
    logs::command(quiet, |watch| {
        let mut out = BufWriter::new(io::stdout().lock());
        let mut written = Ok(());
        let condition = cat(&args.log, &options, watch, |line| {
            written = writeln!(out, "{}", escape_controls(line));
            match written {
                Ok(()) => ControlFlow::Continue(()),
                Err(_) => ControlFlow::Break(()),
            }
        })?;
        match written.and_then(|()| out.flush()) {
            Ok(()) => Ok(condition.map_or(ExitCode::SUCCESS, |condition| {
                logs::of_condition(&args.log, &condition)
            })),
            // `protean cat LOG | head` reads no further.
            Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(ExitCode::SUCCESS),
            Err(error) => {
                eprintln!("error: cannot write to stdout: {error}");
                Ok(ExitCode::from(EXIT_FAILED))
            }
        }
    })
}
