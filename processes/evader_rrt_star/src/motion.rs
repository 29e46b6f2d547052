//! Motion primitives from a node of the tree to a point.

use geometry::math;
use geometry::pose::Pose2;
use nalgebra::{Point2, Vector2};
use planner_view::free_space::{Arc, FreeSpace};

/// Bend below which arcs count as straight lines (rad).
const STRAIGHT: f64 = 1e-7;

/// The shape of an edge.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Leg {
    /// Straight.
    Line,
    /// Along a circle.
    Arc(Arc),
}

/// Link from a pose to a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Link {
    /// Its length (m).
    pub length: f64,
    /// Heading at its end (rad).
    pub heading: f64,
    /// Its shape.
    pub leg: Leg,
}

impl Link {
    /// Returns a straight link. The heading at its end is that at its start; it is not used.
    pub const fn line(length: f64) -> Self {
        Self {
            length,
            heading: 0.0,
            leg: Leg::Line,
        }
    }

    /// Returns `true` if a robot of this radius (m) can drive this link between two points without
    /// contact.
    pub fn is_free(
        &self,
        space: &FreeSpace,
        from: Point2<f64>,
        to: Point2<f64>,
        radius: f64,
    ) -> bool {
        match &self.leg {
            Leg::Line => space.segment_is_free(from, to, radius),
            Leg::Arc(arc) => space.arc_is_free(arc, radius),
        }
    }

    /// Returns the distance (m) from a point to the link between two points.
    pub fn distance_to(&self, from: Point2<f64>, to: Point2<f64>, p: Point2<f64>) -> f64 {
        match &self.leg {
            Leg::Line => segment_distance(from, to, p),
            Leg::Arc(arc) => {
                let offset = p - arc.center;
                let (sin, cos) = math::sincos(arc.start + 0.5 * arc.sweep);
                let along = offset.x * cos + offset.y * sin;
                let norm = offset.norm();
                // Within half the sweep of the middle: the nearest point is inside the arc.
                if along >= norm * math::cos(0.5 * arc.sweep.abs()) {
                    (norm - arc.radius).abs()
                } else {
                    (p - from).norm().min((p - to).norm())
                }
            }
        }
    }
}

/// Returns the distance (m) from a point to a segment.
pub fn segment_distance(from: Point2<f64>, to: Point2<f64>, p: Point2<f64>) -> f64 {
    let (line, offset) = (to - from, p - from);
    let squared = line.norm_squared();
    let t = if squared > 0.0 {
        (offset.dot(&line) / squared).clamp(0.0, 1.0)
    } else {
        0.0
    };
    (offset - line * t).norm()
}

/// Motion primitive: the rule by which nodes are joined.
pub trait Motion {
    /// `true` if the path to a node depends on the heading at its start. A new parent of a node
    /// then changes the paths to all its descendants.
    const HAS_HEADING: bool;

    /// Returns the link from a pose to a point at this distance (m); `None` if the primitive has
    /// none.
    fn link(&self, from: &Pose2, to: Point2<f64>, distance: f64) -> Option<Link>;

    /// Returns the link from the robot's present pose.
    fn link_from_start(&self, from: &Pose2, to: Point2<f64>, distance: f64) -> Option<Link> {
        self.link(from, to, distance)
    }
}

/// Straight lines: a robot that can turn on the spot, or a point.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Straight;

impl Motion for Straight {
    const HAS_HEADING: bool = false;

    fn link(&self, _: &Pose2, _: Point2<f64>, distance: f64) -> Option<Link> {
        Some(Link::line(distance))
    }
}

/// Circular arcs: from every pose the one circle that leaves along the heading and passes through
/// the point (the chasing-game paper's first planner, §III-G).
///
/// With the point at distance ℓ under the bearing α, the curvature is 2 sin α / ℓ, the length ℓ α /
/// sin α, and the robot arrives turned by 2α.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Arcs {
    /// Smallest turning radius (m), > 0.
    pub min_radius: f64,
    /// Maximum bearing of the point from the heading (rad), in (0, π/2]: half of the largest turn
    /// within one arc.
    pub max_bearing: f64,
    /// `true` if the robot may turn on the spot before it sets off; its first leg is straight then.
    pub free_start: bool,
}

impl Motion for Arcs {
    const HAS_HEADING: bool = true;

    fn link(&self, from: &Pose2, to: Point2<f64>, distance: f64) -> Option<Link> {
        let offset = to - from.position();
        let forward = from.forward();
        let (ahead, beside) = (forward.dot(&offset), forward.perp(&offset));
        // Sharper than the smallest radius: 2 |sin α| / ℓ > 1 / r.
        if ahead <= 0.0 || 2.0 * beside.abs() * self.min_radius > distance * distance {
            return None;
        }
        let bearing = math::atan2(beside, ahead);
        if bearing.abs() > self.max_bearing {
            return None;
        }
        if bearing.abs() < STRAIGHT {
            return Some(Link {
                length: distance,
                heading: from.theta,
                leg: Leg::Line,
            });
        }
        let radius = distance * distance / (2.0 * beside);
        let left = Vector2::new(-forward.y, forward.x);
        let side = if radius > 0.0 { -0.5 } else { 0.5 };
        Some(Link {
            // sin α = beside / ℓ
            length: distance * distance * bearing / beside,
            heading: math::wrap_angle(from.theta + 2.0 * bearing),
            leg: Leg::Arc(Arc {
                center: from.position() + left * radius,
                radius: radius.abs(),
                start: math::wrap_angle(from.theta + side * core::f64::consts::PI),
                sweep: 2.0 * bearing,
            }),
        })
    }

    fn link_from_start(&self, from: &Pose2, to: Point2<f64>, distance: f64) -> Option<Link> {
        if !self.free_start {
            return self.link(from, to, distance);
        }
        let offset = to - from.position();
        Some(Link {
            length: distance,
            heading: math::atan2(offset.y, offset.x),
            leg: Leg::Line,
        })
    }
}

#[cfg(test)]
mod tests {
    use core::f64::consts::{FRAC_PI_2, PI};

    use proptest::prelude::*;

    use super::*;

    const ARCS: Arcs = Arcs {
        min_radius: 0.2,
        max_bearing: FRAC_PI_2,
        free_start: false,
    };

    fn along(arc: &Arc, share: f64) -> Point2<f64> {
        let (sin, cos) = math::sincos(arc.start + share * arc.sweep);
        arc.center + Vector2::new(cos, sin) * arc.radius
    }

    #[test]
    fn a_quarter_turn_to_the_left_and_to_the_right() {
        for side in [1.0, -1.0] {
            let from = Pose2::new(1.0, 2.0, 0.0);
            let to = Point2::new(2.0, 2.0 + side);
            let link = ARCS.link(&from, to, 2.0_f64.sqrt()).unwrap();
            assert!((link.length - FRAC_PI_2).abs() < 1e-12, "{link:?}");
            assert!((link.heading - side * FRAC_PI_2).abs() < 1e-12);
            let Leg::Arc(arc) = link.leg else {
                panic!("{link:?}")
            };
            assert!((arc.center - Point2::new(1.0, 2.0 + side)).norm() < 1e-12);
            assert!((arc.radius - 1.0).abs() < 1e-12);
            assert!((arc.sweep - side * FRAC_PI_2).abs() < 1e-12);
        }
    }

    #[test]
    fn points_behind_or_beyond_the_turning_radius_have_no_arc() {
        let from = Pose2::new(0.0, 0.0, 0.0);
        let link = |x, y| {
            let to = Point2::new(x, y);
            ARCS.link(&from, to, to.coords.norm())
        };
        assert!(link(-1.0, 0.1).is_none());
        assert!(link(0.1, 0.3).is_none());
        assert!(link(0.3, 0.3).is_some());
        let narrow = Arcs {
            max_bearing: 0.5,
            ..ARCS
        };
        assert!(
            narrow
                .link(&from, Point2::new(1.0, 0.9), 1.81_f64.sqrt())
                .is_none()
        );
    }

    #[test]
    fn a_robot_that_may_turn_first_leaves_in_any_direction() {
        let free = Arcs {
            free_start: true,
            ..ARCS
        };
        let link = free
            .link_from_start(&Pose2::new(0.0, 0.0, 0.0), Point2::new(-1.0, 0.0), 1.0)
            .unwrap();
        assert_eq!((link.leg, link.heading), (Leg::Line, PI));
    }

    proptest! {
        #[test]
        fn arcs_leave_along_the_heading_and_end_at_the_point(
            theta in -7.0..7.0,
            distance in 0.05..4.0,
            bearing in -1.5..1.5,
        ) {
            let from = Pose2::new(0.3, -0.8, theta);
            let (sin, cos) = math::sincos(theta + bearing);
            let to = from.position() + Vector2::new(cos, sin) * distance;
            let Some(link) = ARCS.link(&from, to, distance) else {
                prop_assert!(2.0 * math::sin(bearing).abs() / distance > 1.0 / ARCS.min_radius);
                return Ok(());
            };
            prop_assert!(link.length >= distance * (1.0 - 1e-12));
            if let Leg::Arc(arc) = link.leg {
                prop_assert!(arc.radius >= ARCS.min_radius * (1.0 - 1e-9));
                prop_assert!((along(&arc, 0.0) - from.position()).norm() < 1e-7 * arc.radius.max(1.0));
                prop_assert!((along(&arc, 1.0) - to).norm() < 1e-7 * arc.radius.max(1.0));
                prop_assert!((arc.radius * arc.sweep.abs() - link.length).abs() < 1e-9 * link.length);
                // A short path along the arc lies in the direction of the heading.
                let step = along(&arc, 1e-3) - from.position();
                prop_assert!(step.normalize().dot(&from.forward()) > 1.0 - 1e-5);
                // No nearer than the nearest of many points of it.
                let p = Point2::new(0.9, 0.1);
                let least = (0..=2000)
                    .map(|i| (along(&arc, f64::from(i) / 2000.0) - p).norm())
                    .fold(f64::INFINITY, f64::min);
                let exact = link.distance_to(from.position(), to, p);
                prop_assert!(exact <= least + 1e-6 && exact >= least - link.length / 2000.0);
            }
        }
    }
}
