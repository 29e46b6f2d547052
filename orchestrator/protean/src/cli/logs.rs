//! What `info`, `recover`, `filter`, `export` and `rerun` have in common.

use std::path::Path;
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use mcap_log::{Condition, DerivedError, LogReadError, ReadProgress, Topics};
use platform::eprintln;

use super::output::{EXIT_FAILED, EXIT_INVALID, EXIT_PARTIAL};
use super::run::handle_signals;
use log_tools::Difference;
use replay::ReplayError;

/// Which topics.
#[derive(Debug, clap::Args)]
pub(super) struct TopicArgs {
    /// Only these topics; `*` stands for any letters: `--topics 'world/*,robot/command'`
    #[arg(long, value_name = "TOPIC", value_delimiter = ',')]
    topics: Vec<String>,
    /// Without these topics
    #[arg(long, value_name = "TOPIC", value_delimiter = ',')]
    exclude: Vec<String>,
}

impl From<TopicArgs> for Topics {
    fn from(args: TopicArgs) -> Self {
        Self {
            only: args.topics,
            without: args.exclude,
        }
    }
}

/// Which part of a log.
#[derive(Debug, clap::Args)]
pub(super) struct PartArgs {
    /// From this simulated time on (s)
    #[arg(long, value_name = "T")]
    pub(super) start: Option<f64>,
    /// Up to this simulated time (s)
    #[arg(long, value_name = "T")]
    pub(super) end: Option<f64>,
    #[command(flatten)]
    pub(super) topics: TopicArgs,
}

/// Does something with a log that can be interrupted, and says how it ended.
pub(super) fn command(
    quiet: bool,
    work: impl FnOnce(&mut ReadProgress) -> Result<ExitCode, CommandError>,
) -> ExitCode {
    let interrupted = Arc::new(AtomicBool::new(false));
    if let Err(error) = handle_signals(&interrupted) {
        eprintln!("error: cannot handle signals: {error}");
        return ExitCode::from(EXIT_FAILED);
    }
    let mut watch = ReadProgress::new(interrupted, quiet);
    work(&mut watch).unwrap_or_else(|error| {
        eprintln!("error: {error}");
        ExitCode::from(error.exit_code())
    })
}

/// Why a command on a log failed.
#[derive(Debug, thiserror::Error)]
pub(super) enum CommandError {
    /// The log cannot be read.
    #[error(transparent)]
    Log(#[from] LogReadError),
    /// A file cannot be made from the log.
    #[error(transparent)]
    Derived(#[from] DerivedError),
    /// The run cannot be done again.
    #[error(transparent)]
    Replay(#[from] ReplayError),
}

impl CommandError {
    fn exit_code(&self) -> u8 {
        match self {
            Self::Log(error) | Self::Replay(ReplayError::Log(error)) => exit_code_of_read(error),
            Self::Derived(error) => exit_code_of_derived(error),
            Self::Replay(ReplayError::Mission(_)) => EXIT_FAILED,
        }
    }
}

/// The exit code of a command whose log cannot be read.
pub(super) fn exit_code_of_read(error: &LogReadError) -> u8 {
    match error {
        LogReadError::Interrupted => EXIT_PARTIAL,
        _ => EXIT_INVALID,
    }
}

/// The exit code of a command that cannot make its file from a log.
pub(super) fn exit_code_of_derived(error: &DerivedError) -> u8 {
    match error {
        DerivedError::Log(error) => exit_code_of_read(error),
        DerivedError::Write { .. } => EXIT_FAILED,
        DerivedError::Exists { .. } | DerivedError::IsTheLog { .. } => EXIT_INVALID,
    }
}

/// Says that a log is of another version than the program that does it again.
pub(super) fn note_version(recorded_by: Option<&str>) {
    if let Some(version) = recorded_by {
        eprintln!(
            "note: recorded by protean {version}, done again by {}",
            env!("CARGO_PKG_VERSION")
        );
    }
}

/// The first difference of a topic, for people.
pub(super) fn difference(topic: &str, first: &Difference) -> String {
    let or_none = |value: &str| match value {
        "" => "nothing".to_owned(),
        value => value.to_owned(),
    };
    format!(
        "{topic}: {} messages, the first at tick {} ({:.2} s) from source {}: {} {} in the log, {} now",
        first.messages,
        first.tick,
        first.time_s,
        first.source,
        first.field,
        or_none(&first.logged),
        or_none(&first.again)
    )
}

/// The exit code of a comparison: whether all is the same, and whether that is the whole run.
pub(super) fn of_comparison(same: bool, whole: bool) -> ExitCode {
    match (same, whole) {
        (true, true) => ExitCode::SUCCESS,
        (true, false) => ExitCode::from(EXIT_PARTIAL),
        (false, _) => ExitCode::from(EXIT_FAILED),
    }
}

/// Warns of a log that is not whole; the exit code says whether messages may be missing.
pub(super) fn of_condition(log: &Path, condition: &Condition) -> ExitCode {
    if condition.is_whole() {
        return ExitCode::SUCCESS;
    }
    eprintln!("warning: {} is not whole:", log.display());
    for line in condition.lines() {
        eprintln!("    {line}");
    }
    if condition.data {
        eprintln!("    nothing of its data is missing");
        return ExitCode::SUCCESS;
    }
    ExitCode::from(EXIT_PARTIAL)
}
