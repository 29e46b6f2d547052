//! Problems for the other tests, and properties of every plan.

use geometry::pose::Pose2;
use geometry::shape::{Aabb, Convex};
use nalgebra::Point2;
use trajectory::{Method, Options, Plan, PlanError, Problem, RobotLimits, Wheels};
use trajectory_check::{Contract, Obstacle, WheelLimit};

/// A board of 4.8 m by 3.6 m and the paper's robot, without obstacles: from the lower left to the
/// upper right.
pub fn board() -> Problem {
    Problem {
        start: Pose2::new(0.1, 0.1, 0.7),
        start_speed: None,
        start_turn_rate: None,
        goal: Point2::new(4.7, 3.5),
        goal_heading: None,
        goal_speed: None,
        limits: RobotLimits::simple(0.15, 16.0),
        obstacles: Vec::new(),
        clearance: 0.075,
        bounds: Aabb {
            min: Point2::new(0.0, 0.0),
            max: Point2::new(4.8, 3.6),
        },
        start_tolerance: 5e-3,
    }
}

pub fn disc(x: f64, y: f64, radius: f64) -> Convex {
    Convex::disc(Point2::new(x, y), radius)
}

/// The board with discs and a box as obstacles.
pub fn cluttered() -> Problem {
    Problem {
        obstacles: vec![
            disc(1.0, 0.9, 0.15),
            disc(2.0, 1.4, 0.2),
            disc(2.2, 1.7, 0.12),
            Convex::rectangle(Point2::new(3.2, 2.5), [0.3, 0.15], 0.4),
            disc(4.0, 2.7, 0.1),
        ],
        ..board()
    }
}

/// A small differential-drive robot with motors: 0.22 m/s at the wheels, 0.5 m/s², 3 rad/s².
pub fn motors() -> RobotLimits {
    RobotLimits {
        v_max: 0.22,
        v_min: 0.0,
        omega_max: 2.84,
        wheels: Some(Wheels {
            speed: 0.22,
            separation: 0.16,
        }),
        acceleration: Some(0.5),
        angular_acceleration: Some(3.0),
    }
}

pub fn options(method: Method) -> Options {
    Options {
        method,
        ..Options::default()
    }
}

pub fn plan(problem: &Problem, options: &Options) -> Result<Plan, PlanError> {
    trajectory::plan(problem, options, None, &mut || false)
}

/// Violations that the checker reports for a plan and the original problem (the optimiser checks the
/// plan on its adjusted obstacle field).
pub fn faults(problem: &Problem, plan: &Plan) -> Vec<String> {
    let Aabb { min, max } = problem.bounds;
    let contract = Contract {
        start_speed: problem.start_speed,
        start_turn_rate: problem.start_turn_rate,
        goal_heading: problem.goal_heading,
        goal_speed: problem.goal_speed,
        wheel: problem.limits.wheels.map(|w| WheelLimit {
            speed: w.speed,
            separation: w.separation,
        }),
        acceleration_max: problem.limits.acceleration,
        angular_acceleration_max: problem.limits.angular_acceleration,
        obstacles: problem
            .obstacles
            .iter()
            .map(|obstacle| match obstacle {
                Convex::Disc { center, radius } => Obstacle::Disc {
                    center: *center,
                    radius: *radius,
                },
                other => Obstacle::Polygon {
                    vertices: other.corners(),
                },
            })
            .collect(),
        clearance: problem.clearance,
        v_min: problem.limits.v_min,
        bounds: Some([min.x, min.y, max.x, max.y]),
        ..Contract::new(
            [problem.start.x, problem.start.y, problem.start.theta],
            [problem.goal.x, problem.goal.y],
            problem.limits.v_max,
            problem.limits.omega_max,
        )
    };
    let report = trajectory_check::check(&contract, &plan.samples);
    let mut faults: Vec<String> = report.violations.iter().map(ToString::to_string).collect();
    if (report.duration - plan.final_time).abs() > 1e-9 {
        faults.push(format!(
            "says {} s, takes {} s",
            plan.final_time, report.duration
        ));
    }
    if plan.final_time < plan.lower_bound * (1.0 - 1e-6) {
        faults.push(format!(
            "{} s beats its bound of {} s",
            plan.final_time, plan.lower_bound
        ));
    }
    faults
}
