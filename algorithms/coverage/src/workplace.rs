//! A rectangular workplace with obstacles, as rectangles that a robot's centre avoids.
//!
//! Edge expansion as in the Chebyshev coverage paper, §4: the robot is a disc of radius r, the
//! workplace shrinks by r on every side and every obstacle grows by r on every side. Obstacles other
//! than axis-aligned rectangles are replaced by rectangles around them (the paper's future work): slabs
//! of which no point lies farther than a tolerance from the obstacle.

mod error;
mod loss;
mod slabs;
#[cfg(test)]
mod tests;

pub use error::WorkplaceError;
pub use loss::ConversionLoss;

use geometry::shape::{Aabb, Convex, Shape};
use metrics::coverage::{CoverageDomain, CoverageError, Rectangle};
use nalgebra::{Point2, Vector2};

/// Maximum number of rectangles that represent the obstacles of a workplace.
pub const MAX_RECTANGLES: usize = 4096;

/// Minimum tolerance of the conversion to rectangles (m); well above the rounding of coordinates.
pub const MIN_TOLERANCE: f64 = 1e-6;

/// A workplace for one size of robot.
#[derive(Debug, Clone, PartialEq)]
pub struct Workplace {
    bounds: Aabb,
    radius: f64,
    tolerance: f64,
    rectangles: Vec<Aabb>,
    inflated: Vec<Aabb>,
    loss: ConversionLoss,
}

impl Workplace {
    /// Creates the workplace within `bounds` (m) of a robot of `radius` (m) among obstacles. Obstacles
    /// other than axis-aligned rectangles become rectangles that extend beyond them by at most
    /// `tolerance` (m), ≥ [`MIN_TOLERANCE`].
    ///
    /// # Errors
    /// [`WorkplaceError`] names the invalid obstacle or value and the remedy.
    pub fn new(
        bounds: Aabb,
        radius: f64,
        obstacles: &[Shape],
        tolerance: f64,
    ) -> Result<Self, WorkplaceError> {
        let mut parts = Vec::new();
        for (index, shape) in obstacles.iter().enumerate() {
            let pieces = shape
                .parts()
                .map_err(|source| WorkplaceError::Shape { index, source })?;
            if pieces.iter().all(|piece| is_outside(piece, &bounds)) {
                return Err(WorkplaceError::Outside { index, bounds });
            }
            if pieces.iter().any(|piece| covers(piece, &bounds, radius)) {
                return Err(WorkplaceError::Covering { index });
            }
            parts.extend(pieces);
        }
        Self::from_parts(bounds, radius, &parts, tolerance)
    }

    /// The same from convex pieces of a map ([`planner_view::free_space::FreeSpace`]). Pieces outside
    /// the workplace are ignored: a map may be larger than the area to cover.
    ///
    /// # Errors
    /// [`WorkplaceError`] names the invalid piece or value and the remedy.
    pub fn from_parts(
        bounds: Aabb,
        radius: f64,
        parts: &[Convex],
        tolerance: f64,
    ) -> Result<Self, WorkplaceError> {
        let finite = |p: Point2<f64>| p.x.is_finite() && p.y.is_finite();
        let size = bounds.max - bounds.min;
        let sound = finite(bounds.min) && finite(bounds.max) && size.x > 0.0 && size.y > 0.0;
        if !sound {
            return Err(WorkplaceError::Bounds(bounds));
        }
        let limit = 0.5 * size.x.min(size.y);
        let fits = radius >= 0.0 && radius < limit;
        if !fits {
            return Err(WorkplaceError::Radius { radius, limit });
        }
        let usable = tolerance >= MIN_TOLERANCE && tolerance.is_finite();
        if !usable {
            return Err(WorkplaceError::Tolerance { tolerance });
        }
        let mut rectangles = Vec::new();
        for (index, part) in parts.iter().enumerate() {
            let aabb = part.aabb();
            if !(finite(aabb.min) && finite(aabb.max)) {
                return Err(WorkplaceError::NotFinite { index });
            }
            if is_outside(part, &bounds) {
                continue;
            }
            slabs::cover(part, tolerance, MAX_RECTANGLES, &mut rectangles);
            if rectangles.len() > MAX_RECTANGLES {
                return Err(WorkplaceError::TooManyRectangles { tolerance });
            }
        }
        let free = shrunken(&bounds, radius);
        let inflated = rectangles
            .iter()
            .filter_map(|rectangle| inflate_and_clip(rectangle, radius, &free))
            .collect();
        let loss = loss::of_conversion(&free, radius, parts, &rectangles);
        Ok(Self {
            bounds,
            radius,
            tolerance,
            rectangles,
            inflated,
            loss,
        })
    }

    /// The workplace itself (m).
    pub fn bounds(&self) -> &Aabb {
        &self.bounds
    }

    /// Free positions of the robot's centre without obstacles (m): the workplace shrunk by the radius.
    pub fn inner(&self) -> Aabb {
        shrunken(&self.bounds, self.radius)
    }

    /// The robot's radius (m).
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// Maximum distance by which rectangles extend beyond the obstacles that they represent (m).
    pub fn tolerance(&self) -> f64 {
        self.tolerance
    }

    /// The rectangles that represent the obstacles (m), at their own size.
    pub fn rectangles(&self) -> &[Aabb] {
        &self.rectangles
    }

    /// The rectangles that the robot's centre avoids (m): grown by the radius on every side and clipped
    /// to [`Workplace::inner`].
    pub fn inflated(&self) -> &[Aabb] {
        &self.inflated
    }

    /// The free space lost by the conversion to rectangles.
    pub fn loss(&self) -> ConversionLoss {
        self.loss
    }

    /// The workplace for the metric of coverage.
    ///
    /// # Errors
    /// [`CoverageError`] does not occur for a valid workplace; it is returned rather than hidden.
    pub fn domain(&self) -> Result<CoverageDomain, CoverageError> {
        let rectangle = |aabb: &Aabb| Rectangle::new(aabb.min, aabb.max);
        CoverageDomain::new(
            rectangle(&self.bounds),
            self.radius,
            self.inflated.iter().map(rectangle).collect(),
        )
    }
}

fn shrunken(bounds: &Aabb, radius: f64) -> Aabb {
    let margin = Vector2::repeat(radius);
    Aabb {
        min: bounds.min + margin,
        max: bounds.max - margin,
    }
}

/// Grows and clips a rectangle; `None` if the result has no inside.
fn inflate_and_clip(rectangle: &Aabb, radius: f64, free: &Aabb) -> Option<Aabb> {
    let margin = Vector2::repeat(radius);
    let min = (rectangle.min - margin).sup(&free.min);
    let max = (rectangle.max + margin).inf(&free.max);
    (min.x < max.x && min.y < max.y).then_some(Aabb { min, max })
}

/// Returns `true` if a piece has no point in the open workplace.
fn is_outside(piece: &Convex, bounds: &Aabb) -> bool {
    let aabb = piece.aabb();
    let reach = piece
        .extent_in_band(1, bounds.min.y, bounds.max.y)
        .is_none_or(|(low, high)| high <= bounds.min.x || low >= bounds.max.x);
    reach || aabb.max.y <= bounds.min.y || aabb.min.y >= bounds.max.y
}

/// Returns `true` if a piece grown by the radius contains the whole workplace shrunk by it.
fn covers(piece: &Convex, bounds: &Aabb, radius: f64) -> bool {
    let free = shrunken(bounds, radius);
    let corners = [
        free.min,
        free.max,
        Point2::new(free.min.x, free.max.y),
        Point2::new(free.max.x, free.min.y),
    ];
    // Grown by a disc it is convex: if it contains the corners, it contains the whole rectangle.
    radius >= 0.0
        && corners
            .iter()
            .all(|&corner| piece.distance(corner) <= radius)
}
