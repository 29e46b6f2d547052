//! The arguments of `protean sweep`.

use std::path::PathBuf;

use clap::Subcommand;
use sweep::spec::LogPolicy;

/// What stands below the options.
pub(super) const HELP: &str = "\
A sweep may be interrupted and killed at any time: the same command goes on where it stopped, and a
mission that is done is never carried out again. What it results in (results.csv, byte for byte)
depends on the experiment alone. docs/reference/experiment.md describes the experiment file and the results.

Exit codes: 0 everything is done, 1 the results cannot be kept, 2 wrong usage or experiment,
3 some missions failed or are missing.";

/// Which missions keep their log.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(super) enum LogPolicyArg {
    /// None, and none is written: the fastest.
    None,
    /// Those that failed. All are written, and removed when the mission went well.
    Failed,
    /// All of them.
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

/// What `protean sweep` takes.
#[derive(Debug, clap::Args)]
pub(super) struct SweepArgs {
    #[command(subcommand)]
    pub(super) command: Option<SweepCommand>,
    #[command(flatten)]
    pub(super) run: SweepRunArgs,
}

#[derive(Debug, Subcommand)]
pub(super) enum SweepCommand {
    /// Draw the figures of results again
    Figures {
        /// The directory of the results
        #[arg(value_name = "DIR")]
        results: PathBuf,
    },
    /// Put the results of an experiment's parts together
    Merge {
        /// The directories of the parts
        #[arg(required = true, value_name = "DIR")]
        parts: Vec<PathBuf>,
        /// Where the results go; it may hold some of them already
        #[arg(long, short, value_name = "DIR")]
        out: PathBuf,
        /// Print one JSON object
        #[arg(long)]
        json: bool,
    },
}

#[derive(Debug, clap::Args)]
#[expect(
    clippy::struct_excessive_bools,
    reason = "one per switch of the command line"
)]
pub(super) struct SweepRunArgs {
    /// The experiment's file
    pub(super) experiment: Option<PathBuf>,
    /// Where the results go [default: results/EXPERIMENT, and shard-I-of-N below it for a shard]
    #[arg(long, short, value_name = "DIR")]
    pub(super) out: Option<PathBuf>,
    /// Missions at once [default: as many as there are processors]
    #[arg(long, short, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=4096))]
    pub(super) jobs: Option<u16>,
    /// Seeds in place of the experiment's: A..B, both included
    #[arg(long, value_name = "A..B")]
    pub(super) seeds: Option<String>,
    /// Override a value of every scenario
    #[arg(long = "set", value_name = "KEY=VALUE")]
    pub(super) set: Vec<String>,
    /// Run every mission inside this program instead of as processes: the same results, many times faster
    #[arg(long)]
    pub(super) in_process: bool,
    /// Only part I of N: every N-th mission
    #[arg(long, value_name = "I/N")]
    pub(super) shard: Option<String>,
    /// List the missions that would be carried out, and do nothing
    #[arg(long)]
    pub(super) dry_run: bool,
    /// Carry out missions again that failed before
    #[arg(long)]
    pub(super) retry_failed: bool,
    /// Take over missions of other results whose scenario and seed are the same
    #[arg(long, value_name = "DIR")]
    pub(super) reuse: Vec<PathBuf>,
    /// Which missions keep their log, in the results' folder logs
    #[arg(long, value_name = "WHICH")]
    pub(super) log: Option<LogPolicyArg>,
    /// Let scenarios start programs that are not Protean's own
    #[arg(long)]
    pub(super) allow_external: bool,
    /// Let the experiment and its scenarios use files outside their folders
    #[arg(long)]
    pub(super) allow_outside: bool,
    /// Show nothing but errors and the result
    #[arg(long, short)]
    pub(super) quiet: bool,
    /// Print the result as one JSON object
    #[arg(long)]
    pub(super) json: bool,
}
