//! Avoidance of bodies on the path.
//!
//! Repulsion alone is not sufficient: a body in a narrow street and a goal straight behind it make
//! a local minimum in front of the body.

use nalgebra::{Point2, Vector2};

use planner_view::map::PlannerMap;
use planner_view::view::RobotView;

/// A robot's body as an obstacle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Body {
    /// Centre (m).
    pub at: Point2<f64>,
    /// Radius (m), ≥ 0.
    pub radius: f64,
}

impl From<&RobotView> for Body {
    fn from(robot: &RobotView) -> Self {
        Self {
            at: robot.pose.position(),
            radius: robot.radius,
        }
    }
}

/// Difference of clearance (m) above which the left is the better side.
const CLEARLY_MORE: f64 = 0.05;

/// Turns the part of the field that would drive a robot into a body, so that the robot passes the
/// body.
///
/// * `here`, `radius` — the robot's centre and radius (m).
/// * `guard` — gap between the two bodies (m) at which the turning begins; at a third of it the
///   whole inward part is turned, linear in between. 0 to disable.
///
/// The robot passes on the right, unless the map has clearly more room to the left of the body: two
/// robots that meet head-on then pass each other. (A choice by the direction of the field makes a
/// robot oscillate in front of a body in the middle of a street.) Bodies with invalid numbers, and
/// bodies at the robot's own centre, do not count.
pub fn slide_around_bodies(
    map: &PlannerMap,
    here: Point2<f64>,
    radius: f64,
    field: Vector2<f64>,
    bodies: impl IntoIterator<Item = Body>,
    guard: f64,
) -> Vector2<f64> {
    // Also rejects NaN.
    if !(guard > 0.0 && radius.is_finite()) {
        return field;
    }
    let mut field = field;
    for body in bodies {
        let line = here - body.at;
        let distance = line.norm();
        let gap = distance - radius - body.radius;
        // Numbers that are not finite fail one of these.
        if !(distance > 1e-6 && gap < guard && gap.is_finite()) {
            continue;
        }
        let away = line / distance;
        let inward = -field.dot(&away);
        if inward <= 0.0 {
            continue;
        }
        let left = Vector2::new(away.y, -away.x);
        let reach = radius + body.radius;
        let room = map.clearance(body.at + left * reach) - map.clearance(body.at - left * reach);
        let turned = if room > CLEARLY_MORE { left } else { -left };
        let share = (1.5 * (1.0 - gap / guard)).clamp(0.0, 1.0);
        field += (away + turned) * (inward * share);
    }
    field
}
