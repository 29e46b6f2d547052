//! Steering of differential-drive robots.

use control::go_to::GoToParams;
use geometry::pose::{Pose2, Twist2};
use planner_view::limits::Limits;
use pyo3::prelude::*;

use crate::arguments::{self, Target, invalid, positive, scalar};

/// Returns the command that leads from a pose to a target in ticks of `dt` (s).
pub fn drive(
    pose: &Pose2,
    target: &Target,
    limits: &Limits,
    params: &GoToParams,
    dt: f64,
) -> Twist2 {
    match target {
        Target::Point(point) => control::go_to::go_to(pose, *point, None, limits, params, dt),
        Target::Path(path) => {
            let here = pose.position();
            let Some((progress, _)) = path.project(here, 0.0, path.length()) else {
                return Twist2::STOP;
            };
            // The first corner ahead that the robot has not reached; near the end, the end.
            let corners = path.points().iter().zip(path.along());
            let mut ahead = corners
                .filter(|(_, along)| **along > progress)
                .map(|(corner, _)| *corner)
                .skip_while(|corner| (corner - here).norm() <= params.arrived);
            let next = ahead.next().or_else(|| path.points().last().copied());
            next.map_or(Twist2::STOP, |corner| {
                control::go_to::go_to(pose, corner, ahead.next(), limits, params, dt)
            })
        }
    }
}

/// Command that drives a robot to a point or along a path: it turns towards the next point, then drives the arc that
/// leads to it.
///
/// Pure pursuit (Coulter, *Implementation of the Pure Pursuit Path Tracking Algorithm*, CMU-RI-TR-92-01, 1992).
///
/// Parameters
/// ----------
/// pose
///     Position (m) and heading (rad), shape (3,), or a robot.
/// target
///     A point (m), shape (2,); a path (m), shape (n, 2), of which the next corner ahead counts; or a robot.
/// v_max
///     Maximum forward speed (m/s).
/// omega_max
///     Maximum turning rate (rad/s).
/// dt
///     Length of a tick (s).
/// v_reverse_max
///     Maximum backward speed (m/s), as a magnitude.
/// params
///     Other values than the defaults of ``turn_on_spot`` (rad), ``turn_gain`` (1/s), ``speed_fraction``,
///     ``arrived`` (m), ``deceleration`` (m/s²) and ``pass_angle`` (rad).
///
/// Returns
/// -------
/// tuple of float
///     Forward speed (m/s) and turning rate (rad/s), within the limits; a stop at the target and for an empty path.
///
/// Raises
/// ------
/// InvalidInput
///     An argument is out of range.
///
/// Examples
/// --------
/// >>> import protean_robotics as pr
/// >>> pr.steering.go_to((0, 0, 0), (2, 0), v_max=0.5, omega_max=2, dt=0.05)
/// (0.5, 0.0)
/// >>> pr.steering.go_to((0, 0, 0), (0, 2), v_max=0.5, omega_max=2, dt=0.05)
/// (0.0, 2.0)
#[pyfunction]
#[pyo3(signature = (pose, target, *, v_max, omega_max, dt, v_reverse_max=0.0, params=None))]
pub fn go_to(
    pose: &Bound<'_, PyAny>,
    target: &Bound<'_, PyAny>,
    #[pyo3(from_py_with = scalar)] v_max: f64,
    #[pyo3(from_py_with = scalar)] omega_max: f64,
    #[pyo3(from_py_with = scalar)] dt: f64,
    #[pyo3(from_py_with = scalar)] v_reverse_max: f64,
    params: Option<&Bound<'_, PyAny>>,
) -> PyResult<(f64, f64)> {
    let limits = Limits::new(v_max, v_reverse_max, omega_max).map_err(invalid)?;
    positive("dt", dt)?;
    let pose = arguments::pose("pose", pose)?;
    let target = arguments::target("target", target)?;
    let command = drive(&pose, &target, &limits, &arguments::params(params)?, dt);
    Ok((command.v, command.omega))
}
