//! Regions that a path must avoid or stay within.

use nalgebra::{Point2, Vector2};
use parry2d_f64::math::Vector;

use crate::contract::Obstacle;
use crate::polygon::{ConvexPolygon, segment, to_point};

/// A disc around a grown obstacle.
#[derive(Debug, Clone, Copy)]
pub struct EnclosingDisc {
    center: Point2<f64>,
    radius: f64,
}

impl EnclosingDisc {
    /// Returns `true` if every point within `radius` (m) of `point` is at least `gap` (m) outside. Quick, and
    /// `false` if in doubt.
    pub fn is_farther(&self, point: Point2<f64>, radius: f64, gap: f64) -> bool {
        let apart = gap + radius + self.radius;
        apart <= 0.0 || (point - self.center).norm_squared() >= apart * apart
    }
}

/// An obstacle grown by the clearance.
#[derive(Debug, Clone)]
pub struct GrownObstacle {
    shape: Shape,
    clearance: f64,
}

#[derive(Debug, Clone)]
enum Shape {
    Disc { center: Vector, radius: f64 },
    Polygon(ConvexPolygon),
}

impl GrownObstacle {
    /// An obstacle that [`validity`](crate::validity) has accepted, with the clearance (m) (≥ 0)
    /// around it; and a disc around that.
    pub fn new(obstacle: &Obstacle, clearance: f64) -> (EnclosingDisc, Self) {
        let (center, reach, shape) = match obstacle {
            Obstacle::Disc { center, radius } => {
                let shape = Shape::Disc {
                    center: Vector::new(center.x, center.y),
                    radius: *radius,
                };
                (*center, *radius, shape)
            }
            Obstacle::Polygon { vertices } => {
                let sum: Vector2<f64> = vertices.iter().map(|vertex| vertex.coords).sum();
                let center = Point2::from(sum / vertices.len().max(1) as f64);
                let reach = vertices
                    .iter()
                    .map(|vertex| (vertex - center).norm())
                    .fold(0.0, f64::max);
                (center, reach, Shape::Polygon(ConvexPolygon::new(vertices)))
            }
        };
        let around = EnclosingDisc {
            center,
            radius: reach + clearance,
        };
        (around, Self { shape, clearance })
    }

    /// Distance (m) from the segment `a`–`b`; minus the maximum depth of a point of it inside.
    pub fn distance(&self, a: Point2<f64>, b: Point2<f64>) -> f64 {
        let ungrown = match &self.shape {
            Shape::Disc { center, radius } => to_point(&segment(a, b), *center) - radius,
            Shape::Polygon(polygon) => polygon.distance(a, b),
        };
        ungrown - self.clearance
    }
}

/// Distance (m) of the segment `a`–`b` from the border of the box `[x_min, y_min, x_max, y_max]` inside it;
/// below 0 if it leaves the box. (A box is convex: an end is the farthest out.)
pub fn inside_box([x_min, y_min, x_max, y_max]: [f64; 4], a: Point2<f64>, b: Point2<f64>) -> f64 {
    [a, b]
        .iter()
        .flat_map(|p| [p.x - x_min, x_max - p.x, p.y - y_min, y_max - p.y])
        .fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_disc_is_grown_by_the_clearance() {
        let disc = Obstacle::Disc {
            center: Point2::new(0.0, 1.0),
            radius: 0.3,
        };
        let (around, grown) = GrownObstacle::new(&disc, 0.2);
        let (a, b) = (Point2::new(-1.0, 0.0), Point2::new(1.0, 0.0));
        assert!((grown.distance(a, b) - 0.5).abs() < 1e-12);
        assert!(
            (grown.distance(Point2::new(0.0, -1.0), Point2::new(0.0, 3.0)) + 0.5).abs() < 1e-12
        );
        assert!(around.is_farther(Point2::new(0.0, -1.0), 0.5, 0.9));
        assert!(!around.is_farther(Point2::new(0.0, -1.0), 0.5, 1.1));
    }

    #[test]
    fn a_box_is_left_by_an_end() {
        let bounds = [0.0, 0.0, 4.0, 3.0];
        let inside = inside_box(bounds, Point2::new(1.0, 1.0), Point2::new(3.5, 1.5));
        assert!((inside - 0.5).abs() < 1e-12);
        assert!(inside_box(bounds, Point2::new(1.0, 1.0), Point2::new(1.0, 3.1)) < -0.09);
    }
}
