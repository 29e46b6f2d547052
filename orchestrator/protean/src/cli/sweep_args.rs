//! The arguments of `protean sweep`.

use std::path::PathBuf;

use clap::Subcommand;
use sweep::Measure;

use platform::output_format::OutputFormat;

use super::common::{ExternalArg, JsonArg, LogPolicyArg, QuietArg, out};
use super::lab;

/// Help below the options.
pub const HELP: &str = "\
A sweep may be interrupted or killed: the same command resumes it and repeats no finished mission. The experiment alone
determines results.csv, byte for byte. docs/reference/experiment.md describes the experiment file and the results.

Exit codes: 0 all missions are done, 1 the results cannot be written, 2 wrong usage or experiment, 3 missions failed or
are missing.";

/// Arguments of `protean sweep`.
#[derive(Debug, clap::Args)]
pub struct SweepArgs {
    #[command(subcommand)]
    pub(super) command: Option<SweepCommand>,
    #[command(flatten)]
    pub(super) run: SweepRunArgs,
}

#[derive(Debug, Subcommand)]
pub enum SweepCommand {
    /// Draw the figures of existing results
    #[command(after_long_help = lab::HELP)]
    Figures(lab::LabArgs),
    /// Merge the results of the shards of an experiment
    Merge {
        /// Directories of the shards
        #[arg(required = true, value_name = "DIR")]
        parts: Vec<PathBuf>,
        /// Write the results to directory DIR, which may contain some of them
        #[arg(long, short, value_name = "DIR", value_parser = out(OutputFormat::FOLDER))]
        out: PathBuf,
        #[command(flatten)]
        json: JsonArg,
    },
}

#[derive(Debug, clap::Args)]
#[expect(
    clippy::struct_excessive_bools,
    reason = "one per switch of the command line"
)]
pub struct SweepRunArgs {
    /// Experiment file
    #[arg(required = true)]
    pub(super) experiment: Option<PathBuf>,
    /// Write the results to directory DIR [default: results/EXPERIMENT, for a shard results/EXPERIMENT/shard-I-of-N]
    #[arg(long, short, value_name = "DIR", value_parser = out(OutputFormat::FOLDER))]
    pub(super) out: Option<PathBuf>,
    /// Run N missions at once [default: number of processors]
    #[arg(long, short, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=4096))]
    pub(super) jobs: Option<u16>,
    /// Seeds A to B, inclusive [default: the experiment's]
    #[arg(long, value_name = "A..B")]
    pub(super) seeds: Option<String>,
    /// Override a value of every scenario, e.g. `rules.time_limit=60`
    #[arg(long = "set", value_name = "KEY=VALUE")]
    pub(super) set: Vec<String>,
    /// Run all processes within this one: same results, many times faster
    #[arg(long)]
    pub(super) in_process: bool,
    /// Run shard I of N: every N-th mission
    #[arg(long, value_name = "I/N")]
    pub(super) shard: Option<String>,
    /// List the missions that would run, and run none
    #[arg(long)]
    pub(super) dry_run: bool,
    /// Run failed missions again
    #[arg(long)]
    pub(super) retry_failed: bool,
    /// Copy missions with the same scenario and seed from other results
    #[arg(long, value_name = "DIR")]
    pub(super) reuse: Vec<PathBuf>,
    /// Missions that keep their log, in folder logs of the results
    #[arg(long, value_name = "WHICH")]
    pub(super) keep_logs: Option<LogPolicyArg>,
    /// List the missions at the worse END, max or min, of a column of results.csv
    #[arg(long, value_name = "COLUMN=END")]
    pub(super) worst: Option<Measure>,
    #[command(flatten)]
    pub(super) external: ExternalArg,
    /// Let the experiment and its scenarios use files outside their folders
    #[arg(long)]
    pub(super) allow_outside: bool,
    #[command(flatten)]
    pub(super) quiet: QuietArg,
    #[command(flatten)]
    pub(super) json: JsonArg,
}
