//! What can be wrong with a trajectory.

use core::fmt;

use thiserror::Error;

/// A quantity beyond what is allowed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Excess {
    /// When, in the trajectory's own time (s).
    pub time: f64,
    /// The value found, in the unit of the violation.
    pub value: f64,
    /// The highest value allowed, tolerance included, in the same unit.
    pub limit: f64,
}

impl fmt::Display for Excess {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { time, value, limit } = self;
        write!(f, "is {value:.6e} at {time:.4} s, at most {limit:.6e}")
    }
}

/// One way in which a trajectory is not honest. A [`Report`](crate::Report) holds each kind at most
/// once, at its worst.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum Violation {
    /// The problem itself cannot be meant; nothing was checked.
    #[error("contract: {what} is {value}, but must be {expected}")]
    Contract {
        /// The field.
        what: &'static str,
        /// Its value; for obstacles see `what`.
        value: f64,
        /// What would have been accepted.
        expected: &'static str,
    },
    /// There is no sample.
    #[error("the trajectory has no sample")]
    Empty,
    /// A number of a sample is NaN, infinite, or of a magnitude above 10⁹; nothing was checked.
    #[error("{what} of sample {index} is {value}, no usable number")]
    NotFinite {
        /// Which sample, from 0.
        index: usize,
        /// The field.
        what: &'static str,
        /// Its value.
        value: f64,
    },
    /// The first sample is not at time 0 (s).
    #[error("first time [s] {0}")]
    StartTime(Excess),
    /// Time runs backwards, by so much (s).
    #[error("step back in time [s] {0}")]
    TimeBackwards(Excess),
    /// Distance from the prescribed start (m).
    #[error("distance from the start [m] {0}")]
    Start(Excess),
    /// Difference from the prescribed heading at the start (rad).
    #[error("error of the start's heading [rad] {0}")]
    StartHeading(Excess),
    /// Difference from the prescribed speed at the start (m/s).
    #[error("error of the start's speed [m/s] {0}")]
    StartSpeed(Excess),
    /// Difference from the prescribed turning rate at the start (rad/s).
    #[error("error of the start's turning rate [rad/s] {0}")]
    StartTurnRate(Excess),
    /// Distance of the end from the goal (m).
    #[error("distance from the goal [m] {0}")]
    Goal(Excess),
    /// Difference from the prescribed heading at the goal (rad).
    #[error("error of the goal's heading [rad] {0}")]
    GoalHeading(Excess),
    /// Difference from the prescribed speed at the goal (m/s).
    #[error("error of the goal's speed [m/s] {0}")]
    GoalSpeed(Excess),
    /// Samples so far apart (m) that something could hide between them.
    #[error("way between two samples [m] {0}")]
    Spacing(Excess),
    /// The pose changes while no time passes (m or rad, whichever is more).
    #[error("jump of the pose in no time [m or rad] {0}")]
    Jump(Excess),
    /// The speed steps although the acceleration is limited (m/s).
    #[error("step of the speed [m/s] {0}")]
    SpeedStep(Excess),
    /// The turning rate steps although the angular acceleration is limited (rad/s).
    #[error("step of the turning rate [rad/s] {0}")]
    TurnRateStep(Excess),
    /// Distance between a sample and where the controls lead from the sample before (m).
    #[error("distance from where the controls lead [m] {0}")]
    Displacement(Excess),
    /// Angle between a sample's heading and the one the controls lead to (rad).
    #[error("difference from the heading the controls lead to [rad] {0}")]
    Heading(Excess),
    /// Distances too small to be a [`Displacement`](Self::Displacement) add up to too much (m).
    #[error("sum of distances from where the controls lead [m] {0}")]
    TotalDisplacement(Excess),
    /// Differences too small to be a [`Heading`](Self::Heading) add up to too much (rad).
    #[error("sum of differences from the headings the controls lead to [rad] {0}")]
    TotalHeading(Excess),
    /// Speed a sample states (m/s).
    #[error("speed [m/s] {0}")]
    Speed(Excess),
    /// Turning rate a sample states (rad/s).
    #[error("turning rate [rad/s] {0}")]
    TurnRate(Excess),
    /// Speed of a wheel by what a sample states (m/s).
    #[error("wheel speed [m/s] {0}")]
    WheelSpeed(Excess),
    /// Speed by the positions and times of two samples (m/s).
    #[error("speed from positions [m/s] {0}")]
    PoseSpeed(Excess),
    /// Turning rate by the headings and times of two samples (rad/s).
    #[error("turning rate from headings [rad/s] {0}")]
    PoseTurnRate(Excess),
    /// Speed of a wheel by the poses and times of two samples (m/s).
    #[error("wheel speed from poses [m/s] {0}")]
    PoseWheelSpeed(Excess),
    /// Rate of change of the speed (m/s²).
    #[error("acceleration [m/s²] {0}")]
    Acceleration(Excess),
    /// Rate of change of the turning rate (rad/s²).
    #[error("angular acceleration [rad/s²] {0}")]
    AngularAcceleration(Excess),
    /// Depth of the path in a grown obstacle (m).
    #[error("depth in obstacle {obstacle} [m] {excess}")]
    Penetration {
        /// Which obstacle of the contract, from 0.
        obstacle: usize,
        /// When, and how deep (m).
        excess: Excess,
    },
    /// Distance of the path outside the bounds (m).
    #[error("distance outside the bounds [m] {0}")]
    Bounds(Excess),
}
