//! The problem that a trajectory claims to solve.

use nalgebra::Point2;

/// Conditions of a trajectory: start, goal, limits of the drive, and obstacles.
///
/// `None` leaves a condition out.
#[derive(Debug, Clone, PartialEq)]
pub struct Contract {
    /// Pose at the start: x (m), y (m), heading (rad).
    pub start: [f64; 3],
    /// Forward speed at the start (m/s).
    pub start_speed: Option<f64>,
    /// Turning rate at the start (rad/s).
    pub start_turn_rate: Option<f64>,
    /// Position at the end: x (m), y (m).
    pub goal: [f64; 2],
    /// Heading at the end (rad).
    pub goal_heading: Option<f64>,
    /// Forward speed at the end (m/s).
    pub goal_speed: Option<f64>,
    /// Maximum forward speed (m/s) (> 0).
    pub v_max: f64,
    /// Minimum forward speed (m/s) (≤ 0): the negative of the maximum speed backwards; 0 forbids
    /// driving backwards.
    pub v_min: f64,
    /// Maximum turning rate, either way (rad/s) (> 0).
    pub omega_max: f64,
    /// Limit of the wheels, which bounds speed and turning rate together.
    pub wheel: Option<WheelLimit>,
    /// Maximum rate of change of the forward speed, either way (m/s²) (> 0).
    pub acceleration_max: Option<f64>,
    /// Maximum rate of change of the turning rate, either way (rad/s²) (> 0).
    pub angular_acceleration_max: Option<f64>,
    /// Obstacles for the robot's centre, at a distance of `clearance`.
    pub obstacles: Vec<Obstacle>,
    /// Minimum distance between the robot's centre and every obstacle (m) (≥ 0).
    pub clearance: f64,
    /// Bounding box of the robot's centre (m): `[x_min, y_min, x_max, y_max]`. It is not shrunk by
    /// `clearance`.
    pub bounds: Option<[f64; 4]>,
}

impl Contract {
    /// Creates the simplest problem: from a pose (x (m), y (m), heading (rad)) to a position (m) at
    /// no more than `v_max` (m/s), forwards or backwards, and `omega_max` (rad/s), without obstacles
    /// and further conditions.
    pub fn new(start: [f64; 3], goal: [f64; 2], v_max: f64, omega_max: f64) -> Self {
        Self {
            start,
            start_speed: None,
            start_turn_rate: None,
            goal,
            goal_heading: None,
            goal_speed: None,
            v_max,
            v_min: -v_max,
            omega_max,
            wheel: None,
            acceleration_max: None,
            angular_acceleration_max: None,
            obstacles: Vec::new(),
            clearance: 0.0,
            bounds: None,
        }
    }

    /// Maximum speed (m/s) either way.
    pub(crate) fn top_speed(&self) -> f64 {
        self.v_max.max(-self.v_min)
    }
}

/// A solid body.
#[derive(Debug, Clone, PartialEq)]
pub enum Obstacle {
    /// A disc.
    Disc {
        /// Centre (m).
        center: Point2<f64>,
        /// Radius (m) (≥ 0).
        radius: f64,
    },
    /// A convex polygon.
    Polygon {
        /// Corners (m), counter-clockwise, at least 3 and not all on one line.
        vertices: Vec<Point2<f64>>,
    },
}

/// Limit of the wheels of a differential drive: |v| + |ω| · separation / 2 ≤ speed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WheelLimit {
    /// Maximum speed of a wheel over the ground (m/s) (> 0).
    pub speed: f64,
    /// Distance between the two wheels (m) (> 0).
    pub separation: f64,
}

impl WheelLimit {
    /// Speed (m/s) of the faster wheel at a forward speed (m/s) and a turning rate (rad/s).
    pub(crate) fn faster(&self, v: f64, omega: f64) -> f64 {
        v.abs() + omega.abs() * self.separation / 2.0
    }
}
