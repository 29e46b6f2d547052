//! What the paper leaves open: how lengths round to numbers of waypoints, and which way the square
//! of the generator's points lies.

use nalgebra::Vector2;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How a segment's length, as a multiple of the patrol's speed, becomes a number of waypoints
/// (paper, Eq. 10).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Rounding {
    /// Downwards, as printed.
    Floor,
    /// To the nearest, which makes a lap of `t_max` seconds have close to `t_max` waypoints.
    #[default]
    Nearest,
}

impl Rounding {
    pub(super) fn shift(self) -> f64 {
        match self {
            Self::Floor => 0.0,
            Self::Nearest => 0.5,
        }
    }
}

/// Which way the square lies on a segment (paper, Eq. 3).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Frame {
    /// Ahead of the robot, on every segment alike.
    #[default]
    Atan2,
    /// By the segment's slope, as printed: behind the robot on segments that lead towards smaller x,
    /// so that the same contour turned by 180° gives another zig-zag.
    Atan,
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
    /// How many waypoints.
    pub rounding: Rounding,
    /// Which way the square lies.
    pub frame: Frame,
}

/// Choices with a name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Preset {
    /// The formulas as the paper prints them: floor, atan.
    Printed,
    /// What fits the paper's figures best: nearest, atan.
    PaperFit,
    /// What we recommend: nearest, atan2.
    #[default]
    Default,
}

impl Preset {
    /// The choices behind the name.
    pub fn mode(self) -> Mode {
        let (rounding, frame) = match self {
            Self::Printed => (Rounding::Floor, Frame::Atan),
            Self::PaperFit => (Rounding::Nearest, Frame::Atan),
            Self::Default => (Rounding::Nearest, Frame::Atan2),
        };
        Mode { rounding, frame }
    }
}
