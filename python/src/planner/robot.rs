//! A robot as a planner in Python sees it.

use control::go_to::GoToParams;
use geometry::pose::{Pose2, Twist2};
use geometry::region::Region;
use nalgebra::Point2;
use numpy::{PyArray1, ToPyArray as _};
use planner::{Limits, RobotInfo};
use planner_view::view::RobotView;
use pyo3::prelude::*;

use python_algorithms::arguments;
use python_algorithms::error::InvalidInput;
use python_algorithms::steering::drive;

/// A robot in a tick.
///
/// The object is the same in all ticks; its values are those of the current one.
#[pyclass(module = "protean_robotics")]
#[derive(Debug)]
pub struct Robot {
    /// Name in the scenario.
    #[pyo3(get)]
    name: String,
    /// Index in the scenario.
    #[pyo3(get)]
    index: usize,
    /// Name of its team.
    #[pyo3(get)]
    team: String,
    /// Role of its team: "neutral", "pursuer" or "evader".
    #[pyo3(get)]
    role: &'static str,
    /// Radius of its body (m).
    #[pyo3(get)]
    radius: f64,
    /// Maximum forward speed (m/s).
    #[pyo3(get)]
    v_max: f64,
    /// Maximum backward speed (m/s), ≥ 0.
    #[pyo3(get)]
    v_reverse_max: f64,
    /// Maximum turning rate (rad/s).
    #[pyo3(get)]
    omega_max: f64,
    /// `True` if it still takes part (not caught, not escaped).
    #[pyo3(get)]
    active: bool,
    /// `True` if its body is in the world.
    #[pyo3(get)]
    present: bool,
    goal: Option<Point2<f64>>,
    pose: Pose2,
    twist: Twist2,
    dt: f64,
}

#[pymethods]
impl Robot {
    /// Position along x (m).
    #[getter]
    fn x(&self) -> f64 {
        self.pose.x
    }

    /// Position along y (m).
    #[getter]
    fn y(&self) -> f64 {
        self.pose.y
    }

    /// Heading (rad), counter-clockwise from the x axis.
    #[getter]
    fn theta(&self) -> f64 {
        self.pose.theta
    }

    /// Forward speed (m/s).
    #[getter]
    fn v(&self) -> f64 {
        self.twist.v
    }

    /// Turning rate (rad/s).
    #[getter]
    fn omega(&self) -> f64 {
        self.twist.omega
    }

    /// Position (m), shape (2,).
    #[getter]
    fn position<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        [self.pose.x, self.pose.y].to_pyarray(py)
    }

    /// Pose: x (m), y (m), heading (rad), shape (3,).
    #[getter]
    fn pose<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        [self.pose.x, self.pose.y, self.pose.theta].to_pyarray(py)
    }

    /// Centre of its goal (m), shape (2,); None without a goal.
    #[getter]
    fn goal<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray1<f64>>> {
        self.goal.map(|goal| [goal.x, goal.y].to_pyarray(py))
    }

    fn __repr__(&self) -> String {
        let Pose2 { x, y, theta } = self.pose;
        format!("<Robot {} at ({x:.2}, {y:.2}, {theta:.2})>", self.name)
    }
}

impl Robot {
    /// Returns a robot of a run at its start; `dt` is the length of a tick (s).
    pub(super) fn new(index: usize, info: &RobotInfo, dt: f64) -> Self {
        Self {
            name: info.name.clone(),
            index,
            team: info.team.clone(),
            role: info.role.name(),
            radius: info.model.radius,
            v_max: info.model.v_max,
            v_reverse_max: info.model.v_reverse_max,
            omega_max: info.model.omega_max,
            active: true,
            present: true,
            goal: info.goal.as_ref().map(Region::center),
            pose: info.start,
            twist: Twist2::STOP,
            dt,
        }
    }

    /// Takes the values of a tick.
    pub(super) fn update(&mut self, view: &RobotView) {
        self.active = view.active;
        self.present = view.present;
        self.pose = view.pose;
        self.twist = view.twist;
    }

    /// Returns `true` if it still takes part.
    pub(super) fn is_active(&self) -> bool {
        self.active
    }

    /// Returns the name.
    pub(super) fn name(&self) -> &str {
        &self.name
    }

    /// Returns the name of its team.
    pub(super) fn team(&self) -> &str {
        &self.team
    }
}

/// Command that drives a robot to a point: it turns towards the point, then drives the arc that leads to it (pure
/// pursuit, Coulter 1992).
///
/// Parameters
/// ----------
/// robot
///     The robot.
/// target
///     A point (m), shape (2,); a way (m), shape (n, 2), of which the next corner ahead counts; or a robot. An empty
///     way is a stop.
///
/// Returns
/// -------
/// tuple of float
///     Forward speed (m/s) and turning rate (rad/s), within the limits of the robot.
#[pyfunction]
pub fn go_to(robot: PyRef<'_, Robot>, target: &Bound<'_, PyAny>) -> PyResult<(f64, f64)> {
    let limits = Limits::new(robot.v_max, robot.v_reverse_max, robot.omega_max)
        .map_err(|error| InvalidInput::new_err(format!("robot {}: {error}", robot.name)))?;
    let target = arguments::target("target", target)?;
    let params = GoToParams::default();
    let command = drive(&robot.pose, &target, &limits, &params, robot.dt);
    Ok((command.v, command.omega))
}
