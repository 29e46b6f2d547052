//! Choices that the paper leaves open: rounding of lengths to numbers of waypoints, and orientation
//! of the square of the generator's points.

use nalgebra::Vector2;

parameters::choice! {
    /// Conversion of a segment's length, as a multiple of the patrol's speed, to a number of waypoints
    /// (paper, Eq. 10).
    pub enum Rounding {
        /// Downwards, as printed.
        Floor,
        /// To the nearest, so that a lap of `t_max` seconds has close to `t_max` waypoints.
        #[default]
        Nearest,
    }
}

impl Rounding {
    pub(super) fn shift(self) -> f64 {
        match self {
            Self::Floor => 0.0,
            Self::Nearest => 0.5,
        }
    }
}

parameters::choice! {
    /// Orientation of the square on a segment (paper, Eq. 3).
    pub enum Frame {
        /// Ahead of the robot, on every segment alike.
        #[default]
        Atan2,
        /// By the segment's slope, as printed: behind the robot on segments towards smaller x, so that
        /// the same contour rotated by 180° gives another zig-zag.
        Atan,
    }
}

impl Frame {
    pub(super) fn facing(self, along: Vector2<f64>) -> Vector2<f64> {
        match self {
            Self::Atan if along.x < 0.0 => -along,
            Self::Atan | Self::Atan2 => along,
        }
    }
}

/// Both choices.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Mode {
    /// Rounding of numbers of waypoints.
    pub rounding: Rounding,
    /// Orientation of the square.
    pub frame: Frame,
}

parameters::choice! {
    /// Named choices.
    pub enum Preset {
        /// The formulas as the paper prints them: floor, atan.
        Printed,
        /// The best fit to the paper's figures: nearest, atan.
        PaperFit,
        /// The recommended choices: nearest, atan2.
        #[default]
        Default,
    }
}

impl Preset {
    /// The choices of the preset.
    pub fn mode(self) -> Mode {
        let (rounding, frame) = match self {
            Self::Printed => (Rounding::Floor, Frame::Atan),
            Self::PaperFit => (Rounding::Nearest, Frame::Atan),
            Self::Default => (Rounding::Nearest, Frame::Atan2),
        };
        Mode { rounding, frame }
    }
}
