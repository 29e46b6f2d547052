//! Assumptions of predictions on a target's motion.

use geometry::pose::Pose2;
use planner_view::view::{RobotView, View};

use crate::goals::estimate;
use crate::interception::Target;
use crate::params::Knowledge;

/// Returns the most probable state of a target; `None` without information on it.
pub fn target(view: &View<'_>, index: usize, knowledge: Knowledge) -> Option<Target> {
    let robot = view.robot(index)?;
    let pose = estimate(view, index, knowledge)?;
    Some(supposed(robot, &pose, knowledge))
}

/// Returns a target at a hypothesis of its pose. With exact knowledge it has its true speed, with a
/// belief (which contains no speeds) full speed along its heading.
pub fn supposed(robot: &RobotView, pose: &Pose2, knowledge: Knowledge) -> Target {
    let speed = match knowledge {
        Knowledge::Exact => robot.twist.v,
        Knowledge::Belief => robot.v_max,
    };
    Target {
        at: pose.position(),
        velocity: pose.forward() * speed,
        v_max: robot.v_max,
    }
}
