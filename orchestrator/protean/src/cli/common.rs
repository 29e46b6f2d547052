//! Options with one meaning in every command.

use std::path::PathBuf;

use clap::builder::{PathBufValueParser, TypedValueParser};
use platform::output_format::OutputFormat;
use sweep::spec::LogPolicy;

/// The text of an argument is not a value of its option.
#[derive(Debug, thiserror::Error)]
#[error("expected {0}")]
pub struct Expected(pub(super) String);

/// Returns the parser of an output file's name, which may not have the ending of another format.
pub fn out(format: OutputFormat) -> impl TypedValueParser<Value = PathBuf> {
    PathBufValueParser::new().try_map(move |file| format.check(file))
}

/// The option `--json`.
#[derive(Debug, Clone, Default, clap::Args)]
pub struct JsonArg {
    /// Print one JSON object
    #[arg(long)]
    pub(super) json: bool,
}

/// The option `--force`.
#[derive(Debug, Clone, Default, clap::Args)]
pub struct ForceArg {
    /// Overwrite existing output
    #[arg(long)]
    pub(super) force: bool,
}

/// The option `--quiet`.
#[derive(Debug, Clone, Default, clap::Args)]
pub struct QuietArg {
    /// Print only the result and errors: no progress, events, notes or statistics
    #[arg(long, short)]
    pub(super) quiet: bool,
}

/// The option `--allow-external`.
#[derive(Debug, Clone, Default, clap::Args)]
pub struct ExternalArg {
    /// Start external programs that the scenario names, without asking
    #[arg(long)]
    pub(super) allow_external: bool,
}

/// Missions that keep their log.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum LogPolicyArg {
    /// No mission; no log is written
    None,
    /// Failed missions; the logs of the others are removed
    Failed,
    /// All missions
    All,
}

impl From<LogPolicyArg> for LogPolicy {
    fn from(policy: LogPolicyArg) -> Self {
        match policy {
            LogPolicyArg::None => Self::None,
            LogPolicyArg::Failed => Self::Failed,
            LogPolicyArg::All => Self::All,
        }
    }
}
