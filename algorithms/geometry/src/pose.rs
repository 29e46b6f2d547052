//! Pose and motion of a robot (REP-103: x forward, y left, angles counter-clockwise).

use core::f64::consts::PI;

use nalgebra::{Point2, Vector2};
use parameters::above;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::extent::coordinate;
use crate::math;

/// Pose of a robot in the world frame.
///
/// ```
/// use core::f64::consts::PI;
/// use geometry::pose::Pose2;
///
/// let pose = Pose2::new(1.0, 2.0, 3.0 * PI);
/// assert!((pose.theta - PI).abs() < 1e-12);
/// assert!((pose.forward().x + 1.0).abs() < 1e-12);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Pose2 {
    /// Position along the world's x axis.
    #[schemars(transform = coordinate())]
    pub x: f64,
    /// Position along the world's y axis.
    #[schemars(transform = coordinate())]
    pub y: f64,
    /// Heading, counter-clockwise from +x, in (−π, π].
    #[schemars(transform = above(-PI).at_most(PI).unit("rad"))]
    pub theta: f64,
}

impl Pose2 {
    /// A pose from its three coordinates (m, m, rad); the heading is wrapped.
    pub fn new(x: f64, y: f64, theta: f64) -> Self {
        Self {
            x,
            y,
            theta: math::wrap_angle(theta),
        }
    }

    /// The position (m).
    pub fn position(&self) -> Point2<f64> {
        Point2::new(self.x, self.y)
    }

    /// The unit vector along the heading.
    pub fn forward(&self) -> Vector2<f64> {
        let (sin, cos) = math::sincos(self.theta);
        Vector2::new(cos, sin)
    }

    /// Returns where a pose is that is `inner` in the frame of this one.
    ///
    /// ```
    /// use core::f64::consts::FRAC_PI_2;
    /// use geometry::pose::Pose2;
    ///
    /// let placed = Pose2::new(10.0, 20.0, FRAC_PI_2).placed(&Pose2::new(2.0, 0.0, FRAC_PI_2));
    /// assert!((placed.x - 10.0).abs() < 1e-12 && (placed.y - 22.0).abs() < 1e-12);
    /// ```
    #[must_use]
    pub fn placed(&self, inner: &Self) -> Self {
        let (sin, cos) = math::sincos(self.theta);
        Self::new(
            self.x + cos * inner.x - sin * inner.y,
            self.y + sin * inner.x + cos * inner.y,
            self.theta + inner.theta,
        )
    }

    /// Returns `true` if all three coordinates are finite.
    pub fn is_finite(&self) -> bool {
        self.x.is_finite() && self.y.is_finite() && self.theta.is_finite()
    }
}

/// Velocity of a differential-drive robot in its own frame; also the command of a planner.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Twist2 {
    /// Forward speed (m/s).
    pub v: f64,
    /// Turning rate (rad/s), counter-clockwise positive.
    pub omega: f64,
}

impl Twist2 {
    /// No motion.
    pub const STOP: Self = Self { v: 0.0, omega: 0.0 };

    /// A twist from forward speed (m/s) and turning rate (rad/s).
    pub const fn new(v: f64, omega: f64) -> Self {
        Self { v, omega }
    }

    /// Maximum magnitude of a component of a command, in its unit. Commands beyond a robot's limits are
    /// clamped; a command beyond this limit comes from a faulty planner.
    pub const ABSURD: f64 = 1e6;

    /// Returns `true` if it is a valid command: both components are finite and within [`Self::ABSURD`].
    pub fn is_command(&self) -> bool {
        // NaN is not at most anything.
        self.v.abs() <= Self::ABSURD && self.omega.abs() <= Self::ABSURD
    }

    /// Returns `true` if both components are finite.
    pub fn is_finite(&self) -> bool {
        self.v.is_finite() && self.omega.is_finite()
    }
}
