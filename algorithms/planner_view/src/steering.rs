//! Output of a planner for one tick.

use geometry::pose::Twist2;
use nalgebra::{Point2, Vector2};

/// A command with its reason: the parts of the decision that a viewer shows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Steering {
    /// Command for the robot; always finite and within the robot's limits.
    pub command: Twist2,
    /// Index of the chased robot, if the planner chases one.
    pub target: Option<usize>,
    /// The final target point of the planner (m): an exit, the look-ahead point of a target, or the
    /// weighted mean of such points over a belief.
    pub aim: Option<Point2<f64>>,
    /// The current target point (m): the first corner on the path to `aim`, or `aim` itself.
    pub waypoint: Option<Point2<f64>>,
    /// The potential field's value at the control point (m/s).
    pub field: Vector2<f64>,
}

impl Steering {
    /// A stop, with nothing to show.
    pub fn stop() -> Self {
        Self {
            command: Twist2::STOP,
            target: None,
            aim: None,
            waypoint: None,
            field: Vector2::zeros(),
        }
    }
}
