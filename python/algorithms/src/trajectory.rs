//! Minimum-time trajectories among obstacles.

#![expect(
    clippy::too_many_arguments,
    reason = "arguments by name of Python's functions, and the fields that a pickled object gives back"
)]

use std::sync::atomic::AtomicBool;

use ::plan::field::{counter_clockwise, read_instance};
use ::plan::loose::Loose;
use ::trajectory::{Method, Options, PlanError, Problem, RobotLimits, Sample, Wheels};
use ::trajectory_problem::problem::{MIN_CLEARANCE, START_TOLERANCE};
use geometry::shape::{Aabb, Convex};
use nalgebra::Point2;
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use pyo3::types::PyList;

use crate::arguments::{self, invalid, refused, scalar};
use crate::error::{Error, InvalidInput};
use crate::interruptible::compute;

/// Trajectory of a robot, which has passed the check of limits and clearances.
#[pyclass(
    frozen,
    get_all,
    new = "from_fields",
    module = "protean_robotics.trajectory"
)]
#[derive(Debug)]
pub struct Trajectory {
    /// Times since the start (s), shape (n,).
    time: Py<PyArray1<f64>>,
    /// Poses: x (m), y (m), heading (rad), shape (n, 3).
    pose: Py<PyArray2<f64>>,
    /// Forward speeds (m/s), shape (n,).
    v: Py<PyArray1<f64>>,
    /// Turning rates (rad/s), shape (n,).
    omega: Py<PyArray1<f64>>,
    /// Duration (s).
    duration: f64,
    /// Lower bound of the duration of any trajectory (s).
    lower_bound: f64,
    /// Length of the path (m).
    length: f64,
    /// Origin: "planned", "curve" (no search in the controls succeeded near it), "fallback" (the exact shortest path) or "deadline".
    status: String,
    /// Obstacles of `plan`: x (m), y (m) and radius (m) of a disc, shape (3,); corners (m) of a polygon, shape (k, 2).
    obstacles: Py<PyList>,
}

#[pymethods]
impl Trajectory {
    /// Draw the path, coloured by the speed, into axes of matplotlib.
    ///
    /// Parameters
    /// ----------
    /// ax
    ///     Axes; new ones if absent.
    ///
    /// Returns
    /// -------
    /// matplotlib.axes.Axes
    ///     The axes.
    ///
    /// Raises
    /// ------
    /// ImportError
    ///     matplotlib is not installed.
    #[pyo3(signature = (*, ax=None))]
    fn plot<'py>(
        slf: &Bound<'py, Self>,
        ax: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        crate::plots(slf.py())?.call_method1("trajectory_axes", (slf, ax))
    }

    fn _repr_html_<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        crate::plots(slf.py())?.call_method1("trajectory_html", (slf,))
    }

    fn __repr__(&self) -> String {
        format!(
            "<Trajectory of {:.3} s and {:.3} m>",
            self.duration, self.length
        )
    }
}

impl Trajectory {
    fn new(
        py: Python<'_>,
        samples: &[Sample],
        [duration, lower_bound, length]: [f64; 3],
        status: String,
        obstacles: &[Convex],
    ) -> PyResult<Self> {
        let column = |value: fn(&Sample) -> f64| {
            PyArray1::from_vec(py, samples.iter().map(value).collect()).unbind()
        };
        let outlines = PyList::empty(py);
        for obstacle in obstacles {
            match obstacle {
                Convex::Disc { center, radius } => {
                    let disc = vec![center.x, center.y, *radius];
                    outlines.append(PyArray1::from_vec(py, disc))?;
                }
                other => outlines.append(arguments::array_of_points(py, &other.corners())?)?,
            }
        }
        let poses = samples.iter().map(|s| [s.x, s.y, s.theta]);
        Ok(Self {
            time: column(|s| s.t),
            pose: arguments::array_of_rows(py, poses)?.unbind(),
            v: column(|s| s.v),
            omega: column(|s| s.omega),
            duration,
            lower_bound,
            length,
            status,
            obstacles: outlines.unbind(),
        })
    }
}

/// Minimum-time trajectory of a differential-drive robot among obstacles.
///
/// Parameters
/// ----------
/// start
///     Position (m) and heading (rad), shape (3,), or a robot.
/// goal
///     Position (m), shape (2,), or pose with a heading (rad), shape (3,).
/// discs
///     Obstacles: x (m), y (m), radius (m), shape (n, 3).
/// polygons
///     Convex obstacles: corners (m) in order, shape (k, 2) each.
/// bounds
///     Lower left and upper right corner of the robot's centre (m), shape (2, 2).
/// v_max
///     Maximum forward speed (m/s).
/// omega_max
///     Maximum turning rate (rad/s).
/// v_min
///     Minimum forward speed (m/s), from −v_max to 0: 0 for driving forwards only; −v_max if absent.
/// clearance
///     Minimum distance of the robot's centre from obstacles (m): its radius and a margin.
/// start_speed, goal_speed
///     Forward speed at the start and at the goal (m/s); free if absent.
/// start_turn_rate
///     Turning rate at the start (rad/s); free if absent.
/// acceleration
///     Maximum change of the speed (m/s²); unlimited if absent.
/// angular_acceleration
///     Maximum change of the turning rate (rad/s²); unlimited if absent.
/// wheels
///     Maximum speed of a wheel (m/s) and distance between the wheels (m), shape (2,); unlimited if absent.
/// method
///     "bspline", "lp", "vmc" or "tangent".
///
/// Returns
/// -------
/// Trajectory
///     Times, poses, speeds and turning rates.
///
/// Raises
/// ------
/// InvalidInput
///     An argument is out of range, or start or goal is in an obstacle.
/// Error
///     No path leads to the goal, or none keeps the prescribed speeds.
///
/// Examples
/// --------
/// >>> import protean_robotics as pr
/// >>> plan = pr.trajectory.plan((0, 0, 0), (3, 0), bounds=[(-5, -5), (5, 5)], v_max=0.5, omega_max=2)
/// >>> round(plan.duration, 6)
/// 6.0
/// >>> around = pr.trajectory.plan((0, 0, 0), (3, 0), discs=[(1.5, 0, 0.3)], clearance=0.1, bounds=[(-5, -5), (5, 5)],
/// ...                             v_max=0.5, omega_max=2)
/// >>> bool(6.0 < around.duration < 7.5)
/// True
#[pyfunction]
#[pyo3(signature = (start, goal, *, discs=None, polygons=None, bounds, v_max, omega_max, v_min=None, clearance=0.0, start_speed=None, start_turn_rate=None, goal_speed=None, acceleration=None, angular_acceleration=None, wheels=None, method="bspline"))]
pub fn plan(
    py: Python<'_>,
    start: &Bound<'_, PyAny>,
    goal: &Bound<'_, PyAny>,
    discs: Option<&Bound<'_, PyAny>>,
    polygons: Option<Vec<Bound<'_, PyAny>>>,
    bounds: &Bound<'_, PyAny>,
    #[pyo3(from_py_with = scalar)] v_max: f64,
    #[pyo3(from_py_with = scalar)] omega_max: f64,
    #[pyo3(from_py_with = scalar)] v_min: Option<f64>,
    #[pyo3(from_py_with = scalar)] clearance: f64,
    #[pyo3(from_py_with = scalar)] start_speed: Option<f64>,
    #[pyo3(from_py_with = scalar)] start_turn_rate: Option<f64>,
    #[pyo3(from_py_with = scalar)] goal_speed: Option<f64>,
    #[pyo3(from_py_with = scalar)] acceleration: Option<f64>,
    #[pyo3(from_py_with = scalar)] angular_acceleration: Option<f64>,
    wheels: Option<&Bound<'_, PyAny>>,
    method: &str,
) -> PyResult<Trajectory> {
    let goal_pose = arguments::pose("goal", goal).ok();
    let goal = match goal_pose {
        Some(pose) => pose.position(),
        None => arguments::point("goal", goal)?,
    };
    let wheels = wheels.map(|wheels| {
        let [speed, separation] = arguments::row("wheels", wheels, "two finite numbers (m/s, m)")?;
        PyResult::Ok(Wheels { speed, separation })
    });
    arguments::not_negative("clearance", clearance)?;
    let problem = Problem {
        start: arguments::pose("start", start)?,
        start_speed,
        start_turn_rate,
        goal,
        goal_heading: goal_pose.map(|pose| pose.theta),
        goal_speed,
        limits: RobotLimits {
            v_min: v_min.unwrap_or(-v_max),
            wheels: wheels.transpose()?,
            acceleration,
            angular_acceleration,
            ..RobotLimits::simple(v_max, omega_max)
        },
        obstacles: obstacles(discs, &polygons.unwrap_or_default())?,
        clearance: clearance.max(MIN_CLEARANCE),
        bounds: rectangle(bounds)?,
        start_tolerance: START_TOLERANCE,
    };
    let options = Options {
        method: Method::by_name(method).ok_or_else(|| {
            let names = Method::ALL.map(Method::name).join(", ");
            refused("method", method, &format!("one of {names}"))
        })?,
        ..Options::default()
    };
    let drawn = problem.obstacles.clone();
    let planned = compute(py, move || {
        ::trajectory::plan(&problem, &options, None, &mut || false)
    })?;
    let plan = planned.map_err(|error| match error {
        PlanError::Invalid(error) => invalid(&error),
        error => Error::new_err(error.to_string()),
    })?;
    let status = serde_json::to_value(plan.status).ok();
    let status = status.and_then(|status| Some(status.as_str()?.to_owned()));
    let figures = [plan.final_time, plan.lower_bound, plan.length];
    let status = status.unwrap_or_default();
    Trajectory::new(py, &plan.samples, figures, status, &drawn)
}

/// Minimum-time trajectory of a problem with the fields of a file of `protean plan`.
///
/// Parameters
/// ----------
/// instance
///     The fields, as in the file: ``cm_per_px``, ``vmax_px_s``, ``wmax_rad_s``, ``buffer_px``, ``bounds_px``, ``start``,
///     ``goal``, ``obstacles`` …; lengths in pixels.
/// options
///     Other values than the defaults of ``method`` and the further options of the command.
///
/// Returns
/// -------
/// Trajectory
///     As that of `plan`, with lengths in pixels.
///
/// Raises
/// ------
/// InvalidInput
///     A field is missing or out of range.
/// Error
///     There is no trajectory.
///
/// Examples
/// --------
/// >>> import protean_robotics as pr
/// >>> instance = {
/// ...     "cm_per_px": 1.0, "vmax_px_s": 50, "wmax_rad_s": 2, "buffer_px": 0, "bounds_px": [-500, -500, 500, 500],
/// ...     "start": {"x": 0, "y": 0, "theta": 0}, "goal": {"x": 300, "y": 0}, "obstacles": [],
/// ... }
/// >>> round(pr.trajectory.plan_instance(instance).duration, 6)
/// 6.0
#[pyfunction]
#[pyo3(signature = (instance, *, options=None))]
pub fn plan_instance(
    py: Python<'_>,
    instance: &Bound<'_, PyAny>,
    options: Option<&Bound<'_, PyAny>>,
) -> PyResult<Trajectory> {
    let options: Options = arguments::params(options)?;
    let text = arguments::json("instance", instance)?;
    let fields: Loose = serde_json::from_str(&text)
        .map_err(|error| InvalidInput::new_err(format!("instance: {error}")))?;
    let instance = read_instance("instance", &fields).map_err(invalid)?;
    let answer = compute(py, move || {
        ::plan::solve(&instance, &options, 1, &AtomicBool::new(false))
    })?;
    let answer = answer.ok_or_else(|| Error::new_err("interrupted"))?;
    let Some(samples) = answer.samples.filter(|_| answer.error.is_none()) else {
        let reason = answer.error.unwrap_or_else(|| "no trajectory".to_owned());
        return Err(Error::new_err(reason));
    };
    let status = serde_json::to_value(answer.status).ok();
    let status = status.and_then(|status| Some(status.as_str()?.to_owned()));
    let figures = [answer.t_s, answer.lower_bound_s, answer.length].map(|x| x.unwrap_or(f64::NAN));
    Trajectory::new(py, &samples, figures, status.unwrap_or_default(), &[])
}

fn obstacles(
    discs: Option<&Bound<'_, PyAny>>,
    polygons: &[Bound<'_, PyAny>],
) -> PyResult<Vec<Convex>> {
    let mut obstacles = Vec::new();
    if let Some(discs) = discs {
        let expected = "finite numbers of shape (n, 3): x (m), y (m), radius (m)";
        for [x, y, radius] in arguments::rows::<3>("discs", discs, expected)? {
            if radius < 0.0 {
                return Err(refused("discs", &radius, "a radius of at least 0 (m)"));
            }
            obstacles.push(Convex::disc(Point2::new(x, y), radius));
        }
    }
    for polygon in polygons {
        let expected = "the corners of a convex polygon (m), shape (n, 2)";
        let corners = arguments::rows::<2>("polygons", polygon, expected)?;
        let found = format!("{} corners", corners.len());
        let corners =
            counter_clockwise(corners).ok_or_else(|| refused("polygons", &found, expected))?;
        let corners: Vec<_> = corners.into_iter().map(Point2::from).collect();
        obstacles.push(Convex::polygon(&corners));
    }
    Ok(obstacles)
}

fn rectangle(bounds: &Bound<'_, PyAny>) -> PyResult<Aabb> {
    let expected = "the lower left and the upper right corner (m), shape (2, 2)";
    let corners = arguments::rows::<2>("bounds", bounds, expected)?;
    let [min, max] = corners[..] else {
        return Err(refused("bounds", &format!("{corners:?}"), expected));
    };
    Ok(Aabb {
        min: Point2::from(min),
        max: Point2::from(max),
    })
}
