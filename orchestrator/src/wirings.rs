//! Every kind of process by its name, with its own type. The simulator is not among them: it leads
//! the loop that they follow.

use planner::PlannerProcess;
use runtime::Wiring;

/// Something to be done with a kind of process.
pub trait WiringVisitor {
    /// What comes of it.
    type Output;

    /// Called for the kind that was asked for.
    fn visit<W: Wiring + 'static>(self) -> Self::Output;
}

/// Visits the kind with this name; `None` if this program has no such kind.
pub fn visit<V: WiringVisitor>(kind: &str, visitor: V) -> Option<V::Output> {
    Some(match kind {
        "perception" => visitor.visit::<perception::process::PerceptionProcess>(),
        "observer" => visitor.visit::<observer::process::ObserverProcess>(),
        "referee" => visitor.visit::<referee::process::RefereeProcess>(),
        "pursuer" => visitor.visit::<PlannerProcess<pursuer::process::PursuerPlanner>>(),
        "evader_potential" => {
            visitor.visit::<PlannerProcess<evader_potential::process::PotentialPlanner>>()
        }
        "evader_reach_avoid" => {
            visitor.visit::<PlannerProcess<evader_reach_avoid::process::ReachAvoidPlanner>>()
        }
        "evader_rrt_star" => {
            visitor.visit::<PlannerProcess<evader_rrt_star::process::RrtStarPlanner>>()
        }
        "evader_braitenberg" => {
            visitor.visit::<PlannerProcess<evader_braitenberg::process::BraitenbergPlanner>>()
        }
        "optimiser" => visitor.visit::<optimiser::process::OptimiserProcess>(),
        "navigator" => visitor.visit::<PlannerProcess<navigator::process::NavigatorPlanner>>(),
        "patrol_awg" => {
            visitor.visit::<PlannerProcess<patrol_planners::process::PatrolAwgPlanner>>()
        }
        "patrol_fto" => {
            visitor.visit::<PlannerProcess<patrol_planners::process::PatrolFtoPlanner>>()
        }
        "coverage_chebyshev" => {
            visitor.visit::<PlannerProcess<coverage_planners::ChebyshevPlanner>>()
        }
        "keyed_coverage" => {
            visitor.visit::<PlannerProcess<coverage_planners::KeyedCoveragePlanner>>()
        }
        "coverage_boustrophedon" => {
            visitor.visit::<PlannerProcess<coverage_planners::BoustrophedonPlanner>>()
        }
        "coverage_random_bounce" => {
            visitor.visit::<PlannerProcess<coverage_planners::RandomBouncePlanner>>()
        }
        "coverage_uniform" => visitor.visit::<PlannerProcess<coverage_planners::UniformPlanner>>(),
        _ => return None,
    })
}
