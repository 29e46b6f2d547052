//! Travel times without obstacles.

use geometry::pose::Pose2;
use nalgebra::Point2;
use parameters::{ParamsError, check, positive, require};

use control::go_to::{GoToParams, bearing, coast, distance_to_segment, go_to};
use planner_view::limits::Limits;

/// Maximum length of a simulated lap (ticks).
const MAX_TICKS: f64 = 1e7;

/// The time a robot needs to a point without obstacles (s): it turns to it on the spot at its
/// maximum rate, then drives straight at its maximum allowed speed.
///
/// The real time is slightly shorter, because the robot begins to drive before the turn is
/// complete.
pub fn time_without_obstacles(
    pose: &Pose2,
    point: Point2<f64>,
    limits: &Limits,
    params: &GoToParams,
) -> f64 {
    let distance = (point - pose.position()).norm();
    bearing(pose, point).abs() / limits.omega_max()
        + distance / (limits.v_max() * params.speed_fraction)
}

/// The time to drive through `points` (m) in this order (s), without obstacles. [`go_to`] drives an
/// ideal unicycle with these limits through them in ticks of `dt` (s); a point is reached when the
/// path passes within `params.arrived` of it. To close a lap, end it with its first point.
///
/// Drives with limits of acceleration or of the wheels need longer; use lower limits for such a
/// robot.
///
/// # Errors
/// [`ParamsError`] for parameters out of range, a start or point that is not finite (`start`,
/// `points`), and for a path of more than ten million ticks (`dt`).
pub fn lap_time(
    start: &Pose2,
    points: &[Point2<f64>],
    limits: &Limits,
    params: &GoToParams,
    dt: f64,
) -> Result<f64, ParamsError> {
    check(params)?;
    positive("dt", dt)?;
    require(start.is_finite(), "start", &"not finite", "finite numbers")?;
    let mut pose = *start;
    let mut ticks = 0.0;
    let mut along = 0.0;
    for (i, &point) in points.iter().enumerate() {
        let finite = point.x.is_finite() && point.y.is_finite();
        require(finite, "points", &point, "finite numbers")?;
        let next = points.get(i + 1).copied();
        if (point - pose.position()).norm() <= params.arrived {
            continue;
        }
        // A generous limit: a robot that arrives at all arrives in this time.
        let most = ticks + 10.0 + 4.0 * time_without_obstacles(&pose, point, limits, params) / dt;
        loop {
            ticks += 1.0;
            if ticks > MAX_TICKS || ticks > most.max(100.0 + along) {
                return Err(ParamsError::new(
                    "dt",
                    &dt,
                    "a tick in which a robot with these limits can steer to every point, \
                     and long enough for the path to end within ten million of them",
                ));
            }
            let command = go_to(&pose, point, next, limits, params, dt);
            let after = coast(&pose, command, dt);
            let off = distance_to_segment(point, pose.position(), after.position());
            pose = after;
            if off <= params.arrived {
                break;
            }
        }
        along = ticks;
    }
    Ok(ticks * dt)
}
