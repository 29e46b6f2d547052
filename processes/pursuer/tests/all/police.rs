//! The Police of these tests, and what they see.

use geometry::pose::Pose2;
use planner_view::view::{BeliefView, RobotView, View};
use pursuer::PursuerParams;
use pursuer::params::Knowledge;
use sim_backend::team::Team;

use crate::support::{self, EXIT};

/// Distance at which an evader is caught (m).
pub const CATCH: f64 = 0.3;
/// Largest speed of the Police (m/s).
pub const V_POLICE: f64 = 0.3;

/// A robot of the Police that stands still.
pub fn police(index: usize, pose: Pose2) -> RobotView {
    support::robot(index, Team::Police, pose, V_POLICE)
}

/// What the robot `me` sees and believes.
pub fn view<'a>(
    time_s: f64,
    me: usize,
    robots: &'a [RobotView],
    beliefs: &'a [BeliefView<'a>],
) -> View<'a> {
    View {
        me,
        beliefs,
        ..support::view(time_s, robots, &[EXIT])
    }
}

/// The defaults, but for knowing where everybody is.
pub fn exact() -> PursuerParams {
    let mut params = PursuerParams {
        knowledge: Knowledge::Exact,
        ..PursuerParams::default()
    };
    params.assignment.knowledge = Knowledge::Exact;
    params
}
