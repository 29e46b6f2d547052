//! Violations of the contract by a trajectory.

use core::fmt;

use thiserror::Error;

/// A quantity beyond its limit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Excess {
    /// Time in the trajectory (s).
    pub time: f64,
    /// Actual value, in the unit of the violation.
    pub value: f64,
    /// Maximum allowed value, including the tolerance, in the same unit.
    pub limit: f64,
}

impl fmt::Display for Excess {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { time, value, limit } = self;
        write!(f, "is {value:.6e} at {time:.4} s, at most {limit:.6e}")
    }
}

/// One kind of violation. A [`Report`](crate::Report) contains each kind at most once, at its
/// worst.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum Violation {
    /// The problem itself is invalid; nothing was checked.
    #[error("contract: {what} is {value}: expected {expected}")]
    Contract {
        /// The field.
        what: &'static str,
        /// Actual value; for obstacles see `what`.
        value: f64,
        /// Expected value.
        expected: &'static str,
    },
    /// There is no sample.
    #[error("the trajectory has no sample")]
    Empty,
    /// A number of a sample is NaN, infinite, or of a magnitude above 10⁹; nothing was checked.
    #[error("{what} of sample {index} is {value}, not a valid number")]
    NotFinite {
        /// Index of the sample, from 0.
        index: usize,
        /// The field.
        what: &'static str,
        /// Actual value.
        value: f64,
    },
    /// The first sample is not at time 0 (s).
    #[error("first time (s) {0}")]
    StartTime(Excess),
    /// Time runs backwards, by this amount (s).
    #[error("step back in time (s) {0}")]
    TimeBackwards(Excess),
    /// Distance from the prescribed start (m).
    #[error("distance from the start (m) {0}")]
    Start(Excess),
    /// Difference from the prescribed heading at the start (rad).
    #[error("error of the start's heading (rad) {0}")]
    StartHeading(Excess),
    /// Difference from the prescribed speed at the start (m/s).
    #[error("error of the start's speed (m/s) {0}")]
    StartSpeed(Excess),
    /// Difference from the prescribed turning rate at the start (rad/s).
    #[error("error of the start's turning rate (rad/s) {0}")]
    StartTurnRate(Excess),
    /// Distance of the end from the goal (m).
    #[error("distance from the goal (m) {0}")]
    Goal(Excess),
    /// Difference from the prescribed heading at the goal (rad).
    #[error("error of the goal's heading (rad) {0}")]
    GoalHeading(Excess),
    /// Difference from the prescribed speed at the goal (m/s).
    #[error("error of the goal's speed (m/s) {0}")]
    GoalSpeed(Excess),
    /// Samples too far apart (m) for a complete check.
    #[error("distance between two samples (m) {0}")]
    Spacing(Excess),
    /// The pose changes while no time passes (m or rad, whichever is more).
    #[error("jump of the pose at one time (m or rad) {0}")]
    Jump(Excess),
    /// The speed steps although the acceleration is limited (m/s).
    #[error("step of the speed (m/s) {0}")]
    SpeedStep(Excess),
    /// The turning rate steps although the angular acceleration is limited (rad/s).
    #[error("step of the turning rate (rad/s) {0}")]
    TurnRateStep(Excess),
    /// Distance between a sample and the position that follows from the controls since the previous
    /// sample (m).
    #[error("distance from the position by the controls (m) {0}")]
    Displacement(Excess),
    /// Angle between a sample's heading and the heading that follows from the controls (rad).
    #[error("difference from the heading by the controls (rad) {0}")]
    Heading(Excess),
    /// Sum of distances that are too small for a [`Displacement`](Self::Displacement) (m).
    #[error("sum of distances from the positions by the controls (m) {0}")]
    TotalDisplacement(Excess),
    /// Sum of differences that are too small for a [`Heading`](Self::Heading) (rad).
    #[error("sum of differences from the headings by the controls (rad) {0}")]
    TotalHeading(Excess),
    /// Stated forward speed of a sample (m/s).
    #[error("speed (m/s) {0}")]
    Speed(Excess),
    /// Stated speed backwards of a sample (m/s).
    #[error("speed backwards (m/s) {0}")]
    ReverseSpeed(Excess),
    /// Stated turning rate of a sample (rad/s).
    #[error("turning rate (rad/s) {0}")]
    TurnRate(Excess),
    /// Speed of a wheel by the stated controls of a sample (m/s).
    #[error("wheel speed (m/s) {0}")]
    WheelSpeed(Excess),
    /// Speed by the positions and times of two samples (m/s).
    #[error("speed from positions (m/s) {0}")]
    PoseSpeed(Excess),
    /// Turning rate by the headings and times of two samples (rad/s).
    #[error("turning rate from headings (rad/s) {0}")]
    PoseTurnRate(Excess),
    /// Speed of a wheel by the poses and times of two samples (m/s).
    #[error("wheel speed from poses (m/s) {0}")]
    PoseWheelSpeed(Excess),
    /// Rate of change of the speed (m/s²).
    #[error("acceleration (m/s²) {0}")]
    Acceleration(Excess),
    /// Rate of change of the turning rate (rad/s²).
    #[error("angular acceleration (rad/s²) {0}")]
    AngularAcceleration(Excess),
    /// Depth of the path in a grown obstacle (m).
    #[error("depth in obstacle {obstacle} (m) {excess}")]
    Penetration {
        /// Index of the obstacle in the contract, from 0.
        obstacle: usize,
        /// Time and depth (m).
        excess: Excess,
    },
    /// Distance of the path outside the bounds (m).
    #[error("distance outside the bounds (m) {0}")]
    Bounds(Excess),
}
