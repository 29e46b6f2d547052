//! Arguments, errors and exit codes that the commands on logs share.

use std::path::Path;
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use mcap_log::{Condition, DerivedError, LogReadError, ReadProgress, Topics};
use platform::eprintln;

use super::output::{EXIT_FAILED, EXIT_INVALID, EXIT_PARTIAL, exit_code_of_mission};
use super::run::handle_signals;
use branch::BranchError;
use replay::ReplayError;

/// Selection of topics.
#[derive(Debug, Clone, clap::Args)]
pub struct TopicArgs {
    /// Take only these topics; `*` matches any text, e.g. `world/*,robot/command`
    #[arg(long, value_name = "TOPIC", value_delimiter = ',')]
    topics: Vec<String>,
    #[command(flatten)]
    exclude: ExcludeArg,
}

/// The option `--exclude`.
#[derive(Debug, Clone, clap::Args)]
pub struct ExcludeArg {
    /// Leave these topics out
    #[arg(long, value_name = "TOPIC", value_delimiter = ',')]
    pub(super) exclude: Vec<String>,
}

impl From<TopicArgs> for Topics {
    fn from(args: TopicArgs) -> Self {
        Self {
            only: args.topics,
            without: args.exclude.exclude,
        }
    }
}

/// Selection of a time span of a log.
#[derive(Debug, clap::Args)]
pub struct SpanArgs {
    /// Start at simulated time T (s)
    #[arg(long, value_name = "T")]
    pub(super) start: Option<f64>,
    /// End at simulated time T (s)
    #[arg(long, value_name = "T")]
    pub(super) end: Option<f64>,
}

/// Selection of a part of a log.
#[derive(Debug, clap::Args)]
pub struct PartArgs {
    #[command(flatten)]
    pub(super) span: SpanArgs,
    #[command(flatten)]
    pub(super) topics: TopicArgs,
}

/// Runs a command on a log until it ends or Ctrl-C interrupts it; prints its error, returns its exit code.
pub fn command(
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

/// Error of a command on a log.
#[derive(Debug, thiserror::Error)]
pub enum CommandError {
    /// The log cannot be read.
    #[error(transparent)]
    Log(#[from] LogReadError),
    /// An output file cannot be written.
    #[error(transparent)]
    Derived(#[from] DerivedError),
    /// An argument is not usable.
    #[error("{0}")]
    Usage(String),
    /// The run cannot be replayed or verified.
    #[error(transparent)]
    Replay(#[from] ReplayError),
    /// The run cannot be branched.
    #[error(transparent)]
    Branch(BranchError),
}

impl From<BranchError> for CommandError {
    fn from(error: BranchError) -> Self {
        match error {
            BranchError::Replay(error) => Self::Replay(error),
            other => Self::Branch(other),
        }
    }
}

impl CommandError {
    fn exit_code(&self) -> u8 {
        match self {
            Self::Log(error) | Self::Replay(ReplayError::Log(error)) => exit_code_of_read(error),
            Self::Branch(_) => EXIT_FAILED,
            Self::Derived(error) => exit_code_of_derived(error),
            Self::Usage(_) | Self::Replay(ReplayError::Bag { .. }) => EXIT_INVALID,
            Self::Replay(ReplayError::Mission(error)) => exit_code_of_mission(error),
        }
    }
}

/// Returns the exit code of a command whose log cannot be read.
pub fn exit_code_of_read(error: &LogReadError) -> u8 {
    match error {
        LogReadError::Interrupted => EXIT_PARTIAL,
        _ => EXIT_INVALID,
    }
}

/// Returns the exit code of a command that cannot write its output.
pub fn exit_code_of_derived(error: &DerivedError) -> u8 {
    match error {
        DerivedError::Log(error) => exit_code_of_read(error),
        DerivedError::Write { .. } => EXIT_FAILED,
        DerivedError::Exists { .. }
        | DerivedError::IsTheLog { .. }
        | DerivedError::Create { .. } => EXIT_INVALID,
    }
}

/// Notes on stderr that another version of the program recorded the log, unless `quiet`.
pub fn note_version(recorded_by: Option<&str>, quiet: bool) {
    if let Some(version) = recorded_by.filter(|_| !quiet) {
        eprintln!(
            "note: recorded by protean {version}, this is {}",
            env!("CARGO_PKG_VERSION")
        );
    }
}

/// Warns of the faults of a file.
pub fn warn_of_faults(log: &Path, faults: &[String]) {
    for fault in faults {
        eprintln!("warning: {}: {fault}", log.display());
    }
}

/// Returns the exit code of a comparison: `same` if no message differs, `whole` if it covers the whole run.
pub fn of_comparison(same: bool, whole: bool) -> ExitCode {
    match (same, whole) {
        (true, true) => ExitCode::SUCCESS,
        (true, false) => ExitCode::from(EXIT_PARTIAL),
        (false, _) => ExitCode::from(EXIT_FAILED),
    }
}

/// Warns of each incomplete log; returns the exit code, which tells if messages of any may be missing.
pub fn of_conditions<'a>(logs: impl Iterator<Item = (&'a Path, &'a Condition)>) -> ExitCode {
    logs.map(|(log, condition)| of_condition(log, condition))
        .fold(ExitCode::SUCCESS, |last, code| {
            if code == ExitCode::SUCCESS {
                last
            } else {
                code
            }
        })
}

/// Warns of an incomplete log; returns the exit code, which tells if messages may be missing.
pub fn of_condition(log: &Path, condition: &Condition) -> ExitCode {
    if condition.is_whole() {
        return ExitCode::SUCCESS;
    }
    eprintln!("warning: {} is incomplete:", log.display());
    for line in condition.lines() {
        eprintln!("    {line}");
    }
    if condition.has_all_messages() {
        eprintln!("    no messages are missing");
        return ExitCode::SUCCESS;
    }
    ExitCode::from(EXIT_PARTIAL)
}
