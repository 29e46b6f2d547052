//! What a planner hands back for one tick.

use geometry::pose::Twist2;
use nalgebra::{Point2, Vector2};

/// A command, and why: the parts of the decision that a person wants to see in a viewer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Steering {
    /// What the robot shall do now; always finite and within the robot's limits.
    pub command: Twist2,
    /// Index of the robot that is being chased, if the planner chases one.
    pub target: Option<usize>,
    /// The point the planner wants to reach in the end (m) (an exit, the look-ahead point of a
    /// target, the weighted mean of such points over a belief).
    pub aim: Option<Point2<f64>>,
    /// The point it heads for now (m): the first corner on the way to `aim`, or `aim` itself.
    pub waypoint: Option<Point2<f64>>,
    /// The potential field's value at the control point (m/s).
    pub field: Vector2<f64>,
}

impl Steering {
    /// Stand still, with nothing to show.
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
