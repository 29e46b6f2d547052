//! Getting past bodies that stand in the way.
//!
//! Repulsion alone does not do: a body in a narrow street and a goal straight behind it make a
//! local minimum in front of the body.

use nalgebra::{Point2, Vector2};

use planner_view::map::PlannerMap;
use planner_view::view::RobotView;

/// A robot's body, to be driven round.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Body {
    /// Its centre (m).
    pub at: Point2<f64>,
    /// Its radius (m), ≥ 0.
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

/// Difference of clearance (m) that makes the left the better side.
const CLEARLY_MORE: f64 = 0.05;

/// The field with the part that would drive a robot into a body turned to go round it.
///
/// * `here`, `radius` — the robot's centre and radius (m).
/// * `guard` — gap between the two bodies (m) at which the turning begins; at a third of it all of
///   the inward part is turned, linear in between. 0 for never.
///
/// The robot passes on the right, unless the map has clearly more room to the left of the body: two
/// robots that meet head-on then get past each other. (Choosing by the side to which the field
/// already leans makes a robot waver in front of a body in the middle of a street.) Bodies whose
/// numbers cannot be used, and bodies at the robot's own centre, do not count.
pub fn slide_around_bodies(
    map: &PlannerMap,
    here: Point2<f64>,
    radius: f64,
    field: Vector2<f64>,
    bodies: impl IntoIterator<Item = Body>,
    guard: f64,
) -> Vector2<f64> {
    // Also refuses NaN.
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
