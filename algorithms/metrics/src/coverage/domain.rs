//! Free positions of a robot's centre.

use nalgebra::Point2;
use thiserror::Error;

use super::TOLERANCE;

/// Reason why coverage cannot be measured.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum CoverageError {
    /// A rectangle without an inside, or with a corner that is not finite.
    #[error(
        "{what} from ({}, {}) to ({}, {}): expected finite corners, the first one below and left of \
         the second", .rectangle.min.x, .rectangle.min.y, .rectangle.max.x, .rectangle.max.y
    )]
    Rectangle {
        /// Name of the rectangle.
        what: &'static str,
        /// Its corners (m).
        rectangle: Rectangle,
    },
    /// The robot is larger than its workplace, or has no radius.
    #[error(
        "radius = {radius}: expected a number ≥ 0 and below {limit} (m), half the shorter side of \
         the workplace; enlarge the workplace or take a smaller robot"
    )]
    Radius {
        /// Actual radius (m).
        radius: f64,
        /// Upper limit of radii (m).
        limit: f64,
    },
    /// Invalid cells, or too many of them.
    #[error(
        "cell side = {side}: expected a number > 0 (m) that divides the workplace into at most \
         {MAX_CELLS} cells",
        MAX_CELLS = super::MAX_CELLS
    )]
    CellSide {
        /// Actual side (m).
        side: f64,
    },
    /// No cell has a free centre.
    #[error(
        "no centre of a cell of {side} m lies in free space: take smaller cells, a smaller robot or \
         fewer obstacles"
    )]
    NothingCoverable {
        /// Side of the cells (m).
        side: f64,
    },
    /// The distance between points of the path is not positive.
    #[error("step = {step}: expected a number > 0 (m), the distance between points of the path")]
    Step {
        /// Actual step (m).
        step: f64,
    },
}

/// An axis-aligned rectangle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rectangle {
    /// Corner with the smallest coordinates (m).
    pub min: Point2<f64>,
    /// Corner with the largest coordinates (m).
    pub max: Point2<f64>,
}

impl Rectangle {
    /// Creates a rectangle from two corners (m), the first with the smaller coordinates.
    pub fn new(min: Point2<f64>, max: Point2<f64>) -> Self {
        Self { min, max }
    }

    fn check(self, what: &'static str) -> Result<Self, CoverageError> {
        let finite = |p: Point2<f64>| p.x.is_finite() && p.y.is_finite();
        let has_inside = self.min.x < self.max.x && self.min.y < self.max.y;
        if finite(self.min) && finite(self.max) && has_inside {
            Ok(self)
        } else {
            Err(CoverageError::Rectangle {
                what,
                rectangle: self,
            })
        }
    }
}

/// The workplace of a measurement: bounds, the robot's radius, and the rectangles that its centre must
/// avoid.
#[derive(Debug, Clone, PartialEq)]
pub struct CoverageDomain {
    bounds: Rectangle,
    radius: f64,
    inflated: Vec<Rectangle>,
}

impl CoverageDomain {
    /// Creates the workplace within `bounds` (m) for a robot of `radius` (m); `inflated` are the obstacles
    /// with the radius added on every side.
    ///
    /// # Errors
    /// [`CoverageError`] if the bounds or an obstacle have no inside or are not finite, or if the
    /// robot does not fit between the bounds.
    pub fn new(
        bounds: Rectangle,
        radius: f64,
        inflated: Vec<Rectangle>,
    ) -> Result<Self, CoverageError> {
        bounds.check("workplace")?;
        let size = bounds.max - bounds.min;
        let limit = 0.5 * size.x.min(size.y);
        let fits = radius >= 0.0 && radius < limit;
        if !fits {
            return Err(CoverageError::Radius { radius, limit });
        }
        for obstacle in &inflated {
            obstacle.check("inflated obstacle")?;
        }
        Ok(Self {
            bounds,
            radius,
            inflated,
        })
    }

    /// The workplace (m).
    pub fn bounds(&self) -> Rectangle {
        self.bounds
    }

    /// The robot's radius (m).
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// The rectangles that the robot's centre must avoid (m).
    pub fn inflated(&self) -> &[Rectangle] {
        &self.inflated
    }

    /// Returns `true` if the robot's centre may be at a point (m): in the closed workplace shrunken by the
    /// radius and not strictly inside an inflated obstacle (both within 1 nm).
    pub fn is_free(&self, p: Point2<f64>) -> bool {
        let (low, high) = (self.bounds.min, self.bounds.max);
        let r = self.radius - TOLERANCE;
        p.x >= low.x + r
            && p.x <= high.x - r
            && p.y >= low.y + r
            && p.y <= high.y - r
            && !self.inflated.iter().any(|o| {
                p.x > o.min.x + TOLERANCE
                    && p.x < o.max.x - TOLERANCE
                    && p.y > o.min.y + TOLERANCE
                    && p.y < o.max.y - TOLERANCE
            })
    }
}
