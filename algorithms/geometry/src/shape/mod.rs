//! Shapes of obstacles: the specification in a scenario, and the convex parts for computations.

mod band;
mod between;
mod convex;
mod polygon;
mod travel;

pub use convex::{Aabb, Contact, Convex, ray_disc};
pub use travel::ShortArc;

use nalgebra::Point2;
use parameters::{Parameters, ParamsError, check, each, unit};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::extent::{coordinate, positive};
use crate::math;
use crate::pose::Pose2;

/// Maximum number of vertices of a polygon.
pub const MAX_VERTICES: usize = 4096;
/// Maximum number of vertices of a non-convex polygon: the time of its decomposition grows with
/// their cube.
pub const MAX_CONCAVE_VERTICES: usize = 512;

/// A solid shape in the plane, in world coordinates.
///
/// In TOML: `{ circle = { center = [0, 0], radius = 1 } }`,
/// `{ rectangle = { center = [0, 0], half_extents = [1, 0.5], angle = 0.3 } }` or
/// `{ polygon = { vertices = [[0, 0], [1, 0], [0, 1]] } }`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Shape {
    /// A disc.
    Circle {
        /// Centre, x and y.
        #[schemars(transform = each(coordinate()))]
        center: [f64; 2],
        /// Radius.
        #[schemars(transform = positive("m"))]
        radius: f64,
    },
    /// A rectangle.
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
    /// A simple polygon, convex or not, in either orientation; the last vertex joins the first.
    Polygon {
        /// Corners in order, at most 512 if the polygon is not convex.
        #[schemars(
            length(min = 3, max = MAX_VERTICES),
            transform = each(each(coordinate()))
        )]
        vertices: Vec<[f64; 2]>,
    },
}

/// Computational effort.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(crate) struct Effort {
    /// Pairs of edges that may cross.
    pub pairs: usize,
    /// The cube of the number of vertices of a polygon that is not convex.
    pub cuts: usize,
}

/// Reason why a shape is invalid.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ShapeError {
    /// A value out of its range.
    #[error(transparent)]
    Field(#[from] ParamsError),
    /// Two edges of a polygon meet.
    #[error(
        "polygon.vertices: edge {first} (from vertex {first}) meets edge {second} (from vertex \
         {second}): expected a simple polygon, whose edges touch only at shared vertices"
    )]
    SelfIntersecting {
        /// Index of the vertex at the start of the first edge.
        first: usize,
        /// Index of the vertex at the start of the second edge.
        second: usize,
    },
    /// A polygon without an area.
    #[error("polygon.vertices: the polygon has no area: expected corners that enclose one")]
    NoArea,
    /// A polygon whose corners lie so close to other edges that it cannot be decomposed.
    #[error(
        "polygon.vertices: the polygon cannot be divided into convex parts: expected corners that \
         are farther than rounding from the other edges"
    )]
    NotDivisible,
}

impl Parameters for Shape {}

impl Shape {
    /// The convex parts whose union is the shape; a convex shape is its own single part.
    ///
    /// # Errors
    /// The error names the field that is out of its range, or the edges that cross.
    ///
    /// ```
    /// use geometry::shape::Shape;
    ///
    /// let corner = Shape::Polygon {
    ///     vertices: vec![[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]],
    /// };
    /// assert!(corner.parts()?.len() > 1);
    /// let crossed = Shape::Polygon {
    ///     vertices: vec![[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]],
    /// };
    /// assert!(crossed.parts().is_err());
    /// # Ok::<(), geometry::shape::ShapeError>(())
    /// ```
    pub fn parts(&self) -> Result<Vec<Convex>, ShapeError> {
        check(self)?;
        match self {
            Self::Circle { center, radius } => {
                let center = Point2::new(center[0], center[1]);
                Ok(vec![Convex::disc(center, *radius)])
            }
            Self::Rectangle {
                center,
                half_extents,
                angle,
            } => {
                let center = Point2::new(center[0], center[1]);
                Ok(vec![Convex::rectangle(center, *half_extents, *angle)])
            }
            Self::Polygon { vertices } => polygon::convex_parts(vertices),
        }
    }

    /// The effort to compute the parts: pairs of edges, and vertices cubed if the shape must be
    /// decomposed.
    pub(crate) fn effort(&self) -> Effort {
        match self {
            Self::Circle { .. } | Self::Rectangle { .. } => Effort::default(),
            Self::Polygon { vertices } => polygon::effort(vertices),
        }
    }

    /// The shape after a rigid motion: rotated by `motion.theta` about `pivot` (m), then shifted by
    /// (`motion.x`, `motion.y`).
    #[must_use]
    pub fn moved(&self, pivot: Point2<f64>, motion: Pose2) -> Self {
        let (sin, cos) = math::sincos(motion.theta);
        let carry = |p: &[f64; 2]| {
            let (dx, dy) = (p[0] - pivot.x, p[1] - pivot.y);
            [
                pivot.x + cos * dx - sin * dy + motion.x,
                pivot.y + sin * dx + cos * dy + motion.y,
            ]
        };
        match self {
            Self::Circle { center, radius } => Self::Circle {
                center: carry(center),
                radius: *radius,
            },
            Self::Rectangle {
                center,
                half_extents,
                angle,
            } => Self::Rectangle {
                center: carry(center),
                half_extents: *half_extents,
                angle: angle + motion.theta,
            },
            Self::Polygon { vertices } => Self::Polygon {
                vertices: vertices.iter().map(carry).collect(),
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use expect_test::expect;

    use super::*;

    #[test]
    fn shapes_read_and_write_as_toml_tables() {
        #[derive(Serialize, Deserialize, PartialEq, Debug)]
        struct File {
            shapes: Vec<Shape>,
        }
        let text = "
            [[shapes]]
            circle = { center = [1.0, 2.0], radius = 0.5 }
            [[shapes]]
            rectangle = { center = [1.0, 2.0], half_extents = [0.5, 1.0] }
            [[shapes]]
            polygon = { vertices = [[0, 0], [1, 0], [0, 1]] }
        ";
        let file: File = toml::from_str(text).unwrap();
        let again: File = toml::from_str(&toml::to_string(&file).unwrap()).unwrap();
        assert_eq!(again, file);
        assert!(toml::from_str::<File>("shapes = [{ circle = { centre = [0, 0] } }]").is_err());
    }

    #[test]
    fn bad_values_are_named() {
        let polygon = |vertices: &[[f64; 2]]| Shape::Polygon {
            vertices: vertices.to_vec(),
        };
        let errors = [
            Shape::Circle {
                center: [0.0, f64::NAN],
                radius: 1.0,
            },
            Shape::Rectangle {
                center: [0.0; 2],
                half_extents: [1.0, 0.0],
                angle: 0.0,
            },
            polygon(&[[0.0, 0.0], [1.0, 0.0]]),
            polygon(&[[0.0, 0.0], [1.0, f64::INFINITY], [0.0, 1.0]]),
        ]
        .map(|shape| shape.parts().unwrap_err().to_string());
        expect![[r#"
            `circle.center[1]` is NaN: expected a number within ±100000 (m)
            `rectangle.half_extents[1]` is 0: expected a number above 0 and at most 100000 (m)
            `polygon.vertices` is a list of 2: expected 3 to 4096 values
            `polygon.vertices[1][1]` is inf: expected a number within ±100000 (m)"#]]
        .assert_eq(&errors.join("\n"));
    }

    #[test]
    fn a_rigid_motion_turns_about_the_pivot() {
        let shape = Shape::Rectangle {
            center: [1.0, 0.0],
            half_extents: [1.0, 0.1],
            angle: 0.0,
        };
        let quarter = Pose2::new(0.0, 3.0, core::f64::consts::FRAC_PI_2);
        let Shape::Rectangle { center, angle, .. } = shape.moved(Point2::origin(), quarter) else {
            panic!("still a rectangle")
        };
        assert!((center[0]).abs() < 1e-12 && (center[1] - 4.0).abs() < 1e-12);
        assert!((angle - core::f64::consts::FRAC_PI_2).abs() < 1e-12);
    }
}
