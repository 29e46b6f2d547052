//! Range scan and beliefs as a planner in Python sees them.

use numpy::{PyArray1, PyArray2, PyArrayMethods as _, ToPyArray as _};
use planner_view::view::{BeliefView, ParticleView, ScanView};
use pyo3::prelude::*;

use super::robot::Robot;

/// A range scan.
#[pyclass(module = "protean_robotics")]
#[derive(Debug)]
pub struct Scan {
    /// Ranges (m), shape (beams,); infinity without an echo.
    #[pyo3(get)]
    ranges: Py<PyArray1<f32>>,
    /// Directions of the beams (rad), shape (beams,), counter-clockwise from the robot's heading.
    #[pyo3(get)]
    angles: Py<PyArray1<f64>>,
    /// Minimum range of the sensor (m).
    #[pyo3(get)]
    range_min: f64,
    /// Maximum range of the sensor (m).
    #[pyo3(get)]
    range_max: f64,
}

#[pymethods]
impl Scan {
    fn __repr__(&self) -> String {
        format!("<Scan up to {:.2} m>", self.range_max)
    }
}

impl Scan {
    /// Returns the scan of a tick.
    pub(super) fn new(py: Python<'_>, view: &ScanView<'_>) -> Self {
        let beams = 0..view.ranges.len();
        let angles: Vec<f64> = beams
            .map(|beam| view.angle_min + beam as f64 * view.angle_increment)
            .collect();
        Self {
            ranges: view.ranges.to_pyarray(py).unbind(),
            angles: angles.to_pyarray(py).unbind(),
            range_min: view.range_min,
            range_max: view.range_max,
        }
    }
}

/// The team's belief about an opponent: weighted hypotheses of its pose.
#[pyclass(module = "protean_robotics")]
#[derive(Debug)]
pub struct Belief {
    /// The opponent.
    #[pyo3(get)]
    robot: Py<Robot>,
    /// Hypotheses: x (m), y (m), heading (rad), weight ≥ 0; shape (particles, 4).
    #[pyo3(get)]
    particles: Py<PyArray2<f32>>,
    /// Mean pose: x (m), y (m), heading (rad); shape (3,).
    #[pyo3(get)]
    mean: Py<PyArray1<f64>>,
    /// Standard deviation of the position around the mean (m).
    #[pyo3(get)]
    position_std: f64,
    /// `True` if a robot of the team sees the opponent in this tick.
    #[pyo3(get)]
    seen: bool,
}

#[pymethods]
impl Belief {
    fn __repr__(&self, py: Python<'_>) -> String {
        let robot = self.robot.borrow(py);
        let std = self.position_std;
        format!("<Belief about {}, {std:.2} m>", robot.name())
    }
}

impl Belief {
    /// Returns the belief of a tick.
    pub(super) fn new(py: Python<'_>, robot: &Py<Robot>, view: &BeliefView<'_>) -> PyResult<Self> {
        let mean = [view.mean.x, view.mean.y, view.mean.theta];
        let flat: Vec<f32> = view.particles.iter().flat_map(row).collect();
        let particles = PyArray1::from_vec(py, flat).reshape([view.particles.len(), 4])?;
        Ok(Self {
            robot: robot.clone_ref(py),
            particles: particles.unbind(),
            mean: mean.to_pyarray(py).unbind(),
            position_std: view.position_std,
            seen: view.seen,
        })
    }
}

fn row(particle: &ParticleView) -> [f32; 4] {
    [particle.x, particle.y, particle.theta, particle.weight]
}
