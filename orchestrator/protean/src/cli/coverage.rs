//! `protean coverage`.

use std::process::ExitCode;

use clap::Subcommand;

use super::common::JsonArg;
use super::output::{EXIT_INVALID, print, print_error};
use super::run_args::OverrideArgs;
use plan::routes::coverage::{Extent, plan};
use scenario::Loader;
use scenario::kind::Kind;

/// Subcommands of `protean coverage`.
#[derive(Debug, Subcommand)]
pub(super) enum CoverageCommand {
    /// Print free rectangles, tour, sub-goals and their coverage
    #[command(after_long_help = HELP)]
    Plan(PlanArgs),
}

/// Help below the options.
const HELP: &str = "\
Coverage assumes that the robot drives straight from sub-goal to sub-goal. It is the share of the cells that the
robot's body can cover: cells with a sub-goal (goals), cells with a point of the path (path), and cells whose centre
the robot's disc sweeps (disc, cells of 0.1 m). `follow.margin` (m) is the distance that the planner keeps from obstacles
and walls in addition to the robot's radius; 0 gives the workspace of the Chebyshev coverage paper.";

/// Arguments of `protean coverage plan`.
#[derive(Debug, clap::Args)]
pub(super) struct PlanArgs {
    /// Scenario file, or name of a built-in scenario (see `protean list`)
    #[arg(default_value = "coverage_open")]
    scenario: String,
    /// Process of the scenario; required if several cover
    #[arg(long, value_name = "NAME")]
    process: Option<String>,
    /// Number of large loops [default: 1]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=100_000), conflicts_with_all = ["goals", "way"])]
    loops: Option<u32>,
    /// Number of sub-goals
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=10_000_000), conflicts_with = "way")]
    goals: Option<u64>,
    /// Number of sub-goals, given as the length of the path through them (m)
    #[arg(long, value_name = "LENGTH", value_parser = parse_way)]
    way: Option<f64>,
    #[command(flatten)]
    json: JsonArg,
    #[command(flatten)]
    overrides: OverrideArgs,
}

fn parse_way(text: &str) -> Result<f64, String> {
    let way: f64 = text.parse().map_err(|e| format!("{e}"))?;
    if way > 0.0 && way <= 1e7 {
        Ok(way)
    } else {
        Err("expected a length above 0 and at most 10000000 (m)".into())
    }
}

/// Runs `protean coverage`.
pub(super) fn coverage(kinds: &[Kind], command: &CoverageCommand) -> ExitCode {
    let CoverageCommand::Plan(args) = command;
    match planned(kinds, args) {
        Ok(text) => {
            print(&text);
            ExitCode::SUCCESS
        }
        Err(error) => {
            print_error(&*error);
            ExitCode::from(EXIT_INVALID)
        }
    }
}

fn planned(kinds: &[Kind], args: &PlanArgs) -> Result<String, Box<dyn std::error::Error>> {
    let scenario = Loader::new(kinds)
        .allow_outside(args.overrides.allow_outside)
        .load(&args.scenario, &args.overrides.set, args.overrides.seed)?;
    let extent = match (args.goals, args.way) {
        (Some(goals), _) => Extent::Goals(goals),
        (None, Some(way)) => Extent::Way(way),
        (None, None) => Extent::Loops(args.loops.unwrap_or(1)),
    };
    let planned = plan(&scenario, args.process.as_deref(), extent)?;
    Ok(if args.json.json {
        planned.json().to_string()
    } else {
        planned.text()
    })
}
