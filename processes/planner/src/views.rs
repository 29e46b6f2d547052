//! Conversion of the world's state to planners' views.

use geometry::pose::{Pose2, Twist2};
use ipc_types::messages::world::RobotState;
use planner_view::view::RobotView;
use robot::team::Team;
use runtime::config::RobotInfo;
use runtime::inputs::StateInput;

/// Returns the view of a robot from the world's state.
fn robot_view(index: usize, state: &RobotState, info: &RobotInfo, team: Team) -> RobotView {
    RobotView {
        index,
        team,
        active: state.status == 0,
        present: state.present != 0,
        pose: Pose2::new(state.x, state.y, state.theta),
        twist: Twist2::new(state.v, state.omega),
        radius: info.model.radius,
        v_max: info.model.v_max,
    }
}

/// Replaces `views` by the views of the robots in the newest state. `teams` are the [teams] of the robots.
pub fn robot_views(
    state: &StateInput,
    infos: &[RobotInfo],
    teams: &[Team],
    views: &mut Vec<RobotView>,
) {
    views.clear();
    let robots = state.robots.iter().zip(infos).zip(teams).enumerate();
    views
        .extend(robots.map(|(index, ((state, info), &team))| robot_view(index, state, info, team)));
}

/// Returns the teams of the robots.
pub fn teams(robots: &[RobotInfo]) -> Vec<Team> {
    let is_hostile = |i: usize, j: usize| robots[i].opponents.contains(&(j as u32));
    Team::of_robots(
        robots.len(),
        |i| robots[i].role,
        |i, j| robots[i].team == robots[j].team,
        is_hostile,
    )
}
