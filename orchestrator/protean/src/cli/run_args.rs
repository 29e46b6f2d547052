//! Arguments of commands that run a scenario.

use std::path::PathBuf;

use super::common::{ExternalArg, ForceArg, JsonArg, QuietArg, out};
use super::tips;
use platform::output_format::OutputFormat;

/// Default port of the live server; viewers try it first.
pub const DEFAULT_PORT: &str = "8765";

/// Scenario that runs when the command line names none.
pub const DEFAULT_SCENARIO: &str = "chase";

/// Changes to a scenario.
#[derive(Debug, Clone, Default, clap::Args)]
pub struct OverrideArgs {
    /// Seed of all random numbers [default: the scenario's]
    #[arg(long, value_name = "N", value_parser = tips::seed)]
    pub(super) seed: Option<u64>,
    /// Override a value of the scenario, e.g. `rules.time_limit=60`
    #[arg(long = "set", value_name = "KEY=VALUE")]
    pub(super) set: Vec<String>,
    /// Let the scenario use files outside its folder
    #[arg(long)]
    pub(super) allow_outside: bool,
}

/// Arguments of `protean run`, besides the scenario.
#[derive(Debug, Clone, Default, clap::Args)]
#[expect(
    clippy::struct_excessive_bools,
    reason = "one per switch of the command line"
)]
pub struct RunArgs {
    #[command(flatten)]
    pub(super) overrides: OverrideArgs,
    /// Run in real time instead of lock-step, or FACTOR times as fast
    #[arg(long, value_name = "FACTOR", num_args = 0..=1, default_missing_value = "1")]
    pub(super) real_time: Option<f64>,
    /// Run all processes within this one: same result, no latencies, no log unless --out names one
    #[arg(long, conflicts_with = "real_time")]
    pub(super) in_process: bool,
    /// Show the run live in a browser, Foxglove or Lichtblick, on PORT of 127.0.0.1, read-only without --control (0: any free port; implies --pace 1)
    #[arg(long, value_name = "PORT", num_args = 0..=1, default_missing_value = DEFAULT_PORT, conflicts_with = "in_process")]
    pub(super) live: Option<u16>,
    /// With --live: open the page in the browser
    #[arg(long, requires = "live")]
    pub(super) open: bool,
    /// With --live: let the page pause, step and pace the run, and branch it at its end; then it stays until Ctrl-C
    #[arg(long, requires = "live", conflicts_with = "real_time")]
    pub(super) control: bool,
    /// Limit lock-step to FACTOR times real time; the result is the same
    #[arg(long, value_name = "FACTOR", conflicts_with_all = ["real_time", "in_process"])]
    pub(super) pace: Option<f64>,
    /// Show the latency of every hop between processes
    #[arg(long, conflicts_with = "in_process")]
    pub(super) latency: bool,
    /// Write the log to FILE [default: logs/SCENARIO-SEED.mcap]
    #[arg(long, short, value_name = "FILE", value_parser = out(OutputFormat::LOG))]
    pub(super) out: Option<PathBuf>,
    #[command(flatten)]
    pub(super) force: ForceArg,
    #[command(flatten)]
    pub(super) external: ExternalArg,
    #[command(flatten)]
    pub(super) quiet: QuietArg,
    #[command(flatten)]
    pub(super) json: JsonArg,
    /// Least severe level of log lines: error, warn, info, debug or trace
    #[arg(long, value_name = "LEVEL", default_value = "warn")]
    pub(super) log_level: String,
}
