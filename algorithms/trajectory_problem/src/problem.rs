//! A problem: start, goal, limits of the robot, obstacles.

use core::fmt::Display;

use geometry::pose::Pose2;
use geometry::shape::{Aabb, Convex};
use nalgebra::Point2;
use thiserror::Error;

use crate::limits::RobotLimits;

/// Maximum number of obstacles of one problem.
pub const MAX_OBSTACLES: usize = 4096;
/// Maximum magnitude of coordinates (m) and speeds (m/s).
pub const MAX_NUMBER: f64 = 1e6;
/// Minimum clearance (m); it represents a point robot.
pub const MIN_CLEARANCE: f64 = 1e-6;
/// Default of the depth (m) to which the start may lie in a grown obstacle or beyond the bounds:
/// the tracking error of a robot that follows its last trajectory. For a deeper start there is no
/// plan.
pub const START_TOLERANCE: f64 = 5e-3;

/// A minimum-time problem; all values in one frame, in SI units.
#[derive(Debug, Clone, PartialEq)]
pub struct Problem {
    /// Pose at the start.
    pub start: Pose2,
    /// Forward speed at the start (m/s), negative backwards; `None`: free.
    pub start_speed: Option<f64>,
    /// Turning rate at the start (rad/s); `None`: free.
    pub start_turn_rate: Option<f64>,
    /// Position of the goal (m).
    pub goal: Point2<f64>,
    /// Heading at the goal (rad); `None`: free.
    pub goal_heading: Option<f64>,
    /// Forward speed at the goal (m/s), negative backwards; `None`: free.
    pub goal_speed: Option<f64>,
    /// Limits of the robot.
    pub limits: RobotLimits,
    /// Obstacles.
    pub obstacles: Vec<Convex>,
    /// Minimum distance (m) of the robot's centre from them (radius plus margin), ≥
    /// [`MIN_CLEARANCE`].
    pub clearance: f64,
    /// Allowed positions of the robot's centre.
    pub bounds: Aabb,
    /// Depth (m) to which the start may lie in a grown obstacle or beyond the bounds, ≥ 0.
    pub start_tolerance: f64,
}

/// Invalid field of a problem; numbers have the units of the problem.
#[derive(Debug, Clone, PartialEq, Error)]
#[error("{field} = {value}: expected {expected}")]
pub struct ProblemError {
    /// The field.
    pub field: String,
    /// Actual value.
    pub value: String,
    /// Expected value.
    pub expected: String,
}

impl ProblemError {
    fn new(field: impl Into<String>, value: impl Display, expected: impl Into<String>) -> Self {
        Self {
            field: field.into(),
            value: value.to_string(),
            expected: expected.into(),
        }
    }
}

fn number(field: &str, value: f64) -> Result<(), ProblemError> {
    if value.abs() <= MAX_NUMBER {
        return Ok(());
    }
    let expected = format!("a number of at most {MAX_NUMBER:e} in magnitude");
    Err(ProblemError::new(
        field,
        format_args!("{value:e}"),
        expected,
    ))
}

fn positive(field: &str, value: f64) -> Result<(), ProblemError> {
    number(field, value)?;
    if value > 0.0 {
        return Ok(());
    }
    Err(ProblemError::new(field, value, "a number > 0"))
}

fn not_negative(field: &str, value: f64) -> Result<(), ProblemError> {
    number(field, value)?;
    if value >= 0.0 {
        return Ok(());
    }
    Err(ProblemError::new(field, value, "a number ≥ 0"))
}

impl Problem {
    /// Checks every field on its own, and that the prescribed speeds are within the limits.
    /// The planner checks the positions of start and goal.
    ///
    /// # Errors
    /// [`ProblemError`] names the first field that is out of range.
    pub fn validate(&self) -> Result<(), ProblemError> {
        number("start.x", self.start.x)?;
        number("start.y", self.start.y)?;
        number("start.theta", self.start.theta)?;
        number("goal.x", self.goal.x)?;
        number("goal.y", self.goal.y)?;
        self.goal_heading
            .map_or(Ok(()), |heading| number("goal.theta", heading))?;
        let limits = &self.limits;
        positive("v_max", limits.v_max)?;
        number("v_min", limits.v_min)?;
        if !(-limits.v_max..=0.0).contains(&limits.v_min) {
            let expected = format!("a number from {} to 0", -limits.v_max);
            return Err(ProblemError::new("v_min", limits.v_min, expected));
        }
        positive("omega_max", limits.omega_max)?;
        if let Some(wheels) = &limits.wheels {
            positive("wheel_speed", wheels.speed)?;
            positive("wheel_separation", wheels.separation)?;
        }
        for (field, value) in [
            ("acceleration", limits.acceleration),
            ("angular_acceleration", limits.angular_acceleration),
        ] {
            value.map_or(Ok(()), |value| positive(field, value))?;
        }
        not_negative("start_tolerance", self.start_tolerance)?;
        number("clearance", self.clearance)?;
        if self.clearance < MIN_CLEARANCE {
            let expected = format!("at least {MIN_CLEARANCE}");
            return Err(ProblemError::new("clearance", self.clearance, expected));
        }
        self.validate_speeds()?;
        self.validate_ground()
    }

    fn validate_speeds(&self) -> Result<(), ProblemError> {
        let limits = &self.limits;
        let turn = self.start_turn_rate.unwrap_or(0.0);
        number("start_turn_rate", turn)?;
        if turn.abs() > limits.top_turn_rate() {
            let expected = format!("at most {} in magnitude", limits.top_turn_rate());
            return Err(ProblemError::new("start_turn_rate", turn, expected));
        }
        let wheels = |omega: f64| {
            limits.wheels.map_or(f64::INFINITY, |w| {
                w.speed - 0.5 * omega.abs() * w.separation
            })
        };
        for (field, speed, omega) in [
            ("start_speed", self.start_speed, turn),
            ("goal_speed", self.goal_speed, 0.0),
        ] {
            let Some(speed) = speed else { continue };
            number(field, speed)?;
            // A measured speed must be accepted despite rounding.
            let room = wheels(omega).max(0.0);
            let [least, most] = [limits.v_min, limits.v_max].map(|v| v.clamp(-room, room));
            if speed < least * (1.0 + 1e-9) || speed > most * (1.0 + 1e-9) {
                let expected = format!("from {least} to {most} by the limits");
                return Err(ProblemError::new(field, speed, expected));
            }
        }
        Ok(())
    }

    fn validate_ground(&self) -> Result<(), ProblemError> {
        for (field, corner) in [
            ("bounds.min", self.bounds.min),
            ("bounds.max", self.bounds.max),
        ] {
            number(&format!("{field}.x"), corner.x)?;
            number(&format!("{field}.y"), corner.y)?;
        }
        let size = self.bounds.max - self.bounds.min;
        if !(size.x > 0.0 && size.y > 0.0) {
            let value = format!("{} × {}", size.x, size.y);
            return Err(ProblemError::new("bounds", value, "a positive area"));
        }
        if self.obstacles.len() > MAX_OBSTACLES {
            let expected = format!("at most {MAX_OBSTACLES}");
            let found = self.obstacles.len();
            return Err(ProblemError::new("obstacles", found, expected));
        }
        for (i, obstacle) in self.obstacles.iter().enumerate() {
            match obstacle {
                Convex::Disc { center, radius } => {
                    number(&format!("obstacles[{i}].x"), center.x)?;
                    number(&format!("obstacles[{i}].y"), center.y)?;
                    not_negative(&format!("obstacles[{i}].radius"), *radius)?;
                }
                other => {
                    let corners = other.corners();
                    for corner in &corners {
                        number(&format!("obstacles[{i}].x"), corner.x)?;
                        number(&format!("obstacles[{i}].y"), corner.y)?;
                    }
                    if corners.len() < 3 {
                        let field = format!("obstacles[{i}]");
                        let value = format!("{} corners", corners.len());
                        return Err(ProblemError::new(field, value, "at least 3 corners"));
                    }
                }
            }
        }
        Ok(())
    }
}
