//! Knowledge that an observer has of a robot at a moment.

use nalgebra::Point2;
use tracking::space::Space;
use tracking::watch::Watch;

/// Measured pose.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeasuredPose {
    /// Measured position (m).
    pub position: Point2<f64>,
    /// Measured heading (rad).
    pub heading: f64,
    /// Standard deviation of x and of y (m), ≥ 0.
    pub sigma: f64,
    /// Standard deviation of the heading (rad), ≥ 0.
    pub heading_sigma: f64,
}

/// One observation of a robot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Look {
    /// Simulated time (s).
    pub time: f64,
    /// Time since the last observation (s), > 0.
    pub dt: f64,
    /// The measurement; `None` if the robot is out of sight.
    pub seen: Option<MeasuredPose>,
    /// Visibility of the robot, 0…1.
    pub visibility: f64,
}

/// Goal that a robot has reached, as detected from its poses.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReachedGoal {
    /// Time at which the robot turned away from it (s).
    pub time: f64,
    /// Estimated position (m).
    pub point: Point2<f64>,
    /// Standard deviation of x and of y (m).
    pub sd: f64,
}

/// Observation with its context.
#[derive(Debug, Clone, Copy)]
pub struct Moment<'a> {
    /// The observation.
    pub look: Look,
    /// The goal that the robot has reached since the last observation, if any.
    pub goal: Option<ReachedGoal>,
    /// `true` if the robot may have reached goals unseen since the observation before.
    pub goals_lost: bool,
    /// The map.
    pub space: &'a Space,
    /// The watching robot and its field of view.
    pub watch: &'a Watch,
}
