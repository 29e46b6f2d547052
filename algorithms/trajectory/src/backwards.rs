//! Driving backwards as driving forwards of a robot that is turned around.
//!
//! A robot with the heading θ and the speed −V moves as one with the heading θ + π and the speed V,
//! and turns at the same rate. So plans that only drive backwards are the plans that only drive
//! forwards of a problem in which all headings are reversed and forward and backward speeds are
//! exchanged.

use core::f64::consts::PI;

use geometry::pose::Pose2;

use crate::plan::{Plan, Sample};
use trajectory_problem::{Problem, RobotLimits};

/// The problem with the robot turned around; its forward speeds are the backward speeds.
pub fn problem(problem: &Problem) -> Problem {
    let limits = &problem.limits;
    let start = &problem.start;
    Problem {
        start: Pose2::new(start.x, start.y, start.theta + PI),
        start_speed: problem.start_speed.map(|v| -v),
        goal_heading: problem.goal_heading.map(|theta| theta + PI),
        goal_speed: problem.goal_speed.map(|v| -v),
        limits: RobotLimits {
            v_max: -limits.v_min,
            v_min: -limits.v_max,
            ..*limits
        },
        ..problem.clone()
    }
}

/// The plan of a robot that is turned around, by an angle of `turn` (rad), π or −π.
pub fn plan(mut plan: Plan, turn: f64) -> Plan {
    for sample in &mut plan.samples {
        *sample = Sample {
            theta: sample.theta + turn,
            v: -sample.v,
            ..*sample
        };
    }
    plan
}
