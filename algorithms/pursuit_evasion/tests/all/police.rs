//! The Police of these tests, and their views.

use geometry::pose::Pose2;
use planner_view::view::{BeliefView, RobotView, View};
use pursuit_evasion::pursuit::PursuerParams;
use pursuit_evasion::pursuit::params::Knowledge;
use robot::team::Role;

use testing::EXIT;

/// Distance at which an evader is caught (m).
pub const CATCH: f64 = 0.3;
/// Largest speed of the Police (m/s).
pub const V_POLICE: f64 = 0.3;

/// Returns a robot of the Police that stands still.
pub fn police(index: usize, pose: Pose2) -> RobotView {
    testing::robot(index, Role::Pursuer, pose, V_POLICE)
}

/// Returns the view and beliefs of the robot `me`.
pub fn view<'a>(
    time_s: f64,
    me: usize,
    robots: &'a [RobotView],
    beliefs: &'a [BeliefView<'a>],
) -> View<'a> {
    View {
        me,
        beliefs,
        ..testing::view(time_s, robots, &[EXIT])
    }
}

/// Returns the defaults with exact knowledge of all positions.
pub fn exact() -> PursuerParams {
    let mut params = PursuerParams {
        knowledge: Knowledge::Exact,
        ..PursuerParams::default()
    };
    params.assignment.knowledge = Knowledge::Exact;
    params
}
