//! A planning problem as in files: lengths are in pixels of a picture of known scale.

use geometry::pose::Pose2;
use geometry::shape::{Aabb, Convex};
use nalgebra::Point2;
use serde_json::{Value as Json, json};
use trajectory::obstacle_field::ObstacleField;
use trajectory_check::{Contract, Obstacle, WheelLimit};
use trajectory_problem::problem::MIN_CLEARANCE;
use trajectory_problem::{Problem, ProblemError, RobotLimits};

/// Smallest extent (m) of a problem that is planned in metres.
const MIN_EXTENT: f64 = 0.1;
/// Largest extent (m) of a problem that is planned in metres.
const MAX_EXTENT: f64 = 200.0;
/// Maximum depth (m) of a start in a grown obstacle: the tolerance of the check of plans.
pub const START_TOLERANCE: f64 = 1e-3;

/// An obstacle.
#[derive(Debug, Clone, PartialEq)]
pub enum Body {
    /// A disc.
    Disc {
        /// x of the centre (px).
        x: f64,
        /// y of the centre (px).
        y: f64,
        /// Radius (px), ≥ 0.
        r: f64,
    },
    /// A convex polygon with its corners (px), counter-clockwise.
    Polygon(Vec<[f64; 2]>),
}

/// A planning problem. A quantity that is `None` is free or unlimited.
#[derive(Debug, Clone, PartialEq)]
pub struct Instance {
    /// Name, unique in its file.
    pub id: String,
    /// Size of a pixel (cm), > 0.
    pub cm_per_px: f64,
    /// Limits of the robot (px, s, rad).
    pub limits: RobotLimits,
    /// Minimum distance of the robot's centre from obstacles (px), ≥ 0.
    pub buffer: f64,
    /// Bounds of its centre (px): minimum x, minimum y, maximum x, maximum y.
    pub bounds: [f64; 4],
    /// Start: x (px), y (px), heading (rad).
    pub start: [f64; 3],
    /// Speed at the start (px/s).
    pub start_speed: Option<f64>,
    /// Turning rate at the start (rad/s).
    pub start_turn_rate: Option<f64>,
    /// Goal: x (px), y (px).
    pub goal: [f64; 2],
    /// Heading at the goal (rad).
    pub goal_heading: Option<f64>,
    /// Speed at the goal (px/s).
    pub goal_speed: Option<f64>,
    /// Obstacles.
    pub obstacles: Vec<Body>,
}

impl Instance {
    /// Returns the size of a pixel in the planner's unit of length.
    ///
    /// The unit is the metre if start, goal and obstacles then extend over `MIN_EXTENT` to
    /// `MAX_EXTENT`, else a power of ten of it: the tolerances of planner and check are lengths for
    /// robots, while the problem has the same solution at any scale.
    pub fn scale(&self) -> f64 {
        let mut scale = self.cm_per_px / 100.0;
        let extent = self.extent();
        if extent > 0.0 {
            while scale * extent > MAX_EXTENT {
                scale /= 10.0;
            }
            while scale * extent < MIN_EXTENT {
                scale *= 10.0;
            }
        }
        scale
    }

    /// Returns the extent (px) of start, goal and obstacles within the bounds.
    fn extent(&self) -> f64 {
        let bodies = self.obstacles.iter().flat_map(|body| match body {
            Body::Disc { x, y, r } => vec![[x - r, y - r], [x + r, y + r]],
            Body::Polygon(corners) => corners.clone(),
        });
        let ends = [[self.start[0], self.start[1]], self.goal];
        let [x0, y0, x1, y1] = self.bounds;
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for [x, y] in bodies.chain(ends) {
            let point = [x.clamp(x0, x1), y.clamp(y0, y1)];
            for axis in 0..2 {
                low[axis] = low[axis].min(point[axis]);
                high[axis] = high[axis].max(point[axis]);
            }
        }
        (high[0] - low[0]).max(high[1] - low[1])
    }

    /// Checks the problem with the units of the file.
    ///
    /// # Errors
    /// [`ProblemError`] names the first field that is out of range, also a start or goal that is not free.
    pub fn check(&self) -> Result<(), ProblemError> {
        let problem = Problem {
            start_tolerance: START_TOLERANCE / self.scale(),
            ..self.problem_at(1.0)
        };
        problem.validate()?;
        ObstacleField::new(&problem).map(drop)
    }

    /// Converts the problem to the planner's unit of length.
    pub fn problem(&self) -> Problem {
        self.problem_at(self.scale())
    }

    /// Converts the problem; a pixel has this length.
    fn problem_at(&self, k: f64) -> Problem {
        let [x, y, theta] = self.start;
        let point = |x: f64, y: f64| Point2::new(x * k, y * k);
        let [x0, y0, x1, y1] = self.bounds;
        Problem {
            start: Pose2::new(x * k, y * k, theta),
            start_speed: self.start_speed.map(|v| v * k),
            start_turn_rate: self.start_turn_rate,
            goal: point(self.goal[0], self.goal[1]),
            goal_heading: self.goal_heading,
            goal_speed: self.goal_speed.map(|v| v * k),
            limits: self.limits.scaled(k),
            obstacles: self
                .obstacles
                .iter()
                .map(|body| match body {
                    Body::Disc { x, y, r } => Convex::disc(point(*x, *y), r * k),
                    Body::Polygon(corners) => {
                        let corners: Vec<_> = corners.iter().map(|c| point(c[0], c[1])).collect();
                        Convex::polygon(&corners)
                    }
                })
                .collect(),
            clearance: (self.buffer * k).max(MIN_CLEARANCE),
            bounds: Aabb {
                min: point(x0, y0),
                max: point(x1, y1),
            },
            start_tolerance: START_TOLERANCE,
        }
    }

    /// Returns the conditions that a plan must meet (in the planner's unit of length), from the problem as given and not from the optimiser.
    pub fn contract(&self) -> Contract {
        let (k, limits) = (self.scale(), &self.limits);
        let [x, y, theta] = self.start;
        Contract {
            start_speed: self.start_speed.map(|v| v * k),
            start_turn_rate: self.start_turn_rate,
            goal_heading: self.goal_heading,
            goal_speed: self.goal_speed.map(|v| v * k),
            wheel: limits.wheels.map(|wheels| WheelLimit {
                speed: wheels.speed * k,
                separation: wheels.separation * k,
            }),
            acceleration_max: limits.acceleration.map(|a| a * k),
            angular_acceleration_max: limits.angular_acceleration,
            obstacles: self
                .obstacles
                .iter()
                .map(|body| match body {
                    Body::Disc { x, y, r } => Obstacle::Disc {
                        center: Point2::new(x * k, y * k),
                        radius: r * k,
                    },
                    Body::Polygon(corners) => Obstacle::Polygon {
                        vertices: corners
                            .iter()
                            .map(|c| Point2::new(c[0] * k, c[1] * k))
                            .collect(),
                    },
                })
                .collect(),
            clearance: self.buffer * k,
            v_min: limits.v_min * k,
            bounds: Some(self.bounds.map(|v| v * k)),
            ..Contract::new(
                [x * k, y * k, theta],
                [self.goal[0] * k, self.goal[1] * k],
                limits.v_max * k,
                limits.omega_max,
            )
        }
    }

    /// Writes the instance as in files.
    pub fn to_json(&self) -> Json {
        let limits = &self.limits;
        let obstacles: Vec<Json> = self
            .obstacles
            .iter()
            .map(|body| match body {
                Body::Disc { x, y, r } => json!({ "x": x, "y": y, "r": r }),
                Body::Polygon(corners) => json!({ "polygon": corners }),
            })
            .collect();
        let mut goal = json!({ "x": self.goal[0], "y": self.goal[1] });
        if let (Some(theta), Some(goal)) = (self.goal_heading, goal.as_object_mut()) {
            goal.insert("theta".to_owned(), json!(theta));
        }
        let mut json = json!({
            "id": self.id,
            "cm_per_px": self.cm_per_px,
            "vmax_px_s": limits.v_max,
            "wmax_rad_s": limits.omega_max,
            "buffer_px": self.buffer,
            "bounds_px": self.bounds,
            "start": { "x": self.start[0], "y": self.start[1], "theta": self.start[2] },
            "start_speed": self.start_speed,
            "goal": goal,
            "obstacles": obstacles,
        });
        let more = [
            (
                "v_min",
                (limits.v_min != -limits.v_max).then_some(limits.v_min),
            ),
            ("start_turn_rate", self.start_turn_rate),
            ("goal_speed", self.goal_speed),
            ("wheel_speed_px_s", limits.wheels.map(|w| w.speed)),
            ("wheel_separation_px", limits.wheels.map(|w| w.separation)),
            ("acceleration_px_s2", limits.acceleration),
            ("angular_acceleration_rad_s2", limits.angular_acceleration),
        ];
        if let Some(json) = json.as_object_mut() {
            for (key, value) in more {
                if let Some(value) = value {
                    json.insert(key.to_owned(), json!(value));
                }
            }
        }
        json
    }
}
