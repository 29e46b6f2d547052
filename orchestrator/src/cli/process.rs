//! `protean process`: being one process of a run.

use std::path::Path;
use std::process::ExitCode;

use kit::planner::PlannerProcess;

use super::EXIT_INVALID;
use crate::bench;

/// Runs the process of this kind to its end.
pub fn run(kind: &str, config: &Path) -> ExitCode {
    match kind {
        "simulator" => simulator::process::run(config),
        "perception" => kit::run::<perception::process::PerceptionProcess>(config),
        "pursuer" => kit::run::<PlannerProcess<pursuer::process::PursuerPlanner>>(config),
        "evader_potential" => {
            kit::run::<PlannerProcess<evader_potential::process::PotentialPlanner>>(config)
        }
        "evader_braitenberg" => {
            kit::run::<PlannerProcess<evader_braitenberg::process::BraitenbergPlanner>>(config)
        }
        // Of the bench: not in the list of kinds, no scenario can ask for them.
        "bench-planner" => bench::ticks::planner(config),
        "raw-planner" => bench::raw_planner(config),
        "bench-sink" => bench::hop::sink(config),
        other => {
            eprintln!("error: no process of kind {other:?} in this program");
            ExitCode::from(EXIT_INVALID)
        }
    }
}
