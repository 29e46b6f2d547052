//! The problem a trajectory claims to solve.

use nalgebra::Point2;

/// What a trajectory has to fulfil: where from, where to, with which drive, past which obstacles.
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
    /// Highest speed, forwards or backwards (m/s) (> 0).
    pub v_max: f64,
    /// Highest turning rate, either way (rad/s) (> 0).
    pub omega_max: f64,
    /// Limit of the wheels, which bounds speed and turning rate together.
    pub wheel: Option<WheelLimit>,
    /// Highest rate of change of the forward speed, either way (m/s²) (> 0).
    pub acceleration_max: Option<f64>,
    /// Highest rate of change of the turning rate, either way (rad/s²) (> 0).
    pub angular_acceleration_max: Option<f64>,
    /// What the robot's centre must stay `clearance` away from.
    pub obstacles: Vec<Obstacle>,
    /// Distance to be kept between the robot's centre and every obstacle (m) (≥ 0).
    pub clearance: f64,
    /// Box the robot's centre must stay in (m): `[x_min, y_min, x_max, y_max]`. It is not shrunk by
    /// `clearance`.
    pub bounds: Option<[f64; 4]>,
}

impl Contract {
    /// The plainest problem: from a pose (x (m), y (m), heading (rad)) to a position (m) at no more
    /// than `v_max` (m/s) and `omega_max` (rad/s), with nothing in the way and nothing else
    /// prescribed.
    pub fn new(start: [f64; 3], goal: [f64; 2], v_max: f64, omega_max: f64) -> Self {
        Self {
            start,
            start_speed: None,
            start_turn_rate: None,
            goal,
            goal_heading: None,
            goal_speed: None,
            v_max,
            omega_max,
            wheel: None,
            acceleration_max: None,
            angular_acceleration_max: None,
            obstacles: Vec::new(),
            clearance: 0.0,
            bounds: None,
        }
    }
}

/// Something solid.
#[derive(Debug, Clone, PartialEq)]
pub enum Obstacle {
    /// A disc.
    Disc {
        /// Its centre (m).
        center: Point2<f64>,
        /// Its radius (m) (≥ 0).
        radius: f64,
    },
    /// A convex polygon.
    Polygon {
        /// Its corners (m), counter-clockwise, at least 3 and not all in one line.
        vertices: Vec<Point2<f64>>,
    },
}

/// What the wheels of a differential drive can do: |v| + |ω| · separation / 2 ≤ speed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WheelLimit {
    /// Highest speed of a wheel over the obstacle field (m/s) (> 0).
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
