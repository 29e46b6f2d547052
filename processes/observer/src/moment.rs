//! What an observer knows of a robot at a moment.

use nalgebra::Point2;
use tracking::space::Space;
use tracking::watch::Watch;

/// A pose as it was measured.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Seen {
    /// Measured position (m).
    pub position: Point2<f64>,
    /// Measured heading (rad).
    pub heading: f64,
    /// Standard deviation of x and of y (m), ≥ 0.
    pub sigma: f64,
    /// Standard deviation of the heading (rad), ≥ 0.
    pub heading_sigma: f64,
}

/// One look at a robot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Look {
    /// Simulated time (s).
    pub time: f64,
    /// Time since the look before (s), > 0.
    pub dt: f64,
    /// The measurement; `None` if the robot is out of sight.
    pub seen: Option<Seen>,
    /// Visibility of the robot, 0…1.
    pub visibility: f64,
}

/// A goal that a robot has been found to have reached.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReachedGoal {
    /// When the robot turned away from it (s).
    pub time: f64,
    /// Where it must have been (m).
    pub point: Point2<f64>,
    /// Standard deviation of x and of y (m).
    pub sd: f64,
}

/// A look with its surroundings.
#[derive(Debug, Clone, Copy)]
pub struct Moment<'a> {
    /// The look.
    pub look: Look,
    /// The goal that the robot has reached since the look before, if any.
    pub goal: Option<ReachedGoal>,
    /// Whether the robot may have reached goals unseen since the look before.
    pub goals_lost: bool,
    /// The map.
    pub space: &'a Space,
    /// Who looks.
    pub watch: &'a Watch,
}
