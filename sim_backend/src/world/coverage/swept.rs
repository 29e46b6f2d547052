//! The area that a disc passes over while its centre moves.

use nalgebra::{Point2, Vector2};

use geometry::math;
use geometry::pose::{Pose2, Twist2};
use geometry::shape::Aabb;

/// Distance (m) between an arc and its chord below which the chord replaces it: far below any cell,
/// far above rounding.
const FLAT: f64 = 1e-7;

/// The path of a centre.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SweptPath {
    /// Straight; both ends may be one point.
    Straight { from: Point2<f64>, to: Point2<f64> },
    /// Around a centre.
    Arc {
        center: Point2<f64>,
        radius: f64,
        /// From the centre to both ends.
        start: Vector2<f64>,
        end: Vector2<f64>,
        /// Angle turned (rad), counter-clockwise positive.
        sweep: f64,
    },
}

impl SweptPath {
    /// The path of a robot that keeps a twist for `dt` (s).
    pub fn from_twist(pose: Pose2, twist: Twist2, dt: f64, end: Point2<f64>) -> Self {
        let (from, sweep) = (pose.position(), twist.omega * dt);
        if (twist.v * dt * sweep).abs() <= 8.0 * FLAT {
            return Self::Straight { from, to: end };
        }
        let radius = twist.v / twist.omega;
        let (sin, cos) = math::sincos(pose.theta);
        let center = from + Vector2::new(-sin, cos) * radius;
        Self::Arc {
            center,
            radius: radius.abs(),
            start: from - center,
            end: end - center,
            sweep,
        }
    }

    /// A rectangle that contains all points of the path, nearly as small as possible.
    pub fn bounds(&self) -> Aabb {
        let (a, b, beyond) = match *self {
            Self::Straight { from, to } => (from, to, 0.0),
            Self::Arc {
                center,
                radius,
                start,
                end,
                sweep,
            } => {
                // No point is farther from the nearer end than half the arc, or the diameter.
                let beyond = (0.5 * radius * sweep.abs()).min(2.0 * radius);
                (center + start, center + end, beyond)
            }
        };
        let grow = Vector2::new(beyond, beyond);
        Aabb {
            min: a.inf(&b) - grow,
            max: a.sup(&b) + grow,
        }
    }

    /// Returns `true` if some point of the path is at most `reach` (m) from `p`.
    pub fn passes(&self, p: Point2<f64>, reach: f64) -> bool {
        match *self {
            Self::Straight { from, to } => {
                let (along, offset) = (to - from, p - from);
                let length_squared = along.norm_squared();
                let part = if length_squared > 0.0 {
                    (offset.dot(&along) / length_squared).clamp(0.0, 1.0)
                } else {
                    0.0
                };
                (offset - along * part).norm_squared() <= reach * reach
            }
            Self::Arc {
                center,
                radius,
                start,
                end,
                sweep,
            } => {
                let ray = p - center;
                let beside = if faces(ray, start, end, sweep) {
                    (ray.norm() - radius).abs() <= reach
                } else {
                    false
                };
                beside
                    || (ray - start).norm_squared() <= reach * reach
                    || (ray - end).norm_squared() <= reach * reach
            }
        }
    }
}

/// Returns `true` if a direction lies within the angle swept from `start` to `end`.
fn faces(ray: Vector2<f64>, start: Vector2<f64>, end: Vector2<f64>, sweep: f64) -> bool {
    use core::f64::consts::{PI, TAU};
    let turns_left = |a: Vector2<f64>, b: Vector2<f64>| sweep.signum() * a.perp(&b);
    if sweep.abs() >= TAU {
        true
    } else if sweep.abs() <= PI {
        turns_left(start, ray) >= 0.0 && turns_left(ray, end) >= 0.0
    } else {
        !(turns_left(end, ray) > 0.0 && turns_left(ray, start) > 0.0)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use robot::drive::integrate;

    proptest! {
        /// Compared with many discs along the path.
        #[test]
        fn paths_pass_the_points_that_discs_along_them_cover(
            theta in -4.0..4.0_f64,
            v in prop_oneof![Just(0.0), -3.0..3.0_f64],
            omega in prop_oneof![Just(0.0), Just(1e-9), -9.0..9.0_f64],
            (x, y) in (-3.0..3.0_f64, -3.0..3.0_f64),
            reach in 0.05..1.0_f64,
        ) {
            let (pose, twist) = (Pose2::new(0.3, -0.2, theta), Twist2::new(v, omega));
            let way = SweptPath::from_twist(pose, twist, 1.0, integrate(pose, twist, 1.0).position());
            let p = Point2::new(x, y);
            let steps = 4000;
            let nearest = (0..=steps)
                .map(|k| integrate(pose, twist, f64::from(k) / f64::from(steps)).position())
                .map(|q| (q - p).norm())
                .fold(f64::INFINITY, f64::min);
            // Between two discs lie at most 3 m / 4000.
            let between = 4e-4;
            if nearest <= reach {
                prop_assert!(way.passes(p, reach + 1e-6), "{way:?}");
                let bounds = way.bounds();
                prop_assert!(
                    p.x >= bounds.min.x - reach && p.x <= bounds.max.x + reach
                        && p.y >= bounds.min.y - reach && p.y <= bounds.max.y + reach
                );
            } else if nearest > reach + between {
                prop_assert!(!way.passes(p, reach), "{way:?}");
            }
        }
    }
}
