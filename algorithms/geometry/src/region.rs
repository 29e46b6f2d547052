//! Regions of the rules: exits and goals.

use nalgebra::Point2;
use parameters::{Parameters, each, unit};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::extent::{coordinate, positive};
use crate::math;

/// A region of the plane that a robot reaches with its centre.
///
/// In TOML: `{ circle = { center = [9.0, 0.0], radius = 0.5 } }` or
/// `{ rectangle = { center = [9.0, 0.0], half_extents = [0.5, 1.25] } }`.
///
/// ```
/// use geometry::region::Region;
/// use nalgebra::Point2;
///
/// let exit = Region::Circle { center: [9.0, 0.0], radius: 0.5 };
/// assert!(exit.contains(Point2::new(8.6, 0.0)));
/// assert!(!exit.contains(Point2::new(8.5, 0.0)));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Region {
    /// The points strictly nearer to `center` than `radius`.
    Circle {
        /// Centre, x and y.
        #[schemars(transform = each(coordinate()))]
        center: [f64; 2],
        /// Radius.
        #[schemars(transform = positive("m"))]
        radius: f64,
    },
    /// The points strictly inside a rectangle.
    Rectangle {
        /// Centre, x and y.
        #[schemars(transform = each(coordinate()))]
        center: [f64; 2],
        /// Half the length of each side, along the rectangle's own x and y.
        #[schemars(transform = each(positive("m")))]
        half_extents: [f64; 2],
        /// Rotation about the centre, counter-clockwise.
        #[serde(default)]
        #[schemars(transform = unit("rad"))]
        angle: f64,
    },
}

impl Region {
    /// Returns `true` if a point (m) lies strictly inside.
    pub fn contains(&self, p: Point2<f64>) -> bool {
        match *self {
            Self::Circle { center, radius } => {
                let (dx, dy) = (p.x - center[0], p.y - center[1]);
                dx * dx + dy * dy < radius * radius
            }
            Self::Rectangle {
                center,
                half_extents,
                angle,
            } => {
                let (dx, dy) = (p.x - center[0], p.y - center[1]);
                let (x, y) = if angle == 0.0 {
                    (dx, dy)
                } else {
                    let (sin, cos) = math::sincos(angle);
                    (cos * dx + sin * dy, cos * dy - sin * dx)
                };
                x.abs() < half_extents[0] && y.abs() < half_extents[1]
            }
        }
    }

    /// The region's centre (m).
    pub fn center(&self) -> Point2<f64> {
        match *self {
            Self::Circle { center, .. } | Self::Rectangle { center, .. } => {
                Point2::new(center[0], center[1])
            }
        }
    }

    /// Radius (m) of the smallest circle around [`Self::center`] that covers the region.
    pub fn bounding_radius(&self) -> f64 {
        match *self {
            Self::Circle { radius, .. } => radius,
            Self::Rectangle { half_extents, .. } => math::hypot(half_extents[0], half_extents[1]),
        }
    }
}

impl Parameters for Region {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn borders_do_not_belong_to_the_region() {
        let circle = Region::Circle {
            center: [9.0, 0.0],
            radius: 0.5,
        };
        assert!(circle.contains(Point2::new(8.500_001, 0.0)));
        assert!(!circle.contains(Point2::new(8.5, 0.0)));
        let rectangle = Region::Rectangle {
            center: [1.0, 1.0],
            half_extents: [2.0, 0.5],
            angle: 0.0,
        };
        assert!(rectangle.contains(Point2::new(2.9, 1.4)));
        assert!(!rectangle.contains(Point2::new(3.0, 1.0)));
    }

    #[test]
    fn a_turned_rectangle_turns_counter_clockwise() {
        let region = Region::Rectangle {
            center: [0.0, 0.0],
            half_extents: [2.0, 0.1],
            angle: core::f64::consts::FRAC_PI_4,
        };
        assert!(region.contains(Point2::new(1.0, 1.0)));
        assert!(!region.contains(Point2::new(1.0, -1.0)));
    }
}
