//! Check of every result by [`trajectory_check`], which shares no code with the planner.

use geometry::shape::Convex;
use trajectory_check::{Contract, Obstacle, Report, WheelLimit};

use crate::obstacle_field::ObstacleField;
use crate::plan::Sample;
use trajectory_problem::Problem;

/// The contract of a trajectory that solves a problem on its obstacle field.
pub fn contract(problem: &Problem, obstacle_field: &ObstacleField) -> Contract {
    let limits = &problem.limits;
    let bounds = &obstacle_field.bounds;
    Contract {
        start: [problem.start.x, problem.start.y, problem.start.theta],
        start_speed: problem.start_speed,
        start_turn_rate: problem.start_turn_rate,
        goal: [problem.goal.x, problem.goal.y],
        goal_heading: problem.goal_heading,
        goal_speed: problem.goal_speed,
        v_max: limits.v_max,
        v_min: limits.v_min,
        omega_max: limits.omega_max,
        wheel: limits.wheels.map(|w| WheelLimit {
            speed: w.speed,
            separation: w.separation,
        }),
        acceleration_max: limits.acceleration,
        angular_acceleration_max: limits.angular_acceleration,
        obstacles: obstacle_field.obstacles.iter().map(obstacle).collect(),
        clearance: obstacle_field.clearance,
        bounds: Some([bounds.min.x, bounds.min.y, bounds.max.x, bounds.max.y]),
    }
}

fn obstacle(obstacle: &Convex) -> Obstacle {
    match obstacle {
        Convex::Disc { center, radius } => Obstacle::Disc {
            center: *center,
            radius: *radius,
        },
        other => Obstacle::Polygon {
            vertices: other.corners(),
        },
    }
}

/// The report of the check.
pub fn report(problem: &Problem, obstacle_field: &ObstacleField, samples: &[Sample]) -> Report {
    trajectory_check::check(&contract(problem, obstacle_field), samples)
}
