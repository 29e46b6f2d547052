//! The kinds of processes of this program.

use attacker::process::AttackerProcess;
use config::Diagnostics;
use coverage_planners::{
    BoustrophedonPlanner, ChebyshevPlanner, KeyedCoveragePlanner, RandomBouncePlanner,
    UniformPlanner,
};
use evader_braitenberg::process::BraitenbergPlanner;
use evader_potential::process::PotentialPlanner;
use evader_reach_avoid::process::ReachAvoidPlanner;
use evader_rrt_star::process::RrtStarPlanner;
use graph_patrol::process::GraphPatrolProcess;
use navigator::process::NavigatorPlanner;
use observer::process::ObserverProcess;
use optimiser::process::OptimiserProcess;
use patrol_planners::process::{PatrolAwgPlanner, PatrolFtoPlanner};
use perception::process::PerceptionProcess;
use planner::{Planner, PlannerProcess};
use policy::process::PolicyPlanner;
use pursuer::process::PursuerPlanner;
use referee::process::RefereeProcess;

pub use scenario::kind::Kind;
use scenario::{Loader, ResolvedScenario};

/// Kinds of processes of this program, in the order of listings.
pub static KINDS: &[Kind] = &[
    Kind::from_type::<PerceptionProcess>(),
    Kind::from_type::<RefereeProcess>(),
    Kind::from_type::<ObserverProcess>(),
    Kind::from_type::<AttackerProcess>(),
    planner::<PursuerPlanner>(),
    planner::<BraitenbergPlanner>(),
    planner::<PotentialPlanner>(),
    planner::<ReachAvoidPlanner>(),
    planner::<RrtStarPlanner>(),
    planner::<PolicyPlanner>(),
    Kind::from_type::<OptimiserProcess>(),
    #[cfg(feature = "ros2")]
    Kind::from_type::<ros2_bridge::Ros2BridgeProcess>(),
    planner::<NavigatorPlanner>(),
    planner::<PatrolAwgPlanner>(),
    planner::<PatrolFtoPlanner>(),
    Kind::from_type::<GraphPatrolProcess>(),
    planner::<ChebyshevPlanner>(),
    planner::<KeyedCoveragePlanner>(),
    planner::<BoustrophedonPlanner>(),
    planner::<RandomBouncePlanner>(),
    planner::<UniformPlanner>(),
];

/// Returns the kind of the processes that steer robots with a planner.
pub const fn planner<P: Planner>() -> Kind {
    Kind::from_type::<PlannerProcess<P>>()
}

/// Loads a scenario with the kinds of this program; its files must be in its folder.
///
/// # Errors
/// See [`Loader::load`].
pub fn load(
    target: &str,
    overrides: &[String],
    seed: Option<u64>,
) -> Result<ResolvedScenario, Diagnostics> {
    Loader::new(KINDS).load(target, overrides, seed)
}

#[cfg(test)]
mod tests;
