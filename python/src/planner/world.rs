//! The world as a planner in Python sees it: robots, exits, time.

use nalgebra::Point2;
use numpy::{PyArray1, PyArray2, PyArrayMethods as _};
use planner_view::view::View;
use pyo3::prelude::*;
use pyo3::types::{PyList, PyTuple};
use runtime::config::ProcessConfig;

use super::robot::Robot;

/// All robots, the exits and the time of a tick.
///
/// The object and its arrays are the same in all ticks; their values are those of the current one.
#[pyclass(module = "protean_robotics")]
#[derive(Debug)]
pub struct World {
    /// Simulated time since the start of the run (s).
    #[pyo3(get)]
    time: f64,
    /// Length of a tick (s).
    #[pyo3(get)]
    dt: f64,
    /// Distance at which a pursuer catches an evader (m); 0 without capture.
    #[pyo3(get)]
    capture_radius: f64,
    /// Centres of the exits (m), shape (exits, 2).
    #[pyo3(get)]
    exits: Py<PyArray2<f64>>,
    /// All robots, in the order of the scenario.
    #[pyo3(get)]
    robots: Py<PyTuple>,
    /// Poses of all robots: x (m), y (m), heading (rad), shape (robots, 3).
    #[pyo3(get)]
    poses: Py<PyArray2<f64>>,
    /// Twists of all robots: forward speed (m/s), turning rate (rad/s), shape (robots, 2).
    #[pyo3(get)]
    twists: Py<PyArray2<f64>>,
    /// `True` for robots that still take part, shape (robots,).
    #[pyo3(get)]
    active: Py<PyArray1<bool>>,
    rows: Vec<Py<Robot>>,
    own: usize,
    opponents: Vec<usize>,
}

#[pymethods]
impl World {
    /// Robots of hostile teams that still take part.
    #[getter]
    fn opponents<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyList>> {
        let rows = self.opponents.iter().filter_map(|&row| self.rows.get(row));
        PyList::new(py, rows.filter(|robot| robot.borrow(py).is_active()))
    }

    /// Other robots of the own team that still take part.
    #[getter]
    fn teammates<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyList>> {
        let Some(own) = self.rows.get(self.own) else {
            return Ok(PyList::empty(py));
        };
        let own_team = own.borrow(py).team().to_owned();
        let mates = self.rows.iter().enumerate().filter(|(row, robot)| {
            let robot = robot.borrow(py);
            *row != self.own && robot.is_active() && robot.team() == own_team
        });
        let mates: Vec<_> = mates.map(|(_, robot)| robot).collect();
        PyList::new(py, mates)
    }

    fn __repr__(&self) -> String {
        let robots = self.rows.len();
        format!("<World of {robots} robots at {:.2} s>", self.time)
    }
}

impl World {
    /// Returns the world of a run before its first tick, for the robot with this index.
    pub(super) fn new(
        py: Python<'_>,
        config: &ProcessConfig,
        own: usize,
        exits: &[Point2<f64>],
    ) -> PyResult<Self> {
        let run = &config.run;
        let dt = config.step_period();
        let robots = run.robots.iter().enumerate();
        let rows = robots
            .map(|(index, info)| Py::new(py, Robot::new(index, info, dt)))
            .collect::<PyResult<Vec<_>>>()?;
        let exits: Vec<Vec<f64>> = exits.iter().map(|exit| vec![exit.x, exit.y]).collect();
        let exits = if exits.is_empty() {
            PyArray2::zeros(py, [0, 2], false)
        } else {
            PyArray2::from_vec2(py, &exits)?
        };
        let opponents = run.robots.get(own).map_or(&[][..], |info| &info.opponents);
        Ok(Self {
            time: 0.0,
            dt,
            capture_radius: run.capture_radius,
            exits: exits.unbind(),
            robots: PyTuple::new(py, &rows)?.unbind(),
            poses: PyArray2::zeros(py, [rows.len(), 3], false).unbind(),
            twists: PyArray2::zeros(py, [rows.len(), 2], false).unbind(),
            active: PyArray1::zeros(py, rows.len(), false).unbind(),
            rows,
            own,
            opponents: opponents.iter().map(|&row| row as usize).collect(),
        })
    }

    /// Takes the values of a tick.
    pub(super) fn update(&mut self, py: Python<'_>, view: &View<'_>) {
        self.time = view.time_s;
        let (poses, twists) = (self.poses.bind(py), self.twists.bind(py));
        let active = self.active.bind(py);
        // A planner that keeps a borrow of an array keeps its old values.
        let (Ok(mut poses), Ok(mut twists), Ok(mut active)) = (
            poses.try_readwrite(),
            twists.try_readwrite(),
            active.try_readwrite(),
        ) else {
            return;
        };
        let (mut poses, mut twists) = (poses.as_array_mut(), twists.as_array_mut());
        let mut active = active.as_array_mut();
        for robot in view.robots {
            let row = robot.index;
            let Some(object) = self.rows.get(row) else {
                continue;
            };
            object.borrow_mut(py).update(robot);
            for (column, value) in [robot.pose.x, robot.pose.y, robot.pose.theta]
                .into_iter()
                .enumerate()
            {
                poses[[row, column]] = value;
            }
            twists[[row, 0]] = robot.twist.v;
            twists[[row, 1]] = robot.twist.omega;
            active[row] = robot.active;
        }
    }

    /// Returns the robot with this index.
    pub(super) fn robot(&self, index: usize) -> Option<&Py<Robot>> {
        self.rows.get(index)
    }
}
