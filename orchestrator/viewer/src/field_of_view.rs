//! Fields of view: what viewers draw as seen from a robot or a place.

use geometry::visibility::polygon::SightLimits;
use serde::Serialize;

/// A field of view, which viewers draw as the polygon of what is seen in it.
///
/// In JSON its origin is the key `robot` or `point`.
///
/// ```
/// use viewer::{FieldOfView, ViewOrigin};
///
/// let field = FieldOfView {
///     name: "seen by camera".to_owned(),
///     origin: ViewOrigin::Point([1.0, 0.5]),
///     range: Some(3.0),
///     angle: None,
/// };
/// assert!(field.limits().is_all_round());
/// ```
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FieldOfView {
    /// What viewers call it; unique.
    pub name: String,
    /// Where its apex is.
    #[serde(flatten)]
    pub origin: ViewOrigin,
    /// Largest distance (m); unlimited if absent.
    pub range: Option<f64>,
    /// Full opening angle around the robot's heading (rad); all round if absent.
    #[serde(rename = "field_of_view")]
    pub angle: Option<f64>,
}

impl FieldOfView {
    /// Its range and angle.
    pub fn limits(&self) -> SightLimits {
        SightLimits {
            range: self.range,
            field_of_view: self.angle,
        }
    }
}

/// The apex of a field of view.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ViewOrigin {
    /// A robot, by its index: as long as it plays.
    Robot(u32),
    /// A fixed place (m).
    Point([f64; 2]),
}
