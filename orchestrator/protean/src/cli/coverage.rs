//! `protean coverage`.

use std::process::ExitCode;

use clap::Subcommand;

use super::output::{EXIT_INVALID, complain, print};
use super::run_args::OverrideArgs;
use plan::routes::coverage::{Extent, plan};
use scenario::Loader;
use scenario::kind::Kind;

/// What `protean coverage` does.
#[derive(Debug, Subcommand)]
pub(super) enum CoverageCommand {
    /// Print the free rectangles, the tour, the sub-goals and what they cover
    #[command(after_long_help = HELP)]
    Plan(PlanArgs),
}

const HELP: &str = "\
Coverage is that of driving straight from sub-goal to sub-goal: the part of the cells with a sub-goal in them
(goals), with a point of the path in them (path), and with a centre that the robot's disc has swept (disc,
cells of 0.1 m), of the cells that the robot's body can cover. With `follow.margin` the planner keeps so much
farther from obstacles and walls than the robot's radius; set it to 0 for the workplace of the Chebyshev
coverage paper.";

/// What `protean coverage plan` takes.
#[derive(Debug, clap::Args)]
pub(super) struct PlanArgs {
    /// A scenario file, or the name of a built-in scenario
    #[arg(default_value = "coverage_open")]
    scenario: String,
    /// Name of the process, if several cover
    #[arg(long, value_name = "NAME")]
    process: Option<String>,
    /// How many large loops [default: 1]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=100_000), conflicts_with_all = ["goals", "way"])]
    loops: Option<u32>,
    /// How many sub-goals
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=10_000_000), conflicts_with = "way")]
    goals: Option<u64>,
    /// As many sub-goals as a way of this length reaches (m)
    #[arg(long, value_name = "LENGTH", value_parser = parse_way)]
    way: Option<f64>,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
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

/// Runs the command.
pub(super) fn coverage(kinds: &[Kind], command: &CoverageCommand) -> ExitCode {
    let CoverageCommand::Plan(args) = command;
    match planned(kinds, args) {
        Ok(text) => {
            print(&text);
            ExitCode::SUCCESS
        }
        Err(error) => {
            complain(&*error);
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
    Ok(if args.json {
        planned.json().to_string()
    } else {
        planned.text()
    })
}
