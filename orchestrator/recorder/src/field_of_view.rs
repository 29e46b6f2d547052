//! Fields of view of robots or fixed points, drawn by viewers and reports.

use geometry::visibility::polygon::SightLimits;
use serde::{Deserialize, Serialize};

/// A field of view; viewers draw the visible area as a polygon.
///
/// In JSON its origin is the key `robot` or `point`.
///
/// ```
/// use recorder::{FieldOfView, ViewOrigin};
///
/// let field = FieldOfView {
///     name: "seen by camera".to_owned(),
///     origin: ViewOrigin::Point([1.0, 0.5]),
///     range: Some(3.0),
///     angle: None,
/// };
/// assert!(field.limits().is_all_round());
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FieldOfView {
    /// Unique name in viewers.
    pub name: String,
    /// Apex.
    #[serde(flatten)]
    pub origin: ViewOrigin,
    /// Maximum distance (m); unlimited if absent.
    pub range: Option<f64>,
    /// Full opening angle around the robot's heading (rad); 2π if absent.
    #[serde(rename = "field_of_view")]
    pub angle: Option<f64>,
}

impl FieldOfView {
    /// Returns range and angle.
    pub fn limits(&self) -> SightLimits {
        SightLimits {
            range: self.range,
            field_of_view: self.angle,
        }
    }
}

/// The apex of a field of view.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ViewOrigin {
    /// A robot, by index, while it is active.
    Robot(u32),
    /// A fixed point (m).
    Point([f64; 2]),
}
