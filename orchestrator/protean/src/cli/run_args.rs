//! Arguments of commands that run a scenario.

use std::path::PathBuf;

/// Port on which viewers look for a live server.
pub(super) const DEFAULT_PORT: &str = "8765";

/// Scenario that runs when none is named.
pub(super) const DEFAULT_SCENARIO: &str = "chase";

/// Changes to a scenario.
#[derive(Debug, Clone, Default, clap::Args)]
pub(super) struct OverrideArgs {
    /// Seed of everything random, in place of the scenario's
    #[arg(long, value_name = "N")]
    pub(super) seed: Option<u64>,
    /// Override a value of the scenario, e.g. `rules.time_limit=60` or `robots.police_1.limits.v_max=0.5`
    #[arg(long = "set", value_name = "KEY=VALUE")]
    pub(super) set: Vec<String>,
    /// Let the scenario use files outside its folder
    #[arg(long)]
    pub(super) allow_outside: bool,
}

/// How to run.
#[derive(Debug, Clone, Default, clap::Args)]
#[expect(
    clippy::struct_excessive_bools,
    reason = "one per switch of the command line"
)]
pub(super) struct RunArgs {
    #[command(flatten)]
    pub(super) overrides: OverrideArgs,
    /// Run by the clock instead of in lock-step, FACTOR times as fast as reality
    #[arg(long, value_name = "FACTOR", num_args = 0..=1, default_missing_value = "1")]
    pub(super) real_time: Option<f64>,
    /// Run everything in this process instead of one per robot: the same result, no latencies, and
    /// no log unless --out asks for one
    #[arg(long, conflicts_with = "real_time")]
    pub(super) in_process: bool,
    /// Show the run live to Foxglove or Lichtblick, at --pace 1 if not said: serves what goes into the
    /// log on this port of 127.0.0.1, read-only, at an address with a secret that is printed
    /// (0: any free port)
    #[arg(long, value_name = "PORT", num_args = 0..=1, default_missing_value = DEFAULT_PORT, conflicts_with = "in_process")]
    pub(super) live: Option<u16>,
    /// In lock-step, go on at most FACTOR times as fast as reality; the result stays the same
    #[arg(long, value_name = "FACTOR", conflicts_with_all = ["real_time", "in_process"])]
    pub(super) pace: Option<f64>,
    /// Write the log to this file [default: logs/SCENARIO-SEED.mcap]
    #[arg(long, short, value_name = "FILE")]
    pub(super) out: Option<PathBuf>,
    /// Overwrite the log if it exists
    #[arg(long)]
    pub(super) force: bool,
    /// Let the scenario start programs that are not Protean's own
    #[arg(long)]
    pub(super) allow_external: bool,
    /// Show nothing but errors and the result
    #[arg(long, short)]
    pub(super) quiet: bool,
    /// Print the outcome as one JSON object
    #[arg(long)]
    pub(super) json: bool,
    /// Least severe level that the processes log: error, warn, info, debug or trace
    #[arg(long, value_name = "LEVEL", default_value = "warn")]
    pub(super) log_level: String,
}
