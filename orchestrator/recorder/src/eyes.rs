//! Viewpoints: what is seen from them is drawn for viewers.

use geometry::visibility::polygon::SightLimits;
use serde::Serialize;

/// A viewpoint: what is seen from it is drawn.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct EyeInfo {
    /// What viewers call what is seen from there; unique.
    pub name: String,
    /// Where it is.
    #[serde(flatten)]
    pub place: EyePlace,
    /// Largest distance (m); unlimited if absent.
    pub range: Option<f64>,
    /// Full opening angle around the robot's heading (rad); all round if absent.
    pub field_of_view: Option<f64>,
}

impl EyeInfo {
    /// How far and how wide it sees.
    pub fn limits(&self) -> SightLimits {
        SightLimits {
            range: self.range,
            field_of_view: self.field_of_view,
        }
    }
}

/// Place of a viewpoint.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum EyePlace {
    /// A robot, by its index: as long as it plays.
    Robot(u32),
    /// A fixed place (m).
    Point([f64; 2]),
}
