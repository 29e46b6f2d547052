//! Followers of a route.

use avoidance::potential_field::{Goal, Repulsor, attraction, compose, obstacle, repulsion};
use control::feedback_linearisation::{EPSILON, command};
use control::path_tracking::{PathTracker, Tracking, TrackingParams};
use geometry::math;
use geometry::pose::{Pose2, Twist2};
use nalgebra::{Point2, Vector2};
use navigation::bearing::Bearings;
use planner_view::free_space::FreeSpace;
use planner_view::limits::Limits;
use planner_view::map::PlannerMap;
use planner_view::view::{RobotView, View};
use pursuit_evasion::potential_evader::EvaderParams;
use robot::team::Role;

use crate::motion::{Arcs, Motion as _};

/// Pure pursuit that does not cut corners where the short cut is not free for a robot of this
/// radius (m).
pub fn pursue(
    tracker: &mut PathTracker,
    pose: &Pose2,
    limits: &Limits,
    params: &TrackingParams,
    space: &FreeSpace,
    radius: f64,
) -> Option<Tracking> {
    // A robot that is nearer to a wall than the margin may continue at that distance.
    let radius = radius.min(space.distance(pose.position())).max(0.0);
    let arcs = Arcs {
        min_radius: 1e-6,
        max_bearing: core::f64::consts::FRAC_PI_2,
        free_start: false,
    };
    tracker.track(pose, limits, params, |pose, to| {
        let from = pose.position();
        let distance = (to - from).norm();
        let offset = to - from;
        let forward = pose.forward();
        let bearing = math::atan2(forward.perp(&offset), forward.dot(&offset));
        if bearing.abs() > params.turn_on_spot {
            // It will turn first, and then drive almost straight.
            return space.segment_is_free(from, to, radius);
        }
        distance == 0.0
            || arcs
                .link(pose, to, distance)
                .is_some_and(|link| link.is_free(space, from, to, radius))
    })
}

/// The paper's follower: the field at the control point towards one point of the path, with
/// obstacles and other evaders, but without the Police.
pub fn by_field(
    map: &PlannerMap,
    view: &View<'_>,
    own: &RobotView,
    to: Point2<f64>,
    limits: &Limits,
    field: &EvaderParams,
) -> (Twist2, Vector2<f64>) {
    // Here the paper has its control point at ε, unlike in its other robots.
    let at = own.pose.position() + own.pose.forward() * EPSILON;
    let goal = Some(Goal {
        at: to,
        weight: 1.0,
    });
    let pull = attraction(at, goal, &Bearings::Straight);
    let non_opponents = view
        .non_opponents(Role::Pursuer)
        .filter(|robot| robot.index != own.index)
        .map(|robot| Repulsor {
            at: robot.pose.position(),
            weight: field.teammate_weight,
        });
    let push = repulsion(at, non_opponents, &Bearings::Straight, &field.avoid);
    let sum = pull + push + obstacle(map, at, field.obstacle.fidelity);
    let wanted = compose(map, own, at, sum, [], 0.0, &field.obstacle);
    (
        command(wanted, own.pose.theta, limits, &field.feedback),
        wanted,
    )
}
